#include "elastica/arcs/arcs.hpp"

#include <algorithm>
#include <array>
#include <boost/math/tools/roots.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "elastica/arcs/arcs_split.hpp"

namespace hotblade::elastica {

namespace {

// Lengths are kept to this, relative; below it a spiral is a circular arc.
constexpr double kLengthTolerance = 1e-12;

// What a piece's length may be off by: itself to rounding, and what the rounding of its ends' coordinates
// makes of it.
double length_slack(const SpiralEnds& ends) {
  const double place = std::abs(ends.a.x) + std::abs(ends.a.y) + std::abs(ends.b.x) + std::abs(ends.b.y);
  return kLengthTolerance * ends.length + 1e-13 * place;
}

double sinc(double a) {
  return std::abs(a) < 1e-4 ? 1 - a * a / 6 : std::sin(a) / a;  // the next term is 1e-18
}

// An arc from its chord's length and its turning.
Arc arc_over(const CurvePoint& start, double chord, double turning) {
  const double length = chord / sinc(0.5 * turning);
  return {start.x, start.y, start.theta, turning / length, length};
}

// Turnings and chords of the two arcs. The chords are 2 c p and 2 c over |p + exp(i gamma)|.
struct Halves {
  double turning1, turning2, chord1, chord2;
};

Halves halves(const BiarcFamily& f, double p) {
  const double gamma = f.gamma();
  const double joint = -f.omega() + 2 * std::atan((1 - p) / (1 + p) * std::tan(0.5 * gamma));
  const double d = std::sqrt((p + 2 * std::cos(gamma)) * p + 1);
  return {joint - f.alpha, f.beta - joint, 2 * f.c * (p / d), 2 * f.c / d};
}

// A root of f in [lo, hi], or the end nearer to one where rounding hides it.
template <typename F>
double root_between(double lo, double hi, const F& f) {
  const double f_lo = f(lo), f_hi = f(hi);
  if (!(f_lo * f_hi < 0)) return std::abs(f_lo) < std::abs(f_hi) ? lo : hi;
  std::uintmax_t steps = 100;
  const auto [a, b] = boost::math::tools::toms748_solve(f, lo, hi, f_lo, f_hi,
                                                        boost::math::tools::eps_tolerance<double>(52), steps);
  return std::abs(f(a)) < std::abs(f(b)) ? a : b;
}

// Between the two arcs over the chord that have one end tangent each: every short spiral lies there (the
// lens).
double lens_width(const BiarcFamily& f) {
  return f.c * std::abs(std::tan(0.5 * f.alpha) + std::tan(0.5 * f.beta));
}

// The triarc that leaves a's circle of curvature after arc length l1: an arc, and the biarc from there whose
// second curvature is b's.
struct Triarc {
  Arc first;
  BiarcFamily rest;
  double p;
  [[nodiscard]] double length() const { return first.length + rest.length(p); }
};

std::optional<Triarc> triarc(const SpiralEnds& ends, double l1) {
  const Arc first{ends.a.x, ends.a.y, ends.a.theta, ends.a.kappa, l1};
  const auto rest = BiarcFamily::between(point_at(first, l1), ends.b);
  if (!rest) return {};
  const double omega = std::sin(rest->omega());
  const double p = (ends.b.kappa * rest->c - std::sin(rest->beta)) / omega;
  constexpr double kAll = 1e12;  // the first arc is all but everything
  return Triarc{first, *rest, p > 0 ? std::min(p, kAll) : kAll};
}

std::optional<SpiralArcs> as_triarc(const SpiralEnds& ends, const BiarcFamily& family, const Bilens& lens) {
  const Halves h = halves(family, lens.p1);
  const double longest = h.chord1 / sinc(0.5 * h.turning1);
  const auto excess = [&](double part) {
    const auto t = triarc(ends, part * longest);
    return (t ? t->length() : 0) - ends.length;
  };
  // Short of the whole first arc, where nothing is left to turn between the other two.
  const double part = root_between(0.0, 1 - 1e-9, excess);
  const auto found = triarc(ends, part * longest);
  if (!found || std::abs(found->length() - ends.length) > length_slack(ends)) return {};
  auto rest = found->rest.arcs(found->p);
  rest[1].kappa = ends.b.kappa;  // as it is to rounding, unless the arc is next to nothing
  return SpiralArcs{{found->first, rest[0], rest[1]}, lens.width};
}

}  // namespace

CurvePoint point_at(const Arc& arc, double s) {
  const double half = 0.5 * arc.kappa * s, chord = s * sinc(half), direction = arc.theta + half;
  return {arc.x + chord * std::cos(direction), arc.y + chord * std::sin(direction), arc.theta + 2 * half,
          arc.kappa};
}

std::optional<BiarcFamily> BiarcFamily::between(const CurvePoint& a, const CurvePoint& b) {
  const double dx = b.x - a.x, dy = b.y - a.y, chord = std::hypot(dx, dy);
  if (!(chord > 0)) return {};
  const double direction = std::atan2(dy, dx),
               alpha = std::remainder(a.theta - direction, 2 * std::numbers::pi);
  const double beta = alpha + (b.theta - a.theta);
  if (!(std::abs(beta) < std::numbers::pi && std::abs(alpha) < std::numbers::pi)) return {};
  return BiarcFamily{a.x, a.y, a.theta - alpha, 0.5 * chord, alpha, beta};  // turns as a.theta counts them
}

double BiarcFamily::first_curvature(double p) const {
  return -(std::sin(alpha) + std::sin(omega()) / p) / c;
}

double BiarcFamily::second_curvature(double p) const {
  return (std::sin(beta) + p * std::sin(omega())) / c;
}

double BiarcFamily::length(double p) const {
  const Halves h = halves(*this, p);
  return h.chord1 / sinc(0.5 * h.turning1) + h.chord2 / sinc(0.5 * h.turning2);
}

std::array<Arc, 2> BiarcFamily::arcs(double p) const {
  const Halves h = halves(*this, p);
  const Arc first = arc_over({x, y, direction + alpha, 0}, h.chord1, h.turning1);
  return {first, arc_over(point_at(first, first.length), h.chord2, h.turning2)};
}

std::optional<Bilens> bilens(const BiarcFamily& f, double kappa_a, double kappa_b) {
  const double omega = std::sin(f.omega());
  const double p1 = -omega / (kappa_a * f.c + std::sin(f.alpha));
  const double p2 = (kappa_b * f.c - std::sin(f.beta)) / omega;
  if (!(p1 > 0 && p2 >= p1 && std::isfinite(p2))) return {};
  const double reach = 1 + 2 * p2 * std::cos(f.gamma()) + p1 * p2;
  const double ab = f.c * f.c * f.first_curvature(p2) * f.second_curvature(p1);
  const double width = 4 * f.c * (p2 - p1) * std::abs(omega) /
                       (reach + std::sqrt(reach * reach + 4 * p2 * (p2 - p1) * std::max(ab, 0.0)));
  return Bilens{p1, p2, width};
}

double spiral_bound(const SpiralEnds& ends) {
  const auto family = BiarcFamily::between(ends.a, ends.b);
  if (!family) return std::numeric_limits<double>::infinity();
  if (const auto region = bilens(*family, ends.a.kappa, ends.b.kappa)) return region->width;
  const bool circular = std::abs(family->length(1) - ends.length) <= length_slack(ends);
  return circular ? lens_width(*family) : std::numeric_limits<double>::infinity();
}

std::optional<SpiralArcs> spiral_arcs(const SpiralEnds& ends, ArcOrder order) {
  const auto family = BiarcFamily::between(ends.a, ends.b);
  if (!family) return {};
  const double allowed = length_slack(ends), lens = lens_width(*family);
  const auto region = bilens(*family, ends.a.kappa, ends.b.kappa);
  if (lens <= 1e-13 * ends.length || !region) {  // a circular arc as far as rounding tells
    if (std::abs(family->length(1) - ends.length) > allowed) return {};
    const double turning = ends.b.theta - ends.a.theta;
    return SpiralArcs{{{ends.a.x, ends.a.y, ends.a.theta, turning / ends.length, ends.length}}, lens};
  }
  if (order == ArcOrder::kTriarc) return as_triarc(ends, *family, *region);
  const double p =
      root_between(region->p1, region->p2, [&](double q) { return family->length(q) - ends.length; });
  if (std::abs(family->length(p) - ends.length) > allowed) return {};
  const auto two = family->arcs(p);
  return SpiralArcs{{two[0], two[1]}, region->width};
}

ArcFit fit_arcs(const Elastica& elastica, double tolerance, ArcOrder order) {
  if (!(tolerance > 0) || !(elastica.length > 0)) {
    throw std::logic_error("fit_arcs needs a positive tolerance and length");
  }
  const ElasticaCurve curve(elastica);
  return fit_arcs_between([&](double s) { return curve.at(s); }, spiral_breaks(elastica), tolerance, order);
}

}  // namespace hotblade::elastica
