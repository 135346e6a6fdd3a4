#include "pipeline/plan/direction/border_runs.hpp"

#include <Eigen/Dense>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdint>

namespace hotblade::pipeline {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

// An edge of the border with the unit normal of the face beside it.
struct BorderEdge {
  int from = 0, to = 0;
  Vector3d normal;
};

BorderEdge border_edge(const surface::TriangleMesh& mesh, int corner) {
  const auto at = [&](int v) -> const Vector3d& { return mesh.vertices()[static_cast<std::size_t>(v)]; };
  const auto& t = mesh.triangles()[static_cast<std::size_t>(corner / 3)];
  return {surface::vertex_at(mesh, corner), surface::vertex_at(mesh, surface::next_corner(corner)),
          (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0])).normalized()};
}

// Closed loops of edges, each in the sense of its faces.
std::vector<std::vector<BorderEdge>> border_loops(const surface::TriangleMesh& mesh) {
  std::vector<std::vector<BorderEdge>> loops;
  for (const std::vector<int>& corners : mesh.border_loops()) {
    std::vector<BorderEdge>& loop = loops.emplace_back();
    for (const int corner : corners) loop.push_back(border_edge(mesh, corner));
  }
  return loops;
}

// Weighted means of a run: every point stands for half of both edges at it.
struct Spread {
  Vector3d centre;
  Vector3d rms;  // along the columns of `axes`, ascending
  Matrix3d axes;
};

std::vector<double> weights(const BorderRun& run) {
  std::vector<double> w(run.points.size(), 0);
  for (std::size_t i = 1; i < w.size(); ++i) {
    const double half = 0.5 * (run.points[i] - run.points[i - 1]).norm() / run.length_mm;
    w[i - 1] += half;
    w[i] += half;
  }
  return w;
}

Spread spread(const BorderRun& run) {
  const std::vector<double> w = weights(run);
  Spread s{Vector3d::Zero(), {}, {}};
  for (std::size_t i = 0; i < w.size(); ++i) s.centre += w[i] * (run.points[i] - run.points.front());
  s.centre += run.points.front();
  Matrix3d covariance = Matrix3d::Zero();
  for (std::size_t i = 0; i < w.size(); ++i) {
    const Vector3d d = run.points[i] - s.centre;
    covariance += w[i] * d * d.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(covariance);
  s.rms = solver.eigenvalues().cwiseMax(0).cwiseSqrt();
  s.axes = solver.eigenvectors();
  return s;
}

// Flatter than a thousandth of its length a run is straight: borders of files are rounded and faceted.
constexpr double kStraight = 1e-3;
// Out of the plane, as a share of the run's width in it: what meshing leaves of a plane curve.
constexpr double kPlane = 0.02;

bool lies_in_a_plane(const Spread& s) {
  return s.rms[1] > kStraight * s.rms[2] && s.rms[0] <= kPlane * s.rms[1];
}

}  // namespace

std::vector<BorderRun> border_runs(const surface::TriangleMesh& mesh) {
  constexpr double kCornerCosine = 0.8660254037844387;  // of 30 degrees
  std::vector<BorderRun> runs;
  double total = 0;
  const auto at = [&](int v) -> const Vector3d& { return mesh.vertices()[static_cast<std::size_t>(v)]; };
  const auto turns = [&](const BorderEdge& a, const BorderEdge& b) {
    const Vector3d along = at(a.to) - at(a.from), next = at(b.to) - at(b.from);
    return along.dot(next) < kCornerCosine * along.norm() * next.norm();
  };
  for (std::vector<BorderEdge>& loop : border_loops(mesh)) {
    for (std::size_t i = 0; i < loop.size(); ++i) {
      if (!turns(loop[(i + loop.size() - 1) % loop.size()], loop[i])) continue;
      std::rotate(loop.begin(), loop.begin() + static_cast<std::ptrdiff_t>(i), loop.end());
      break;
    }
    for (std::size_t i = 0; i < loop.size(); ++i) {
      if (i == 0 || turns(loop[i - 1], loop[i])) runs.push_back({{at(loop[i].from)}, Vector3d::Zero(), 0});
      BorderRun& run = runs.back();
      const double length = (at(loop[i].to) - at(loop[i].from)).norm();
      run.points.push_back(at(loop[i].to));
      run.normal += length * loop[i].normal;
      run.length_mm += length;
      total += length;
    }
  }
  for (BorderRun& run : runs) run.normal.normalize();
  constexpr double kEqual = 1e6;
  const auto key = [&](const BorderRun& run) {
    return static_cast<std::int64_t>(std::llround(kEqual * run.length_mm / total));
  };
  std::stable_sort(runs.begin(), runs.end(),
                   [&](const BorderRun& a, const BorderRun& b) { return key(a) > key(b); });
  return runs;
}

