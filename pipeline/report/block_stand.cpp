#include "pipeline/report/block_stand.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "elastica/blade/blade_batch.hpp"
#include "pipeline/program/block_place.hpp"

namespace hotblade::pipeline {

namespace {

using Points = std::vector<Eigen::Vector3d>;

// Poses that a drawing shows of a strip's cut, and places along each: their steps are under a pixel on paper.
constexpr std::size_t kPoses = 80, kPlaces = 32;

std::vector<const BladePose*> cutting_poses(const Strip& strip) {
  std::vector<const BladePose*> all, some;
  for (const BladePose& pose : strip.poses) {
    if (pose.phase == StripPhase::kLeadIn || pose.phase == StripPhase::kCut ||
        pose.phase == StripPhase::kLeadOut)
      all.push_back(&pose);
  }
  if (all.empty()) return some;
  const std::size_t step = std::max<std::size_t>(1, all.size() / kPoses);
  for (std::size_t i = 0; i < all.size(); i += step) some.push_back(all[i]);
  if (some.back() != all.back()) some.push_back(all.back());
  return some;
}

// Returns the lines of some blades in the axes of the block as it stands.
std::vector<Points> in_axes(const Pose& design_to_axes, std::span<const BladePose* const> poses) {
  constexpr std::size_t kPoints = 161;  // a blade of 1500 mm in steps under 10 mm
  std::vector<elastica::Elastica> blades;
  std::vector<elastica::Part> whole;
  for (const BladePose* pose : poses) {
    blades.push_back(pose->blade);
    whole.push_back({0, pose->blade.length});
  }
  const elastica::PartPlaces on = elastica::sample_places(blades, whole, kPoints);
  const Eigen::Matrix3d turn = design_to_axes.q.toRotationMatrix();
  std::vector<Points> lines(poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    for (std::size_t k = 0; k < kPoints; ++k) {
      const Eigen::Vector2d p = on.at(i, k);
      lines[i].push_back(turn * poses[i]->frame.point(p.x(), p.y()) + design_to_axes.p);
    }
  }
  return lines;
}

// Returns the shares of a segment from `p` to `q` over which both x and y are within the box; absent: none.
std::optional<std::array<double, 2>> shares_within(const Eigen::AlignedBox3d& box, const Eigen::Vector3d& p,
                                                   const Eigen::Vector3d& q) {
  std::array<double, 2> shares{0, 1};
  for (const int axis : {0, 1}) {
    const double way = q[axis] - p[axis];
    double low = box.min()[axis] - p[axis], high = box.max()[axis] - p[axis];
    if (way == 0) {
      if (low > 0 || high < 0) return std::nullopt;
      continue;
    }
    low /= way;
    high /= way;
    shares = {std::max(shares[0], std::min(low, high)), std::min(shares[1], std::max(low, high))};
  }
  if (shares[0] > shares[1]) return std::nullopt;
  return shares;
}

// Returns the part of a line over and under the box, from where it first comes in to where it last goes out.
Points within(const Points& line, const Eigen::AlignedBox3d& box) {
  Points inside;
  std::optional<std::size_t> first, last;
  Eigen::Vector3d from, to;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const auto shares = shares_within(box, line[i], line[i + 1]);
    if (!shares) continue;
    const Eigen::Vector3d way = line[i + 1] - line[i];
    if (!first) from = line[i] + (*shares)[0] * way;
    first = first.value_or(i);
    to = line[i] + (*shares)[1] * way;
    last = i;
  }
  if (!first) return inside;
  inside.push_back(from);
  inside.insert(inside.end(), line.begin() + static_cast<std::ptrdiff_t>(*first) + 1,
                line.begin() + static_cast<std::ptrdiff_t>(*last) + 1);
  inside.push_back(to);
  return inside;
}

// Returns `kPlaces` points of a line, evenly along it.
Points spread(const Points& line) {
  std::vector<double> along{0};
  for (std::size_t i = 0; i + 1 < line.size(); ++i)
    along.push_back(along.back() + (line[i + 1] - line[i]).norm());
  Points points;
  std::size_t i = 0;
  for (std::size_t k = 0; k < kPlaces; ++k) {
    const double at = along.back() * static_cast<double>(k) / (kPlaces - 1);
    while (i + 2 < line.size() && along[i + 1] < at) ++i;
    const double length = along[i + 1] - along[i];
    points.push_back(line[i] + (length > 0 ? (at - along[i]) / length : 0) * (line[i + 1] - line[i]));
  }
  return points;
}

// Returns where a line from the top down passes this height; absent where it does not.
std::optional<Eigen::Vector3d> at_height(const Points& line, double z) {
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const double a = line[i].z() - z, b = line[i + 1].z() - z;
    if ((a <= 0) != (b <= 0)) return line[i] + a / (a - b) * (line[i + 1] - line[i]);
  }
  return std::nullopt;
}

