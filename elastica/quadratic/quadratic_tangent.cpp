#include "elastica/quadratic/quadratic_tangent.hpp"

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "elastica/kernels/quadratic.h"
#include "elastica/linear/cross.hpp"

namespace hotblade::elastica {

namespace {

using Eigen::Vector2d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// What counts as touching, relative to the problem's size: a hundred roundings of the coordinates.
constexpr double kOnTolerance = 1e-13;
// Grids around a feature of the locus: ratio of neighbouring distances, and how far in from an end of a
// component, as a part of it, a minimum is looked for.
constexpr double kGridRatio = 1.5;
constexpr double kNearestPart = 1e-7;
constexpr int kEvenSteps = 64;

// A point of the locus: the middle control point, where its curve touches, and how fast b1 moves along the
// common tangent's direction (proposition 4.2), negative where it runs backwards; it turns round in a cusp.
struct LocusPoint {
  Vector2d b1, contact;
  double t, speed = 1;
};

struct Problem {
  Vector2d b0, b2;
  Objective objective;

  [[nodiscard]] hb_quadratic_edges edges(const Vector2d& b1) const {
    return hb_quadratic_edges_of(b0.x(), b0.y(), b1.x(), b1.y(), b2.x(), b2.y());
  }
  [[nodiscard]] double value(const Vector2d& b1) const {
    const hb_quadratic_edges q = edges(b1);
    return objective == Objective::kLength ? hb_quadratic_length(q) : hb_quadratic_energy(q);
  }
  [[nodiscard]] double side(const Vector2d& b1) const { return cross(b1 - b0, b2 - b1); }

