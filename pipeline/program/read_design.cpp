#include "pipeline/program/read_design.hpp"

#include <nlohmann/json.hpp>
#include <numbers>

#include "pipeline/settings/error.hpp"

namespace hotblade::pipeline {

surface::DesignSurface read_design(const std::filesystem::path& file, const DesignSettings& settings) {
  surface::ReadOptions options{settings.units, settings.up.front()};
  options.group = settings.group;
  if (settings.facing) options.facing = Eigen::Vector3d((*settings.facing).data());
  options.facing_max_rad = settings.facing_max_deg * std::numbers::pi / 180;
  options.stitch_mm = settings.stitch_mm;
  return surface::read_obj(file, options);
}

surface::DesignSurface read_design(const std::filesystem::path& file, const Program& program) {
  DesignSettings settings;
  settings.units = program.design.source_units;
  settings.up = std::string(1, program.design.up);
  const auto all = nlohmann::json::parse(program.settings_json, nullptr, false);
  if (!all.is_object() || !all.contains("design")) return read_design(file, settings);
  const auto& design = all.at("design");
  try {
    settings.group = design.value("group", settings.group);
    settings.facing_max_deg = design.value("facing_max_deg", settings.facing_max_deg);
    settings.stitch_mm = design.value("stitch_mm", settings.stitch_mm);
    if (design.contains("facing") && !design.at("facing").is_null())
      settings.facing = design.at("facing").get<std::array<double, 3>>();
    return read_design(file, settings);
  } catch (const nlohmann::json::exception&) {
    throw Error(ErrorKind::kBadInput,
                "program: settings.design is not as a plan writes it: plan the design again");
  } catch (const std::logic_error& error) {
    throw Error(ErrorKind::kBadInput, std::string("program: settings.design: ") + error.what());
  }
}

}  // namespace hotblade::pipeline
