#include "pipeline/plan/strips/run_layout.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "pipeline/plan/motion/strip_block.hpp"
#include "pipeline/plan/ribs/adaptive_ribs.hpp"
#include "pipeline/plan/ribs/complete.hpp"
#include "pipeline/plan/strips/share_strip.hpp"
#include "pipeline/plan/strips/split.hpp"

namespace hotblade::pipeline {

namespace {

class RunLayout {
 public:
  // `sections` go on past the design's border all or none.
  RunLayout(const ChainTarget& chain, std::span<const RibTarget> sections, const Settings& settings,
            std::size_t most_more, const WatchTries& watch)
      : chain_(chain),
        sections_(sections),
        settings_(settings),
        most_more_(static_cast<int>(most_more)),
        watch_(watch),
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

  [[nodiscard]] bool completed() const { return sections_.front().own.has_value(); }

  // Ribs, as indices into ribs_, from the first to the last that a share has design for.
  struct RibRange {
    std::size_t first = 0, last = 0;
    [[nodiscard]] std::size_t size() const { return last - first + 1; }
  };

  // The first and the last section that a share has design in, or next to: it ends somewhere between.
  [[nodiscard]] std::array<std::size_t, 2> sections_of(double u0, double u1) const {
    std::array<std::size_t, 2> ends{0, sections_.size() - 1};
    const auto idle = [&](std::size_t k) {
      const DesignPart own = sections_[k].own_of(u0, u1);
      return !(own.last > own.first);
    };
    while (ends[0] < ends[1] && idle(ends[0] + 1)) ++ends[0];
    while (ends[1] > ends[0] && idle(ends[1] - 1)) --ends[1];
    return ends;
  }

  [[nodiscard]] RibRange ribs_of(double u0, double u1) const {
    const auto [first, last] = sections_of(u0, u1);
    RibRange range{0, ribs_.size() - 1};
    while (range.last > range.first + 1 && ribs_[range.first + 1] <= first) ++range.first;
    while (range.last > range.first + 1 && ribs_[range.last - 1] >= last) --range.last;
    return range;
  }

  // The share's fits, with what the block must hold of the sections between them.
  [[nodiscard]] std::vector<RibFit> fit_share(double u0, double u1, const RibRange& range) const {
    watch_();
    std::vector<RibFit> fits =
        fit_ribs(std::span(targets_).subspan(range.first, range.size()), u0, u1, settings_.fit);
    if (!completed()) return fits;
    std::size_t r = 0;
    for (std::size_t k = ribs_[range.first]; k <= ribs_[range.last]; ++k) {
      const RibTarget& section = sections_[k];
      const DesignPart own = section.own_of(u0, u1);
      if (!(own.last > own.first)) continue;
      while (r + 1 < fits.size() &&
             section.offset_mm - fits[r].offset_mm > fits[r + 1].offset_mm - section.offset_mm)
        ++r;
      const auto ends = resample(section, u0 + own.first * (u1 - u0), u0 + own.last * (u1 - u0), 2);
      fits[r].beside.insert(fits[r].beside.end(), ends.begin(), ends.end());
    }
    return fits;
  }

