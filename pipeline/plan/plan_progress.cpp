#include "pipeline/plan/plan_progress.hpp"

#include <algorithm>

namespace hotblade::pipeline {

namespace {

constexpr double kEnd = 0.95;   // what follows a plan takes the rest
constexpr double kStep = 0.01;  // of what is left
// Between two stages of an attempt that tell their shares: a fit's steps end before the poses begin.
constexpr double kNextStage = 0.2;

}  // namespace

void PlanProgress::creep(double end) {
  at_ += kStep * std::max(end - at_, 0.0);
}

void PlanProgress::step(const std::string& stage, double end) {
  const std::scoped_lock lock(mutex_);
  creep(end);
  tell_(stage, at_);
}

void PlanProgress::attempt(const std::string& stage, double share) {
  const std::scoped_lock lock(mutex_);
  if (share < share_) {
    from_ = at_;
    to_ = at_ + 0.5 * (kEnd - at_);
  }
  const auto place = [&](double part) { return from_ + part * (to_ - from_); };
  if (share == share_) {
    creep(place(std::min(share + kNextStage, 1.0)));
  } else {
    at_ = std::max(at_, place(share));
  }
  share_ = share;
  tell_(stage, at_);
}

}  // namespace hotblade::pipeline
