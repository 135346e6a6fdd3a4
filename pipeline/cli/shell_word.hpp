// What is printed for a shell to read again.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace hotblade::pipeline {

// Returns the text as one word of a POSIX shell: as it is where that is one, in single quotes otherwise.
[[nodiscard]] std::string shell_word(std::string_view text);

// Returns the words as a line that a shell takes apart into them again.
[[nodiscard]] std::string shell_line(const std::vector<std::string>& words);

}  // namespace hotblade::pipeline
