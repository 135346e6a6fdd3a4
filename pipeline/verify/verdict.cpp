#include "pipeline/verify/verdict.hpp"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <vector>

#include "gpu/backend/stop.hpp"
#include "pipeline/sayings/saying.hpp"
#include "pipeline/verify/budget.hpp"
#include "pipeline/verify/clamp_error.hpp"

namespace hotblade::pipeline {

namespace {

// Two digits down: the largest such number that is not above x.
double two_digits_down(double x) {
  if (!(x > 0)) return 0;
  // By a power that is a whole number, the quotient is the number that its two digits read as.
  const double digits = 1 - std::floor(std::log10(x));
  if (digits >= 0) return std::floor(x * std::pow(10.0, digits)) / std::pow(10.0, digits);
  return std::floor(x / std::pow(10.0, -digits)) * std::pow(10.0, -digits);
}

// What a share of the clamps' errors moves the blades of a program by at its ribs. A pose's margin bounds its
// distance to the straight blade from below.
class ClampShare {
 public:
  explicit ClampShare(const Program& program) {
    for (const Strip& strip : program.strips) {
      for (const BladePose& pose : strip.poses) {
        if (pose.rib) ribs_.emplace_back(pose, pose.margin_mm.value_or(0), program.settings.machine);
      }
    }
  }
  // The largest of all ribs' numbers does not depend on who asks for them in which order.
  [[nodiscard]] bool within(double share, double room_mm) {
    const bool all = tbb::parallel_reduce(
        tbb::blocked_range(ribs_.begin(), ribs_.end()), true,
        [&](const auto& some, bool so_far) {
          return so_far && std::all_of(some.begin(), some.end(),
                                       [&](ClampResponse& rib) { return rib.at(share) <= room_mm; });
        },
        std::logical_and<>());
    gpu::stop_point();
    return all;
  }

 private:
  std::vector<ClampResponse> ribs_;
};

ClampErrors scaled(const ClampErrors& errors, double factor) {
  return {two_digits_down(factor * errors.position_mm), two_digits_down(factor * errors.angle_rad)};
}

// The errors, in proportion to the planned ones, that leave `room_mm` for what the clamps add; absent where
// none do. What blades are moved by grows with the errors, linearly or with their root.
std::optional<ClampErrors> errors_within(const Program& program, const ClampErrors& planned, double room_mm) {
  if (!(room_mm > 0)) return std::nullopt;
  ClampShare share(program);
  double least = 0, most = 1;
  constexpr int kHalvings = 30;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (least + most);
    (share.within(middle, room_mm) ? least : most) = middle;
  }
  // Smaller than any clamp is placed to is no answer.
  constexpr double kLeastFactor = 1e-4;
  if (least < kLeastFactor) return std::nullopt;
  return scaled(planned, least);
}

}  // namespace

const char* name(VerdictColor color) {
  if (color == VerdictColor::kRed) return "red";
  return color == VerdictColor::kAmber ? "amber" : "green";
}

Verdict verdict_of(const Program& program) {
  const Verification& v = program.verification;
  Verdict verdict;
  verdict.tolerance_mm = v.tolerance_mm;
  verdict.budget_mm = budget_sum_mm(v.budget_mm);
  for (const auto& [line, mm] : v.budget_mm) {
    if (line == kClampErrorLine) verdict.clamp_mm += mm;
  }
  const MachineSettings& machine = program.settings.machine;
  verdict.planned = {machine.clamp_error_mm, machine.clamp_error_rad};
  if (verdict.over_budget()) {
    const double room_mm = verdict.tolerance_mm - (verdict.budget_mm - verdict.clamp_mm);
    verdict.needed = errors_within(program, verdict.planned, room_mm);
  }
  if (v.status == VerificationStatus::kPassed)
    verdict.color = verdict.over_budget() ? VerdictColor::kAmber : VerdictColor::kGreen;
  return verdict;
}

std::string needed_text(const Verdict& v) {
  if (v.needed)
    return say(Saying::kClampsWithin, {v.tolerance_mm, v.needed->position_mm, 1e3 * v.needed->angle_rad});
  return say(Saying::kClampsNotEnough, {v.tolerance_mm});
}

std::string headline(const Verdict& verdict) {
  if (verdict.color == VerdictColor::kRed) return "not cuttable as asked";
  if (verdict.color == VerdictColor::kGreen) return "can be cut as planned";
  return verdict.needed ? "can be cut " + needed_text(verdict) : "can be cut, but " + needed_text(verdict);
}

std::string budget_text(const Verdict& v) {
  if (!v.over_budget())
    return fmt::format("error budget {:.3g} mm (tolerance {:g} mm)", v.budget_mm, v.tolerance_mm);
  return say(Saying::kOverBudget, {v.budget_mm, v.tolerance_mm, v.clamp_mm, v.planned.position_mm,
                                   1e3 * v.planned.angle_rad, needed_text(v)});
}

nlohmann::ordered_json to_json(const Verdict& v) {
  const auto errors_json = [](const ClampErrors& e) -> nlohmann::ordered_json {
    return {{"position_mm", e.position_mm}, {"angle_rad", e.angle_rad}};
  };
  return {{"color", name(v.color)},
          {"text", headline(v)},
          {"tolerance_mm", v.tolerance_mm},
          {"budget_mm", v.budget_mm},
          {"clamp_error_mm", v.clamp_mm},
          {"clamps_planned", errors_json(v.planned)},
          {"clamps_needed", v.needed ? errors_json(*v.needed) : nlohmann::ordered_json()}};
}

}  // namespace hotblade::pipeline
