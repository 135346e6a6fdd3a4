#include "pipeline/advice/remedies.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>

#include "pipeline/sayings/saying.hpp"
#include "pipeline/settings/settings_fields.hpp"

namespace hotblade::pipeline {

namespace {

using Value = nlohmann::json;

// A number that this setting would have to have for the refusal to hold, from the one it has.
using Needed = double (*)(double now, const Refusal& refusal);

enum class Demand { kLarger, kSmaller };  // which of two needed values is the more demanding

constexpr double kAny = std::numeric_limits<double>::infinity();

struct Rule {
  Limit limit;          // of the refusal
  const char* section;  // of the settings
  const char* key;
  const char* unit;
  Demand demand;
  double step;   // needed values are rounded to it, to the safe side; 0: two digits
  double reach;  // a change by more than this factor is another job, not a remedy; kAny: never
  Needed needed;
  Saying why;
};

double by_ratio(double now, const Refusal& r) {
  return now * r.value / r.bound;
}

double by_inverse_ratio(double now, const Refusal& r) {
  return now * r.bound / r.value;
}

double the_value(double, const Refusal& r) {
  return r.value;
}

// The bound of every deviation is a share of the tolerance, so the ratio holds for all of them.
const auto kRules = std::to_array<Rule>({
    {Limit::kDeviation, "design", "tolerance_mm", "mm", Demand::kLarger, 0, 10, by_ratio, Saying::kOtherRibs},
    {Limit::kRibDeviation, "design", "tolerance_mm", "mm", Demand::kLarger, 0, 10, by_ratio,
     Saying::kOtherRibs},
    {Limit::kDeviationWithSag, "design", "tolerance_mm", "mm", Demand::kLarger, 0, 10, by_ratio,
     Saying::kOtherRibs},
    {Limit::kSag, "design", "tolerance_mm", "mm", Demand::kLarger, 0, 10, by_ratio, Saying::kShareOfWeight},
    {Limit::kUncutShare, "design", "max_uncut_share", "", Demand::kLarger, 0.001, 10,
     [](double, const Refusal& r) { return 0.01 * r.value; }, Saying::kMayStayUncut},
    {Limit::kRibRadius, "blade", "thickness_mm", "mm", Demand::kSmaller, 0.01, 2, by_ratio,
     Saying::kThinnerBlade},
    {Limit::kBladeYield, "blade", "thickness_mm", "mm", Demand::kSmaller, 0.01, 2, by_ratio,
     Saying::kThinnerBlade},
    {Limit::kBendingStress, "blade", "thickness_mm", "mm", Demand::kSmaller, 0.01, 2, by_inverse_ratio,
     Saying::kThinnerBlade},
    {Limit::kSlowestFeed, "motion", "min_feed_mm_s", "mm/s", Demand::kSmaller, 0.01, 5, the_value,
     Saying::kSlowestPoint},
    {Limit::kDuration, "motion", "feed_mm_s", "mm/s", Demand::kLarger, 0.01, 5, by_ratio, Saying::kTimeOfCut},
    {Limit::kClampHeight, "machine", "plinth_mm", "mm", Demand::kLarger, 1, kAny,
     [](double now, const Refusal& r) { return now + r.bound - r.value; }, Saying::kBlockHigher},
});

// Two digits up: the smallest such number that is not below x.
double two_digits_up(double x) {
  const double step = std::pow(10.0, std::floor(std::log10(x)) - 1);
  // A hair less, so that a number of two digits stays itself.
  return step * std::ceil(x / step - 1e-9);
}

// One of the third digit of a number.
double third_digit(double x) {
  return std::pow(10.0, std::floor(std::log10(x)) - 2);
}

double rounded(double x, const Rule& rule) {
  if (rule.step == 0) return two_digits_up(x);
  const double steps = x / rule.step;
  return rule.step * (rule.demand == Demand::kLarger ? std::ceil(steps) : std::floor(steps));
}

std::string with_unit(double x, const std::string& unit) {
  return unit.empty() ? fmt::format("{:.6g}", x) : fmt::format("{:.6g} {}", x, unit);
}

class Collector {
 public:
  explicit Collector(const PlanResult& result) : settings_(to_json(result.program.settings)) {}

  void add(const Refusal& r) {
    // What is known from below only tells no number that would do; twice as much is worth a try.
    Refusal known = r;
    if (r.capped) known.value *= 2;
    add_known(known);
  }

  [[nodiscard]] std::vector<Remedy> take() { return std::move(list_); }

 private:
  void add_known(const Refusal& r) {
    if (!std::isfinite(r.value) || !std::isfinite(r.bound)) return;
    if (add_list(r)) return;
    for (const Rule& rule : kRules) {
      if (r.limit != rule.limit) continue;
      const Value* now = setting(rule.section, rule.key);
      if (now == nullptr || !now->is_number()) return;
      const double is = now->get<double>(), needed = rounded(rule.needed(is, r), rule);
      if (!std::isfinite(needed) || needed <= 0) return;
      if (std::max(needed / is, is / needed) > rule.reach) return;
      merge({fmt::format("{}.{}", rule.section, rule.key), with_unit(is, rule.unit),
             with_unit(needed, rule.unit), say(rule.why), 1, needed, is,
             rule.step == 0 ? third_digit(needed) : rule.step, rule.unit},
            rule.demand);
      return;
    }
  }

