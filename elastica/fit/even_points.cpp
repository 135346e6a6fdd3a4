#include "elastica/fit/even_points.hpp"

#include <algorithm>
#include <limits>

namespace hotblade::elastica {

namespace {

constexpr int kFitPoints = 129;

}  // namespace

std::vector<Eigen::Vector2d> evenly_spaced(std::span<const Eigen::Vector2d> line, int n) {
  std::vector<double> passed{0};
  for (std::size_t i = 1; i < line.size(); ++i)
    passed.push_back(passed.back() + (line[i] - line[i - 1]).norm());
  std::vector<Eigen::Vector2d> points;
  std::size_t k = 1;
  for (int i = 0; i < n; ++i) {
    const double wanted = passed.back() * i / (n - 1);
    while (k + 1 < line.size() && passed[k] < wanted) ++k;
    const double width = passed[k] - passed[k - 1];
    const double share = width > 0 ? (wanted - passed[k - 1]) / width : 0;
    points.emplace_back(line[k - 1] + std::clamp(share, 0.0, 1.0) * (line[k] - line[k - 1]));
  }
  return points;
}

std::vector<Eigen::Vector2d> even_points(const std::vector<Eigen::Vector2d>& q) {
  double shortest = std::numeric_limits<double>::infinity(), longest = 0;
  for (std::size_t i = 1; i < q.size(); ++i) {
    const double chord = (q[i] - q[i - 1]).norm();
    shortest = std::min(shortest, chord);
    longest = std::max(longest, chord);
  }
  if (!(longest > 0)) return {};
  constexpr double kEven = 1.01;
  constexpr std::size_t kMostAsGiven = 1025;
  if (longest <= kEven * shortest && q.size() <= kMostAsGiven) return q;
  return evenly_spaced(q, kFitPoints);
}

}  // namespace hotblade::elastica
