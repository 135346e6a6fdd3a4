// hotblade check: the health of a design, whether it can be sliced, and what a plan of it will meet.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "pipeline/advice/design_trials.hpp"
#include "pipeline/cli/command.hpp"
#include "pipeline/cli/ends_on_signal.hpp"
#include "pipeline/cli/settings_options.hpp"
#include "pipeline/program/read_design.hpp"
#include "pipeline/report/json/report_json.hpp"
#include "pipeline/settings/json_text.hpp"
#include "surface/read/design_surface.hpp"
#include "surface/read/self_crossings.hpp"
#include "surface/slice/plane_family.hpp"

namespace hotblade::pipeline {
namespace {

using surface::DesignSurface;
using surface::Health;

struct Count {
  const char* name;
  std::size_t value;
};

std::vector<Count> counts(const Health& health) {
  return {{"vertices", health.vertices},
          {"triangles", health.triangles},
          {"components", health.components},
          {"border_loops", health.border_loops},
          {"non_manifold_edges", health.non_manifold_edges},
          {"non_manifold_vertices", health.non_manifold_vertices},
          {"degenerate_faces", health.degenerate_faces},
          {"duplicate_faces", health.duplicate_faces},
          {"unused_vertices", health.unused_vertices}};
}

std::string row(std::string name, const std::string& value) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return fmt::format("{:<24}{}\n", name, value);
}

std::string point_text(const Eigen::Vector3d& p) {
  // Adding zero turns a negative zero into a positive one.
  return fmt::format("({:.3f}, {:.3f}, {:.3f})", p.x() + 0.0, p.y() + 0.0, p.z() + 0.0);
}

std::string lines(const std::string& title, const std::vector<std::string>& items) {
  std::string text;
  for (const std::string& item : items) text += row(title, item);
  return text;
}

std::string radius_text(double radius_mm) {
  return std::isfinite(radius_mm) ? fmt::format("{:.4g} mm", radius_mm) : "none: flat";
}

// Two digits behind the point, without a negative zero.
double short_number(double x) {
  return std::round(100 * x) / 100 + 0.0;
}

std::string bend_text(const Bending& bend, double blade_radius_mm) {
  std::string text = radius_text(bend.radius_mm);
  if (std::isfinite(bend.radius_mm)) text += " at " + point_text(bend.at);
  text += fmt::format(" (blade {:.4g} mm)", blade_radius_mm);
  if (const double share = short_number(100 * bend.sharper_share); share > 0)
    text += fmt::format(", {:g} % of the area is sharper", share);
  return text;
}

std::string vector_text(const Eigen::Vector3d& v) {
  return fmt::format("[{:g}, {:g}, {:g}]", short_number(v.x()), short_number(v.y()), short_number(v.z()));
}

std::string keep_text(const Forecast& f) {
  if (f.upright)
    return fmt::format("back or front: the surface stands upright (leans {:g} towards z)",
                       short_number(f.lean));
  return fmt::format("below is {}, above is {} (the surface leans {:g} towards z)",
                     f.lean > 0 ? "back" : "front", f.lean > 0 ? "front" : "back", short_number(f.lean));
}

std::string forecast_table(const Forecast& f) {
  std::string text;
  if (f.faces > 1)
    text += row("faces", fmt::format("{} that lie apart or meet in creases, planned one by one", f.faces));
  if (f.faces_between_folds > f.faces) {
    text += row("shallow folds", fmt::format("{} faces between them, planned one by one where strips across "
                                             "are as many or do not serve",
                                             f.faces_between_folds));
  }
  text += row("smallest radius", bend_text(f.surface, f.blade_radius_mm));
  text += row("flattest rib planes", "normal " + vector_text(f.planes));
  text += row("radius in them", bend_text(f.sections, f.blade_radius_mm));
  text +=
      row("over 60 degrees to them", fmt::format("{:g} % of the area", short_number(100 * f.steep_share)));
  text += row("strips", fmt::format("{} at least", f.strips_lower_bound));
  text += row("keep", keep_text(f));
  if (f.odd_size && !f.odd_size->hopeless) text += row("size", describe(*f.odd_size));
  return text + lines("reason", f.reasons);
}

// What is said of a design. `tried`: changes of settings that passed; absent where none was to be tried.
struct Findings {
  const DesignSurface& design;
  const std::optional<Forecast>& forecast;
  const std::optional<std::vector<TriedRemedy>>& tried;
};

std::string table(const Findings& found) {
  const DesignSurface& design = found.design;
  const Health& health = design.health;
  const Eigen::Vector3d size = health.bbox_mm[1] - health.bbox_mm[0];
  std::string text = row("file", design.file_name) + row("sha256", design.sha256);
  text += row("units", fmt::format("{} ({} mm), {} up", design.units, design.scale_to_mm, design.up));
  text += row("bounding box", fmt::format("{:.3f} x {:.3f} x {:.3f} mm", size.x(), size.y(), size.z()));
  text += row("from", point_text(health.bbox_mm[0])) + row("to", point_text(health.bbox_mm[1]));
  text += row("in the file", fmt::format("{} vertices, {} faces", health.file_vertices, health.file_faces));
  for (const Count& count : counts(health)) text += row(count.name, std::to_string(count.value));
  text += row("border length", fmt::format("{:.3f} mm", health.border_length_mm));
  text += row("area", fmt::format("{:.1f} mm2", health.area_mm2));
  text += row("orientable", health.orientable ? "yes" : "no") + row("closed", health.closed ? "yes" : "no");
  text += lines("repaired", health.repairs) + lines("warning", health.warnings);
  text += lines("blocker", health.blockers);
  if (found.forecast) text += forecast_table(*found.forecast);
  if (found.tried) {
    for (const TriedRemedy& remedy : *found.tried)
      text += row("tried", fmt::format("{} ({})", describe(remedy), remedy.why));
    if (found.tried->empty())
      text += row("tried", found.forecast && !found.forecast->suggestions.empty()
                               ? "nothing passed of what might help"
                               : "nothing: the shape suggests no other settings");
  }
  return text + row("sliceable", health.blockers.empty() ? "yes" : "no");
}

using Json = nlohmann::ordered_json;

Json point_json(const Eigen::Vector3d& p) {
  return {p.x() + 0.0, p.y() + 0.0, p.z() + 0.0};
}

// A radius of null: nothing bends.
Json bend_json(const Bending& bend) {
  const bool bends = std::isfinite(bend.radius_mm);
  return {{"radius_mm", bends ? Json(bend.radius_mm) : Json()},
          {"at_mm", bends ? point_json(bend.at) : Json()},
          {"sharper_share", bend.sharper_share}};
}

Json odd_size_json(const OddSize& odd) {
  Json json{{"why", odd.why}, {"hopeless", odd.hopeless}, {"units", Json::array()}};
  for (const OtherUnit& other : odd.others)
    json["units"].push_back({{"units", other.units},
                             {"size_mm", point_json(other.size_mm)},
                             {"strips_lower_bound", other.strips_lower_bound}});
  return json;
}

Json forecast_json(const Forecast& f) {
  Json json;
  json["blade_radius_mm"] = f.blade_radius_mm;
  json["faces"] = f.faces;
  json["faces_between_folds"] = f.faces_between_folds;
  json["surface"] = bend_json(f.surface);
  json["planes"] = point_json(f.planes);
  json["sections"] = bend_json(f.sections);
  json["steep_share"] = f.steep_share;
  json["lean"] = f.lean;
  json["upright"] = f.upright;
  json["keep_suits"] = f.upright ? Json{"back", "front"} : Json{"below", "above", "back", "front"};
  json["facing"] = f.facing ? Json(*f.facing) : Json();
  json["strips_lower_bound"] = f.strips_lower_bound;
  json["odd_size"] = f.odd_size ? odd_size_json(*f.odd_size) : Json();
  json["reasons"] = f.reasons;
  return json;
}

std::string findings_json(const Findings& found) {
  const DesignSurface& design = found.design;
  const Health& health = design.health;
  Json json;
  json["file"] = design.file_name;
  json["sha256"] = design.sha256;
  json["units"] = design.units;
  json["scale_to_mm"] = design.scale_to_mm;
  json["up"] = std::string(1, design.up);
  json["bbox_mm"] = {point_json(health.bbox_mm[0]), point_json(health.bbox_mm[1])};
  json["file_vertices"] = health.file_vertices;
  json["file_faces"] = health.file_faces;
  for (const Count& count : counts(health)) json[count.name] = count.value;
  json["border_length_mm"] = health.border_length_mm;
  json["area_mm2"] = health.area_mm2;
  json["orientable"] = health.orientable;
  json["closed"] = health.closed;
  json["repairs"] = health.repairs;
  json["warnings"] = health.warnings;
  json["blockers"] = health.blockers;
  json["sliceable"] = health.blockers.empty();
  json["forecast"] = found.forecast ? forecast_json(*found.forecast) : Json();
  json["tried"] = found.tried ? to_json(*found.tried) : Json();
  return json_text(json, 2) + "\n";
}

// Nothing where a fan's axis does not go with the design: that is a warning.
std::optional<Forecast> forecast_or_warning(DesignSurface& design, const Settings& settings) {
  try {
    return forecast_of(design, settings);
  } catch (const surface::FanError& error) {
    design.health.warnings.emplace_back(error.what());
    return std::nullopt;
  }
}

struct CheckArguments {
  DesignOptions design;
  bool as_json = false, advise = false;
};

Exit check(const CheckArguments& arguments, const Console& console) {
  const EndsOnSignal ends(console, "interrupted: not measured to the end");
  const Settings settings = resolve_design(arguments.design);
  const std::string& file = arguments.design.file;
  DesignSurface design = read_design(file, settings.design);
  const std::string crossings = surface::self_crossings_text(design);
  if (!crossings.empty()) design.health.warnings.push_back(crossings);
  const std::optional<Forecast> met = forecast_or_warning(design, settings);
  std::optional<std::vector<TriedRemedy>> tried;
  const bool suggests = met && !met->suggestions.empty();
  if (arguments.advise) tried.emplace();
  if (arguments.advise && suggests) {
    const ReadAgain read = [&](const DesignSettings& how) { return read_design(file, how); };
    tried = try_changes(settings, changes_by_shape(met->suggestions),
                        [&](const Settings& changed) { return plan_again(read, changed, {}, false); });
  }
  const Findings found{design, met, tried};
  std::cout << (arguments.as_json ? findings_json(found) : table(found));
  if (suggests && !arguments.advise) console.note(kAdviseHint);
  return design.health.blockers.empty() ? Exit::kOk : Exit::kBadInput;
}

}  // namespace

void add_check(CLI::App& app, const Console& console, Action& action) {
  auto arguments = std::make_shared<CheckArguments>();
  auto* command = app.add_subcommand("check", "Measure the health of a design: can it be sliced?");
  add_design_options(*command, arguments->design);
  command->add_flag("--json", arguments->as_json, "Print JSON instead of a table");
  command->add_flag("--advise", arguments->advise,
                    "Plan the job with settings that its shape suggests, and say which passed");
  command->footer(
      "Exit code 3 when the design cannot be sliced.\nExample: hotblade check vault.obj --units mm");
  command->callback([arguments, &console, &action] {
    action = [arguments, &console] { return check(*arguments, console); };
  });
}

}  // namespace hotblade::pipeline
