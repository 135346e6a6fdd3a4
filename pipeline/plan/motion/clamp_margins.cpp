#include "pipeline/plan/motion/clamp_margins.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "elastica/blade/blade_batch.hpp"
#include "elastica/blade/clamp_margin.hpp"
#include "gpu/backend/stop.hpp"
#include "pipeline/plan/motion/blocks.hpp"
#include "pipeline/verify/clamp_error.hpp"

namespace hotblade::pipeline {

namespace {

// A fold leads to that of a pose nearby, half of the way to it at most: farther on another one may be nearer.
constexpr double kWarmShare = 0.5;

// What a search at a pose has found.
struct Found {
  std::vector<elastica::Fold> folds;
  double clear_mm = 0;       // to the nearest loss; as far as was looked where there is none
  bool by_straight = false;  // that is the straight blade, and no fold was found before it
};

class MarginSearch {
 public:
  MarginSearch(const std::vector<BladePose>& poses, const Settings& settings)
      : poses_(poses),
        machine_(settings.machine),
        least_mm_(smallest_margin_mm(settings, poses.front().blade.length)),
        held_(poses.size()),
        way_(poses.size(), 0.0),
        straight_(poses.size(), 0.0),
        bound_(poses.size(), 0.0) {
    std::vector<double> steps(poses.size(), 0.0);
    in_blocks(poses.size(), [&](std::size_t from, std::size_t to) {
      std::vector<elastica::Elastica> blades;
      std::vector<double> lengths;
      for (std::size_t i = from; i < to; ++i) {
        blades.push_back(poses[i].blade);
        lengths.push_back(poses[i].blade.length);
      }
      std::vector<elastica::CurvePoint> ends(blades.size());
      elastica::points_at(blades, lengths, ends);
      for (std::size_t i = from; i < to; ++i) {
        const elastica::Elastica& blade = blades[i - from];
        const elastica::CurvePoint& end = ends[i - from];
        held_[i] = {{blade.x, blade.y, blade.theta}, {end.x, end.y, end.theta}};
        straight_[i] =
            elastica::clamp_distance(held_[i], {{0, 0, 0}, {blade.length, 0, 0}}, 0.5 * blade.length);
      }
    });
    tbb::parallel_for(std::size_t{1}, poses.size(), [&](std::size_t i) { steps[i] = direct(i - 1, i); });
    gpu::stop_point();
    for (std::size_t i = 1; i < poses.size(); ++i) way_[i] = way_[i - 1] + steps[i];
  }

  std::vector<PoseMargin> run() {
    std::set<std::size_t> wanted{0, poses_.size() - 1};
    while (!wanted.empty()) {
      search(wanted);
      wanted = too_coarse();
    }
    std::vector<PoseMargin> margins(poses_.size());
    for (std::size_t i = 0; i < margins.size(); ++i) margins[i] = margin_at(i);
    return margins;
  }

 private:
  using Searched = std::map<std::size_t, Found>;

  [[nodiscard]] PoseMargin margin_at(std::size_t i) const {
    const double bound = std::min(kFarFromFoldMm, bound_[i]), straight = straight_[i];
    const bool by_fold = bound < kMarginShare * straight || (bound < least_mm_ && straight >= least_mm_);
    return {std::min(bound, straight), by_fold ? bound : kFarFromFoldMm, straight};
  }

  // Each from the folds of the poses beside that were searched before; all at once.
  void search(const std::set<std::size_t>& wanted) {
    const std::vector<std::size_t> list(wanted.begin(), wanted.end());
    std::vector<Found> found(list.size());
    // A strip ends in the shape that it began with.
    const bool ends_alike = list.size() > 1 && alike(list.front(), list.back());
    tbb::parallel_for(std::size_t{0}, list.size() - (ends_alike ? 1 : 0), [&](std::size_t k) {
      gpu::stop_point();
      found[k] = look(list[k]);
    });
    gpu::stop_point();
    if (ends_alike) found.back() = found.front();
    for (std::size_t k = 0; k < list.size(); ++k) searched_[list[k]] = std::move(found[k]);
    // What holds of true distances is made to hold: none is more than its neighbour's and the way there.
    for (auto q = searched_.begin(), p = q++; q != searched_.end(); p = q++) lower(*q, *p);
    for (auto q = searched_.rbegin(), p = q++; q != searched_.rend(); p = q++) lower(*q, *p);
    for (const auto& [i, known] : searched_) {
      if (known.clear_mm < least_mm_ && !known.by_straight && !nearly_straight(poses_[i], machine_))
        lost_mm_ = std::min(lost_mm_, known.clear_mm);
    }
  }

