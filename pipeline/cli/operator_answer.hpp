// What an operator's answer means before arms move.
#pragma once

#include <string_view>

namespace hotblade::pipeline {

// Returns whether an answer starts a strip: `yes` or the strip's id, to the letter.
[[nodiscard]] bool agrees_to_start(std::string_view answer, std::string_view strip_id);

}  // namespace hotblade::pipeline
