#include "pipeline/plan/suggestions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "pipeline/plan/ribs/rib_fit.hpp"
#include "pipeline/sayings/saying.hpp"
#include "surface/read/design_surface.hpp"

namespace hotblade::pipeline {

namespace {

// More strips than a day cuts are not odd for a building, but worth a word; more than a year cuts are no unit
// to think of.
constexpr std::size_t kManyStrips = 50, kTooManyStrips = 1000;

// More of it than this is lost in the best of planes: what is left is no job.
constexpr double kMostlyLost = 0.5;

// Clamps that stand at their clearance on both sides are as far apart as a part of this size.
double least_extent_mm(const Settings& settings) {
  return 2 * settings.stock.clearance_mm;
}

bool along_z(const Settings& settings) {
  return settings.design.keep == Keep::kBelow || settings.design.keep == Keep::kAbove;
}

// Whether another axis than the one given is up: a surface that a blade sweeps from above faces upwards for
// the most part; a solid has sides as well.
bool faces_along_y(const Shape& shape) {
  constexpr double kMostOfIt = 0.8, kMoreThanTheSides = 1.5;
  if (!shape.facing) return shape.upright && shape.seen.y() > kMostOfIt;
  return shape.seen.y() > kMoreThanTheSides * std::max(shape.seen.x(), shape.seen.z());
}

std::string vector_text(const std::array<double, 3>& v) {
  return fmt::format("[{:g}, {:g}, {:g}]", v[0], v[1], v[2]);
}

// Units by whose scale the design is larger or smaller, and neither too small nor of more than `most` strips.
std::vector<OtherUnit> units_that_suit(const Shape& shape, const Settings& settings, bool larger,
                                       std::size_t most) {
  std::vector<OtherUnit> others;
  for (const char* units : {"mm", "cm", "m", "in", "ft"}) {
    const double scale = surface::scale_to_mm(units) / surface::scale_to_mm(shape.units);
    if (scale == 1 || (scale > 1) != larger) continue;
    OtherUnit other{units, scale * shape.size_mm,
                    strips_lower_bound(scale * scale * shape.area_mm2, settings)};
    const bool bends = scale * shape.radius_mm >= shape.blade_radius_mm;
    if (bends && other.size_mm.maxCoeff() >= least_extent_mm(settings) && other.strips_lower_bound <= most)
      others.push_back(std::move(other));
  }
  return others;
}

// Four digits, and all of those before the point.
std::string size_text(double mm) {
  return mm < 1000 ? fmt::format("{:.4g}", mm) : fmt::format("{:.0f}", mm);
}

std::string axis_up(const Shape& shape) {
  return shape.up == 'z' ? "y" : "z";
}

// Of the shape alone, whatever the unit.
std::vector<Suggestion> of_faces(const Shape& shape, const Settings& settings) {
  std::vector<Suggestion> list;
  const bool lies = along_z(settings) && faces_along_y(shape);
  const std::string up = "design.up=" + axis_up(shape), upper = "design.facing=[0, 0, 1]",
                    back = "design.keep=back";
  const bool leans_nowhere = along_z(settings) && shape.upright;
  if (shape.facing) {
    if (lies) list.push_back({{up, upper}, say(Saying::kSolidAlongY)});
    const bool upwards = *shape.facing == std::array<double, 3>{0, 0, 1};
    Suggestion side{
        {"design.facing=" + vector_text(*shape.facing)},
        upwards ? say(Saying::kSolidUpperFaces) : say(Saying::kSolidFaces, {vector_text(*shape.facing)})};
    if (leans_nowhere) side.assignments.push_back(back);
    list.push_back(std::move(side));
    return list;
  }
  if (lies) list.push_back({{up}, say(Saying::kFacesAlongY, {axis_up(shape)})});
  if (leans_nowhere) list.push_back({{back}, say(Saying::kStandsUpright)});
  return list;
}

}  // namespace

bool is_mostly_lost(const Shape& shape) {
  return shape.lost_share > kMostlyLost;
}

std::optional<std::string> planes_warning(const Shape& shape) {
  if (is_mostly_lost(shape) || shape.lost_in_given.value_or(0) <= kMostlyLost) return std::nullopt;
  return say(Saying::kMostlyLostGiven, {100 * *shape.lost_in_given});
}

bool is_of_usual_size(const Shape& shape, const Settings& settings) {
  return shape.size_mm.maxCoeff() >= least_extent_mm(settings) && !is_mostly_lost(shape) &&
         strips_lower_bound(shape.area_mm2, settings) <= kManyStrips;
}

std::optional<OddSize> odd_size(const Shape& shape, const Settings& settings) {
  const double extent = shape.size_mm.maxCoeff();
  const std::size_t strips = strips_lower_bound(shape.area_mm2, settings);
  OddSize odd;
  odd.hopeless = true;
  if (extent < least_extent_mm(settings)) {
    odd.why = say(Saying::kSmallExtent, {extent, least_extent_mm(settings)});
    odd.others = units_that_suit(shape, settings, true, kTooManyStrips);
    return odd;
  }
  if (is_mostly_lost(shape)) {
    odd.why = say(Saying::kMostlyLost, {100 * shape.lost_share});
    odd.others = units_that_suit(shape, settings, true, kTooManyStrips);
    if (odd.others.empty()) return std::nullopt;  // whatever the unit: that is its shape
    return odd;
  }
  if (strips <= kManyStrips) return std::nullopt;
  // Large alone is no reason against it: where it is too large, the plan says so.
  odd.hopeless = false;
  odd.why = say(Saying::kStripsAtLeast, {extent, strips});
  odd.others = units_that_suit(shape, settings, false, kManyStrips);
  if (odd.others.empty()) return std::nullopt;
  return odd;
}

std::string describe(const OddSize& odd) {
  std::string others;
  for (const OtherUnit& other : odd.others) {
    const Eigen::Vector3d& size = other.size_mm;
    const std::string x = size_text(size.x()), y = size_text(size.y()), z = size_text(size.z());
    const std::string one =
        other.strips_lower_bound > kManyStrips
            ? say(Saying::kIfInUnitStrips, {x, y, z, other.units, other.strips_lower_bound})
            : say(Saying::kIfInUnit, {x, y, z, other.units});
    others = others.empty() ? one : say(Saying::kAnd, {others, one});
  }
  return others.empty() ? say(Saying::kIsThatTheUnit, {odd.why})
                        : say(Saying::kIsThatTheUnitOthers, {odd.why, others});
}

std::vector<std::string> reasons(const Shape& shape, const Settings& settings) {
  std::vector<std::string> list;
  if (shape.facing)
    list.push_back(
        fmt::format("the design is closed, and a blade cuts one side of it: most, {:.0f} % of "
                    "the area, looks towards {}",
                    100 * shape.facing_share, vector_text(*shape.facing)));
  if (!along_z(settings)) return list;
  if (faces_along_y(shape)) list.emplace_back("most of the design faces along y");
  if (shape.upright)
    list.push_back(fmt::format("design.keep = \"{}\" says nothing about a surface that stands upright",
                               name(settings.design.keep)));
  return list;
}

std::vector<Suggestion> suggestions(const Shape& shape, const std::optional<OddSize>& odd,
                                    const Settings& settings) {
  // A plan takes some tenths of a second for each: units of more strips are said, and left to a plan of
  // their own.
  constexpr std::size_t kMostTried = 16;
  std::vector<Suggestion> list;
  const std::vector<Suggestion> faces = of_faces(shape, settings);
  if (odd && settings.design.format != "gltf") {  // which is in metres
    for (const OtherUnit& other : odd->others) {
      if (other.strips_lower_bound > kMostTried) continue;
      Suggestion change{{"design.units=" + other.units}, odd->why};
      if (!faces.empty()) {
        const Suggestion& first = faces.front();
        change.assignments.insert(change.assignments.end(), first.assignments.begin(),
                                  first.assignments.end());
        change.why = say(Saying::kAlso, {change.why, first.why});
      }
      list.push_back(std::move(change));
    }
  }
  list.insert(list.end(), faces.begin(), faces.end());
  return list;
}

std::size_t strips_lower_bound(double area_mm2, const Settings& settings) {
  const auto& size = settings.stock.max_size_mm;
  const Eigen::Vector3d most(size[0], size[1], size[2]);
  const double sweep = settings.slice.fan_axis ? 0.5 * std::numbers::pi * most.norm() : most.maxCoeff();
  const double covered = settings.blade.free_lengths_mm.back() * sweep / std::cos(kMaxSlopeRad);
  constexpr double kRounding = 1e-9;
  const double share = 1 - settings.design.max_uncut_share;
  return static_cast<std::size_t>(std::max(1.0, std::ceil(share * area_mm2 / covered - kRounding)));
}

}  // namespace hotblade::pipeline
