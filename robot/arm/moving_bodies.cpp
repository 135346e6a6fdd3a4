#include "robot/arm/moving_bodies.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace hotblade::robot {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

Isometry3d isometry(const Pose& pose) {
  Isometry3d place = Isometry3d::Identity();
  place.linear() = pose.q.toRotationMatrix();
  place.translation() = pose.p;
  return place;
}

// How far a quantity leaves the straight line between two poses by its second derivative: h^2/8 of it. At
// the ends the derivative is that of the pose beside.
template <class Value, class At, class Size>
Value bend_of(const std::vector<double>& t, std::size_t step, const At& at, const Size& size) {
  const auto second = [&](std::size_t pose) {
    const std::size_t k = std::clamp<std::size_t>(pose, 1, t.size() - 2);
    const double before = t[k] - t[k - 1], after = t[k + 1] - t[k];
    return Value(size(((at(k + 1) - at(k)) / after - (at(k) - at(k - 1)) / before) / ((before + after) / 2)));
  };
  const double h = t[step + 1] - t[step];
  return Value(second(step).cwiseMax(second(step + 1)) * (h * h / 8));
}

// A joint of the arm that turns a body, and the farthest that the body's points get from its axis.
struct Lever {
  int joint = 0;
  double mm = 0;
  bool own = false;  // of the body alone: it follows that joint
};

// Along the chain of axes from the body inwards: its distance from a point of an axis is kept by turns about
// that axis.
std::vector<Lever> levers_of(const Arm& arm, std::size_t joints, const std::vector<MimicJoint>& mimics,
                             const Solid& solid) {
  struct Link {
    Vector3d axis, point;
    int joint;
    double factor;
  };
  std::vector<Link> chain;
  for (std::size_t i = 0; i < joints; ++i) {
    const Joint& joint = arm.joints()[i];
    // The point of the axis that is nearest to the wrist, which makes the sum of lengths small.
    const Vector3d point = joint.point_mm + joint.axis.dot(arm.wrist_at_zero() - joint.point_mm) * joint.axis;
    chain.push_back({joint.axis, point, static_cast<int>(i), 1});
  }
  for (const MimicJoint& m : mimics)
    chain.push_back({m.axis, m.point_mm, static_cast<int>(m.joint), std::abs(m.factor)});
  std::vector<Lever> levers;
  const auto from_axis = [](const Link& link, const Vector3d& p) {
    return (p - link.point).cross(link.axis).norm();
  };
  double reach = 0;  // from the point of the axis after this to the body's farthest point
  for (std::size_t i = chain.size(); i-- > 0;) {
    const bool last = i + 1 == chain.size();
    const Vector3d next = last ? solid.centre() : chain[i + 1].point;
    if (last) reach = solid.radius_mm();
    levers.push_back({chain[i].joint, chain[i].factor * (from_axis(chain[i], next) + reach), i >= joints});
    reach += (next - chain[i].point).norm();
  }
  return levers;
}

class ArmBody : public MovingBody {
 public:
  ArmBody(const CellArm& cell_arm, std::size_t index, const Body& body, const CellPath& path)
      : cell_arm_(cell_arm), mimics_(body.mimics), path_(path), solid_(body.shapes) {
    arm = index;
    joints = body.moved_by;
    follower = !body.mimics.empty();
    base_ = isometry(cell_arm.base);
    const std::vector<JointAngles>& q = path.joints[arm];
    at_.reserve(q.size());
    for (const JointAngles& angles : q) at_.push_back(place(angles));
    levers_ = levers_of(cell_arm.model.arm, joints, mimics_, solid_);
  }

  [[nodiscard]] PlacedSolid placed(std::size_t pose, double share) const override {
    if (share <= 0) return {solid_, at_[pose]};
    const std::vector<JointAngles>& q = path_.joints[arm];
    return {solid_, place(q[pose] + share * (q[pose + 1] - q[pose]))};
  }

  [[nodiscard]] Way way(std::size_t from_joint) const override {
    const std::vector<JointAngles>& q = path_.joints[arm];
    Way way;
    for (std::size_t k = 0; k + 1 < q.size(); ++k) {
      const JointAngles bends = q.size() < 3
                                    ? JointAngles(JointAngles::Zero())
                                    : bend_of<JointAngles>(
                                          path_.t, k, [&](std::size_t i) { return q[i]; },
                                          [](const JointAngles& v) { return JointAngles(v.cwiseAbs()); });
      double straight = 0, bend = 0;
      for (const Lever& lever : levers_) {
        if (!lever.own && lever.joint < static_cast<int>(from_joint)) continue;
        straight += lever.mm * std::abs(q[k + 1][lever.joint] - q[k][lever.joint]);
        bend += lever.mm * bends[lever.joint];
      }
      way.straight_mm.push_back(straight);
      way.bend_mm.push_back(bend);
    }
    return way;
  }