  [[nodiscard]] TangentMinimum minimum(const LocusPoint& p, TangencyBranch branch) const {
    const Quadratic curve{b0, p.b1, b2};
    const Vector2d velocity = (1 - p.t) * (p.b1 - b0) + p.t * (b2 - p.b1);
    const double size = (p.b1 - b0).norm() + (b2 - p.b1).norm();
    // A minimum's place is good to the root of rounding, and so is a vanishing velocity.
    return {curve, p.contact, p.t, value(p.b1), branch, velocity.norm() > 1e-7 * size};
  }
};

// Grid points a + d and b - d with d growing from `least` by kGridRatio, over (a, b).
void add_grid(std::vector<double>& grid, double centre, double least, double a, double b) {
  for (double d = least; d < b - a; d *= kGridRatio) {
    if (centre - d > a) grid.push_back(centre - d);
    if (centre + d < b) grid.push_back(centre + d);
  }
}

template <typename F>
double zero_between(double lo, double hi, const F& f) {
  const bool rises = f(lo) < 0;
  for (int i = 0; i < 60 && hi - lo > 1e-15 * (std::abs(lo) + std::abs(hi)); ++i) {
    const double middle = 0.5 * (lo + hi);
    (rises == (f(middle) > 0) ? hi : lo) = middle;
  }
  return 0.5 * (lo + hi);
}

template <typename F>
std::pair<double, double> least_between(double lo, double hi, const F& f) {
  std::uintmax_t steps = 80;
  return boost::math::tools::brent_find_minima(f, lo, hi, std::numeric_limits<double>::digits / 2, steps);
}

// The cusps of the locus between neighbouring grid points, and points close about each: at a cusp length and
// energy have an extremum, and others may be near. A pair of cusps inside one cell shows as a dip of the
// speed.
template <typename Locus>
void add_cusps(const Locus& locus, std::vector<double>& grid) {
  const auto speed = [&](double x) { return locus(x).speed; };
  std::vector<double> k, cusps;
  for (const double x : grid) k.push_back(speed(x));
  const auto seek = [&](double a, double ka, double b, double kb) {
    if (ka * kb < 0) cusps.push_back(zero_between(a, b, speed));
  };
  const std::size_t n = grid.size();
  for (std::size_t i = 0; i + 1 < n; ++i) seek(grid[i], k[i], grid[i + 1], k[i + 1]);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double sign = k[i] < 0 ? -1 : 1;
    const double before = sign * k[i - 1], here = sign * k[i], after = sign * k[i + 1];
    if (!(here < before && here < after && here < 0.5 * std::max(before, after))) continue;
    const auto [x, least] =
        least_between(grid[i - 1], grid[i + 1], [&](double at) { return sign * speed(at); });
    if (!(least < 0)) continue;
    seek(grid[i - 1], before, x, least);
    seek(x, least, grid[i + 1], after);
  }
  std::vector<double> near;
  for (const double c : cusps) {
    const auto above = std::upper_bound(grid.begin(), grid.end(), c);
    const double cell = *above - *(above - 1);
    near.push_back(c);
    for (double d = 0.3 * cell; d > 1e-5 * cell; d *= 0.3) {
      near.push_back(std::max(c - d, grid.front()));
      near.push_back(std::min(c + d, grid.back()));
    }
  }
  grid.insert(grid.end(), near.begin(), near.end());
  std::sort(grid.begin(), grid.end());
}

struct Sample {
  double x, f;
};

// Adds samples where the slope dips without changing sign: a minimum and a maximum may hide there, close
// together.
template <typename F>
bool refine_dips(std::vector<Sample>& samples, const F& value) {
  const std::size_t n = samples.size();
  std::vector<double> slope;
  for (std::size_t i = 0; i + 1 < n; ++i) {
    slope.push_back((samples[i + 1].f - samples[i].f) / (samples[i + 1].x - samples[i].x));
  }
  std::vector<bool> refine(n, false);
  bool any = false;
  for (std::size_t i = 1; i + 2 < n; ++i) {
    const double before = slope[i - 1], here = slope[i], after = slope[i + 1];
    if (!(before * here > 0 && here * after > 0 && std::isfinite(before) && std::isfinite(after))) continue;
    const double a = std::abs(here), low = std::min(std::abs(before), std::abs(after)),
                 high = std::max(std::abs(before), std::abs(after));
    if (!(a <= low && a < 0.5 * high)) continue;
    refine[i - 1] = refine[i] = refine[i + 1] = any = true;
  }
  if (!any) return false;
  std::vector<Sample> finer;
  for (std::size_t i = 0; i < n; ++i) {
    finer.push_back(samples[i]);
    if (!refine[i]) continue;
    for (const double part : {1.0 / 3, 2.0 / 3}) {
      const double x = samples[i].x + part * (samples[i + 1].x - samples[i].x);
      if (x > finer.back().x && x < samples[i + 1].x) finer.push_back({x, value(x)});
    }
  }
  samples = std::move(finer);
  return true;
}

// The minima in a bracket around the sample `here`: two that lie close together may share it.
template <typename F>
std::vector<double> minima_between(const Sample& before, const Sample& here, const Sample& after,
                                   const F& value) {
  constexpr int kParts = 6;  // of either side
  std::vector<Sample> samples{before};
  for (const auto& [from, to] : {std::pair{before, here}, std::pair{here, after}}) {
    for (int i = 1; i < kParts; ++i) {
      const double x = from.x + (to.x - from.x) * i / kParts;
      samples.push_back({x, value(x)});
    }
    samples.push_back(to);
  }
  std::vector<double> minima;
  for (std::size_t i = 1; i + 1 < samples.size(); ++i) {
    const Sample& s = samples[i];
    if (!(s.f < samples[i - 1].f && s.f <= samples[i + 1].f)) continue;
    const auto [at, least] = least_between(samples[i - 1].x, samples[i + 1].x, value);
    minima.push_back(least <= s.f ? at : s.x);
  }
  return minima;
}

// The minima of one component of the locus, x in (grid.front(), grid.back()), whose ends do not count. For
// the energy every place where the curve folds is a pole between minima, and joins the samples.
template <typename Locus>
void minima_on(const Problem& problem, const Locus& locus, std::vector<double> grid, TangencyBranch branch,
               std::vector<TangentMinimum>& found) {
  std::sort(grid.begin(), grid.end());
  add_cusps(locus, grid);
  grid.erase(std::unique(grid.begin(), grid.end()), grid.end());
  const auto side = [&](double at) { return problem.side(locus(at).b1); };
  const auto value = [&](double at) {
    const double v = problem.value(locus(at).b1);
    return std::isfinite(v) ? v : std::numeric_limits<double>::max();
  };
  std::vector<Sample> samples;
  double side_before = 0;
  for (const double x : grid) {
    const Vector2d b1 = locus(x).b1;
    const double s = problem.side(b1);
    if (problem.objective == Objective::kEnergy && s * side_before < 0) {
      samples.push_back({zero_between(samples.back().x, x, side), kInfinity});
    }
    samples.push_back({x, problem.value(b1)});
    side_before = s;
  }
  constexpr int kRounds = 4;  // each finds pairs a third as far apart
  for (int round = 0; round < kRounds && refine_dips(samples, value); ++round) {
  }
  for (std::size_t i = 1; i + 1 < samples.size(); ++i) {
    const Sample &before = samples[i - 1], &here = samples[i], &after = samples[i + 1];
    if (!(here.f < before.f && here.f <= after.f)) continue;
    for (const double at : minima_between(before, here, after, value)) {
      found.push_back(problem.minimum(locus(at), branch));
    }
  }
}

// The end point `on` lies on the line or circle, whose direction there is `tangent`: b1 anywhere on that
// tangent. The length falls towards b1 = on, the chord.
void end_tangent(const Problem& problem, bool first, const Vector2d& tangent,
                 std::vector<TangentMinimum>& found) {
  const Vector2d on = first ? problem.b0 : problem.b2, other = first ? problem.b2 : problem.b0;
  const TangencyBranch branch = first ? TangencyBranch::kEndTangent0 : TangencyBranch::kEndTangent2;
  const auto locus = [&](double x) { return LocusPoint{on + x * tangent, on, first ? 0.0 : 1.0}; };
  if (problem.objective == Objective::kLength) {
    found.push_back(problem.minimum(locus(0), branch));
    return;
  }
  const double chord = (other - on).norm(), far = 1e6 * chord, foot = (other - on).dot(tangent);
  for (const double sign : {-1.0, 1.0}) {
    std::vector<double> grid;
    add_grid(grid, 0, kNearestPart * chord, sign < 0 ? -far : 0, sign < 0 ? 0 : far);
    if (foot * sign > 0) {
      const double height = std::abs(cross(tangent, other - on));
      add_grid(grid, foot, 0.05 * height + kNearestPart * chord, sign < 0 ? 2 * foot : 0,
               sign < 0 ? 0 : 2 * foot);
    }
    minima_on(problem, locus, std::move(grid), branch, found);
  }
}

TangentCurves sorted(std::vector<TangentMinimum> minima) {
  TangentCurves curves;
  std::stable_sort(minima.begin(), minima.end(),
                   [](const TangentMinimum& a, const TangentMinimum& b) { return a.value < b.value; });
  // A closed locus is walked a little more than once round. Two minima nearer than a place is known to are
  // one.
  const auto same = [](const TangentMinimum& a, const TangentMinimum& b) {
    const double size = (a.curve[1] - a.curve[0]).norm() + (a.curve[2] - a.curve[1]).norm();
    return a.branch == b.branch && (a.curve[1] - b.curve[1]).norm() < 1e-6 * size;
  };
  for (std::size_t i = 0; i < minima.size(); ++i) {
    const auto rest = minima.begin() + static_cast<std::ptrdiff_t>(i) + 1;
    minima.erase(std::remove_if(rest, minima.end(), [&](const auto& m) { return same(minima[i], m); }),
                 minima.end());
  }
  curves.status = minima.empty() ? TangentStatus::kInfeasible : TangentStatus::kOk;
  const auto regular = std::find_if(minima.begin(), minima.end(), [](const auto& m) { return m.regular; });
  curves.best = regular == minima.end() ? 0 : static_cast<std::size_t>(regular - minima.begin());
  curves.minima = std::move(minima);
  return curves;
}

// The straight segment from end to end, touching at `contact`.
TangentMinimum straight(const Problem& problem, const Vector2d& contact) {
  const Vector2d chord = problem.b2 - problem.b0;
  const double t = std::clamp((contact - problem.b0).dot(chord) / chord.squaredNorm(), 0.0, 1.0);
  const Vector2d middle = 0.5 * (problem.b0 + problem.b2);
  const double value = problem.objective == Objective::kLength ? chord.norm() : 0;
  return {{problem.b0, middle, problem.b2}, contact, t, value, TangencyBranch::kChord, true};
}

void check(const Vector2d& b0, const Vector2d& b2, const Vector2d& place, double size) {
  if (!b0.allFinite() || !b2.allFinite() || !place.allFinite() || !std::isfinite(size) || !(size > 0) ||
      !(b0 != b2)) {
    throw std::logic_error("tangent curve needs finite, distinct ends and a finite line or circle");
  }
}

// --- The circle, taken to the unit circle about 0.

// One end in polar form: gap = 1 - distance from the centre, exactly 0 on the circle.
struct PolarEnd {
  Vector2d p, outward, along;
  double angle, gap, half_width;  // half_width: of the arc whose tangents have the end on their outer side

