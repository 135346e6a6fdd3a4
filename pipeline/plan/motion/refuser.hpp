// Refusals of a motion at one of its poses.
#pragma once

#include <string>

#include "pipeline/plan/motion/motion.hpp"

namespace hotblade::pipeline {

// Adds refusals that name the strip, the nearest rib while cutting, the phase and the time. It refers to
// both: they have to outlive it.
class Refuser {
 public:
  Refuser(const StripPlan& strip, BladeMotion& motion) : strip_(strip), motion_(motion) {}

  void operator()(std::size_t pose, Limit limit, double value, double bound, std::string note = "");

  [[nodiscard]] StripPhase phase(std::size_t pose) const { return motion_.poses[pose].phase; }

 private:
  [[nodiscard]] std::string rib_name(const BladePose& pose) const;

  const StripPlan& strip_;
  BladeMotion& motion_;
};

}  // namespace hotblade::pipeline
