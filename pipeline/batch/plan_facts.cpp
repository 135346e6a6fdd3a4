#include "pipeline/batch/plan_facts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "pipeline/batch/mapped_file.hpp"
#include "pipeline/batch/result.hpp"
#include "pipeline/program/sha256.hpp"
#include "pipeline/settings/error.hpp"
#include "pipeline/settings/json_bytes.hpp"

namespace hotblade::pipeline::batch {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

Cell number_cell(double value) {
  return {fmt::format("{}", value), true};
}
Cell count_cell(std::size_t value) {
  return {std::to_string(value), true};
}

// The number under a key; nothing where there is none, or no number.
Cell number_at(const Json& json, const char* key) {
  const auto at = json.is_object() ? json.find(key) : json.end();
  return at != json.end() && at->is_number() ? number_cell(at->get<double>()) : Cell{};
}
Cell text_at(const Json& json, const char* key) {
  const auto at = json.is_object() ? json.find(key) : json.end();
  return at != json.end() && at->is_string() ? Cell{at->get<std::string>(), false} : Cell{};
}

// What the strips of a report add up to.
struct Sums {
  std::size_t strips = 0, ribs = 0, waypoints = 0;
  double machine_s = 0, cut_s = 0, stock_mm3 = 0, kept_mm3 = 0;
  std::optional<double> smallest_radius_mm, margin_mm;
};

void lower(std::optional<double>& least, const Json& strip, const char* key) {
  const auto at = strip.find(key);
  if (at != strip.end() && at->is_number())
    least = std::min(least.value_or(at->get<double>()), at->get<double>());
}

Sums sums_of(const Json& strips) {
  Sums sums;
  for (const Json& strip : strips) {
    ++sums.strips;
    sums.ribs += strip.value("ribs", std::size_t{0});
    sums.waypoints += strip.value("poses", std::size_t{0});
    sums.machine_s += strip.value("duration_s", 0.0);
    sums.cut_s += strip.value("cut_s", 0.0);
    const double stock_mm3 = strip.value("stock_volume_mm3", 0.0);
    sums.stock_mm3 += stock_mm3;
    sums.kept_mm3 += stock_mm3 * strip.value("foam_kept_share", 0.0);
    lower(sums.smallest_radius_mm, strip, "blade_radius_min_mm");
    lower(sums.margin_mm, strip, "margin_mm_min");
  }
  return sums;
}

Cell optional_cell(const std::optional<double>& value) {
  return value ? number_cell(*value) : Cell{};
}

Cells strip_cells(const Json& strip, const Json& blade) {
  Cells cells{text_at(strip, "id")};
  for (const char* key : {"ribs", "blade_length_mm", "deviation_max_mm", "duration_s", "cut_s"})
    cells.push_back(number_at(strip, key));
  const auto size = strip.find("stock_size_mm");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const bool there = size != strip.end() && size->is_array() && size->size() == 3;
    cells.push_back(there ? number_cell((*size)[axis].get<double>()) : Cell{});
  }
  for (const char* key : {"foam_kept_share", "blade_radius_min_mm", "margin_mm_min"})
    cells.push_back(number_at(strip, key));
  for (const char* key : {"width_mm", "thickness_mm"}) cells.push_back(number_at(blade, key));
  return cells;
}

Cells refusal_cells(const Json& refusal) {
  return {text_at(refusal, "strip"),   text_at(refusal, "rib"),     text_at(refusal, "limit"),
          number_at(refusal, "value"), number_at(refusal, "bound"), text_at(refusal, "unit"),
          text_at(refusal, "message")};
}

const Json& list_at(const Json& report, const char* key) {
  static const Json none = Json::array();
  const auto at = report.is_object() ? report.find(key) : report.end();
  return at != report.end() && at->is_array() ? *at : none;
}

// The report as it was when the result was made; none: the plan wrote none.
Json report_of(const fs::path& directory, const Result& result) {
  const auto listed = std::find_if(result.files.begin(), result.files.end(),
                                   [](const ResultFile& file) { return file.name == kReportFile; });
  if (listed == result.files.end()) return {};
  const MappedFile mapped(directory / kReportFile);
  if (sha256_hex(mapped.text()) != listed->sha256)
    throw Error(ErrorKind::kBadInput, (directory / kReportFile).string() +
                                          ": was changed, its hash is not that of result.json: remove its "
                                          "directory, and plan it again");
  return whole_json_if_any<Json>(mapped.text());
}

