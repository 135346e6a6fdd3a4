#include "pipeline/program/design_file.hpp"

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "pipeline/program/read_design.hpp"
#include "pipeline/settings/error.hpp"

namespace hotblade::pipeline {

namespace fs = std::filesystem;

std::optional<fs::path> design_at_hand(const fs::path& program_file, const Program& program) {
  const fs::path directory = program_file.parent_path();
  std::error_code ignored;
  if (const fs::path beside = directory / program.design.file; fs::exists(beside, ignored)) return beside;
  std::ifstream stream(directory / "run.json");
  const auto run = nlohmann::json::parse(stream, nullptr, false);
  if (!run.is_object() || !run.contains("design_path") || !run["design_path"].is_string())
    return std::nullopt;
  const fs::path planned = run["design_path"].get<std::string>();
  return fs::exists(planned, ignored) ? std::optional(planned) : std::nullopt;
}

surface::DesignSurface read_design_of(const Program& program, const fs::path& file) {
  surface::DesignSurface design = read_design(file, program);
  if (design.sha256 == program.design.sha256) return design;
  throw Error(
      ErrorKind::kBadInput,
      fmt::format("{}: not the design of this program (sha256 {}, limit {}): give {} as it was planned",
                  file.string(), design.sha256.substr(0, 12), program.design.sha256.substr(0, 12),
                  program.design.file));
}

}  // namespace hotblade::pipeline
