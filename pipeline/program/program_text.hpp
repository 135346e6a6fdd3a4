// The canonical text of a program in pieces, for jobs of hundreds of strips: `before`, the strips' own texts
// with ",\n" between them, `after`. Together they are to_json(program).
#pragma once

#include <string>

#include "pipeline/program/program.hpp"

namespace hotblade::pipeline {

struct ProgramFrame {
  std::string before, after;
};

// Returns all but the strips.
[[nodiscard]] ProgramFrame program_frame(const Program& program);

// Returns the text of one strip.
[[nodiscard]] std::string to_json(const Strip& strip);

}  // namespace hotblade::pipeline
