#include "pipeline/batch/asked.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string_view>

#include "pipeline/batch/csv.hpp"
#include "pipeline/program/read_design.hpp"
#include "pipeline/settings/error.hpp"
#include "surface/read/design_surface.hpp"
#include "surface/read/file_format.hpp"
#include "surface/read/polygons.hpp"

namespace hotblade::pipeline::batch {
namespace {

namespace fs = std::filesystem;

// More cases than this are a slip of the keyboard.
constexpr std::size_t kMostCases = 100'000;

[[noreturn]] void fail_settings(const std::string& what) {
  throw Error(ErrorKind::kBadSettings, what);
}

// The parts of a text between commas that no bracket and no quote holds.
std::vector<std::string> parts_of(std::string_view text) {
  std::vector<std::string> parts{""};
  int depth = 0;
  char quote = 0;
  for (const char c : text) {
    if (quote != 0) {
      if (c == quote) quote = 0;
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else {
      depth += (c == '[' || c == '{') - (c == ']' || c == '}');
    }
    if (c == ',' && depth <= 0 && quote == 0) {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

// A swept key with its values, one a case; a sweep file has several keys that change together.
struct Sweep {
  std::vector<std::string> keys;
  std::vector<Case> cases;
};

Sweep sweep_of(const std::string& text) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0)
    fail_settings(fmt::format("--sweep {}: a sweep reads KEY=VALUE,VALUE,...", text));
  Sweep sweep{{text.substr(0, equals)}, {}};
  for (std::string& value : parts_of(std::string_view(text).substr(equals + 1))) {
    if (value.empty()) fail_settings(fmt::format("--sweep {}: a value is empty: leave the comma out", text));
    sweep.cases.push_back({std::move(value)});
  }
  return sweep;
}

Sweep sweep_of_file(const std::string& file) {
  const CsvTable table = read_csv(file);
  Sweep sweep{table.columns, {}};
  for (const CsvRow& row : table.rows) {
    const auto empty = std::find(row.cells.begin(), row.cells.end(), "");
    if (empty != row.cells.end()) {
      throw Error(ErrorKind::kBadInput,
                  fmt::format("{}:{}: no value for {}: a case gives one for every column", file, row.line,
                              table.columns[static_cast<std::size_t>(empty - row.cells.begin())]));
    }
    sweep.cases.push_back(row.cells);
  }
  if (sweep.cases.empty()) throw Error(ErrorKind::kBadInput, file + ":1: no cases: each line below is one");
  return sweep;
}

void add_keys(std::vector<std::string>& keys, const std::vector<std::string>& more) {
  for (const std::string& key : more) {
    if (std::find(keys.begin(), keys.end(), key) != keys.end())
      fail_settings(fmt::format("{} is swept twice: give all its values in one place", key));
    if (key == "design.group" || key == "design.units")
      fail_settings(key + " cannot be swept: a list of designs (--list) has columns `group` and `units`");
    keys.push_back(key);
  }
}

}  // namespace

nlohmann::ordered_json to_json(const Asked& asked) {
  return {{"design", asked.design},     {"list", asked.list},
          {"split", asked.split},       {"group_index", asked.group_index},
          {"units", asked.units},       {"up", asked.up},
          {"configs", asked.configs},   {"set", asked.assignments},
          {"sweeps", asked.sweeps},     {"sweep_file", asked.sweep_file},
          {"pictures", asked.pictures}, {"keep", asked.keep},
          {"gzip", asked.gzip},         {"chunk_minutes", asked.chunk_minutes}};
}

Asked asked_from(const nlohmann::ordered_json& json) {
  Asked asked;
  json.at("design").get_to(asked.design);
  json.at("list").get_to(asked.list);
  json.at("split").get_to(asked.split);
  json.at("group_index").get_to(asked.group_index);
  json.at("units").get_to(asked.units);
  json.at("up").get_to(asked.up);
  json.at("configs").get_to(asked.configs);
  json.at("set").get_to(asked.assignments);
  json.at("sweeps").get_to(asked.sweeps);
  json.at("sweep_file").get_to(asked.sweep_file);
  json.at("pictures").get_to(asked.pictures);
  json.at("keep").get_to(asked.keep);
  asked.gzip = json.value("gzip", false);  // batches of older programs do not say it
  json.at("chunk_minutes").get_to(asked.chunk_minutes);
  return asked;
}

Cases cases_of(const Asked& asked) {
  std::vector<Sweep> sweeps;
  for (const std::string& text : asked.sweeps) sweeps.push_back(sweep_of(text));
  if (!asked.sweep_file.empty()) sweeps.push_back(sweep_of_file(asked.sweep_file));
  Cases all{{}, {{}}};
  for (const Sweep& sweep : sweeps) {
    add_keys(all.keys, sweep.keys);
    std::vector<Case> more;
    if (all.list.size() * sweep.cases.size() > kMostCases)
      fail_settings(fmt::format("too many cases (more than {}): sweep fewer values", kMostCases));
    for (const Case& one : all.list) {
      for (const Case& added : sweep.cases) {
        more.push_back(one);
        more.back().insert(more.back().end(), added.begin(), added.end());
      }
    }
    all.list = std::move(more);
  }
  return all;
}

DesignList read_design_list(const std::string& file) {
  const CsvTable table = read_csv(file);
  DesignList list;
  const auto known = [](const std::string& column) {
    return column == "path" || column == "units" || column == "up" || column == "group";
  };
  std::copy_if(table.columns.begin(), table.columns.end(), std::back_inserter(list.keys),
               [&](const std::string& column) { return !known(column); });
  if (table.column("path") == table.columns.size())
    throw Error(ErrorKind::kBadInput, file + ":1: no column `path`: it names the design file of each line");
  for (const CsvRow& row : table.rows) {
    const auto cell = [&](std::string_view column) {
      const std::size_t at = table.column(column);
      return at < row.cells.size() ? row.cells[at] : std::string();
    };
    ListedDesign design{cell("path"), {}, cell("units"), cell("up"), cell("group"), {}};
    const std::string place = fmt::format("{}:{}", file, row.line);
    if (design.path.empty()) throw Error(ErrorKind::kBadInput, place + ": no path: name a design file");
    design.name = fs::path(design.path).stem().string() + (design.group.empty() ? "" : ":" + design.group);
    design.path = (fs::path(file).parent_path() / design.path).string();
    if (!design.units.empty()) design.settings.push_back({place, "design.units", design.units});
    if (!design.up.empty()) design.settings.push_back({place, "design.up", design.up});
    for (const std::string& key : list.keys) {
      if (const std::string value = cell(key); !value.empty()) design.settings.push_back({place, key, value});
    }
    list.designs.push_back(std::move(design));
  }
  if (list.designs.empty())
    throw Error(ErrorKind::kBadInput, file + ":1: no designs: each line below is one");
  return list;
}

namespace {

const GivenSetting* given_in(const ListedDesign& design, std::string_view key) {
  const auto at = std::find_if(design.settings.begin(), design.settings.end(),
                               [&](const GivenSetting& one) { return one.key == key; });
  return at != design.settings.end() ? &*at : nullptr;
}

// The format of a listed file by its own name and bytes, by its name where they do not agree, `auto` where
// they are another program's or it cannot be read: its plan says what is wrong.
std::string format_by_file(const std::string& path) {
  try {
    const std::optional<surface::FileFormat> format = surface::format_of_file(path);
    return format ? std::string(surface::name(*format)) : "auto";
  } catch (const surface::MeshError&) {
    const std::string ending = fs::path(path).extension().string();
    const auto named = surface::format_named(ending.empty() ? "" : std::string_view(ending).substr(1));
    return named ? std::string(surface::name(*named)) : "auto";
  }
}

constexpr const char* kFormatKey = "design.format";

}  // namespace

bool is_no_obj(const ListedDesign& design) {
  const GivenSetting* format = given_in(design, kFormatKey);
  return format != nullptr && format->value != "obj" && format->value != "auto";
}

DesignList listed_designs(const Asked& asked) {
  DesignList list = read_design_list(asked.list);
  const std::string of_all =
      resolve({{asked.configs.begin(), asked.configs.end()}, asked.assignments, {}}).design.format;
  for (ListedDesign& design : list.designs) {
    const GivenSetting* own = given_in(design, kFormatKey);
    std::string format = own != nullptr ? own->value : of_all;
    if (format == "auto") format = format_by_file(design.path);
    if (format == "obj" || format == "auto") continue;
    const auto add = [&](const char* key, const std::string& value) {
      std::erase_if(design.settings, [&](const GivenSetting& one) { return one.key == key; });
      design.settings.push_back({design.path, key, value});
    };
    add(kFormatKey, format);
    if (!design.group.empty()) add("design.group", design.group);
    if (format != "gltf") continue;
    // What is asked for all designs is of those that carry no unit.
    if (design.units.empty()) add("design.units", "m");
    if (design.up.empty()) add("design.up", "y");
  }
  return list;
}

Settings settings_of(const Asked& asked, const std::vector<GivenSetting>& given) {
  SettingsSources sources{{asked.configs.begin(), asked.configs.end()}, asked.assignments, {}};
  if (!asked.units.empty()) sources.flags.push_back({"--units", "design.units", asked.units});
  if (!asked.up.empty()) sources.flags.push_back({"--up", "design.up", asked.up});
  for (const GivenSetting& one : given) sources.flags.push_back({one.given, one.key, one.value});
  Settings settings = resolve(sources);
  expect_facing(settings.design);
  if (settings.design.format == "gltf")
    take_format(given.empty() ? "--list" : given.front().given, true, settings.design);
  if (settings.design.units.empty()) {
    fail_settings(
        "no unit given: an OBJ carries none: say --units mm, cm, m, in or ft, or give the list a column "
        "`units`");
  }
  return settings;
}

std::vector<NamedDesign> named_designs(const DesignList& list) {
  std::vector<NamedDesign> named;
  std::set<std::string> taken;  // a file may be called as another's second use would be
  for (const ListedDesign& design : list.designs) taken.insert(design.name);
  std::map<std::string, int> times;
  for (const ListedDesign& design : list.designs) {
    int& time = times[design.name];
    std::string name = design.name;
    if (++time > 1) {
      while (!taken.insert(name = fmt::format("{}#{}", design.name, time)).second) ++time;
    }
    named.push_back({design, std::move(name)});
  }
  return named;
}

SplitOptions split_options(const Asked& asked, SplitBy by, const std::string& units,
                           const std::string& only) {
  SplitOptions options;
  options.by = by;
  options.group_index = asked.group_index;
  options.only = only;
  options.largest_coordinate = surface::kLargestCoordinateMm / surface::scale_to_mm(units);
  options.whole_name = std::filesystem::path(asked.design).stem().string();
  return options;
}

}  // namespace hotblade::pipeline::batch
