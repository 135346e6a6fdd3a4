// How fast a blade goes at the places of its cut, square to itself: what the melted band depends on.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <utility>
#include <vector>

#include "pipeline/program/program.hpp"

namespace hotblade::pipeline {

// Returns the speed in mm/s of a point that goes from `before` to `after` in this time, square to a tangent
// of any length; 0 in no time.
[[nodiscard]] double speed_across(const Eigen::Vector3d& before, const Eigen::Vector3d& after, double seconds,
                                  const Eigen::Vector3d& tangent);

class BladeSpeeds {
 public:
  // Of the poses that form the design (those with a foam interval), a few millimetres apart.
  explicit BladeSpeeds(const std::vector<BladePose>& poses);

  // Returns the speed in mm/s where the blade passes nearest to a point of the design frame, linear between
  // poses and along them; that of the nearest end beyond them. Throws std::logic_error when fewer than two
  // poses form the design.
  [[nodiscard]] double at(const Eigen::Vector3d& point) const;

  [[nodiscard]] bool empty() const { return rows_.size() < 2; }
  // Calls f(point, mm/s) for places of the cut.
  template <typename F>
  void for_each(const F& f) const {
    for (const Row& row : rows_) {
      for (const Place& place : row.places) f(place.point, place.speed_mm_s);
    }
  }
  // Returns the slowest and the fastest, mm/s.
  [[nodiscard]] std::pair<double, double> range() const;

 private:
  struct Place {
    double x_mm = 0, speed_mm_s = 0;  // x in the plane of its row
    Eigen::Vector3d point{0, 0, 0};
  };
  // The blade of one pose.
  struct Row {
    Eigen::Vector3d origin{0, 0, 0}, x{1, 0, 0}, normal{0, 0, 1};
    std::vector<Place> places;  // ascending in x
    [[nodiscard]] double ahead(const Eigen::Vector3d& p) const;
    [[nodiscard]] double aside(const Eigen::Vector3d& p) const;  // of the blade, along x
    [[nodiscard]] double at(const Eigen::Vector3d& p) const;
  };
  std::vector<Row> rows_;
};

}  // namespace hotblade::pipeline
