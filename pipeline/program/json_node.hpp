// A JSON value that knows its place in the file, for readers that check everything and name what is wrong.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hotblade::pipeline {

// An interval a number has to lie in; `above` excludes the lower end.
struct Range {
  double low, high;
  bool above = false;
  [[nodiscard]] constexpr bool holds(double value) const {
    return (above ? value > low : value >= low) && value <= high;
  }
};

// A cheap view: it refers to the JSON value and to its parent node, both of which have to outlive it. Every
// function throws Error (kBadInput) and `file: place: what (value, limit): hint`.
class JsonNode {
 public:
  using Json = nlohmann::ordered_json;

  JsonNode(const Json& value, const std::string& file) : value_(value), file_(file) {}

  // Return the value under a key or at a place; the parent has to be no temporary, which would be gone before
  // its child is used.
  [[nodiscard]] JsonNode field(const char* key) const&;
  [[nodiscard]] JsonNode item(std::size_t index) const&;
  JsonNode field(const char* key) const&& = delete;
  JsonNode item(std::size_t index) const&& = delete;

  // Throws unless the value is an object with exactly these keys, in any order.
  void expect_keys(std::span<const char* const> keys) const;
  // Returns the number of items of an array that has at least `least` of them, exactly `least` when `exact`.
  [[nodiscard]] std::size_t items(std::size_t least, bool exact = false) const;

  // Return the value as what they name, checked; one_of() a word among the choices, numbers() at least
  // `least` numbers in the range.
  [[nodiscard]] bool is_null() const { return value_.is_null(); }
  [[nodiscard]] double number() const;
  [[nodiscard]] double number(Range range) const;
  [[nodiscard]] std::size_t count() const;
  [[nodiscard]] bool boolean() const;
  [[nodiscard]] const std::string& text() const;
  [[nodiscard]] const std::string& one_of(std::span<const char* const> choices) const;
  [[nodiscard]] std::vector<double> numbers(std::size_t least, Range range) const;
  [[nodiscard]] const Json& json() const { return value_; }

  // Throws Error (kBadInput) that names the value's place.
  [[noreturn]] void fail(const std::string& what_and_hint) const;

 private:
  JsonNode(const Json& value, const JsonNode& parent, const char* key, std::size_t index)
      : value_(value), file_(parent.file_), parent_(&parent), key_(key), index_(index) {}
  [[nodiscard]] std::string place() const;
  // Returns the value as the file has it, shortened for a message.
  [[nodiscard]] std::string shown() const;

  const Json& value_;
  const std::string& file_;
  const JsonNode* parent_ = nullptr;
  const char* key_ = nullptr;
  std::size_t index_ = 0;
};

// Returns the tree of a JSON text. Throws Error (kBadInput) with `file:line: what`, also for a key given
// twice in one object and for anything after the value.
[[nodiscard]] nlohmann::ordered_json parse_json(const std::string& text, const std::string& file);

// Looks at the parts of a text that need not become one tree: `take` is asked of every finished item of the
// array under the root's key `array`, and what it takes (true) is left out of the result; `see` is shown
// every value that is finished under a key of the root.
struct JsonTaker {
  const char* array;
  std::function<bool(const JsonNode::Json& item)> take;
  std::function<void(const std::string& key, const JsonNode::Json& value)> see;
};
[[nodiscard]] nlohmann::ordered_json parse_json(const std::string& text, const std::string& file,
                                                const JsonTaker& taker);

}  // namespace hotblade::pipeline
