// A refusal in the page's words.
#pragma once

#include <string>

#include "pipeline/report/words.hpp"
#include "pipeline/verify/refusal.hpp"

namespace hotblade::pipeline {

// Return what the functions of the same name do of a refusal (pipeline/verify/refusal.hpp), in the language
// of the words.
[[nodiscard]] std::string limit_text(const Refusal& refusal, const Words& w);
[[nodiscard]] std::string unit(const Refusal& refusal, const Words& w);
[[nodiscard]] std::string note(const Refusal& refusal, const Words& w);
[[nodiscard]] std::string describe_amount(const Refusal& refusal, const Words& w);
[[nodiscard]] std::string describe(const Refusal& refusal, const Words& w);

}  // namespace hotblade::pipeline
