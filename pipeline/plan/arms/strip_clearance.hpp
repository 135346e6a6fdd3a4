// A strip's arms, its block with plinth and table, and its blade as bodies that have to keep apart.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "pipeline/program/program.hpp"
#include "robot/arm/arm.hpp"
#include "robot/arm/cell.hpp"
#include "robot/arm/clearance.hpp"
#include "robot/arm/solid.hpp"

namespace hotblade::pipeline {

// What holds the strip's clamps, by clamp, at every pose.
struct HeldJoints {
  std::array<std::size_t, 2> arm{0, 1};  // index in the cell
  std::array<std::vector<robot::JointAngles>, 2> joints;
};

// Returns what stands around a strip's arms in the cell: its block as a whole, what it stands on, the table
// and obstacles.
[[nodiscard]] std::vector<robot::Standing> surroundings(const Strip& strip, const robot::Cell& cell);

// Whether a block and its plinth may stand at a place: clear of the cell's obstacles, as the proof asks too.
class FreePlaces {
 public:
  // The cell must outlive it.
  explicit FreePlaces(const robot::Cell& cell);
  [[nodiscard]] bool operator()(const Block& block, const Pose& design_to_cell) const;

 private:
  const robot::Cell& cell_;
  std::vector<robot::Solid> obstacles_;
};

// Returns the strip's arms and blade along its poses.
[[nodiscard]] robot::CellPath cell_path(const Strip& strip, const robot::BladeSection& blade,
                                        const HeldJoints& held);

// Returns what is proved of the strip where it stands.
[[nodiscard]] robot::Clearance prove_clear(const Strip& strip, const robot::BladeSection& blade,
                                           const robot::Cell& cell, const HeldJoints& held);

// Returns "arm R1 link_5 is 12.4 mm from the plinth, 20 mm at least (7.6 mm too near)", or what is not
// proved.
[[nodiscard]] std::string describe(const robot::Contact& contact, const Strip& strip);

// Returns " in phase cut at 12.00 s".
[[nodiscard]] std::string when(const robot::Contact& contact, const Strip& strip);

}  // namespace hotblade::pipeline
