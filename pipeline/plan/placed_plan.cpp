#include "pipeline/plan/placed_plan.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pipeline/verify/budget.hpp"
#include "robot/blade/blade_section.hpp"

namespace hotblade::pipeline {

namespace {

// Both ends of a step are told in microseconds, and rounded.
constexpr double kTold_s = 2e-6;

bool hot_step_differs(const Strip& strip, const Strip& before) {
  for (std::size_t i = 1; i < strip.poses.size(); ++i) {
    const BladePose &p = strip.poses[i - 1], &q = strip.poses[i];
    const double step_s = q.t - p.t, before_s = before.poses[i].t - before.poses[i - 1].t;
    if ((p.heat || q.heat) && std::abs(step_s - before_s) > kTold_s) return true;
  }
  return false;
}

// A line of the error budget, mm; 0 where a program has none.
double line_mm(const Program& program, const char* line) {
  for (const auto& [name, mm] : program.verification.budget_mm)
    if (name == line) return mm;
  return 0;
}

}  // namespace

bool cuts_otherwise(const Program& program, const Program& before) {
  if (!program.blade.melt.by_speed()) return false;
  return !std::equal(program.strips.begin(), program.strips.end(), before.strips.begin(), before.strips.end(),
                     [](const Strip& a, const Strip& b) { return !hot_step_differs(a, b); });
}

PlanResult plan_of(Program program) {
  PlanResult result;
  StripFacts facts;
  facts.droop_error_mm = line_mm(program, kDroopLine) / robot::kSagUnknownShare;
  facts.motion.in_plane_sag_mm = line_mm(program, kInPlaneLine) / robot::kSagUnknownShare;
  facts.motion.clamp_error_mm = line_mm(program, kClampErrorLine);
  facts.motion.off_plane_mm = std::max(0.0, line_mm(program, kInterpolationLine) - interpolation_mm(program));
  facts.joint_fit_mm = line_mm(program, kJointFitLine);
  for (const Strip& strip : program.strips) {
    facts.id = strip.id;
    result.strips.push_back(facts);
  }
  result.program = std::move(program);
  return result;
}

}  // namespace hotblade::pipeline
