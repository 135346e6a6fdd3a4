#include "robot/arm/urdf.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <utility>

#include "robot/arm/model_file.hpp"
#include "robot/arm/urdf_elements.hpp"

namespace hotblade::robot {
namespace {

using Eigen::Isometry3d;

constexpr const char* kBase = "base_link";
constexpr const char* kFlange = "tool0";

// Puts the elements together from base_link on, all joints at zero.
class Tree {
 public:
  Tree(const UrdfElements& elements, const std::string& name) : elements_(elements), name_(name) {
    for (const UrdfLink& link : elements.links) links_[link.name] = &link;
    for (const UrdfJoint& joint : elements.joints) connect(joint);
    for (const char* needed : {kBase, kFlange}) {
      if (!links_.contains(needed))
        fail(elements.line, std::string("no link \"") + needed + "\": arms are read from base_link to tool0");
    }
    find_chain();
    place({kBase, Isometry3d::Identity(), 0, {}, kBase});
    for (const UrdfLink& link : elements.links) {
      if (!placed_.contains(link.name) && !link.shapes.empty())
        fail(link.line, "link \"" + link.name + "\" does not hang on base_link");
    }
  }

  ArmModel model() const {
    std::array<Joint, kJoints> joints;
    for (std::size_t i = 0; i < kJoints; ++i) {
      const UrdfJoint& joint = *chain_[i];
      const Isometry3d& at = placed_.at(joint.child);
      joints[i] = {joint.name,    at.linear() * joint.axis, at.translation(), joint.min_rad,
                   joint.max_rad, joint.speed_rad_s};
    }
    check_axes(joints);
    return {arm(joints), bodies_, elements_.ignored, shapeless()};
  }

 private:
  // A link on the way from base_link.
  struct Place {
    std::string link;
    Isometry3d at;
    std::size_t moved_by;
    std::vector<MimicJoint> mimics;
    std::string body;  // the link that it belongs to: fixed joints make no body of their own
  };

  [[noreturn]] void fail(int line, const std::string& what) const {
    throw ModelError(name_ + ":" + std::to_string(line) + ": " + what);
  }

  void connect(const UrdfJoint& joint) {
    for (const std::string& link : {joint.parent, joint.child}) {
      if (!links_.contains(link))
        fail(joint.line, "joint \"" + joint.name + "\" names no link: \"" + link + "\"");
    }
    const auto [before, is_new] = above_.emplace(joint.child, &joint);
    if (!is_new) {
      fail(joint.line, "link \"" + joint.child + "\" is the child of \"" + joint.name + "\" and of \"" +
                           before->second->name + "\"");
    }
    below_[joint.parent].push_back(&joint);
  }

  void find_chain() {
    std::string link = kFlange;
    for (std::size_t steps = 0; link != kBase; ++steps) {
      const auto joint = above_.find(link);
      if (joint == above_.end() || steps > elements_.joints.size())
        fail(links_.at(kFlange)->line, "tool0 does not hang on base_link");
      if (joint->second->kind == UrdfJointKind::kTurning) chain_.insert(chain_.begin(), joint->second);
      link = joint->second->parent;
    }
    if (chain_.size() != kJoints) {
      fail(links_.at(kFlange)->line,
           std::to_string(chain_.size()) + " turning joints between base_link and tool0, must be six");
    }
    for (const UrdfJoint* joint : chain_) {
      if (joint->mimic)
        fail(joint->mimic->line, "joint \"" + joint->name + "\" of the six turns with another");
    }
  }

  std::vector<std::string> shapeless() const {
    std::vector<std::string> names = moving_;
    std::erase_if(names, [this](const std::string& name) {
      return std::any_of(bodies_.begin(), bodies_.end(), [&](const Body& b) { return b.link == name; });
    });
    return names;
  }

  void place(const Place& here) {
    placed_[here.link] = here.at;
    if (here.body == here.link) moving_.push_back(here.link);
    const UrdfLink& link = *links_.at(here.link);
    for (const Shape& shape : link.shapes)
      body_of(here).shapes.push_back({here.at * shape.place, shape.solid});
    for (const UrdfJoint* joint : below_[here.link]) {
      // base_link may stand on a world; a circle would come back to a link that is placed.
      if (placed_.contains(joint->child)) fail(joint->line, "joint \"" + joint->name + "\" closes a circle");
      place(beyond(here, *joint));
    }
  }