 private:
  [[nodiscard]] Isometry3d place(const JointAngles& q) const {
    Isometry3d at = base_ * link_motions(cell_arm_.model.arm, q)[joints];
    for (const MimicJoint& m : mimics_)
      at = at * turn_about(m.axis, m.point_mm, m.factor * q[static_cast<int>(m.joint)] + m.offset_rad);
    return at;
  }

  const CellArm& cell_arm_;
  std::vector<MimicJoint> mimics_;
  const CellPath& path_;
  Solid solid_;
  std::vector<Lever> levers_;
  Isometry3d base_;
  std::vector<Isometry3d> at_;
};

class StandingBody : public MovingBody {
 public:
  StandingBody(const Standing& standing, std::size_t poses) : solid_(standing.shapes), poses_(poses) {
    name = standing.name;
  }
  [[nodiscard]] PlacedSolid placed(std::size_t, double) const override {
    return {solid_, Isometry3d::Identity()};
  }
  [[nodiscard]] Way way(std::size_t) const override {
    return {std::vector<double>(poses_ - 1, 0), std::vector<double>(poses_ - 1, 0)};
  }

 private:
  Solid solid_;
  std::size_t poses_;
};

class BladeBody : public MovingBody {
 public:
  BladeBody(const CellPath& path, std::size_t from, std::size_t to)
      : band_(path.blade), from_(from), to_(to), cache_(path.t.size()) {
    name = "the blade";
    const auto& corners = band_.corners;
    for (std::size_t k = 0; k + 1 < corners.size(); ++k) {
      double straight = 0, bend = 0;
      for (std::size_t i = 2 * from; i < 2 * to + 2; ++i) {
        straight = std::max(straight, (corners[k + 1][i] - corners[k][i]).norm());
        if (corners.size() < 3) continue;
        using Amount = Eigen::Matrix<double, 1, 1>;
        bend = std::max(bend, bend_of<Amount>(
                                  path.t, k, [&](std::size_t pose) { return corners[pose][i]; },
                                  [](const Vector3d& v) { return Amount(v.norm()); })
                                  .value());
      }
      way_.straight_mm.push_back(straight);
      way_.bend_mm.push_back(bend);
    }
  }

  [[nodiscard]] PlacedSolid placed(std::size_t pose, double share) const override {
    if (share > 0) return {sheet(pose, share), Isometry3d::Identity()};
    if (!cache_[pose]) cache_[pose] = std::make_unique<Solid>(sheet(pose, 0));
    return {*cache_[pose], Isometry3d::Identity()};
  }
  [[nodiscard]] Way way(std::size_t) const override { return way_; }

 private:
  [[nodiscard]] Solid sheet(std::size_t pose, double share) const {
    const auto& now = band_.corners[pose];
    const auto& next = band_.corners[share > 0 ? pose + 1 : pose];
    const auto corner = [&](std::size_t i) { return Vector3d(now[i] + share * (next[i] - now[i])); };
    std::vector<Triangle> triangles;
    for (std::size_t i = 2 * from_; i < 2 * to_; i += 2) {
      triangles.push_back({corner(i), corner(i + 1), corner(i + 2)});
      triangles.push_back({corner(i + 1), corner(i + 3), corner(i + 2)});
    }
    return Solid(std::move(triangles));
  }

  const BladeBand& band_;
  std::size_t from_, to_;
  Way way_;
  mutable std::vector<std::unique_ptr<Solid>> cache_;
};

}  // namespace

Bodies arm_bodies(const Cell& cell, std::size_t arm, const CellPath& path) {
  const CellArm& from = cell.arms[arm];
  Bodies bodies;
  for (const Body& body : from.model.bodies) {
    if (body.shapes.empty()) continue;
    bodies.push_back(std::make_unique<ArmBody>(from, arm, body, path));
    bodies.back()->name = "arm " + from.id + " " + body.link;
  }
  if (from.tool.shapes.empty()) return bodies;
  Body tool{"tool", kJoints, {}, from.tool.shapes};
  for (Shape& shape : tool.shapes) shape.place = from.model.arm.flange_at_zero() * shape.place;
  bodies.push_back(std::make_unique<ArmBody>(from, arm, tool, path));
  bodies.back()->name = "arm " + from.id + " tool";
  bodies.back()->tool = true;
  return bodies;
}

std::unique_ptr<MovingBody> standing_body(const Standing& standing, std::size_t poses) {
  return std::make_unique<StandingBody>(standing, poses);
}

std::unique_ptr<MovingBody> blade_body(const CellPath& path, std::size_t from, std::size_t to) {
  return std::make_unique<BladeBody>(path, from, to);
}

}  // namespace hotblade::robot
