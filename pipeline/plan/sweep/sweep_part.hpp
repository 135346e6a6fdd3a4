// One part of a design on the way to its strip: what lies behind some seams, and the family that follows it.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "pipeline/plan/sweep/sweep_cost.hpp"
#include "pipeline/plan/sweep/sweep_joint.hpp"
#include "pipeline/plan/sweep/sweep_strip.hpp"

namespace hotblade::pipeline {

// Called before every fit of a part, from all threads; what it throws ends the search at once.
using WatchSweeps = std::function<void()>;

struct SweepPart {
  RibAxes axes;
  std::vector<SweepSeam> seams;
  std::shared_ptr<const WasteSurface> surface;  // the design's, or the triangles near the part
  int rib_splits = 0;  // seams that ribs end at, beyond those that their length asks for
  std::shared_ptr<const SweptBands> bands =
      nullptr;  // by the speeds of its strip in a former plan; none: not known
};

// How a strip is made steadier against its clamps' errors: by a fit that is pulled to what they move least,
// and by a blade that is at least as long as said. Zeros: not at all.
struct Steadying {
  double weight = 0;  // ClampPull
  double blade_mm = 0;
};

// What a fit costs and how close it is.
struct SweepEffort {
  int coefficients, sections;
  double sample_mm;
  std::vector<int> exponents;
  int most_iterations;
  double calm = 1;
  bool turn_planes = false;  // SweepFitOptions
  Steadying steadying{};
  bool of_few = false;  // of a dense design
};

[[nodiscard]] SweepEffort cheap_effort();
[[nodiscard]] SweepEffort close_effort();
[[nodiscard]] SweepEffort final_effort(int coefficients, double calm, const Steadying& steadying = {});

// A fit, what weight moves the cut where the design is steepest, and how stable its blade is.
struct PartFit : SweepFitReport {
  double blade_length_mm = 0;  // that it was fitted with
  double sag_mm = 0, margin = 0;
  std::shared_ptr<const SweepSag> formed_by;  // what the fitted sections were moved by; none: weightless
  std::shared_ptr<const SweepSag> sag;        // of the fit itself; none where there is no fit
  std::optional<Refusal> refusal;             // why there is none
  // The deviation, with what of the sag is not known and what the blade's limits are missed by; where there
  // is no fit, by how much the part is too large or too curved for one, above anything a fit may have.
  double cost_mm = 0;
  Eigen::AlignedBox<double, 2> extent;  // of the part along the sweep and along the ribs
  double height_mm = 0;                 // of its middle, along y
  double stock_share = 0;               // of the largest block, by the edge that fills it most
  double turn_rad = 0;                  // SweepData
  std::optional<SweepGap> gap;          // SweepData

  [[nodiscard]] bool holds() const { return !refusal.has_value(); }
};

// A part's strip, or why it has none.
struct PartPlan {
  PartFit fit;
  std::optional<StripPlan> strip;
  std::optional<Refusal> refusal;
  double calm = 0;     // of the strip's fit (SweepFitOptions)
  double fold_mm = 0;  // by which its blade snaps at the ribs (plan/motion/rib_fold.hpp)
  Steadying steadying{};
  std::optional<HeldBlade> held{};             // of a strip that was looked at for a steadier blade
  std::shared_ptr<const PartPlan> unsteady{};  // what it was before it was made steadier; none: it was not
  // What its strip was found to be off by, with what of its sag is not known, beyond what its fit was off by
  // at its samples; none: it was not looked at.
  std::optional<double> beyond_fit_mm{};
};

// Pulls towards few and smooth tensions that parts are planned with, one after the other, until their blades
// hold. With steps of six in place of two and a half forty dented panels take four strips more.
inline constexpr std::array<double, 7> kCalms{1, 2.5, 6, 15, 36, 90, 216};

// Fits the parts of a design.
class PartFitter {
 public:
  PartFitter(const Settings& settings, const WatchSweeps& watch) : settings_(settings), watch_(watch) {}

  // A part's size and slopes, and what of them no fit can mend.
  [[nodiscard]] PartFit measured(const SweepPart& part) const;

  // The family near a part, from `start` or from flat blades.
  [[nodiscard]] PartFit fit(const SweepPart& part, const SweepEffort& effort,
                            const PartFit* start = nullptr) const;