  [[nodiscard]] Found look(std::size_t i) const {
    const auto near = nearest(i);
    const bool warm = near != searched_.end() && !near->second.folds.empty() &&
                      apart(i, near->first) < kWarmShare * near->second.clear_mm;
    std::vector<elastica::Fold> seeds;
    const auto [before, after] = beside(i);
    for (const auto& known : {before, after}) {
      if (known != searched_.end())
        seeds.insert(seeds.end(), known->second.folds.begin(), known->second.folds.end());
    }
    Found found = look(i, seeds, !warm);
    // More than the neighbours allow: the nearest fold is another one than theirs.
    if (warm && found.clear_mm > ceiling(i)) {
      Found again = look(i, seeds, true);
      if (again.clear_mm < found.clear_mm) found = std::move(again);
    }
    return found;
  }

  [[nodiscard]] Found look(std::size_t i, const std::vector<elastica::Fold>& near, bool everywhere) const {
    const elastica::Elastica& blade = poses_[i].blade;
    // Twice as far as the neighbours allow: searches of that radius take half the time of the farthest, and
    // one no larger misses more.
    constexpr double kLeastMm = 1e-3;  // a neighbour at the same place may be lost by itself
    const double far =
        std::clamp(2 * ceiling(i), kLeastMm, std::max(kFarFromFoldMm, kFoldSearchShare * blade.length));
    elastica::ClampMargin margin = elastica::clamp_margin(blade, near, {far, 0, everywhere});
    const bool by_straight = straight_[i] < margin.fold_mm;
    return {std::move(margin.folds), std::min(straight_[i], margin.fold_mm), by_straight};
  }

  void lower(Searched::value_type& to, const Searched::value_type& from) const {
    double& clear = to.second.clear_mm;
    clear = std::min(clear, from.second.clear_mm + apart(to.first, from.first));
    // The straight distance is less than the way, and counts as long as the way keeps within the distance
    // that holds no loss: what is found at its end then lies within it as well.
    const double near = from.second.clear_mm + direct(to.first, from.first);
    if (near < clear && keeps_within(to, from.first)) clear = near;
  }
  [[nodiscard]] bool keeps_within(const Searched::value_type& of, std::size_t to) const {
    const auto [first, last] = std::minmax(of.first, to);
    for (std::size_t i = first; i <= last; ++i)
      if (!(direct(i, of.first) < of.second.clear_mm)) return false;
    return true;
  }

  // Of the clamps: along their way, and at once.
  [[nodiscard]] double apart(std::size_t i, std::size_t k) const { return std::abs(way_[i] - way_[k]); }
  [[nodiscard]] double direct(std::size_t i, std::size_t k) const {
    return elastica::clamp_distance(held_[i], held_[k], 0.5 * poses_[i].blade.length);
  }

  // Whether two poses hold the blade in one shape: folds do not depend on where the pair of clamps stands.
  [[nodiscard]] bool alike(std::size_t i, std::size_t k) const {
    constexpr double kSameMm = 1e-6;
    const elastica::Elastica &a = poses_[i].blade, &b = poses_[k].blade;
    const double l2 = a.length * a.length;
    const Eigen::Vector2d more = elastica::force_along(a, a.theta) - elastica::force_along(b, b.theta);
    return a.length == b.length && direct(i, k) <= kSameMm &&
           std::max(std::abs(a.kappa - b.kappa) * l2, more.norm() * l2 * a.length) <= kSameMm;
  }

  // Searched poses at and behind, and before; none: the end.
  [[nodiscard]] std::pair<Searched::const_iterator, Searched::const_iterator> beside(std::size_t i) const {
    const auto after = searched_.lower_bound(i);
    return {after == searched_.begin() ? searched_.end() : std::prev(after), after};
  }

  [[nodiscard]] Searched::const_iterator nearest(std::size_t i) const {
    const auto [before, after] = beside(i);
    if (before == searched_.end() || after == searched_.end())
      return before == searched_.end() ? after : before;
    return apart(i, before->first) <= apart(i, after->first) ? before : after;
  }