  // What a strip forms of each section: the design's part, and what is needed to cut right through its
  // border. A seam ends it.
  [[nodiscard]] std::vector<FormedPart> formed_by(double u0, double u1, const RibRange& range) const {
    constexpr double kBeyondMm = 5;
    std::vector<FormedPart> formed;
    if (!completed()) return formed;
    for (std::size_t k = ribs_[range.first]; k <= ribs_[range.last]; ++k) {
      const RibTarget& section = sections_[k];
      const double beyond = kBeyondMm / (section.s.back() * (u1 - u0));
      DesignPart part = section.own_of(u0, u1);
      part.first = u0 > 0 ? std::max(0.0, part.first - beyond) : part.first - beyond;
      part.last = u1 < 1 ? std::min(1.0, part.last + beyond) : part.last + beyond;
      formed.push_back({section.offset_mm, part});
    }
    return formed;
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

  static void keep_range(const RibRange& range, std::vector<RibFit>& fits) {
    fits.resize(range.last + 1);
    fits.erase(fits.begin(), fits.begin() + static_cast<std::ptrdiff_t>(range.first));
  }

  // All strips between these lines, or none.
  bool cut(const std::vector<double>& lines) {
    layout_.strips.clear();
    std::vector<std::vector<RibFit>> free;
    for (std::size_t i = 0; i + 1 < lines.size(); ++i) {
      free.push_back(fit_share(lines[i], lines[i + 1], {0, ribs_.size() - 1}));
    }
    std::vector<std::vector<RibFit>> joined = free;
    join_pieces(joined, allowed_mm(settings_));
    for (std::size_t i = 0; i < free.size(); ++i) {
      const RibRange range = ribs_of(lines[i], lines[i + 1]);
      keep_range(range, free[i]);
      keep_range(range, joined[i]);
      Attempt attempt = try_share(chain_, joined[i], Purpose::kStrip, settings_);
      const bool clamped = joined[i].front().clamp_start || joined[i].front().clamp_end;
      if (!attempt.strip && clamped) attempt = try_share(chain_, free[i], Purpose::kStrip, settings_);
      if (!attempt.strip) {
        listen(attempt);
        return false;
      }
      attempt.strip->formed = formed_by(lines[i], lines[i + 1], range);
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
    next.formed = strip.formed;
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
          try_share(chain_, fit_share(u0, u1, ribs_of(u0, u1)), Purpose::kSearch, settings_);
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
    const std::size_t were = ribs_.size();
    const std::vector<std::size_t> more = ribs_to_add(sections_, ribs_, strips, limit), ends = ribs_at_ends();
    ribs_.insert(ribs_.end(), more.begin(), more.end());
    ribs_.insert(ribs_.end(), ends.begin(), ends.end());
    std::sort(ribs_.begin(), ribs_.end());
    ribs_.erase(std::unique(ribs_.begin(), ribs_.end()), ribs_.end());
    return ribs_.size() > were;
  }

  // Where a share's design begins or ends between two ribs: a rib there, so that its strip is no longer than
  // that; far enough from the next rib inside.
  [[nodiscard]] std::vector<std::size_t> ribs_at_ends() const {
    std::vector<std::size_t> add;
    const double least = least_rib_gap_mm(sections_);
    const auto offset = [&](std::size_t k) { return sections_[k].offset_mm; };
    for (std::size_t i = 0; i + 1 < lines_.size(); ++i) {
      const auto [first, last] = sections_of(lines_[i], lines_[i + 1]);
      const RibRange range = ribs_of(lines_[i], lines_[i + 1]);
      const std::size_t from = ribs_[range.first], to = ribs_[range.last];
      std::size_t a = first, b = last;
      while (a > from && offset(ribs_[range.first + 1]) - offset(a) < least) --a;
      while (b < to && offset(b) - offset(ribs_[range.last - 1]) < least) ++b;
      if (a > from && offset(a) - offset(from) >= least) add.push_back(a);
      if (b < to && offset(to) - offset(b) >= least) add.push_back(b);
    }
    return add;
  }

  const ChainTarget& chain_;
  std::span<const RibTarget> sections_;
  const Settings& settings_;
  int most_more_;
  const WatchTries& watch_;
  std::vector<std::size_t> ribs_;   // sections that have a rib
  std::vector<RibTarget> targets_;  // of them
  std::vector<double> lines_;
  StripLayout layout_;
  Refusal said_;
  bool fitted_ = false, hopeless_ = false;
};

// Refusals, strips, ribs: fewer are better.
std::array<std::size_t, 3> cost(const StripLayout& layout) {
  std::size_t ribs = 0;
  for (const StripPlan& strip : layout.strips) ribs += strip.ribs.size();
  return {layout.refusals.size(), layout.strips.size(), ribs};
}

// Sections at the ends that are too short to be ribs of their own.
std::span<const RibTarget> without_tips(std::span<const RibTarget> sections) {
  constexpr double kLeastRibMm = 5;
  while (sections.size() > 2 && sections.front().s.back() < kLeastRibMm) sections = sections.subspan(1);
  while (sections.size() > 2 && sections.back().s.back() < kLeastRibMm)
    sections = sections.first(sections.size() - 1);
  return sections;
}

}  // namespace

StripLayout lay_out_run(const ChainTarget& chain, std::span<const RibTarget> sections,
                        const Settings& settings, std::size_t most_more, const WatchTries& watch) {
  const std::span<const RibTarget> own = without_tips(sections);
  const auto whole = complete_ribs(sections);
  if (!whole) return RunLayout(chain, own, settings, most_more, watch).run();
  StripLayout completed = RunLayout(chain, *whole, settings, most_more, watch).run();
  constexpr std::size_t kFewRibs = 10;
  if (completed.strips.size() == 1 && completed.strips[0].ribs.size() <= kFewRibs) return completed;
  StripLayout as_it_is = RunLayout(chain, own, settings, most_more, watch).run();
  return cost(as_it_is) < cost(completed) ? as_it_is : completed;
}

}  // namespace hotblade::pipeline
