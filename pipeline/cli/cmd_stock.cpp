// hotblade stock list: the foam, the blades and the order of cutting of a whole batch.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "pipeline/batch/gather.hpp"
#include "pipeline/cli/batch_commands.hpp"
#include "pipeline/settings/json_text.hpp"

namespace hotblade::pipeline {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double kHourS = 3600;
constexpr double kLeastStepMm = 0.1, kMostStepMm = 1000;

struct StockArguments {
  std::string directory;
  double step_mm = 1;
  bool partial = false, as_json = false;
};

std::string sum_text(const std::string& what, const batch::BlockSum& sum) {
  return fmt::format("  {:24} {:6} {:10.3f} {:10.2f} {:10.2f}\n", what, sum.blocks, sum.foam_m3,
                     sum.machine_s / kHourS, sum.cut_s / kHourS);
}

// `: p1, p2, and 7 more`; empty for none.
std::string named(const std::vector<std::string>& panels) {
  constexpr std::size_t kMostNames = 20;
  if (panels.empty()) return "";
  const std::size_t shown = std::min(panels.size(), kMostNames);
  return fmt::format(": {}{}",
                     fmt::join(panels.begin(), panels.begin() + static_cast<std::ptrdiff_t>(shown), ", "),
                     panels.size() > shown ? fmt::format(", and {} more", panels.size() - shown) : "");
}

std::vector<std::string> ids_of(const std::vector<std::size_t>& blocks, const batch::CutList& list) {
  std::vector<std::string> ids;
  for (const std::size_t block : blocks) ids.push_back(list.blocks[block].id);
  return ids;
}

std::string table(const batch::StockReport& report, const fs::path& directory) {
  const batch::CutList& list = report.list;
  std::string text = fmt::format("panels {}, without a plan that passed {}{}\n", list.panels, list.not_cut,
                                 named(list.not_cut_panels));
  if (!list.amber_panels.empty())
    text += fmt::format("panels that are amber {}{}\n", list.amber_panels.size(), named(list.amber_panels));
  text += fmt::format("blocks {}, foam {:.3f} m3, machine {:.2f} h, blades {}\n", list.all.blocks,
                      list.all.foam_m3, list.all.machine_s / kHourS, list.blades.size());
  const auto heading = [&](const std::string& what) {
    text += fmt::format("{:26} {:>6} {:>10} {:>10} {:>10}\n", what, "blocks", "foam m3", "machine h",
                        "cutting h");
  };
  heading("blades: length (section)");
  for (const auto& [blade, sum] : list.blades)
    text +=
        sum_text(fmt::format("{:g} ({:g} x {:g})", blade.length_mm, blade.width_mm, blade.thickness_mm), sum);
  heading("blocks by size, mm");
  for (const auto& [size, sum] : list.sizes)
    text += sum_text(fmt::format("{:g} x {:g} x {:g}", size[0], size[1], size[2]), sum);
  const batch::FoamList& foam = report.foam;
  if (!foam.bought.empty()) {
    text += fmt::format(
        "foam to buy: {} blocks, {:.3f} m3 ({:.3f} with each panel nested alone, {:.3f} with a piece for "
        "each)\n",
        foam.bought.size(), foam.bought_m3, foam.by_panel_m3, foam.each_m3);
    for (const auto& [size, count] : foam.sizes)
      text +=
          fmt::format("  {:24} {:6}\n", fmt::format("{:g} x {:g} x {:g}", size[0], size[1], size[2]), count);
  }
  if (!foam.too_large.empty())
    text += fmt::format("blocks that no size of stock.sizes_mm holds: {}{}\n", foam.too_large.size(),
                        named(ids_of(foam.too_large, list)));
  if (!foam.empty() && !foam.unsaid.empty())
    text += fmt::format("blocks not among these, as their settings have no stock.sizes_mm: {}{}\n",
                        foam.unsaid.size(), named(ids_of(foam.unsaid, list)));
  if (!foam.empty()) text += fmt::format("sawing {}\n", (directory / "foam.html").string());
  return text + fmt::format("order of cutting {}\npage to print {}\n", (directory / "cut_list.csv").string(),
                            (directory / "cut_list.html").string());
}

Json sum_json(const batch::BlockSum& sum) {
  return {
      {"blocks", sum.blocks}, {"foam_m3", sum.foam_m3}, {"machine_s", sum.machine_s}, {"cut_s", sum.cut_s}};
}

Json foam_json(const batch::FoamList& foam, const batch::CutList& list) {
  Json buy = Json::array();
  for (const auto& [size, count] : foam.sizes) buy.push_back({{"size_mm", size}, {"blocks", count}});
  return {{"bought_m3", foam.bought_m3},
          {"pieces_m3", foam.pieces_m3},
          {"by_panel_m3", foam.by_panel_m3},
          {"each_m3", foam.each_m3},
          {"buy", std::move(buy)},
          {"too_large", ids_of(foam.too_large, list)},
          {"unsaid", ids_of(foam.unsaid, list)}};
}

std::string stock_json(const batch::StockReport& report) {
  const batch::CutList& list = report.list;
  Json blades = Json::array(), sizes = Json::array();
  for (const auto& [blade, sum] : list.blades) {
    Json one{
        {"width_mm", blade.width_mm}, {"thickness_mm", blade.thickness_mm}, {"length_mm", blade.length_mm}};
    one.update(sum_json(sum));
    blades.push_back(std::move(one));
  }
  for (const auto& [size, sum] : list.sizes) {
    Json one{{"size_mm", size}};
    one.update(sum_json(sum));
    sizes.push_back(std::move(one));
  }
  Json json{{"panels", list.panels},       {"not_cut", list.not_cut},     {"missing", report.missing},
            {"total", sum_json(list.all)}, {"blades", std::move(blades)}, {"sizes", std::move(sizes)}};
  json["not_cut_panels"] = list.not_cut_panels;
  json["amber_panels"] = list.amber_panels;
  if (!report.foam.empty()) json["foam"] = foam_json(report.foam, list);
  return json_text(json, 2) + "\n";
}

Exit list_stock_of(const StockArguments& arguments, const Console& console) {
  batch::GatherHooks hooks;
  hooks.progress = [&console](double share) { console.report_progress("stock", share); };
  hooks.stop = [] { return interrupted(); };
  const batch::StockReport report = batch::list_stock(batch::BatchDirectory(arguments.directory),
                                                      arguments.partial, arguments.step_mm, hooks);
  console.end_progress();
  std::cout << (arguments.as_json ? stock_json(report) : table(report, arguments.directory));
  return Exit::kOk;
}

}  // namespace

void add_stock(CLI::App& app, const Console& console, Action& action) {
  auto arguments = std::make_shared<StockArguments>();
  auto* stock = app.add_subcommand("stock", "Foam and blades of a batch");
  stock->require_subcommand(1);
  stock->footer("Example: hotblade stock list facade");
  auto* list =
      stock->add_subcommand("list", "Say what foam and blades a batch takes, and in which order it is cut");
  add_batch_directory(*list, arguments->directory);
  list->add_option("--step-mm", arguments->step_mm, "Count blocks by sizes up to the next whole step")
      ->check(CLI::Range(kLeastStepMm, kMostStepMm))
      ->type_name("MM");
  list->add_flag("--partial", arguments->partial, "Also while jobs are without a result");
  list->add_flag("--json", arguments->as_json, "Print JSON instead of tables");
  list->footer(
      "Writes cut_list.csv and cut_list.html, as `batch gather` does, and foam.csv and foam.html where the "
      "settings have stock.sizes_mm.\n"
      "Example: hotblade stock list facade --step-mm 50");
  list->callback([arguments, &console, &action] {
    action = [arguments, &console] { return list_stock_of(*arguments, console); };
  });
}

}  // namespace hotblade::pipeline
