#include "pipeline/verify/clamp_mismatch.hpp"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "gpu/backend/stop.hpp"
#include "pipeline/program/clamps.hpp"

namespace hotblade::pipeline {

double clamp_mismatch_mm(const Program& program) {
  constexpr double kMmPerRad = 1000;
  constexpr std::size_t kPosesAtOnce = 1024;
  const robot::ClampOffsets& offsets = program.settings.machine.clamps;
  std::vector<double> worst(program.strips.size(), 0);
  tbb::parallel_for(std::size_t{0}, worst.size(), [&](std::size_t i) {
    const std::span<const BladePose> all(program.strips[i].poses);
    for (std::size_t first = 0; first < all.size(); first += kPosesAtOnce) {
      gpu::stop_point();
      const auto poses = all.subspan(first, std::min(kPosesAtOnce, all.size() - first));
      std::vector<elastica::Elastica> blades;
      std::vector<Frame> frames;
      for (const BladePose& pose : poses) {
        blades.push_back(pose.blade);
        frames.push_back(pose.frame);
      }
      const std::vector<ClampPoses> planned = clamps(blades, frames);
      for (std::size_t k = 0; k < poses.size(); ++k) {
        for (const auto clamp : {&ClampPoses::a, &ClampPoses::b}) {
          const bool is_a = clamp == &ClampPoses::a;
          const Pose is = robot::held(is_a ? poses[k].a : poses[k].b, is_a ? offsets.a : offsets.b),
                     &should = planned[k].*clamp;
          const double off = std::max((is.p - should.p).norm(), kMmPerRad * is.q.angularDistance(should.q));
          if (!(off <= worst[i])) worst[i] = off;
        }
      }
    }
  });
  gpu::stop_point();
  return worst.empty() ? 0 : *std::max_element(worst.begin(), worst.end(), [](double p, double q) {
    return p < q || std::isnan(q);
  });
}

}  // namespace hotblade::pipeline
