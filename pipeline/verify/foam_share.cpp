#include "pipeline/verify/foam_share.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "elastica/blade/blade_batch.hpp"

namespace hotblade::pipeline {

namespace {

// A sag of a 200th of the chord between samples is a percent of a percent of the area. As many rows along the
// sweep: waypoints lie several times closer.
constexpr std::size_t kBladeSamples = 201;
constexpr int kRows = 200;

// The block's edges as the blade sees them: along the rib, from the kept side to the waste, along the sweep.
class BlockAxes {
 public:
  BlockAxes(const Stock& stock, const Frame& rib) : origin_(stock.frame.origin) {
    std::array<Eigen::Vector3d, 3> edges{stock.frame.x, stock.frame.y, stock.frame.normal()};
    std::array<double, 3> sizes{stock.size_mm.x(), stock.size_mm.y(), stock.size_mm.z()};
    const auto take = [&](std::size_t first, const Eigen::Vector3d& wanted) {
      std::size_t best = first;
      for (std::size_t k = first + 1; k < 3; ++k) {
        if (std::abs(edges[k].dot(wanted)) > std::abs(edges[best].dot(wanted))) best = k;
      }
      std::swap(edges[first], edges[best]);
      std::swap(sizes[first], sizes[best]);
    };
    take(0, rib.y);
    take(1, rib.normal());
    axes_ = {edges[2], edges[0], edges[1]};
    size_ = {sizes[2], sizes[0], sizes[1]};
    // Heights count from the kept side up.
    if (axes_[1].dot(rib.y) < 0) {
      origin_ += size_.y() * axes_[1];
      axes_[1] = -axes_[1];
    }
  }

  [[nodiscard]] double height_mm() const { return size_.y(); }
  [[nodiscard]] double sweep_mm() const { return size_.z(); }

  // Points along the blade of pose number `i` in the block; those outside are held at its faces.
  [[nodiscard]] std::vector<Eigen::Vector3d> blade_in_block(const BladePose& pose,
                                                            const elastica::PartPoints& blades,
                                                            std::size_t i) const {
    const auto in_block = [&](const Eigen::Vector3d& d) {
      return Eigen::Vector3d(d.dot(axes_[0]), d.dot(axes_[1]), d.dot(axes_[2]));
    };
    const Eigen::Vector3d origin = in_block(pose.frame.origin - origin_), x = in_block(pose.frame.x),
                          y = in_block(pose.frame.y);
    std::vector<Eigen::Vector3d> points;
    points.reserve(blades.points);
    for (std::size_t k = 0; k < blades.points; ++k) {
      const Eigen::Vector2d q = blades.at(i, k);
      const Eigen::Vector3d p = origin + q.x() * x + q.y() * y;
      points.push_back(p.cwiseMax(0).cwiseMin(size_));
    }
    return points;
  }

 private:
  Eigen::Vector3d origin_, size_;
  std::array<Eigen::Vector3d, 3> axes_;
};

bool sweeps(const BladePose& pose) {
  return pose.phase == StripPhase::kLeadIn || pose.phase == StripPhase::kCut ||
         pose.phase == StripPhase::kLeadOut;
}

// How far the blade's plane has moved from one pose to the other, where the blade starts and its length
// beyond.
double moved_mm(const BladePose& p, const BladePose& q) {
  const auto at = [](const BladePose& pose, double along) {
    return pose.frame.point(pose.blade.x + along, pose.blade.y);
  };
  const double length = q.blade.length;
  return std::max((at(p, 0) - at(q, 0)).norm(), (at(p, length) - at(q, length)).norm());
}

// Poses that sweep the block, one whenever the plane has moved by a row; the first and the last included.
std::vector<const BladePose*> sweeping_rows(const Strip& strip, double row_mm) {
  std::vector<const BladePose*> rows;
  const BladePose* last = nullptr;
  for (const BladePose& pose : strip.poses) {
    if (!sweeps(pose)) continue;
    last = &pose;
    if (rows.empty() || moved_mm(*rows.back(), pose) >= row_mm) rows.push_back(&pose);
  }
  if (last && rows.back() != last) rows.push_back(last);
  return rows;
}

}  // namespace

double foam_kept_share(const Strip& strip) {
  const auto first = std::find_if(strip.poses.begin(), strip.poses.end(), sweeps);
  if (first == strip.poses.end()) return 0;
  const BlockAxes block(strip.stock, first->frame);
  double kept = 0, base = 0;
  std::vector<Eigen::Vector3d> before;
  const auto sweep = [&](const std::vector<Eigen::Vector3d>& now) {
    for (std::size_t i = 0; !before.empty() && i + 1 < now.size(); ++i) {
      const Eigen::Vector3d &a = before[i], &b = before[i + 1], &c = now[i + 1], &d = now[i];
      // Of the patch seen from above, by its diagonals; nothing where all corners lie on one face.
      const double area = 0.5 * ((c.x() - a.x()) * (d.z() - b.z()) - (c.z() - a.z()) * (d.x() - b.x()));
      base += area;
      kept += area * 0.25 * (a.y() + b.y() + c.y() + d.y());
    }
    before = now;
  };
  const std::vector<const BladePose*> sweeping = sweeping_rows(strip, block.sweep_mm() / kRows);
  constexpr std::size_t kBlock = 128;
  for (std::size_t from = 0; from < sweeping.size(); from += kBlock) {
    std::vector<elastica::Elastica> blades;
    std::vector<elastica::Part> whole;
    for (std::size_t i = from; i < std::min(from + kBlock, sweeping.size()); ++i) {
      blades.push_back(sweeping[i]->blade);
      whole.push_back({0, sweeping[i]->blade.length});
    }
    const elastica::PartPoints points = elastica::sample_parts(blades, whole, kBladeSamples);
    for (std::size_t i = 0; i < blades.size(); ++i)
      sweep(block.blade_in_block(*sweeping[from + i], points, i));
  }
  return base != 0 ? std::clamp(kept / (base * block.height_mm()), 0.0, 1.0) : 0;
}

}  // namespace hotblade::pipeline
