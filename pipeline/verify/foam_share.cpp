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

// The same block with its edges as the blade sees them: x along the rib, y from the kept side to the waste,
// the third along the sweep.
Block along_rib(const Block& block, const Frame& rib) {
  std::array<Eigen::Vector3d, 3> edges{block.frame.x, block.frame.y, block.frame.normal()};
  std::array<double, 3> sizes{block.size_mm.x(), block.size_mm.y(), block.size_mm.z()};
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
  Block seen{{block.frame.origin, edges[2], edges[0]}, {sizes[2], sizes[0], sizes[1]}};
  // Heights count from the kept side up.
  if (seen.frame.y.dot(rib.y) < 0) {
    seen.frame.origin += seen.size_mm.y() * seen.frame.y;
    seen.frame.y = -seen.frame.y;
  }
  // The third axis is x cross y, whichever way that edge ran.
  if (seen.frame.normal().dot(edges[1]) < 0) seen.frame.origin += seen.size_mm.z() * edges[1];
  return seen;
}

// Points along the blade of pose number `i` in the block's axes; those outside are held at its faces.
std::vector<Eigen::Vector3d> blade_in_block(const Block& block, const BladePose& pose,
                                            const elastica::PartPlaces& blades, std::size_t i) {
  const Frame& axes = block.frame;
  const auto turned = [&, normal = axes.normal()](const Eigen::Vector3d& d) -> Eigen::Vector3d {
    return {d.dot(axes.x), d.dot(axes.y), d.dot(normal)};
  };
  const Eigen::Vector3d origin = block.local(pose.frame.origin), x = turned(pose.frame.x()),
                        y = turned(pose.frame.y());
  std::vector<Eigen::Vector3d> points;
  points.reserve(blades.points);
  for (std::size_t k = 0; k < blades.points; ++k) {
    const Eigen::Vector2d q = blades.at(i, k);
    const Eigen::Vector3d p = origin + q.x() * x + q.y() * y;
    points.push_back(p.cwiseMax(0).cwiseMin(block.size_mm));
  }
  return points;
}

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
  const Block block = along_rib(strip.block, first->frame);
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
  const std::vector<const BladePose*> sweeping = sweeping_rows(strip, block.size_mm.z() / kRows);
  constexpr std::size_t kBlock = 128;
  for (std::size_t from = 0; from < sweeping.size(); from += kBlock) {
    std::vector<elastica::Elastica> blades;
    std::vector<elastica::Part> whole;
    for (std::size_t i = from; i < std::min(from + kBlock, sweeping.size()); ++i) {
      blades.push_back(sweeping[i]->blade);
      whole.push_back({0, sweeping[i]->blade.length});
    }
    const elastica::PartPlaces points = elastica::sample_places(blades, whole, kBladeSamples);
    for (std::size_t i = 0; i < blades.size(); ++i)
      sweep(blade_in_block(block, *sweeping[from + i], points, i));
  }
  return base != 0 ? std::clamp(kept / (base * block.size_mm.y()), 0.0, 1.0) : 0;
}

}  // namespace hotblade::pipeline
