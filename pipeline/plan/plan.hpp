// From a design to a verified program: the stages in order, with everything a report needs.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/plan/motion/motion.hpp"
#include "pipeline/plan/motion/other_blades.hpp"
#include "pipeline/plan/sweep/sweep_search.hpp"
#include "pipeline/program/program.hpp"
#include "pipeline/stock/nest.hpp"
#include "pipeline/verify/verify.hpp"
#include "robot/blade/blade_section.hpp"

namespace hotblade::pipeline {

// A strip laid out, and the motion that cuts it.
struct PosedStrip {
  StripPlan strip;
  BladeMotion motion;
};

// Facts of one strip for the report.
struct StripFacts {
  std::string id;
  std::size_t ribs = 0, projected_ribs = 0;
  double blade_length_mm = 0, smallest_margin = 0;  // the margin at the ribs and over the motion
  double worst_fit_mm = 0, worst_bezier_mm = 0, largest_lambda_residual = 0;
  double joint_fit_mm = 0;  // of the fit, what fitting the strips together at their seams added to its own
  SeamFacts seam;           // largest, to the strips before that it meets
  MotionFacts motion;
  double deviation_max_mm = 0, deviation_bound_mm = 0;  // of samples, and proven of all that they stand for
  double droop_error_mm = 0;  // what droop and twist move the surface where it is steepest
  double stock_volume_mm3 = 0;
  double band_min_mm = 0, band_max_mm = 0;  // that the blade melts, square to its width, by its speed
  double plinth_mm = 0;                     // the block stands this far above the table
  double foam_kept_share = 0;               // of it that becomes the part (pipeline/verify/foam_share.hpp)
  double plane_turn_rad = 0;            // between the first and the last rib's plane; 0: they are parallel
  std::optional<BladeTrials> blades{};  // of a plan that passed

  // Returns its deviation with what of its sag is not known.
  [[nodiscard]] double deviation_with_sag_mm() const {
    return deviation_bound_mm + robot::kSagUnknownShare * (droop_error_mm + motion.in_plane_sag_mm);
  }
  // Returns the radius where the blade is bent most; 0 for a straight one.
  [[nodiscard]] double smallest_radius_mm() const {
    return motion.largest_curvature_per_mm > 0 ? 1 / motion.largest_curvature_per_mm : 0;
  }
};

// A strip as it is handed out, with what is reported of it.
struct PlannedStrip {
  Strip strip;
  StripFacts facts;
  std::vector<Refusal> refusals;
  std::vector<std::string> warnings;
};

// Returns the name of a clamp's coordinate by its number: along_a, across_a, turn_a, along_b, across_b,
// turn_b.
[[nodiscard]] std::string clamp_coordinate_name(std::size_t coordinate);

// One try at the plan, in the order they were made.
struct Decision {
  SweepWay way = SweepWay::kEven;
  std::vector<SweptFit> fits;       // of its parts
  Eigen::Vector3d normal{0, 0, 0};  // of the planes, of a fan the middle one
  bool fan = false;
  std::size_t strips = 0, ribs = 0;
  double fit_mm = 0;        // what the fit itself was off, where that was found
  double deviation_mm = 0;  // verified; 0 where it never came to that
  bool passed = false, taken = false;
  bool alone = false;  // each strip looked at by itself, and nothing of what they leave uncut
  std::optional<Refusal> stopped_by{};  // the first of what it failed by

  // Returns what it failed by, in words; empty: nothing.
  [[nodiscard]] std::string why() const { return stopped_by ? describe(*stopped_by) : ""; }
};

// A change of settings with which a refused plan was planned again and passed (pipeline/advice/advice.hpp).
struct TriedRemedy {
  std::vector<std::string> assignments;  // as `--set` takes them: "design.tolerance_mm=1.3"
  std::string without;                   // the setting that was left out instead; empty: none
  std::string why;
  double deviation_mm = 0, tolerance_mm = 0;
  std::size_t strips = 0;
  std::string verdict;  // its colour
  // Of a number that was changed: the smallest change that passed and the largest that did not, both planned,
  // or refused as today's; with their unit.
  struct Narrowed {
    double passes = 0, fails = 0;
    std::string unit;
  };
  std::optional<Narrowed> narrowed{};
};

// A smooth face of a design with creases (surface/slice/creases.hpp), planned as a design of its own: what of
// the plan's lists is its.
struct FacePlanned {
  struct Range {
    std::size_t first = 0, count = 0;
  };
  Range strips, decisions, ranking;
  std::size_t strips_lower_bound = 1;  // by the face's area
};

// What one stage of the plan took.
struct StageTime {
  std::string stage;
  double seconds = 0, processor_s = 0;  // by the clock, and of all threads of the process
};

// A program with everything a report says of it.
struct PlanResult {
  Program program;  // strips that could be planned; verification says passed or refused
  std::vector<StripFacts> strips;
  // In the order of what the Beziers of their sections say, or of the strips that their rows of blocks take.
  std::vector<PlanesTried> ranking;
  std::vector<Refusal> refusals;
  std::vector<std::string> warnings;
  VerifyReport verification;
  double spacing_mm = 0;  // largest between the ribs of a strip
  std::vector<Decision> decisions;
  std::vector<FacePlanned> faces;  // that lie apart or meet in creases, in the order of the strips; or none
  std::size_t strips_lower_bound = 1;  // by the design's size and area: fewer strips cannot cut it
  std::vector<TriedRemedy> remedies;   // what was tried and passed
  std::optional<Nesting> foam;         // what to buy, where settings say what is sold
  std::vector<StageTime> times;
};

// `progress` is told the stage and the share of the whole done, by one thread at a time; what it throws ends
// the plan.
struct PlanHooks {
  std::function<void(const std::string&, double)> progress = [](const std::string&, double) {};
  gpu::Backend backend = gpu::Backend::kCpu;  // of the verification's distances; changes no value
  // Whether a refused plan is handed on all the same: then one of many strips too is posed as it would run.
  bool refused_too = false;
};

// Returns the plan of a design whose health was checked (no blockers). Throws Error (kNotCuttable) when
// slice.fan_axis does not go with the design.
[[nodiscard]] PlanResult plan(const surface::DesignSurface& design, const Settings& settings,
                              const PlanHooks& hooks);

// Measures and judges a plan anew whose poses have other times than it was planned with, as for a cell's
// arms: where the melted band depends on the speed, it cuts something else.
void measure_again(const surface::DesignSurface& design, gpu::Backend backend, PlanResult& result);

}  // namespace hotblade::pipeline
