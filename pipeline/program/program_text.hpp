// The canonical text of a program in pieces, for jobs of hundreds of strips: `before`, the strips' own texts
// with ",\n" between them, `after`. Together they are to_json(program).
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "pipeline/program/program.hpp"

namespace hotblade::pipeline {

struct ProgramFrame {
  std::string before, after;
};

// Returns all but the strips.
[[nodiscard]] ProgramFrame program_frame(const Program& program);

// Returns `before` and behind it the text of one strip.
[[nodiscard]] std::string to_json(const Strip& strip, std::string before = "");

// What a file of a refused plan calls itself (pipeline/program/refused_plan.hpp).
inline constexpr std::string_view kRefusedPlanFormat = "hotblade-refused-plan";

// Returns the text of a program's file, unpacked where its name ends in .gz. Throws Error: kFile when it
// cannot be read, and as unpacked() does (pipeline/program/gzip.hpp).
[[nodiscard]] std::string file_text(const std::filesystem::path& file);

}  // namespace hotblade::pipeline
