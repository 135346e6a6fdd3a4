#include "pipeline/plan/plan_progress.hpp"

#include <algorithm>

namespace hotblade::pipeline {

namespace {

constexpr double kStep = 0.01;  // of what is left

}  // namespace

void PlanProgress::step(const std::string& stage, double end) {
  const std::scoped_lock lock(mutex_);
  at_ += kStep * std::max(end - at_, 0.0);
  tell_(stage, at_);
}

}  // namespace hotblade::pipeline
