// The controller languages that post_processor() knows.
#pragma once

#include "pipeline/export/post_processor.hpp"

namespace hotblade::pipeline {

// ABB RAPID: hb_arm_a.mod and hb_arm_b.mod, one MultiMove task each. A move's time is given with \T, so that
// both arms take the same time whatever their distances; ConfL and ConfJ are off, because the clamps turn
// little and the configuration is the cell's choice.
class RapidPostProcessor : public PostProcessor {
 public:
  [[nodiscard]] std::vector<ExportedFile> files(const RobotJob& job) const override;
};

// KUKA KRL: hb_arm_a.src and hb_arm_b.src. Orientations are A, B, C, turns about Z, Y', X'' in degrees.
class KrlPostProcessor : public PostProcessor {
 public:
  [[nodiscard]] std::vector<ExportedFile> files(const RobotJob& job) const override;
};

// An orientation as turns about Z, then the new Y, then the new X, degrees; A and C in (-180, 180], B in
// [-90, 90]. At B = +-90 only A and C together count, and C is 0.
struct KukaAngles {
  double a = 0, b = 0, c = 0;
};
[[nodiscard]] KukaAngles kuka_angles(const Eigen::Quaterniond& q);

}  // namespace hotblade::pipeline
