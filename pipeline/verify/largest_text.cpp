#include "pipeline/verify/largest_text.hpp"

#include <fmt/format.h>

namespace hotblade::pipeline {

std::string largest_text(const VerifyReport& report) {
  return fmt::format("{}{:.3f} mm", report.capped ? ">= " : "", report.deviation.max);
}

std::string largest_and_bound_text(const VerifyReport& report) {
  if (report.capped) return largest_text(report);
  return fmt::format("{} (nowhere over {:.3f} mm)", largest_text(report), report.bound_mm);
}

}  // namespace hotblade::pipeline
