#include "pipeline/report/arms_section.hpp"

#include <fmt/format.h>

#include "pipeline/report/report_plots.hpp"
#include "robot/arm/arm.hpp"
#include "robot/arm/clearance.hpp"

namespace hotblade::pipeline {
namespace {

using robot::kDegree_rad;

std::string cell(const std::string& text) {
  return "<td>" + escaped(text) + "</td>";
}

std::string row(const Strip& strip, const Words& w) {
  const StripArms& arms = *strip.arms;
  std::string nearest;
  for (const StripArms::NearestPair& pair : arms.nearest_mm)
    nearest += fmt::format("{}{} {:.0f} mm", nearest.empty() ? "" : ", ",
                           w.said(robot::pair_words(pair.kind)), pair.mm);
  // The view in three dimensions shows what stands in a strip's rows on its card.
  return "<tr data-strip=\"" + escaped(strip.id) + "\"><td class=\"l\">" + escaped(strip.id) + "</td>" +
         cell(arms.a.arm) + cell(arms.b.arm) +
         cell(arms.dx_mm == 0 && arms.dy_mm == 0 && arms.yaw_rad == 0
                  ? fmt::format("{:.0f}", arms.raise_mm)
                  : fmt::format("{:.0f}; {:.0f}, {:.0f}; {:.0f}\u00b0", arms.raise_mm, arms.dx_mm, arms.dy_mm,
                                arms.yaw_rad / kDegree_rad)) +
         cell(arms.reach ? fmt::format("{:.0f} % {}", 100 * arms.reach->value, arms.reach->arm) : "") +
         cell(fmt::format("{:.1f}\u00b0 {} J{}", arms.joint_margin_rad.value / kDegree_rad,
                          arms.joint_margin_rad.arm, arms.joint_margin_rad.joint)) +
         cell(fmt::format("{:.1f}\u00b0 {}", arms.wrist_rad.value / kDegree_rad, arms.wrist_rad.arm)) +
         cell(fmt::format("{:.1f}", arms.joints_s + arms.jerk_s)) + "<td class=\"l\">" + escaped(nearest) +
         "</td></tr>\n";
}

}  // namespace

std::string arms_section(const PlanResult& result, const Words& w) {
  const Program& program = result.program;
  if (!program.cell) return "";
  std::string html = "<h2>" + w("Arms") + "</h2><p>" + escaped(program.cell->name) + ". " +
                     w("Reach is the farthest wrist's, of what its arm reaches; least distances in mm.") +
                     "</p>\n<div class=\"scroll\"><table><tr><th class=\"l\">" + w("strip") + "</th>";
  for (const char* head : {"clamp A", "clamp B", "raised, mm", "reach", "joint margin", "wrist", "added, s"})
    html += "<th>" + w(head) + "<small></small></th>";
  html += "<th class=\"l\">" + w("nearest") + "<small></small></th></tr>\n";
  for (const Strip& strip : program.strips) {
    if (strip.arms) html += row(strip, w);
  }
  return html + "</table></div>\n";
}

}  // namespace hotblade::pipeline