  Place beyond(const Place& here, const UrdfJoint& joint) const {
    Place next{joint.child, here.at * joint.origin, here.moved_by, here.mimics, here.body};
    if (joint.kind == UrdfJointKind::kFixed) return next;
    next.body = joint.child;
    const auto of_six = std::find(chain_.begin(), chain_.end(), &joint);
    if (of_six != chain_.end()) {
      next.moved_by = static_cast<std::size_t>(of_six - chain_.begin()) + 1;
      return next;
    }
    if (!joint.mimic) {
      fail(joint.line, "joint \"" + joint.name +
                           "\" turns on its own beside the six: leave it out or say with <mimic> "
                           "which it follows");
    }
    const auto followed = std::find_if(chain_.begin(), chain_.end(),
                                       [&](const UrdfJoint* j) { return j->name == joint.mimic->joint; });
    if (followed == chain_.end())
      fail(joint.mimic->line,
           "joint \"" + joint.name + "\" follows \"" + joint.mimic->joint + "\", must be one of the six");
    next.mimics.push_back({next.at.linear() * joint.axis, next.at.translation(),
                           static_cast<std::size_t>(followed - chain_.begin()), joint.mimic->factor,
                           joint.mimic->offset_rad});
    return next;
  }

  Body& body_of(const Place& here) {
    const auto found =
        std::find_if(bodies_.begin(), bodies_.end(), [&](const Body& b) { return b.link == here.body; });
    if (found != bodies_.end()) return *found;
    bodies_.push_back({here.body, here.moved_by, here.mimics, {}});
    return bodies_.back();
  }

  void check_axes(const std::array<Joint, kJoints>& joints) const {
    for (const AxisError& e : axis_errors(joints)) {
      if (e.angle_rad <= kRoundedAxis_rad && e.distance_mm <= kRoundedAxis_mm) continue;
      const bool meeting = e.relation == AxisError::Relation::kMeeting;
      std::array<char, 160> amount;
      if (meeting) {
        std::snprintf(amount.data(), amount.size(), "%.4g mm from meeting", e.distance_mm);
      } else {
        std::snprintf(amount.data(), amount.size(), "%.4g deg from %s", e.angle_rad / kDegree_rad,
                      e.relation == AxisError::Relation::kSquare ? "square to" : "parallel to");
      }
      const std::string limit = meeting ? "0.1 at most" : "0.0057 at most";
      fail(chain_[e.second]->line, chain_[e.second]->name + " axis is " + amount.data() + " " +
                                       chain_[e.first]->name + ", " + limit +
                                       ": this arm has no spherical wrist or no parallel axes 2 and 3");
    }
  }

  Arm arm(const std::array<Joint, kJoints>& joints) const {
    try {
      return {elements_.robot, joints, placed_.at(kFlange)};
    } catch (const std::logic_error&) {
      fail(chain_[2]->line, "axes " + chain_[1]->name + " and " + chain_[2]->name + ", or " +
                                chain_[2]->name + " and the wrist, are in one line");
    }
  }

  const UrdfElements& elements_;
  const std::string& name_;
  std::map<std::string, const UrdfLink*> links_;
  std::map<std::string, const UrdfJoint*> above_;
  std::map<std::string, std::vector<const UrdfJoint*>> below_;
  std::vector<const UrdfJoint*> chain_;
  std::map<std::string, Isometry3d> placed_;
  std::vector<Body> bodies_;
  std::vector<std::string> moving_;  // the base and links on joints that turn
};

}  // namespace

std::vector<Isometry3d> body_motions(const ArmModel& model, const JointAngles& q) {
  const auto links = link_motions(model.arm, q);
  std::vector<Isometry3d> motions;
  for (const Body& body : model.bodies) {
    Isometry3d motion = links[body.moved_by];
    for (const MimicJoint& m : body.mimics)
      motion =
          motion * turn_about(m.axis, m.point_mm, m.factor * q[static_cast<int>(m.joint)] + m.offset_rad);
    motions.push_back(motion);
  }
  return motions;
}

ArmModel parse_urdf(const std::string& text, const std::string& name, const std::filesystem::path& folder) {
  return Tree(parse_urdf_elements(text, name, folder), name).model();
}

ArmModel read_urdf(const std::filesystem::path& file) {
  return parse_urdf(read_model_file(file), file.string(), file.parent_path());
}

}  // namespace hotblade::robot
