#include "pipeline/verify/width_pass.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "elastica/blade/blade_batch.hpp"
#include "pipeline/verify/width_lanes.hpp"

namespace hotblade::pipeline {

using Eigen::Vector3d;

namespace {

// Less of a width lies across no surface that a blade cuts.
constexpr double kFlattest = 1e-3;
// As many as fill the widest lanes at once.
constexpr std::size_t kPosesAtOnce = 8;

// The part in foam of every pose, or of the nearest one before it that has any, or behind.
std::vector<elastica::Part> parts_of(std::span<const BladePose> poses) {
  std::vector<elastica::Part> parts(poses.size());
  const auto in_foam = [](const BladePose& pose) { return pose.foam.has_value(); };
  const auto first = std::ranges::find_if(poses, in_foam);
  if (first == poses.end()) return parts;
  const BladePose* last = &*first;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (poses[i].foam) last = &poses[i];
    parts[i] = {(*last->foam)[0], (*last->foam)[1]};
  }
  return parts;
}

}  // namespace

// The poses about one row.
class WidthPass {
 public:
  WidthPass(const WidthPasses& all, std::size_t row, std::span<const Vector3d> normals,
            std::span<const Vector3d> plane_normals, double apart_mm)
      : all_(all),
        poses_(all.poses_),
        row_(row),
        normals_(normals),
        plane_normals_(plane_normals),
        half_mm_(0.5 * all.width_mm_),
        apart_mm_(apart_mm),
        part_{(*poses_[row].foam)[0], (*poses_[row].foam)[1]},
        over_(poses_[row], part_, normals, plane_normals, all.width_mm_) {}

  // The poses on one side, from the row's own on until the width of one no longer reaches any place. False
  // where there are not enough of them.
  [[nodiscard]] bool pass(bool after) {
    over_.start_side();
    Reach reach;
    for (std::size_t k = row_;;) {
      const std::vector<std::size_t> next = next_poses(k, after, reach);
      if (next.empty()) return false;
      std::vector<elastica::Elastica> blades;
      for (const std::size_t n : next) blades.push_back(poses_[n].blade);
      const std::vector<elastica::Part> parts(next.size(), part_);
      const elastica::PartPoints on = elastica::sample_parts(blades, parts, plane_normals_.size());
      for (std::size_t i = 0; i < next.size(); ++i) {
        const WidthOverRow::Passed passed = over_.pass(poses_[next[i]], on, i * plane_normals_.size());
        if (passed == WidthOverRow::Passed::kUntold) return false;
        if (passed == WidthOverRow::Passed::kAll) return true;
      }
    }
  }

  [[nodiscard]] std::vector<double> deepest_mm() const { return over_.deepest_mm(); }

 private:
  // How far the marks of the pose asked last have its width pass over the row's places.
  struct Reach {
    double least_mm = 0, most_mm = 0;
  };

  // The next hot poses from `k` on, which moves with them, as far apart as they have to be, until the width
  // of one no longer reaches any mark.
  [[nodiscard]] std::vector<std::size_t> next_poses(std::size_t& k, bool after, Reach& reach) const {
    std::vector<std::size_t> next;
    while (next.size() < kPosesAtOnce) {
      if (after ? k + 1 >= poses_.size() : k == 0) break;
      const std::size_t n = after ? k + 1 : k - 1;
      if (!poses_[n].heat) break;
      k = n;
      const Reach there = reach_of(n);
      const bool leaves = there.least_mm > half_mm_ && !(reach.least_mm > half_mm_);
      if (!leaves && there.most_mm - reach.most_mm < apart_mm_) continue;
      next.push_back(n);
      reach = there;
      if (leaves) break;
    }
    return next;
  }

  [[nodiscard]] Reach reach_of(std::size_t k) const {
    Reach reach{std::numeric_limits<double>::infinity(), 0};
    for (std::size_t i = 0; i < WidthPasses::kMarks; ++i) {
      const std::size_t j = i * (plane_normals_.size() - 1) / (WidthPasses::kMarks - 1);
      // A blade that goes along its surface meets a place's normal with its width that far from its middle.
      const double slope = normals_[j].dot(plane_normals_[j]);
      const double moved = std::abs((all_.marks_[k][i] - all_.marks_[row_][i]).dot(plane_normals_[j])) /
                           std::max(1 - slope * slope, kFlattest);
      reach = {std::min(reach.least_mm, moved), std::max(reach.most_mm, moved)};
    }
    return reach;
  }

  const WidthPasses& all_;
  std::span<const BladePose> poses_;
  std::size_t row_;
  std::span<const Vector3d> normals_, plane_normals_;
  double half_mm_, apart_mm_;
  elastica::Part part_;
  WidthOverRow over_;
};

WidthPasses::WidthPasses(std::span<const BladePose> poses, double width_mm)
    : poses_(poses), width_mm_(width_mm), marks_(poses.size()) {
  std::vector<elastica::Elastica> blades;
  blades.reserve(poses.size());
  for (const BladePose& pose : poses) blades.push_back(pose.blade);
  const elastica::PartPlaces places = elastica::sample_places(blades, parts_of(poses), kMarks);
  for (std::size_t n = 0; n < poses.size(); ++n) {
    for (std::size_t i = 0; i < kMarks; ++i) {
      const Eigen::Vector2d q = places.at(n, i);
      marks_[n][i] = poses[n].frame.point(q.x(), q.y());
    }
  }
}

std::optional<std::vector<double>> WidthPasses::deepest_mm(std::size_t row, std::span<const Vector3d> normals,
                                                           std::span<const Vector3d> plane_normals,
                                                           double apart_mm) const {
  WidthPass pass(*this, row, normals, plane_normals, apart_mm);
  if (!pass.pass(false) || !pass.pass(true)) return std::nullopt;
  return pass.deepest_mm();
}

}  // namespace hotblade::pipeline
