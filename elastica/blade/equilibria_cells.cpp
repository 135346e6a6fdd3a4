#include "elastica/blade/equilibria_cells.hpp"

#include <algorithm>
#include <boost/math/special_functions/ellint_rd.hpp>
#include <boost/math/special_functions/ellint_rf.hpp>
#include <cmath>
#include <numbers>
#include <optional>

namespace hotblade::elastica::cells {

namespace {

// Rounding of the elliptic integrals and of the interval arithmetic, relative to values of order 1 to 100.
constexpr double kSlack = 1e-11;
// Nearest to the separatrix: quarter periods up to 15, beyond which a start state cannot tell the shape.
constexpr double kMostW = 27.6;
// Furthest above it: m = 1.6e5, a circle to 1.6e-6 of the length.
constexpr double kLeastW = -12;

using Policy = boost::math::policies::policy<boost::math::policies::promote_double<false>>;

double rf(double x, double y, double z) {
  return boost::math::ellint_rf(x, y, z, Policy());
}
double rd(double x, double y, double z) {
  return boost::math::ellint_rd(x, y, z, Policy());
}

Interval operator+(const Interval& a, const Interval& b) {
  return {a.lo + b.lo, a.hi + b.hi};
}
Interval operator-(const Interval& a, const Interval& b) {
  return {a.lo - b.hi, a.hi - b.lo};
}
Interval operator*(double k, const Interval& a) {
  return k < 0 ? Interval{k * a.hi, k * a.lo} : Interval{k * a.lo, k * a.hi};
}
Interval operator*(const Interval& a, const Interval& b) {
  const auto [lo, hi] = std::minmax({a.lo * b.lo, a.lo * b.hi, a.hi * b.lo, a.hi * b.hi});
  return {lo, hi};
}
bool misses_zero(const Interval& a, double size) {
  return a.lo > kSlack * size || a.hi < -kSlack * size;
}
double width(const Interval& a) {
  return a.hi - a.lo;
}
double middle(const Interval& a) {
  return 0.5 * (a.lo + a.hi);
}

Interval cosine(const Interval& a) {
  if (width(a) >= 2 * std::numbers::pi) return {-1, 1};
  const double u = std::cos(a.lo), v = std::cos(a.hi);
  Interval r{std::min(u, v), std::max(u, v)};
  if (std::floor(a.hi / (2 * std::numbers::pi)) > std::floor(a.lo / (2 * std::numbers::pi))) r.hi = 1;
  if (std::floor((a.hi + std::numbers::pi) / (2 * std::numbers::pi)) >
      std::floor((a.lo + std::numbers::pi) / (2 * std::numbers::pi)))
    r.lo = -1;
  return r;
}
Interval sine(const Interval& a) {
  return cosine({a.lo - std::numbers::pi / 2, a.hi - std::numbers::pi / 2});
}

// Time and action from psi = 0.
struct Part {
  double time = 0, action = 0;
};

// Below the separatrix, quarter of a period; m = (1 - c)/2.
Part quarter(double m) {
  const double k = rf(0, m, 1);
  return {k, 2 * (1 - m) * (k - rd(0, m, 1) / 3)};
}

// Below the separatrix, for 0 <= psi, at most pi; the turning point where psi lies beyond it.
Part part_below(double psi, double m) {
  const double s = std::sin(0.5 * psi), cc = std::cos(0.5 * psi) * std::cos(0.5 * psi);
  if (cc <= m || psi >= std::numbers::pi) return quarter(m);
  const double kk = 1 - m, k = std::sqrt(kk), d = std::max(0.0, (cc - m) / kk);
  const double f = s / k * rf(d, cc, 1);
  return {f, 2 * (kk * f - s * s * s / (3 * k) * rd(d, cc, 1))};
}

// Above the separatrix, any psi; m = (c - 1)/2.
Part part_above(double psi, double m) {
  const double turns = std::round(psi / (2 * std::numbers::pi)), phi = 0.5 * psi - std::numbers::pi * turns;
  const double s = std::sin(phi), cc = std::cos(phi) * std::cos(phi), k = 1 + m;
  const auto integral = [k, m](double sine_, double cosine_squared) {
    const double x = k * cosine_squared, y = cosine_squared + m;
    const double f = sine_ * rf(x, y, k);
    return Part{f, 2 * k * (f - sine_ * sine_ * sine_ * rd(x, y, k) / 3)};
  };
  const Part p = integral(s, cc);
  if (turns == 0) return p;
  const Part half = integral(1, 0);
  return {p.time + 2 * turns * half.time, p.action + 2 * turns * half.action};
}

Part part_at(double psi, double m, bool above) {
  if (above) return part_above(psi, m);
  const Part p = part_below(std::abs(psi), m);
  return psi < 0 ? Part{-p.time, -p.action} : p;
}

struct Range {
  Interval time, action;
};

// Ranges of time and action from 0 to psi over the part of a cell below the separatrix where the pendulum
// gets to psi. At fixed psi time falls and action grows with c, both grow with psi, and both are odd in psi.
Range range_below(const Interval& psi, const Interval& m) {
  const auto reach = [](double p) {
    return std::cos(0.5 * p) * std::cos(0.5 * p);
  };  // largest m that gets there
  const auto largest = [&](double p) {
    const double at = std::min(m.hi, reach(p));
    return Part{at < m.lo ? quarter(m.lo).time : part_below(p, at).time, part_below(p, m.lo).action};
  };
  const auto smallest = [&](double p) {
    return Part{part_below(p, m.lo).time, part_below(p, std::clamp(reach(p), m.lo, m.hi)).action};
  };
  Range r;
  if (psi.lo >= 0) {
    const Part p = smallest(psi.lo);
    r.time.lo = p.time, r.action.lo = p.action;
  } else {
    const Part p = largest(-psi.lo);
    r.time.lo = -p.time, r.action.lo = -p.action;
  }
  if (psi.hi >= 0) {
    const Part p = largest(psi.hi);
    r.time.hi = p.time, r.action.hi = p.action;
  } else {
    const Part p = smallest(-psi.hi);
    r.time.hi = -p.time, r.action.hi = -p.action;
  }
  return r;
}

// |psi'| = 2 sqrt(cos^2(psi/2) -+ m); empty (hi < lo) where the pendulum does not get to.
Interval speed(const Interval& cosine_psi, const Interval& signed_m) {
  const double low = 0.5 * (1 + cosine_psi.lo) + signed_m.lo, high = 0.5 * (1 + cosine_psi.hi) + signed_m.hi;
  if (high < 0) return {1, 0};
  return {2 * std::sqrt(std::max(0.0, low)), 2 * std::sqrt(high)};
}

// A curve whose tangents lie within `spread` of each other reaches at least as far as the cosine of half of
// it.
bool too_straight(double r, double spread) {
  return spread < std::numbers::pi && r < std::cos(0.5 * spread) - kSlack;
}

// The two conditions and the energy, for one type.
bool possible(const Interval& time, const Interval& action, const Interval& drop, const Interval& c,
              const Interval& rsin, const Interval& rcos, double max_energy) {
  if (!(time.hi > 0) || !(action.hi > 0)) return false;
  const Interval t{std::max(0.0, time.lo), time.hi}, a{std::max(0.0, action.lo), action.hi};
  if (a.lo * t.lo > max_energy * (1 + kSlack)) return false;
  const double size = 1 + t.hi * (1 + std::max(std::abs(c.lo), std::abs(c.hi)));
  return !misses_zero(drop - t * rsin, size) && !misses_zero(a - t * (c + rcos), size);
}

// One end of the swing over a cell.
struct End {
  Interval psi, speed;
};

Interval reciprocal(const Interval& a) {
  return {1 / a.hi, 1 / a.lo};
}

double speed_at(double psi, double u) {
  return 2 * std::sqrt(std::max(0.0, 0.5 * (1 + std::cos(psi)) - u));
}

// Mean value form of both conditions: value at the middle, plus derivatives over the cell times its half
// widths. Its error falls with the square of the cell's size; the ends' speeds must not vanish in the cell.
// With u = (1 - c)/2 and k^2 = 1 - u, du/dw = -u, and at fixed psi0
//   dA/dw = u T,  dT/dw = A/(4 k^2) + sin(psi0)/(2 k^2 v0) -+ sin(psi1)/(2 k^2 v1),
// from Byrd, Friedman (1971), 710.07, with the change of the amplitude at fixed psi.
bool possible_by_slope(const Cell& cell, const Target& target, int n, const End& e0, const End& e1,
                       const Interval& time, const Interval& action) {
  const double sign = n % 2 == 0 ? 1 : -1, below = cell.above ? -1 : 1;
  const Interval u = below * Interval{std::exp(-cell.w.hi), std::exp(-cell.w.lo)}, kk{1 - u.hi, 1 - u.lo};
  const Interval beta{e0.psi.lo + target.chi, e0.psi.hi + target.chi};
  const Interval rsin = target.r * sine(beta), rcos = target.r * cosine(beta);
  const Interval lean = Interval{1 - 2 * u.hi, 1 - 2 * u.lo} + rcos;
  const Interval inverse0 = reciprocal(e0.speed), inverse1 = sign * reciprocal(e1.speed);
  const Interval bend0 = sine(e0.psi) * inverse0, bend1 = sine(e1.psi) * inverse1;
  const Interval time_psi = inverse1 - inverse0;
  const Interval time_w = reciprocal(4.0 * kk) * (action + 2.0 * (bend0 - bend1));
  const Interval g1_psi = bend1 - bend0 - time_psi * rsin - time * rcos;
  const Interval g1_w = 2.0 * (u * (inverse0 - inverse1)) - time_w * rsin;
  const Interval g2_psi = 0.5 * (sign * e1.speed - e0.speed) - time_psi * lean + time * rsin;
  const Interval g2_w = -1.0 * (u * time) - time_w * lean;
  const double psi0 = middle(e0.psi), psi1 = psi0 + target.turning, m = std::exp(-middle(cell.w)),
               um = below * m;
  const Part p0 = part_at(psi0, m, cell.above), p1 = part_at(psi1, m, cell.above);
  const Part q = n > 0 ? quarter(m) : Part{};
  const double t = 2 * n * q.time - p0.time + sign * p1.time,
               a = 2 * n * q.action - p0.action + sign * p1.action;
  const double g1 =
      speed_at(psi0, um) - sign * speed_at(psi1, um) - t * target.r * std::sin(psi0 + target.chi);
  const double g2 = a - t * (1 - 2 * um + target.r * std::cos(psi0 + target.chi));
  const double half_psi = 0.5 * width(e0.psi), half_w = 0.5 * width(cell.w);
  const Interval x{-half_psi, half_psi}, y{-half_w, half_w};
  const double size = 1 + std::abs(t) * (1 + m);
  return !misses_zero(Interval{g1, g1} + g1_psi * x + g1_w * y, size) &&
         !misses_zero(Interval{g2, g2} + g2_psi * x + g2_w * y, size);
}

std::uint64_t possible_below(const Cell& cell, const Target& target, double max_energy) {
  const Interval m{std::exp(-cell.w.hi), std::exp(-cell.w.lo)}, c{1 - 2 * m.hi, 1 - 2 * m.lo};
  Interval psi0{std::max(cell.psi0.lo, -std::numbers::pi), std::min(cell.psi0.hi, std::numbers::pi)};
  psi0 = {std::max(psi0.lo, -std::numbers::pi - target.turning),
          std::min(psi0.hi, std::numbers::pi - target.turning)};
  if (!(psi0.lo <= psi0.hi)) return 0;
  const Interval psi1{psi0.lo + target.turning, psi0.hi + target.turning};
  const Interval back{-m.hi, -m.lo}, v0 = speed(cosine(psi0), back), v1 = speed(cosine(psi1), back);
  if (v0.hi < v0.lo || v1.hi < v1.lo) return 0;
  const Interval beta{psi0.lo + target.chi, psi0.hi + target.chi};
  const Interval rsin = target.r * sine(beta), rcos = target.r * cosine(beta);
  const Range r0 = range_below(psi0, m), r1 = range_below(psi1, m);
  const bool smooth = v0.lo > 0 && v1.lo > 0 && psi0.lo > -std::numbers::pi && psi0.hi < std::numbers::pi &&
                      psi1.lo > -std::numbers::pi && psi1.hi < std::numbers::pi;
  const Part least = quarter(m.hi), most = quarter(m.lo);
  std::uint64_t types = 0;
  for (int n = 0; n <= 60; ++n) {
    if (!(cell.types >> n & 1)) continue;
    const double sign = n % 2 == 0 ? 1 : -1;
    const double furthest = 2 * std::acos(std::sqrt(m.lo));
    const double lowest = n > 1 ? -furthest : std::min(psi0.lo, psi1.lo);
    if (too_straight(target.r, (n == 0 ? psi1.hi : furthest) - lowest)) continue;
    const Interval time = 2.0 * n * Interval{least.time, most.time} - r0.time + sign * r1.time;
    const Interval action = 2.0 * n * Interval{least.action, most.action} - r0.action + sign * r1.action;
    if (!possible(time, action, v0 - sign * v1, c, rsin, rcos, max_energy)) continue;
    if (smooth && !possible_by_slope(cell, target, n, {psi0, v0}, {psi1, v1}, time, action)) continue;
    types |= std::uint64_t{1} << n;
  }
  return types;
}

Part between(double from, double to, double m) {
  const Part p = part_above(from, m), q = part_above(to, m);
  return {q.time - p.time, q.action - p.action};
}

// Above the separatrix the end point over the length is the mean of (cos psi, sin psi) by time. Its
// derivative by c is a covariance with 1/psi'^2, at most a quarter of the product of both ranges; that by
// psi0 is
//   ((f1 - mean)/psi'(T) - (f0 - mean)/psi'(0)) / T.
class MeanTest {
 public:
  MeanTest(const Cell& cell, const Target& target, const Interval& m, const End& e0, const End& e1,
           const Interval& time)
      : e0_(e0), e1_(e1), time_(time), half_(0.5 * width(e0.psi)) {
    const double psi = middle(e0.psi), mid = std::exp(-middle(cell.w)), c = 1 + 2 * mid;
    const Part whole = between(psi, psi + target.turning, mid);
    mean_cos_ = whole.action / whole.time - c;
    mean_sin_ = (speed_at(psi, -mid) - speed_at(psi + target.turning, -mid)) / whole.time;
    const Interval v = speed(cosine({e0.psi.lo, e1.psi.hi}), m);
    by_c_ = 0.5 * std::max(m.hi - mid, mid - m.lo) * (1 / (v.lo * v.lo) - 1 / (v.hi * v.hi));
    by_psi_ = half_ * (1 / e0.speed.lo + 1 / e1.speed.lo) / time.lo;
    size_ = 1 + c;  // rounding of the difference A/T - c grows with c
  }