  explicit PolarEnd(const Vector2d& at) : p(at), angle(std::atan2(at.y(), at.x())), gap(1 - at.norm()) {
    if (std::abs(gap) <= kOnTolerance * (1 + at.norm())) gap = 0;
    outward = {std::cos(angle), std::sin(angle)};
    along = {-outward.y(), outward.x()};
    half_width = gap < 0 ? std::acos(1 / (1 - gap)) : 0;
  }
  [[nodiscard]] bool on() const { return gap == 0; }
  // c - p and (c - p).c for the contact c at an angle, without cancellation near the end's own direction.
  [[nodiscard]] std::pair<Vector2d, double> from(double theta) const {
    const double half = 0.5 * (theta - angle), s = std::sin(half), c = std::cos(half);
    return {2 * s * (c * along - s * outward) + gap * outward, gap + 2 * (1 - gap) * s * s};
  }
};

// b1 for the contact at theta (paper, equation 6); both ends must be on one side of the tangent there.
LocusPoint circle_locus(const PolarEnd& end0, const PolarEnd& end2, double theta) {
  const auto [c0, h0] = end0.from(theta);
  const auto [c2, h2] = end2.from(theta);
  const double r0 = std::sqrt(std::abs(h0)), r2 = std::sqrt(std::abs(h2));
  const Vector2d contact{std::cos(theta), std::sin(theta)}, tangent{-contact.y(), contact.x()};
  const double ratio = r2 / r0, turn = tangent.dot(c2) * h0 - tangent.dot(c0) * h2;
  // Equation 8, with h0' = c0.tangent and h2' = c2.tangent; h2 < 0 on the closer branch.
  const double speed = 1 + 0.5 * (ratio + 1 / ratio) - turn * turn / (4 * ratio * h0 * h0 * h2);
  return {contact + 0.5 * (ratio * c0 + 1 / ratio * c2), contact, r0 / (r0 + r2), speed};
}

// Angles at which components of the locus end, in [start, start + 2 pi).
std::vector<double> component_ends(const PolarEnd& end0, const PolarEnd& end2) {
  std::vector<double> ends;
  for (const PolarEnd* end : {&end0, &end2}) {
    if (end->gap > 0) continue;
    ends.push_back(end->angle - end->half_width);
    if (!end->on()) ends.push_back(end->angle + end->half_width);
  }
  if (ends.empty()) return ends;
  const double start = ends.front();
  for (double& a : ends) {
    a = start + std::fmod(a - start + 4 * std::numbers::pi, 2 * std::numbers::pi);
  }
  std::sort(ends.begin(), ends.end());
  return ends;
}

void circle_component(const Problem& problem, const PolarEnd& end0, const PolarEnd& end2, double a, double b,
                      bool closed, std::vector<TangentMinimum>& found) {
  const double width = b - a;
  if (width < 1e-12) return;  // less than the angles are known to
  const double middle = 0.5 * (a + b), h0 = end0.from(middle).second, h2 = end2.from(middle).second;
  if (h0 * h2 <= 0) return;
  std::vector<double> grid;
  const double margin =
      closed ? width / kEvenSteps : 0;  // a full circle overlaps itself, for minima at its seam
  for (int i = closed ? -1 : 1; i < kEvenSteps + (closed ? 2 : 0); ++i)
    grid.push_back(a + i * width / kEvenSteps);
  if (!closed) {
    add_grid(grid, a, kNearestPart * width, a, middle);
    add_grid(grid, b, kNearestPart * width, middle, b);
  }
  for (const PolarEnd* end : {&end0, &end2}) {
    // An end just inside, or just outside and behind: the locus runs fast where the contact passes it.
    if (end->on() || std::abs(end->gap) > 0.5) continue;
    double angle = end->angle;
    while (angle < a) angle += 2 * std::numbers::pi;
    while (angle > b) angle -= 2 * std::numbers::pi;
    if (angle > a) add_grid(grid, angle, 0.05 * std::sqrt(std::abs(end->gap)) + 1e-9, a - margin, b + margin);
  }
  const auto locus = [&](double theta) { return circle_locus(end0, end2, theta); };
  minima_on(problem, locus, std::move(grid), h0 < 0 ? TangencyBranch::kCloser : TangencyBranch::kFarther,
            found);
}

CircleCase circle_case(const PolarEnd& a, const PolarEnd& b) {
  const int on = a.on() + b.on(), inside = (a.gap > 0) + (b.gap > 0);
  if (on == 2) return CircleCase::kOnOn;
  if (on == 1) return inside == 1 ? CircleCase::kOnInside : CircleCase::kOutsideOn;
  return inside == 2   ? CircleCase::kInsideInside
         : inside == 1 ? CircleCase::kOutsideInside
                       : CircleCase::kOutsideOutside;
}

// Where the segment itself touches the unit circle from outside.
std::optional<Vector2d> chord_contact(const PolarEnd& end0, const PolarEnd& end2) {
  const Vector2d chord = end2.p - end0.p;
  const double t = -end0.p.dot(chord) / chord.squaredNorm(), size = 1 + end0.p.norm() + end2.p.norm();
  if (t < -kOnTolerance || t > 1 + kOnTolerance) return {};
  const Vector2d foot = end0.p + std::clamp(t, 0.0, 1.0) * chord;
  if (std::abs(foot.norm() - 1) > kOnTolerance * size) return {};
  return foot;
}

}  // namespace

