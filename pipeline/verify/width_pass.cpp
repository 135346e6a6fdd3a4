#include "pipeline/verify/width_pass.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "elastica/blade/blade_batch.hpp"

namespace hotblade::pipeline {

namespace {

using Eigen::Vector3d;

// Poses that move by less than this share of the width pass as one: a crest of radius r between two is
// w^2 / 8192 r deeper.
constexpr double kApart = 1.0 / 32;
// Poses farther apart than this share of the width leave open how deep the blade was between them.
constexpr double kTold = 0.5;

// Where the width of another pose stands over a place of the row.
struct Over {
  double height_mm = 0;  // along the cut's normal
  double along_mm = 0;   // of the width, from its middle, in its direction
};

class WidthPass {
 public:
  WidthPass(std::span<const BladePose> poses, std::size_t row, std::span<const Vector3d> normals,
            std::span<const Vector3d> plane_normals, double width_mm)
      : poses_(poses),
        row_(row),
        normals_(normals),
        plane_normals_(plane_normals),
        half_mm_(0.5 * width_mm),
        part_{(*poses[row].foam)[0], (*poses[row].foam)[1]} {
    const elastica::PartPlaces own = elastica::sample_places({&poses[row].blade, 1}, {&part_, 1}, columns());
    for (std::size_t j = 0; j < columns(); ++j) {
      const Eigen::Vector2d q = own.at(0, j);
      own_.push_back(poses[row].frame.point(q.x(), q.y()));
    }
    deepest_mm_.assign(columns(), 0.0);
  }

  // The poses on one side, from the row's own on until the width of one no longer reaches any place. False
  // where there are not enough of them.
  [[nodiscard]] bool pass(bool after) {
    std::vector<Over> before(columns());
    double slowest_mm = 0, fastest_mm = 0;  // how far places of the pose before are
    for (std::size_t k = row_; slowest_mm <= half_mm_;) {
      if (after ? k + 1 >= poses_.size() : k == 0) return false;
      k = after ? k + 1 : k - 1;
      if (!poses_[k].heat) return false;
      const auto [least, most] = moved_mm(k);
      if (least <= half_mm_ && most - fastest_mm < kApart * 2 * half_mm_) continue;
      std::vector<Over> over = over_of(k);
      if (!take(before, over)) return false;
      before = std::move(over);
      slowest_mm = least;
      fastest_mm = most;
    }
    return true;
  }

  [[nodiscard]] std::vector<double> deepest_mm() && { return std::move(deepest_mm_); }

 private:
  [[nodiscard]] std::size_t columns() const { return normals_.size(); }

  // Of the ends and the middle of the row's part, how far another pose is along the row's width.
  [[nodiscard]] std::pair<double, double> moved_mm(std::size_t k) const {
    constexpr std::size_t kAsked = 3;
    const elastica::PartPlaces there = elastica::sample_places({&poses_[k].blade, 1}, {&part_, 1}, kAsked);
    double least = std::numeric_limits<double>::infinity(), most = 0;
    for (std::size_t i = 0; i < kAsked; ++i) {
      const Eigen::Vector2d q = there.at(0, i);
      const std::size_t j = i * (columns() - 1) / (kAsked - 1);
      const double moved = std::abs((poses_[k].frame.point(q.x(), q.y()) - own_[j]).dot(plane_normals_[j]));
      least = std::min(least, moved);
      most = std::max(most, moved);
    }
    return {least, most};
  }

  // Where the normal through each of the row's places meets the ribbon of a pose: its middle line there, by
  // the point, the tangent and the curvature at the same place of the blade, and its width.
  [[nodiscard]] std::vector<Over> over_of(std::size_t k) const {
    const BladePose& pose = poses_[k];
    const elastica::PartPoints on = elastica::sample_parts({&pose.blade, 1}, {&part_, 1}, columns());
    const Vector3d turned = pose.frame.normal() - poses_[row_].frame.normal();
    std::vector<Over> all(columns());
    for (std::size_t j = 0; j < columns(); ++j) {
      const Vector3d& n = normals_[j];
      const Vector3d width = (plane_normals_[j] + turned).normalized();
      const Vector3d tangent = on.cos[j] * pose.frame.x() + on.sin[j] * pose.frame.y(),
                     left = -on.sin[j] * pose.frame.x() + on.cos[j] * pose.frame.y();
      const Vector3d away = pose.frame.point(on.x[j], on.y[j]) - own_[j];
      // away + width u + tangent s + left curvature s^2 / 2 = height n
      const Vector3d up = width.cross(tangent);
      const double size = n.dot(up);
      const double s = -away.dot(n.cross(width)) / size;
      all[j].along_mm = -away.dot(tangent.cross(n)) / size;
      all[j].height_mm = (away.dot(up) + 0.5 * on.curvature[j] * s * s * left.dot(up)) / size;
    }
    return all;
  }

  // Counts what a pose reaches, and where the edge of the width passes between the one before and it.
  [[nodiscard]] bool take(const std::vector<Over>& before, const std::vector<Over>& over) {
    for (std::size_t j = 0; j < columns(); ++j) {
      const double from = std::abs(before[j].along_mm), to = std::abs(over[j].along_mm);
      if (!std::isfinite(over[j].height_mm)) return false;
      if (from > half_mm_) continue;
      if (std::abs(over[j].along_mm - before[j].along_mm) > kTold * 2 * half_mm_) return false;
      double height = over[j].height_mm;
      if (to > half_mm_) {
        const double share = (half_mm_ - from) / (to - from);
        height = (1 - share) * before[j].height_mm + share * height;
      }
      deepest_mm_[j] = std::max(deepest_mm_[j], -height);
    }
    return true;
  }

  std::span<const BladePose> poses_;
  std::size_t row_;
  std::span<const Vector3d> normals_, plane_normals_;
  double half_mm_;
  elastica::Part part_;
  std::vector<Vector3d> own_;
  std::vector<double> deepest_mm_;
};

}  // namespace

std::optional<std::vector<double>> width_passes_mm(std::span<const BladePose> poses, std::size_t row,
                                                   std::span<const Vector3d> normals,
                                                   std::span<const Vector3d> plane_normals, double width_mm) {
  WidthPass pass(poses, row, normals, plane_normals, width_mm);
  if (!pass.pass(false) || !pass.pass(true)) return std::nullopt;
  return std::move(pass).deepest_mm();
}

}  // namespace hotblade::pipeline
