#include "pipeline/plan/arms/arms.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "gpu/backend/stop.hpp"
#include "pipeline/cell/cell_file.hpp"
#include "pipeline/plan/arms/strip_arms.hpp"
#include "pipeline/plan/arms/strip_clearance.hpp"
#include "pipeline/plan/arms/strip_start.hpp"
#include "pipeline/plan/arms/strip_timing.hpp"
#include "pipeline/plan/motion/round_poses.hpp"
#include "pipeline/program/sha256.hpp"
#include "pipeline/program/strip_jobs.hpp"
#include "pipeline/sayings/saying.hpp"
#include "pipeline/verify/verify.hpp"

namespace hotblade::pipeline {
namespace {

using robot::kDegree_rad;

// Margins below which a program is warned of.
constexpr double kSmallJoint_rad = 10 * kDegree_rad, kSmallWrist_rad = 10 * kDegree_rad;

// Of the description and of every mesh's corners.
std::string files_sha256(const robot::CellArm& arm) {
  std::string bytes = arm.model_text;
  for (const robot::Body& body : arm.model.bodies) {
    for (const robot::Shape& shape : body.shapes) {
      const auto* mesh = std::get_if<robot::Mesh>(&shape.solid);
      if (mesh == nullptr) continue;
      for (const auto& triangle : mesh->triangles) {
        for (const Eigen::Vector3d& corner : triangle) {
          std::array<char, 3 * sizeof(double)> raw;
          std::memcpy(raw.data(), corner.data(), raw.size());
          bytes.append(raw.data(), raw.size());
        }
      }
    }
  }
  return sha256_hex(bytes);
}

ProgramCell cell_data(const robot::Cell& cell) {
  ProgramCell data;
  data.name = cell.name;
  for (std::size_t i = 0; i < data.arms.size(); ++i) {
    const robot::CellArm& from = cell.arms[i];
    ProgramArm& arm = data.arms[i];
    arm.id = from.id;
    arm.model = from.model_file;
    arm.files_sha256 = files_sha256(from);
    arm.base = from.base;
    const Eigen::Isometry3d jaw = robot::jaw_in_flange(from.tool);
    arm.jaw = {jaw.translation(), robot::canonical(Eigen::Quaterniond(jaw.linear()).normalized())};
    for (std::size_t k = 0; k < robot::kJoints; ++k) {
      const robot::Joint& joint = from.model.arm.joints()[k];
      arm.joints[k] = {joint.name,
                       joint.min_rad,
                       joint.max_rad,
                       from.speed_share * joint.speed_rad_s,
                       from.acceleration_rad_s2[k],
                       from.jerk_rad_s3[k]};
    }
  }
  data.sha256 = cell_sha256(cell);
  return data;
}

std::string words(const ArmPlace& place) {
  const bool moved = place.dx_mm != 0 || place.dy_mm != 0, turned = place.yaw_rad != 0;
  const double degrees = place.yaw_rad / kDegree_rad;
  if (moved && turned)
    return say(Saying::kRaisedMovedTurned, {place.raise_mm, place.dx_mm, place.dy_mm, degrees});
  if (moved) return say(Saying::kRaisedMoved, {place.raise_mm, place.dx_mm, place.dy_mm});
  return turned ? say(Saying::kRaisedTurned, {place.raise_mm, degrees})
                : say(Saying::kRaised, {place.raise_mm});
}

ArmPlace place_of(const StripArms& arms) {
  return {arms.raise_mm, false, arms.dx_mm, arms.dy_mm, arms.yaw_rad};
}

// The distance of the strip's clamps outside of the envelope, mm.
double outside(const Strip& strip, const ArmPlace& at, const robot::MotionLimits& limits) {
  double most = 0;
  const Pose place = placed(strip.design_to_cell, at);
  for (const BladePose& pose : strip.poses) {
    for (const PoseRow* clamp : {&pose.a, &pose.b}) {
      const Eigen::Vector3d p = robot::transformed(place, *clamp).p;
      most =
          std::max({most, (p - limits.envelope_max_mm).maxCoeff(), (limits.envelope_min_mm - p).maxCoeff()});
    }
  }
  return most;
}

// What both arms do at one place.
struct Tried {
  ArmPlace place;
  ArmChoice a, b;
  robot::Clearance clearance{};    // where both are held
  std::optional<Refusal> start{};  // where both are clear: what stands in the way of the straight blade
  StripTiming timing{};            // where nothing does
  [[nodiscard]] bool held() const { return a.stage == ArmStage::kServed && b.stage == ArmStage::kServed; }
  [[nodiscard]] bool served() const { return stage() == ArmStage::kServed; }
  [[nodiscard]] ArmStage stage() const {
    if (!held()) return worse().stage;
    if (clearance.worst || start) return ArmStage::kClearance;
    return timing.refusal ? ArmStage::kTooSlow : ArmStage::kServed;
  }
  // Within a stage, the larger the nearer to the next.
  [[nodiscard]] double rank() const {
    if (!held()) return worse().rank;
    if (clearance.worst) return clearance.worst->distance_mm - clearance.worst->clearance_mm;
    if (start) return 0;  // the strip itself is clear
    return timing.refusal ? timing.refusal->value : worse().rank;
  }
  // The arm that stands in the way.
  [[nodiscard]] const ArmChoice& worse() const {
    const bool b_first = b.stage != a.stage ? b.stage < a.stage : b.rank < a.rank;
    return b_first ? b : a;
  }
};

ArmJoints plain(const robot::JointAngles& q) {
  ArmJoints joints;
  std::copy(q.data(), q.data() + q.size(), joints.begin());
  return joints;
}

// The farthest wrist of both arms, as a share of what its arm reaches.
StripArms::Nearest farthest(const robot::Cell& cell, const Tried& tried, const Strip& strip) {
  StripArms::Nearest most{-1, "", 0, 0};
  for (const ArmChoice* choice : {&tried.a, &tried.b}) {
    const robot::Arm& arm = cell.arms[cell.arms[0].id == choice->held.arm ? 0 : 1].model.arm;
    for (std::size_t k = 0; k < choice->joints.size(); ++k) {
      const robot::Reach reach = robot::reach(arm, robot::forward(arm, choice->joints[k]));
      const double share = reach.from_axis_2_mm / reach.most_mm;
      if (share > most.value) most = {share, choice->held.arm, 0, strip.poses[k].t};
    }
  }
  return most;
}

void take(const Tried& tried, const robot::Cell& cell, Strip& strip) {
  strip.design_to_cell = placed(strip.design_to_cell, tried.place);
  StripArms arms;
  arms.a = tried.a.held;
  arms.b = tried.b.held;
  arms.raise_mm = tried.place.raise_mm;
  arms.dx_mm = tried.place.dx_mm;
  arms.dy_mm = tried.place.dy_mm;
  arms.yaw_rad = tried.place.yaw_rad;
  // A program that was made before it said when clamps alone would be there keeps the times of its arms.
  arms.joints_s = tried.timing.slower.joints_s + (strip.arms ? strip.arms->joints_s : 0);
  arms.jerk_s = tried.timing.slower.jerk_s + (strip.arms ? strip.arms->jerk_s : 0);
  std::vector<double> before;
  bool slower = false;
  for (std::size_t i = 0; i < strip.poses.size(); ++i) {
    double& t = strip.poses[i].t;
    before.push_back(t);
    slower = slower || tried.timing.slower.t[i] != t;
    t = tried.timing.slower.t[i];
  }
  if (slower) arms.clamp_times_s = std::move(before);
  for (const robot::PairKind kind : robot::kPairKinds) {
    if (const auto& nearest = tried.clearance.nearest[static_cast<std::size_t>(kind)])
      arms.nearest_mm.push_back({robot::name(kind), nearest->mm, strip.poses[nearest->pose].t});
  }
  const auto nearer = [&](const robot::Least& a, const robot::Least& b, int joint_of_wrist) {
    const bool at_b = b.value < a.value;
    const robot::Least& least = at_b ? b : a;
    const int joint = joint_of_wrist > 0 ? joint_of_wrist : static_cast<int>(least.joint) + 1;
    return StripArms::Nearest{least.value, (at_b ? arms.b : arms.a).arm, joint, strip.poses[least.pose].t};
  };
  arms.joint_margin_rad = nearer(tried.a.margins.joint_rad, tried.b.margins.joint_rad, 0);
  arms.wrist_rad = nearer(tried.a.margins.wrist_rad, tried.b.margins.wrist_rad, 5);
  arms.reach = farthest(cell, tried, strip);
  strip.arms = arms;
  strip.joints.clear();
  for (std::size_t i = 0; i < strip.poses.size(); ++i)
    strip.joints.push_back({plain(tried.a.joints[i]), plain(tried.b.joints[i])});
  round_joints(strip.joints);
}

void warn_of(const Strip& strip, std::vector<std::string>& warnings) {
  const StripArms& arms = *strip.arms;
  const StripArms::Nearest &joint = arms.joint_margin_rad, &wrist = arms.wrist_rad;
  if (joint.value < kSmallJoint_rad) {
    warnings.push_back(
        say(Saying::kJointNearLimit, {strip.id, joint.arm, joint.joint, joint.value / kDegree_rad, joint.t}));
  }
  if (wrist.value < kSmallWrist_rad) {
    warnings.push_back(
        say(Saying::kWristNearStraight, {strip.id, wrist.arm, wrist.value / kDegree_rad, wrist.t}));
  }
}

// What would help, with its place for what stands in the way.
Saying help_of(robot::PairKind kind) {
  switch (kind) {
    case robot::PairKind::kToolBlock:
    case robot::PairKind::kLinkBlock:
      return Saying::kOtherJawOrPlace;
    case robot::PairKind::kPlinth:
      return Saying::kRaiseOrSmallerPlinth;
    case robot::PairKind::kTable:
    case robot::PairKind::kBladeTable:
      return Saying::kRaise;
    case robot::PairKind::kBladeObstacle:
    case robot::PairKind::kBlockObstacle:
      return Saying::kOtherPlaces;
    case robot::PairKind::kArms:
      return Saying::kOtherJawOrBases;
    default:
      return Saying::kOtherJawOrPlaces;
  }
}

Refusal unclear(const Strip& strip, const Tried& tried) {
  const robot::Contact& contact = *tried.clearance.worst;
  const BladePose& at = strip.poses[contact.pose];
  Refusal refusal{strip.id,
                  "",
                  Limit::kArmClearance,
                  contact.distance_mm,
                  contact.clearance_mm,
                  say(help_of(contact.kind), {describe(contact, strip)})};
  refusal.when = when(contact, strip);
  refusal.at = middle_of(at);
  return refusal;
}

Refusal refusal_at(const Strip& strip, const Tried& tried) {
  if (!tried.held()) return tried.worse().refusal;
  if (tried.clearance.worst) return unclear(strip, tried);
  return tried.start ? *tried.start : *tried.timing.refusal;
}

// The refusal of the place that came furthest, and what stopped the others.
Refusal refusal_of(const Strip& strip, const std::vector<Tried>& tried, const robot::Cell& cell) {
  const auto further = [](const Tried& x, const Tried& y) {
    return x.stage() != y.stage() ? x.stage() < y.stage() : x.rank() < y.rank();
  };
  const Tried& furthest = *std::max_element(tried.begin(), tried.end(), further);
  Refusal refusal = refusal_at(strip, furthest);
  std::array<int, 5> counts{};
  for (const Tried& t : tried) ++counts[static_cast<std::size_t>(t.stage())];
  refusal.note = say(Saying::kOfChoices, {refusal.note, words(furthest.place), tried.size(), counts[0],
                                          counts[1], counts[2], counts[3], counts[4], cell.name});
  return refusal;
}

// Proves both arms clear where they are held, on the way from the straight blade too, and gives them their
// times where they are.
void prove(const Strip& strip, const robot::BladeSection& blade, const MotionSettings& motion,
           const robot::Cell& cell, Tried& tried) {
  if (!tried.held()) return;
  Strip there = strip;
  there.design_to_cell = placed(strip.design_to_cell, tried.place);
  HeldJoints held;
  held.arm = tried.place.swapped ? std::array<std::size_t, 2>{1, 0} : std::array<std::size_t, 2>{0, 1};
  held.joints = {tried.a.joints, tried.b.joints};
  tried.clearance = prove_clear(there, blade, cell, held);
  if (tried.clearance.worst) return;
  tried.start = start_refusal(there, blade, cell, held, {tried.a.held, tried.b.held});
  if (!tried.start) tried.timing = time_for_arms(there, motion, cell, held);
}

// Places with what they promise, the best first.
struct ScoredPlace {
  ArmPlace place;
  double score = 0;
};

// One strip's way to its place: heights first, the lowest good one, then by score; then, where the cell says
// so, the grid: good ones by how little they move the block, then by score, as many as are worth a try.
class Placement {
 public:
  Placement(const Strip& strip, const Program& program, const robot::Cell& cell)
      : strip_(strip), program_(program), cell_(cell), limits_(planned_limits(program)), free_(cell) {}

