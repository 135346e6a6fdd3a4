#include "robot/controller/arm_scene.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace hotblade::robot {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using protocol::ArmsOther;

constexpr std::uint8_t kToolLink = 7;
// What a jaw holds of the blade belongs to it.
constexpr double kHeldBlade_mm = 60;
// Chords of the blade: a blade of 800 mm at its least radius leaves one of 17 mm by less than 1 mm, which is
// allowed for.
constexpr std::size_t kChords = 48;
// Farther is of no interest until bodies have moved.
constexpr double kFarthest_mm = 400;
// Registers round clamps by less than a micrometre and declared joints by half a microradian.
constexpr double kRegisters_mm = 0.02;

Isometry3d placed(const ArmCell::Body& body, const ArmPosture& posture) {
  Isometry3d at = posture.links[body.moved_by];
  for (const MimicJoint& m : body.mimics)
    at = at * turn_about(m.axis, m.point_mm, m.factor * posture.q[static_cast<int>(m.joint)] + m.offset_rad);
  return at;
}

// The farthest that any point of a body got from where it was: its sphere's middle and its turn.
double way_of(const Solid& solid, const Isometry3d& from, const Isometry3d& to) {
  const double turn = (to.linear() - from.linear()).norm() / std::sqrt(2.0);
  return (to * solid.centre() - from * solid.centre()).norm() + turn * solid.radius_mm();
}

ArmsOther other_of(Standing::What what) {
  switch (what) {
    case Standing::What::kBlock:
      return ArmsOther::kBlock;
    case Standing::What::kPlinth:
      return ArmsOther::kPlinth;
    case Standing::What::kTable:
      return ArmsOther::kTable;
    case Standing::What::kObstacle:
      return ArmsOther::kObstacle;
  }
  return ArmsOther::kNothing;
}

bool between_arms(const ArmCell::Pair& pair) {
  return pair.other == ArmsOther::kOtherArm || pair.other == ArmsOther::kItself;
}

protocol::ArmsDetail detail_of(const ArmCell& cell, const ArmCell::Pair& pair, double too_near_mm) {
  const auto um = static_cast<std::int32_t>(std::lround(too_near_mm * 1000));
  if (pair.of != ArmsOther::kNothing) return {0, static_cast<std::uint8_t>(pair.of), pair.other, 0, um};
  const ArmCell::Body& body = cell.bodies()[pair.body];
  return {static_cast<std::uint8_t>(body.arm + 1), body.link, pair.other,
          between_arms(pair) ? cell.bodies()[pair.with].link : std::uint8_t{0}, um};
}

}  // namespace

ArmCell::ArmCell(Cell cell, std::uint64_t id, const Limits& limits,
                 const std::map<std::uint64_t, std::vector<Standing>>& blocks)
    : cell_(std::move(cell)), id_(id), limits_(limits) {
  for (std::size_t arm = 0; arm < cell_.arms.size(); ++arm) add_arm(arm);
  add_pairs_of_arms();
  if (cell_.table_mm) {
    Shape table{Isometry3d::Identity(), Box{*cell_.table_mm}};
    table.place.translation().z() = -cell_.table_mm->z() / 2;
    add_standing({Standing::What::kTable, "", {table}}, pairs_);
  }
  for (const Obstacle& obstacle : cell_.obstacles) {
    Shape shape = obstacle.shape;
    shape.place = isometry(obstacle.at) * shape.place;
    add_standing({Standing::What::kObstacle, "", {shape}}, pairs_);
  }
  for (const auto& [job, around] : blocks) {
    for (const Standing& standing : around) {
      const bool of_the_job =
          standing.what == Standing::What::kBlock || standing.what == Standing::What::kPlinth;
      if (of_the_job) add_standing(standing, block_pairs_[job]);
    }
  }
}

void ArmCell::add_arm(std::size_t arm) {
  const CellArm& from = cell_.arms[arm];
  const auto number = static_cast<std::uint8_t>(arm);
  for (const robot::Body& body : from.model.bodies) {
    if (!body.shapes.empty())
      bodies_.push_back(
          {number, static_cast<std::uint8_t>(body.moved_by), body.moved_by, body.mimics, Solid(body.shapes)});
  }
  std::vector<Shape> tool = from.tool.shapes;
  if (tool.empty()) return;
  for (Shape& shape : tool) shape.place = from.model.arm.flange_at_zero() * shape.place;
  bodies_.push_back({number, kToolLink, kJoints, {}, Solid(tool)});
}

