#include "pipeline/verify/motion_check.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "elastica/blade/blade_batch.hpp"
#include "gpu/backend/stop.hpp"
#include "pipeline/program/forming_gap.hpp"
#include "pipeline/program/strip_jobs.hpp"
#include "pipeline/verify/branch.hpp"
#include "pipeline/verify/refusal.hpp"
#include "robot/pose/limits.hpp"
#include "robot/pose/rates.hpp"

namespace hotblade::pipeline {

namespace {

using robot::MotionLimits;
using robot::Waypoint;

// Rounding of places and times.
constexpr double kRounded_mm = 1e-3, kRounded_s = 1e-5;

// Of what a limit is about, the amount at the last of three waypoints, and its bound.
struct Amount {
  double value = 0, bound = 0;
};

// The waypoint that breaks a limit and those before it, from which a controller counts.
class Step {
 public:
  Step(std::span<const Waypoint> way, std::size_t at, const MotionLimits& limits)
      : way_(way), at_(at), limits_(limits) {}

  [[nodiscard]] Amount amount(Limit limit, double blade_length_mm) const {
    const Waypoint& w = way_[std::min(at_, way_.size() - 1)];
    switch (limit) {
      case Limit::kEnvelope:
        return {std::max(outside_mm(w.a.p), outside_mm(w.b.p)), 0};
      case Limit::kChord: {
        const robot::ClampPoses holding = robot::held({w.a, w.b}, limits_.clamps);
        return {(holding.b.p - holding.a.p).norm(), blade_length_mm * (1 - limits_.chord_slack)};
      }
      case Limit::kMinDt:
        return {seconds(at_), limits_.min_dt_us * 1e-6};
      case Limit::kSpeed:
        return {most([](const auto& v, const auto&) { return v.linear.norm(); }), limits_.speed_mm_s};
      case Limit::kAngularSpeed:
        return {most([](const auto& v, const auto&) { return v.angular.norm(); }), limits_.angular_rad_s};
      case Limit::kAcceleration:
        return {most([](const auto&, const auto& change) { return change.linear_mm_s2; }),
                limits_.accel_mm_s2};
      case Limit::kAngularAcceleration:
        return {most([](const auto&, const auto& change) { return change.angular_rad_s2; }),
                limits_.angular_accel_rad_s2};
      default:
        return {};
    }
  }

 private:
  [[nodiscard]] double outside_mm(const Eigen::Vector3d& p) const {
    return (limits_.envelope_min_mm - p).cwiseMax(p - limits_.envelope_max_mm).maxCoeff();
  }
  // Of the step that ends at a waypoint; before the first and behind the last one as long as its neighbour.
  [[nodiscard]] double seconds(std::size_t at) const {
    const std::size_t end = std::clamp<std::size_t>(at, 1, way_.size() - 1);
    return (way_[end].t_us - way_[end - 1].t_us) * 1e-6;
  }
  [[nodiscard]] robot::ClampRates rates(robot::Pose Waypoint::*clamp, std::size_t at) const {
    if (at == 0 || at >= way_.size()) return {};
    return robot::rates_between(way_[at - 1].*clamp, way_[at].*clamp, seconds(at));
  }
  template <typename Of>
  [[nodiscard]] double most(const Of& of) const {
    double most = 0;
    for (const auto clamp : {&Waypoint::a, &Waypoint::b}) {
      const robot::ClampRates before = rates(clamp, at_ - std::min<std::size_t>(at_, 1)),
                              now = rates(clamp, at_);
      most = std::max(most,
                      of(now, robot::accelerations_between(
                                  before, now, seconds(at_ - std::min<std::size_t>(at_, 1)), seconds(at_))));
    }
    return most;
  }

  std::span<const Waypoint> way_;
  std::size_t at_;
  const MotionLimits& limits_;
};

// The check of one strip.
class StripCheck {
 public:
  StripCheck(const Program& program, const Strip& strip)
      : settings_(program.settings), limits_(planned_limits(program)), strip_(strip) {}

  std::vector<MotionBreach> take() {
    machine();
    clearance();
    heat();
    feed();
    block();
    return std::move(breaches_);
  }

