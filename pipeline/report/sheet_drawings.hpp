// The drawings of the floor's sheets as SVG text: a block as it stands, and all blocks in their places.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/program/program.hpp"
#include "pipeline/report/block_stand.hpp"
#include "pipeline/report/words.hpp"

namespace hotblade::pipeline {

// Returns the block as it stands on the table, with its sizes, its datum edges, its name where it is to be
// written, and the blade where it enters and leaves.
[[nodiscard]] std::string stand_svg(const BlockStand& stand, const std::string& block, const Words& words);

// The cut surfaces of strips with their names and an arrow each, up as the block stands on the table, seen
// along an axis of the design. A page of many sheets draws it once and shows it on each.
class AssemblyPicture {
 public:
  // Returns the pictures that show every strip of a program from its waste side: one of a panel, several of
  // what is cut all around.
  [[nodiscard]] static std::vector<AssemblyPicture> all_of(const Program& program, double width,
                                                           double most_height);

  [[nodiscard]] bool shows(std::size_t strip) const;
  // Returns the picture for others on the same page to show: it takes no room itself.
  [[nodiscard]] std::string definition() const;
  // Returns the picture; with one strip filled, where one is said that it shows.
  [[nodiscard]] std::string svg(std::optional<std::size_t> filled, const std::string& label) const;
  // Returns the axis of the design that is looked along: "-z" is from above.
  [[nodiscard]] std::string view() const { return view_; }

 private:
  AssemblyPicture(const Program& program, std::size_t view, const Eigen::Vector3d& eye,
                  std::vector<std::size_t> strips, double width, double most_height);

  [[nodiscard]] std::string name(std::size_t i) const;

  std::string id_;
  double width_, height_;
  std::string view_;
  std::array<std::string, 2> axes_;  // of the design, to the right and up
  std::vector<std::size_t> strips_;  // by index; of the three that follow, in the same order
  std::vector<std::string> ids_;
  std::vector<std::vector<Eigen::Vector2d>> outlines_;  // on paper
  std::vector<Eigen::Vector2d> ups_;
};

}  // namespace hotblade::pipeline
