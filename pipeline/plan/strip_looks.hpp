// Strips as they are posed and measured on the way to a plan. What is known of one serves as long as it is
// fitted to the same blades: of the next plan only what changed is posed and measured again.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

#include "pipeline/plan/plan.hpp"
#include "pipeline/plan/sweep/swept_bands.hpp"
#include "pipeline/verify/verify.hpp"

namespace hotblade::pipeline {

// Sets the narrowest and the widest band that a strip's blade melts, by the speeds of its poses.
void set_bands(const std::vector<BladePose>& poses, const Settings& settings, StripFacts& facts);

// Returns what the strips of a plan melt, each by the speeds of its own motion; none where it has none.
[[nodiscard]] std::vector<std::shared_ptr<const SweptBands>> bands_of(const std::vector<StripPlan>& strips,
                                                                      const Settings& settings);

class StripLooks {
 public:
  explicit StripLooks(MotionLook look) : look_(look) {}

  // Poses these strips, side by side, but for those that are known. In full looks these are the strips of the
  // plan before, as poses take much memory, in coarse ones all that were ever looked at. `posed` is told the
  // share that is done.
  void pose(const std::vector<StripPlan>& strips, const Settings& settings,
            const std::function<void(double)>& posed);
  [[nodiscard]] std::size_t count() const { return looked_.size(); }
  // Returns how many strips were not measured since they were posed.
  [[nodiscard]] std::size_t fresh() const;

  // Measures the cut of each strip that is fresh; `like` has the settings and the blade. Nothing is said of
  // what of the design is left uncut. Where the look is full the blades are found again from their clamps.
  void measure_fresh(const Program& like, const surface::DesignSurface& design, const VerifyOptions& options);

  // What is known of all strips, without their ribs and poses: facts, refusals, the largest deviation.
  [[nodiscard]] PlanResult known() const;

  // Moves all strips, with their ribs and poses, into a plan that is to be verified, and back with what that
  // found of each.
  void give(PlanResult& result);
  void take_back(PlanResult& result);

 private:
  struct Looked {
    StripPlan plan;
    PlannedStrip planned;
    bool measured = false;
    double deviation_mm = 0, bound_mm = 0;
    Eigen::Vector3d deviation_at{0, 0, 0};
    std::vector<Refusal> branch{};  // why its clamps do not lead the blade as planned
  };

  MotionLook look_;
  std::vector<Looked> looked_;  // in the order of the plan
  std::vector<Looked> others_;  // of plans before
};

}  // namespace hotblade::pipeline
