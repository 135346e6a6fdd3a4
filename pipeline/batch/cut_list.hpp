// The blocks of a whole batch, as they are bought, marked and cut, in the order of cutting that changes the
// blade least often.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "pipeline/batch/batch_facts.hpp"

namespace hotblade::pipeline::batch {

// A blade as it is mounted: its section and its free length between the clamps.
struct MountedBlade {
  double width_mm = 0, thickness_mm = 0, length_mm = 0;
  auto operator<=>(const MountedBlade&) const = default;
};

struct CutBlock {
  std::string id;  // what is written on the foam: 12-3-KF
  std::size_t job = 0;
  std::string panel, strip;
  bool amber = false;  // of a plan whose error budget is over its tolerance
  MountedBlade blade;
  std::array<double, 3> size_mm{};  // along x, y and z of its frame
  double machine_s = 0, cut_s = 0;

  [[nodiscard]] double volume_m3() const;
};

// Blocks that are alike.
struct BlockSum {
  std::size_t blocks = 0;
  double foam_m3 = 0, machine_s = 0, cut_s = 0;
  void add(const CutBlock& block);
};

using BlockSize = std::array<double, 3>;  // in mm, the longest first: foam is the same along each axis

struct CutList {
  std::vector<CutBlock> blocks;  // in the order of cutting
  BlockSum all;
  std::map<MountedBlade, BlockSum> blades;
  std::map<BlockSize, BlockSum> sizes;
  std::size_t panels = 0, not_cut = 0;  // panels of the batch; of them without a case that passed
  std::vector<std::string> not_cut_panels, amber_panels;  // their names, and those whose best case is amber
};

// Returns what is written on a block of a strip: the numbers of the job and the strip, and two letters that
// stand for both and for the plan's key. A digit misread, or a list from before an update that numbered the
// jobs anew or moved the panel, gives other letters but in one case of 256. The letters are none that look
// like digits or like each other, and tell which way up the rest is.
[[nodiscard]] std::string block_id(const Job& job, const std::string& strip);

// Returns the blocks of each panel's best case (the one that passed in the least machine time; of several the
// first). Each blade is mounted once: blocks are ordered by blade, and by job and strip below it. `sizes`
// are to the next whole `step_mm`. Throws std::logic_error unless step_mm > 0.
[[nodiscard]] CutList cut_list(const std::vector<JobFacts>& rows, double step_mm);

// Returns cut_list.csv.
[[nodiscard]] std::string cut_list_table(const CutList& list);

// Returns sizes and blades as people read them: 1000 × 500 × 400; 800 (8 × 0.5).
[[nodiscard]] std::string size_text(const BlockSize& size_mm);
[[nodiscard]] std::string blade_text(const MountedBlade& blade);

}  // namespace hotblade::pipeline::batch
