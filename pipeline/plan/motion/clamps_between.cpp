#include "pipeline/plan/motion/clamps_between.hpp"

#include <algorithm>
#include <limits>

#include "elastica/curve/elastica.hpp"
#include "pipeline/plan/ribs/strip_plan.hpp"

namespace hotblade::pipeline {

namespace {

using Eigen::Vector3d;

constexpr int kQuarters = 4;

// A point's distance from a box with a corner at 0, and the plane through the box's nearest point square to
// the way there: the box lies behind it.
struct BoxDistance {
  double mm = 0;
  Vector3d nearest{0, 0, 0}, outwards{0, 0, 0};

  BoxDistance(const Vector3d& p, const Vector3d& size_mm) : nearest(p.cwiseMax(0).cwiseMin(size_mm)) {
    const Vector3d away = p - nearest;
    mm = away.norm();
    if (mm > 0) outwards = away / mm;
  }
  // No point is nearer to the box than to the plane.
  [[nodiscard]] double at_least_mm(const Vector3d& p) const { return outwards.dot(p - nearest); }
};

// A bound from below of the distance from a box, all the way from p to q straight ahead.
double least_between(const Vector3d& p, const Vector3d& q, const Vector3d& size_mm) {
  const BoxDistance at_p(p, size_mm), at_q(q, size_mm);
  // Two lines over the way; the larger of both is convex, so least at an end or where they cross.
  const double p_end = at_p.at_least_mm(q), q_start = at_q.at_least_mm(p);
  const double at_start = at_p.mm - q_start, at_end = at_q.mm - p_end;  // by which one is above the other
  if (!(at_start + at_end > 0)) return std::min(at_p.mm, at_q.mm);
  const double share = at_start / (at_start + at_end);
  return at_p.mm + share * (p_end - at_p.mm);
}

}  // namespace

class ClampsBetween::Search {
 public:
  Search(const ClampsBetween& of, double length_mm, double share, double enough_mm)
      : of_(of), length_mm_(length_mm), share_(share), enough_mm_(enough_mm) {}

  Clearance run() {
    std::optional<Clamps> start = look(of_.places_.front());
    for (std::size_t i = 0; start && i + 2 < of_.places_.size(); i += 2) {
      least_.after = static_cast<int>(i / kQuarters);
      const std::optional<Clamps> middle = look(of_.places_[i + 1]), end = look(of_.places_[i + 2]);
      if (!middle || !end) break;
      divide(of_.places_[i].offset_mm, of_.places_[i + 2].offset_mm, *start, *middle, *end);
      start = end;
      if (!(least_.mm >= enough_mm_)) break;
    }
    return least_;
  }

 private:
  // Where the clamps are; none where they are too near already, or the blade winds up.
  [[nodiscard]] std::optional<Clamps> look(const Place& place) {
    if (winds_up(place.rib, length_mm_)) {
      least_.mm = 0;
      return std::nullopt;
    }
    const elastica::ElasticaCurve curve(extended(from_mid_state(place.rib), length_mm_, share_));
    Clamps clamps;
    for (std::size_t k = 0; k < clamps.size(); ++k) {
      const elastica::CurvePoint end = curve.at(k == 0 ? 0 : length_mm_);
      clamps[k] = of_.block_.local(place.plane.point(end.x, end.y));
      least_.mm = std::min(least_.mm, BoxDistance(clamps[k], of_.block_.size_mm).mm);
    }
    if (!(least_.mm >= enough_mm_)) return std::nullopt;
    return clamps;
  }

  // Both halves of a way whose middle was looked at.
  void divide(double from_mm, double to_mm, const Clamps& start, const Clamps& middle, const Clamps& end) {
    // A half of a smooth way bulges by a quarter of what the whole does.
    constexpr double kBulge = 0.25;
    Clamps bulge;
    for (std::size_t k = 0; k < bulge.size(); ++k)
      bulge[k] = kBulge * (middle[k] - 0.5 * (start[k] + end[k]));
    const double half_mm = 0.5 * (from_mm + to_mm);
    search(from_mm, half_mm, start, middle, bulge);
    search(half_mm, to_mm, middle, end, bulge);
  }

  void search(double from_mm, double to_mm, const Clamps& start, const Clamps& end, const Clamps& bulge) {
    constexpr double kShort_mm = 1;
    bool settled = true;
    for (std::size_t k = 0; k < start.size(); ++k) {
      const double bound_mm = least_between(start[k], end[k], of_.block_.size_mm) - bulge[k].norm();
      settled = settled && (bound_mm >= enough_mm_ || (end[k] - start[k]).norm() <= kShort_mm);
    }
    if (settled || !(least_.mm >= enough_mm_)) return;
    const std::optional<Clamps> middle = look(of_.place_at(0.5 * (from_mm + to_mm)));
    if (middle) divide(from_mm, to_mm, start, *middle, end);
  }

  const ClampsBetween& of_;
  double length_mm_, share_, enough_mm_;
  Clearance least_{std::numeric_limits<double>::infinity(), 0};
};

ClampsBetween::ClampsBetween(const std::vector<RibFit>& ribs, const RibAxes& axes, const Block& block)
    : axes_(axes), block_(block), spline_(ribs) {
  places_.push_back(place_at(ribs.front().offset_mm));
  for (std::size_t i = 0; i + 1 < ribs.size(); ++i) {
    const double from = ribs[i].offset_mm, gap = ribs[i + 1].offset_mm - from;
    for (int quarter = 1; quarter <= kQuarters; ++quarter)
      places_.push_back(place_at(from + gap * quarter / kQuarters));
  }
}

ClampsBetween::Place ClampsBetween::place_at(double offset_mm) const {
  return {offset_mm, spline_.mid_at(offset_mm), axes_.plane(offset_mm)};
}

ClampsBetween::Clearance ClampsBetween::least(double length_mm, double share, double enough_mm) const {
  return Search(*this, length_mm, share, enough_mm).run();
}

}  // namespace hotblade::pipeline