  [[nodiscard]] const Value* setting(const char* section, const char* key) const {
    const auto s = settings_.find(section);
    if (s == settings_.end() || !s->is_object()) return nullptr;
    const auto k = s->find(key);
    return k == s->end() ? nullptr : &*k;
  }

  // Settings that hold lists; true where the refusal is about one.
  bool add_list(const Refusal& r) {
    if (r.limit == Limit::kBlockEdge) {
      if (setting("stock", "max_size_mm") != nullptr)
        merge({"stock.max_size_mm", with_unit(r.bound, "mm") + " for this edge",
               with_unit(std::ceil(r.value), "mm"), say(Saying::kEdgeOfBlock), 1, std::ceil(r.value), r.bound,
               1, "mm"},
              Demand::kLarger);
      return true;
    }
    const bool length = r.limit == Limit::kRibLength, clearance = r.limit == Limit::kClampClearance;
    if (!length && !clearance) return false;
    const Value* lengths = setting("blade", "free_lengths_mm");
    if (lengths == nullptr || lengths->empty()) return true;
    // Both clamps stand off the block by their clearance; a longer blade has half of its growth on each side.
    const Value* clear = setting("stock", "clearance_mm");
    const double keep = clear == nullptr ? 0 : clear->get<double>();
    double longest = 0;
    for (const Value& x : *lengths) longest = std::max(longest, x.get<double>());
    const double least = length ? r.value + 2 * keep : longest + 2 * (r.bound - r.value);
    constexpr double kStep_mm = 50, kNarrowStep_mm = 10;
    const double needed = kStep_mm * std::ceil(std::max(least, longest + kStep_mm) / kStep_mm);
    merge({"blade.free_lengths_mm", with_unit(longest, "mm") + " at the longest", with_unit(needed, "mm"),
           say(Saying::kOneMoreLength), 1, needed, longest, kNarrowStep_mm, "mm"},
          Demand::kLarger);
    return true;
  }

  void merge(const Remedy& remedy, Demand demand) {
    const auto same = std::find_if(list_.begin(), list_.end(),
                                   [&](const Remedy& m) { return m.setting == remedy.setting; });
    if (same == list_.end()) {
      list_.push_back(remedy);
      return;
    }
    const std::size_t refusals = same->refusals + 1;
    if (demand == Demand::kLarger ? remedy.value > same->value : remedy.value < same->value) *same = remedy;
    same->refusals = refusals;
  }

  Value settings_;
  std::vector<Remedy> list_;
};

}  // namespace

Settings with_remedy(Settings settings, const Remedy& remedy) {
  for (const SettingField& field : setting_fields()) {
    if (full_key(field) != remedy.setting) continue;
    const SettingPlace place = field.place(settings);
    if (auto* const* number = std::get_if<double*>(&place)) **number = remedy.value;
    if (auto* const* edges = std::get_if<std::array<double, 3>*>(&place)) {
      for (double& edge : **edges) edge = std::max(edge, remedy.value);
    }
    if (auto* const* lengths = std::get_if<std::vector<double>*>(&place)) {
      (*lengths)->push_back(remedy.value);
      std::sort((*lengths)->begin(), (*lengths)->end());
      (*lengths)->erase(std::unique((*lengths)->begin(), (*lengths)->end()), (*lengths)->end());
    }
  }
  return settings;
}

std::string assignment_of(const Settings& settings, const Remedy& remedy) {
  Settings changed = with_remedy(settings, remedy);
  for (const SettingField& field : setting_fields()) {
    if (full_key(field) == remedy.setting)
      return remedy.setting + "=" + toml_text(field.place(changed)).value_or("");
  }
  return remedy.setting + "=" + remedy.needed;
}

std::size_t steps_between(const Remedy& remedy, double fails) {
  constexpr double kRounding = 1e-6;  // of a step
  return static_cast<std::size_t>(
      std::max(1.0, std::ceil(std::abs(remedy.value - fails) / remedy.step - kRounding)));
}

Remedy at_step(Remedy remedy, double fails, std::size_t steps) {
  const double whole = std::round(remedy.value / remedy.step) +
                       (fails < remedy.value ? -1.0 : 1.0) * static_cast<double>(steps);
  // By a power that is a whole number: 124 / 100 is the number that reads 1.24.
  remedy.value = remedy.step < 1 ? whole / std::round(1 / remedy.step) : whole * remedy.step;
  remedy.needed = with_unit(remedy.value, remedy.unit);
  return remedy;
}

std::vector<Remedy> remedies(const PlanResult& result) {
  if (result.refusals.empty()) return {};
  Collector collector(result);
  for (const Refusal& r : result.refusals) collector.add(r);
  return collector.take();
}

}  // namespace hotblade::pipeline