  std::optional<Tried> choose() {
    std::vector<ScoredPlace> order = scored(heights(cell_.place), -1);
    std::stable_sort(order.begin(), order.end(), [](const ScoredPlace& a, const ScoredPlace& b) {
      return std::min(a.score, 1.0) > std::min(b.score, 1.0);
    });
    if (auto found = first_served(order)) return found;
    if (cell_.place.how != robot::Placing::kSearch) return std::nullopt;
    order = scored(grid(cell_.place), 0);
    std::stable_sort(order.begin(), order.end(), [](const ScoredPlace& a, const ScoredPlace& b) {
      const bool good = a.score >= 1;
      if (good != (b.score >= 1)) return good;
      return good ? moved_mm(a.place) < moved_mm(b.place) : a.score > b.score;
    });
    constexpr std::size_t kMostTried = 40;
    if (order.size() > kMostTried) order.resize(kMostTried);
    return first_served(order);
  }

  [[nodiscard]] const std::vector<Tried>& failed() const { return failed_; }
  [[nodiscard]] double least_outside_mm() const { return least_outside_mm_; }

 private:
  // Those within the envelope whose score is above `least`; the place as planned is tried wherever it lies.
  std::vector<ScoredPlace> scored(const std::vector<ArmPlace>& all, double least) {
    std::vector<ScoredPlace> list;
    const PlaceScorer score(strip_, cell_);
    for (const ArmPlace& place : all) {
      gpu::stop_point();
      const double off = outside(strip_, place, limits_);
      least_outside_mm_ = std::min(least_outside_mm_, off);
      if (off > 0 && moved_mm(place) > 0) continue;
      // Heights are tried all the same, so that a refusal names what stands in the way.
      if (least >= 0 && !free_(strip_.block, placed(strip_.design_to_cell, place))) continue;
      const double value = score(place);
      if (value > least || least < 0) list.push_back({place, value});
    }
    return list;
  }

