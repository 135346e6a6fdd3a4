#include "pipeline/settings/json_text.hpp"

#include <nlohmann/json.hpp>

#include "pipeline/settings/json_bytes.hpp"

namespace hotblade::pipeline {

std::string json_text(const nlohmann::json& json, int indent) {
  return json.dump(indent, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string json_text(const nlohmann::ordered_json& json, int indent) {
  return json.dump(indent, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

std::string utf8_text(std::string_view bytes) {
  return whole_json<nlohmann::json>(json_text(nlohmann::json(bytes))).get<std::string>();
}

bool is_utf8(std::string_view bytes) {
  return utf8_text(bytes) == bytes;
}

}  // namespace hotblade::pipeline
