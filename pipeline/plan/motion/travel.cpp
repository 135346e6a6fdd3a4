#include "pipeline/plan/motion/travel.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "elastica/blade/blade_batch.hpp"
#include "elastica/fit/fit.hpp"
#include "elastica/quadratic/quadratic.hpp"
#include "elastica/quadratic/quadratic_tangent.hpp"

namespace hotblade::pipeline {

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using elastica::MidState;
using elastica::Quadratic;

// The corner of the block that the way goes around, as (offset, height): the first the sweep meets, on the
// waste side. Of parallel planes: exactly that corner.
Vector2d near_corner(const StripPlan& strip) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  Vector2d near(kInf, -kInf);
  const Frame plane = strip.plane(0);
  for (const Vector3d& corner : strip.block.corners()) {
    near.x() = std::min(near.x(), strip.planes.offset(corner));
    near.y() = std::max(near.y(), (corner - plane.origin).dot(plane.y));
  }
  return near;
}

// In a fan, about: up to which offset planes lie before the block, and how high it is in its middle plane.
Vector2d near_corner_of_fan(const StripPlan& strip, double from_mm) {
  constexpr double kStepMm = 1;
  const std::array<Vector3d, 8> corners = strip.block.corners();
  const double middle = 0.5 * (strip.ribs.front().offset_mm + strip.ribs.back().offset_mm);
  const Frame plane = strip.plane(middle);
  Vector2d near(from_mm, -std::numeric_limits<double>::infinity());
  for (const Vector3d& corner : corners) near.y() = std::max(near.y(), (corner - plane.origin).dot(plane.y));
  const double sense = strip.x.cross(strip.y).dot(strip.sweep) > 0 ? 1 : -1;
  for (; near.x() < middle; near.x() += kStepMm) {
    const Frame at = strip.swept_plane(near.x());
    for (const Vector3d& corner : corners)
      if (sense * at.normal().dot(corner - at.origin) <= 0) return near;
  }
  return near;
}

// The way of the blade's middle in (offset, height); the rest of the pose changes evenly along it.
struct Way {
  MidState from, home;
  Quadratic curve;
  double length = 0;

  [[nodiscard]] BladePlace place(double u) const {
    const Vector2d p = elastica::point_at(curve, elastica::parameter_at(curve, u * length));
    MidState mid = from;
    mid.x = from.x + u * (home.x - from.x);
    mid.y = p.y();
    mid.theta = from.theta + u * (home.theta - from.theta);
    return {p.x(), elastica::half_from_middle(mid), -0.5 * mid.length, mid.length, 0, 0, false};
  }
};

// How far the blade hangs below its middle, anywhere on a way: turning and shape are the same on all of them.
double hang_mm(const Way& way) {
  constexpr int kTurns = 16, kPoints = 65;
  double hang = 0;
  for (int i = 0; i <= kTurns; ++i) {
    const BladePlace place = way.place(static_cast<double>(i) / kTurns);
    const elastica::Elastica blade = elastica::segment(place.curve, place.from_mm, -place.from_mm);
    for (const auto& p : elastica::sample(blade, kPoints)) hang = std::max(hang, place.curve.y - p.y);
  }
  return hang;
}

// Straight where that stays outside the circle, otherwise around it; shortest first.
std::vector<Quadratic> around(const Vector2d& from, const Vector2d& to, const Vector2d& corner,
                              double radius) {
  const Vector2d way = to - from;
  const double on = std::clamp((corner - from).dot(way) / way.squaredNorm(), 0.0, 1.0);
  // The way leads against the sweep: the block has to lie on its left.
  const bool outside = way.x() * (corner - from).y() - way.y() * (corner - from).x() >= 0;
  if (outside && (from + on * way - corner).norm() >= radius) return {{from, (from + to) / 2, to}};
  if ((from - corner).norm() <= radius || (to - corner).norm() <= radius) return {};
  std::vector<Quadratic> curves;
  for (const auto& m :
       elastica::tangent_to_circle(from, to, corner, radius, elastica::Objective::kLength).minima) {
    if (m.regular) curves.push_back(m.curve);
  }
  return curves;
}

// Points of a blade this far apart are measured, closer ones where those before leave it open.
constexpr std::array<double, 3> kApart_mm{32, 8, 2};

std::size_t points_of(double part_mm, double apart_mm) {
  return std::max<std::size_t>(2, static_cast<std::size_t>(std::ceil(part_mm / apart_mm)) + 1);
}

// What its points leave open of a blade's part: where it may be too near to the block, and whether it is.
struct Open {
  std::optional<elastica::Part> part;
  bool hits = false;
};