TangentCurves tangent_to_line(const Vector2d& b0, const Vector2d& b2, const Vector2d& on,
                              const Vector2d& direction, Objective objective) {
  check(b0, b2, on, direction.norm());
  const Problem problem{b0, b2, objective};
  const Vector2d along = direction.normalized(), across{-along.y(), along.x()};
  const double size = (b2 - b0).norm() + (b0 - on).norm() + (b2 - on).norm();
  double a = across.dot(b0 - on), c = across.dot(b2 - on);
  if (std::abs(a) <= kOnTolerance * size) a = 0;
  if (std::abs(c) <= kOnTolerance * size) c = 0;
  if (a * c < 0) return {};
  std::vector<TangentMinimum> found;
  if (a == 0 && c == 0) {
    found.push_back(straight(problem, 0.5 * (b0 + b2)));
    return sorted(std::move(found));
  }
  if (a == 0 || c == 0) {
    end_tangent(problem, a == 0, along, found);
    return sorted(std::move(found));
  }
  const double up = a + c > 0 ? 1 : -1, depth = std::sqrt(a * c), z0 = along.dot(b0 - on),
               z2 = along.dot(b2 - on);
  a *= up;
  c *= up;
  const double t = std::sqrt(a) / (std::sqrt(a) + std::sqrt(c));
  const auto locus = [&](double x) {
    const double touch = (1 - t) * (1 - t) * z0 + 2 * t * (1 - t) * x + t * t * z2;
    return LocusPoint{on + x * along - up * depth * across, on + touch * along, t};
  };
  // b1 is on the chord's line at `fold`, between which and infinity, either way, the energy has its minima.
  const double far = 1e4 * size, from = std::min(z0, z2) - far, to = std::max(z0, z2) + far;
  std::vector<double> grid{from, to};
  add_grid(grid, z0, 0.05 * (a + depth), from, to);
  add_grid(grid, z2, 0.05 * (c + depth), from, to);
  if (a != c && objective == Objective::kEnergy) {
    const double fold = z0 + (z2 - z0) * (a + depth) / (a - c);
    if (fold > from && fold < to) add_grid(grid, fold, kNearestPart * size, from, to);
  }
  minima_on(problem, locus, std::move(grid), TangencyBranch::kLine, found);
  return sorted(std::move(found));
}

