#include "pipeline/report/places_table.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "pipeline/report/report_plots.hpp"

namespace hotblade::pipeline {

Eigen::Vector3d middle_of(const Block& block) {
  return 0.5 * (block.corners()[0] + block.corners()[7]);
}

std::string place_text(const Eigen::Vector3d& mm) {
  // Adding zero takes the sign off a zero.
  const Eigen::Vector3d whole = mm.array().round().matrix() + Eigen::Vector3d::Zero();
  return fmt::format("{:.0f}, {:.0f}, {:.0f}", whole.x(), whole.y(), whole.z());
}

std::string size_text(const Eigen::Vector3d& mm) {
  return fmt::format("{:.0f} x {:.0f} x {:.0f}", mm.x(), mm.y(), mm.z());
}

std::string corner_text(const BlockStand& stand, const Words& w) {
  std::string text = place_text(stand.corner);
  if (stand.turned_rad == 0) return text;
  return text + fmt::format(", {} {:.1f}°, {}", w("turned about it by"),
                            std::abs(stand.turned_rad) * 180 / std::numbers::pi,
                            w(stand.turned_rad > 0 ? "counter-clockwise as seen from above"
                                                   : "clockwise as seen from above"));
}

std::string places_section(const PlanResult& result, const Words& w, bool with_sheets) {
  if (result.strips.empty()) return "";
  std::string html = "<h2>" + w("Which block goes where") +
                     "</h2><div class=\"scroll\"><table><tr><th class=\"l\">" + w("block") + "</th>";
  for (const char* column : {"its middle in the design x, y, z", "block as it stands, width x depth x height",
                             "its left front lower corner on the table x, y, z"})
    html += "<th>" + w(column) + "<small>mm</small></th>";
  if (with_sheets) html += "<th>" + w("Sheet") + "<small></small></th>";
  html += "</tr>\n";
  for (const Strip& strip : result.program.strips) {
    const BlockStand stand = stand_of(strip);
    const std::string id = escaped(strip.id);
    html += fmt::format(
        "<tr data-strip=\"{0}\"><td class=\"l\">{0}</td><td class=\"n\">{1}</td><td class=\"n\">{2}</td><td "
        "class=\"n\">{3}</td>",
        id, place_text(middle_of(strip.block)), size_text(stand.box.sizes()), corner_text(stand, w));
    if (with_sheets)
      html += fmt::format("<td><a id=\"sheet-{0}\" href=\"sheets.html#sheet-{0}\">{0}</a></td>", id);
    html += "</tr>\n";
  }
  return html + "</table></div>\n<p class=\"note\">" +
         w("Axes of a block size: width along the blade, depth towards the back of the table, height along "
           "the "
           "cut.") +
         "</p>\n";
}

}  // namespace hotblade::pipeline
