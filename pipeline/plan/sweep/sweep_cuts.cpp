#include "pipeline/plan/sweep/sweep_cuts.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "surface/slice/slice.hpp"

namespace hotblade::pipeline {

namespace {

using Eigen::Vector3d;

using Eigen::Vector2d;

// A curve in the planes, by its length; a closed one goes on round.
struct Line {
  std::vector<Vector2d> points;
  std::vector<double> passed_mm;  // of its length, at each point
  bool closed = false;

  Line(std::vector<Vector2d> of, bool is_closed) : points(std::move(of)), closed(is_closed) {
    passed_mm.assign(1, 0);
    for (std::size_t i = 1; i < points.size(); ++i)
      passed_mm.push_back(passed_mm.back() + (points[i] - points[i - 1]).norm());
  }
  [[nodiscard]] double length_mm() const { return passed_mm.back(); }
  [[nodiscard]] Vector2d at_share(double share) const { return at(share * length_mm()); }
  // Of unit length, of what lies around the place.
  [[nodiscard]] Vector2d tangent(double share) const {
    constexpr double kAround = 0.01;  // of the length: some facets
    return (at_share(share + kAround) - at_share(share - kAround)).normalized();
  }

 private:
  [[nodiscard]] Vector2d at(double mm) const {
    const double whole = length_mm();
    if (closed) mm -= std::floor(mm / whole) * whole;
    const auto next = std::upper_bound(passed_mm.begin() + 1, passed_mm.end() - 1, mm);
    const auto i = static_cast<std::size_t>(next - passed_mm.begin());
    const double share = (mm - passed_mm[i - 1]) / (passed_mm[i] - passed_mm[i - 1]);
    return points[i - 1] + std::clamp(share, 0.0, 1.0) * (points[i] - points[i - 1]);
  }
};

// A piece of a section in its plane; a closed one from its lowest point on.
Line line_of(const surface::SectionPiece& piece, const RibAxes& axes) {
  std::vector<Vector2d> points;
  for (const Vector3d& p : piece.points) points.emplace_back(p.dot(axes.x), p.dot(axes.y));
  if (piece.closed) {
    const auto lower = [](const Vector2d& a, const Vector2d& b) { return a.y() < b.y(); };
    std::rotate(points.begin(), std::min_element(points.begin(), points.end(), lower), points.end());
    points.push_back(points.front());
  }
  return {std::move(points), piece.closed};
}

// How many of a line's last points lie past the end of another that it passes by.
std::size_t past_end(const Line& line, const Line& other) {
  constexpr double kBeside = 0.2;  // of the other's length: farther off it is another side of the design
  const Vector2d end = other.points.back(), out = other.tangent(1);
  std::size_t past = 0;
  for (; past < line.points.size(); ++past) {
    const Vector2d from = line.points[line.points.size() - 1 - past] - end;
    if (from.dot(out) <= 0) return from.norm() < kBeside * other.length_mm() ? past : 0;
  }
  return 0;
}

// The longest line, led on past its end by the one that goes on the farthest there.
Line led_on(const Line& longest, const std::vector<Line>& lines) {
  Line best = longest;
  for (const Line& line : lines) {
    const auto past = static_cast<std::ptrdiff_t>(past_end(line, longest));
    if (past == 0) continue;
    std::vector<Vector2d> points = longest.points;
    points.insert(points.end(), line.points.end() - past, line.points.end());
    Line on(std::move(points), false);
    if (on.length_mm() > best.length_mm()) best = std::move(on);
  }
  return best;
}

Line reversed(Line line) {
  std::reverse(line.points.begin(), line.points.end());
  return {std::move(line.points), line.closed};
}

// The curve of the longest section between the offsets, towards larger x at its middle; where the border runs
// askew, led on by others.
std::optional<Line> middle_line(const surface::TriangleMesh& mesh, const RibAxes& axes,
                                const Range& offsets_mm) {
  constexpr std::size_t kSections = 8;  // as many as planes are ranked by
  std::vector<double> offsets(kSections);
  for (std::size_t i = 0; i < kSections; ++i) {
    const double share = (static_cast<double>(i) + 0.5) / kSections;
    offsets[i] = offsets_mm.first + share * (offsets_mm.second - offsets_mm.first);
  }
  std::vector<Line> lines;
  for (const surface::Section& section : surface::slice(mesh, axes.planes, offsets)) {
    for (const surface::SectionPiece& piece : section.pieces) lines.push_back(line_of(piece, axes));
  }
  const auto shorter = [](const Line& a, const Line& b) { return a.length_mm() < b.length_mm(); };
  const auto longest = std::max_element(lines.begin(), lines.end(), shorter);
  if (longest == lines.end()) return std::nullopt;
  Line line = *longest;
  if (!line.closed) {
    line = led_on(line, lines);
    for (Line& other : lines) other = reversed(std::move(other));
    line = led_on(reversed(std::move(line)), lines);
  }
  return line.tangent(0.5).x() < 0 ? reversed(std::move(line)) : line;
}

// Square to the line where so much of its length is passed.
SweepSeam seam_at(const Line& line, const RibAxes& axes, double share) {
  const Vector2d place = line.at_share(share), along = line.tangent(share);
  return {along.x() * axes.x + along.y() * axes.y, along.dot(place)};
}

SweepSeam behind(const SweepSeam& seam) {
  return {-seam.normal, -seam.at_mm};
}

}  // namespace

SweepSeam seam_across_sweep(const RibAxes& axes, double offset_mm, double side) {
  const Vector3d normal = side * axes.planes.normal(offset_mm);
  return {normal, normal.dot(axes.plane(offset_mm).origin)};
}

SweepSeam seam_across_ribs(const RibAxes& axes, double offset_mm, double x_mm, double side) {
  const Frame plane = axes.plane(offset_mm);
  const Vector3d normal = side * plane.x;
  return {normal, normal.dot(plane.point(x_mm, 0))};
}

std::vector<double> even_shares(std::size_t parts) {
  return std::vector<double>(parts, 1 / static_cast<double>(parts));
}

std::vector<double> cuts(double from, double to, const std::vector<double>& shares) {
  std::vector<double> at;
  double passed = 0;
  for (std::size_t i = 0; i + 1 < shares.size(); ++i)
    at.push_back(from + (passed += shares[i]) * (to - from));
  return at;
}

std::vector<std::vector<SweepSeam>> even_widths(const RibAxes& axes, double offset_mm, const Range& x_mm,
                                                std::size_t parts) {
  std::vector<std::vector<SweepSeam>> seams(parts);
  const std::vector<double> at = cuts(x_mm.first, x_mm.second, even_shares(parts));
  for (std::size_t i = 0; i < at.size(); ++i) {
    seams[i].push_back(seam_across_ribs(axes, offset_mm, at[i], 1));
    seams[i + 1].push_back(seam_across_ribs(axes, offset_mm, at[i], -1));
  }
  return seams;
}

std::vector<std::vector<SweepSeam>> even_lengths(const surface::TriangleMesh& mesh, const RibAxes& axes,
                                                 const Range& offsets_mm, std::size_t parts) {
  const std::optional<Line> line = middle_line(mesh, axes, offsets_mm);
  if (!line) return {};
  std::vector<std::vector<SweepSeam>> seams(parts);
  const auto meet = [&](std::size_t before, std::size_t after, double share) {
    const SweepSeam seam = seam_at(*line, axes, share);
    seams[before].push_back(seam);
    seams[after].push_back(behind(seam));
  };
  for (std::size_t i = 1; i < parts; ++i) meet(i - 1, i, static_cast<double>(i) / static_cast<double>(parts));
  if (parts > 1 && line->closed) {
    meet(parts - 1, 0, 0);
    return seams;
  }
  // The plane of a seam may meet the other side of a tube: no part reaches past the middle but the one there.
  const SweepSeam middle = seam_at(*line, axes, 0.5);
  for (std::size_t i = 0; i < parts; ++i) {
    if (2 * (i + 1) < parts) seams[i].push_back(middle);
    if (2 * i > parts) seams[i].push_back(behind(middle));
  }
  return seams;
}

}  // namespace hotblade::pipeline
