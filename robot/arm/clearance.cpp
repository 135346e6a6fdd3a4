#include "robot/arm/clearance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <memory>

#include "robot/arm/moving_bodies.hpp"

namespace hotblade::robot {
namespace {

// A step that its ends do not prove is halved this often.
constexpr int kHalvings = 6;
// Poses of the first look, which finds what is far too near before anything is proved.
constexpr std::size_t kFirstLook = 200;

struct Pair {
  PairKind kind = PairKind::kArms;
  const MovingBody* a = nullptr;
  const MovingBody* b = nullptr;
  double clearance_mm = 0;
  Way way{};  // of both bodies together, as one sees the other
  // By pose: how far it is from the first.
  std::vector<double> moved_mm{};
};

// Two bodies of an arm see of each other's ways only what the joints between them do.
void set_way(Pair& pair) {
  const std::size_t from =
      pair.kind == PairKind::kSelf ? std::min(pair.a->joints, pair.b->joints) : std::size_t{0};
  pair.way = pair.a->way(from);
  const Way other = pair.b->way(from);
  pair.moved_mm.assign(1, 0);
  for (std::size_t k = 0; k < other.straight_mm.size(); ++k) {
    pair.way.straight_mm[k] += other.straight_mm[k];
    pair.way.bend_mm[k] += other.bend_mm[k];
    pair.moved_mm.push_back(pair.moved_mm.back() + pair.way.straight_mm[k] + pair.way.bend_mm[k]);
  }
}

// All bodies of a path, and the pairs that have to keep apart.
class Scene {
 public:
  Scene(const Cell& cell, const std::vector<Standing>& standing, const CellPath& path,
        const std::function<void()>& between)
      : cell_(cell), path_(path), between_(between) {
    for (std::size_t arm = 0; arm < arms_.size(); ++arm) arms_[arm] = arm_bodies(cell, arm, path);
    for (const auto& a : arms_[0]) {
      for (const auto& b : arms_[1]) add(PairKind::kArms, *a, *b, cell.clearances.arms_mm);
    }
    for (const Bodies& bodies : arms_) {
      add_self(bodies);
      for (const auto& body : bodies) add_blade(*body);
    }
    for (const Standing& one : standing) {
      standing_.push_back(standing_body(one, path.t.size()));
      for (const Bodies& bodies : arms_) {
        for (const auto& body : bodies) add_standing(one.what, *body, *standing_.back());
      }
      add_blade(one.what, *standing_.back());
    }
    add_blocks(standing);
  }

  [[nodiscard]] const std::vector<Pair>& pairs() const { return pairs_; }

 private:
  void add(PairKind kind, const MovingBody& a, const MovingBody& b, double clearance_mm) {
    between_();
    pairs_.push_back({kind, &a, &b, clearance_mm});
    set_way(pairs_.back());
  }

  void add_standing(Standing::What what, const MovingBody& body, const MovingBody& other) {
    const Clearances& least = cell_.clearances;
    switch (what) {
      case Standing::What::kBlock:
        add(body.tool ? PairKind::kToolBlock : PairKind::kLinkBlock, body, other,
            body.tool ? least.tool_mm : least.others_mm);
        return;
      case Standing::What::kPlinth:
        add(PairKind::kPlinth, body, other, body.tool ? least.tool_mm : least.others_mm);
        return;
      case Standing::What::kTable:
        if (body.joints >= 2) add(PairKind::kTable, body, other, least.others_mm);
        return;
      case Standing::What::kObstacle:
        if (body.joints >= 1) add(PairKind::kObstacle, body, other, least.others_mm);
        return;
    }
  }

  // The blade cuts the block and leaves it below, where the plinth has to end beside the cut.
  void add_blade(Standing::What what, const MovingBody& other) {
    const BladeBand& band = path_.blade;
    const bool table = what == Standing::What::kTable;
    if (band.corners.empty() || (!table && what != Standing::What::kObstacle)) return;
    add(table ? PairKind::kBladeTable : PairKind::kBladeObstacle,
        blade_between(0, band.corners[0].size() / 2 - 1), other, cell_.clearances.others_mm + band.skin_mm);
  }

