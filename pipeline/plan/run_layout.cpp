#include "pipeline/plan/run_layout.hpp"

#include <algorithm>
#include <cmath>

#include "pipeline/plan/adaptive_ribs.hpp"
#include "pipeline/plan/share_strip.hpp"
#include "pipeline/plan/split.hpp"

namespace hotblade::pipeline {

namespace {

class RunLayout {
 public:
  RunLayout(const ChainTarget& chain, std::span<const RibTarget> sections, const Settings& settings,
            std::size_t most_more)
      : chain_(chain),
        sections_(sections),
        settings_(settings),
        most_more_(static_cast<int>(most_more)),
        ribs_(first_ribs(sections)) {}

  StripLayout run() {
    for (bool settled = false; !settled;) {
      gather();
      if (!(lines_.empty() ? false : cut(lines_)) && !split()) {
        layout_.strips.clear();
        layout_.refusals.push_back(said_);
        return std::move(layout_);
      }
      settled = !refine();
    }
    for (StripPlan& strip : layout_.strips) smooth(strip);
    measure_seams();
    return std::move(layout_);
  }

 private:
  void gather() {
    targets_.clear();
    for (const std::size_t k : ribs_) targets_.push_back(sections_[k]);
  }

  // The refusal that is told in the end. The first one of pieces that an elastica serves says most; before
  // that, how far the last one was off.
  void listen(const Attempt& attempt) {
    if (!fitted_) {
      said_ = attempt.refusal;
      said_.rib = rib_id("", attempt.rib);
    }
    fitted_ = fitted_ || attempt.fitted;
    hopeless_ = hopeless_ || attempt.hopeless;
  }

  // All strips between these lines, or none.
  bool cut(const std::vector<double>& lines) {
    layout_.strips.clear();
    std::vector<std::vector<RibFit>> free;
    for (std::size_t i = 0; i + 1 < lines.size(); ++i) {
      free.push_back(fit_ribs(targets_, lines[i], lines[i + 1], settings_.fit));
    }
    std::vector<std::vector<RibFit>> joined = free;
    join_pieces(joined, allowed_mm(settings_));
    for (std::size_t i = 0; i < free.size(); ++i) {
      Attempt attempt = try_share(chain_, joined[i], Purpose::kStrip, settings_);
      const bool clamped = joined[i].front().clamp_start || joined[i].front().clamp_end;
      if (!attempt.strip && clamped) attempt = try_share(chain_, free[i], Purpose::kStrip, settings_);
      if (!attempt.strip) {
        listen(attempt);
        return false;
      }
      layout_.strips.push_back(std::move(*attempt.strip));
    }
    lines_ = lines;
    return true;
  }

  void measure_seams() {
    for (std::size_t i = 1; i < layout_.strips.size(); ++i) {
      layout_.strips[i].seam_before = measure_seam(layout_.strips[i - 1].ribs, layout_.strips[i].ribs);
    }
  }

  // Solves the strip's ribs together; a result that its blade cannot serve is given up.
  void smooth(StripPlan& strip) const {
    std::vector<RibFit> ribs = strip.ribs;
    const double allowed = allowed_mm(settings_);
    const JointFitReport joint = joint_fit(
        ribs, {strip.blade_length_mm, strip.share_a, settings_.motion.feed_mm_s, 0.1 * allowed, allowed});
    const BladeReport blade =
        choose_blade(ribs, strip, block_around(ribs, strip, settings_.stock), settings_);
    strip.joint = {joint.acceleration_before_mm_s2, joint.acceleration_before_mm_s2, 0};
    if (joint.weight == 0 || !blade.choice || blade.choice->length_mm > strip.blade_length_mm) return;
    StripPlan next = make_strip_plan(chain_, ribs, *blade.choice, settings_);
    if (!fits_stock(next, settings_)) return;
    next.joint = joint;
    next.separate = std::make_shared<const StripPlan>(strip);
    strip = std::move(next);
  }

  // Longer ribs than any blade or block need no fit to be told.
  [[nodiscard]] bool may_serve(double u0, double u1) const {
    return (u1 - u0) * longest_rib_mm() < settings_.blade.free_lengths_mm.back();
  }

  bool split() {
    const ShareTest test = [&](double u0, double u1) -> std::optional<double> {
      if (hopeless_ || (u1 - u0 < 1 && !may_serve(u0, u1))) return std::nullopt;
      const Attempt attempt =
          try_share(chain_, fit_ribs(targets_, u0, u1, settings_.fit), Purpose::kSearch, settings_);
      if (attempt.strip) return attempt.strip->ribs[worst_rib(attempt.strip->ribs)].deviation_mm;
      listen(attempt);
      return std::nullopt;
    };
    const Split found =
        split_ribs(test, {steps(), least_pieces() + std::min(settings_.fit.max_splits, most_more_)});
    return !found.lines.empty() && (cut(found.lines) || cut(found.farthest));
  }

  // Pieces that the longest rib needs for its length alone: no strip is longer than a blade or a block.
  [[nodiscard]] int least_pieces() const {
    const auto& stock = settings_.stock.max_size_mm;
    const double most =
        std::min(settings_.blade.free_lengths_mm.back(), *std::max_element(stock.begin(), stock.end()));
    return static_cast<int>(std::ceil(longest_rib_mm() / most));
  }

  [[nodiscard]] double longest_rib_mm() const {
    double longest = 0;
    for (const RibTarget& rib : targets_) longest = std::max(longest, rib.s.back());
    return longest;
  }

  // Lines about 20 mm apart are finer than a seam needs to be placed; 24 steps do for short ribs.
  [[nodiscard]] int steps() const {
    constexpr double kStepMm = 20;
    return std::clamp(static_cast<int>(longest_rib_mm() / kStepMm), 24, 2400);
  }

  // Adds ribs where the surface between them is off; false when it is near enough everywhere.
  bool refine() {
    std::vector<FittedShare> strips;
    for (std::size_t i = 0; i < layout_.strips.size(); ++i) {
      strips.push_back({lines_[i], lines_[i + 1], layout_.strips[i].ribs});
    }
    const double limit = settings_.fit.between_share * settings_.design.tolerance_mm;
    const std::vector<std::size_t> more = ribs_to_add(sections_, ribs_, strips, limit);
    ribs_.insert(ribs_.end(), more.begin(), more.end());
    std::sort(ribs_.begin(), ribs_.end());
    return !more.empty();
  }

  const ChainTarget& chain_;
  std::span<const RibTarget> sections_;
  const Settings& settings_;
  int most_more_;
  std::vector<std::size_t> ribs_;   // sections that have a rib
  std::vector<RibTarget> targets_;  // of them
  std::vector<double> lines_;
  StripLayout layout_;
  Refusal said_;
  bool fitted_ = false, hopeless_ = false;
};

}  // namespace

StripLayout lay_out_run(const ChainTarget& chain, std::span<const RibTarget> sections,
                        const Settings& settings, std::size_t most_more) {
  return RunLayout(chain, sections, settings, most_more).run();
}

}  // namespace hotblade::pipeline