// Springs stand on what they are built against, wrists on each other.
bool ArmCell::built_to_touch(const Body& a, const Body& b) const {
  const bool wrist = std::min(a.moved_by, b.moved_by) >= 4;
  if (!wrist && a.mimics.empty() && b.mimics.empty()) return false;
  const ArmPosture posture = posture_of(cell_.arms[a.arm], JointAngles::Zero());
  const Isometry3d at_a = placed(a, posture), at_b = placed(b, posture);
  return distance_mm(a.solid, at_a, b.solid, at_b, kFarthest_mm) < cell_.clearances.self_mm ||
         one_inside_other(a.solid, at_a, b.solid, at_b);
}

void ArmCell::add_pairs_of_arms() {
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const Body& a = bodies_[i];
    pairs_.push_back({ArmsOther::kBlade, i, 0, cell_.clearances.others_mm});
    for (std::size_t j = i + 1; j < bodies_.size(); ++j) {
      const Body& b = bodies_[j];
      if (a.arm != b.arm) {
        pairs_.push_back({ArmsOther::kOtherArm, i, j, cell_.clearances.arms_mm});
        continue;
      }
      const std::size_t low = std::min(a.moved_by, b.moved_by), high = std::max(a.moved_by, b.moved_by);
      const bool tool = a.link == kToolLink || b.link == kToolLink;
      if (high - low < 2 || (tool && low == 4) || built_to_touch(a, b)) continue;
      pairs_.push_back({ArmsOther::kItself, i, j, cell_.clearances.self_mm});
    }
  }
}

void ArmCell::add_standing(const Standing& standing, std::vector<Pair>& pairs) {
  const ArmsOther other = other_of(standing.what);
  const bool tools_nearer = other == ArmsOther::kBlock || other == ArmsOther::kPlinth;
  const std::size_t least_joints = tools_nearer ? 0 : other == ArmsOther::kTable ? 2 : 1;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (bodies_[i].moved_by < least_joints) continue;
    const bool tool = bodies_[i].link == kToolLink;
    pairs.push_back({other, i, standing_.size(),
                     tool && tools_nearer ? cell_.clearances.tool_mm : cell_.clearances.others_mm});
  }
  // The blade cuts the block and leaves it below, where the plinth has to end beside the cut.
  if (!tools_nearer)
    pairs.push_back({other, 0, standing_.size(), cell_.clearances.others_mm, ArmsOther::kBlade});
  if (other == ArmsOther::kObstacle) obstacles_.push_back(standing_.size());
  for (const std::size_t obstacle : tools_nearer ? obstacles_ : std::vector<std::size_t>{})
    pairs.push_back({ArmsOther::kObstacle, standing_.size(), obstacle, cell_.clearances.others_mm, other});
  standing_.emplace_back(standing.shapes);
}

std::vector<ArmCell::Pair> ArmCell::pairs_of(std::uint64_t job) const {
  std::vector<Pair> all = pairs_;
  if (const auto block = block_pairs_.find(job); block != block_pairs_.end())
    all.insert(all.end(), block->second.begin(), block->second.end());
  return all;
}

ArmWatch::ArmWatch(const ArmCell& cell, std::uint64_t job, double blade_width_mm)
    : pairs_(cell.pairs_of(job)),
      at_(cell.bodies().size(), Isometry3d::Identity()),
      moved_mm_(cell.bodies().size(), 0),
      clear_until_mm_(pairs_.size(), -1),
      blade_width_mm_(blade_width_mm) {}

void ArmWatch::move_bodies(const ArmCell& cell, const std::array<ArmPosture, 2>& arms) {
  for (std::size_t i = 0; i < at_.size(); ++i) {
    const ArmCell::Body& body = cell.bodies()[i];
    const ArmPosture& posture = arms[body.arm];
    const Isometry3d to = placed(body, posture);
    if (begun_) moved_mm_[i] += way_of(body.solid, at_[i], to);
    at_[i] = to;
  }
}

