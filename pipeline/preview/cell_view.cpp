#include "pipeline/preview/cell_view.hpp"

#include <algorithm>
#include <stdexcept>

#include "robot/arm/solid.hpp"

namespace hotblade::pipeline::preview {
namespace {

using Eigen::Isometry3d;

Isometry3d isometry(const Pose& pose) {
  Isometry3d place = Isometry3d::Identity();
  place.linear() = pose.q.toRotationMatrix();
  place.translation() = pose.p;
  return place;
}

CellPart part_of(std::string name, CellPartKind kind, const std::vector<robot::Shape>& shapes) {
  CellPart part{std::move(name), kind, {}, {}, Isometry3d::Identity(), {}};
  for (const robot::Shape& shape : shapes) {
    for (const robot::Triangle& triangle : robot::triangles_of(shape)) {
      const int first = static_cast<int>(part.vertices.size());
      part.vertices.insert(part.vertices.end(), triangle.begin(), triangle.end());
      part.triangles.push_back({first, first + 1, first + 2});
    }
  }
  return part;
}

// What a joint has to the nearer of its limits; absent for base_link and where it is not the colour.
std::optional<double> margin_of(const CellShown& shown, const robot::CellArm& arm, std::size_t moved_by,
                                const robot::JointAngles& q) {
  if (!shown.by_margin || moved_by == 0) return std::nullopt;
  const robot::Joint& joint = arm.model.arm.joints()[moved_by - 1];
  const double angle = q[static_cast<int>(moved_by) - 1];
  return std::min(angle - joint.min_rad, joint.max_rad - angle);
}

// Hands every body to `take`, with where it is: name, kind, shapes, place.
template <class Take>
void each_body(const CellShown& shown, const Strip& strip, std::size_t pose, const Take& take) {
  if (strip.joints.empty() || !strip.arms) throw std::logic_error("a pose without joints has no arms");
  const Isometry3d to_design = isometry(strip.design_to_cell).inverse();
  for (std::size_t i = 0; i < shown.cell->arms.size(); ++i) {
    const robot::CellArm& arm = shown.cell->arms[i];
    const ArmJoints& joints = strip.arms->a.arm == arm.id ? strip.joints[pose].a : strip.joints[pose].b;
    const robot::JointAngles q = Eigen::Map<const robot::JointAngles>(joints.data());
    const Isometry3d base = to_design * isometry(arm.base);
    const std::vector<Isometry3d> motions = robot::body_motions(arm.model, q);
    const CellPartKind kind = i == 0 ? CellPartKind::kFirstArm : CellPartKind::kSecondArm;
    for (std::size_t k = 0; k < arm.model.bodies.size(); ++k) {
      const robot::Body& body = arm.model.bodies[k];
      take("arm_" + arm.id + "_" + body.link, kind, body.shapes,
           CellPlace{base * motions[k], margin_of(shown, arm, body.moved_by, q)});
    }
    take("arm_" + arm.id + "_tool", CellPartKind::kTool, arm.tool.shapes,
         CellPlace{base * robot::forward(arm.model.arm, q), {}});
  }
  const auto standing = shown.standing.find(strip.id);
  if (standing == shown.standing.end()) return;
  for (const robot::Standing& body : standing->second)
    take(body.name, CellPartKind::kStanding, body.shapes, CellPlace{to_design, {}});
}

}  // namespace

std::vector<CellPart> cell_parts(const CellShown& shown, const Strip& strip, std::size_t pose) {
  std::vector<CellPart> parts;
  each_body(shown, strip, pose,
            [&](std::string name, CellPartKind kind, const auto& shapes, const CellPlace& place) {
              CellPart& part = parts.emplace_back(part_of(std::move(name), kind, shapes));
              part.place = place.at;
              part.margin_rad = place.margin_rad;
            });
  return parts;
}

std::vector<CellPlace> cell_places(const CellShown& shown, const Strip& strip, std::size_t pose) {
  std::vector<CellPlace> places;
  each_body(shown, strip, pose, [&](const std::string&, CellPartKind, const auto&, const CellPlace& place) {
    places.push_back(place);
  });
  return places;
}

}  // namespace hotblade::pipeline::preview
