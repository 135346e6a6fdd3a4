#include "pipeline/plan/arms/strip_clearance.hpp"

#include <algorithm>
#include <cmath>

#include "elastica/curve/elastica.hpp"
#include "gpu/backend/stop.hpp"
#include "pipeline/sayings/saying.hpp"

namespace hotblade::pipeline {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using robot::Standing;

// The blade's chords leave it by no more than this, and a tool holds this much of it.
constexpr double kChordSag_mm = 0.2, kHeldBlade_mm = 60;
constexpr std::size_t kMostChords = 512;

Isometry3d in_cell(const Pose& pose) {
  Isometry3d place = Isometry3d::Identity();
  place.linear() = pose.q.toRotationMatrix();
  place.translation() = pose.p;
  return place;
}

Isometry3d axes_of(const Frame& frame) {
  Isometry3d place = Isometry3d::Identity();
  place.linear().col(0) = frame.x;
  place.linear().col(1) = frame.y;
  place.linear().col(2) = frame.normal();
  place.translation() = frame.origin;
  return place;
}

robot::Shape box_at(const Isometry3d& place, const Vector3d& size_mm) {
  return {place, robot::Box{size_mm}};
}

// Under the block down to the table, `inset_mm` smaller on every side; as large as the block where that
// leaves nothing.
void add_plinth(std::vector<Standing>& all, const Isometry3d& middle, const Vector3d& size, double inset_mm) {
  int up = 0;
  middle.linear().row(2).cwiseAbs().maxCoeff(&up);
  const Vector3d spread = middle.linear().row(2).cwiseAbs().transpose().cwiseProduct(size) / 2;
  const double height = middle.translation().z() - spread.sum();
  if (height <= 0) return;
  Vector3d foot = size;
  for (int i = 0; i < 3; ++i) {
    if (i != up && size[i] > 2 * inset_mm) foot[i] -= 2 * inset_mm;
  }
  foot[up] = height;
  Isometry3d place = middle;
  place.translation().z() = height / 2;
  all.push_back({Standing::What::kPlinth, "the plinth", {box_at(place, foot)}});
}

std::vector<Standing> block_and_plinth(const Block& block, const Pose& design_to_cell, double inset_mm) {
  std::vector<Standing> all;
  const Isometry3d middle =
      in_cell(design_to_cell) * axes_of(block.frame) * Eigen::Translation3d(block.size_mm / 2);
  all.push_back({Standing::What::kBlock, "the block", {box_at(middle, block.size_mm)}});
  add_plinth(all, middle, block.size_mm, inset_mm);
  return all;
}

robot::Shape shape_of(const robot::Obstacle& obstacle) {
  robot::Shape shape = obstacle.shape;
  shape.place = in_cell(obstacle.at) * shape.place;
  return shape;
}

double largest_curvature(const Strip& strip) {
  double largest = 1e-6;
  for (const BladePose& pose : strip.poses)
    largest = std::max(largest, elastica::ElasticaCurve(pose.blade).max_abs_curvature());
  return largest;
}

// Arc lengths of the band's stations, those of the tools' ends among them.
struct Stations {
  std::vector<double> s;
  std::size_t free_from = 0, free_to = 0;
  double sag_mm = 0;
};

Stations stations_of(double length, double curvature) {
  const double held = std::min(kHeldBlade_mm, length / 2);
  const double chord = std::sqrt(8 * kChordSag_mm / curvature);
  Stations stations;
  double longest = 0;
  const auto add = [&](double from, double to) {
    if (to <= from) return;
    const double wanted = std::ceil((to - from) / chord);
    const auto count = static_cast<std::size_t>(std::clamp(wanted, 1.0, static_cast<double>(kMostChords)));
    const double step = (to - from) / static_cast<double>(count);
    longest = std::max(longest, step);
    for (std::size_t i = 0; i < count; ++i) stations.s.push_back(from + step * static_cast<double>(i));
  };
  add(0, held);
  stations.free_from = stations.s.size();
  add(held, length - held);
  stations.free_to = stations.s.size();
  add(length - held, length);
  stations.s.push_back(length);
  stations.sag_mm = curvature * longest * longest / 8;
  return stations;
}

}  // namespace

