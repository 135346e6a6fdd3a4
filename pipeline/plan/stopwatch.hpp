// Times of a plan's stages, by the clock and by the processor.
#pragma once

#include <algorithm>
#include <chrono>
#include <ctime>
#include <string>
#include <vector>

#include "pipeline/plan/plan.hpp"

namespace hotblade::pipeline {

// Each lap adds the time since the one before to a stage.
class Stopwatch {
 public:
  explicit Stopwatch(std::vector<StageTime>& times) : times_(times) {}
  void lap(const std::string& stage) {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - last_).count(), used = processor_s();
    const auto known =
        std::find_if(times_.begin(), times_.end(), [&](const StageTime& t) { return t.stage == stage; });
    StageTime& time = known != times_.end() ? *known : times_.emplace_back(StageTime{stage});
    time.seconds += seconds;
    time.processor_s += used - used_;
    last_ = now;
    used_ = used;
  }

 private:
  static double processor_s() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

  std::vector<StageTime>& times_;
  double used_ = processor_s();
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace hotblade::pipeline
