#include "pipeline/report/strip_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>

#include "pipeline/plan/motion/clamp_margins.hpp"
#include "pipeline/report/report_plots.hpp"

namespace hotblade::pipeline {

namespace {

std::string block(const StripRow& row) {
  const Eigen::Vector3d& size = row.strip.block.size_mm;
  return fmt::format("{:.0f} x {:.0f} x {:.0f}", size.x(), size.y(), size.z());
}

std::string radius(const StripRow& row) {
  const double mm = row.facts.smallest_radius_mm();
  return mm > 0 ? fmt::format("{:.0f}", mm) : "straight";
}

// Of the stress that yield strength and safety allow.
std::string stress_share(const StripRow& row) {
  const double allowed = row.blade.yield_strength_mpa / row.blade.safety;
  return allowed > 0 ? fmt::format("{:.0f}", 100 * row.facts.motion.largest_stress_mpa / allowed) : "-";
}

std::string verdict(const StripRow& row) {
  return row.over > 0 ? fmt::format("{} over", row.over) : "ok";
}

// One figure of the facts, or of the motion's facts, with so many decimals.
template <auto member, int decimals>
std::string fixed(const StripRow& row) {
  if constexpr (std::is_same_v<decltype(member), double MotionFacts::*>) {
    return fmt::format("{:.{}f}", row.facts.motion.*member, decimals);
  } else {
    return fmt::format("{:.{}f}", row.facts.*member, decimals);
  }
}

// Before the shape is lost; farther is not looked into.
std::string clamps_may_err(const StripRow& row) {
  if (!row.facts.motion.clamps_weighed()) return "-";
  const double mm = row.facts.motion.smallest_margin_mm();
  return fmt::format("{}{:.2f}", mm >= kFarFromFoldMm ? ">= " : "", mm);
}

// The clamp coordinate whose error moves a rib most.
std::string worst_sensitivity(const StripRow& row) {
  if (!row.facts.motion.clamps_weighed()) return "-";
  double most = 0;
  std::string name;
  for (const auto& rib : row.facts.motion.rib_sensitivity_mm) {
    for (std::size_t i = 0; i < rib.size(); ++i) {
      if (!(rib[i] > most)) continue;
      most = rib[i];
      name = clamp_coordinate_name(i);
    }
  }
  std::replace(name.begin(), name.end(), '_', ' ');
  // A straight blade is moved to second order only: what first order says of it then is rounding's.
  if (!(most < row.facts.blade_length_mm)) return "straight";
  return fmt::format("{:.2f} ({})", most, name);
}

using F = StripFacts;
using M = MotionFacts;
constexpr StripTable kCut = StripTable::kCut, kBlade = StripTable::kBlade;

const auto kColumns = std::to_array<StripColumn>({
    {kCut, "ribs", "", [](const StripRow& r) { return fmt::format("{}", r.facts.ribs); }},
    {kCut, "deviation", "mm", fixed<&F::deviation_max_mm, 3>},
    {kCut, "nowhere over", "mm", fixed<&F::deviation_bound_mm, 3>},
    {kCut, "rib fit at samples", "mm", fixed<&F::worst_fit_mm, 3>},
    {kCut, "kink at seam", "deg",
     [](const StripRow& r) { return fmt::format("{:.2f}", r.facts.seam.kink_deg); }},
    {kCut, "block", "mm", block},
    {kCut, "plinth", "mm", fixed<&F::plinth_mm, 0>},
    {kCut, "foam kept", "%",
     [](const StripRow& r) { return fmt::format("{:.0f}", 100 * r.facts.foam_kept_share); }},
    {kCut, "slowest feed", "mm/s", fixed<&M::slowest_feed_mm_s, 2>},
    {kCut, "time", "", [](const StripRow& r) { return duration(r.facts.motion.duration_s); }},
    {kCut, "verdict", "", verdict},
    {kBlade, "blade", "mm", fixed<&F::blade_length_mm, 0>},
    {kBlade, "smallest radius", "mm", radius},
    {kBlade, "stability margin", "", fixed<&F::smallest_margin, 1>},
    {kBlade, "clamps may err", "mm", clamps_may_err},
    {kBlade, "0.1 mm or 1 mrad moves", "mm", worst_sensitivity},
    {kBlade, "clamp to foam", "mm", fixed<&M::smallest_clearance_mm, 1>},
    {kBlade, "end force", "N", fixed<&M::largest_force_n, 1>},
    {kBlade, "end moment", "N mm", fixed<&M::largest_moment_n_mm, 0>},
    {kBlade, "bending stress", "MPa", fixed<&M::largest_stress_mpa, 0>},
    {kBlade, "of the allowed", "%", stress_share},
    {kBlade, "droop", "mm", fixed<&M::droop_mm, 3>},
});

// The place a refusal names starts with the strip's id, if it is about a strip.
bool names(const Refusal& refusal, const std::string& id) {
  if (refusal.strip.rfind(id, 0) != 0) return false;
  return refusal.strip.size() == id.size() || refusal.strip[id.size()] == ' ';
}

// Limits that a strip is over. Of all strips that deviate too far only the farthest is refused by name.
std::size_t over(const PlanResult& result, const StripFacts& strip) {
  std::size_t count = 0;
  bool deviates = strip.deviation_bound_mm > result.program.settings.design.tolerance_mm;
  for (const Refusal& refusal : result.refusals) {
    if (!names(refusal, strip.id)) continue;
    ++count;
    if (refusal.limit == Limit::kDeviation) deviates = false;
  }
  return count + (deviates ? 1 : 0);
}

std::string table(const PlanResult& result, StripTable which, const Words& w) {
  std::string html = "<div class=\"scroll\"><table><tr><th class=\"l\">" + w("strip") + "</th>";
  for (const StripColumn& c : kColumns) {
    if (c.table == which) html += fmt::format("<th>{}<small>{}</small></th>", w(c.name), w.said(c.unit));
  }
  html += "</tr>\n";
  for (std::size_t i = 0; i < result.strips.size(); ++i) {
    const StripRow row{result.strips[i], result.program.strips[i], result.program.blade,
                       over(result, result.strips[i])};
    // Links lead to the row of the first table; the view marks both.
    html +=
        fmt::format("<tr{}{} data-strip=\"{}\"><td class=\"l\">{}</td>", row.over > 0 ? " class=\"bad\"" : "",
                    which == kCut ? fmt::format(" id=\"strip-{}\"", escaped(row.facts.id)) : "",
                    escaped(row.facts.id), escaped(row.facts.id));
    for (const StripColumn& c : kColumns) {
      if (c.table == which) html += "<td class=\"n\">" + escaped(w.said(c.cell(row))) + "</td>";
    }
    html += "</tr>\n";
  }
  return html + "</table></div>\n";
}

}  // namespace

std::span<const StripColumn> strip_columns() {
  return kColumns;
}

std::string duration(double seconds) {
  const long whole = std::lround(seconds);
  return whole < 60 ? fmt::format("{} s", whole) : fmt::format("{} min {:02} s", whole / 60, whole % 60);
}

std::string strips_section(const PlanResult& result, const Words& w) {
  if (result.strips.empty()) return "";
  const robot::BladeSet& b = result.program.blade;
  return "<h2>" + w("Strips") + "</h2>\n" + table(result, kCut, w) + "<p class=\"note\">" +
         w("Deviation: of the cut from the design within the strip; the largest of the page also counts the "
           "design from the cut. Nowhere over: what no place of the strip deviates more than, measured or "
           "not. Foam kept: the block's volume on the part's side of the blade; the rest is "
           "waste. Kink: the angle between the surfaces of neighbouring strips where they meet. Block: along "
           "the blade x towards the waste x along the sweep.") +
         "</p>\n<h2>" + w("Load on blade and clamps") + "</h2>\n" + table(result, kBlade, w) +
         "<p class=\"note\">" +
         w.format(
             "Largest of all poses. End force and moment are what a clamp has to hold. Allowed stress: "
             "{:.0f} MPa, the yield strength of {:.0f} MPa over a safety of {:g}. A stability margin of 0 "
             "is where the blade snaps into another shape.",
             b.safety > 0 ? b.yield_strength_mpa / b.safety : 0, b.yield_strength_mpa, b.safety) +
         "</p>\n";
}

}  // namespace hotblade::pipeline
