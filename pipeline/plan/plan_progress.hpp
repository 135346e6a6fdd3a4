// How far a plan is, told so that it always moves: nobody knows beforehand how many fits a search takes.
#pragma once

#include <functional>
#include <mutex>
#include <string>

namespace hotblade::pipeline {

class PlanProgress {
 public:
  using Tell = std::function<void(const std::string& stage, double share)>;
  explicit PlanProgress(Tell tell) : tell_(std::move(tell)) {}

  // A step of a search, from any thread: a hundredth of what is left of the way to `end`.
  void step(const std::string& stage, double end);

 private:
  Tell tell_;
  std::mutex mutex_;
  double at_ = 0;
};

}  // namespace hotblade::pipeline
