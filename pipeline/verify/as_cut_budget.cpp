#include "pipeline/verify/as_cut_budget.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "elastica/blade/continuation.hpp"
#include "elastica/blade/taut.hpp"
#include "pipeline/verify/as_cut.hpp"
#include "pipeline/verify/blade_speeds.hpp"
#include "pipeline/verify/budget.hpp"
#include "pipeline/verify/design_faces.hpp"
#include "pipeline/verify/hanging.hpp"
#include "pipeline/verify/width_heights.hpp"
#include "robot/blade/blade_branch.hpp"
#include "robot/pose/motion.hpp"

namespace hotblade::pipeline {

namespace {

using robot::ClampPoses;
using robot::Pose;
using Points = std::vector<Eigen::Vector3d>;

// How the blade hangs that cuts a rib. A program without a pose for the rib does not say.
class HangingRib {
 public:
  HangingRib(const Strip& strip, int rib, const robot::Blade& section) {
    const auto pose = std::find_if(strip.poses.begin(), strip.poses.end(),
                                   [&](const BladePose& p) { return p.rib == rib; });
    frame_ = strip.ribs[static_cast<std::size_t>(rib)].frame;
    if (pose == strip.poses.end()) return;
    frame_ = pose->frame;
    sag_ = hanging(pose->blade, frame_, strip.design_to_cell, section);
    for (const auto& q : elastica::sample(pose->blade, elastica::kGravityCells + 1))
      nodes_.push_back(frame_.point(q.x, q.y));
  }

  // At the blade's point nearest to p.
  [[nodiscard]] Hang at(const Eigen::Vector3d& p) const {
    if (nodes_.empty()) return {Eigen::Vector3d::Zero(), frame_.normal()};
    double nearest = std::numeric_limits<double>::infinity(), share = 0;
    Eigen::Vector3d along = frame_.x;
    for (std::size_t k = 0; k + 1 < nodes_.size(); ++k) {
      const Eigen::Vector3d way = nodes_[k + 1] - nodes_[k];
      const double t = std::clamp((p - nodes_[k]).dot(way) / way.squaredNorm(), 0.0, 1.0);
      const double away = (p - nodes_[k] - t * way).squaredNorm();
      if (!(away < nearest)) continue;
      nearest = away;
      share = (static_cast<double>(k) + t) / elastica::kGravityCells;
      along = way.normalized();
    }
    return hang_of(sag_.at(share), frame_, {along.dot(frame_.x), along.dot(frame_.y)});
  }

 private:
  Frame frame_;
  robot::SagProfile sag_;
  Points nodes_;
};

// How far ribs, brought back by half the melted band over the blade's whole width, are from the design.
class DroppedRibs {
 public:
  DroppedRibs(const Program& program, const surface::DesignSurface& design, gpu::Backend backend)
      : blade_(program.blade), to_design_(design.mesh, program, backend) {}

  // Of what of a curve from clamp A to clamp B, points of a strip's rib, lies over its face of the design,
  // moved as the blade hangs.
  [[nodiscard]] double deviation_mm(int strip, const Points& in_plane, const HangingRib& rib,
                                    const BladeSpeeds& speeds) const {
    std::vector<WidthPlace> places;
    for (std::size_t i = 0; i < in_plane.size(); ++i) {
      const Hang hang = rib.at(in_plane[i]);
      const Eigen::Vector3d along =
          in_plane[std::min(i + 1, in_plane.size() - 1)] - in_plane[i - std::min<std::size_t>(i, 1)];
      places.push_back({in_plane[i] + hang.shift_mm, hang.plane_normal, hang.plane_normal.cross(along)});
    }
    const auto of_strip = [strip](std::size_t) { return strip; };
    const std::vector<double> heights =
        width_heights(to_design_, places, blade_.width_mm, PastBorder::kPlane, of_strip);
    double worst = 0;
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (!std::isfinite(heights[i])) continue;
      const double speed = speeds.empty() ? 0 : speeds.at(places[i].point);
      worst = std::max(worst, std::abs(heights[i] - 0.5 * blade_.band_mm(speed)));
    }
    return worst;
  }