 private:
  void add(std::size_t pose, const std::string& text) {
    breaches_.push_back({strip_.id, pose, strip_.poses[pose].t, text});
  }
  void add_limit(std::size_t pose, Limit limit, Amount amount) {
    Refusal refusal{strip_.id, rib_at(strip_, pose), limit, amount.value, amount.bound};
    refusal.when = when(pose);
    const std::string whose = refusal.rib.empty() ? strip_.id : refusal.rib;
    const bool counted = amount.value != 0 || amount.bound != 0;
    add(pose, counted ? describe(refusal) : whose + ": " + info(limit).fault + refusal.when);
  }
  [[nodiscard]] std::string when(std::size_t pose) const {
    return fmt::format(" in phase {} at {:.2f} s", name(strip_.poses[pose].phase), strip_.poses[pose].t);
  }

  void machine() {
    const std::vector<Waypoint> way = waypoints(strip_);
    robot::LimitChecker checker(limits_, strip_.blade_length_mm);
    for (std::size_t i = 0; i <= way.size(); ++i) {
      const Limit limit = i < way.size() ? checker.next(way[i]) : checker.finish();
      if (limit == Limit::kNone) continue;
      add_limit(std::min(i, way.size() - 1), limit,
                Step(way, i, limits_).amount(limit, strip_.blade_length_mm));
      return;
    }
  }

  void clearance() {
    std::size_t lowest = 0;
    const auto height = [&](std::size_t pose) {
      const BladePose& at = strip_.poses[pose];
      return std::min(robot::transformed(strip_.design_to_cell, at.a).p.z(),
                      robot::transformed(strip_.design_to_cell, at.b).p.z());
    };
    for (std::size_t i = 1; i < strip_.poses.size(); ++i) {
      if (height(i) < height(lowest)) lowest = i;
    }
    if (!(height(lowest) >= settings_.stock.clearance_mm - kRounded_mm))
      add_limit(lowest, Limit::kClampHeight, {height(lowest), settings_.stock.clearance_mm});
  }

  void heat() {
    if (const auto gap = forming_gap(strip_)) add(gap->first, describe(strip_, *gap));
    preheat();
    phases();
  }

  // The blade has to stand hot for long enough before it moves.
  void preheat() {
    const auto& poses = strip_.poses;
    const auto first = std::ranges::find_if(poses, [](const BladePose& p) { return p.heat; });
    const auto foam = std::ranges::find_if(poses, [](const BladePose& p) { return p.foam.has_value(); });
    if (foam == poses.end() || !(settings_.motion.preheat_s > 0)) return;
    double stood_s = 0;
    if (first < foam) {
      const auto moves = std::find_if(first, foam, [&](const BladePose& p) {
        return (p.a.p - first->a.p).norm() > kRounded_mm || (p.b.p - first->b.p).norm() > kRounded_mm;
      });
      const auto cold = first == poses.begin() ? first : first - 1;
      stood_s = (moves - 1)->t - cold->t;
    }
    if (stood_s >= settings_.motion.preheat_s - kRounded_s) return;
    const auto at = static_cast<std::size_t>(std::min(first, foam) - poses.begin());
    add(at,
        fmt::format("{}: time that the blade stands hot before it enters the foam {:.3g} s (limit {:.3g} s, "
                    "motion.preheat_s){}",
                    strip_.id, stood_s, settings_.motion.preheat_s, when(at)));
  }

  // A phase is of one heat, and one alone forms the design.
  void phases() {
    StripPhase before = StripPhase::kForm;
    for (std::size_t i = 0; i < strip_.poses.size(); ++i) {
      const BladePose& pose = strip_.poses[i];
      const bool hot = pose.phase >= StripPhase::kPreheat && pose.phase <= StripPhase::kLeadOut;
      const bool forms = pose.phase == StripPhase::kCut;
      const std::string phase = name(pose.phase);
      std::string wrong;
      if (pose.phase < before) wrong = "phase " + phase + " comes behind phase " + name(before);
      if (pose.heat != hot) wrong = "phase " + phase + " is " + (pose.heat ? "hot" : "cold");
      if (pose.foam.has_value() != forms)
        wrong = "phase " + phase + (forms ? " forms nothing" : " forms the design");
      if (!wrong.empty())
        return add(i, fmt::format("{}: {} at {:.2f} s, pose {}", strip_.id, wrong, pose.t, i));
      before = pose.phase;
    }
  }