TangentCurves tangent_to_circle(const Vector2d& b0, const Vector2d& b2, const Vector2d& centre, double radius,
                                Objective objective) {
  check(b0, b2, centre, radius);
  const PolarEnd end0((b0 - centre) / radius), end2((b2 - centre) / radius);
  const Problem problem{end0.p, end2.p, objective};
  std::vector<TangentMinimum> found;
  if (const auto contact = chord_contact(end0, end2)) found.push_back(straight(problem, *contact));
  const std::vector<double> ends = component_ends(end0, end2);
  if (ends.empty()) circle_component(problem, end0, end2, 0, 2 * std::numbers::pi, true, found);
  for (std::size_t i = 0; i < ends.size(); ++i) {
    const double next = i + 1 < ends.size() ? ends[i + 1] : ends.front() + 2 * std::numbers::pi;
    circle_component(problem, end0, end2, ends[i], next, false, found);
  }
  if (end0.on()) end_tangent(problem, true, end0.along, found);
  if (end2.on()) end_tangent(problem, false, end2.along, found);
  for (TangentMinimum& m : found) {
    m.curve = {b0, centre + radius * m.curve[1], b2};
    m.contact = centre + radius * m.contact;
    m.value = Problem{b0, b2, objective}.value(m.curve[1]);
    if (m.branch == TangencyBranch::kChord) m.value = objective == Objective::kLength ? (b2 - b0).norm() : 0;
  }
  TangentCurves curves = sorted(std::move(found));
  curves.circle_case = circle_case(end0, end2);
  return curves;
}

}  // namespace hotblade::elastica