EdgePlace place_of(const BlockStand& stand, const Eigen::Vector3d& p) {
  const Eigen::Vector3d low = p - stand.box.min(), high = stand.box.max() - p;
  const std::array<double, 4> distance{low.x(), high.x(), low.y(), high.y()};
  const auto face = static_cast<Face>(std::min_element(distance.begin(), distance.end()) - distance.begin());
  const double from_base = stand.base_at_back ? high.y() : low.y();
  return {face, face == Face::kLeft || face == Face::kRight ? from_base : low.x()};
}

// The lines that each place of the blade draws, from the left end to the right: kPlaces of them, or none.
std::vector<Points> columns_of(const Strip& strip, const Pose& design_to_axes, const BlockStand& stand) {
  std::vector<Points> columns;
  for (const Points& blade : in_axes(design_to_axes, cutting_poses(strip))) {
    Points line = within(blade, stand.box);
    if (line.empty()) continue;
    if (!stand.clamp_a_left) std::reverse(line.begin(), line.end());
    const Points points = spread(line);
    columns.resize(kPlaces);
    for (std::size_t k = 0; k < kPlaces; ++k) columns[k].push_back(points[k]);
  }
  return columns;
}

}  // namespace

BlockStand stand_of(const Strip& strip) {
  BlockStand stand;
  const BlockPlace place = standing_place(strip.block, strip.design_to_cell);
  const Pose design_to_axes = place.in_box(strip.design_to_cell);
  const Eigen::Matrix3d turn = design_to_axes.q.toRotationMatrix();
  stand.box = place.box;
  stand.turned_rad = place.turned_rad;
  stand.corner = place.corner;
  // Foam is added under the kept part, at the low end of the block's second axis (stock.base_mm).
  stand.base_at_back = (turn * strip.block.frame.y).y() < 0;
  if (!strip.poses.empty()) {
    const BladePose* const middle = &strip.poses[strip.poses.size() / 2];
    const Points line = in_axes(design_to_axes, {&middle, 1}).front();
    stand.clamp_a_left = line.front().x() < line.back().x();
  }
  const std::vector<Points> columns = columns_of(strip, design_to_axes, stand);
  if (columns.empty()) return stand;
  const double top = stand.box.max().z(), bottom = stand.box.min().z();
  for (const Points& column : columns) {
    if (const auto p = at_height(column, top)) stand.enters.push_back(*p);
    if (const auto p = at_height(column, bottom)) stand.leaves.push_back(*p);
  }
  const Face base = stand.base_at_back ? Face::kBack : Face::kFront;
  for (const std::size_t side : {0u, 1u}) {
    const Points& end = side == 0 ? columns.front() : columns.back();
    const auto enters = at_height(end, top), leaves = at_height(end, bottom);
    if (enters) stand.enters_at[side] = place_of(stand, *enters);
    if (leaves) stand.leaves_at[side] = place_of(stand, *leaves);
    Points& drawn = stand.sides[side];
    if (enters) drawn.push_back(*enters);
    for (const Eigen::Vector3d& p : end) {
      if (p.z() < top && p.z() > bottom) drawn.push_back(p);
    }
    if (leaves) drawn.push_back(*leaves);
    for (const Eigen::Vector3d& p : drawn) stand.base_cut |= place_of(stand, p).face == base;
  }
  return stand;
}

}  // namespace hotblade::pipeline
