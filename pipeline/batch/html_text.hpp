// Text as HTML holds it.
#pragma once

#include <string>

namespace hotblade::pipeline::batch {

// Returns the text with &, <, > and quotes escaped, for content and for attributes in double quotes.
[[nodiscard]] std::string html_text(const std::string& text);

}  // namespace hotblade::pipeline::batch
