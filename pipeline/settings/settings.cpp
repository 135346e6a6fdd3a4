#include "pipeline/settings/settings.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <sstream>
#include <string_view>
#include <type_traits>

#include "pipeline/settings/assignments.hpp"
#include "pipeline/settings/edit_distance.hpp"
#include "pipeline/settings/error.hpp"
#include "pipeline/settings/json_text.hpp"
#include "pipeline/settings/settings_fields.hpp"

namespace hotblade::pipeline {
namespace {

// More blade lengths than this are a slip of the pen, and the plan tries each.
constexpr std::size_t kMaxLengths = 100;
// Direction components are rounded to doubles by hand; a vector below this is meant as zero.
constexpr double kMinDirection = 1e-3;

// Where a key's value came from, "job.toml:12", "--set" or "--units"; keys at their default are not in here.
using Origins = std::map<std::string, std::string>;

[[noreturn]] void fail(const std::string& where, const std::string& what) {
  throw Error(ErrorKind::kBadSettings, where + ": " + what);
}

[[noreturn]] void fail_key(const Origins& origins, const std::string& key, const std::string& what) {
  const auto origin = origins.find(key);
  fail(origin == origins.end() ? "settings" : origin->second, key + " " + what);
}

// ---- did you mean ----

// The hint for an unknown "section.key": the nearest known key, in its own section or in another.
std::string key_hint(const std::string& section, const std::string& key) {
  std::string nearest;
  std::size_t best = std::max<std::size_t>(2, key.size() / 3) + 1;
  for (const SettingField& field : setting_fields()) {
    // A key cut short ("kerf") is near; the same distance in the section asked for counts for more.
    const bool cut_short = !key.empty() && field.key.starts_with(key);
    const std::size_t edits = cut_short ? 1 : edit_distance(key, field.key);
    const std::size_t distance = 2 * edits + (field.section == section ? 0 : 1);
    if (distance < 2 * best) {
      best = (distance + 1) / 2;
      nearest = full_key(field);
    }
  }
  return nearest.empty() ? "`hotblade config defaults` lists every key" : "did you mean " + nearest + "?";
}

std::string section_hint(const std::string& section) {
  std::string nearest, all;
  std::size_t best = std::max<std::size_t>(2, section.size() / 3) + 1;
  for (const SettingField& field : setting_fields()) {
    const std::string name(field.section);
    if (all.find(name) == std::string::npos) all += (all.empty() ? "" : ", ") + name;
    const std::size_t distance = edit_distance(section, name);
    if (distance < best) {
      best = distance;
      nearest = name;
    }
  }
  return nearest.empty() ? "sections are " + all : "did you mean [" + nearest + "]?";
}

// ---- reading values ----

std::string unknown_word(const SettingField& field, const std::string& word) {
  const bool several = choices(field).size() > 1;
  return "(\"" + word + "\", must be " + (several ? "one of " : "") + range_text(field) + ")";
}

std::string type_name(const toml::node& node) {
  std::ostringstream text;
  text << node.type();
  return text.str();
}

struct Reader {
  const toml::node& node;
  const SettingField& field;
  const std::string& where;

  [[noreturn]] void wrong_type(const std::string& wanted) const {
    fail(where, full_key(field) + " (" + type_name(node) + ", must be " + wanted + ")");
  }

  double number(const toml::node& n, const std::string& wanted) const {
    if (const auto integer = n.value_exact<std::int64_t>()) return static_cast<double>(*integer);
    if (const auto real = n.value_exact<double>()) return *real;
    wrong_type(wanted);
  }

  std::vector<double> numbers(const std::string& wanted) const {
    const toml::array* array = node.as_array();
    if (array == nullptr) wrong_type(wanted);
    std::vector<double> values;
    for (const toml::node& element : *array) values.push_back(number(element, wanted));
    return values;
  }

  std::string spelled() const {
    std::ostringstream text;
    node.is_date() ? text << *node.as_date() : text << *node.as_integer();
    return text.str();
  }

