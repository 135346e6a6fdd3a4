#include "elastica/blade/equilibria.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <tuple>

#include "elastica/blade/end_map.hpp"
#include "elastica/blade/equilibria_cells.hpp"
#include "elastica/blade/stability.hpp"

namespace hotblade::elastica {

namespace {

using cells::Cell;
using cells::Swing;
using cells::Target;
using Eigen::Vector3d;

// A blade of length 1 from the origin along the x axis.
struct Unit {
  ClampPair clamps;
  Target target;
};

Unit unit_problem(const ClampPair& c, double length, bool mirrored) {
  const double dx = (c.b.x - c.a.x) / length, dy = (c.b.y - c.a.y) / length;
  const double co = std::cos(c.a.theta), si = std::sin(c.a.theta), sign = mirrored ? -1 : 1;
  Unit u;
  u.clamps.b = {co * dx + si * dy, sign * (co * dy - si * dx), sign * (c.b.theta - c.a.theta)};
  u.target = {std::hypot(u.clamps.b.x, u.clamps.b.y), std::atan2(u.clamps.b.y, u.clamps.b.x),
              u.clamps.b.theta};
  return u;
}

Vector3d vector_of(const Swing& s) {
  return {s.kappa, s.lambda1, s.lambda2};
}

// Difference of two start states as a curvature: a force bends by its moment.
double distance(const Vector3d& a, const Vector3d& b) {
  const Vector3d d = (a - b).cwiseAbs();
  return d[0] + 0.5 * (d[1] + d[2]);
}

// What a cell spans in start states, for one type.
struct Span {
  Vector3d middle;
  double by_psi = 0, by_w = 0;
  [[nodiscard]] double radius() const { return 0.5 * (by_psi + by_w); }
};

Span span_of(const Cell& c, int n, const Target& target) {
  const double psi = 0.5 * (c.psi0.lo + c.psi0.hi), w = 0.5 * (c.w.lo + c.w.hi);
  const auto at = [&](double p, double q) { return vector_of(swing_at(p, q, c.above, n, target)); };
  return {at(psi, w), distance(at(c.psi0.lo, w), at(c.psi0.hi, w)),
          distance(at(psi, c.w.lo), at(psi, c.w.hi))};
}

class Search {
 public:
  Search(const ClampPair& clamps, double length, const EquilibriaOptions& options)
      : clamps_(clamps), length_(length), options_(options) {}

  EquilibriaReport run() {
    for (const bool mirrored : {false, true}) {
      unit_ = unit_problem(clamps_, length_, mirrored);
      mirrored_ = mirrored;
      if (unit_.target.r < 1) search();
      try_start({0, 0, 0, unit_.target.turning, 0, 0, 1});  // the circle, and the straight blade
    }
    std::sort(report_.equilibria.begin(), report_.equilibria.end(), [](const auto& a, const auto& b) {
      return std::tie(a.energy, a.elastica.kappa) < std::tie(b.energy, b.elastica.kappa);
    });
    return report_;
  }

 private:
  void search() {
    const double energy = options_.max_energy * length_;
    const int most = std::min(options_.max_inflections, cells::inflection_bound(unit_.target, energy));
    report_.taut += cells::taut_solutions(unit_.target, most, energy);
    std::vector<Cell> open = cells::initial_cells(unit_.target, most);
    while (!open.empty()) {
      Cell cell = open.back();
      open.pop_back();
      ++report_.cells;
      cell.types = possible_types(cell, unit_.target, energy);
      if (cell.types == 0) continue;
      const Span lead = span_of(cell, std::countr_zero(cell.types), unit_.target);
      resolve(cell);
      if (cell.types == 0) continue;
      // Beyond this many cells the clamps hold no blade in any useful sense.
      constexpr int kMostCells = 500'000;
      if (report_.cells > kMostCells) {
        ++report_.unresolved;
        continue;
      }
      split(cell, lead, open);
    }
  }

  // Starts Newton's method from the types whose start states the cell tells well enough, and drops those
  // whose answer lies in the cell's surroundings.
  void resolve(Cell& cell) {
    // Spans, in units of curvature times length, from which Newton's method reaches what is there, and below
    // which two solutions or none are told apart no further.
    constexpr double kTry = 0.4, kGiveUp = 1e-5, kGiveUpWidth = 1e-3;
    const double width = std::max(cell.psi0.hi - cell.psi0.lo, cell.w.hi - cell.w.lo);
    for (int n = 0; n <= kMaxInflections; ++n) {
      if (!(cell.types >> n & 1)) continue;
      const Span span = span_of(cell, n, unit_.target);
      if (!(span.radius() < kTry)) continue;
      const bool taut = beyond_tension(span.middle);
      const bool found = !taut && solution_within(span);
      const bool given_up = !found && !taut && span.radius() < kGiveUp && width < kGiveUpWidth;
      report_.taut += taut ? 1 : 0;
      report_.unresolved += given_up ? 1 : 0;
      if (found || taut || given_up) cell.types &= ~(std::uint64_t{1} << n);
    }
  }

