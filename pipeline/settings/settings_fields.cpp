#include "pipeline/settings/settings_fields.hpp"

#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <type_traits>

#include "pipeline/settings/json_text.hpp"

namespace hotblade::pipeline {
namespace {

using Place = SettingPlace;
using S = Settings;

// Ranges are wide: they catch a slip of unit or comma, not an unusual machine. Where physics gives the limit,
// it is checked between keys instead (settings.cpp, check_together).
constexpr SettingField kFields[] = {
    {"design", "units", "", 0, 0, "|mm|cm|m|in|ft",
     "Unit of the file's numbers; required, here or as --units, but for glTF",
     [](S& s) -> Place { return &s.design.units; }},
    {"design", "up", "", 0, 0, "z|y", "Axis of the file that points up; y for glTF",
     [](S& s) -> Place { return &s.design.up; }},
    {"design", "format", "", 0, 0, "auto|obj|stl|ply|gltf",
     "Format of the file; auto: as its bytes and its name tell",
     [](S& s) -> Place { return &s.design.format; }},
    {"design", "keep", "", 0, 0, kKeepWords,
     "Foam that stays: below or above the surface, or behind or before the face normals",
     [](S& s) -> Place { return &s.design.keep; }},
    {"design", "group", "", 0, 0, kAnyText, "Group or object of the file to cut; empty: the whole file",
     [](S& s) -> Place { return &s.design.group; }},
    {"design", "facing", "", -1000, 1000, "",
     "Cut the faces that look in this direction of the design frame, as of a solid; absent: all",
     [](S& s) -> Place { return &s.design.facing; }},
    {"design", "facing_max_deg", "deg", 0, 180, "", "Largest angle between a face's normal and design.facing",
     [](S& s) -> Place { return &s.design.facing_max_deg; }},
    {"design", "stitch_mm", "mm", 0, 10, "",
     "Border vertices of the design this close to another border are joined; 0: none",
     [](S& s) -> Place { return &s.design.stitch_mm; }},
    {"design", "tolerance_mm", "mm", 0.01, 100, "", "Accepted deviation between cut and design",
     [](S& s) -> Place { return &s.design.tolerance_mm; }},
    {"design", "max_uncut_share", "", 0, 1, "",
     "Share of the design's area that may stay out of reach of every strip",
     [](S& s) -> Place { return &s.design.max_uncut_share; }},
    {"design", "over_budget", "", 0, 0, kOverBudgetWords,
     "What an error budget over the tolerance does: the plan is amber with a warning, or refused",
     [](S& s) -> Place { return &s.design.over_budget; }},

    {"slice", "direction", "", -1000, 1000, "",
     "Normal of the rib planes in the design frame, of any length; absent: searched",
     [](S& s) -> Place { return &s.slice.direction; }},
    {"slice", "fan_axis", "mm", -1e6, 1e6, "",
     "Line that the rib planes turn about instead, in the design frame: a point x, y, z, then a direction of "
     "any length",
     [](S& s) -> Place { return &s.slice.fan_axis; }},
    {"slice", "spacing_mm", "mm", 0, 500, "",
     "Largest distance between the ribs of a strip, 0.5 or more; left out or 0: as few ribs as the fit takes",
     [](S& s) -> Place { return &s.slice.spacing_mm; }},
    {"slice", "gaps", "", 0, 0, kGapsWords,
     "Windows and notches: one strip across them where it serves both sides, or a block for each side",
     [](S& s) -> Place { return &s.slice.gaps; }},
    {"slice", "shallow_folds", "", 0, 0, kShallowFoldsWords,
     "Folds that a blade could round but no family follows far to both sides: strips across them, or a face "
     "to "
     "each side; auto: across where that takes fewer strips than there are faces",
     [](S& s) -> Place { return &s.slice.shallow_folds; }},

    {"fit", "lambda_threshold", "", 0, 10, "",
     "Ribs with a larger lambda-residual are projected before the fit",
     [](S& s) -> Place { return &s.fit.lambda_threshold; }},
    {"fit", "deviation_share", "", 0.01, 1, "",
     "Share of the tolerance that one rib's elastica may use up; the fit of a swept strip wants half of it",
     [](S& s) -> Place { return &s.fit.deviation_share; }},
    {"fit", "max_splits", "", 0, 1000, "",
     "Most splits along a rib, beyond those its length asks for: no strip is longer than a blade or a block",
     [](S& s) -> Place { return &s.fit.max_splits; }},

    {"blade", "free_lengths_mm", "mm", 50, 5000, "",
     "Blades at hand: free lengths between the clamps, ascending",
     [](S& s) -> Place { return &s.blade.free_lengths_mm; }},
    {"blade", "width_mm", "mm", 0.1, 100, "", "Width of the blade's section, along the rib planes' normal",
     [](S& s) -> Place { return &s.blade.width_mm; }},
    {"blade", "thickness_mm", "mm", 0.05, 5, "", "Thickness of the blade's section",
     [](S& s) -> Place { return &s.blade.thickness_mm; }},
    {"blade", "youngs_modulus_mpa", "MPa", 1000, 500000, "", "Young's modulus",
     [](S& s) -> Place { return &s.blade.youngs_modulus_mpa; }},
    {"blade", "poisson_ratio", "", 0, 0.5, "", "Poisson's ratio, for the blade's twist under its weight",
     [](S& s) -> Place { return &s.blade.poisson_ratio; }},
    {"blade", "yield_strength_mpa", "MPa", 10, 5000, "", "Yield strength",
     [](S& s) -> Place { return &s.blade.yield_strength_mpa; }},
    {"blade", "safety", "", 1, 10, "", "Bending stress stays below the yield strength divided by this",
     [](S& s) -> Place { return &s.blade.safety; }},
    {"blade", "density_kg_m3", "kg/m3", 100, 25000, "", "Density, for the blade's sag",
     [](S& s) -> Place { return &s.blade.density_kg_m3; }},
    {"blade", "kerf_mm", "mm", 0.05, 20, "",
     "Melted band of a blade that moves square to its width, the thickness included",
     [](S& s) -> Place { return &s.blade.kerf_mm; }},
    {"blade", "min_margin", "", 0, 1000, "",
     "Smallest accepted stability margin: eigenvalue of the second variation times length squared",
     [](S& s) -> Place { return &s.blade.min_margin; }},
    {"blade", "min_margin_mm", "mm", 0, 20, "",
     "Smallest accepted clamp error that makes the blade snap; 0 takes twice the machine's clamp errors",
     [](S& s) -> Place { return &s.blade.min_margin_mm; }},

    {"blade", "length_error_mm", "mm", -20, 20, "",
     "Every blade is longer between its clamps by this than its free length says; calibrate finds it",
     [](S& s) -> Place { return &s.blade.length_error_mm; }, true},
    {"blade", "stiffness_error", "", -0.9, 9, "",
     "The blade is stiffer by this share than width, thickness and modulus say; its sag and forces depend on "
     "it",
     [](S& s) -> Place { return &s.blade.stiffness_error; }, true},

    {"foam", "band_mm_at_mm_s", "", 0.01, 1000, "",
     "Melted band by the blade's speed square to itself: pairs of mm/s and mm, speeds rising and bands not, "
     "as "
     "[[1, 2.6], [3, 1.6], [7, 1.0]]; absent: blade.kerf_mm at every speed",
     [](S& s) -> Place { return &s.blade.melt.band_mm_at_mm_s; }, true},
    {"foam", "melt_mm2_s", "mm2/s", 0, 10000, "",
     "Instead of pairs, band = melt_mm2_s / (speed + loss_mm_s): area that a length of blade melts in a "
     "second; 0: not given",
     [](S& s) -> Place { return &s.blade.melt.melt_mm2_s; }, true},
    {"foam", "loss_mm_s", "mm/s", 0, 1000, "",
     "Speed at which as much heat goes into melting as is lost beside the cut",
     [](S& s) -> Place { return &s.blade.melt.loss_mm_s; }, true},

    {"stock", "max_size_mm", "mm", 10, 10000, "", "Largest foam block: length, width, height",
     [](S& s) -> Place { return &s.stock.max_size_mm; }},
    {"stock", "sizes_mm", "mm", 10, 10000, "",
     "Sizes that foam is sold in: length, width, height, as [[2500, 1250, 600], [1250, 1250, 600]]; absent: "
     "no "
     "list of what to buy",
     [](S& s) -> Place { return &s.stock.sizes_mm; }, true},
    {"stock", "saw_mm", "mm", 0, 50, "", "Foam that a cut takes where blocks are sawn out of what is bought",
     [](S& s) -> Place { return &s.stock.saw_mm; }, true},
    {"stock", "base_mm", "mm", 0, 2000, "", "Foam left under the lowest kept point",
     [](S& s) -> Place { return &s.stock.base_mm; }},
    {"stock", "border_mm", "mm", 0, 1000, "", "Foam around the design on the other sides",
     [](S& s) -> Place { return &s.stock.border_mm; }},
    {"stock", "clearance_mm", "mm", 0, 1000, "", "Clamps and table stay at least this far from the stock",
     [](S& s) -> Place { return &s.stock.clearance_mm; }},

    {"motion", "feed_mm_s", "mm/s", 0.1, 1000, "", "Cutting feed at the fastest point of the blade",
     [](S& s) -> Place { return &s.motion.feed_mm_s; }},
    {"motion", "min_feed_mm_s", "mm/s", 0.01, 1000, "",
     "Cutting feed at the slowest point of the blade, at least",
     [](S& s) -> Place { return &s.motion.min_feed_mm_s; }},
    {"motion", "travel_mm_s", "mm/s", 1, 5000, "", "Fastest clamp speed outside the foam",
     [](S& s) -> Place { return &s.motion.travel_mm_s; }},
    {"motion", "accel_mm_s2", "mm/s2", 1, 100000, "", "Largest acceleration of a clamp",
     [](S& s) -> Place { return &s.motion.accel_mm_s2; }},
    {"motion", "jerk_mm_s3", "mm/s3", 0, 10000000, "", "Largest jerk of a clamp, 1 or more; 0: not limited",
     [](S& s) -> Place { return &s.motion.jerk_mm_s3; }, true},
    {"motion", "angular_rad_s", "rad/s", 0.001, 20, "", "Largest turning speed of a clamp",
     [](S& s) -> Place { return &s.motion.angular_rad_s; }},
    {"motion", "angular_accel_rad_s2", "rad/s2", 0.001, 1000, "", "Largest turning acceleration of a clamp",
     [](S& s) -> Place { return &s.motion.angular_accel_rad_s2; }},
    {"motion", "angular_jerk_rad_s3", "rad/s3", 0, 100000, "",
     "Largest turning jerk of a clamp, 0.01 or more; 0: not limited",
     [](S& s) -> Place { return &s.motion.angular_jerk_rad_s3; }, true},
    {"motion", "waypoint_s", "s", 0.005, 0.05, "", "Time between waypoints",
     [](S& s) -> Place { return &s.motion.waypoint_s; }},
    {"motion", "preheat_s", "s", 0, 600, "", "Dwell with the heat on before the blade enters the foam",
     [](S& s) -> Place { return &s.motion.preheat_s; }},
    {"motion", "approach_mm", "mm", 0, 2000, "", "The blade is bent into shape this far above the stock",
     [](S& s) -> Place { return &s.motion.approach_mm; }},
    {"motion", "lead_mm", "mm", 0, 500, "",
     "The cut starts and ends this far outside the stock; 0 takes 20, and as far as the clamps need it to "
     "end",
     [](S& s) -> Place { return &s.motion.lead_mm; }},

    {"machine", "envelope_mm", "mm", 100, 100000, "",
     "Space of the cell: length and width centred on the table, height from the table up",
     [](S& s) -> Place { return &s.machine.envelope_mm; }},
    {"machine", "plinth_mm", "mm", 0, 3000, "",
     "The stock stands this far above the table; 0 takes 150, or as much more as a strip's clamps need to "
     "stay clear of it",
     [](S& s) -> Place { return &s.machine.plinth_mm; }},
    {"machine", "clamp_error_mm", "mm", 0, 10, "", "Error of a clamp's position, for the error budget",
     [](S& s) -> Place { return &s.machine.clamp_error_mm; }},
    {"machine", "clamp_error_rad", "rad", 0, 0.1, "", "Error of a clamp's angle, for the error budget",
     [](S& s) -> Place { return &s.machine.clamp_error_rad; }},

    {"machine", "clamp_a_shift_mm", "mm", -20, 20, "",
     "Clamp A holds the blade this far from where it is told to be: along the blade's tangent, the in-plane "
     "normal and "
     "the plane's normal; calibrate finds it",
     [](S& s) -> Place { return &s.machine.clamps.a.shift_mm; }, true},
    {"machine", "clamp_a_turn_rad", "rad", -0.2, 0.2, "",
     "And turned by this about the same three axes, a rotation vector",
     [](S& s) -> Place { return &s.machine.clamps.a.turn_rad; }, true},
    {"machine", "clamp_b_shift_mm", "mm", -20, 20, "", "As machine.clamp_a_shift_mm, of clamp B",
     [](S& s) -> Place { return &s.machine.clamps.b.shift_mm; }, true},
    {"machine", "clamp_b_turn_rad", "rad", -0.2, 0.2, "", "As machine.clamp_a_turn_rad, of clamp B",
     [](S& s) -> Place { return &s.machine.clamps.b.turn_rad; }, true},

    {"job", "number", "", 0, 0, kAnyText,
     "Number or name of the job, on the report and every sheet for the floor",
     [](S& s) -> Place { return &s.job.number; }},
    {"job", "date", "", 0, 0, kAnyText, "Date of the job on report and sheets, as it is to be read there",
     [](S& s) -> Place { return &s.job.date; }},
    {"job", "author", "", 0, 0, kAnyText, "Who planned the job, on report and sheets",
     [](S& s) -> Place { return &s.job.author; }},
    {"job", "language", "", 0, 0, "en|de", "Language of report.html and the sheets",
     [](S& s) -> Place { return &s.job.language; }},
};

template <typename Numbers>
std::string list_text(const Numbers& values) {
  std::string text = "[";
  for (const double v : values) text += (text.size() > 1 ? ", " : "") + number_text(v);
  return text + "]";
}

// The word at this place of a list separated by '|'.
std::string_view word_at(std::string_view words, std::size_t place) {
  for (; place > 0; --place) words.remove_prefix(words.find('|') + 1);
  return words.substr(0, words.find('|'));
}

struct TomlText {
  std::optional<std::string> operator()(const double* v) const { return number_text(*v); }
  std::optional<std::string> operator()(const int* v) const { return std::to_string(*v); }
  template <typename Enum>
  requires std::is_enum_v<Enum> std::optional<std::string>
  operator()(const Enum* v) const { return "\"" + std::string(name(*v)) + "\""; }
  std::optional<std::string> operator()(const std::string* v) const { return toml_string(*v); }
  std::optional<std::string> operator()(const std::vector<double>* v) const { return list_text(*v); }
  template <std::size_t N>
  std::optional<std::string> operator()(const std::vector<std::array<double, N>>* v) const {
    if (v->empty()) return std::nullopt;
    std::string text = "[";
    for (const auto& some : *v) text += (text.size() > 1 ? ", " : "") + list_text(some);
    return text + "]";
  }
  std::optional<std::string> operator()(const std::array<double, 3>* v) const { return list_text(*v); }
  template <std::size_t N>
  std::optional<std::string> operator()(const std::optional<std::array<double, N>>* v) const {
    return v->has_value() ? std::optional(list_text(**v)) : std::nullopt;
  }
};

}  // namespace

std::string_view name(Keep keep) {
  return word_at(kKeepWords, static_cast<std::size_t>(keep));
}

std::string_view name(Gaps gaps) {
  return word_at(kGapsWords, static_cast<std::size_t>(gaps));
}

std::string_view name(ShallowFolds folds) {
  return word_at(kShallowFoldsWords, static_cast<std::size_t>(folds));
}

std::string_view name(OverBudget over_budget) {
  return word_at(kOverBudgetWords, static_cast<std::size_t>(over_budget));
}

std::span<const SettingField> setting_fields() {
  return kFields;
}

std::string full_key(const SettingField& field) {
  return std::string(field.section) + "." + std::string(field.key);
}

std::vector<std::string> choices(const SettingField& field) {
  std::vector<std::string> words{""};
  for (const char c : field.choices) {
    if (c == '|') {
      words.emplace_back();
    } else {
      words.back() += c;
    }
  }
  return words;
}

std::string number_text(double value) {
  std::array<char, 32> buffer{};
  // Sizes that people write out are written out: 100000, not 1e+05. Both forms fit the buffer.
  const double size = std::abs(value);
  const bool plain = value == 0 || (size >= 1e-4 && size < 1e9);
  const auto format = plain ? std::chars_format::fixed : std::chars_format::scientific;
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, format).ptr;
  return {buffer.data(), end};
}