  template <std::size_t N>
  std::vector<std::array<double, N>> tuples() const {
    const std::string wanted = std::string("a list of ") + (N == 2 ? "pairs" : "triples") + " of numbers";
    const toml::array* array = node.as_array();
    if (array == nullptr || array->empty()) wrong_type(wanted);
    std::vector<std::array<double, N>> values;
    for (const toml::node& element : *array) {
      const toml::array* some = element.as_array();
      if (some == nullptr || some->size() != N) wrong_type(wanted);
      for (std::size_t k = 0; k < N; ++k) {
        if (k == 0) values.emplace_back();
        values.back()[k] = number((*some)[k], wanted);
      }
    }
    return values;
  }

  template <std::size_t N>
  std::array<double, N> tuple() const {
    const std::string wanted = "a list of " + std::to_string(N) + " numbers";
    const std::vector<double> values = numbers(wanted);
    if (values.size() != N) {
      fail(where,
           full_key(field) + " (" + std::to_string(values.size()) + " numbers, must be " + wanted + ")");
    }
    std::array<double, N> fixed;
    std::copy(values.begin(), values.end(), fixed.begin());
    return fixed;
  }

  void operator()(double* place) const { *place = number(node, "a number"); }
  void operator()(int* place) const {
    const auto integer = node.value_exact<std::int64_t>();
    const auto real = node.value_exact<double>();
    if (!integer && real && std::abs(*real) >= 0x1p63) {  // too large for TOML's whole numbers, as below
      *place = *real > 0 ? std::numeric_limits<int>::max() : std::numeric_limits<int>::min();
      return;
    }
    if (!integer) wrong_type("a whole number");
    // Out of int is out of range whatever the range; the check that follows says so.
    *place = static_cast<int>(
        std::clamp<std::int64_t>(*integer, std::numeric_limits<int>::min(), std::numeric_limits<int>::max()));
  }
  void operator()(std::string* place) const {
    if (field.choices == kAnyText && (node.is_date() || node.is_integer())) {
      *place = spelled();  // the date or the number of a job, which TOML knows without quotes
      return;
    }
    const auto text = node.value_exact<std::string>();
    if (!text) wrong_type("a string");
    *place = *text;
  }
  template <typename Enum>
  requires std::is_enum_v<Enum>
  void operator()(Enum* place) const {
    std::string word;
    (*this)(&word);
    if (!choose(field, word, *place)) fail(where, full_key(field) + " " + unknown_word(field, word));
  }
  void operator()(std::vector<double>* place) const { *place = numbers("a list of numbers"); }
  template <std::size_t N>
  void operator()(std::vector<std::array<double, N>>* place) const {
    *place = tuples<N>();
  }
  void operator()(std::array<double, 3>* place) const { *place = tuple<3>(); }
  template <std::size_t N>
  void operator()(std::optional<std::array<double, N>>* place) const {
    *place = tuple<N>();
  }
};

// Makes a value absent; returns false where its key has to have one.
struct MakeAbsent {
  template <typename T>
  bool operator()(T*) const {
    return false;
  }
  template <std::size_t N>
  bool operator()(std::optional<std::array<double, N>>* place) const {
    place->reset();
    return true;
  }
  template <std::size_t N>
  bool operator()(std::vector<std::array<double, N>>* place) const {
    place->clear();
    return true;
  }
};

// ---- checking ----

struct RangeCheck {
  const SettingField& field;
  const Origins& origins;