  [[nodiscard]] double ceiling(std::size_t i) const {
    double most = std::numeric_limits<double>::infinity();
    const auto [before, after] = beside(i);
    for (const auto& known : {before, after}) {
      if (known != searched_.end()) most = std::min(most, known->second.clear_mm + apart(i, known->first));
    }
    constexpr double kRounding = 1e-6;
    return most * (1 + kRounding);
  }

  // How high the bound of pose i has to be, between two searched ones.
  [[nodiscard]] double wanted_bound(std::size_t i, const Found& p, const Found& q) const {
    const double straight = straight_[i];
    double least = std::min({kFarFromFoldMm, straight, lost_mm_});
    for (const Found* found : {&p, &q})
      if (!found->by_straight) least = std::min(least, found->clear_mm);
    const double wanted = kMarginShare * least;
    const bool may_pass = (p.by_straight || q.by_straight) && straight >= least_mm_ && lost_mm_ >= least_mm_;
    return may_pass ? std::max(wanted, least_mm_) : wanted;
  }

  // What a searched pose leaves of its distance that far from it. Beside the straight blade folds lie
  // closely, and a search may miss one: none farther than half of the way to it is relied on.
  [[nodiscard]] static double left(const Found& found, double way_mm) {
    return found.clear_mm - (found.by_straight ? 2 : 1) * way_mm;
  }

  // Bounds the poses between two searched ones; the one whose bound is lowest against what is wanted of it,
  // or the first of the two when all are high enough.
  std::size_t bound_between(const Searched::value_type& p, const Searched::value_type& q) {
    bound_[p.first] = p.second.clear_mm;
    bound_[q.first] = q.second.clear_mm;
    bool enough = true;
    for (std::size_t i = p.first + 1; i < q.first; ++i) {
      bound_[i] = std::max({0.0, left(p.second, apart(i, p.first)), left(q.second, apart(i, q.first))});
      enough = enough && bound_[i] >= wanted_bound(i, p.second, q.second);
    }
    if (enough) return p.first;
    // By the straight distance, as in lower().
    for (std::size_t i = p.first + 1; i < q.first && raise(i, p); ++i) {
    }
    for (std::size_t i = q.first - 1; i > p.first && raise(i, q); --i) {
    }
    std::size_t worst = p.first;
    double missing = 0;
    for (std::size_t i = p.first + 1; i < q.first; ++i) {
      const double short_by = wanted_bound(i, p.second, q.second) - bound_[i];
      if (short_by > missing) {
        missing = short_by;
        worst = i;
      }
    }
    return worst;
  }

  bool raise(std::size_t i, const Searched::value_type& from) {
    const double rest = left(from.second, direct(i, from.first));
    bound_[i] = std::max(bound_[i], rest);
    return rest > 0;
  }

  [[nodiscard]] std::set<std::size_t> too_coarse() {
    std::set<std::size_t> wanted;
    if (searched_.size() == 1) bound_[searched_.begin()->first] = searched_.begin()->second.clear_mm;
    for (auto q = searched_.begin(), p = q++; q != searched_.end(); p = q++) {
      const std::size_t worst = bound_between(*p, *q);
      if (worst != p->first) wanted.insert(worst);
    }
    return wanted;
  }

  const std::vector<BladePose>& poses_;
  const MachineSettings& machine_;
  double least_mm_;
  double lost_mm_ = std::numeric_limits<double>::infinity();  // the smallest that refuses the strip
  std::vector<elastica::ClampPair> held_;
  std::vector<double> way_;  // of the clamps against each other, from the first pose
  std::vector<double> straight_;
  std::vector<double> bound_;
  Searched searched_;
};

}  // namespace

std::vector<PoseMargin> clamp_margins(const std::vector<BladePose>& poses, const Settings& settings) {
  if (poses.empty()) return {};
  return MarginSearch(poses, settings).run();
}

double smallest_margin_mm(const Settings& settings, double blade_length_mm) {
  constexpr double kTimesTheError = 2;
  return settings.blade.min_margin_mm > 0
             ? settings.blade.min_margin_mm
             : kTimesTheError * worst_clamp_error_mm(settings.machine, blade_length_mm);
}

}  // namespace hotblade::pipeline