  // Closer and closer fits with more and more ribs, as long as these help; calmer ones, and none but those
  // that are calmer than `calmer_than`, where the blade does not serve or its clamps' errors would snap it at
  // a rib.
  [[nodiscard]] PartPlan plan(const SweepPart& part, const PartFit& start, double calmer_than = 0) const;

  // The plan with the blade, and the tension, that the clamps' errors move less, where the error budget is
  // binding (design.over_budget) and these are most of what the strip's blade adds to it: the lengths of the
  // list from its own on, as long as they help.
  [[nodiscard]] PartPlan steadied(const SweepPart& part, PartPlan plan) const;

  // A plan's fit carried on with the part as it is now, as by other bands.
  [[nodiscard]] PartPlan again(const SweepPart& part, const PartPlan& plan) const;

  // Strips that meet at seams fitted together, from the plans of their own; all parts have a strip. Where no
  // blade takes what a strip would be so, it goes towards it as far as one does. `met` has what they were
  // when they were last fitted so, or their own plans; those that are `settled` and meet no others than such
  // stay so.
  [[nodiscard]] std::vector<PartPlan> join(const std::vector<SweepPart>& parts,
                                           const std::vector<PartPlan>& plans, std::vector<PartPlan> met,
                                           const std::vector<bool>& settled) const;

  // What a part's fit may be off by, as far as is known, for its strip to stay within the tolerance.
  [[nodiscard]] double most_mm(const PartPlan& plan) const;

  // Foam between a rib's end and its clamp, and a little more.
  [[nodiscard]] double clear_mm() const;
  // Longest edge of what a block holds, and longest rib that a blade reaches over.
  [[nodiscard]] double longest_edge_mm() const;
  [[nodiscard]] double longest_rib_mm() const;

 private:
  [[nodiscard]] PartPlan plan_at(const SweepPart& part, const PartFit& start, double calm) const;
  [[nodiscard]] double wanted_mm() const;
  [[nodiscard]] double near_enough_mm(const SweepPart& part) const;
  [[nodiscard]] double blade_for(double rib_mm) const;
  [[nodiscard]] Refusal unreached(double rib_mm) const;
  void explain(const SweepPart& part, PartPlan& plan) const;
  // A part moved for such an effort; fits, and the strips made of them, take their sections of one.
  using MovedPart = std::shared_ptr<const MovedSurface>;
  [[nodiscard]] MovedPart moved_of(const SweepPart& part, const SweepEffort& effort,
                                   const SweepSag* sag) const;
  [[nodiscard]] SweepData sections_of(const MovedSurface& moved, const SweepEffort& effort) const;
  // `moved` is what the fit's sections were taken of.
  [[nodiscard]] PartFit fit(const SweepPart& part, const SweepEffort& effort, const PartFit* start,
                            MovedPart& moved) const;
  [[nodiscard]] PartFit measured(const SweepData& data) const;
  [[nodiscard]] std::optional<Refusal> refusal_of(const SweepData& data) const;
  [[nodiscard]] double cost_of(const SweepData& data) const;
  [[nodiscard]] SweepFitOptions options_for(const SweepData& data, const SweepEffort& effort) const;
  void weigh(PartFit& fit, const RibAxes& axes, const SweepBlade& blade, const SweepData& data) const;
  [[nodiscard]] double cost_of(const PartFit& fit, bool turns) const;
  // By which a plan's blade snaps at its ribs, and by which it may: those that snap sooner are no better than
  // what they come of.
  [[nodiscard]] double fold_of(const PartPlan& plan) const;
  [[nodiscard]] double least_fold_mm(const PartPlan& plan) const;
  [[nodiscard]] HeldBlade held(const PartPlan& plan) const;
  [[nodiscard]] JointPart joint_part(const MovedSurface& moved, const PartPlan& own, const PartPlan& met,
                                     bool held) const;
  void measure_seams(const std::vector<PartSeam>& seams, std::vector<PartPlan>& met) const;
  [[nodiscard]] PartPlan met(const MovedSurface& moved, const JointPart& joint, const SweepFamily& together,
                             const PartPlan& own) const;
  [[nodiscard]] std::optional<PartPlan> steadier(const SweepPart& part, const PartPlan& plan,
                                                 const PartFit& from, const Steadying& steadying) const;
  [[nodiscard]] SweptStrip strip_of(const SweepPart& part, const SweepEffort& effort, PartFit& fit,
                                    MovedPart moved) const;

  const Settings& settings_;
  const WatchSweeps& watch_;
};

}  // namespace hotblade::pipeline
