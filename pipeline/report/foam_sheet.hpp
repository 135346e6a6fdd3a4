// The sheet of the foam to buy and where to saw it.
#pragma once

#include <string>

#include "pipeline/program/program.hpp"
#include "pipeline/report/words.hpp"
#include "pipeline/stock/nest.hpp"

namespace hotblade::pipeline {

// Returns what to buy, by size; and for every block that is bought a picture, its pieces and the cuts in
// order, each part named by a letter.
[[nodiscard]] std::string foam_section(const Nesting& nesting, const Program& program, const Words& words);

}  // namespace hotblade::pipeline