  void check(double value) const {
    // A NaN fails both comparisons.
    if (value >= field.min && value <= field.max) return;
    fail_key(origins, full_key(field), "(" + number_text(value) + ", must be " + range_text(field) + ")");
  }
  void operator()(const double* v) const { check(*v); }
  void operator()(const int* v) const { check(*v); }
  void operator()(const std::string* v) const {
    if (field.choices == kAnyText) return;
    const auto words = choices(field);
    if (std::find(words.begin(), words.end(), *v) != words.end()) return;
    fail_key(origins, full_key(field), unknown_word(field, *v));
  }
  template <typename Enum>
  requires std::is_enum_v<Enum>
  void operator()(const Enum*) const {}  // an enum holds no other value
  void operator()(const std::vector<double>* v) const {
    if (v->empty() || v->size() > kMaxLengths) {
      fail_key(origins, full_key(field),
               "(" + std::to_string(v->size()) + " numbers, must be " + range_text(field) + ")");
    }
    for (const double value : *v) check(value);
  }
  template <std::size_t N>
  void operator()(const std::vector<std::array<double, N>>* v) const {
    if (v->size() > kMaxLengths) {
      fail_key(origins, full_key(field),
               "(" + std::to_string(v->size()) + ", must be " + range_text(field) + ")");
    }
    for (const auto& some : *v) (*this)(&some);
  }
  template <std::size_t N>
  void operator()(const std::array<double, N>* v) const {
    for (const double value : *v) check(value);
  }
  template <std::size_t N>
  void operator()(const std::optional<std::array<double, N>>* v) const {
    if (v->has_value()) (*this)(&**v);
  }
};

void check_together(const Settings& s, const Origins& origins) {
  const auto at_most = [&](const char* key, double value, const char* limit_key, double limit) {
    if (value <= limit) return;
    // Where the limit alone was given, it is the one that is wrong.
    if (!origins.contains(key) && origins.contains(limit_key))
      fail_key(origins, limit_key,
               "(" + number_text(limit) + ", must be at least " + key + ", " + number_text(value) + ")");
    fail_key(origins, key,
             "(" + number_text(value) + ", must be at most " + limit_key + ", " + number_text(limit) + ")");
  };
  const auto& lengths = s.blade.free_lengths_mm;
  if (std::adjacent_find(lengths.begin(), lengths.end(), std::greater_equal<>()) != lengths.end()) {
    fail_key(origins, "blade.free_lengths_mm", "(not ascending): list every length once, shortest first");
  }
  const auto has_length = [&](const char* key, const std::optional<std::array<double, 3>>& d,
                              const char* hint) {
    if (!d || std::max({std::abs((*d)[0]), std::abs((*d)[1]), std::abs((*d)[2])}) >= kMinDirection) return;
    fail_key(origins, key,
             "(zero, must have a component of at least " + number_text(kMinDirection) + "): " + hint);
  };
  has_length("slice.direction", s.slice.direction, "leave it out to have it searched");
  has_length("design.facing", s.design.facing, "leave it out to cut all faces");
  if (s.slice.fan_axis) {
    const auto& a = *s.slice.fan_axis;
    if (std::max({std::abs(a[3]), std::abs(a[4]), std::abs(a[5])}) < kMinDirection) {
      fail_key(origins, "slice.fan_axis",
               "(direction zero, must have a component of at least " + number_text(kMinDirection) +
                   "): the last three of its six numbers");
    }
    if (s.slice.direction) {
      fail_key(origins, "slice.fan_axis",
               "(given with slice.direction, must stand alone): planes are parallel or turn about an axis");
    }
  }
  at_most("blade.thickness_mm", s.blade.thickness_mm, "blade.width_mm", s.blade.width_mm);
  // The melted band includes the blade.
  at_most("blade.thickness_mm", s.blade.thickness_mm, "blade.kerf_mm", s.blade.kerf_mm);
  const auto zero_or_at_least = [&](const char* key, double value, double least, const char* hint) {
    if (value == 0 || value >= least) return;
    fail_key(origins, key,
             "(" + number_text(value) + ", must be 0 or at least " + number_text(least) + "): " + hint);
  };
  zero_or_at_least("slice.spacing_mm", s.slice.spacing_mm, 0.5, "0 takes as few ribs as the fit does");
  // Clamps that jerk less take minutes to start.
  zero_or_at_least("motion.jerk_mm_s3", s.motion.jerk_mm_s3, 1, "0 is no limit");
  zero_or_at_least("motion.angular_jerk_rad_s3", s.motion.angular_jerk_rad_s3, 0.01, "0 is no limit");
  // The blade is formed above the stock, no nearer than clamps may come and not below where it is led in.
  at_most("motion.lead_mm", s.motion.lead_mm, "motion.approach_mm", s.motion.approach_mm);
  at_most("stock.clearance_mm", s.stock.clearance_mm, "motion.approach_mm", s.motion.approach_mm);
  at_most("motion.min_feed_mm_s", s.motion.min_feed_mm_s, "motion.feed_mm_s", s.motion.feed_mm_s);
  at_most("motion.feed_mm_s", s.motion.feed_mm_s, "motion.travel_mm_s", s.motion.travel_mm_s);
  at_most("machine.plinth_mm", s.machine.plinth_mm, "the height of machine.envelope_mm",
          s.machine.envelope_mm[2]);
}

// Every block is sawn out of stock that is sold.
void check_stock(const Settings& s, const Origins& origins) {
  const StockSettings& stock = s.stock;
  if (stock.saw_mm > 0 && stock.sizes_mm.empty())
    fail_key(origins, "stock.saw_mm", "(given without stock.sizes_mm): it says nothing alone");
  if (stock.sizes_mm.empty()) return;
  const auto sorted = [](std::array<double, 3> size) {
    std::sort(size.begin(), size.end());
    return size;
  };
  const auto most = sorted(stock.max_size_mm);
  const bool sold = std::any_of(stock.sizes_mm.begin(), stock.sizes_mm.end(), [&](const auto& size) {
    const auto has = sorted(size);
    return most[0] <= has[0] && most[1] <= has[1] && most[2] <= has[2];
  });
  if (sold) return;
  fail_key(origins, "stock.max_size_mm",
           "(" + number_text(stock.max_size_mm[0]) + " x " + number_text(stock.max_size_mm[1]) + " x " +
               number_text(stock.max_size_mm[2]) +
               "): a block of that size is within none of stock.sizes_mm");
}

// The band by speed: measured or modelled, and known for every speed that a blade may have.
void check_melt(const Settings& s, const Origins& origins) {
  const robot::Melt& melt = s.blade.melt;
  const auto& pairs = melt.band_mm_at_mm_s;
  constexpr const char* kPairs = "foam.band_mm_at_mm_s";
  if (!pairs.empty() && melt.melt_mm2_s > 0)
    fail_key(origins, "foam.melt_mm2_s",
             std::string("(given with ") + kPairs + "): one of both says the band");
  if (melt.melt_mm2_s > 0 && melt.loss_mm_s == 0)
    fail_key(origins, "foam.loss_mm_s",
             "(0 with foam.melt_mm2_s): a blade at rest melts no band without end");
  if (melt.melt_mm2_s == 0 && melt.loss_mm_s > 0)
    fail_key(origins, "foam.loss_mm_s", "(given without foam.melt_mm2_s): it says nothing alone");
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    const bool faster = pairs[i][0] > pairs[i - 1][0], wider = pairs[i][1] > pairs[i - 1][1];
    if (faster && !wider) continue;
    fail_key(origins, kPairs,
             "(" + number_text(pairs[i][1]) + " mm at " + number_text(pairs[i][0]) + " mm/s after " +
                 number_text(pairs[i - 1][1]) + " mm at " + number_text(pairs[i - 1][0]) +
                 " mm/s): speeds rise, and a faster blade melts no wider band");
  }
  if (!melt.by_speed()) return;
  if (!pairs.empty() && (pairs.front()[0] > s.motion.min_feed_mm_s || pairs.back()[0] < s.motion.feed_mm_s)) {
    fail_key(origins, kPairs,
             "(" + number_text(pairs.front()[0]) + " to " + number_text(pairs.back()[0]) +
                 " mm/s, must reach from motion.min_feed_mm_s, " + number_text(s.motion.min_feed_mm_s) +
                 ", to motion.feed_mm_s, " + number_text(s.motion.feed_mm_s) +
                 "): a blade may move at any speed between them");
  }
  const double narrowest = melt.band_mm(s.motion.feed_mm_s);
  if (narrowest < s.blade.thickness_mm) {
    fail_key(origins, pairs.empty() ? "foam.melt_mm2_s" : kPairs,
             "(a band of " + number_text(narrowest) +
                 " mm at motion.feed_mm_s, must be at least "
                 "blade.thickness_mm, " +
                 number_text(s.blade.thickness_mm) + "): the melted band includes the blade");
  }
}

// The access functions take a mutable Settings; a copy keeps const callers honest.
void check(Settings settings, const Origins& origins) {
  for (const SettingField& field : setting_fields())
    std::visit(RangeCheck{field, origins}, field.place(settings));
  check_together(settings, origins);
  check_stock(settings, origins);
  check_melt(settings, origins);
}

// ---- applying ----

// Null for an unknown key.
const SettingField* field_of(const std::string& section, const std::string& key) {
  const auto fields = setting_fields();
  const auto field = std::find_if(fields.begin(), fields.end(), [&](const SettingField& f) {
    return f.section == section && f.key == key;
  });
  return field == fields.end() ? nullptr : &*field;
}

void apply_value(Settings& settings, Origins& origins, const std::string& section, const std::string& key,
                 const toml::node& node, const std::string& where) {
  const SettingField* field = field_of(section, key);
  if (field == nullptr) fail(where, section + "." + key + ": unknown key: " + key_hint(section, key));
  const SettingPlace place = field->place(settings);
  std::visit(Reader{node, *field, where}, place);
  origins[full_key(*field)] = where;
  // Here and not only at the end: a later source must not hide that this one is wrong.
  std::visit(RangeCheck{*field, origins}, place);
}

bool is_section(const std::string& name) {
  const auto fields = setting_fields();
  return std::any_of(fields.begin(), fields.end(), [&](const SettingField& f) { return f.section == name; });
}

void apply_table(Settings& settings, Origins& origins, const toml::table& table, const std::string& source,
                 bool with_line) {
  const auto where = [&](const toml::source_region& region) {
    return with_line ? source + ":" + std::to_string(region.begin.line) : source;
  };
  for (const auto& [section_key, section_node] : table) {
    const std::string section(section_key.str());
    const toml::table* keys = section_node.as_table();
    if (keys == nullptr) {
      fail(where(section_key.source()), section + ": a key outside a section: " + key_hint("", section));
    }
    if (!is_section(section)) {
      fail(where(section_key.source()), "[" + section + "]: unknown section: " + section_hint(section));
    }
    for (const auto& [key, node] : *keys) {
      apply_value(settings, origins, section, std::string(key.str()), node, where(key.source()));
    }
  }
}

std::string read_text(const std::filesystem::path& file) {
  std::error_code code;
  if (std::filesystem::is_directory(file, code)) {
    throw Error(ErrorKind::kFile, file.string() + ": is a directory: name a TOML file");
  }
  // No configuration is so long, and a device may have no end.
  constexpr std::size_t kMostBytes = 4'000'000;
  std::ifstream in(file, std::ios::binary);
  const bool opened = in.is_open();
  std::string text;
  std::array<char, 1 << 14> block;
  while (text.size() <= kMostBytes && (in.read(block.data(), block.size()) || in.gcount() > 0))
    text.append(block.data(), static_cast<std::size_t>(in.gcount()));
  if (!opened || in.bad())
    throw Error(ErrorKind::kFile, file.string() + ": cannot read the configuration: does the file exist?");
  if (text.size() > kMostBytes)
    fail(file.string(), "longer than " + std::to_string(kMostBytes) + " bytes: is this a configuration?");
  return text;
}

void apply_file(Settings& settings, Origins& origins, const std::filesystem::path& file) {
  const std::string text = read_text(file);
  try {
    apply_table(settings, origins, toml::parse(text, file.string()), file.string(), true);
  } catch (const toml::parse_error& error) {
    fail(file.string() + ":" + std::to_string(error.source().begin.line), std::string(error.description()));
  }
}

// A whole number of more than 64 bits, which no TOML has, is beyond every limit by its size.
std::optional<double> too_large(std::string_view value) {
  const std::string_view digits = value.substr(value.starts_with('-') || value.starts_with('+') ? 1 : 0);
  if (digits.empty() || digits.front() == '0' ||
      digits.find_first_not_of("0123456789") != std::string_view::npos)
    return std::nullopt;
  double number = std::numeric_limits<double>::infinity();
  (void)std::from_chars(digits.data(), digits.data() + digits.size(), number);
  return value.starts_with('-') ? -number : number;
}

// A value as TOML, or as the string it spells when it is no TOML but a plain word.
toml::table parse_value(const std::string& value, const std::string& where) {
  try {
    toml::table table = toml::parse("value = " + value);
    if (table.size() == 1) return table;
  } catch (const toml::parse_error& error) {
    if (const auto number = too_large(value)) return toml::table{{"value", *number}};
    const bool word = std::all_of(value.begin(), value.end(), [](char c) {
      return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-' || c == '.' || c == '/';
    });
    const auto comma = value.find(',');
    const bool decimal_comma =
        comma != std::string::npos && value.find(',', comma + 1) == std::string::npos &&
        std::all_of(value.begin(), value.end(), [](char c) {
          return std::isdigit(static_cast<unsigned char>(c)) != 0 || c == ',' || c == '-';
        });
    if (decimal_comma) {
      std::string point = value;
      point[comma] = '.';
      fail(where, "(" + value + ") is no number: did you mean " + point + "?");
    }
    if (!word) fail(where, "(" + value + ") is no TOML value: " + std::string(error.description()));
    toml::table table;
    table.insert("value", value);
    return table;
  }
  fail(where, "(" + value + ") is more than one TOML value");
}

void apply_assignment(Settings& settings, Origins& origins, const std::string& key, const std::string& value,
                      const std::string& where) {
  const auto dot = key.find('.');
  if (dot == std::string::npos) fail(where, key + ": a key outside a section: " + key_hint("", key));
  const std::string section = key.substr(0, dot);
  if (!is_section(section)) fail(where, "[" + section + "]: unknown section: " + section_hint(section));
  const std::string own_key = key.substr(dot + 1);
  const SettingField* field = field_of(section, own_key);
  if (field != nullptr && value == kAbsent && std::visit(MakeAbsent{}, field->place(settings))) {
    origins[key] = where;
    return;
  }
  // Any text is the text itself, unless it is quoted as TOML quotes it.
  if (!is_utf8(value)) fail(where, key + " (" + utf8_text(value) + ") is no UTF-8: write it as UTF-8");
  const bool text =
      field != nullptr && field->choices == kAnyText && !value.starts_with('"') && !value.starts_with('\'');
  const toml::table table = text ? toml::table{{"value", value}} : parse_value(value, where + " " + key);
  apply_value(settings, origins, section, own_key, *table.get("value"), where);
}

void apply_assignments(Settings& settings, Origins& origins, const std::vector<std::string>& assignments) {
  for (const std::string& assignment : assignments) {
    const auto equals = assignment.find('=');
    if (equals == std::string::npos) fail("--set", "(" + assignment + ") must be section.key=value");
    apply_assignment(settings, origins, assignment.substr(0, equals), assignment.substr(equals + 1), "--set");
  }
}

// What flags say on top of others: they take back what they have at its default.
void said_by(const std::vector<SettingsFlag>& flags, std::set<std::string>& said) {
  for (const SettingsFlag& flag : flags) {
    if (flag.said) {
      said.insert(flag.key);
    } else {
      said.erase(flag.key);
    }
  }
}

}  // namespace

