// How far a plan is, told so that it moves with the work: nobody knows beforehand how many tries a search
// takes, nor how many fits a try.
#pragma once

#include <functional>
#include <mutex>
#include <string>

namespace hotblade::pipeline {

class PlanProgress {
 public:
  using Tell = std::function<void(const std::string& stage, double share)>;
  // `fits`: about so many fits of parts come before a try is looked at in full.
  PlanProgress(Tell tell, double fits) : tell_(std::move(tell)), expected_(fits) {}

  // A fit of a part, from any thread. More fits than expected still move it: of the share that fits have, n
  // are n / (n + fits).
  void fitted();
  // Of a try that is looked at in full, the share that is done, 0 to 1; from any thread.
  void looked_at(const std::string& stage, double share);
  // The try was not taken: what comes next has its share of what is left.
  void next_try();

 private:
  void tell(const std::string& stage, double share_of_try);

  Tell tell_;
  std::mutex mutex_;
  double expected_, fits_ = 0;
  double tries_ = 0, at_ = 0;
};

}  // namespace hotblade::pipeline
