#include "pipeline/program/parse_arms.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pipeline/program/program_limits.hpp"
#include "pipeline/settings/error.hpp"
#include "robot/arm/clearance.hpp"

namespace hotblade::pipeline {
namespace {

Pose arm_pose(const JsonNode& parent, const char* key) {
  const JsonNode node = parent.field(key);
  node.expect_keys(std::array{"p", "q"});
  const JsonNode p = node.field("p"), q = node.field("q");
  (void)p.items(3, true);
  (void)q.items(4, true);
  const std::vector<double> at = p.numbers(3, kAny), turn = q.numbers(4, kAny);
  const Eigen::Quaterniond turned(turn[0], turn[1], turn[2], turn[3]);
  if (!is_unit(turned.norm())) q.fail("is not of length 1");
  return {{at[0], at[1], at[2]}, turned};
}

std::string arm_sha256(const JsonNode& node) {
  const std::string& digits = node.text();
  const bool hex = digits.find_first_not_of("0123456789abcdef") == std::string::npos;
  if (digits.size() != 64 || !hex) node.fail("is not a SHA-256 (64 lower-case hex digits)");
  return digits;
}

ArmJoints six(const JsonNode& node, const char* key) {
  const JsonNode field = node.field(key);
  (void)field.items(kArmJoints, true);
  const std::vector<double> values = field.numbers(kArmJoints, kAny);
  ArmJoints joints;
  std::copy(values.begin(), values.end(), joints.begin());
  return joints;
}

int small_whole(const JsonNode& node, int most) {
  const double value = node.number({-static_cast<double>(most), static_cast<double>(most)});
  if (value != std::floor(value)) node.fail("is not a whole number");
  return static_cast<int>(value);
}

HeldClamp held_of(const JsonNode& node) {
  constexpr int kMostTurns = 1000;
  node.expect_keys(std::array{"arm", "branch", "flip", "turns"});
  HeldClamp held;
  held.arm = node.field("arm").text();
  const JsonNode branch = node.field("branch"), turns = node.field("turns");
  (void)branch.items(held.branch.size(), true);
  for (std::size_t i = 0; i < held.branch.size(); ++i) {
    const JsonNode sign = branch.item(i);
    held.branch[i] = small_whole(sign, 1);
    if (held.branch[i] == 0) sign.fail("is neither 1 nor -1");
  }
  held.flip = node.field("flip").boolean();
  (void)turns.items(kArmJoints, true);
  for (std::size_t i = 0; i < kArmJoints; ++i) held.turns[i] = small_whole(turns.item(i), kMostTurns);
  return held;
}

StripArms::Nearest nearest_of(const JsonNode& node, bool joint) {
  (void)node.items(joint ? 4 : 3, true);
  StripArms::Nearest nearest;
  const JsonNode value = node.item(0), arm = node.item(1), t = node.item(joint ? 3 : 2);
  nearest.value = value.number(kAny);
  nearest.arm = arm.text();
  if (joint) nearest.joint = small_whole(node.item(2), static_cast<int>(kArmJoints));
  nearest.t = t.number(kTime);
  return nearest;
}

std::vector<StripArms::NearestPair> nearest_pairs_of(const JsonNode& node) {
  if (!node.json().is_object()) node.fail("is no object");
  std::vector<StripArms::NearestPair> pairs;
  for (const auto& [key, value] : node.json().items()) {
    const bool known = std::any_of(robot::kPairKinds.begin(), robot::kPairKinds.end(),
                                   [&](robot::PairKind kind) { return key == robot::name(kind); });
    if (!known) node.fail("has the unknown kind \"" + key + "\"");
    const JsonNode pair = node.field(key.c_str());
    (void)pair.items(2, true);
    const JsonNode mm = pair.item(0), t = pair.item(1);
    pairs.push_back({key, mm.number({0, robot::kWidest_mm}), t.number(kTime)});
  }
  return pairs;
}

ProgramArm program_arm_of(const JsonNode& node) {
  node.expect_keys(std::array{"id", "model", "files_sha256", "base", "jaw", "joints"});
  ProgramArm arm;
  arm.id = node.field("id").text();
  arm.model = node.field("model").text();
  arm.files_sha256 = arm_sha256(node.field("files_sha256"));
  arm.base = arm_pose(node, "base");
  arm.jaw = arm_pose(node, "jaw");
  const JsonNode joints = node.field("joints");
  (void)joints.items(kArmJoints, true);
  for (std::size_t i = 0; i < kArmJoints; ++i) {
    const JsonNode joint = joints.item(i);
    joint.expect_keys(std::array{"name", "min", "max", "speed", "acceleration", "jerk"});
    arm.joints[i] = {joint.field("name").text(),
                     joint.field("min").number(),
                     joint.field("max").number(),
                     joint.field("speed").number(kPositive),
                     joint.field("acceleration").number(kPositive),
                     joint.field("jerk").number(kPositive)};
    if (arm.joints[i].min_rad >= arm.joints[i].max_rad) joint.fail("min is not below max");
  }
  return arm;
}

[[noreturn]] void fail_joints(const std::string& file_name, std::size_t strip, const std::string& what) {
  throw Error(ErrorKind::kBadInput, fmt::format("{}: strips[{}]{}", file_name, strip, what));
}

bool comes_after(const std::vector<double>& times, std::size_t i, std::size_t poses) {
  return times.size() == poses && (i == 0 || times[i] > times[i - 1]);
}

// The joints of one clamp's arm within its limits.
void expect_within(const ArmJoints& joints, const ProgramArm& arm, const std::string& file_name,
                   std::size_t strip, std::size_t pose, const char* clamp) {
  for (std::size_t i = 0; i < kArmJoints; ++i) {
    const ProgramJoint& joint = arm.joints[i];
    if (joints[i] >= joint.min_rad && joints[i] <= joint.max_rad) continue;
    fail_joints(file_name, strip,
                fmt::format(".poses[{}].joints.{}[{}]: is outside the limits of {} ({}, {} to {})", pose,
                            clamp, i, joint.name, joints[i], joint.min_rad, joint.max_rad));
  }
}

}  // namespace

ClampJoints joints_of(const JsonNode& node) {
  node.expect_keys(std::array{"a", "b"});
  return {six(node, "a"), six(node, "b")};
}

StripArms strip_arms_of(const JsonNode& node) {
  std::vector<const char*> keys{"a", "b", "joint_margin_rad", "wrist_rad", "place"};
  // Programs without these were made before distances and times were looked at, and keep reading.
  const bool has_nearest = node.json().is_object() && node.json().contains("nearest_mm");
  if (has_nearest) keys.push_back("nearest_mm");
  const bool has_added = node.json().is_object() && node.json().contains("added_s");
  if (has_added) keys.push_back("added_s");
  const bool has_reach = node.json().is_object() && node.json().contains("reach");
  if (has_reach) keys.push_back("reach");
  const bool has_times = node.json().is_object() && node.json().contains("clamp_times_s");
  if (has_times) keys.push_back("clamp_times_s");
  node.expect_keys(keys);
  StripArms arms;
  const JsonNode a = node.field("a"), b = node.field("b"), place = node.field("place");
  arms.a = held_of(a);
  arms.b = held_of(b);
  const JsonNode margin = node.field("joint_margin_rad"), wrist = node.field("wrist_rad");
  arms.joint_margin_rad = nearest_of(margin, true);
  arms.wrist_rad = nearest_of(wrist, false);
  if (has_reach) {
    const JsonNode reach = node.field("reach");
    arms.reach = nearest_of(reach, false);
  }
  if (has_nearest) {
    const JsonNode nearest = node.field("nearest_mm");
    arms.nearest_mm = nearest_pairs_of(nearest);
  }
  std::vector<const char*> of_place{"raise_mm"};
  const bool moved = place.json().is_object() && place.json().contains("yaw_rad");
  if (moved) of_place.insert(of_place.end(), {"dx_mm", "dy_mm", "yaw_rad"});
  place.expect_keys(of_place);
  arms.raise_mm = place.field("raise_mm").number();
  if (moved) {
    arms.dx_mm = place.field("dx_mm").number();
    arms.dy_mm = place.field("dy_mm").number();
    arms.yaw_rad = place.field("yaw_rad").number();
  }
  if (has_added) {
    const JsonNode added = node.field("added_s");
    added.expect_keys(std::array{"jerk", "joints"});
    arms.jerk_s = added.field("jerk").number(kNotNegative);
    arms.joints_s = added.field("joints").number(kNotNegative);
  }
  if (has_times) arms.clamp_times_s = node.field("clamp_times_s").numbers(2, kTime);
  return arms;
}

ProgramCell cell_of(const JsonNode& node) {
  node.expect_keys(std::array{"name", "sha256", "arms"});
  ProgramCell cell;
  cell.name = node.field("name").text();
  cell.sha256 = arm_sha256(node.field("sha256"));
  const JsonNode arms = node.field("arms");
  (void)arms.items(cell.arms.size(), true);
  for (std::size_t i = 0; i < cell.arms.size(); ++i) cell.arms[i] = program_arm_of(arms.item(i));
  return cell;
}

void expect_joints(const Program& program, const std::string& file_name) {
  for (std::size_t s = 0; s < program.strips.size(); ++s) {
    const Strip& strip = program.strips[s];
    if (strip.arms.has_value() != program.cell.has_value()) {
      fail_joints(
          file_name, s,
          program.cell ? ": \"arms\" is missing, the program has a cell" : ".arms: the program has no cell");
    }
    const ProgramArm *a = nullptr, *b = nullptr;
    if (strip.arms) {
      for (const ProgramArm& arm : program.cell->arms) {
        if (arm.id == strip.arms->a.arm) a = &arm;
        if (arm.id == strip.arms->b.arm) b = &arm;
      }
      if (a == nullptr || b == nullptr || a == b)
        fail_joints(file_name, s, ".arms: are not both arms of the cell");
    }
    if (strip.joints.empty() == program.cell.has_value()) {
      fail_joints(file_name, s,
                  program.cell ? ".poses[0]: \"joints\" is missing, the program has a cell"
                               : ".poses[0].joints: the program has no cell");
    }
    for (std::size_t i = 0; i < strip.poses.size(); ++i) {
      const std::vector<double>* times = strip.arms ? &strip.arms->clamp_times_s : nullptr;
      if (times != nullptr && !times->empty() && !comes_after(*times, i, strip.poses.size()))
        fail_joints(file_name, s, ".arms.clamp_times_s: are not as many as poses, and rising");
      if (strip.joints.empty()) continue;
      expect_within(strip.joints[i].a, *a, file_name, s, i, "a");
      expect_within(strip.joints[i].b, *b, file_name, s, i, "b");
    }
  }
}

}  // namespace hotblade::pipeline
