#include "pipeline/program/program_settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <type_traits>

#include "pipeline/settings/error.hpp"
#include "pipeline/settings/settings_fields.hpp"

namespace hotblade::pipeline {
namespace {

// Takes the value of one key to its place.
struct SettingReader {
  const JsonNode& node;
  const SettingField& field;

  [[nodiscard]] Range range() const { return {field.min, field.max}; }

  template <std::size_t N>
  [[nodiscard]] std::array<double, N> tuple() const {
    std::array<double, N> values;
    [[maybe_unused]] const std::size_t size = node.items(N, true);
    for (std::size_t i = 0; i < N; ++i) values[i] = node.item(i).number(range());
    return values;
  }

  void operator()(double* place) const { *place = node.number(range()); }
  void operator()(int* place) const {
    const auto count = static_cast<double>(node.count());
    if (!range().holds(count)) node.fail(fmt::format("out of range ({}, {})", count, range_text(field)));
    *place = static_cast<int>(count);
  }
  void operator()(std::string* place) const {
    *place = node.text();
    if (field.choices == kAnyText) return;
    const std::vector<std::string> words = choices(field);
    if (std::find(words.begin(), words.end(), *place) == words.end())
      node.fail(fmt::format("unknown word (\"{}\", {})", *place, range_text(field)));
  }
  template <typename Enum>
  requires std::is_enum_v<Enum>
  void operator()(Enum* place) const {
    std::string word;
    (*this)(&word);
    if (!choose(field, word, *place)) throw std::logic_error("an enum of settings has to have its words");
  }
  void operator()(std::vector<double>* place) const { *place = node.numbers(1, range()); }
  template <std::size_t N>
  void operator()(std::vector<std::array<double, N>>* place) const {
    if (node.is_null()) return;
    place->resize(node.items(1));
    for (std::size_t i = 0; i < place->size(); ++i) {
      const std::vector<double> some = node.item(i).numbers(N, range());
      if (some.size() != N) node.item(i).fail(fmt::format("is not a list of {} numbers", N));
      std::copy(some.begin(), some.end(), (*place)[i].begin());
    }
  }
  void operator()(std::array<double, 3>* place) const { *place = tuple<3>(); }
  template <std::size_t N>
  void operator()(std::optional<std::array<double, N>>* place) const {
    if (!node.is_null()) *place = tuple<N>();
  }
};

void read_section(const JsonNode& node, const std::string& section, Settings& settings) {
  if (!node.json().is_object()) node.fail("is not an object of settings");
  const auto fields = setting_fields();
  for (const auto& [key, value] : node.json().items()) {
    const JsonNode setting = node.field(key.c_str());
    const auto field = std::find_if(fields.begin(), fields.end(), [&](const SettingField& f) {
      return f.section == section && f.key == key;
    });
    if (field == fields.end()) setting.fail("unknown setting: use the hotblade that wrote it");
    std::visit(SettingReader{setting, *field}, field->place(settings));
  }
}

}  // namespace

Settings settings_of(const JsonNode& node) {
  if (!node.json().is_object()) node.fail("is not an object");
  Settings settings;
  const auto fields = setting_fields();
  for (const auto& [name, section] : node.json().items()) {
    const JsonNode child = node.field(name.c_str());
    if (std::none_of(fields.begin(), fields.end(), [&](const SettingField& f) { return f.section == name; }))
      child.fail("unknown section of settings: use the hotblade that wrote it");
    read_section(child, name, settings);
  }
  try {
    validate(settings);
  } catch (const Error& error) {
    node.fail(std::string("do not go together: ") + error.what());
  }
  return settings;
}

}  // namespace hotblade::pipeline