// Of the part of blade `i` that its points are on. A point of it is at most half a step from one of these,
// along the blade; so is the nearest of the points between both edges, because the distance to a box is
// convex. A point that is farther off vouches for the points beside it.
Open open_of(const elastica::PartPlaces& points, std::size_t i, const elastica::Part& part,
             const Frame& frame, const Block& block, double width_mm, double clearance_mm) {
  const Vector3d across = width_mm / 2 * frame.normal();
  const double apart = (part.last - part.first) / static_cast<double>(points.points - 1);
  Open open;
  for (std::size_t k = 0; k < points.points;) {
    const Vector2d p = points.at(i, k);
    const Vector3d middle = frame.point(p.x(), p.y());
    const double mm = std::min(block.distance_mm(middle + across), block.distance_mm(middle - across)),
                 away = mm - clearance_mm - 0.5 * apart;
    if (!(mm >= clearance_mm)) return {part, true};
    if (away >= 0) {
      k += 1 + static_cast<std::size_t>(away / apart);
      continue;
    }
    const double at = part.first + apart * static_cast<double>(k);
    if (!open.part) open.part = {std::max(part.first, at - 0.5 * apart), 0};
    open.part->last = std::min(part.last, at + 0.5 * apart);
    ++k;
  }
  return open;
}

bool is_clear(const Stretch& travel, const StripPlan& strip, double width_mm, double clearance_mm) {
  std::vector<double> shares;
  for (int i = 0; i <= travel.samples; ++i) shares.push_back(static_cast<double>(i) / travel.samples);
  std::vector<BladeShape> shapes = shapes_at(travel, shares);
  std::vector<elastica::Part> parts;
  for (const BladeShape& shape : shapes) parts.push_back({0, shape.blade.length});
  for (const double apart_mm : kApart_mm) {
    std::vector<elastica::Elastica> blades;
    double longest = 0;
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      blades.push_back(shapes[i].blade);
      longest = std::max(longest, parts[i].last - parts[i].first);
    }
    const elastica::PartPlaces points = elastica::sample_places(blades, parts, points_of(longest, apart_mm));
    std::vector<BladeShape> near;
    std::vector<elastica::Part> open;
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      const Open left = open_of(points, i, parts[i], strip.swept_plane(shapes[i].offset_mm), strip.block,
                                width_mm, clearance_mm);
      if (left.hits) return false;
      if (!left.part) continue;
      near.push_back(shapes[i]);
      open.push_back(*left.part);
    }
    shapes = std::move(near);
    parts = std::move(open);
    if (shapes.empty()) return true;
  }
  return false;
}

}  // namespace

bool is_clear(const elastica::Elastica& blade, const Frame& frame, const Block& block, double width_mm,
              double clearance_mm) {
  const elastica::Part whole{0, blade.length};
  const elastica::PartPlaces points =
      elastica::sample_places({&blade, 1}, {&whole, 1}, points_of(blade.length, kApart_mm.back()));
  return !open_of(points, 0, whole, frame, block, width_mm, clearance_mm).part;
}

std::optional<Stretch> travel_home(const StripPlan& strip, const BladeShape& from, const BladeShape& home,
                                   const Settings& settings) {
  Way way{elastica::mid_state(from.blade), elastica::mid_state(home.blade), {}, 0};
  const Vector2d start(from.offset_mm, way.from.y), end(home.offset_mm, way.home.y);
  way.curve = {start, (start + end) / 2, end};
  way.length = elastica::length(way.curve);
  const double hang = hang_mm(way), half_width = settings.blade.width_mm / 2;
  const Vector2d near = strip.planes.turns() ? near_corner_of_fan(strip, home.offset_mm) : near_corner(strip);
  // A fan's offsets are no distances, and its planes see the block tilted: its corner may have to be taken as
  // higher than it is in the middle plane.
  constexpr std::array<double, 6> kRaises_mm{0, 25, 50, 100, 200, 400};
  const std::size_t raises = strip.planes.turns() ? kRaises_mm.size() : 1;
  for (std::size_t i = 0; i < raises; ++i) {
    const Vector2d corner(near.x() - half_width, near.y() + hang + kRaises_mm[i]);
    // The points between which a clearance is measured take away half a step; a larger circle makes up for
    // it, and for the corner on the other side where that is the nearer one.
    for (const double more_mm : {2.0, 10.0, 50.0}) {
      for (const Quadratic& curve : around(start, end, corner, settings.stock.clearance_mm + more_mm)) {
        way.curve = curve;
        way.length = elastica::length(curve);
        const Stretch travel{StripPhase::kTravel, false, 200, [way](double u) { return way.place(u); }};
        if (is_clear(travel, strip, settings.blade.width_mm, settings.stock.clearance_mm)) return travel;
      }
    }
  }
  return std::nullopt;
}

}  // namespace hotblade::pipeline
