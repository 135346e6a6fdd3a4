#include "pipeline/plan/sweep/sweep_sag.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "elastica/blade/blade_batch.hpp"
#include "pipeline/plan/ribs/rib_fit.hpp"
#include "robot/blade/blade_section.hpp"

namespace hotblade::pipeline {

namespace {

constexpr std::size_t kNodes = 64;  // cells across a blade

// Gravity on the axes of the plane at an offset, its sweep last: the planes' middle lies level.
Eigen::Vector3d down_at(double offset_mm, double middle_mm, const RibAxes& axes) {
  if (!axes.planes.turns()) return Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d down = axes.planes.normal(middle_mm);
  const Frame plane = axes.plane(offset_mm);
  return {down.dot(plane.x), down.dot(plane.y), down.dot(axes.planes.normal(offset_mm))};
}

// What a blade sags in its plane if only its stiffness holds it, where it is too straight to stand as an arch
// or to hang as a chain: by more than it rises over its chord. To first order in a load the ends hold it
// then, with a force that no clamp keeps up.
double slack_sag_mm(const elastica::ElasticaCurve& curve, const Eigen::Vector3d& down,
                    const robot::Blade& section) {
  constexpr int kPlaces = 16;
  constexpr double kClampedBeam = 384;
  const double length = curve.elastica().length;
  const double sag = robot::weight_n_mm(section) * down.head<2>().norm() * std::pow(length, 4) /
                     (kClampedBeam * robot::bending_stiffness_n_mm2(section));
  const Eigen::Vector2d start = curve.at(0).position(), chord = curve.at(length).position() - start;
  double rise = 0;
  for (int i = 1; i < kPlaces; ++i) {
    const Eigen::Vector2d off = curve.at(length * i / kPlaces).position() - start;
    rise = std::max(rise, std::abs(chord.x() * off.y() - chord.y() * off.x()) / chord.norm());
  }
  return rise < sag ? sag : 0;
}

SweepSag::Value between(const SweepSag::Value& p, const SweepSag::Value& q, double t) {
  return {(1 - t) * p.droop_mm + t * q.droop_mm, (1 - t) * p.twist_rad + t * q.twist_rad,
          (1 - t) * p.theta + t * q.theta};
}

}  // namespace

SweepSag::SweepSag(const SweepFamily& family, const RibAxes& axes, const SweepBlade& blade,
                   const robot::Blade& section)
    : first_mm_(family.first_mm),
      last_mm_(family.last_mm),
      half_width_mm_(0.5 * section.width_mm),
      blade_(blade),
      margin_(std::numeric_limits<double>::infinity()) {
  const double reach = 2 * std::max(blade.before_mm, blade.length_mm - blade.before_mm);
  const auto offset_at = [&](std::size_t k) {
    return first_mm_ + (last_mm_ - first_mm_) * static_cast<double>(k) / (kPlaces - 1);
  };
  for (std::size_t k = 0; k < kPlaces; ++k) {
    if (!winds_up(family.mid_state(offset_at(k), reach), reach)) continue;
    stable_ = false;
    margin_ = -std::numeric_limits<double>::infinity();
    return;
  }
  std::vector<elastica::Elastica> shapes;
  std::vector<Eigen::Vector3d> down;
  for (std::size_t k = 0; k < kPlaces; ++k) {
    shapes.push_back(segment(from_mid_state(family.mid_state(offset_at(k), reach)),
                             0.5 * reach - blade.before_mm, 0.5 * reach - blade.before_mm + blade.length_mm));
    down.push_back(down_at(offset_at(k), 0.5 * (first_mm_ + last_mm_), axes));
  }
  std::array<double, kPlaces> margins{};
  elastica::stability_margins(shapes, margins);
  margin_ = *std::min_element(margins.begin(), margins.end());
  const std::vector<robot::SagProfile> sags = robot::sag_profiles(shapes, section, down);
  const std::vector<elastica::Part> whole(kPlaces, {0, blade.length_mm});
  const elastica::PartPoints points = elastica::sample_parts(shapes, whole, kNodes + 1);
  for (std::size_t k = 0; k < kPlaces; ++k) {
    const robot::SagProfile& sag = sags[k];
    stable_ = stable_ && sag.stable;
    const double slack_mm =
        axes.planes.turns() ? slack_sag_mm(elastica::ElasticaCurve(shapes[k]), down[k], section) : 0;
    nodes_[k].reserve(kNodes + 1);
    for (std::size_t i = 0; i <= kNodes; ++i) {
      const double share = static_cast<double>(i) / kNodes;
      const auto x_mm = static_cast<float>(points.at(k, i).x());
      // Ends may turn back; what lies inwards of them in x stays a graph.
      if (!nodes_[k].empty() && x_mm <= nodes_[k].back().x_mm) continue;
      const auto value = sag.at(share);
      const double theta = shapes[k].theta + points.turn[k * points.points + i];
      nodes_[k].push_back({x_mm, static_cast<float>(share * blade.length_mm - blade.before_mm),
                           static_cast<float>(value.droop_mm), static_cast<float>(value.twist_rad),
                           static_cast<float>(theta)});
      if (axes.planes.turns())
        in_plane_mm_[k].push_back(static_cast<float>(std::max(slack_mm, value.in_plane_mm.norm())));
    }
  }
}

SweepSag::Value SweepSag::at(double offset_mm, double x_mm) const {
  const auto across = [&](const std::vector<Node>& nodes) -> Value {
    const auto above = std::lower_bound(nodes.begin(), nodes.end(), x_mm,
                                        [](const Node& n, double x) { return n.x_mm < x; });
    const auto value = [](const Node& n) -> Value { return {n.droop_mm, n.twist_rad, n.theta}; };
    if (above == nodes.begin()) return value(*above);
    if (above == nodes.end()) return value(nodes.back());
    const Node &p = *(above - 1), &q = *above;
    return between(value(p), value(q), (x_mm - p.x_mm) / (q.x_mm - p.x_mm));
  };
  const double place = std::clamp((offset_mm - first_mm_) / (last_mm_ - first_mm_), 0.0, 1.0) * (kPlaces - 1);
  const auto k = std::min(static_cast<std::size_t>(place), kPlaces - 2);
  return between(across(nodes_[k]), across(nodes_[k + 1]), place - static_cast<double>(k));
}

double SweepSag::moved_mm(double arc_low_mm, double arc_high_mm, double steepest_rad) const {
  if (!stable_) return std::numeric_limits<double>::infinity();
  double droop = 0, twist = 0, in_plane = 0;
  for (std::size_t k = 0; k < kPlaces; ++k) {
    for (std::size_t i = 0; i < nodes_[k].size(); ++i) {
      const Node& n = nodes_[k][i];
      if (n.s_mm < arc_low_mm || n.s_mm > arc_high_mm) continue;
      droop = std::max<double>(droop, std::abs(n.droop_mm));
      twist = std::max<double>(twist, std::abs(n.twist_rad));
      if (!in_plane_mm_[k].empty()) in_plane = std::max<double>(in_plane, in_plane_mm_[k][i]);
    }
  }
  return droop * std::sin(steepest_rad) + half_width_mm_ * twist + in_plane;
}

}  // namespace hotblade::pipeline
