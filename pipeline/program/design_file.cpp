#include "pipeline/program/design_file.hpp"

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "pipeline/program/read_design.hpp"
#include "pipeline/program/sha256.hpp"
#include "pipeline/settings/error.hpp"
#include "pipeline/settings/json_bytes.hpp"

namespace hotblade::pipeline {

namespace fs = std::filesystem;

namespace {

// A path that run.json beside the program has, its bytes where they are no UTF-8.
std::optional<fs::path> path_in_run(const fs::path& program_file, const std::string& key) {
  std::ifstream stream(program_file.parent_path() / "run.json");
  const std::string run_text((std::istreambuf_iterator<char>(stream)), {});
  const auto run = whole_json_if_any<nlohmann::json>(run_text);
  if (!run.is_object()) return std::nullopt;
  const auto bytes = run.find(key + "_bytes"), text = run.find(key);
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

std::string sha256_of_file(const fs::path& file) {
  constexpr std::size_t kAtOnce = std::size_t{1} << 16;
  std::string some(kAtOnce, '\0');
  Sha256 sha256;
  for (std::ifstream stream(file, std::ios::binary); stream;) {
    stream.read(some.data(), static_cast<std::streamsize>(some.size()));
    sha256.add(std::string_view(some).substr(0, static_cast<std::size_t>(stream.gcount())));
  }
  return sha256.hex();
}

}  // namespace

std::optional<fs::path> design_path(const fs::path& program_file, const Program& program) {
  std::error_code ignored;
  if (const fs::path beside = program_file.parent_path() / program.design.file; fs::exists(beside, ignored))
    return beside;
  return path_in_run(program_file, "design_path");
}

std::optional<fs::path> design_at_hand(const fs::path& program_file, const Program& program) {
  std::error_code ignored;
  const std::optional<fs::path> path = design_path(program_file, program);
  return path && fs::exists(*path, ignored) ? path : std::nullopt;
}

fs::path given_or_at_hand(const fs::path& given, const fs::path& program_file, const Program& program) {
  if (!given.empty()) return given;
  if (const auto found = design_at_hand(program_file, program)) return *found;
  throw Error(ErrorKind::kFile, (program_file.parent_path() / program.design.file).string() +
                                    ": the design is neither beside the program nor where run.json says: say "
                                    "--design FILE");
}

std::optional<fs::path> cell_given(const fs::path& program_file) {
  return path_in_run(program_file, "cell");
}

surface::DesignSurface read_design_of(const Program& program, const fs::path& file) {
  const auto expect_design = [&](const std::string& sha256) {
    if (sha256 == program.design.sha256) return;
    throw Error(
        ErrorKind::kBadInput,
        fmt::format("{}: not the design of this program (sha256 {}, limit {}): give {} as it was planned",
                    file.string(), sha256.substr(0, 12), program.design.sha256.substr(0, 12),
                    program.design.file));
  };
  try {
    surface::DesignSurface design = read_design(file, program);
    expect_design(design.sha256);
    return design;
  } catch (const surface::MeshError&) {
    // Another design may not even be of the format that the program's has.
    expect_design(sha256_of_file(file));
    throw;
  }
}

}  // namespace hotblade::pipeline