void ArmWatch::move_blade(const BladeNow& blade) {
  const elastica::ElasticaCurve curve(blade.shape);
  const Vector3d edge = blade.clamp_a.q * Vector3d(0, 0, blade_width_mm_ / 2);
  const bool first = corners_.empty();
  corners_.resize(2 * (kChords + 1));
  arm_at_a_ = blade.arm_at_a;
  blade_length_mm_ = blade.shape.length;
  const double chord = blade_length_mm_ / kChords;
  double farthest = 0, turn = 0, before = blade.shape.theta;
  for (std::size_t i = 0; i <= kChords; ++i) {
    const elastica::CurvePoint at = curve.at(chord * static_cast<double>(i));
    const Vector3d middle = blade.clamp_a.p + blade.clamp_a.q * Vector3d(at.x, at.y, 0);
    turn = std::max(turn, std::abs(at.theta - before));
    before = at.theta;
    for (const std::size_t side : {0, 1}) {
      const Vector3d corner = side == 0 ? Vector3d(middle - edge) : Vector3d(middle + edge);
      Vector3d& was = corners_[2 * i + side];
      if (!first) farthest = std::max(farthest, (corner - was).norm());
      was = corner;
    }
  }
  blade_moved_mm_ += farthest;
  blade_sag_mm_ = turn * chord / 8;
}

double ArmWatch::moved(const ArmCell::Pair& pair) const {
  const double first = pair.of == ArmsOther::kNothing ? moved_mm_[pair.body]
                       : pair.of == ArmsOther::kBlade ? blade_moved_mm_
                                                      : 0;
  if (between_arms(pair)) return first + moved_mm_[pair.with];
  return pair.other == ArmsOther::kBlade ? first + blade_moved_mm_ : first;
}

// The blade, without what a jaw that it is asked for holds; none: that holds all of it.
std::optional<Solid> ArmWatch::blade_beside(const ArmCell::Body* holder) const {
  std::size_t from = 0, to = kChords;
  if (holder != nullptr && holder->link == kToolLink) {
    const auto held =
        static_cast<std::size_t>(std::ceil(kHeldBlade_mm / blade_length_mm_ * static_cast<double>(kChords)));
    if (2 * held >= kChords) return std::nullopt;
    (holder->arm == arm_at_a_ ? from : to) = holder->arm == arm_at_a_ ? held : kChords - held;
  }
  std::vector<Triangle> sheet;
  for (std::size_t i = 2 * from; i < 2 * to; i += 2) {
    sheet.push_back({corners_[i], corners_[i + 1], corners_[i + 2]});
    sheet.push_back({corners_[i + 1], corners_[i + 3], corners_[i + 2]});
  }
  return Solid(std::move(sheet));
}

double ArmWatch::distance(const ArmCell& cell, const ArmCell::Pair& pair, bool first_look) const {
  const ArmCell::Body* body = pair.of == ArmsOther::kNothing ? &cell.bodies()[pair.body] : nullptr;
  std::optional<Solid> blade;
  if (pair.has_blade()) {
    blade = blade_beside(body);
    if (!blade) return kFarthest_mm;
  }
  const Isometry3d standing = Isometry3d::Identity();
  const Solid& a = body != nullptr                ? body->solid
                   : pair.of == ArmsOther::kBlade ? *blade
                                                  : cell.standing()[pair.body];
  const Isometry3d& at_a = body != nullptr ? at_[pair.body] : standing;
  const Solid& b = between_arms(pair)                ? cell.bodies()[pair.with].solid
                   : pair.other == ArmsOther::kBlade ? *blade
                                                     : cell.standing()[pair.with];
  const Isometry3d& at_b = between_arms(pair) ? at_[pair.with] : standing;
  // Surfaces of a body within another are apart.
  if (first_look && one_inside_other(a, at_a, b, at_b)) return 0;
  return distance_mm(a, at_a, b, at_b, kFarthest_mm);
}

std::optional<ArmWatch::TooNear> ArmWatch::look(const ArmCell& cell, const std::array<ArmPosture, 2>& arms,
                                                const std::optional<BladeNow>& blade) {
  move_bodies(cell, arms);
  if (blade) move_blade(*blade);
  std::optional<TooNear> found;
  for (std::size_t i = 0; i < pairs_.size() && !found; ++i) {
    const ArmCell::Pair& pair = pairs_[i];
    if (pair.has_blade() && !blade) continue;
    if (moved(pair) <= clear_until_mm_[i]) continue;
    ++asked_;
    const double mm = distance(cell, pair, clear_until_mm_[i] < 0);
    const double least = pair.clearance_mm - kRegisters_mm - (pair.has_blade() ? blade_sag_mm_ : 0);
    clear_until_mm_[i] = moved(pair) + mm - least;
    if (mm >= least) continue;
    found = TooNear{detail_of(cell, pair, pair.clearance_mm - mm), mm};
  }
  begun_ = true;
  return found;
}

}  // namespace hotblade::robot
