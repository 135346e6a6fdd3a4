#include "pipeline/batch/cut_page.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "pipeline/batch/html_text.hpp"

namespace hotblade::pipeline::batch {
namespace {

constexpr double kHourS = 3600, kMinuteS = 60;

constexpr const char* kCutPageHead = R"(<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<style>
body{font:11pt/1.35 system-ui,sans-serif;margin:1.5em;color:#000;background:#fff}
h1{font-size:1.4em}h2{font-size:1.15em;margin:1.2em 0 .3em;break-after:avoid}
table{border-collapse:collapse}th,td{padding:.15em .7em;border-bottom:1px solid #bbb;text-align:left}
td.n,th.n{text-align:right}td.n{font-variant-numeric:tabular-nums;white-space:nowrap}
td.id{font:700 1.2em ui-monospace,monospace;white-space:nowrap}td.done{font-size:1.3em;line-height:1}
td.panel{overflow-wrap:anywhere}.amber{border:1px solid;padding:0 .3em}tr.blade th{border-top:3px solid #000;padding-top:.5em;break-after:avoid}
tr{break-inside:avoid}thead{display:table-header-group}
@page{margin:12mm}
</style>
)";

std::string sum_head(const std::string& what) {
  return "<table><thead><tr><th>" + what +
         "</th><th class=\"n\">blocks</th><th class=\"n\">foam m³</th><th class=\"n\">machine h</th>"
         "<th class=\"n\">cutting h</th></tr></thead>\n<tbody>\n";
}

std::string sum_row(const std::string& what, const BlockSum& sum) {
  return fmt::format(
      "<tr><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{:.3f}</td><td class=\"n\">{:.2f}</td>"
      "<td class=\"n\">{:.2f}</td></tr>\n",
      what, sum.blocks, sum.foam_m3, sum.machine_s / kHourS, sum.cut_s / kHourS);
}

BlockSize whole_mm(const CutBlock& block) {
  BlockSize size = block.size_mm;
  for (double& side : size) side = std::ceil(side);
  return size;
}

std::string names(const std::vector<std::string>& panels) {
  return html_text(fmt::format("{}", fmt::join(panels, ", ")));
}

std::string block_row(const CutBlock& block) {
  return fmt::format(
      "<tr><td class=\"done\">☐</td><td class=\"id\">{}</td><td class=\"panel\">{}{}</td><td>{}</td>"
      "<td class=\"n\">{}</td><td class=\"n\">{:.1f}</td></tr>\n",
      html_text(block.id), html_text(block.panel), block.amber ? " <b class=\"amber\">amber</b>" : "",
      html_text(block.strip), size_text(whole_mm(block)), block.machine_s / kMinuteS);
}

std::string order_of_cutting(const CutList& list) {
  std::string text =
      "<h2>Order of cutting</h2>\n<table><thead><tr><th>done</th><th>id</th><th>panel</th><th>strip</th>"
      "<th class=\"n\">block mm, x y z</th><th class=\"n\">min</th></tr></thead>\n";
  for (std::size_t i = 0; i < list.blocks.size(); ++i) {
    const MountedBlade& blade = list.blocks[i].blade;
    if (i == 0 || blade != list.blocks[i - 1].blade) {
      text += fmt::format(
          "{}<tbody>\n<tr class=\"blade\"><th colspan=\"6\">☐ mount blade {} mm: {} blocks</th></tr>\n",
          i == 0 ? "" : "</tbody>\n", blade_text(blade), list.blades.at(blade).blocks);
    }
    text += block_row(list.blocks[i]);
  }
  return text + (list.blocks.empty() ? "<tbody>" : "") + "</tbody></table>\n";
}

}  // namespace

std::string cut_page(const std::string& name, const CutList& list) {
  const std::string title = html_text(name) + ": cut list";
  std::string text = kCutPageHead;
  text += "<title>" + title + "</title></head>\n<body>\n<h1>" + title + "</h1>\n";
  text += fmt::format("<p>{} blocks of {} panels, {:.2f} m³ of foam, {:.2f} machine hours, {} blades.",
                      list.all.blocks, list.panels - list.not_cut, list.all.foam_m3,
                      list.all.machine_s / kHourS, list.blades.size());
  if (list.not_cut > 0)
    text += fmt::format(" <b>{} panels are not among them, as no plan passed: {}.</b>", list.not_cut,
                        names(list.not_cut_panels));
  if (!list.amber_panels.empty())
    text += fmt::format(
        " <b>{} panels are amber, their error budget over the tolerance (see their reports): {}.</b>",
        list.amber_panels.size(), names(list.amber_panels));
  text += "</p>\n<h2>Blades</h2>\n" + sum_head("free length (section) mm");
  for (const auto& [blade, sum] : list.blades) text += sum_row(blade_text(blade), sum);
  text += "</tbody></table>\n<h2>Blocks by size</h2>\n" + sum_head("mm");
  for (const auto& [size, sum] : list.sizes) text += sum_row(size_text(size), sum);
  return text + "</tbody></table>\n" + order_of_cutting(list) + "</body></html>\n";
}

}  // namespace hotblade::pipeline::batch
