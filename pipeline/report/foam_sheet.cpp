#include "pipeline/report/foam_sheet.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <map>
#include <vector>

#include "pipeline/report/report_plots.hpp"

namespace hotblade::pipeline {

namespace {

std::string edges_text(const BoxSize& mm) {
  return fmt::format("{:.0f} x {:.0f} x {:.0f}", mm[0], mm[1], mm[2]);
}

// Seen from above, the length to the right, the width to the back, the height up.
Eigen::Vector2d on_paper(const BoxSize& p) {
  constexpr double kBack = 0.35;
  return {p[0] + kBack * p[1], -p[2] - 0.6 * kBack * p[1]};
}

std::string box_outline(const StockBox& box, double scale, const Eigen::Vector2d& origin, const char* style) {
  const auto corner = [&](int i, int j, int k) {
    const BoxSize p{box.at[0] + i * box.size[0], box.at[1] + j * box.size[1], box.at[2] + k * box.size[2]};
    const Eigen::Vector2d q = origin + scale * on_paper(p);
    return fmt::format("{:.1f},{:.1f} ", q.x(), q.y());
  };
  const auto face = [&](const std::string& points) {
    return "<polygon points=\"" + points + "\" " + style + "/>";
  };
  return face(corner(0, 0, 1) + corner(1, 0, 1) + corner(1, 1, 1) + corner(0, 1, 1)) +
         face(corner(1, 0, 0) + corner(1, 1, 0) + corner(1, 1, 1) + corner(1, 0, 1)) +
         face(corner(0, 0, 0) + corner(1, 0, 0) + corner(1, 0, 1) + corner(0, 0, 1));
}

// The stock as dashed edges, its pieces in it from the back to the front.
std::string foam_picture(const BoughtBlock& block, const Program& program) {
  constexpr double kWidth = 330, kMargin = 6;
  const Eigen::Vector2d far = on_paper(block.size);
  const double scale = (kWidth - 2 * kMargin) / far.x();
  const double height = -scale * far.y() + 2 * kMargin;
  const Eigen::Vector2d origin(kMargin, height - kMargin);
  std::vector<const NestedPiece*> pieces;
  for (const NestedPiece& p : block.pieces) pieces.push_back(&p);
  // Pieces do not touch: what begins behind the end of another is drawn before it.
  std::stable_sort(pieces.begin(), pieces.end(), [](const NestedPiece* a, const NestedPiece* b) {
    const auto depth = [](const NestedPiece& p) { return p.box.at[1] - p.box.at[0] - p.box.at[2]; };
    return depth(*a) > depth(*b);
  });
  std::string svg = fmt::format("<svg viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\">", kWidth, height);
  svg += box_outline({{0, 0, 0}, block.size}, scale, origin,
                     "fill=\"none\" stroke=\"#9aa4ad\" stroke-dasharray=\"4 3\"");
  for (const NestedPiece* p : pieces) {
    svg += box_outline(p->box, scale, origin, "fill=\"#e8eef3\" fill-opacity=\"0.85\" stroke=\"#22262b\"");
    const BoxSize middle{p->box.at[0] + 0.5 * p->box.size[0], p->box.at[1],
                         p->box.at[2] + 0.5 * p->box.size[2]};
    const Eigen::Vector2d q = origin + scale * on_paper(middle);
    svg += fmt::format(
        "<text x=\"{:.1f}\" y=\"{:.1f}\" font-size=\"13\" font-weight=\"700\" "
        "text-anchor=\"middle\">{}</text>",
        q.x(), q.y() + 4, escaped(program.strips[p->piece].id));
  }
  return svg + "</svg>";
}

std::string cuts_table(const BoughtBlock& block, const Program& program, const Words& w) {
  static constexpr std::array kAxes{"length", "width", "height"};
  std::string rows;
  std::size_t parts = 1;
  for (std::size_t i = 0; i < block.cuts.size(); ++i) {
    const SawCut& cut = block.cuts[i];
    const auto axis = static_cast<std::size_t>(cut.axis);
    BoxSize near = cut.of.size;
    near[axis] = cut.at;
    std::string gives = part_name(cut.part) + " " + edges_text(near);
    if (cut.leaves()) gives += ", " + part_name(parts++) + " " + edges_text(cut.off.size);
    rows += fmt::format(
        "<tr><td>{}</td><td class=\"l\"><b>{}</b></td><td class=\"l\">{}</td><td>{:.1f}</td><td "
        "class=\"l\">{}</td></tr>\n",
        i + 1, part_name(cut.part), w(kAxes.at(axis)), cut.at, gives);
  }
  std::string are;
  for (const NestedPiece& p : block.pieces) {
    are += (are.empty() ? "" : ", ") + part_name(p.part) + " = <b>" + escaped(program.strips[p.piece].id) +
           "</b>";
  }
  std::string table;
  if (!rows.empty())
    table = "<table><thead><tr><th>" + w("cut") + "</th><th class=\"l\">" + w("part") +
            "</th><th class=\"l\">" + w("square to its") + "</th><th>" + w("at") +
            "<small>mm</small></th><th class=\"l\">" + w("gives") + "<small>mm</small></th></tr></thead>\n" +
            rows + "</table>\n";
  return table + "<p>" + are + "</p>\n";
}

}  // namespace

std::string foam_section(const Nesting& nesting, const Program& program, const Words& w) {
  std::map<BoxSize, std::size_t, std::greater<>> sizes;
  for (const BoughtBlock& block : nesting.blocks) ++sizes[block.size];
  std::string buy;
  for (const auto& [size, number] : sizes)
    buy += (buy.empty() ? "" : ", ") + fmt::format("{} x ({})", number, edges_text(size));
  std::string html = fmt::format(
      "<p class=\"sums\"><span>{} <b>{} mm</b></span><span>{} <b>{:.1f} l</b></span><span>{} <b>{:.0f} "
      "%</b></span>"
      "</p>\n",
      w("To buy"), buy, w("Foam"), 1e-6 * nesting.bought_mm3, w("used"),
      100 * nesting.pieces_mm3 / nesting.bought_mm3);
  html += "<p class=\"note\">" +
          w("Every cut goes from face to face of its part, square to the edge named; it is measured from the "
            "end that keeps the part's letter, to the saw's near side.") +
          "</p>\n";
  for (std::size_t i = 0; i < nesting.blocks.size(); ++i) {
    const BoughtBlock& block = nesting.blocks[i];
    html += fmt::format(
        "<div class=\"bought\"><h2>{} {}: {} mm</h2><div "
        "class=\"pictures\"><div>{}</div><div>{}</div></div></div>\n",
        w("Foam"), i + 1, edges_text(block.size), cuts_table(block, program, w),
        foam_picture(block, program));
  }
  return html;
}

}  // namespace hotblade::pipeline
