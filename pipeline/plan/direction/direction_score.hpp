// What a family of rib planes promises: from a few sections a score that no plan can be better than, and the
// score of a coarse plan on them.
#pragma once

#include <limits>
#include <optional>
#include <string>

#include "pipeline/plan/strips/strips.hpp"

namespace hotblade::pipeline {

// One family of planes and what it promises.
struct DirectionScore {
  Eigen::Vector3d normal;
  std::optional<surface::FanAxis> fan{};  // planes turn about it; `normal` is that of the middle one
  bool estimated = true;                  // from the sections alone: strips and score are at least these
  std::size_t strips = 0;                 // a run that is refused counts as many as its length asks for
  double covered_share = 0;               // of the design's area, by strips that are served
  double deviation_mm = 0;                // of the worst coarse rib; 0 when estimated
  double raggedness = 0;  // change of the ribs' length over each chain, as a share of the longest, summed
  double steepness = 0;   // mean over the ribs of the design's steepest slope, as a share of 60 degrees
  double mean_sine = 0, max_sine = 0;  // |sin slope| over the area of the sections, and its largest
  // strips + 100 (1 - covered) + deviation / tolerance + 2 raggedness + steepness, and a quarter more for a
  // fan; low is good.
  double score = 0;
  std::string refused{};  // why its plan was refused, where it was planned in full and others were tried
};

// A fan tilts its planes in their blocks, and its blades sag: it has to be better by more than this.
inline constexpr double kFanScore = 0.25;

// Planes and the design's sections by some of them: nine, or three in each of the blocks along the sweep.
struct DirectionTrial {
  DirectionScore score;
  TargetReport targets;
  double unseen_mm2 = 0;             // area that has no ribs: too steep, too short, alone
  std::vector<double> section_mm{};  // of the sweep that each rib stands for, chain by chain
};

// Return the sections of a family of planes and its score, which is at most that of plan_coarsely(). `normal`
// is that of parallel planes. Throw surface::FanError for an axis that does not go with the design.
[[nodiscard]] DirectionTrial try_direction(const surface::DesignSurface& design,
                                           const Eigen::Vector3d& normal, const Settings& settings);
[[nodiscard]] DirectionTrial try_fan(const surface::DesignSurface& design, const surface::FanAxis& axis,
                                     const Settings& settings);

// Lays the trial's sections out in strips and returns their score. Strips whose clamps would touch the table
// are not served. A plan that takes so many strips that its score would not be below `most` is given up: the
// trial's score then.
[[nodiscard]] DirectionScore plan_coarsely(const DirectionTrial& trial, const Settings& settings,
                                           double most = std::numeric_limits<double>::infinity());

}  // namespace hotblade::pipeline