Settings resolve(const SettingsSources& sources) {
  return resolve_said(sources).settings;
}

SaidSettings resolve_said(const SettingsSources& sources) {
  Settings settings;
  Origins origins;
  for (const auto& file : sources.files) apply_file(settings, origins, file);
  apply_assignments(settings, origins, sources.assignments);
  for (const SettingsFlag& flag : sources.flags) {
    apply_assignment(settings, origins, flag.key, flag.value, flag.flag);
  }
  check(settings, origins);
  std::set<std::string> said;
  for (const auto& [key, origin] : origins) said.insert(key);
  said_by(sources.flags, said);
  return {settings, said};
}

Settings with_assignments(Settings settings, const std::vector<std::string>& assignments) {
  Origins origins;
  apply_assignments(settings, origins, assignments);
  check(settings, origins);
  return settings;
}

Settings with_flags(Settings settings, const std::vector<SettingsFlag>& flags) {
  Origins origins;
  for (const SettingsFlag& flag : flags) apply_assignment(settings, origins, flag.key, flag.value, flag.flag);
  check(settings, origins);
  return settings;
}

SaidSettings with_flags(SaidSettings settings, const std::vector<SettingsFlag>& flags) {
  settings.settings = with_flags(std::move(settings.settings), flags);
  said_by(flags, settings.said);
  return settings;
}

void validate(const Settings& settings) {
  check(settings, {});
}

Settings with_true_lengths(Settings settings) {
  for (double& length : settings.blade.free_lengths_mm) length += settings.blade.length_error_mm;
  settings.blade.length_error_mm = 0;
  return settings;
}

}  // namespace hotblade::pipeline
