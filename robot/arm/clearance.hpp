// Whether two arms, what they hold and what stands around them keep apart, at every pose and between poses.
//
// A distance proves more than its own pose: until bodies can have moved by what it is above the clearance,
// they are clear (Schwarzer, Saha, Latombe 2005). How far a body moves at most follows from the turns of its
// joints and its levers about them. mm, rad, s.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "robot/arm/arm.hpp"
#include "robot/arm/cell.hpp"

namespace hotblade::robot {

// Kinds of pairs, as programs name them.
enum class PairKind {
  kArms,
  kToolBlock,
  kLinkBlock,
  kPlinth,
  kTable,
  kBlade,
  kSelf,
  kObstacle,
  kBladeTable,
  kBladeObstacle,
  kBlockObstacle  // its plinth too
};
inline constexpr std::array kPairKinds{
    PairKind::kArms,       PairKind::kToolBlock,     PairKind::kLinkBlock,    PairKind::kPlinth,
    PairKind::kTable,      PairKind::kBlade,         PairKind::kSelf,         PairKind::kObstacle,
    PairKind::kBladeTable, PairKind::kBladeObstacle, PairKind::kBlockObstacle};
// Returns the word that programs have for it: "arm_arm".
[[nodiscard]] const char* name(PairKind kind);
// Returns a pair that a program names so in words, "arm to block" for "link_block"; any other as it is.
[[nodiscard]] std::string pair_words(const std::string& name);

// What does not move, in the cell's frame.
struct Standing {
  enum class What { kBlock, kPlinth, kTable, kObstacle };
  What what = What::kObstacle;
  std::string name;
  std::vector<Shape> shapes;
};

// The blade from clamp A to clamp B as a band of flat pieces, in the cell's frame.
struct BladeBand {
  // By pose: corners at both edges, two a station, the stations at the same arc lengths in every pose.
  std::vector<std::vector<Eigen::Vector3d>> corners;
  // Stations between which the tools may not come: what they hold lies before and after.
  std::size_t free_from = 0, free_to = 0;
  double skin_mm = 0;  // the blade's surface is no farther from the band
};

// A strip as the arms do it.
struct CellPath {
  std::vector<double> t;
  std::array<std::vector<JointAngles>, 2> joints;  // of the cell's arms
  std::size_t arm_at_a = 0;                        // index of the arm that holds clamp A
  BladeBand blade;
};

// A pair that is too near, or not proved clear.
struct Contact {
  PairKind kind = PairKind::kArms;
  std::string first, second;  // "arm R1 link_5", "the plinth"
  double distance_mm = 0;     // not proved: what is left of it at least
  double clearance_mm = 0;
  std::size_t pose = 0;  // it is there, or between this and the next
  double share = 0;      // of the step to the next
  bool proved = true;    // that it is too near
  double bound_mm = 0;   // not proved: how far the bodies may move in the step
};

struct NearestPair {
  double mm = 0;
  std::size_t pose = 0;
};

// Distances are looked at up to this.
inline constexpr double kWidest_mm = 500;
// The least distance of a kind is that of all poses within this.
inline constexpr double kNearestWithin_mm = 1;

struct Clearance {
  // By PairKind; absent: there is no such pair, or none within kWidest_mm.
  std::array<std::optional<NearestPair>, kPairKinds.size()> nearest;
  // The pair that breaks its clearance by most of the first look, or the first that was found behind that.
  // Absent: all are proved clear.
  std::optional<Contact> worst;
  std::size_t asked = 0;  // distances
};

// Returns what is proved, up to the first pair that is not clear. Pairs: all bodies of one arm with all of
// the other; all of them with block and plinth, links 1 to 6 and tool with obstacles and (from link 2 on) the
// table; all of them with the blade, of which a tool's own end is left out; the blade with table and
// obstacles, not with block and plinth, as it cuts the one and leaves it below, where the other has to end
// beside the cut; block and plinth with obstacles, which do not move either; links of an arm that are two
// joints apart or more, but for the tool and link 4, and for links of the wrist that touch at joint angles of
// zero. `between` is called between distances, every few ms: what it throws ends the proof.
[[nodiscard]] Clearance prove_clear(
    const Cell& cell, const std::vector<Standing>& standing, const CellPath& path,
    const std::function<void()>& between = [] {});

// The same distances at every `step`th pose and at the last, all of them asked, nothing proved between.
[[nodiscard]] Clearance sampled_clearance(const Cell& cell, const std::vector<Standing>& standing,
                                          const CellPath& path, std::size_t step);

}  // namespace hotblade::robot
