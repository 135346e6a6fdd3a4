// How far a plan is, told so that it always moves: nobody knows beforehand how many fits a search takes, or
// how many attempts.
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

  // A stage of an attempt and the share of the attempt that is done then, from any thread. A share that is
  // smaller than the one before begins another attempt, which takes half of what is left; the same one again
  // is a step towards the next stage.
  void attempt(const std::string& stage, double share);

 private:
  void creep(double end);

  Tell tell_;
  std::mutex mutex_;
  double at_ = 0;
  double from_ = 0, to_ = 0, share_ = 2;  // of the attempt under way; the first begins below
};

}  // namespace hotblade::pipeline
