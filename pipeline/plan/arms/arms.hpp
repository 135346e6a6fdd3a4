// The arms of a program: which holds which clamp, how high each block has to stand for both, and every joint.
//
// Each strip's path of clamps is fixed in its design; what is left to choose is the block's height, where the
// cell allows it also where it stands and how it is turned, which arm
// takes which end, which way round the blade lies in each jaw, and the arms' branches. All are tried, and the
// first that keeps every limit with its margins at every pose, and is proved clear of everything, is taken.
// Waypoints are then met later where joints ask for it.
#pragma once

#include <string>
#include <vector>

#include "pipeline/program/program.hpp"
#include "pipeline/verify/refusal.hpp"
#include "robot/arm/cell.hpp"

namespace hotblade::pipeline {

struct ArmsReport {
  std::vector<Refusal> refusals;      // of strips that no choice serves
  std::vector<std::string> warnings;  // small margins, and what the cell's file left out
};

// Returns the hash of every value of a cell, but for how blocks may be placed, and of its arms' files, by
// which a program names its cell.
[[nodiscard]] std::string cell_sha256(const robot::Cell& cell);

// Returns the program with the cell and, in each strip that both arms serve, the arms, the joints of every
// pose and `design_to_cell` raised. Arms that
// it had before are forgotten. Where a strip is refused the program comes back as it was.
struct ArmedProgram {
  Program program;
  ArmsReport report;
};
[[nodiscard]] ArmedProgram with_arms(const Program& program, const robot::Cell& cell);

// Returns a line for each arm's links, and for each tool, that have no shape: nothing is known of what they
// hit.
[[nodiscard]] std::vector<std::string> not_looked_at(const robot::Cell& cell);

// Puts these lines among what the program says was not checked, in place of those of any other cell.
void tell_not_looked_at(Program& program, const robot::Cell& cell);

// Returns a table for people, a line a strip: which arm holds which clamp, what the block is raised by, what
// is left to limits and to a straight wrist. Empty for a program without arms.
[[nodiscard]] std::string describe_arms(const Program& program);

}  // namespace hotblade::pipeline
