#include "pipeline/plan/clamp_margins.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "elastica/clamp_margin.hpp"

namespace hotblade::pipeline {

namespace {

using elastica::ClampMargin;

constexpr elastica::ClampMarginOptions kOptions{kFarFromFoldMm, 0};

class MarginSearch {
 public:
  explicit MarginSearch(const std::vector<BladePose>& poses)
      : poses_(poses), way_(poses.size(), 0.0), straight_(poses.size(), 0.0) {
    std::vector<double> steps(poses.size(), 0.0);
    tbb::parallel_for(std::size_t{0}, poses.size(), [&](std::size_t i) {
      const double length = poses[i].blade.length, weight = 0.5 * length;
      const elastica::ClampPair held = elastica::clamps_of(poses[i].blade);
      straight_[i] = elastica::clamp_distance(held, {{0, 0, 0}, {length, 0, 0}}, weight);
      if (i > 0) steps[i] = elastica::clamp_distance(elastica::clamps_of(poses[i - 1].blade), held, weight);
    });
    for (std::size_t i = 1; i < poses.size(); ++i) way_[i] = way_[i - 1] + steps[i];
  }

  std::vector<PoseMargin> run() {
    std::set<std::size_t> wanted{0, poses_.size() - 1};
    while (!wanted.empty()) {
      search(wanted);
      wanted = too_coarse();
    }
    std::vector<PoseMargin> margins(poses_.size());
    for (std::size_t i = 0; i < margins.size(); ++i) margins[i] = {bound(i), straight_[i]};
    return margins;
  }

 private:
  // Each from the folds of the nearest pose searched before; all at once.
  void search(const std::set<std::size_t>& wanted) {
    const std::vector<std::size_t> list(wanted.begin(), wanted.end());
    std::vector<ClampMargin> found(list.size());
    tbb::parallel_for(std::size_t{0}, list.size(), [&](std::size_t k) {
      const std::size_t i = list[k];
      const ClampMargin* near = nearest(i);
      const auto& blade = poses_[i].blade;
      found[k] = near ? elastica::clamp_margin(blade, near->folds, kOptions)
                      : elastica::clamp_margin(blade, kOptions);
      // More than the neighbours allow: the nearest fold is another one than theirs.
      if (near && !near->folds.empty() && found[k].fold_mm > ceiling(i)) {
        const ClampMargin again = elastica::clamp_margin(blade, kOptions);
        if (again.fold_mm < found[k].fold_mm) found[k] = again;
      }
    });
    for (std::size_t k = 0; k < list.size(); ++k) searched_[list[k]] = std::move(found[k]);
    // What holds of true distances is made to hold: none is more than its neighbour's and the way there.
    for (auto q = searched_.begin(), p = q++; q != searched_.end(); p = q++) lower(*q, *p);
    for (auto q = searched_.rbegin(), p = q++; q != searched_.rend(); p = q++) lower(*q, *p);
  }

  using Searched = std::map<std::size_t, ClampMargin>;

  void lower(Searched::value_type& to, const Searched::value_type& from) const {
    to.second.fold_mm = std::min(to.second.fold_mm, from.second.fold_mm + apart(to.first, from.first));
  }

  [[nodiscard]] double apart(std::size_t i, std::size_t k) const { return std::abs(way_[i] - way_[k]); }

  // Searched poses at and behind, and before; none: the end.
  [[nodiscard]] std::pair<Searched::const_iterator, Searched::const_iterator> beside(std::size_t i) const {
    const auto after = searched_.lower_bound(i);
    return {after == searched_.begin() ? searched_.end() : std::prev(after), after};
  }

  [[nodiscard]] const ClampMargin* nearest(std::size_t i) const {
    const auto [before, after] = beside(i);
    if (before == searched_.end()) return after == searched_.end() ? nullptr : &after->second;
    if (after == searched_.end()) return &before->second;
    return &(apart(i, before->first) <= apart(i, after->first) ? before : after)->second;
  }

  [[nodiscard]] double ceiling(std::size_t i) const {
    double most = kFarFromFoldMm;
    const auto [before, after] = beside(i);
    for (const auto& known : {before, after}) {
      if (known != searched_.end()) most = std::min(most, known->second.fold_mm + apart(i, known->first));
    }
    constexpr double kRounding = 1e-6;
    return most * (1 + kRounding);
  }

  [[nodiscard]] double bound(std::size_t i) const {
    double least = 0;
    const auto [before, after] = beside(i);
    for (const auto& known : {before, after}) {
      if (known != searched_.end()) least = std::max(least, known->second.fold_mm - apart(i, known->first));
    }
    return least;
  }

  // Between searched poses whose bound is low: the pose where it is lowest. Where the straight blade is
  // nearer than the bound, no fold decides.
  [[nodiscard]] std::set<std::size_t> too_coarse() const {
    std::set<std::size_t> wanted;
    for (auto q = searched_.begin(), p = q++; q != searched_.end(); p = q++) {
      const double both = kMarginShare * std::min(p->second.fold_mm, q->second.fold_mm);
      std::size_t worst = 0;
      double missing = 0;
      for (std::size_t i = p->first + 1; i < q->first; ++i) {
        const double short_by = std::min(both, straight_[i]) - bound(i);
        if (short_by > missing) {
          missing = short_by;
          worst = i;
        }
      }
      if (missing > 0) wanted.insert(worst);
    }
    return wanted;
  }

  const std::vector<BladePose>& poses_;
  std::vector<double> way_;  // of the clamps against each other, from the first pose
  std::vector<double> straight_;
  Searched searched_;
};

}  // namespace

std::vector<PoseMargin> clamp_margins(const std::vector<BladePose>& poses) {
  if (poses.empty()) return {};
  return MarginSearch(poses).run();
}

double worst_clamp_error_mm(const MachineSettings& machine, double blade_length_mm) {
  return std::numbers::sqrt2 *
         std::hypot(machine.clamp_error_mm, 0.5 * blade_length_mm * machine.clamp_error_rad);
}

double smallest_margin_mm(const Settings& settings, double blade_length_mm) {
  constexpr double kTimesTheError = 2;
  return settings.blade.min_margin_mm > 0
             ? settings.blade.min_margin_mm
             : kTimesTheError * worst_clamp_error_mm(settings.machine, blade_length_mm);
}

}  // namespace hotblade::pipeline
