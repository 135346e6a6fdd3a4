// The resolved configuration: built-in defaults < --config files in order < --set key=value < flags.
// TOML sections and keys carry the member names below; unknown keys are errors. docs/configuration.md lists
// them.
#pragma once

#include <array>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "robot/blade/blade.hpp"
#include "robot/pose/clamp_offset.hpp"

namespace hotblade::pipeline {

// The foam that stays: below or above the surface, or behind or before its face normals.
enum class Keep { kBelow, kAbove, kBack, kFront };
// May one blade cut both sides of a window?
enum class Gaps { kBridge, kApart };
// May one blade go over a fold that it can round, but stands alone (surface/slice/creases.hpp)? What a plan
// chose stands in its program.
enum class ShallowFolds { kAuto, kCrossed, kParted };
// What becomes of a plan whose error budget is over the tolerance.
enum class OverBudget { kWarn, kRefuse };

// Return the words that settings and programs have for them.
[[nodiscard]] std::string_view name(Keep keep);
[[nodiscard]] std::string_view name(Gaps gaps);
[[nodiscard]] std::string_view name(ShallowFolds folds);
[[nodiscard]] std::string_view name(OverBudget over_budget);

struct DesignSettings {
  std::string units;            // mm, cm, m, in, ft; required, no default
  std::string up = "z";         // z or y
  std::string format = "auto";  // obj, stl, ply, gltf, or auto: as the file tells
  Keep keep = Keep::kBelow;
  std::string group;  // group or object of the file to cut; empty: the whole file
  // The faces that look in this direction of the design frame are cut; absent, all are.
  std::optional<std::array<double, 3>> facing;
  double facing_max_deg = 80;     // between a face's normal and `facing`
  double stitch_mm = 0;           // borders of the design this close to each other are joined
  double tolerance_mm = 1.0;      // accepted deviation between cut and design
  double max_uncut_share = 0.01;  // of the design's area that no strip reaches
  OverBudget over_budget = OverBudget::kWarn;
};

struct SliceSettings {
  std::optional<std::array<double, 3>> direction;  // normal of the rib planes, design frame; absent: searched
  // The line that rib planes turn about instead: a point of it (mm) and its direction, design frame.
  std::optional<std::array<double, 6>> fan_axis;
  double spacing_mm = 0;  // largest distance between the ribs of a strip; 0: as few ribs as the fit takes
  Gaps gaps = Gaps::kBridge;
  ShallowFolds shallow_folds = ShallowFolds::kAuto;
};

struct FitSettings {
  double lambda_threshold = 0.22;  // ribs whose Bezier is above are projected (the paper's best class)
  double deviation_share = 0.5;    // of the tolerance that one rib's elastica may deviate from its target
  int max_splits = 12;             // along a rib
};

struct BladeSettings : robot::BladeSet {
  // Spring steel of 8 x 0.5 mm (samples/blades/spring_steel_1_4310.toml).
  BladeSettings()
      : BladeSet{{{8, 0.5, 190000, 1010}, 0.3, 1.5, 7900, 1.0, {}, 0}, {400, 600, 800, 1000, 1200, 1500}} {}
  double min_margin = 1.0;  // smallest accepted eigenvalue of the second variation times length^2
  // The smallest accepted clamp error that snaps the blade; 0 takes it from the machine's errors.
  double min_margin_mm = 0;
  double length_error_mm = 0;  // every blade is longer between its clamps by this than its free length
};

struct StockSettings {
  std::array<double, 3> max_size_mm{1200, 1200, 600};
  std::vector<std::array<double, 3>> sizes_mm;  // that foam is sold in; empty: not known
  double saw_mm = 0;                            // foam that a saw takes with each cut
  double base_mm = 50;                          // foam left under the lowest kept point
  double border_mm = 10;                        // foam around the design on the other sides
  double clearance_mm = 40;                     // clamps and table stay at least this far from the stock
};

struct MotionSettings {
  double feed_mm_s = 7, min_feed_mm_s = 1;
  double travel_mm_s = 100, accel_mm_s2 = 500, jerk_mm_s3 = 0;
  double angular_rad_s = 1, angular_accel_rad_s2 = 2, angular_jerk_rad_s3 = 0;
  double waypoint_s = 0.05;  // 0.005 to 0.05
  double preheat_s = 2;
  double approach_mm = 60;  // the blade is formed this far above the stock
  double lead_mm = 0;       // lead_in and lead_out run this far outside the stock; 0: as far as needed
};

struct MachineSettings {
  std::array<double, 3> envelope_mm{4000, 4000, 3000};  // centred on the table in x and y, z from 0
  // The stock stands this far above the table; 0 is as far as needed (pipeline/plan/motion/motion.hpp).
  double plinth_mm = 0;
  // The errors of each clamp, for the error budget. Repeatability of mid-size arms is 0.03 to 0.1 mm (ISO
  // 9283 data sheets); calibrated, their absolute error is a few tenths: put your cell's here.
  double clamp_error_mm = 0.1, clamp_error_rad = 0.0002;
  // What is known of these errors (`hotblade calibrate`): how far each clamp holds the blade from where it is
  // told to be.
  robot::ClampOffsets clamps;
};

// What stands on the report and the sheets of a job; it changes no cut.
struct JobSettings {
  std::string number, date, author;  // any text; empty: left out
  std::string language = "en";       // of the sheets: en or de
};

struct Settings {
  DesignSettings design;
  SliceSettings slice;
  FitSettings fit;
  BladeSettings blade;
  StockSettings stock;
  MotionSettings motion;
  MachineSettings machine;
  JobSettings job;
};

// A setting given by a flag of its own; errors name the flag.
struct SettingsFlag {
  std::string flag;   // "--units"
  std::string key;    // "design.units"
  std::string value;  // as for assignments
  bool said = true;   // false: it is at its default where it is copied from
};

// The sources of settings, in the order in which they are applied.
struct SettingsSources {
  std::vector<std::filesystem::path> files;
  std::vector<std::string>
      assignments;  // "design.keep=back", value in TOML syntax, bare words taken as strings
  std::vector<SettingsFlag> flags;
};

// One key as users see it: what docs/configuration.md and `hotblade config defaults` say about it.
struct SettingInfo {
  std::string key;            // "blade.kerf_mm"
  std::string unit;           // empty: none
  std::string default_value;  // TOML; "absent" for a key without a default
  std::string range;          // "0.1 to 100", or the words allowed
  std::string description;
};
// All keys, in the order of docs/configuration.md.
[[nodiscard]] std::vector<SettingInfo> describe_settings();

// The settings that the sources amount to. Throws Error: kFile for a file that cannot be read, kBadSettings
// for syntax, unknown keys, wrong types and values out of range, each with `file:line: key (value, limit):
// hint`. It does not ask for units.
[[nodiscard]] Settings resolve(const SettingsSources& sources);

// Settings with the keys that a source said, be it what they are by default.
struct SaidSettings {
  Settings settings;
  std::set<std::string> said;
};
// Returns the same with what was said. Throws as resolve() does.
[[nodiscard]] SaidSettings resolve_said(const SettingsSources& sources);

// Checks ranges and that the parts fit together (kerf at least the thickness, lengths ascending, feed at most
// travel); throws as resolve does.
void validate(const Settings& settings);

// Returns the settings with the blades as long as they are: blade.length_error_mm added to every free length,
// and 0.
[[nodiscard]] Settings with_true_lengths(Settings settings);

// All settings, as program.json keeps them.
[[nodiscard]] nlohmann::ordered_json to_json(const Settings& settings);
[[nodiscard]] std::string to_toml(const Settings& settings);  // commented, round-trips through resolve

}  // namespace hotblade::pipeline