 private:
  const robot::Blade& blade_;
  DesignFaces to_design_;
};

struct RibErrors {
  double section_mm = 0, curve_mm = 0, fit_mm = 0;
};

RibErrors rib_errors(const Program& program, const surface::DesignSurface& design,
                     const VerifyOptions& options) {
  constexpr int kSamples = 129;
  const DroppedRibs measure(program, design, options.backend);
  RibErrors errors;
  for (const Strip& strip : program.strips) {
    // None where the band is one.
    const BladeSpeeds speeds(program.blade.melt.by_speed() ? strip.poses : std::vector<BladePose>{});
    for (const Rib& rib : strip.ribs) {
      Points target, curve;
      for (const Eigen::Vector2d& q : rib.target) target.push_back(rib.frame.point(q.x(), q.y()));
      for (const auto& q : elastica::sample(rib.elastica, kSamples))
        curve.push_back(rib.frame.point(q.x, q.y));
      const HangingRib hung(strip, static_cast<int>(&rib - strip.ribs.data()), program.blade);
      const auto number = static_cast<int>(&strip - program.strips.data());
      errors.section_mm = std::max(errors.section_mm, measure.deviation_mm(number, target, hung, speeds));
      errors.curve_mm = std::max(errors.curve_mm, measure.deviation_mm(number, curve, hung, speeds));
      errors.fit_mm = std::max(errors.fit_mm, rib.design_deviation_mm);
    }
  }
  return errors;
}

constexpr int kBladePoints = 17;

// The part of a blade that forms the design.
Points points_on(const elastica::Elastica& blade, const Frame& frame, const std::array<double, 2>& part) {
  const elastica::ElasticaCurve curve(blade);
  Points points;
  for (int i = 0; i < kBladePoints; ++i) {
    const auto q = curve.at(part[0] + (part[1] - part[0]) * i / (kBladePoints - 1));
    points.push_back(frame.point(q.x, q.y));
  }
  return points;
}

double farthest(const Points& a, const Points& b) {
  double worst = 0;
  for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, (a[i] - b[i]).norm());
  return worst;
}

// The planned blade at a time between poses k and k + 1: the cubic through the four poses about it.
std::optional<Points> planned_points(const Strip& strip, std::size_t k, double t,
                                     const std::array<double, 2>& part) {
  if (k < 1 || k + 2 >= strip.poses.size()) return std::nullopt;
  Points sum(kBladePoints, Eigen::Vector3d::Zero());
  for (std::size_t j = k - 1; j <= k + 2; ++j) {
    const BladePose& pose = strip.poses[j];
    if (!pose.foam) return std::nullopt;
    double weight = 1;
    for (std::size_t m = k - 1; m <= k + 2; ++m) {
      if (m != j) weight *= (t - strip.poses[m].t) / (pose.t - strip.poses[m].t);
    }
    const Points points = points_on(pose.blade, pose.frame, part);
    for (std::size_t i = 0; i < points.size(); ++i) sum[i] += weight * points[i];
  }
  return sum;
}

// The blade between the program's own clamps, moved as the controller moves those of the registers. The shape
// of a blade pulled straight depends on less than the registers hold: the program's own is taken, linear in
// time.
Points unrounded_points(const BladePose& from, const BladePose& to, double share, const BladePose& executed,
                        const robot::ClampOffsets& offsets) {
  const ClampPoses holding = robot::held(robot::interpolate({from.a, from.b}, {to.a, to.b}, share), offsets);
  const Pose& a = holding.a;
  const elastica::PlanarPose b = robot::seen_from_a(holding, elastica::clamps_of(executed.blade).b.theta).b;
  if (std::hypot(b.x, b.y) < (1 - elastica::kNearlyTautSlack) * executed.blade.length) {
    const auto solved = elastica::solve_clamped(executed.blade, {{0, 0, 0}, b});
    const Frame frame{a.p, a.q * Eigen::Vector3d::UnitX(), a.q * Eigen::Vector3d::UnitY()};
    if (solved) return points_on(solved->elastica, frame, *executed.foam);
  }
  Points points = points_on(from.blade, from.frame, *executed.foam);
  const Points next = points_on(to.blade, to.frame, *executed.foam);
  for (std::size_t i = 0; i < points.size(); ++i) points[i] = (1 - share) * points[i] + share * next[i];
  return points;
}