  [[nodiscard]] bool beyond_tension(const Vector3d& p) const {
    return p[1] * unit_.clamps.b.x + p[2] * unit_.clamps.b.y < -kLargestTension;
  }

  // Whether a solution lies in the span's surroundings; it is kept then.
  bool solution_within(const Span& span) {
    constexpr double kAround = 3;
    const Elastica start{0, 0, 0, span.middle[0], span.middle[1], span.middle[2], 1};
    const JacobiFields end = end_map(start);
    const PlanarPose& b = unit_.clamps.b;
    const Vector3d miss(b.x - end.point.x, b.y - end.point.y, b.theta - end.point.theta);
    const Vector3d step = end.fields.partialPivLu().solve(miss);
    // A first step that leads away: not worth the rest.
    if (!(distance(step, Vector3d::Zero()) < kAround * (span.radius() + kSame))) return false;
    const std::optional<Vector3d> found = try_start(start);
    return found && distance(*found, span.middle) < kAround * (span.radius() + kSame);
  }

  static void split(const Cell& cell, const Span& span, std::vector<Cell>& open) {
    // Start states tell which side to halve; where they do not differ, outside the domain, the cell's own
    // shape does.
    constexpr double kShape = 0.05;
    const double across = span.by_psi + kShape * (cell.psi0.hi - cell.psi0.lo);
    const double along = span.by_w + kShape * (cell.w.hi - cell.w.lo);
    Cell a = cell, b = cell;
    cells::Interval Cell::*const side = across > along ? &Cell::psi0 : &Cell::w;
    (a.*side).hi = (b.*side).lo = 0.5 * ((cell.*side).lo + (cell.*side).hi);
    open.push_back(a);
    open.push_back(b);
  }

  // Newton's method from a start state; the solution is kept when it is wanted and new, and returned in any
  // case.
  std::optional<Vector3d> try_start(const Elastica& start) {
    const std::optional<ClampedShape> shape = solve_clamped(start, unit_.clamps);
    if (!shape) return std::nullopt;
    const Elastica& e = shape->elastica;
    const Vector3d p(e.kappa, e.lambda1, e.lambda2);
    const double sign = mirrored_ ? -1 : 1;
    const Vector3d own(sign * p[0], p[1], sign * p[2]);
    for (const Vector3d& known : known_) {
      if (distance(own, known) < kSame * (1 + own.cwiseAbs().maxCoeff())) return p;
    }
    known_.push_back(own);
    keep(own);
    return p;
  }

  void keep(const Vector3d& p) {
    const double co = std::cos(clamps_.a.theta), si = std::sin(clamps_.a.theta), l2 = length_ * length_;
    Equilibrium q;
    q.elastica = {clamps_.a.x,
                  clamps_.a.y,
                  clamps_.a.theta,
                  p[0] / length_,
                  (co * p[1] - si * p[2]) / l2,
                  (si * p[1] + co * p[2]) / l2,
                  length_};
    const JacobiFields end = end_map({0, 0, 0, p[0], p[1], p[2], 1});
    // kappa^2/2 - lambda . (cos, sin) is constant along the curve.
    q.energy = (0.5 * p[0] * p[0] - p[1] + p[1] * end.point.x + p[2] * end.point.y) / length_;
    q.stable = end.index == 0;
    q.inflections = count_inflections(q.elastica);
    if (q.inflections > options_.max_inflections || q.energy > options_.max_energy) return;
    q.margin = stability_margin(q.elastica);
    report_.equilibria.push_back(q);
  }

  // Newton's method is exact to 1e-9 or better, and two solutions this close are one shape to a clamp.
  static constexpr double kSame = 1e-5;

  ClampPair clamps_;
  double length_;
  EquilibriaOptions options_;
  Unit unit_;
  bool mirrored_ = false;
  std::vector<Vector3d> known_;
  EquilibriaReport report_;
};

}  // namespace

EquilibriaReport find_equilibria(const ClampPair& c, double length, const EquilibriaOptions& options) {
  for (const double v : {c.a.x, c.a.y, c.a.theta, c.b.x, c.b.y, c.b.theta, length}) {
    if (!std::isfinite(v)) throw std::logic_error("clamp poses and length must be finite");
  }
  if (!(length > 0)) throw std::logic_error("a blade needs a length");
  if (options.max_inflections < 0 || options.max_inflections > kMaxInflections ||
      std::isnan(options.max_energy)) {
    throw std::logic_error("limits of the search are out of range");
  }
  return Search(c, length, options).run();
}

int count_inflections(const Elastica& elastica) {
  // Curvature below this, of the largest possible one, is an end that happens to be an inflection.
  constexpr double kZero = 1e-9;
  const double zero = kZero * taylor_rate(elastica.theta, elastica.kappa, elastica.lambda1, elastica.lambda2);
  int count = 0, sign = 0;
  const auto pass = [&](double kappa) {
    const int here = kappa > zero ? 1 : kappa < -zero ? -1 : 0;
    if (here * sign < 0) ++count;
    if (here != 0) sign = here;
  };
  pass(elastica.kappa);
  for (const JacobiFields& f : jacobi_fields(elastica)) pass(f.point.kappa);
  return count;
}

}  // namespace hotblade::elastica
