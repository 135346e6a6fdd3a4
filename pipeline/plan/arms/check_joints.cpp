#include "pipeline/plan/arms/check_joints.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "pipeline/plan/arms/arms.hpp"
#include "pipeline/plan/arms/strip_clearance.hpp"
#include "pipeline/plan/arms/strip_start.hpp"
#include "pipeline/settings/error.hpp"
#include "robot/pose/motion.hpp"

namespace hotblade::pipeline {
namespace {

using Eigen::Vector3d;

// Where the jaw of an arm is in the cell: its points carried back from the last axis to the first, one turn
// at a time.
struct Jaw {
  Vector3d p, x, z;
};

Jaw jaw_of(const robot::CellArm& arm, const ArmJoints& q) {
  const Eigen::Isometry3d flange = arm.model.arm.flange_at_zero();
  const robot::ArmTool& tool = arm.tool;
  Jaw jaw{flange * tool.jaw_p_mm, flange.linear() * tool.jaw_x,
          flange.linear() * tool.jaw_x.cross(tool.jaw_y)};
  for (std::size_t i = robot::kJoints; i-- > 0;) {
    const robot::Joint& joint = arm.model.arm.joints()[i];
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(q[i], joint.axis));
    jaw.p = joint.point_mm + turn * (jaw.p - joint.point_mm);
    jaw.x = turn * jaw.x;
    jaw.z = turn * jaw.z;
  }
  return {arm.base.q * jaw.p + arm.base.p, arm.base.q * jaw.x, arm.base.q * jaw.z};
}

// Between directions; small angles keep their digits.
double angle_between(const Vector3d& a, const Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

double wrist_angle(const robot::Arm& arm, const ArmJoints& q) {
  const Vector3d axis_6 =
      Eigen::Quaterniond(Eigen::AngleAxisd(q[4], arm.joints()[4].axis)) * arm.joints()[5].axis;
  const double angle = angle_between(arm.joints()[3].axis, axis_6);
  return std::min(angle, M_PI - angle);
}

// The worst share of a limit, and where.
struct Worst {
  double share = 1;
  std::string what;
  void offer(double amount, const auto& say) {
    if (!(amount > share)) return;
    share = amount;
    what = say();
  }
};

class StripCheck {
 public:
  StripCheck(const Strip& strip, const robot::Cell& cell, JointCheck& check)
      : strip_(strip), cell_(cell), check_(check) {}

  void run() {
    for (const bool b : {false, true}) {
      const HeldClamp& held = b ? strip_.arms->b : strip_.arms->a;
      const robot::CellArm& arm = cell_.arms[cell_.arms[0].id == held.arm ? 0 : 1];
      Worst off, limit, wrist, rate, change, jerk;
      for (std::size_t k = 0; k < strip_.poses.size(); ++k) {
        place(k, b, held, arm, off);
        limits(k, b, arm, limit, wrist);
        rates(k, b, arm, rate, change);
      }
      jerks(b, arm, jerk);
      for (const Worst* worst : {&off, &limit, &wrist, &rate, &change, &jerk}) {
        if (!worst->what.empty()) check_.breaches.push_back(worst->what);
      }
    }
  }

 private:
  [[nodiscard]] const ArmJoints& joints(std::size_t pose, bool b) const {
    const ClampJoints& both = strip_.joints[pose];
    return b ? both.b : both.a;
  }
  [[nodiscard]] std::string at(std::size_t pose, const robot::CellArm& arm) const {
    return fmt::format("{} at {:.2f} s: arm {}", strip_.id, strip_.poses[pose].t, arm.id);
  }

  void place(std::size_t k, bool b, const HeldClamp& held, const robot::CellArm& arm, Worst& worst) {
    const Pose clamp = robot::transformed(strip_.design_to_cell, b ? strip_.poses[k].b : strip_.poses[k].a);
    const Jaw jaw = jaw_of(arm, joints(k, b));
    const Vector3d x = (b ? -1 : 1) * (clamp.q * Vector3d::UnitX()),
                   z = (held.flip ? -1 : 1) * (clamp.q * Vector3d::UnitZ());
    const double mm = (jaw.p - clamp.p).norm(),
                 rad = std::max(angle_between(jaw.x, x), angle_between(jaw.z, z));
    check_.off_mm = std::max(check_.off_mm, mm);
    check_.off_rad = std::max(check_.off_rad, rad);
    worst.offer(std::max(mm / kJawOff_mm, rad / kJawOff_rad), [&] {
      return fmt::format("{}: jaw {:.3g} mm and {:.3g} rad off clamp {}", at(k, arm), mm, rad, b ? "b" : "a");
    });
  }

  void limits(std::size_t k, bool b, const robot::CellArm& arm, Worst& worst, Worst& worst_wrist) {
    const ArmJoints& q = joints(k, b);
    for (std::size_t i = 0; i < kArmJoints; ++i) {
      const robot::Joint& joint = arm.model.arm.joints()[i];
      const double margin = std::min(q[i] - joint.min_rad, joint.max_rad - q[i]);
      check_.joint_margin_rad = std::min(check_.joint_margin_rad, margin);
      const double left = margin - cell_.margins.joint_deg * robot::kDegree_rad;
      // A rounding more than none left.
      worst.offer(1 - left - 1e-9, [&] {
        return fmt::format("{} {} within {:.3f} degrees of its limit, {} are kept", at(k, arm), joint.name,
                           margin / robot::kDegree_rad, cell_.margins.joint_deg);
      });
    }
    const double wrist = wrist_angle(arm.model.arm, q);
    check_.wrist_rad = std::min(check_.wrist_rad, wrist);
    worst_wrist.offer(1 + cell_.margins.wrist_deg * robot::kDegree_rad - wrist - 1e-9, [&] {
      return fmt::format("{} wrist {:.3f} degrees from straight, {} at least", at(k, arm),
                         wrist / robot::kDegree_rad, cell_.margins.wrist_deg);
    });
  }

  // Rates of the steps before and after a pose; at rest before the first and after the last.
  void rates(std::size_t k, bool b, const robot::CellArm& arm, Worst& worst, Worst& worst_change) {
    const std::size_t last = strip_.poses.size() - 1;
    const auto step_s = [&](std::size_t to) { return strip_.poses[to].t - strip_.poses[to - 1].t; };
    const double before_s = step_s(std::max<std::size_t>(k, 1)), after_s = step_s(std::min(k + 1, last));
    for (std::size_t i = 0; i < kArmJoints; ++i) {
      const double before = k == 0 ? 0 : (joints(k, b)[i] - joints(k - 1, b)[i]) / before_s;
      const double after = k == last ? 0 : (joints(k + 1, b)[i] - joints(k, b)[i]) / after_s;
      const robot::Joint& joint = arm.model.arm.joints()[i];
      const double share = std::abs(after) / (arm.speed_share * joint.speed_rad_s);
      const double ramp = robot::PathClock::kRampPerS * std::max(std::abs(before), std::abs(after));
      const double change =
          (std::abs(after - before) / ((before_s + after_s) / 2) + ramp) / arm.acceleration_rad_s2[i];
      check_.speed_share = std::max(check_.speed_share, share);
      check_.acceleration_share = std::max(check_.acceleration_share, change);
      worst.offer(share, [&] {
        return fmt::format("{} {} {:.0f} % of its speed", at(k, arm), joint.name, 100 * share);
      });
      worst_change.offer(change, [&] {
        return fmt::format("{} {} {:.0f} % of its acceleration", at(k, arm), joint.name, 100 * change);
      });
    }
  }

  // By divided differences of four poses; a pose as long outside as the nearest step stands for rest.
  void jerks(bool b, const robot::CellArm& arm, Worst& worst) {
    std::vector<double> t;
    std::vector<std::size_t> pose;
    const std::size_t last = strip_.poses.size() - 1;
    const double first_s = strip_.poses[1].t - strip_.poses[0].t,
                 last_s = strip_.poses[last].t - strip_.poses[last - 1].t;
    for (const double out : {2.0, 1.0}) {
      t.push_back(strip_.poses[0].t - out * first_s);
      pose.push_back(0);
    }
    for (std::size_t k = 0; k <= last; ++k) {
      t.push_back(strip_.poses[k].t);
      pose.push_back(k);
    }
    for (const double out : {1.0, 2.0}) {
      t.push_back(strip_.poses[last].t + out * last_s);
      pose.push_back(last);
    }
    for (std::size_t i = 0; i < kArmJoints; ++i) {
      for (std::size_t k = 3; k < t.size(); ++k) {
        std::array<double, 4> d{};
        for (std::size_t m = 0; m < d.size(); ++m) d[m] = joints(pose[k - 3 + m], b)[i];
        for (std::size_t order = 1; order < d.size(); ++order) {
          for (std::size_t m = 0; m + order < d.size(); ++m)
            d[m] = (d[m + 1] - d[m]) / (t[k - 3 + m + order] - t[k - 3 + m]);
        }
        const double share = 6 * std::abs(d[0]) / arm.jerk_rad_s3[i];
        check_.jerk_share = std::max(check_.jerk_share, share);
        worst.offer(share, [&] {
          return fmt::format("{} {} {:.0f} % of its jerk", at(pose[k - 1], arm),
                             arm.model.arm.joints()[i].name, 100 * share);
        });
      }
    }
  }

  const Strip& strip_;
  const robot::Cell& cell_;
  JointCheck& check_;
};

// Poses between those that are sampled besides the proof.
constexpr std::size_t kSampleStep = 5;

std::vector<robot::JointAngles> angles_of(const Strip& strip, bool b) {
  std::vector<robot::JointAngles> all;
  for (const ClampJoints& joints : strip.joints)
    all.emplace_back(Eigen::Map<const robot::JointAngles>((b ? joints.b : joints.a).data()));
  return all;
}

// The proof again, from the program's joints, and every fifth pose sampled: what the program says of its
// distances has to be no more than what is measured.
void check_clear(const Strip& strip, const robot::BladeSection& blade, const robot::Cell& cell,
                 JointCheck& check) {
  HeldJoints held;
  const std::size_t a = cell.arms[0].id == strip.arms->a.arm ? 0 : 1;
  held.arm = {a, 1 - a};
  held.joints = {angles_of(strip, false), angles_of(strip, true)};
  if (const auto refused = start_refusal(strip, blade, cell, held, {strip.arms->a, strip.arms->b}))
    check.breaches.push_back(describe(*refused));
  const robot::CellPath path = cell_path(strip, blade, held);
  const std::vector<robot::Standing> standing = surroundings(strip, cell);
  const robot::Clearance proved = robot::prove_clear(cell, standing, path);
  const robot::Clearance sampled = robot::sampled_clearance(cell, standing, path, kSampleStep);
  for (const auto& worst : {proved.worst, sampled.worst}) {
    if (!worst) continue;
    check.breaches.push_back(
        fmt::format("{} at {:.2f} s: {}", strip.id, strip.poses[worst->pose].t, describe(*worst, strip)));
    break;
  }
  for (const robot::PairKind kind : robot::kPairKinds) {
    const auto i = static_cast<std::size_t>(kind);
    const std::string key = robot::name(kind);
    const auto said = std::find_if(strip.arms->nearest_mm.begin(), strip.arms->nearest_mm.end(),
                                   [&](const StripArms::NearestPair& pair) { return pair.kind == key; });
    double measured = robot::kWidest_mm;
    for (const auto& nearest : {proved.nearest[i], sampled.nearest[i]}) {
      if (nearest) measured = std::min(measured, nearest->mm);
    }
    const bool silent = said == strip.arms->nearest_mm.end();
    const double claimed = silent ? robot::kWidest_mm : said->mm;
    if (claimed > measured + robot::kNearestWithin_mm) {
      const std::string says =
          silent ? fmt::format("has none within {:.0f}: an older version may have placed it, place it again",
                               claimed)
                 : fmt::format("says {:.1f}", claimed);
      check.breaches.push_back(fmt::format("{}: {} comes within {:.1f} mm, the program {}", strip.id,
                                           robot::pair_words(key), measured, says));
    }
    if (measured < robot::kWidest_mm)
      check.nearest.push_back(fmt::format("{} {} {:.1f} mm", strip.id, robot::pair_words(key), measured));
  }
}

}  // namespace

JointCheck check_joints(const Program& program, const robot::Cell& cell) {
  if (!program.cell) throw Error(ErrorKind::kBadInput, "the program has no joints: plan it with --cell");
  if (program.cell->sha256 != cell_sha256(cell)) {
    throw Error(ErrorKind::kBadInput, "the program's joints are those of another cell (" +
                                          program.cell->name + ", sha256 " + program.cell->sha256 +
                                          "), not of " + cell.name);
  }
  JointCheck check;
  check.joint_margin_rad = check.wrist_rad = std::numeric_limits<double>::infinity();
  for (const Strip& strip : program.strips) {
    StripCheck(strip, cell, check).run();
    check_clear(strip, program.blade, cell, check);
  }
  return check;
}

nlohmann::ordered_json to_json(const JointCheck& check) {
  return {{"off_mm", check.off_mm},
          {"off_rad", check.off_rad},
          {"joint_margin_rad", check.joint_margin_rad},
          {"wrist_rad", check.wrist_rad},
          {"speed_share", check.speed_share},
          {"acceleration_share", check.acceleration_share},
          {"jerk_share", check.jerk_share},
          {"nearest", check.nearest},
          {"breaches", check.breaches}};
}

}  // namespace hotblade::pipeline
