// The width of one pose over the places of a row, eight places at a time (width_pass.hpp).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "elastica/blade/blade_batch.hpp"
#include "elastica/kernels/lanes.hpp"
#include "elastica/kernels/simd.hpp"
#include "pipeline/program/program.hpp"

namespace hotblade::pipeline {

// Eight places of a row.
struct alignas(sizeof(elastica::lanes::Lanes)) WidthCell {
  std::array<elastica::lanes::Cell, 3> normal, plane_normal, own;
  // Of the pose told before, along the normals and along the width from its middle.
  elastica::lanes::Cell height, along;
  elastica::lanes::Cell deepest;
};

// What has passed over the places of a row so far, to be told of poses in order on one side of it and then of
// those on the other. Lanes behind the last place have what the last one has.
class WidthOverRow {
 public:
  // Of even places on a part of the row's pose, whose unit normals these are: of the cut, towards the waste,
  // and of the plane that the blade hangs in there.
  WidthOverRow(const BladePose& row, const elastica::Part& part, std::span<const Eigen::Vector3d> normals,
               std::span<const Eigen::Vector3d> plane_normals, double width_mm);

  // Back at the row's own pose.
  void start_side();

  enum class Passed {
    kNot,     // the width still reaches a place
    kAll,     // it reaches none
    kUntold,  // the pose is too far from the one before to tell how deep the blade was between, or no number
  };
  // Counts what a pose reaches, and where the edge of the width passes between the one told before and it.
  // `on` has the same places of its blade from `first` on.
  [[nodiscard]] Passed pass(const BladePose& pose, const elastica::PartPoints& on, std::size_t first,
                            elastica::Simd simd = elastica::best_simd());

  // Of each place, how much deeper than the row's pose the width of any reached, mm; no less than 0.
  [[nodiscard]] std::vector<double> deepest_mm() const;

 private:
  Eigen::Vector3d row_normal_;
  std::size_t places_;
  double half_mm_;  // of the width
  std::vector<WidthCell> cells_;
};

}  // namespace hotblade::pipeline
