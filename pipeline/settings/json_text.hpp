// Texts of JSON, whatever bytes their strings hold. A name of a file is bytes, and a JSON is UTF-8: every
// JSON that the pipeline writes is made here (tests/house/check_house.sh), and has U+FFFD, the mark of what
// is no UTF-8, in the place of each byte that is none.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace hotblade::pipeline {

// Returns the JSON's text, in one line or with lines indented by so many blanks.
[[nodiscard]] std::string json_text(const nlohmann::json& json, int indent = -1);
[[nodiscard]] std::string json_text(const nlohmann::ordered_json& json, int indent = -1);

// Returns the bytes as UTF-8: as they are, or with U+FFFD for each that belongs to none of its characters.
[[nodiscard]] std::string utf8_text(std::string_view bytes);

// Returns whether the bytes are UTF-8.
[[nodiscard]] bool is_utf8(std::string_view bytes);

}  // namespace hotblade::pipeline
