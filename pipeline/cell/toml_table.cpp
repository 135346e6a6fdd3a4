#include "pipeline/cell/toml_table.hpp"

#include <toml++/toml.h>

#include <cmath>
#include <set>
#include <utility>

#include "pipeline/settings/edit_distance.hpp"
#include "pipeline/settings/error.hpp"
#include "pipeline/settings/settings_fields.hpp"

namespace hotblade::pipeline {

struct TomlTable::Content {
  std::string file, path;            // of the table: "arm[0].base"
  std::shared_ptr<toml::table> top;  // keeps the nodes
  const toml::table* table = nullptr;
  std::set<std::string, std::less<>> asked;

  [[nodiscard]] std::string name_of(std::string_view key) const {
    if (key.empty()) return path;
    return (path.empty() ? "" : path + ".") + std::string(key);
  }
  const toml::node* ask(std::string_view key) {
    asked.insert(std::string(key));
    return table->get(key);
  }
};

namespace {

// The nearest key that was asked for; empty where none is near.
std::string hint(std::string_view key, const std::set<std::string, std::less<>>& asked) {
  std::string nearest;
  std::size_t best = std::max<std::size_t>(2, key.size() / 3) + 1;
  for (const std::string& known : asked) {
    const std::size_t distance = edit_distance(std::string(key), known);
    if (distance < best) {
      best = distance;
      nearest = known;
    }
  }
  return nearest.empty() ? "" : ": did you mean " + nearest + "?";
}

}  // namespace

TomlTable::TomlTable(std::unique_ptr<Content> content) : content_(std::move(content)) {}
TomlTable::TomlTable(TomlTable&&) noexcept = default;
TomlTable::~TomlTable() = default;

TomlTable TomlTable::parse(const std::string& text, const std::string& file) {
  try {
    auto top = std::make_shared<toml::table>(toml::parse(text, file));
    auto content = std::make_unique<Content>();
    content->file = file;
    content->table = top.get();
    content->top = std::move(top);
    return TomlTable(std::move(content));
  } catch (const toml::parse_error& error) {
    throw Error(ErrorKind::kBadSettings, file + ":" + std::to_string(error.source().begin.line) + ": " +
                                             std::string(error.description()));
  }
}

void TomlTable::fail(std::string_view key, const std::string& what) const {
  auto line = content_->table->source().begin.line;
  for (const auto& [name, node] : *content_->table) {
    if (name.str() == key) line = name.source().begin.line;
  }
  throw Error(ErrorKind::kBadSettings,
              content_->file + ":" + std::to_string(std::max<std::uint32_t>(line, 1)) + ": " +
                  content_->name_of(key) + (content_->name_of(key).empty() ? "" : ": ") + what);
}

bool TomlTable::has(std::string_view key) const {
  return content_->table->contains(key);
}

std::optional<std::string> TomlTable::text(std::string_view key) {
  const toml::node* node = content_->ask(key);
  if (node == nullptr) return std::nullopt;
  const auto value = node->value_exact<std::string>();
  if (!value || value->empty()) fail(key, "must be a text");
  return *value;
}

std::optional<bool> TomlTable::flag(std::string_view key) {
  const toml::node* node = content_->ask(key);
  if (node == nullptr) return std::nullopt;
  const auto value = node->value_exact<bool>();
  if (!value) fail(key, "must be true or false");
  return *value;
}

namespace {

std::optional<double> number_of(const toml::node& node) {
  if (const auto integer = node.value_exact<std::int64_t>()) return static_cast<double>(*integer);
  return node.value_exact<double>();
}

std::string range_of(double least, double most) {
  return number_text(least) + " to " + number_text(most);
}

}  // namespace

std::optional<double> TomlTable::number(std::string_view key, double least, double most) {
  const toml::node* node = content_->ask(key);
  if (node == nullptr) return std::nullopt;
  const auto value = number_of(*node);
  if (!value) fail(key, "must be a number");
  if (!(*value >= least && *value <= most))
    fail(key, number_text(*value) + ", must be " + range_of(least, most));
  return value;
}

std::optional<int> TomlTable::whole(std::string_view key, int least, int most) {
  const auto value = number(key, least, most);
  if (!value) return std::nullopt;
  if (*value != std::floor(*value)) fail(key, number_text(*value) + ", must be a whole number");
  return static_cast<int>(*value);
}

std::optional<std::vector<double>> TomlTable::list(std::string_view key, std::size_t count, double least,
                                                   double most) {
  const toml::node* node = content_->ask(key);
  if (node == nullptr) return std::nullopt;
  const toml::array* array = node->as_array();
  if (array == nullptr || array->size() != count) fail(key, "must be " + std::to_string(count) + " numbers");
  std::vector<double> values;
  for (const toml::node& element : *array) {
    const auto value = number_of(element);
    if (!value) fail(key, "must be " + std::to_string(count) + " numbers");
    if (!(*value >= least && *value <= most))
      fail(key, number_text(*value) + ", must be " + range_of(least, most));
    values.push_back(*value);
  }
  return values;
}

std::optional<TomlTable> TomlTable::table(std::string_view key) {
  const toml::node* node = content_->ask(key);
  if (node == nullptr) return std::nullopt;
  if (node->as_table() == nullptr) fail(key, "must be a table");
  auto inner = std::make_unique<Content>();
  inner->file = content_->file;
  inner->path = content_->name_of(key);
  inner->top = content_->top;
  inner->table = node->as_table();
  return TomlTable(std::move(inner));
}

std::vector<TomlTable> TomlTable::tables(std::string_view key) {
  const toml::node* node = content_->ask(key);
  std::vector<TomlTable> all;
  if (node == nullptr) return all;
  const toml::array* array = node->as_array();
  if (array == nullptr) fail(key, "must be a list of tables");
  for (std::size_t i = 0; i < array->size(); ++i) {
    const toml::table* table = array->get(i)->as_table();
    if (table == nullptr) fail(key, "must be a list of tables");
    auto inner = std::make_unique<Content>();
    inner->file = content_->file;
    inner->path = content_->name_of(key) + "[" + std::to_string(i) + "]";
    inner->top = content_->top;
    inner->table = table;
    all.push_back(TomlTable(std::move(inner)));
  }
  return all;
}

void TomlTable::expect_all_read() const {
  for (const auto& [name, node] : *content_->table) {
    if (!content_->asked.contains(name.str()))
      fail(name.str(), "unknown key" + hint(name.str(), content_->asked));
  }
}

}  // namespace hotblade::pipeline
