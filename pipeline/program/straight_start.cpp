#include "pipeline/program/straight_start.hpp"

#include <cmath>

#include "elastica/curve/elastica.hpp"
#include "pipeline/program/clamps.hpp"

namespace hotblade::pipeline {
namespace {

// The blade with a share of its bending, its middle where it was.
elastica::Elastica bent_by(const elastica::Elastica& blade, double share) {
  const double half = blade.length / 2;
  const elastica::CurvePoint middle = elastica::point_at(blade, half);
  elastica::Elastica part = blade;
  part.kappa *= share;
  part.lambda1 *= share;
  part.lambda2 *= share;
  const elastica::CurvePoint off = elastica::point_at(part, half);
  // Turned about its middle: what bends it turns with it.
  const double turn = middle.theta - off.theta, c = std::cos(turn), s = std::sin(turn);
  const Eigen::Vector2d from = Eigen::Vector2d(part.x, part.y) - off.position();
  const Eigen::Vector2d start =
      middle.position() + Eigen::Vector2d(c * from.x() - s * from.y(), s * from.x() + c * from.y());
  const double g1 = part.lambda2, g2 = -part.lambda1;
  part.x = start.x();
  part.y = start.y();
  part.theta += turn;
  part.lambda2 = c * g1 - s * g2;
  part.lambda1 = -(s * g1 + c * g2);
  return part;
}

// A clamp that holds the blade where another does, told as far off it as a first one was.
Pose told_as(const Pose& held, const Pose& first_held, const Pose& first_told) {
  const Eigen::Quaterniond back = first_held.q.conjugate();
  return {held.p + held.q * (back * (first_told.p - first_held.p)),
          robot::canonical((held.q * (back * first_told.q)).normalized())};
}

}  // namespace

std::vector<BladePose> straight_start(const Strip& strip) {
  const BladePose& first = strip.poses.front();
  // Clamps that a calibration found to be off are told otherwise than they hold
  // (robot/pose/clamp_offset.hpp).
  const ClampPoses holding = clamps(first.blade, first.frame);
  std::vector<BladePose> poses;
  for (int k = 0; k < kStartMoves; ++k) {
    const double u = static_cast<double>(k) / kStartMoves;
    BladePose pose;
    pose.t = first.t - kStart_s * (1 - u);
    pose.frame = first.frame;
    // At rest at both ends.
    pose.blade = bent_by(first.blade, u * u * (3 - 2 * u));
    const ClampPoses pair = clamps(pose.blade, pose.frame);
    pose.a = told_as(pair.a, holding.a, first.a);
    pose.b = told_as(pair.b, holding.b, first.b);
    poses.push_back(pose);
  }
  poses.push_back(first);
  return poses;
}

}  // namespace hotblade::pipeline
