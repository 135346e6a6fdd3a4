#include "pipeline/plan/plan_progress.hpp"

#include <algorithm>

namespace hotblade::pipeline {

namespace {

// Of a try, what the fits have.
constexpr double kFits = 0.6;

// The share of the whole that so many tries are, if none was taken: over half for the first, as most plans
// are taken at the first or the second, and less and less for each that follows.
double tried(double tries) {
  constexpr double kHalfWay = 0.8;
  return tries / (tries + kHalfWay);
}

}  // namespace

void PlanProgress::fitted() {
  const std::scoped_lock lock(mutex_);
  fits_ += 1;
  tell("sweep", kFits * fits_ / (fits_ + expected_));
}

void PlanProgress::looked_at(const std::string& stage, double share) {
  const std::scoped_lock lock(mutex_);
  tell(stage, kFits + (1 - kFits) * share);
}

void PlanProgress::next_try() {
  const std::scoped_lock lock(mutex_);
  tries_ += 1;
  fits_ = 0;
}

void PlanProgress::tell(const std::string& stage, double share_of_try) {
  at_ = std::max(at_, tried(tries_) + share_of_try * (tried(tries_ + 1) - tried(tries_)));
  tell_(stage, at_);
}

}  // namespace hotblade::pipeline