std::vector<Standing> surroundings(const Strip& strip, const robot::Cell& cell) {
  std::vector<Standing> all = block_and_plinth(strip.block, strip.design_to_cell, cell.plinth_inset_mm);
  if (cell.table_mm) {
    Isometry3d place = Isometry3d::Identity();
    place.translation().z() = -cell.table_mm->z() / 2;
    all.push_back({Standing::What::kTable, "the table", {box_at(place, *cell.table_mm)}});
  }
  for (const robot::Obstacle& obstacle : cell.obstacles)
    all.push_back({Standing::What::kObstacle, obstacle.id, {shape_of(obstacle)}});
  return all;
}

FreePlaces::FreePlaces(const robot::Cell& cell) : cell_(cell) {
  for (const robot::Obstacle& obstacle : cell.obstacles)
    obstacles_.emplace_back(std::vector<robot::Shape>{shape_of(obstacle)});
}

bool FreePlaces::operator()(const Block& block, const Pose& design_to_cell) const {
  if (obstacles_.empty()) return true;
  const double least = cell_.clearances.others_mm;
  const Isometry3d here = Isometry3d::Identity();
  for (const Standing& standing : block_and_plinth(block, design_to_cell, cell_.plinth_inset_mm)) {
    const robot::Solid solid(standing.shapes);
    for (const robot::Solid& obstacle : obstacles_) {
      if (distance_mm(solid, here, obstacle, here, least) < least) return false;
      if (one_inside_other(solid, here, obstacle, here)) return false;
    }
  }
  return true;
}

robot::CellPath cell_path(const Strip& strip, const robot::BladeSection& blade, const HeldJoints& held) {
  robot::CellPath path;
  path.arm_at_a = held.arm[0];
  for (std::size_t clamp = 0; clamp < 2; ++clamp) path.joints[held.arm[clamp]] = held.joints[clamp];
  const Stations stations = stations_of(strip.blade_length_mm, largest_curvature(strip));
  path.blade.free_from = stations.free_from;
  path.blade.free_to = stations.free_to;
  path.blade.skin_mm = stations.sag_mm + blade.thickness_mm / 2;
  const Isometry3d place = in_cell(strip.design_to_cell);
  for (const BladePose& pose : strip.poses) {
    path.t.push_back(pose.t);
    const elastica::ElasticaCurve curve(pose.blade);
    const Vector3d edge = pose.frame.normal() * (blade.width_mm / 2);
    std::vector<Vector3d>& corners = path.blade.corners.emplace_back();
    for (const double s : stations.s) {
      const elastica::CurvePoint point = curve.at(s);
      const Vector3d p = pose.frame.point(point.x, point.y);
      corners.push_back(place * Vector3d(p - edge));
      corners.push_back(place * Vector3d(p + edge));
    }
  }
  return path;
}

robot::Clearance prove_clear(const Strip& strip, const robot::BladeSection& blade, const robot::Cell& cell,
                             const HeldJoints& held) {
  return robot::prove_clear(cell, surroundings(strip, cell), cell_path(strip, blade, held), gpu::stop_point);
}

std::string describe(const robot::Contact& contact, const Strip& strip) {
  if (!contact.proved) {
    return say(Saying::kNotProvedClear,
               {contact.first, contact.second, contact.clearance_mm, strip.poses[contact.pose].t,
                strip.poses[contact.pose + 1].t, contact.bound_mm});
  }
  return say(Saying::kTooNear, {contact.first, contact.distance_mm, contact.second, contact.clearance_mm,
                                contact.clearance_mm - contact.distance_mm});
}

std::string when(const robot::Contact& contact, const Strip& strip) {
  const BladePose& pose = strip.poses[contact.pose];
  return say(Saying::kInPhase, {name(pose.phase), pose.t});
}

}  // namespace hotblade::pipeline
