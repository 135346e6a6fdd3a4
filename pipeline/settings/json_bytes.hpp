// JSON that comes from outside, read to its end.
#pragma once

#include <cstddef>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string_view>

namespace hotblade::pipeline {

// The bytes of a text as nlohmann is to read them. It takes a NUL for the text's end and looks at nothing
// behind; no JSON has one, so it is shown another control character, which none has either.
class JsonBytes {
 public:
  using iterator_category = std::forward_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = char;

  JsonBytes() = default;
  explicit JsonBytes(const char* at) : at_(at) {}
  char operator*() const { return *at_ == '\0' ? '\x01' : *at_; }
  JsonBytes& operator++() {
    ++at_;
    return *this;
  }
  JsonBytes operator++(int) { return JsonBytes(at_++); }
  bool operator==(const JsonBytes&) const = default;

 private:
  const char* at_ = nullptr;
};

[[nodiscard]] inline JsonBytes json_begin(std::string_view text) {
  return JsonBytes(text.data());
}
[[nodiscard]] inline JsonBytes json_end(std::string_view text) {
  return JsonBytes(text.data() + text.size());
}

// Returns the value that a text is. Throws nlohmann's parse_error where it is none.
template <typename Json>
[[nodiscard]] Json whole_json(std::string_view text) {
  return Json::parse(json_begin(text), json_end(text));
}
// Returns the same, or a discarded value where the text is none.
template <typename Json>
[[nodiscard]] Json whole_json_if_any(std::string_view text) {
  return Json::parse(json_begin(text), json_end(text), nullptr, false);
}

}  // namespace hotblade::pipeline