std::vector<BorderRun> long_sides(const surface::TriangleMesh& mesh) {
  constexpr std::size_t kMost = 8;
  constexpr double kLeastShare = 0.05;
  std::vector<BorderRun> runs = border_runs(mesh);
  double border = 0;
  for (const BorderRun& run : runs) border += run.length_mm;
  std::erase_if(runs, [&](const BorderRun& run) { return run.length_mm < kLeastShare * border; });
  if (runs.size() > kMost) runs.resize(kMost);
  return runs;
}

std::optional<BorderPlane> plane_of(const BorderRun& run) {
  if (run.points.size() < 2 || !(run.length_mm > 0)) return std::nullopt;
  const Spread s = spread(run);
  if (lies_in_a_plane(s)) return BorderPlane{s.centre, s.axes.col(0)};
  if (s.rms[1] > kStraight * s.rms[2]) return std::nullopt;
  const Vector3d along = run.points.back() - run.points.front();
  const Vector3d across = along.cross(run.normal);
  constexpr double kAlong = 1e-3;  // a normal along the border says nothing about a plane
  if (!(across.norm() > kAlong * along.norm())) return std::nullopt;
  return BorderPlane{s.centre, across.normalized()};
}

bool is_straight(const BorderRun& run) {
  const Spread s = spread(run);
  return s.rms[1] <= kStraight * s.rms[2];
}

std::optional<surface::FanAxis> circle_axis(const BorderRun& run) {
  if (run.points.size() < 4 || !(run.length_mm > 0)) return std::nullopt;
  const Spread s = spread(run);
  if (!lies_in_a_plane(s)) return std::nullopt;
  // |q|^2 = 2 m.q + k by least squares (Kasa 1976), exact for points on a circle.
  const std::vector<double> w = weights(run);
  Matrix3d a = Matrix3d::Zero();
  Vector3d b = Vector3d::Zero();
  std::vector<Vector2d> seen;
  for (std::size_t i = 0; i < w.size(); ++i) {
    const Vector3d d = run.points[i] - s.centre;
    seen.emplace_back(s.axes.col(2).dot(d) / s.rms[2], s.axes.col(1).dot(d) / s.rms[2]);
    const Vector3d row(2 * seen.back().x(), 2 * seen.back().y(), 1);
    a += w[i] * row * row.transpose();
    b += w[i] * seen.back().squaredNorm() * row;
  }
  const Vector3d m = a.ldlt().solve(b);
  const double radius = std::sqrt(std::max(0.0, m.z() + m.head<2>().squaredNorm()));
  const double turn = run.length_mm / (s.rms[2] * radius);
  double off = 0;
  for (std::size_t i = 0; i < w.size(); ++i) {
    const double d = (seen[i] - m.head<2>()).norm() - radius;
    off += w[i] * d * d;
  }
  constexpr double kLeastTurn = 0.1;
  // Of the arc's height: an ellipse or a parabola of the same height is off by less only where it is shallow.
  constexpr double kRound = 0.03;
  const double height = radius * (1 - std::cos(std::min(0.5 * turn, 1.6)));
  if (!(turn >= kLeastTurn) || !(std::sqrt(off) <= kRound * height)) return std::nullopt;
  const Vector2d centre = s.rms[2] * m.head<2>();
  return surface::FanAxis{s.centre + centre.x() * s.axes.col(2) + centre.y() * s.axes.col(1), s.axes.col(0)};
}

}  // namespace hotblade::pipeline