  // Of what stands, block and plinth alone are put anywhere.
  void add_blocks(const std::vector<Standing>& standing) {
    for (std::size_t i = 0; i < standing.size(); ++i) {
      if (standing[i].what != Standing::What::kBlock && standing[i].what != Standing::What::kPlinth) continue;
      for (std::size_t j = 0; j < standing.size(); ++j) {
        if (standing[j].what == Standing::What::kObstacle)
          add(PairKind::kBlockObstacle, *standing_[i], *standing_[j], cell_.clearances.others_mm);
      }
    }
  }

  void add_blade(const MovingBody& body) {
    const BladeBand& band = path_.blade;
    if (band.corners.empty()) return;
    std::size_t from = 0, to = band.corners[0].size() / 2 - 1;
    if (body.tool)
      (body.arm == path_.arm_at_a ? from : to) = body.arm == path_.arm_at_a ? band.free_from : band.free_to;
    if (from >= to) return;
    add(PairKind::kBlade, body, blade_between(from, to), cell_.clearances.others_mm + band.skin_mm);
  }

  const MovingBody& blade_between(std::size_t from, std::size_t to) {
    const auto [blade, is_new] = blades_.try_emplace({from, to});
    if (is_new) blade->second = blade_body(path_, from, to);
    return *blade->second;
  }

  void add_self(const Bodies& bodies) {
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      for (std::size_t j = i + 1; j < bodies.size(); ++j) {
        const MovingBody &a = *bodies[i], &b = *bodies[j];
        const std::size_t low = std::min(a.joints, b.joints), high = std::max(a.joints, b.joints);
        if (high - low < 2 || ((a.tool || b.tool) && low == 4)) continue;
        // What is built to touch: links of the wrist, and springs with what they stand on.
        if ((low >= 4 || a.follower || b.follower) && touch_at_zero(a, b)) continue;
        add(PairKind::kSelf, a, b, cell_.clearances.self_mm);
      }
    }
  }

  [[nodiscard]] bool touch_at_zero(const MovingBody& a, const MovingBody& b) const {
    CellPath zero;
    zero.t = {0};
    for (auto& joints : zero.joints) joints = {JointAngles::Zero()};
    const Bodies bodies = arm_bodies(cell_, a.arm, zero);
    const auto named = [&](const std::string& name) {
      return (*std::find_if(bodies.begin(), bodies.end(),
                            [&](const auto& body) { return body->name == name; }))
          ->placed(0, 0);
    };
    const PlacedSolid first = named(a.name), second = named(b.name);
    return distance_mm(first.solid, first.at, second.solid, second.at, kWidest_mm) <
               cell_.clearances.self_mm ||
           one_inside_other(first.solid, first.at, second.solid, second.at);
  }

  const Cell& cell_;
  const CellPath& path_;
  const std::function<void()>& between_;
  std::array<Bodies, 2> arms_;
  Bodies standing_;
  std::map<std::array<std::size_t, 2>, std::unique_ptr<MovingBody>>
      blades_;  // by their first and last station
  std::vector<Pair> pairs_;
};

class Prover {
 public:
  Prover(const Scene& scene, const CellPath& path, const std::function<void()>& between)
      : scene_(scene), poses_(path.t.size()), between_(between) {}

  // Distances at some poses.
  void look(std::size_t step) {
    for (const Pair& pair : scene_.pairs()) {
      if (overlap_at_start(pair)) offer(pair, 0, 0);
      for (std::size_t k = 0; k < poses_; k += step) ask(pair, k, least_known(pair));
      ask(pair, poses_ - 1, least_known(pair));
    }
  }