Cells cells_of(const Result& result, const Json& report, const std::string& page) {
  const Sums sums = sums_of(list_at(report, "strips"));
  const bool cut = sums.strips > 0;
  const Json& refusals = list_at(report, "refusals");
  const Json deviation = report.is_object() ? report.value("deviation_mm", Json::object()) : Json::object();
  const auto if_cut = [&](Cell cell) { return cut ? std::move(cell) : Cell{}; };
  return {{result.verdict, false},
          count_cell(static_cast<std::size_t>(result.exit)),
          number_at(report, "tolerance_mm"),
          if_cut(number_at(deviation, "max")),
          if_cut(number_at(deviation, "p99")),
          if_cut(number_at(report, "uncut_share")),
          count_cell(sums.strips),
          count_cell(sums.ribs),
          count_cell(sums.waypoints),
          number_cell(sums.machine_s),
          number_cell(sums.cut_s),
          number_cell(sums.stock_mm3 / kMm3PerM3),
          if_cut(sums.stock_mm3 > 0 ? number_cell(sums.kept_mm3 / sums.stock_mm3) : Cell{}),
          optional_cell(sums.smallest_radius_mm),
          optional_cell(sums.margin_mm),
          refusals.empty() ? Cell{} : text_at(refusals.front(), "limit"),
          {result.message, false},
          number_cell(result.seconds),
          number_cell(result.cpu_s),
          number_cell(result.peak_mb),
          count_cell(static_cast<std::size_t>(result.attempts)),
          {result.node, false},
          {result.version, false},
          {page, false},
          {result.color, false}};
}

std::size_t place_of(const std::vector<std::string>& columns, const std::string& name) {
  const auto at = std::find(columns.begin(), columns.end(), name);
  if (at == columns.end()) throw std::logic_error("no column " + name);
  return static_cast<std::size_t>(at - columns.begin());
}

}  // namespace

const std::vector<std::string>& plan_columns() {
  static const std::vector<std::string> columns{"verdict",
                                                "exit",
                                                "tolerance_mm",
                                                "deviation_max_mm",
                                                "p99_mm",
                                                "uncut_share",
                                                "strips",
                                                "ribs",
                                                "waypoints",
                                                "machine_s",
                                                "cut_s",
                                                "stock_m3",
                                                "foam_kept_share",
                                                "smallest_radius_mm",
                                                "margin_mm_min",
                                                "worst_refusal",
                                                "message",
                                                "plan_s",
                                                "cpu_s",
                                                "peak_mb",
                                                "attempts",
                                                "node",
                                                "version",
                                                "report",
                                                "color"};
  return columns;
}

const std::vector<std::string>& strip_columns() {
  static const std::vector<std::string> columns{"strip",
                                                "ribs",
                                                "blade_length_mm",
                                                "deviation_max_mm",
                                                "machine_s",
                                                "cut_s",
                                                "stock_x_mm",
                                                "stock_y_mm",
                                                "stock_z_mm",
                                                "foam_kept_share",
                                                "smallest_radius_mm",
                                                "margin_mm_min",
                                                "blade_width_mm",
                                                "blade_thickness_mm"};
  return columns;
}

const std::vector<std::string>& refusal_columns() {
  static const std::vector<std::string> columns{"strip", "rib",  "limit_name", "value",
                                                "bound", "unit", "message"};
  return columns;
}

const std::vector<std::string>& warning_columns() {
  static const std::vector<std::string> columns{"text"};
  return columns;
}

std::size_t plan_column(const std::string& name) {
  return place_of(plan_columns(), name);
}
std::size_t strip_column(const std::string& name) {
  return place_of(strip_columns(), name);
}

PlanFacts facts_of(const BatchDirectory& directory, const std::string& key) {
  const fs::path place = directory.result(key);
  const Result result = read_result(place);
  const Json report = report_of(place, result);
  const std::string below = place.lexically_relative(directory.path()).generic_string() + "/";
  PlanFacts facts;
  for (const ResultFile& file : result.files) {
    if (file.name == "report.html") facts.page = below + file.name;
    if (file.name == "preview.png") facts.picture = below + file.name;
  }
  try {
    facts.cells = cells_of(result, report, facts.page);
    const Json blade = report.is_object()
                           ? report.value(Json::json_pointer("/settings/blade"), Json::object())
                           : Json::object();
    for (const Json& strip : list_at(report, "strips")) facts.strips.push_back(strip_cells(strip, blade));
    for (const Json& refusal : list_at(report, "refusals")) facts.refusals.push_back(refusal_cells(refusal));
    for (const Json& warning : list_at(report, "warnings")) {
      if (warning.is_string()) facts.warnings.push_back({{warning.get<std::string>(), false}});
    }
  } catch (const Json::exception& error) {
    throw Error(ErrorKind::kBadInput,
                (place / "report.json").string() + ": is no report (" + error.what() + ")");
  }
  return facts;
}

PlanFacts facts_of_failure(const Failure* failure) {
  PlanFacts facts{Cells(plan_columns().size()), {}, {}, {}, {}, {}};
  facts.cells[plan_column("verdict")].text = failure != nullptr ? "failed" : "missing";
  if (failure == nullptr) return facts;
  facts.cells[plan_column("attempts")] = count_cell(static_cast<std::size_t>(failure->attempts));
  const std::string said = failure->last_lines.empty() ? "" : ": " + failure->last_lines.back();
  facts.cells[plan_column("message")].text = failure->why + said;
  return facts;
}

}  // namespace hotblade::pipeline::batch
