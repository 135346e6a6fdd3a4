// The cut program: what program.json holds (docs/program.md, format version 2). mm, rad, s; kappa 1/mm,
// lambda 1/mm^2.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "elastica/curve/elastica.hpp"
#include "pipeline/program/block.hpp"
#include "pipeline/program/compact_optional.hpp"
#include "pipeline/program/frame.hpp"
#include "pipeline/program/pose_row.hpp"
#include "pipeline/program/program_arms.hpp"
#include "pipeline/program/shared_frame.hpp"
#include "pipeline/settings/settings.hpp"
#include "robot/blade/blade.hpp"
#include "robot/pose/pose.hpp"
#include "robot/pose/waypoint.hpp"
#include "surface/read/file_format.hpp"

namespace hotblade::pipeline {

using robot::Pose;

// A planned rib: the section's target, the Bezier and the elastica that stand for it.
struct Rib {
  std::string id;
  Frame frame;
  std::vector<Eigen::Vector2d> target;  // after the kerf offset, rib frame
  // Control points of n cubics, 3 n + 1; several where one does not come near the elastica. Each stands for
  // an equal length of it; they join with their first derivatives.
  std::vector<Eigen::Vector2d> bezier;
  double lambda_residual = 0;
  elastica::Elastica elastica;
  double l2 = 0, h1 = 0, hausdorff_mm = 0;  // Bezier against elastica
  double design_deviation_mm = 0;           // largest distance of the elastica from the target
};

// Of the distance between cut and design that is allowed: a rib's Beziers are no farther from its elastica.
inline constexpr double kBezierShare = 0.1;
// The cubics of a rib, at most kMostCubics.
inline constexpr std::size_t kMostCubics = 64;
[[nodiscard]] std::vector<std::array<Eigen::Vector2d, 4>> cubics(const Rib& rib);

// A round number that single precision holds.
inline constexpr double kLargestLoad = 1e38;

// What a pose asks of the blade and the clamps (robot/blade/blade_section.hpp).
// Programs have six digits of each, and none is larger than kLargestLoad.
struct PoseLoads {
  float force_n = 0;                           // between the clamps, the same at both
  float moment_a_n_mm = 0, moment_b_n_mm = 0;  // in the blade at the clamps, counted as B kappa
  float stress_mpa = 0;                        // largest bending stress
  float droop_mm = 0, in_plane_sag_mm = 0;     // what weight moves the blade, over foam or all of it
};
template <>
struct Absence<PoseLoads> {
  static PoseLoads absent() { return {.force_n = std::numeric_limits<float>::quiet_NaN()}; }
  static bool is_absent(const PoseLoads& loads) { return std::isnan(loads.force_n); }
};

// What a pose of a strip is part of, in this order. The controller's own phases are
// robot::protocol::Phase.
enum class StripPhase : std::uint8_t {
  kForm,
  kPreheat,
  kApproach,
  kLeadIn,
  kCut,
  kLeadOut,
  kRetract,
  kTravel
};
inline constexpr std::array kStripPhases{StripPhase::kForm,    StripPhase::kPreheat, StripPhase::kApproach,
                                         StripPhase::kLeadIn,  StripPhase::kCut,     StripPhase::kLeadOut,
                                         StripPhase::kRetract, StripPhase::kTravel};
// Returns the word that programs have for it.
[[nodiscard]] const char* name(StripPhase phase);

// Where the blade and its clamps are at one time of a strip. A job has a million: in this order there are no
// gaps between members.
struct BladePose {
  PoseRow a, b;  // clamps, design frame
  double t = 0;  // s from the strip's start
  SharedFrame frame;
  elastica::Elastica blade;                     // whole blade, clamp A to clamp B, in the frame's plane
  CompactOptional<std::array<double, 2>> foam;  // arc lengths of the part that forms the design
  double margin = 0;                            // smallest eigenvalue of the second variation times length^2
  CompactOptional<double> margin_mm;            // the clamps may err this far; absent: not computed
  CompactOptional<PoseLoads> loads;             // absent: not computed
  CompactOptional<int> rib;                     // index of the rib that this pose cuts
  StripPhase phase = StripPhase::kForm;
  bool heat = false;
};

// Returns the middle of a pose's blade, in foam of the part there, in the design frame.
[[nodiscard]] Eigen::Vector3d middle_of(const BladePose& pose);

// One block and the motion that cuts it.
struct Strip {
  std::string id;
  double blade_length_mm = 0;
  Pose design_to_cell;
  Block block;  // `stock` in program files
  std::vector<Rib> ribs;
  std::vector<BladePose> poses;
  std::optional<StripArms> arms{};    // absent: no cell was given
  std::vector<ClampJoints> joints{};  // of the arms at each pose; none where no cell was given
};

// How far the cut is from the design, mm; `at` is the place of the largest.
struct Deviation {
  double max = 0, p99 = 0, rms = 0, mean = 0;
  Eigen::Vector3d at{0, 0, 0};
};

// Whether every limit held in the plan that a program came from.
enum class VerificationStatus { kPassed, kRefused };
[[nodiscard]] const char* name(VerificationStatus status);

struct Verification {
  VerificationStatus status = VerificationStatus::kRefused;
  double tolerance_mm = 0;
  Deviation deviation_mm;
  double uncut_mm2 = 0;
  std::vector<std::pair<std::string, double>> budget_mm;  // name, mm; in order
  std::size_t samples = 0;
  std::vector<std::string> not_checked;
};

// The design a program was planned from, and how it was read.
struct DesignData {
  std::string file, sha256, source_units;
  std::optional<surface::FileFormat> format{};  // as it was read; absent: of version 1, which does not say
  double scale_to_mm = 1;
  char up = 'z';
  Keep keep = Keep::kBelow;
  std::size_t vertices = 0, faces = 0;
  std::array<Eigen::Vector3d, 2> bbox_mm{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
};

struct Program {
  std::string created_by;
  DesignData design;
  Settings settings;  // the resolved configuration it was planned with
  robot::BladeSet blade;
  std::vector<Strip> strips;
  Verification verification;
  std::vector<std::string> overrides;  // what was refused and run all the same; empty: nothing
  std::optional<ProgramCell> cell{};   // absent: no cell was given
};

// Returns the canonical JSON text: fixed key order, shortest round-trip numbers, one pose or rib a line.
[[nodiscard]] std::string to_json(const Program& program);

// Returns the program of a text, every number checked for finiteness, range and size. Throws Error
// (kBadInput) with `file: where: what (value, limit): hint`, also for fewer strips than `least_strips`, and
// kNotCuttable for what a refused plan found.
[[nodiscard]] Program parse_program(const std::string& text, const std::string& file_name,
                                    std::size_t least_strips = 1);

// Returns the program of a file, unpacked where its name ends in .gz. Throws Error: kFile when it cannot be
// read, kNotCuttable when it is what a refused plan found, kBadInput when it is not a program.
[[nodiscard]] Program read_program(const std::filesystem::path& file);

// Returns the controller's waypoints of a strip: its poses in the cell frame, times rounded to microseconds.
[[nodiscard]] std::vector<robot::Waypoint> waypoints(const Strip& strip);

}  // namespace hotblade::pipeline