  // Ends with the first pair that is not clear.
  void prove() {
    for (const Pair& pair : scene_.pairs()) {
      if (found_.worst) return;
      prove(pair);
    }
  }

  [[nodiscard]] Clearance take() { return std::move(found_); }

 private:
  [[nodiscard]] double distance(const Pair& pair, std::size_t pose, double share, double capped_mm) {
    between_();
    const PlacedSolid a = pair.a->placed(pose, share), b = pair.b->placed(pose, share);
    ++found_.asked;
    return distance_mm(a.solid, a.at, b.solid, b.at, capped_mm);
  }

  // Surfaces of one body within another are apart; where they begin apart they can only get there through
  // zero.
  [[nodiscard]] static bool overlap_at_start(const Pair& pair) {
    const PlacedSolid a = pair.a->placed(0, 0), b = pair.b->placed(0, 0);
    const double apart = (a.at * a.solid.centre() - b.at * b.solid.centre()).norm() - a.solid.radius_mm() -
                         b.solid.radius_mm();
    return apart < 0 && one_inside_other(a.solid, a.at, b.solid, b.at);
  }

  double ask(const Pair& pair, std::size_t pose, double capped_mm) {
    const double mm = distance(pair, pose, 0, capped_mm);
    if (mm < capped_mm) offer(pair, mm, pose);
    return mm;
  }

  void offer(const Pair& pair, double mm, std::size_t pose) {
    auto& nearest = found_.nearest[static_cast<std::size_t>(pair.kind)];
    if (!nearest || mm < nearest->mm) nearest = {mm, pose};
    if (mm < pair.clearance_mm) too_near(pair, mm, pose, 0);
  }

  void too_near(const Pair& pair, double mm, std::size_t pose, double share) {
    if (mm - pair.clearance_mm >= most_short()) return;
    found_.worst = {pair.kind, pair.a->name, pair.b->name, mm, pair.clearance_mm, pose, share, true, 0};
  }

  // How much the worst pair is above its clearance, which is never more than 0.
  [[nodiscard]] double most_short() const {
    return found_.worst ? found_.worst->distance_mm - found_.worst->clearance_mm : 0;
  }

  // The least distance of the pair's kind so far, or its clearance: what is farther is of no interest.
  [[nodiscard]] double least_known(const Pair& pair) const {
    const auto& nearest = found_.nearest[static_cast<std::size_t>(pair.kind)];
    return std::max(pair.clearance_mm, nearest ? nearest->mm : kWidest_mm);
  }

  // Below this a distance of the pair has to be known: its clearance, the least of its kind, and once it is
  // sure that the path is not clear, what is worse than that alone.
  [[nodiscard]] double wanted(const Pair& pair) const {
    if (found_.worst && found_.worst->proved) return pair.clearance_mm + most_short() - kNearestWithin_mm;
    return std::max(pair.clearance_mm, least_known(pair) - kNearestWithin_mm);
  }

  // Goes from pose to pose as far as two distances like the last would prove, and back where the next is
  // less.
  void prove(const Pair& pair) {
    const std::vector<double>& moved = pair.moved_mm;
    const auto reached = [&](std::size_t k, double way_mm) {
      const auto after = std::upper_bound(moved.begin() + static_cast<std::ptrdiff_t>(k) + 1, moved.end(),
                                          moved[k] + way_mm);
      return std::max(k + 1, static_cast<std::size_t>(after - moved.begin()) - 1);
    };
    Known from{0, ask(pair, 0, kWidest_mm)};
    while (from.pose + 1 < poses_) {
      Known to{std::min(reached(from.pose, 2 * (from.mm - wanted(pair))), poses_ - 1), 0};
      to.mm = ask(pair, to.pose, kWidest_mm);
      between(pair, from, to);
      from = to;
    }
  }

  struct Known {
    std::size_t pose = 0;
    double mm = 0;
  };

