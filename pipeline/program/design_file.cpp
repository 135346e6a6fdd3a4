#include "pipeline/program/design_file.hpp"

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "pipeline/program/read_design.hpp"
#include "pipeline/settings/error.hpp"

namespace hotblade::pipeline {

namespace fs = std::filesystem;

namespace {

// Where run.json says that the design was; its bytes where they are no UTF-8.
std::optional<fs::path> path_in(const nlohmann::json& run) {
  const auto bytes = run.find("design_path_bytes"), text = run.find("design_path");
  if (bytes != run.end() && bytes->is_array()) {
    std::string path;
    for (const auto& byte : *bytes) {
      if (!byte.is_number_unsigned() || byte.get<std::uint64_t>() > 255) return std::nullopt;
      path += static_cast<char>(byte.get<unsigned char>());
    }
    return path;
  }
  return text != run.end() && text->is_string() ? std::optional<fs::path>(text->get<std::string>())
                                                : std::nullopt;
}

}  // namespace

std::optional<fs::path> design_at_hand(const fs::path& program_file, const Program& program) {
  const fs::path directory = program_file.parent_path();
  std::error_code ignored;
  if (const fs::path beside = directory / program.design.file; fs::exists(beside, ignored)) return beside;
  std::ifstream stream(directory / "run.json");
  const auto run = nlohmann::json::parse(stream, nullptr, false);
  const std::optional<fs::path> planned = run.is_object() ? path_in(run) : std::nullopt;
  return planned && fs::exists(*planned, ignored) ? planned : std::nullopt;
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