  [[nodiscard]] bool possible(const Target& target) const {
    if (!std::isfinite(by_psi_)) return true;
    const Interval beta{e0_.psi.lo + target.chi, e0_.psi.hi + target.chi}, all{e0_.psi.lo, e1_.psi.hi};
    const double at = middle(e0_.psi) + target.chi, r = target.r;
    return may_vanish(mean_cos_ - r * std::cos(at), mean_cos_, cosine(all), cosine(e0_.psi), cosine(e1_.psi),
                      -r * sine(beta)) &&
           may_vanish(mean_sin_ - r * std::sin(at), mean_sin_, sine(all), sine(e0_.psi), sine(e1_.psi),
                      r * cosine(beta));
  }

 private:
  // `value` at the middle; the mean and its function's ranges over the way and at both ends; derivative of
  // the wanted value.
  [[nodiscard]] bool may_vanish(double value, double mean, const Interval& range, const Interval& f0,
                                const Interval& f1, const Interval& wanted_slope) const {
    const double by_c = width(range) * by_c_, slack = by_c + width(range) * by_psi_;
    const Interval means{std::max(range.lo, mean - slack), std::min(range.hi, mean + slack)};
    const Interval slope =
        reciprocal(time_) * ((f1 - means) * reciprocal(e1_.speed) - (f0 - means) * reciprocal(e0_.speed)) -
        wanted_slope;
    return !misses_zero(Interval{value - by_c, value + by_c} + slope * Interval{-half_, half_}, size_);
  }