struct MotionErrors {
  double quantisation_mm = 0, interpolation_mm = 0, mismatch_mm = 0;
};

void add_motion_errors(const Strip& strip, const ExecutedStrip& executed, const robot::ClampOffsets& offsets,
                       MotionErrors& errors) {
  constexpr std::size_t kLooks = 400;  // a strip; the errors repeat from waypoint to waypoint
  std::vector<std::size_t> forming;
  for (std::size_t i = 0; i < executed.poses.size(); ++i) {
    if (executed.poses[i].foam) forming.push_back(i);
  }
  // A prime step would do; one more than a multiple of most sampling ratios looks at every phase of a step.
  const std::size_t step = std::max<std::size_t>(1, forming.size() / kLooks) | 1;
  for (std::size_t i = 0; i < forming.size(); i += step) {
    const BladePose& pose = executed.poses[forming[i]];
    const std::size_t k = executed.after[forming[i]];
    if (k + 1 >= strip.poses.size()) continue;
    const BladePose &from = strip.poses[k], &to = strip.poses[k + 1];
    const double share = share_of_step(from, to, executed.path_s[forming[i]]);
    const auto planned = planned_points(strip, k, from.t + share * (to.t - from.t), *pose.foam);
    if (!planned) continue;
    const Points is = points_on(pose.blade, pose.frame, *pose.foam);
    const Points unrounded = unrounded_points(from, to, share, pose, offsets);
    errors.quantisation_mm = std::max(errors.quantisation_mm, farthest(is, unrounded));
    errors.interpolation_mm = std::max(errors.interpolation_mm, farthest(unrounded, *planned));
    errors.mismatch_mm = std::max(errors.mismatch_mm, farthest(is, *planned));
  }
}

}  // namespace

double share_of_step(const BladePose& from, const BladePose& to, double path_s) {
  return to.t > from.t ? std::clamp((path_s - from.t) / (to.t - from.t), 0.0, 1.0) : 0;
}

AsCutBudget as_cut_budget(const Program& program, const std::vector<ExecutedStrip>& executed,
                          const surface::DesignSurface& design, double half_band_mm,
                          const VerifyOptions& options) {
  AsCutBudget budget;
  const auto planned = [&](const std::string& name) {
    for (const auto& [line, mm] : program.verification.budget_mm) {
      if (line == name) return mm;
    }
    budget.missing.push_back(name);
    return 0.0;
  };
  const RibErrors ribs = rib_errors(program, design, options);
  MotionErrors motion;
  for (std::size_t i = 0; i < executed.size(); ++i) {
    add_motion_errors(program.strips[i], executed[i], program.settings.machine.clamps, motion);
  }
  const double joint = std::min(planned("joint_fit"), ribs.fit_mm);
  budget.lines_mm = {{"mesh", mesh_chord_mm(design.mesh, crease_limits(program.settings, program.blade))},
                     {"section", ribs.section_mm},
                     {"fit", ribs.fit_mm - joint},
                     {"joint_fit", joint},
                     {"between_ribs", std::max(0.0, program.verification.deviation_mm.max - ribs.curve_mm)},
                     {"kerf_width", half_band_mm},
                     {"gravity_droop", planned("gravity_droop")},
                     {"gravity_in_plane", planned("gravity_in_plane")},
                     {"quantisation", motion.quantisation_mm},
                     {"interpolation", motion.interpolation_mm},
                     {"clamp_error", planned("clamp_error")}};
  budget.shape_mismatch_mm = motion.mismatch_mm;
  return budget;
}

}  // namespace hotblade::pipeline
