#include "pipeline/batch/foam_list.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <utility>

#include "pipeline/batch/csv.hpp"
#include "pipeline/batch/html_text.hpp"

namespace hotblade::pipeline::batch {
namespace {

double volume_m3(const BoxSize& size_mm) {
  return size_mm[0] * size_mm[1] * size_mm[2] / kMm3PerM3;
}

// These blocks of the list, nested together.
Nesting nested(const CutList& list, const SoldFoam& sold, std::span<const std::size_t> blocks,
               const std::function<void()>& watch) {
  std::vector<BoxSize> sizes;
  for (const std::size_t b : blocks) sizes.push_back(list.blocks[b].size_mm);
  Nesting nesting = nest(sizes, sold.sizes_mm, sold.saw_mm, watch);
  for (BoughtBlock& bought : nesting.blocks)
    for (NestedPiece& piece : bought.pieces) piece.piece = blocks[piece.piece];
  return nesting;
}

std::size_t first_cut(const BoughtBlock& bought) {
  std::size_t first = bought.pieces.front().piece;
  for (const NestedPiece& piece : bought.pieces) first = std::min(first, piece.piece);
  return first;
}

// Foam for blocks that are cut from the same, in the order of cutting.
void add_foam(const CutList& list, const SoldFoam& sold, const std::vector<std::size_t>& blocks,
              const std::function<void()>& watch, FoamList& foam) {
  for (std::size_t from = 0; from < blocks.size(); from += kLotBlocks) {
    const auto lot = std::span(blocks).subspan(from, std::min(kLotBlocks, blocks.size() - from));
    Nesting nesting = nested(list, sold, lot, watch);
    for (BoughtBlock& bought : nesting.blocks) {
      foam.bought_m3 += volume_m3(bought.size);
      BlockSize size = bought.size;
      std::sort(size.begin(), size.end(), std::greater<>());
      ++foam.sizes[size];
      foam.bought.push_back({std::move(bought), sold.saw_mm});
    }
  }
  std::map<std::string, std::vector<std::size_t>> of_panel;
  for (const std::size_t b : blocks) {
    foam.pieces_m3 += list.blocks[b].volume_m3();
    of_panel[list.blocks[b].panel].push_back(b);
  }
  for (const auto& [panel, own] : of_panel) {
    const Nesting alone = nested(list, sold, own, watch);
    foam.by_panel_m3 += alone.bought_mm3 / kMm3PerM3;
    foam.each_m3 += alone.apart_mm3 / kMm3PerM3;
  }
}

std::string mm_text(double mm) {
  return fmt::format("{:.1f}", mm);
}

std::string box_text(const StockBox& box) {
  return fmt::format("{:.0f} × {:.0f} × {:.0f}", box.size[0], box.size[1], box.size[2]);
}

std::string place_text(const StockBox& box) {
  return fmt::format("{:.0f}, {:.0f}, {:.0f}", box.at[0], box.at[1], box.at[2]);
}

constexpr const char* kFoamPageHead = R"(<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<style>
body{font:11pt/1.35 system-ui,sans-serif;margin:1.5em;color:#000;background:#fff}
h1{font-size:1.4em}h2{font-size:1.15em;margin:1.2em 0 .3em;break-after:avoid}
table{border-collapse:collapse;margin:.3em 0}th,td{padding:.15em .7em;border-bottom:1px solid #bbb;text-align:left}
td.n,th.n{text-align:right;font-variant-numeric:tabular-nums;white-space:nowrap}
td.id{font:700 1.2em ui-monospace,monospace;white-space:nowrap}td.done{font-size:1.3em;line-height:1}
tr{break-inside:avoid}thead{display:table-header-group}
@page{margin:12mm}
</style>
)";

std::string to_buy(const FoamList& foam) {
  std::string text =
      "<h2>To buy</h2>\n<table><thead><tr><th>mm</th><th class=\"n\">blocks</th><th class=\"n\">m³</th></tr>"
      "</thead>\n<tbody>\n";
  for (const auto& [size, count] : foam.sizes)
    text += fmt::format("<tr><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{:.3f}</td></tr>\n",
                        size_text(size), count, static_cast<double>(count) * volume_m3(size));
  return text + "</tbody></table>\n";
}

// The cuts in order. Parts are named as they come, as on the sheet of a plan's report.
std::string cuts_text(const BoughtBlock& block) {
  constexpr std::array<const char*, 3> kEdges{"length", "width", "height"};
  std::string text =
      "<table><thead><tr><th>done</th><th>part</th><th>square to its</th><th class=\"n\">at mm</th><th>gives "
      "mm</th></tr></thead>\n<tbody>\n";
  std::size_t parts = 1;
  for (const SawCut& cut : block.cuts) {
    const auto axis = static_cast<std::size_t>(cut.axis);
    StockBox near = cut.of;
    near.size[axis] = cut.at;
    std::string gives = part_name(cut.part) + " " + box_text(near);
    if (cut.leaves()) gives += ", " + part_name(parts++) + " " + box_text(cut.off);
    text += fmt::format(
        "<tr><td class=\"done\">☐</td><td class=\"id\">{}</td><td>{}</td><td "
        "class=\"n\">{}</td><td>{}</td></tr>\n",
        part_name(cut.part), kEdges.at(axis), mm_text(cut.at), gives);
  }
  return text + "</tbody></table>\n";
}

// One bought block: its cuts, and what it is sawn into.
std::string bought_text(std::size_t number, const BoughtFoam& bought, const CutList& list) {
  std::string text =
      fmt::format("<h2>Foam {}: {} mm</h2>\n", number, box_text({{0, 0, 0}, bought.block.size}));
  if (!bought.block.cuts.empty()) text += cuts_text(bought.block);
  text +=
      "<table><thead><tr><th>part</th><th>id</th><th>panel</th><th>strip</th><th>at x, y, "
      "z</th><th>mm</th></tr>"
      "</thead>\n<tbody>\n";
  for (const NestedPiece& piece : bought.block.pieces) {
    const CutBlock& block = list.blocks[piece.piece];
    text += fmt::format(
        "<tr><td class=\"id\">{}</td><td "
        "class=\"id\">{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
        part_name(piece.part), html_text(block.id), html_text(block.panel), html_text(block.strip),
        place_text(piece.box), box_text(piece.box));
  }
  return text + "</tbody></table>\n";
}

}  // namespace

FoamList foam_list(const CutList& list, const std::function<SoldFoam(std::size_t)>& sold_for,
                   const std::function<void()>& watch) {
  FoamList foam;
  std::map<SoldFoam, std::vector<std::size_t>> alike;
  for (std::size_t b = 0; b < list.blocks.size(); ++b) {
    const SoldFoam sold = sold_for(list.blocks[b].job);
    if (sold.sizes_mm.empty()) {
      foam.unsaid.push_back(b);
      continue;
    }
    const bool held = std::any_of(sold.sizes_mm.begin(), sold.sizes_mm.end(),
                                  [&](const BoxSize& size) { return holds(size, list.blocks[b].size_mm); });
    if (held) {
      alike[sold].push_back(b);
    } else {
      foam.too_large.push_back(b);
    }
  }
  for (const auto& [sold, blocks] : alike) add_foam(list, sold, blocks, watch, foam);
  std::stable_sort(foam.bought.begin(), foam.bought.end(), [](const BoughtFoam& a, const BoughtFoam& b) {
    return first_cut(a.block) < first_cut(b.block);
  });
  return foam;
}

std::string foam_table(const FoamList& foam, const CutList& list) {
  std::string text = csv_line({"foam", "foam_x_mm", "foam_y_mm", "foam_z_mm", "id", "job", "panel", "strip",
                               "at_x_mm", "at_y_mm", "at_z_mm", "x_mm", "y_mm", "z_mm"});
  for (std::size_t i = 0; i < foam.bought.size(); ++i) {
    const BoughtBlock& bought = foam.bought[i].block;
    for (const NestedPiece& piece : bought.pieces) {
      const CutBlock& block = list.blocks[piece.piece];
      std::vector<std::string> cells{std::to_string(i + 1)};
      for (const double mm : bought.size) cells.push_back(mm_text(mm));
      for (const std::string& word : {block.id, std::to_string(block.job), block.panel, block.strip})
        cells.push_back(word);
      for (const double mm : piece.box.at) cells.push_back(mm_text(mm));
      for (const double mm : piece.box.size) cells.push_back(mm_text(mm));
      text += csv_line(cells);
    }
  }
  return text;
}

std::string foam_page(const std::string& batch, const FoamList& foam, const CutList& list) {
  const std::string title = html_text(batch) + ": foam to buy";
  std::string text = kFoamPageHead;
  text += "<title>" + title + "</title></head>\n<body>\n<h1>" + title + "</h1>\n";
  text += fmt::format(
      "<p>{:.3f} m³ in {} blocks, for {:.3f} m³ of panels' blocks; {:.3f} m³ with each panel's nested alone, "
      "{:.3f} m³ with a piece of foam for each. Every cut goes from face to face of its part, square to the "
      "edge "
      "named; it is measured from the end that keeps the part's letter, to the saw's near side. Places are "
      "from "
      "the foam's one corner, x along its length. Mark every piece with its id.</p>\n",
      foam.bought_m3, foam.bought.size(), foam.pieces_m3, foam.by_panel_m3, foam.each_m3);
  const auto name = [&](const char* what, const std::vector<std::size_t>& blocks) {
    if (blocks.empty()) return;
    text += fmt::format("<p><b>{}:", what);
    for (const std::size_t b : blocks) text += " " + html_text(list.blocks[b].id);
    text += "</b></p>\n";
  };
  name("No size that is sold holds", foam.too_large);
  name("Not among these, as their settings say no size that is sold", foam.unsaid);
  text += to_buy(foam);
  for (std::size_t i = 0; i < foam.bought.size(); ++i) text += bought_text(i + 1, foam.bought[i], list);
  return text + "</body></html>\n";
}

}  // namespace hotblade::pipeline::batch
