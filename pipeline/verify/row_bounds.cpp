#include "pipeline/verify/row_bounds.hpp"

#include <algorithm>
#include <cmath>

namespace hotblade::pipeline {

namespace {

constexpr std::size_t kTogether = 8;

// Of the poses from one on, up or down, the last whose width reaches over what that one cuts: places between
// two clamps move no less than the slower of both.
std::size_t reached(const Strip& strip, std::size_t from, bool up, double width_mm) {
  std::size_t last = from;
  const BladePose& begin = strip.poses[from];
  while (up ? last + 1 < strip.poses.size() : last > 0) {
    const BladePose& pose = strip.poses[last];
    if (std::min((pose.a.p - begin.a.p).norm(), (pose.b.p - begin.b.p).norm()) > 0.5 * width_mm) break;
    last = up ? last + 1 : last - 1;
  }
  return last;
}

std::uint32_t part_at(const BladePose& pose, double share) {
  const auto& [first, last] = *pose.foam;
  const double at = (first + share * (last - first)) / pose.blade.length * kBladeParts;
  return static_cast<std::uint32_t>(std::clamp(at, 0.0, kBladeParts - 1.0));
}

}  // namespace

void PartsOff::add(const std::array<float, kBladeParts>& off_mm) {
  if (poses_++ % kTogether == 0) groups_.push_back({});
  for (std::size_t part = 0; part < kBladeParts; ++part)
    groups_.back()[part] = std::max(groups_.back()[part], off_mm[part]);
}

float PartsOff::most(std::size_t first_pose, std::size_t last_pose, std::size_t part) const {
  float most = 0;
  const std::size_t end = std::min(groups_.size(), last_pose / kTogether + 1);
  for (std::size_t group = first_pose / kTogether; group < end; ++group)
    most = std::max(most, groups_[group][part]);
  return most;
}

RowBounds::RowBounds(const SweptSurface& cut, const Program& program) : strips_(program.strips.size()) {
  places_.reserve(cut.vertices.size());
  // Vertices come row by row, evenly from the first to the last of what is in foam.
  for (std::size_t begin = 0; begin < cut.vertices.size();) {
    const auto strip = static_cast<std::uint32_t>(cut.strip_of_vertex[begin]);
    const auto pose = static_cast<std::size_t>(cut.pose_of_vertex[begin]);
    std::size_t end = begin + 1;
    while (end < cut.vertices.size() && cut.pose_of_vertex[end] == cut.pose_of_vertex[begin] &&
           cut.strip_of_vertex[end] == cut.strip_of_vertex[begin])
      ++end;
    strips_[strip].push_back({pose, {}});
    for (std::size_t v = begin; v < end; ++v) {
      const double share =
          static_cast<double>(v - begin) / std::max(1.0, static_cast<double>(end - begin - 1));
      places_.push_back({strip, static_cast<std::uint32_t>(strips_[strip].size() - 1),
                         part_at(program.strips[strip].poses[pose], share)});
    }
    begin = end;
  }
}

void RowBounds::add(std::span<const std::size_t> vertices, double bound_mm) {
  Place low = places_[vertices.front()], high = low;
  for (const std::size_t v : vertices.subspan(1)) {
    low.row = std::min(low.row, places_[v].row);
    low.part = std::min(low.part, places_[v].part);
    high.row = std::max(high.row, places_[v].row);
    high.part = std::max(high.part, places_[v].part);
  }
  for (std::size_t row = low.row; row <= high.row; ++row) {
    auto& bounds = strips_[low.strip][row].bound_mm;
    for (std::size_t part = low.part; part <= high.part; ++part)
      bounds[part] = std::max(bounds[part], bound_mm);
  }
}

double RowBounds::with(const PartsOff& off, const Strip& strip, std::size_t index, double width_mm) const {
  if (index >= strips_.size()) return 0;
  const std::vector<Row>& rows = strips_[index];
  double largest = 0;
  for (std::size_t row = 0; row < rows.size(); ++row) {
    const std::size_t before = rows[row > 0 ? row - 1 : 0].pose,
                      behind = rows[std::min(row + 1, rows.size() - 1)].pose;
    const std::size_t first = reached(strip, before, false, width_mm),
                      last = reached(strip, behind, true, width_mm);
    for (std::size_t part = 0; part < kBladeParts; ++part) {
      const double bound = rows[row].bound_mm[part];
      if (bound > 0) largest = std::max(largest, bound + static_cast<double>(off.most(first, last, part)));
    }
  }
  return largest;
}

}  // namespace hotblade::pipeline
