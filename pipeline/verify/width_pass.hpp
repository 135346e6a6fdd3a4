// How deep the width of a blade passes over places of its own cut, pose by pose. Slope and bend of the cut
// (robot::over_width_mm) say it only as well as rows of a grid tell a slope: beside a border the poses go on
// another way, and of a motion that was executed clamps are told micrometres, of which a nearly straight
// blade makes tenths.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "pipeline/program/program.hpp"

namespace hotblade::pipeline {

// Of some poses in order, which must outlive it. Several threads may ask at once.
class WidthPasses {
 public:
  WidthPasses(std::span<const BladePose> poses, double width_mm);

  // Returns for even places of the part in foam of a pose, the row, how much deeper than that pose itself the
  // width of any of them reaches there, mm, along the unit normals of the cut, which point to the waste: no
  // less than 0. `plane_normals` are the directions of the row's width there, as it hangs. Poses are asked
  // that are at least `apart_mm` from one another: a crest of radius r between two is its square / 8 r
  // deeper. Nothing where the hot poses end, or are farther apart than half the width, before all of it has
  // passed.
  [[nodiscard]] std::optional<std::vector<double>> deepest_mm(std::size_t row,
                                                              std::span<const Eigen::Vector3d> normals,
                                                              std::span<const Eigen::Vector3d> plane_normals,
                                                              double apart_mm) const;

 private:
  // Both ends and the middle of a part.
  static constexpr std::size_t kMarks = 3;
  using Marks = std::array<Eigen::Vector3d, kMarks>;

  std::span<const BladePose> poses_;
  double width_mm_;
  std::vector<Marks> marks_;  // of every pose's own part in foam, or of the nearest one's that has any

  friend class WidthPass;
};

}  // namespace hotblade::pipeline
