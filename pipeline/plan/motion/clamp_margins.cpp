#include "pipeline/plan/motion/clamp_margins.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "elastica/blade/clamp_margin.hpp"
#include "gpu/backend/stop.hpp"
#include "pipeline/verify/clamp_error.hpp"

namespace hotblade::pipeline {

namespace {

// A fold leads to that of a pose nearby, half of the way to it at most: farther on another one may be nearer.
constexpr double kWarmShare = 0.5;

// What a search at a pose has found.
struct Found {
  std::vector<elastica::Fold> folds;
  double fold_mm = 0;  // to the nearest; as far as was looked where there is none
};

class MarginSearch {
 public:
  explicit MarginSearch(const std::vector<BladePose>& poses)
      : poses_(poses),
        held_(poses.size()),
        way_(poses.size(), 0.0),
        straight_(poses.size(), 0.0),
        bound_(poses.size(), 0.0) {
    std::vector<double> steps(poses.size(), 0.0);
    tbb::parallel_for(std::size_t{0}, poses.size(), [&](std::size_t i) {
      const double length = poses[i].blade.length;
      held_[i] = elastica::clamps_of(poses[i].blade);
      straight_[i] = elastica::clamp_distance(held_[i], {{0, 0, 0}, {length, 0, 0}}, 0.5 * length);
    });
    gpu::stop_point();
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
    for (std::size_t i = 0; i < margins.size(); ++i)
      margins[i] = {std::min(kFarFromFoldMm, bound_[i]), straight_[i]};
    return margins;
  }

 private:
  using Searched = std::map<std::size_t, Found>;

  // Each from the folds of the nearest pose searched before; all at once.
  void search(const std::set<std::size_t>& wanted) {
    const std::vector<std::size_t> list(wanted.begin(), wanted.end());
    std::vector<Found> found(list.size());
    tbb::parallel_for(std::size_t{0}, list.size(), [&](std::size_t k) {
      gpu::stop_point();
      found[k] = look(list[k]);
    });
    gpu::stop_point();
    for (std::size_t k = 0; k < list.size(); ++k) searched_[list[k]] = std::move(found[k]);
    // What holds of true distances is made to hold: none is more than its neighbour's and the way there.
    for (auto q = searched_.begin(), p = q++; q != searched_.end(); p = q++) lower(*q, *p);
    for (auto q = searched_.rbegin(), p = q++; q != searched_.rend(); p = q++) lower(*q, *p);
  }

  [[nodiscard]] Found look(std::size_t i) const {
    const auto near = nearest(i);
    const bool warm = near != searched_.end() && apart(i, near->first) < kWarmShare * near->second.fold_mm;
    Found found = look(i, warm ? near->second.folds : std::vector<elastica::Fold>{});
    // More than the neighbours allow: the nearest fold is another one than theirs.
    if (warm && found.fold_mm > ceiling(i)) {
      Found again = look(i, {});
      if (again.fold_mm < found.fold_mm) found = std::move(again);
    }
    return found;
  }

  [[nodiscard]] Found look(std::size_t i, const std::vector<elastica::Fold>& near) const {
    const elastica::Elastica& blade = poses_[i].blade;
    const double far = std::max(kFarFromFoldMm, kFoldSearchShare * blade.length);
    elastica::ClampMargin margin = elastica::clamp_margin(blade, near, {far, 0});
    // Beyond the straight blade no fold is looked for, as that is the nearer loss.
    if (margin.folds.empty() && margin.fold_mm > 0 && straight_[i] < far)
      margin.fold_mm = std::max(straight_[i], kFarFromFoldMm);
    return {std::move(margin.folds), margin.fold_mm};
  }

  void lower(Searched::value_type& to, const Searched::value_type& from) const {
    to.second.fold_mm = std::min(to.second.fold_mm, from.second.fold_mm + apart(to.first, from.first));
  }

  // Of the clamps: along their way, and at once.
  [[nodiscard]] double apart(std::size_t i, std::size_t k) const { return std::abs(way_[i] - way_[k]); }
  [[nodiscard]] double direct(std::size_t i, std::size_t k) const {
    return elastica::clamp_distance(held_[i], held_[k], 0.5 * poses_[i].blade.length);
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
      if (known != searched_.end()) most = std::min(most, known->second.fold_mm + apart(i, known->first));
    }
    constexpr double kRounding = 1e-6;
    return most * (1 + kRounding);
  }

  // How much the bound of pose i, between two searched ones, may be below what they tell. Where the straight
  // blade is nearer, no fold decides.
  [[nodiscard]] double wanted_bound(std::size_t i, double both) const {
    return std::min(kMarginShare * std::min(kFarFromFoldMm, both), straight_[i]);
  }

  // Bounds the poses between two searched ones; the one whose bound is lowest against what is wanted of it,
  // or the first of the two when all are high enough.
  std::size_t bound_between(const Searched::value_type& p, const Searched::value_type& q) {
    const double both = std::min(p.second.fold_mm, q.second.fold_mm);
    bound_[p.first] = p.second.fold_mm;
    bound_[q.first] = q.second.fold_mm;
    bool enough = true;
    for (std::size_t i = p.first + 1; i < q.first; ++i) {
      bound_[i] = std::max({0.0, p.second.fold_mm - apart(i, p.first), q.second.fold_mm - apart(i, q.first)});
      enough = enough && bound_[i] >= wanted_bound(i, both);
    }
    if (enough) return p.first;
    // The straight distance between two poses is less than the way, and counts as long as the way keeps
    // within the distance that holds no fold.
    for (std::size_t i = p.first + 1; i < q.first && raise(i, p); ++i) {
    }
    for (std::size_t i = q.first - 1; i > p.first && raise(i, q); --i) {
    }
    std::size_t worst = p.first;
    double missing = 0;
    for (std::size_t i = p.first + 1; i < q.first; ++i) {
      const double short_by = wanted_bound(i, both) - bound_[i];
      if (short_by > missing) {
        missing = short_by;
        worst = i;
      }
    }
    return worst;
  }

  bool raise(std::size_t i, const Searched::value_type& from) {
    const double left = from.second.fold_mm - direct(i, from.first);
    bound_[i] = std::max(bound_[i], left);
    return left > 0;
  }

  [[nodiscard]] std::set<std::size_t> too_coarse() {
    std::set<std::size_t> wanted;
    if (searched_.size() == 1) bound_[searched_.begin()->first] = searched_.begin()->second.fold_mm;
    for (auto q = searched_.begin(), p = q++; q != searched_.end(); p = q++) {
      const std::size_t worst = bound_between(*p, *q);
      if (worst != p->first) wanted.insert(worst);
    }
    return wanted;
  }

  const std::vector<BladePose>& poses_;
  std::vector<elastica::ClampPair> held_;
  std::vector<double> way_;  // of the clamps against each other, from the first pose
  std::vector<double> straight_;
  std::vector<double> bound_;
  Searched searched_;
};

}  // namespace

std::vector<PoseMargin> clamp_margins(const std::vector<BladePose>& poses) {
  if (poses.empty()) return {};
  return MarginSearch(poses).run();
}

double smallest_margin_mm(const Settings& settings, double blade_length_mm) {
  constexpr double kTimesTheError = 2;
  return settings.blade.min_margin_mm > 0
             ? settings.blade.min_margin_mm
             : kTimesTheError * worst_clamp_error_mm(settings.machine, blade_length_mm);
}

}  // namespace hotblade::pipeline
