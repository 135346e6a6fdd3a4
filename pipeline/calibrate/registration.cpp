#include "pipeline/calibrate/registration.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace hotblade::pipeline {

namespace {

using Points = std::vector<Eigen::Vector3d>;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

Points moved_by(const Eigen::Isometry3d& move, std::span<const Eigen::Vector3d> points) {
  Points out;
  out.reserve(points.size());
  for (const Eigen::Vector3d& p : points) out.push_back(move * p);
  return out;
}

Eigen::Vector3d middle(std::span<const Eigen::Vector3d> points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) sum += p;
  return sum / static_cast<double>(points.size());
}

// A right-handed frame of the longest, the middle and the flattest axis of points, about their middle, and
// the points' half extents along the first two.
struct BodyAxes {
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  Eigen::Vector2d half{0, 0};
};

BodyAxes body_axes_of(std::span<const Eigen::Vector3d> points) {
  BodyAxes axes;
  const Eigen::Vector3d centre = middle(points);
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& p : points) spread += (p - centre) * (p - centre).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
  Eigen::Matrix3d turn;
  turn.col(0) = solver.eigenvectors().col(2);
  turn.col(2) = solver.eigenvectors().col(0);
  turn.col(1) = turn.col(2).cross(turn.col(0));
  axes.frame.linear() = turn;
  axes.frame.translation() = centre;
  // Of most points: a few far ones are no part of the body.
  for (int k = 0; k < 2; ++k) {
    std::vector<double> along;
    along.reserve(points.size());
    for (const Eigen::Vector3d& p : points) along.push_back(std::abs(turn.col(k).dot(p - centre)));
    const auto place =
        along.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(along.size() - 1));
    std::nth_element(along.begin(), place, along.end());
    axes.half[k] = *place;
  }
  return axes;
}

double misfit_of(const CutMesh& cut, std::span<const Eigen::Vector3d> points) {
  double sum = 0;
  for (const double d : cut.distances(points)) sum += std::min(d, kFarMm) * std::min(d, kFarMm);
  return std::sqrt(sum / static_cast<double>(points.size()));
}

// One round: the small motion that brings points nearest to the planes of their feet. Points farther than
// `reach_mm` have no vote.
Eigen::Isometry3d one_round(const CutMesh& cut, const Points& points, double reach_mm) {
  const Eigen::Vector3d centre = middle(points);
  Matrix6 normal = Matrix6::Zero();
  Vector6 right = Vector6::Zero();
  const std::vector<Foot> feet = cut.feet(points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d d = points[i] - feet[i].point;
    const double distance = d.norm();
    if (distance > reach_mm) continue;
    // Past an edge the point is drawn straight to it, or nothing would hold the scan along the surface.
    const Eigen::Vector3d towards = feet[i].beside ? d / distance : feet[i].normal;
    Vector6 row;
    row << (points[i] - centre).cross(towards), towards;
    const double height = feet[i].beside ? distance : feet[i].height_mm;
    const double u = distance / reach_mm, weight = (1 - u * u) * (1 - u * u);
    normal += weight * row * row.transpose();
    right -= weight * height * row;
  }
  // What nothing holds stays: a flat cut lets a scan slide. Far below what a hundred points say of a bent
  // one, turns and shifts each by their own size.
  constexpr double kHeld = 1e-6;
  normal.diagonal().head<3>().array() += kHeld * (1 + normal.diagonal().head<3>().sum());
  normal.diagonal().tail<3>().array() += kHeld * (1 + normal.diagonal().tail<3>().sum());
  return step_about(centre, normal.ldlt().solve(right));
}

bool same_place(const Eigen::Isometry3d& p, const Eigen::Isometry3d& q, const Eigen::Vector3d& centre) {
  constexpr double kSameRad = 12 * std::numbers::pi / 180, kSameMm = 20;
  return Eigen::AngleAxisd(p.linear().transpose() * q.linear()).angle() < kSameRad &&
         (p * centre - q * centre).norm() < kSameMm;
}

std::vector<Eigen::Isometry3d> starts(const CutMesh& cut, std::span<const Eigen::Vector3d> points) {
  constexpr int kTurns = 24;
  constexpr double kWorthMoving = 0.1;  // of the cut's half extent
  const BodyAxes body = body_axes_of(cut.surface().vertices), scan = body_axes_of(points);
  std::vector<Eigen::Isometry3d> all;
  for (int turn = 0; turn < kTurns; ++turn) {
    for (const bool upside_down : {false, true}) {
      Eigen::Matrix3d way = Eigen::AngleAxisd(turn * 2 * std::numbers::pi / kTurns, Eigen::Vector3d::UnitZ())
                                .toRotationMatrix();
      if (upside_down)
        way = way * Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()).toRotationMatrix();
      // How far a smaller scan may lie from the cut's middle.
      const Eigen::Vector2d of_scan = (way.topLeftCorner<2, 2>().cwiseAbs() * scan.half);
      std::array<std::vector<double>, 2> shifts;
      for (int k = 0; k < 2; ++k) {
        const double room = body.half[k] - of_scan[k];
        shifts[static_cast<std::size_t>(k)] =
            room > kWorthMoving * body.half[k] ? std::vector<double>{-room, 0, room} : std::vector<double>{0};
      }
      for (const double dx : shifts[0]) {
        for (const double dy : shifts[1]) {
          Eigen::Isometry3d between = Eigen::Isometry3d::Identity();
          between.linear() = way;
          between.translation() = Eigen::Vector3d(dx, dy, 0);
          all.push_back(body.frame * between * scan.frame.inverse());
        }
      }
    }
  }
  return all;
}