  std::optional<Tried> first_served(const std::vector<ScoredPlace>& order) {
    for (const ScoredPlace& one : order) {
      gpu::stop_point();
      Tried tried{one.place, choose_branch(strip_, cell_, one.place, false),
                  choose_branch(strip_, cell_, one.place, true)};
      prove(strip_, program_.blade, program_.settings.motion, cell_, tried);
      if (tried.served()) return tried;
      failed_.push_back(std::move(tried));
    }
    return std::nullopt;
  }

  const Strip& strip_;
  const Program& program_;
  const robot::Cell& cell_;
  robot::MotionLimits limits_;
  FreePlaces free_;
  std::vector<Tried> failed_;
  double least_outside_mm_ = 1e9;
};

// Puts the strip's block back where it stood before its arms, and its clamps back to when they were there.
void forget_arms(Strip& strip) {
  StripArms& arms = *strip.arms;
  strip.design_to_cell = unplaced(strip.design_to_cell, place_of(arms));
  if (arms.clamp_times_s.empty()) return;
  for (std::size_t i = 0; i < strip.poses.size(); ++i) strip.poses[i].t = arms.clamp_times_s[i];
  arms.clamp_times_s.clear();
  arms.joints_s = arms.jerk_s = 0;
}

bool begins_like(const std::string& item, Saying saying) {
  const std::string_view english = sayings()[static_cast<std::size_t>(saying)].english;
  return item.starts_with(english.substr(0, english.find('{')));
}

}  // namespace

std::vector<std::string> not_looked_at(const robot::Cell& cell) {
  std::vector<std::string> lines;
  for (const robot::CellArm& arm : cell.arms) {
    if (!arm.model.shapeless.empty())
      lines.push_back(
          say(Saying::kShapelessLinks, {arm.id, fmt::format("{}", fmt::join(arm.model.shapeless, ", "))}));
    if (arm.tool.shapes.empty()) lines.push_back(say(Saying::kShapelessTool, {arm.id}));
  }
  return lines;
}

void tell_not_looked_at(Program& program, const robot::Cell& cell) {
  std::vector<std::string>& items = program.verification.not_checked;
  std::erase_if(items, [](const std::string& item) {
    return begins_like(item, Saying::kShapelessLinks) || begins_like(item, Saying::kShapelessTool);
  });
  for (std::string& line : not_looked_at(cell)) items.push_back(std::move(line));
}

std::string cell_sha256(const robot::Cell& cell) {
  robot::Cell placed_anyhow = cell;
  placed_anyhow.place = {};
  std::string all = to_toml(placed_anyhow);
  for (const robot::CellArm& arm : cell.arms) all += files_sha256(arm);
  return sha256_hex(all);
}

ArmedProgram with_arms(const Program& program, const robot::Cell& cell) {
  ArmedProgram armed{program, {}};
  armed.report.warnings = warnings(cell);
  for (Strip& strip : armed.program.strips) {
    if (strip.arms) forget_arms(strip);
    Placement placement(strip, program, cell);
    if (const auto tried = placement.choose()) {
      take(*tried, cell, strip);
      warn_of(strip, armed.report.warnings);
    } else if (placement.failed().empty()) {
      armed.report.refusals.push_back(
          {strip.id, "", Limit::kEnvelope, placement.least_outside_mm(), 0, say(Saying::kAnyHeight)});
    } else {
      armed.report.refusals.push_back(refusal_of(strip, placement.failed(), cell));
    }
  }
  if (armed.report.refusals.empty()) {
    armed.program.cell = cell_data(cell);
    // What was looked at here is not among it.
    for (std::string& item : armed.program.verification.not_checked) {
      if (item == say(Saying::kArmsNotLookedAt)) item = say(Saying::kArmsBeyond);
    }
    tell_not_looked_at(armed.program, cell);
    return armed;
  }
  armed.program = program;
  return armed;
}

std::string describe_arms(const Program& program) {
  if (!program.cell) return "";
  std::string text = fmt::format("cell {}\n{:<6}{:>6}{:>6}{:>9}{:>20}{:>20}\n", program.cell->name, "strip",
                                 "a", "b", "raised", "joint margin", "wrist");
  for (const Strip& strip : program.strips) {
    const StripArms& arms = *strip.arms;
    const double degrees = 1 / robot::kDegree_rad;
    text += fmt::format("{:<6}{:>6}{:>6}{:>6.0f} mm{:>20}{:>20}\n", strip.id, arms.a.arm, arms.b.arm,
                        arms.raise_mm,
                        fmt::format("{:.1f} deg {} J{}", arms.joint_margin_rad.value * degrees,
                                    arms.joint_margin_rad.arm, arms.joint_margin_rad.joint),
                        fmt::format("{:.1f} deg {}", arms.wrist_rad.value * degrees, arms.wrist_rad.arm));
    if (arms.dx_mm != 0 || arms.dy_mm != 0 || arms.yaw_rad != 0)
      text += fmt::format("{:<6}{}\n", "", words(place_of(arms)));
    std::string nearest;
    for (const StripArms::NearestPair& pair : arms.nearest_mm)
      nearest += fmt::format("{}{} {:.0f} mm at {:.1f} s", nearest.empty() ? "" : ", ",
                             robot::pair_words(pair.kind), pair.mm, pair.t);
    if (!nearest.empty()) text += fmt::format("{:<6}nearest: {}\n", "", nearest);
  }
  return text;
}

}  // namespace hotblade::pipeline