  // Bodies are at one time no nearer than the mean of two distances less half of their way from one to the
  // other.
  void between(const Pair& pair, Known from, Known to) {
    const double way = pair.moved_mm[to.pose] - pair.moved_mm[from.pose];
    const double least = (from.mm + to.mm - way) / 2;
    if (least >= wanted(pair)) return;
    if (to.pose == from.pose + 1) {
      if (!(found_.worst && found_.worst->proved))
        halve(pair, from.pose, {0, from.mm}, {1, to.mm}, kHalvings);
      return;
    }
    Known middle{(from.pose + to.pose) / 2, 0};
    middle.mm = ask(pair, middle.pose, kWidest_mm);
    between(pair, from, middle);
    between(pair, middle, to);
  }

  struct Within {
    double share = 0, mm = 0;
  };

  // Bodies on their straight ways are at one time no nearer than the mean of both ends less half of the way,
  // and the path is no farther from these than both bends.
  void halve(const Pair& pair, std::size_t pose, Within from, Within to, int left) {
    const double bend = pair.way.bend_mm[pose];
    const double way = (to.share - from.share) * pair.way.straight_mm[pose];
    const double least = (from.mm + to.mm - way) / 2 - bend;
    if (least >= pair.clearance_mm) return;
    if (left == 0) {
      if (found_.worst && (found_.worst->proved || least - pair.clearance_mm >= most_short())) return;
      found_.worst = {pair.kind, pair.a->name, pair.b->name, least,         pair.clearance_mm,
                      pose,      from.share,   false,        way + 2 * bend};
      return;
    }
    Within middle{(from.share + to.share) / 2, 0};
    middle.mm = distance(pair, pose, middle.share, kWidest_mm);
    if (middle.mm + bend < pair.clearance_mm) return too_near(pair, middle.mm, pose, middle.share);
    halve(pair, pose, from, middle, left - 1);
    halve(pair, pose, middle, to, left - 1);
  }

  const Scene& scene_;
  std::size_t poses_;
  const std::function<void()>& between_;
  Clearance found_;
};

}  // namespace

const char* name(PairKind kind) {
  switch (kind) {
    case PairKind::kArms:
      return "arm_arm";
    case PairKind::kToolBlock:
      return "tool_block";
    case PairKind::kLinkBlock:
      return "link_block";
    case PairKind::kPlinth:
      return "plinth";
    case PairKind::kTable:
      return "table";
    case PairKind::kBlade:
      return "blade";
    case PairKind::kSelf:
      return "self";
    case PairKind::kObstacle:
      return "obstacle";
    case PairKind::kBladeTable:
      return "blade_table";
    case PairKind::kBladeObstacle:
      return "blade_obstacle";
    case PairKind::kBlockObstacle:
      return "block_obstacle";
  }
  return "";
}

std::string pair_words(const std::string& name) {
  // In the order of kPairKinds.
  constexpr std::array<const char*, kPairKinds.size()> kWords{
      "arm to arm",     "tool to block",     "arm to block",     "arm to plinth",
      "arm to table",   "arm to blade",      "arm to itself",    "arm to obstacle",
      "blade to table", "blade to obstacle", "block to obstacle"};
  for (std::size_t i = 0; i < kPairKinds.size(); ++i) {
    if (name == robot::name(kPairKinds[i])) return kWords[i];
  }
  return name;
}

Clearance prove_clear(const Cell& cell, const std::vector<Standing>& standing, const CellPath& path,
                      const std::function<void()>& between) {
  const Scene scene(cell, standing, path, between);
  Prover prover(scene, path, between);
  prover.look(kFirstLook);  // which is all that most places that are not clear take
  prover.prove();
  return prover.take();
}

Clearance sampled_clearance(const Cell& cell, const std::vector<Standing>& standing, const CellPath& path,
                            std::size_t step) {
  const std::function<void()> between = [] {};
  const Scene scene(cell, standing, path, between);
  Prover prover(scene, path, between);
  prover.look(step);
  return prover.take();
}

}  // namespace hotblade::robot
