#include "pipeline/plan/ribs/direction_plate.hpp"

#include <Eigen/Sparse>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace hotblade::pipeline {

namespace {

using Eigen::Vector2d;
using Triplets = std::vector<Eigen::Triplet<double>>;

// Along the window and along the sweep.
constexpr int kAlong = 41, kAcross = 25, kNodes = kAlong * kAcross;
constexpr double kStepAlong = 1.0 / (kAlong - 1), kStepAcross = 1.0 / (kAcross - 1);
// More sections say hardly more: two for each row of nodes.
constexpr std::size_t kMostSections = 2 * kAcross;
// The plate's length: bends shorter than six of it are smoothed away as the facets'.
constexpr double kSmooth = 1.0 / 20;
// Holds what bending leaves open, as the tilt across a run that is seen at one place only; so weak that a
// slope fades over four windows.
constexpr double kTension = 1.0 / 16;

int node(int i, int j) {
  return j * kAlong + i;
}

// weight * (sum of the coefficients times their nodes)^2 to the normal equations.
template <std::size_t N>
void add_square(const std::array<int, N>& nodes, const std::array<double, N>& c, double weight,
                Triplets& matrix) {
  for (std::size_t a = 0; a < N; ++a) {
    for (std::size_t b = 0; b < N; ++b) matrix.emplace_back(nodes[a], nodes[b], weight * c[a] * c[b]);
  }
}

void add_bending(Triplets& matrix) {
  const double area = kStepAlong * kStepAcross, bend = area * std::pow(kSmooth, 4), pull = kTension * bend;
  const auto along = [](int power) { return std::pow(kStepAlong, -2 * power); };
  const auto across = [](int power) { return std::pow(kStepAcross, -2 * power); };
  constexpr std::array<double, 3> kSecond{1, -2, 1};
  constexpr std::array<double, 2> kFirst{-1, 1};
  for (int j = 0; j < kAcross; ++j) {
    for (int i = 0; i < kAlong; ++i) {
      const bool right = i + 1 < kAlong, up = j + 1 < kAcross;
      if (i > 0 && right)
        add_square<3>({node(i - 1, j), node(i, j), node(i + 1, j)}, kSecond, bend * along(2), matrix);
      if (j > 0 && up)
        add_square<3>({node(i, j - 1), node(i, j), node(i, j + 1)}, kSecond, bend * across(2), matrix);
      if (right && up)
        add_square<4>({node(i, j), node(i + 1, j), node(i, j + 1), node(i + 1, j + 1)}, {1, -1, -1, 1},
                      2 * bend * along(1) * across(1), matrix);
      if (right) add_square<2>({node(i, j), node(i + 1, j)}, kFirst, pull * along(1), matrix);
      if (up) add_square<2>({node(i, j), node(i, j + 1)}, kFirst, pull * across(1), matrix);
    }
  }
}

// Directions of a section's even pieces, without jumps.
struct Directions {
  std::vector<double> theta;
  double piece_mm = 0;
};

Directions directions_of(const RibTarget& rib, double window_mm) {
  const int pieces = std::max(1, static_cast<int>(std::ceil(2 * (kAlong - 1) * rib.s.back() / window_mm)));
  const std::vector<Vector2d> q = resample(rib, 0, 1, pieces + 1);
  Directions d{{}, rib.s.back() / pieces};
  for (std::size_t i = 1; i < q.size(); ++i) {
    const Vector2d edge = q[i] - q[i - 1];
    const double theta = std::atan2(edge.y(), edge.x()), before = d.theta.empty() ? theta : d.theta.back();
    d.theta.push_back(before + std::remainder(theta - before, 2 * std::numbers::pi));
  }
  return d;
}

std::vector<std::size_t> chosen(std::size_t count) {
  std::vector<std::size_t> sections;
  const std::size_t most = std::min(count, kMostSections);
  for (std::size_t i = 0; i < most; ++i) sections.push_back(i * (count - 1) / (most - 1));
  return sections;
}

}  // namespace

DirectionPlate::Cell DirectionPlate::cell(double along_mm, double offset_mm) const {
  const double u = (kAlong - 1) * std::clamp((along_mm - window_[0]) / (window_[1] - window_[0]), 0.0, 1.0);
  const double v = (kAcross - 1) * std::clamp((offset_mm - sweep_[0]) / (sweep_[1] - sweep_[0]), 0.0, 1.0);
  const int i = std::min(static_cast<int>(u), kAlong - 2), j = std::min(static_cast<int>(v), kAcross - 2);
  const double a = u - i, b = v - j;
  return {{node(i, j), node(i + 1, j), node(i, j + 1), node(i + 1, j + 1)},
          {(1 - a) * (1 - b), a * (1 - b), (1 - a) * b, a * b}};
}

DirectionPlate::DirectionPlate(std::span<const RibTarget> sections, const std::vector<double>& starts,
                               const std::array<double, 2>& window_mm)
    : window_(window_mm), sweep_{sections.front().offset_mm, sections.back().offset_mm} {
  const double width = window_[1] - window_[0], sweep = sweep_[1] - sweep_[0];
  Triplets matrix;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(kNodes);
  add_bending(matrix);
  const std::vector<std::size_t> used = chosen(sections.size());
  // Direction and place of the section before, where both are seen.
  double theta_before = 0;
  for (std::size_t n = 0; n < used.size(); ++n) {
    const RibTarget& rib = sections[used[n]];
    const double from = sections[used[n > 0 ? n - 1 : n]].offset_mm,
                 to = sections[used[n + 1 < used.size() ? n + 1 : n]].offset_mm;
    const Directions d = directions_of(rib, width);
    const double middle = d.theta[d.theta.size() / 2];
    const double turns =
        n == 0 ? 0 : theta_before + std::remainder(middle - theta_before, 2 * std::numbers::pi) - middle;
    theta_before = middle + turns;
    const double weight = 0.5 * (to - from) / sweep * d.piece_mm / width;
    for (std::size_t i = 0; i < d.theta.size(); ++i) {
      const Cell c = cell(starts[used[n]] + d.piece_mm * (static_cast<double>(i) + 0.5), rib.offset_mm);
      add_square<4>(c.node, c.share, weight, matrix);
      for (std::size_t k = 0; k < 4; ++k) right[c.node[k]] += weight * c.share[k] * (d.theta[i] + turns);
    }
  }
  Eigen::SparseMatrix<double> normal(kNodes, kNodes);
  normal.setFromTriplets(matrix.begin(), matrix.end());
  theta_ = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(normal).solve(right);
}

double DirectionPlate::at(double along_mm, double offset_mm) const {
  const Cell c = cell(along_mm, offset_mm);
  double theta = 0;
  for (std::size_t k = 0; k < 4; ++k) theta += c.share[k] * theta_[c.node[k]];
  return theta;
}

}  // namespace hotblade::pipeline
