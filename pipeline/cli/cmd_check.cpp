// hotblade check: the health of a design, and whether it can be sliced.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "pipeline/cli/command.hpp"
#include "pipeline/cli/settings_options.hpp"
#include "pipeline/program/read_design.hpp"
#include "surface/read/design_surface.hpp"
#include "surface/read/self_crossings.hpp"

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

std::string table(const DesignSurface& design) {
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
  return text + row("sliceable", health.blockers.empty() ? "yes" : "no");
}

std::string json_text(const DesignSurface& design) {
  const Health& health = design.health;
  const auto point = [](const Eigen::Vector3d& p) {
    return nlohmann::json{p.x() + 0.0, p.y() + 0.0, p.z() + 0.0};
  };
  nlohmann::ordered_json json;
  json["file"] = design.file_name;
  json["sha256"] = design.sha256;
  json["units"] = design.units;
  json["scale_to_mm"] = design.scale_to_mm;
  json["up"] = std::string(1, design.up);
  json["bbox_mm"] = {point(health.bbox_mm[0]), point(health.bbox_mm[1])};
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
  return json.dump(2) + "\n";
}

Exit check(const DesignOptions& options, bool as_json) {
  const Settings settings = resolve_design(options);
  DesignSurface design = read_design(options.file, settings.design);
  const std::string crossings = surface::self_crossings_text(design);
  if (!crossings.empty()) design.health.warnings.push_back(crossings);
  std::cout << (as_json ? json_text(design) : table(design));
  return design.health.blockers.empty() ? Exit::kOk : Exit::kBadInput;
}

}  // namespace

void add_check(CLI::App& app, const Console&, Action& action) {
  auto options = std::make_shared<DesignOptions>();
  auto as_json = std::make_shared<bool>(false);
  auto* command = app.add_subcommand("check", "Measure the health of a design: can it be sliced?");
  add_design_options(*command, *options);
  command->add_flag("--json", *as_json, "Print JSON instead of a table");
  command->footer(
      "Exit code 3 when the design cannot be sliced.\nExample: hotblade check vault.obj --units mm");
  command->callback(
      [options, as_json, &action] { action = [options, as_json] { return check(*options, *as_json); }; });
}

}  // namespace hotblade::pipeline