// The best of candidates, no two alike.
std::vector<Placement> best_of(std::vector<Placement> all, std::size_t most, const Eigen::Vector3d& centre) {
  std::stable_sort(all.begin(), all.end(),
                   [](const Placement& p, const Placement& q) { return p.misfit_mm < q.misfit_mm; });
  std::vector<Placement> kept;
  for (const Placement& candidate : all) {
    const bool known = std::any_of(kept.begin(), kept.end(), [&](const Placement& k) {
      return same_place(k.scan_to_design, candidate.scan_to_design, centre);
    });
    if (!known) kept.push_back(candidate);
    if (kept.size() == most) break;
  }
  return kept;
}

}  // namespace

Eigen::Isometry3d step_about(const Eigen::Vector3d& centre, const Vector6& step) {
  const Eigen::Vector3d turn = step.head<3>();
  const double angle = turn.norm();
  Eigen::Isometry3d move = Eigen::Isometry3d::Identity();
  if (angle > 0) move.linear() = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
  move.translation() = centre + step.tail<3>() - move.linear() * centre;
  return move;
}

std::vector<Eigen::Vector3d> some_of(std::span<const Eigen::Vector3d> points, std::size_t most) {
  const std::size_t step = std::max<std::size_t>(1, (points.size() + most - 1) / most);
  Points some;
  for (std::size_t i = 0; i < points.size(); i += step) some.push_back(points[i]);
  return some;
}

Placement drawn_to(const CutMesh& cut, std::span<const Eigen::Vector3d> points, const Eigen::Isometry3d& from,
                   int rounds) {
  constexpr double kNearest = 3, kStillMm = 1e-4;
  Placement placed{from, 0};
  for (int round = 0; round < rounds; ++round) {
    const Points there = moved_by(placed.scan_to_design, points);
    // From a few times the middle distance on points have no vote, but never sooner than far ones: a scan
    // that slides past an edge of the cut is held there by the points beyond it.
    std::vector<double> distances = cut.distances(there);
    const auto half = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
    std::nth_element(distances.begin(), half, distances.end());
    const Eigen::Isometry3d step = one_round(cut, there, std::max(kNearest * *half, kFarMm));
    placed.scan_to_design = step * placed.scan_to_design;
    const Eigen::Vector3d centre = middle(there);
    if ((step * centre - centre).norm() < kStillMm && Eigen::AngleAxisd(step.linear()).angle() < 1e-6) break;
  }
  // Products of many rotations stay rotations.
  placed.scan_to_design.linear() =
      Eigen::Quaterniond(placed.scan_to_design.linear()).normalized().toRotationMatrix();
  placed.misfit_mm = misfit_of(cut, moved_by(placed.scan_to_design, points));
  return placed;
}

std::vector<Placement> placements(const CutMesh& cut, std::span<const Eigen::Vector3d> points) {
  if (points.empty()) throw std::logic_error("a scan without points has no place");
  constexpr std::size_t kFewPoints = 150, kMorePoints = 600, kFirst = 16, kLast = 6;
  constexpr int kFewRounds = 6, kMoreRounds = 30;
  const Points few = some_of(points, kFewPoints), more = some_of(points, kMorePoints);
  const Eigen::Vector3d centre = middle(more);
  const auto draw_all = [&](std::vector<Placement> from, const Points& with, int rounds) {
    tbb::parallel_for(std::size_t{0}, from.size(),
                      [&](std::size_t i) { from[i] = drawn_to(cut, with, from[i].scan_to_design, rounds); });
    return from;
  };
  std::vector<Placement> all;
  for (const Eigen::Isometry3d& start : starts(cut, more)) all.push_back({start, 0});
  all = best_of(draw_all(std::move(all), few, kFewRounds), kFirst, centre);
  all = best_of(draw_all(std::move(all), more, kMoreRounds), kLast, centre);
  constexpr double kTimes = 2, kMoreMm = 0.5;
  std::erase_if(all, [best = all.front().misfit_mm](const Placement& p) {
    return p.misfit_mm > kTimes * best + kMoreMm;
  });
  return all;
}

std::string turn_between(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to) {
  const Eigen::AngleAxisd turn((to * from.inverse()).linear());
  const Eigen::Vector3d& axis = turn.axis();
  return fmt::format("turned by {:.0f} degrees about ({:.2f}, {:.2f}, {:.2f})",
                     turn.angle() * 180 / std::numbers::pi, axis.x(), axis.y(), axis.z());
}

}  // namespace hotblade::pipeline