std::string toml_string(const std::string& text) {
  const std::string json = json_text(nlohmann::json(text));
  std::string escaped;
  for (const char c : json) {
    if (c == '\x7f') {
      escaped += "\\u007f";
    } else {
      escaped += c;
    }
  }
  return escaped;
}

std::optional<std::string> toml_text(const SettingPlace& place) {
  return std::visit(TomlText{}, place);
}

std::string range_text(const SettingField& field) {
  Settings defaults;
  const SettingPlace place = field.place(defaults);
  if (!field.choices.empty()) {
    if (field.choices == kAnyText) return "any text";
    std::string text;
    for (const std::string& word : choices(field)) {
      if (word.empty()) continue;
      text += (text.empty() ? "" : ", ") + word;
    }
    return text.empty() ? "empty" : text;
  }
  const std::string range = number_text(field.min) + " to " + number_text(field.max);
  if (std::holds_alternative<double*>(place) || std::holds_alternative<int*>(place)) return range;
  const char* count = "3 numbers";
  if (std::holds_alternative<std::vector<double>*>(place)) count = "1 to 100 numbers";
  if (std::holds_alternative<std::vector<std::array<double, 2>>*>(place)) count = "1 to 100 pairs of numbers";
  if (std::holds_alternative<std::vector<std::array<double, 3>>*>(place))
    count = "1 to 100 triples of numbers";
  if (std::holds_alternative<std::optional<std::array<double, 6>>*>(place)) count = "6 numbers";
  return std::string(count) + ", each " + range;
}

}  // namespace hotblade::pipeline
