#include "elastica/fit/even_points.hpp"

#include <algorithm>
#include <limits>

namespace hotblade::elastica {

namespace {

constexpr int kFitPoints = 129;

}  // namespace

std::vector<Eigen::Vector2d> even_points(const std::vector<Eigen::Vector2d>& q) {
  std::vector<double> s(q.size(), 0.0);
  double shortest = std::numeric_limits<double>::infinity(), longest = 0;
  for (std::size_t i = 1; i < q.size(); ++i) {
    const double chord = (q[i] - q[i - 1]).norm();
    shortest = std::min(shortest, chord);
    longest = std::max(longest, chord);
    s[i] = s[i - 1] + chord;
  }
  if (q.empty() || !(s.back() > 0)) return {};
  constexpr double kEven = 1.01;
  constexpr std::size_t kMostAsGiven = 1025;
  if (longest <= kEven * shortest && q.size() <= kMostAsGiven) return q;
  std::vector<Eigen::Vector2d> even;
  std::size_t i = 1;
  for (int k = 0; k < kFitPoints; ++k) {
    const double want = s.back() * k / (kFitPoints - 1);
    while (i + 1 < s.size() && s[i] < want) ++i;
    const double width = s[i] - s[i - 1];
    even.push_back(q[i - 1] + (width > 0 ? std::min(1.0, (want - s[i - 1]) / width) : 0) * (q[i] - q[i - 1]));
  }
  return even;
}

}  // namespace hotblade::elastica