  End e0_, e1_;
  Interval time_;
  double half_, mean_cos_ = 0, mean_sin_ = 0, by_c_ = 0, by_psi_ = 0, size_ = 1;
};

bool possible_above(const Cell& cell, const Target& target, double max_energy) {
  const double turning = target.turning;
  const Interval m{std::exp(-cell.w.hi), std::exp(-cell.w.lo)};
  const Interval psi0 = cell.psi0, psi1{psi0.lo + turning, psi0.hi + turning};
  const Interval beta{psi0.lo + target.chi, psi0.hi + target.chi};
  // The mean lies among the values.
  const Interval all{psi0.lo, psi1.hi};
  if (misses_zero(cosine(all) - target.r * cosine(beta), 1)) return false;
  if (misses_zero(sine(all) - target.r * sine(beta), 1)) return false;
  const End e0{psi0, speed(cosine(psi0), m)}, e1{psi1, speed(cosine(psi1), m)};
  // At fixed ends time falls and action grows with c; the widest and the narrowest way bound both.
  const bool wide = psi1.lo > psi0.hi;
  const Interval time{wide ? between(psi0.hi, psi1.lo, m.hi).time : 0, between(psi0.lo, psi1.hi, m.lo).time};
  const Interval action{wide ? between(psi0.hi, psi1.lo, m.lo).action : 0,
                        between(psi0.lo, psi1.hi, m.hi).action};
  if (time.lo * action.lo > max_energy * (1 + kSlack)) return false;
  if (!MeanTest(cell, target, m, e0, e1, time).possible(target)) return false;
  // Far above the separatrix the terms of the slopes cancel, and the mean is the better test.
  constexpr double kFarAbove = -3;
  return cell.w.lo < kFarAbove || possible_by_slope(cell, target, 0, e0, e1, time, action);
}

// Whether a curve that turns one way only can do it: to the left, and, when it turns by less than half a
// turn, its chord's direction lies between its end tangents, and the chord is at least cos(turning/2) long.
bool convex_arc_possible(const Target& target) {
  if (!(target.turning > 0)) return false;
  if (target.turning >= std::numbers::pi) return true;
  return !too_straight(target.r, target.turning) && target.chi >= -kSlack &&
         target.chi <= target.turning + kSlack;
}

}  // namespace

std::vector<Cell> initial_cells(const Target& target, int max_inflections) {
  std::vector<Cell> cells;
  const bool convex = convex_arc_possible(target);
  const std::uint64_t all = ((std::uint64_t{2} << max_inflections) - 1) & ~std::uint64_t{convex ? 0U : 1U};
  const double least_w = -std::log(0.5 * (1 + target.r));
  constexpr int kAcross = 16;
  for (int i = 0; i < kAcross; ++i) {
    const Interval psi0{-std::numbers::pi + 2 * std::numbers::pi * i / kAcross,
                        -std::numbers::pi + 2 * std::numbers::pi * (i + 1) / kAcross};
    cells.push_back({psi0, {least_w, std::max(least_w, 1.0) + 1}, false, all});
    cells.push_back({psi0, {std::max(least_w, 1.0) + 1, kMostW}, false, all});
    if (!convex) continue;
    cells.push_back({psi0, {kLeastW, 0}, true, 1});
    cells.push_back({psi0, {0, kMostW}, true, 1});
  }
  return cells;
}

std::uint64_t possible_types(const Cell& cell, const Target& target, double max_energy) {
  if (cell.above) return possible_above(cell, target, max_energy) ? 1 : 0;
  return possible_below(cell, target, max_energy);
}

Swing swing_at(double psi0, double w, bool above, int n, const Target& target) {
  const double m = std::exp(-w), psi1 = psi0 + target.turning;
  const double start = part_at(psi0, m, above).time, end = part_at(psi1, m, above).time;
  const double time = 2.0 * n * (n > 0 ? quarter(m).time : 0) - start + (n % 2 == 0 ? end : -end);
  return {time * speed_at(psi0, above ? -m : m), time * time * std::cos(psi0), -time * time * std::sin(psi0)};
}

namespace {

// How far the chord of the taut shape that starts at psi0 with n turning points is from its direction (the
// sine of the angle), absent where the way does not lead along the tension, or takes less time than the
// nearest cells have.
std::optional<double> taut_mismatch(double psi0, int n, const Target& target, double max_energy) {
  const double m = std::exp(-kMostW), psi1 = psi0 + target.turning, sign = n % 2 == 0 ? 1 : -1;
  const bool above = n == 0;
  if (above && std::floor((psi0 + std::numbers::pi) / (2 * std::numbers::pi)) ==
                   std::floor((psi1 + std::numbers::pi) / (2 * std::numbers::pi)))
    return std::nullopt;
  if (!above && (std::abs(psi0) >= std::numbers::pi || std::abs(psi1) >= std::numbers::pi))
    return std::nullopt;
  const Part p0 = part_at(psi0, m, above), p1 = part_at(psi1, m, above), q = above ? Part{} : quarter(m);
  const double action = 2 * n * q.action - p0.action + sign * p1.action;
  const double least_time = 2 * n * q.time - p0.time + sign * p1.time;
  const double u = above ? -m : m, drop = speed_at(psi0, u) - sign * speed_at(psi1, u);
  // (action - T)^2 + drop^2 = (r T)^2, the larger T.
  const double square = action * action + drop * drop, rest = 1 - target.r * target.r;
  const double root = action * action - square * rest;
  if (root < 0) return std::nullopt;
  const double time = square / (action - std::sqrt(root));
  if (!(time > least_time) || action * time > max_energy) return std::nullopt;
  const double beta = psi0 + target.chi, x = action - time, y = drop;
  if (x * std::cos(beta) + y * std::sin(beta) < 0) return std::nullopt;
  return (x * std::sin(beta) - y * std::cos(beta)) / (target.r * time);
}

}  // namespace

int taut_solutions(const Target& target, int max_inflections, double max_energy) {
  constexpr int kScan = 2000;
  int count = 0;
  for (int n = convex_arc_possible(target) ? 0 : 1; n <= max_inflections; ++n) {
    std::optional<double> last;
    for (int i = 0; i <= kScan; ++i) {
      const auto here =
          taut_mismatch(-std::numbers::pi + 2 * std::numbers::pi * i / kScan, n, target, max_energy);
      if (last && here && (*last < 0) != (*here < 0)) ++count;
      last = here;
    }
  }
  return count;
}

int inflection_bound(const Target& target, double max_energy) {
  const Part least = quarter(0.5 * (1 + target.r));
  const double swings = std::sqrt(max_energy / (4 * least.time * least.action));
  return swings < 1e6 ? 1 + static_cast<int>(swings) : 1'000'000;
}

}  // namespace hotblade::elastica::cells
