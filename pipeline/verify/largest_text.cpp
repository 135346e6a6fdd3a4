#include "pipeline/verify/largest_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

namespace hotblade::pipeline {

std::string largest_text(const VerifyReport& report) {
  return fmt::format("{}{:.3f} mm", report.capped ? ">= " : "", report.deviation.max);
}

std::string largest_and_bound_text(const VerifyReport& report) {
  if (report.capped) return largest_text(report);
  return fmt::format("{} (nowhere over {:.3f} mm)", largest_text(report), report.bound_mm);
}

std::string over_text(const VerifyReport& report, const VerifyOptions& options) {
  std::vector<std::string> over;
  if (std::max(report.bound_mm, report.deviation.max) > options.tolerance_mm)
    over.push_back(
        fmt::format("deviation {} (limit {:g} mm)", largest_and_bound_text(report), options.tolerance_mm));
  if (report.uncut_share() > options.max_uncut_share)
    over.push_back(fmt::format("uncut {:.0f} mm2 ({:.2f} % of the design, limit {:.2f} %)", report.uncut_mm2,
                               100 * report.uncut_share(), 100 * options.max_uncut_share));
  if (report.clamp_mismatch_mm > kClampMismatchMm)
    over.push_back(fmt::format("clamps {:.3f} mm off the planned blade's ends (limit {} mm)",
                               report.clamp_mismatch_mm, kClampMismatchMm));
  return fmt::format("{}", fmt::join(over, ", "));
}

}  // namespace hotblade::pipeline
