#include "pipeline/plan/motion/rib_fold.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "elastica/blade/clamp_margin.hpp"
#include "gpu/backend/stop.hpp"
#include "pipeline/plan/motion/rib_poses.hpp"
#include "pipeline/verify/clamp_error.hpp"

namespace hotblade::pipeline {

double rib_fold_mm(const StripPlan& strip, const MachineSettings& machine, double farthest_mm) {
  std::vector<BladePose> poses = rib_poses(strip, machine);
  for (BladePose& end : end_poses(strip, machine)) poses.push_back(std::move(end));
  std::vector<double> folds_mm(poses.size(), farthest_mm);
  tbb::parallel_for(std::size_t{0}, poses.size(), [&](std::size_t i) {
    gpu::stop_point();
    if (!nearly_straight(poses[i], machine))
      folds_mm[i] = elastica::clamp_margin(poses[i].blade, {farthest_mm, 0}).fold_mm;
  });
  gpu::stop_point();
  return *std::min_element(folds_mm.begin(), folds_mm.end());
}

}  // namespace hotblade::pipeline