  // Even places of what is in foam at each of some poses, of the blades of others.
  static constexpr std::size_t kPlaces = 9;
  using Poses = std::span<const BladePose* const>;
  [[nodiscard]] static std::vector<Eigen::Vector3d> places(Poses blades, Poses parts) {
    std::vector<elastica::Elastica> all;
    std::vector<elastica::Part> of;
    for (const BladePose* pose : blades) all.push_back(pose->blade);
    for (const BladePose* pose : parts) of.push_back({(*pose->foam)[0], (*pose->foam)[1]});
    const elastica::PartPlaces on = elastica::sample_places(all, of, kPlaces);
    std::vector<Eigen::Vector3d> points;
    for (std::size_t n = 0; n < blades.size(); ++n) {
      for (std::size_t k = 0; k < kPlaces; ++k) {
        const Eigen::Vector2d q = on.at(n, k);
        points.push_back(blades[n]->frame.point(q.x(), q.y()));
      }
    }
    return points;
  }

  // Planned feeds are those of equal shares of what is in foam, or of the same places of the blade: a place
  // is as fast here as the faster of both.
  void feed() {
    std::vector<const BladePose*> from, to;
    for (std::size_t i = 1; i < strip_.poses.size(); ++i) {
      if (!strip_.poses[i - 1].foam || !strip_.poses[i].foam) continue;
      from.push_back(&strip_.poses[i - 1]);
      to.push_back(&strip_.poses[i]);
    }
    if (to.empty()) return;
    const std::vector<Eigen::Vector3d> now = places(to, to), share = places(from, from),
                                       same = places(from, to);
    std::size_t slowest = 0;
    double slowest_mm_s = std::numeric_limits<double>::infinity();
    for (std::size_t n = 0; n < to.size(); ++n) {
      for (std::size_t k = 0; k < kPlaces; ++k) {
        const std::size_t at = n * kPlaces + k;
        const double moved = std::max((now[at] - share[at]).norm(), (now[at] - same[at]).norm());
        const double speed = moved / (to[n]->t - from[n]->t);
        if (speed >= slowest_mm_s) continue;
        slowest_mm_s = speed;
        slowest = static_cast<std::size_t>(to[n] - strip_.poses.data());
      }
    }
    // As planned: facets and rounded times make a little less.
    constexpr double kSameFeed = 0.99;
    if (!(slowest_mm_s >= kSameFeed * settings_.motion.min_feed_mm_s))
      add_limit(slowest, Limit::kSlowestFeed, {slowest_mm_s, settings_.motion.min_feed_mm_s});
  }

  void block() {
    std::vector<const BladePose*> in_foam;
    for (const BladePose& pose : strip_.poses) {
      if (pose.foam) in_foam.push_back(&pose);
    }
    const double height = strip_.block.height_above_table_mm(strip_.design_to_cell);
    if (!(height >= -kRounded_mm))
      add(0, fmt::format("{}: height of the block's lowest corner above the table {:.4g} mm (limit 0 mm)",
                         strip_.id, height));
    if (in_foam.empty()) return;
    const std::vector<Eigen::Vector3d> points = places(in_foam, in_foam);
    std::size_t farthest = 0;
    double outside_mm = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double mm = strip_.block.distance_mm(points[i]);
      if (mm <= outside_mm) continue;
      outside_mm = mm;
      farthest = static_cast<std::size_t>(in_foam[i / kPlaces] - strip_.poses.data());
    }
    constexpr double kAtItsFace_mm = 0.1;
    if (outside_mm <= kAtItsFace_mm) return;
    const std::string rib = rib_at(strip_, farthest);
    add(farthest,
        fmt::format(
            "{}: distance of what is in foam from the strip's block (stock) {:.4g} mm (limit {} mm){}",
            rib.empty() ? strip_.id : rib, outside_mm, kAtItsFace_mm, when(farthest)));
  }

  const Settings& settings_;
  MotionLimits limits_;
  const Strip& strip_;
  std::vector<MotionBreach> breaches_;
};

}  // namespace

std::vector<MotionBreach> check_motion(const Program& program) {
  std::vector<std::vector<MotionBreach>> found(program.strips.size());
  tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t i) {
    gpu::stop_point();
    if (!program.strips[i].poses.empty()) found[i] = StripCheck(program, program.strips[i]).take();
  });
  gpu::stop_point();
  std::vector<MotionBreach> all;
  for (auto& breaches : found) std::ranges::move(breaches, std::back_inserter(all));
  return all;
}

}  // namespace hotblade::pipeline
