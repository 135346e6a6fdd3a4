#include "pipeline/plan/motion/rib_fold.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "elastica/blade/clamp_margin.hpp"
#include "gpu/backend/stop.hpp"
#include "pipeline/plan/motion/clamp_margins.hpp"
#include "pipeline/plan/motion/rib_poses.hpp"
#include "pipeline/verify/clamp_error.hpp"

namespace hotblade::pipeline {

namespace {

// Poses along the sweep, searched one after the other: what is found at one vouches for those around it, as
// far as the clamps have not moved beyond it.
class FoldAlong {
 public:
  FoldAlong(std::vector<BladePose> poses, const MachineSettings& machine, double farthest_mm)
      : poses_(std::move(poses)), least_mm_(farthest_mm), open_(poses_.size()), near_(poses_.size(), 0) {
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      held_.push_back(elastica::clamps_of(poses_[i].blade));
      open_[i] = !nearly_straight(poses_[i], machine);
    }
  }

  // The smallest of all, no more than was given.
  double run() {
    // At 0 some shape holds by itself no longer.
    for (std::vector<Look> looks = wanted(); !looks.empty() && least_mm_ > 0; looks = wanted()) {
      std::vector<elastica::ClampMargin> found(looks.size());
      tbb::parallel_for(std::size_t{0}, looks.size(), [&](std::size_t k) {
        gpu::stop_point();
        found[k] = elastica::clamp_margin(poses_[looks[k].pose].blade, {looks[k].far_mm, 0});
      });
      gpu::stop_point();
      for (const elastica::ClampMargin& margin : found) least_mm_ = std::min(least_mm_, margin.fold_mm);
      for (std::size_t k = 0; k < looks.size(); ++k) close_around(looks[k].pose, found[k]);
    }
    return least_mm_;
  }

 private:
  struct Look {
    std::size_t pose = 0;
    double far_mm = 0;
  };

  // Of each run of poses that nothing vouches for, the middle one.
  [[nodiscard]] std::vector<Look> wanted() const {
    std::vector<Look> looks;
    for (std::size_t from = 0; from < open_.size();) {
      std::size_t to = from;
      while (to < open_.size() && open_[to]) ++to;
      if (to > from) looks.push_back({(from + to) / 2, far_mm(from, to)});
      from = std::max(to, from + 1);
    }
    return looks;
  }

  // A look far away vouches for many poses, and takes five times as long: it is taken where none of those
  // beside found a fold nearby.
  [[nodiscard]] double far_mm(std::size_t from, std::size_t to) const {
    const bool near = (from > 0 && near_[from - 1]) || (to < near_.size() && near_[to]);
    return near ? least_mm_ : std::max(least_mm_, farthest_mm(from));
  }
  [[nodiscard]] double farthest_mm(std::size_t pose) const {
    return kFoldSearchShare * poses_[pose].blade.length;
  }

  // Poses from which the nearest fold is no nearer than the smallest found, one beside the other: farther on
  // the shape may have gone around one.
  void close_around(std::size_t pose, const elastica::ClampMargin& margin) {
    constexpr double kNearby = 0.2;  // of the farthest look
    const double clear = std::min(margin.fold_mm, margin.straight_mm);
    const bool near = clear < kNearby * farthest_mm(pose);
    open_[pose] = false;
    near_[pose] = near;
    const auto close = [&](std::size_t i) {
      const double left =
          clear - elastica::clamp_distance(held_[i], held_[pose], 0.5 * poses_[pose].blade.length);
      if (left >= least_mm_) {
        open_[i] = false;
        near_[i] = near;
      }
      return left > 0;
    };
    for (std::size_t i = pose; i-- > 0 && close(i);) {
    }
    for (std::size_t i = pose + 1; i < poses_.size() && close(i); ++i) {
    }
  }

  std::vector<BladePose> poses_;
  std::vector<elastica::ClampPair> held_;
  double least_mm_;
  std::vector<char> open_;  // nothing vouches for it yet
  std::vector<char> near_;  // what vouches for it found a fold nearby
};

}  // namespace

double rib_fold_mm(const StripPlan& strip, const MachineSettings& machine, double farthest_mm) {
  std::vector<BladePose> ends = end_poses(strip, machine), poses = rib_poses(strip, machine);
  poses.insert(poses.begin(), std::move(ends.front()));
  poses.push_back(std::move(ends.back()));
  return FoldAlong(std::move(poses), machine, farthest_mm).run();
}

}  // namespace hotblade::pipeline
