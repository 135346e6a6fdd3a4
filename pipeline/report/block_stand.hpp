// How a block stands on the table, and where the blade goes through it: what a worker has to know to set it
// up.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <vector>

#include "pipeline/program/program.hpp"

namespace hotblade::pipeline {

// A face of a block that stands, as seen from the front of the table.
enum class Face { kLeft, kRight, kFront, kBack };

// Where an end of the blade crosses an edge of the top or the bottom.
struct EdgePlace {
  Face face = Face::kLeft;
  double mm = 0;  // from the base face along the left or right edge, else from the left edge
};

// In axes that the block's edges run along (pipeline/program/block_place.hpp): x to the right and y to the
// back as seen from the front of the table, z up, mm; where the block is not turned, the cell's.
struct BlockStand {
  Eigen::AlignedBox3d box;          // the block on the table
  double turned_rad = 0;            // of the axes, counter-clockwise as seen from above
  Eigen::Vector3d corner{0, 0, 0};  // the left front lower one, in the cell's axes
  bool base_at_back = false;        // the face that foam was added at is the one at high y
  bool base_cut = false;            // the blade comes through the base face
  bool clamp_a_left = true;
  // What the blade's left and right end draw on the block's sides, from the top down.
  std::array<std::vector<Eigen::Vector3d>, 2> sides;
  // What the blade draws on the top where it enters and on the bottom where it leaves, from the left.
  std::vector<Eigen::Vector3d> enters, leaves;
  // The ends of these; absent where the blade passes beside the block.
  std::array<std::optional<EdgePlace>, 2> enters_at, leaves_at;
};

// Returns how the block of a strip stands.
[[nodiscard]] BlockStand stand_of(const Strip& strip);

}  // namespace hotblade::pipeline
