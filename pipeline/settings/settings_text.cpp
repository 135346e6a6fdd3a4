// Settings written out: JSON for programs, TOML for people, and the table of every key.
#include <nlohmann/json.hpp>
#include <type_traits>

#include "pipeline/settings/assignments.hpp"
#include "pipeline/settings/settings_fields.hpp"

namespace hotblade::pipeline {
namespace {

struct ToJson {
  template <std::size_t N>
  nlohmann::ordered_json operator()(const std::optional<std::array<double, N>>* v) const {
    return v->has_value() ? nlohmann::ordered_json(**v) : nlohmann::ordered_json(nullptr);
  }
  template <std::size_t N>
  nlohmann::ordered_json operator()(const std::vector<std::array<double, N>>* v) const {
    return v->empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(*v);
  }
  template <typename T>
  nlohmann::ordered_json operator()(const T* v) const {
    if constexpr (std::is_enum_v<T>) {
      return std::string(name(*v));
    } else {
      return *v;
    }
  }
};

bool is_off(const SettingPlace& place) {
  if (const auto* number = std::get_if<double*>(&place)) return **number == 0;
  if (const auto* numbers = std::get_if<std::array<double, 3>*>(&place))
    return **numbers == std::array<double, 3>{};
  if (const auto* triples = std::get_if<std::vector<std::array<double, 3>>*>(&place))
    return (*triples)->empty();
  return std::get<std::vector<std::array<double, 2>>*>(place)->empty();
}

std::string unit_and_range(const SettingField& field) {
  return (field.unit.empty() ? "" : std::string(field.unit) + ", ") + range_text(field);
}

}  // namespace

nlohmann::ordered_json to_json(const Settings& settings) {
  Settings copy = settings;
  nlohmann::ordered_json json;
  for (const SettingField& field : setting_fields()) {
    const SettingPlace place = field.place(copy);
    if (field.off_at_zero && is_off(place)) continue;
    json[std::string(field.section)][std::string(field.key)] = std::visit(ToJson{}, place);
  }
  return json;
}

std::string to_toml(const Settings& settings) {
  Settings copy = settings;
  std::string text, section;
  for (const SettingField& field : setting_fields()) {
    if (field.section != section) {
      text += (section.empty() ? "[" : "\n[") + std::string(field.section) + "]\n";
      section = field.section;
    }
    text += "# " + std::string(field.description) + " (" + unit_and_range(field) + ")\n";
    const std::string key(field.key);
    const auto value = toml_text(field.place(copy));
    text += value ? key + " = " + *value + "\n" : "# " + key + " is " + kAbsent + "\n";
  }
  return text;
}

std::vector<SettingInfo> describe_settings() {
  Settings defaults;
  std::vector<SettingInfo> infos;
  for (const SettingField& field : setting_fields()) {
    infos.push_back({full_key(field), std::string(field.unit),
                     toml_text(field.place(defaults)).value_or(kAbsent), range_text(field),
                     std::string(field.description)});
  }
  return infos;
}

}  // namespace hotblade::pipeline
