#include "pipeline/json_node.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pipeline/command_error.hpp"

namespace hotblade::pipeline {
namespace {

std::string limits(Range range) {
  if (std::isinf(range.high)) return fmt::format("{} {}", range.above ? "above" : "at least", range.low);
  return fmt::format("{}{} to {}", range.above ? "above " : "", range.low, range.high);
}

std::string joined(std::span<const char* const> words) {
  return fmt::format("{}", fmt::join(words, ", "));
}

int line_of(const std::string& text, std::size_t byte) {
  const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(byte, text.size()));
  return 1 + static_cast<int>(std::count(text.begin(), end, '\n'));
}

// Sees every key while parsing and refuses a second one of the same name in the same object.
class DuplicateKeys {
 public:
  explicit DuplicateKeys(const std::string& file) : file_(file) {}

  bool operator()(JsonNode::Json::parse_event_t event, const JsonNode::Json& value) {
    using Event = JsonNode::Json::parse_event_t;
    if (event == Event::object_start) open_.emplace_back();
    if (event == Event::object_end) open_.pop_back();
    if (event == Event::key) add(value.get_ref<const std::string&>());
    return true;
  }

 private:
  void add(const std::string& key) {
    auto& keys = open_.back();
    if (std::find(keys.begin(), keys.end(), key) != keys.end()) {
      throw CommandError(Exit::kBadInput,
                         fmt::format("{}: key \"{}\" stands twice in one object", file_, key));
    }
    keys.push_back(key);
  }

  const std::string& file_;
  std::vector<std::vector<std::string>> open_;
};

}  // namespace

JsonNode JsonNode::field(const char* key) const& {
  if (!value_.is_object()) fail(fmt::format("is not an object ({})", shown()));
  const auto found = value_.find(key);
  if (found == value_.end()) fail(fmt::format("\"{}\" is missing", key));
  return {*found, *this, key, 0};
}

JsonNode JsonNode::item(std::size_t index) const& {
  return {value_.at(index), *this, nullptr, index};
}

void JsonNode::expect_keys(std::span<const char* const> keys) const {
  if (!value_.is_object()) fail(fmt::format("is not an object ({})", shown()));
  for (const char* key : keys) {
    if (!value_.contains(key)) fail(fmt::format("\"{}\" is missing", key));
  }
  if (value_.size() == keys.size()) return;
  for (const auto& [key, value] : value_.items()) {
    const bool known =
        std::any_of(keys.begin(), keys.end(), [&k = key](const char* one) { return k == one; });
    if (!known) fail(fmt::format("unknown key \"{}\": one of {} is expected", key, joined(keys)));
  }
}

std::size_t JsonNode::items(std::size_t least, bool exact) const {
  if (!value_.is_array()) fail(fmt::format("is not an array ({})", shown()));
  const std::size_t size = value_.size();
  if (size < least || (exact && size != least)) {
    fail(fmt::format("wrong number of items ({}, {} {})", size, exact ? "exactly" : "at least", least));
  }
  return size;
}

double JsonNode::number() const {
  if (!value_.is_number()) fail(fmt::format("is not a number ({})", shown()));
  const double number = value_.get<double>();
  if (!std::isfinite(number)) fail(fmt::format("is not finite ({})", shown()));
  return number;
}

double JsonNode::number(Range range) const {
  const double value = number();
  const bool inside = (range.above ? value > range.low : value >= range.low) && value <= range.high;
  if (!inside) fail(fmt::format("out of range ({}, {})", value, limits(range)));
  return value;
}

std::size_t JsonNode::count() const {
  if (!value_.is_number_unsigned()) fail(fmt::format("is not a whole number from 0 ({})", shown()));
  return value_.get<std::size_t>();
}

bool JsonNode::boolean() const {
  if (!value_.is_boolean()) fail(fmt::format("is not true or false ({})", shown()));
  return value_.get<bool>();
}

const std::string& JsonNode::text() const {
  if (!value_.is_string()) fail(fmt::format("is not a string ({})", shown()));
  return value_.get_ref<const std::string&>();
}

const std::string& JsonNode::one_of(std::span<const char* const> choices) const {
  const std::string& word = text();
  const bool known =
      std::any_of(choices.begin(), choices.end(), [&](const char* one) { return word == one; });
  if (!known) fail(fmt::format("unknown word ({}, one of {})", shown(), joined(choices)));
  return word;
}

std::vector<double> JsonNode::numbers(std::size_t least, Range range) const {
  std::vector<double> values(items(least));
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = item(i).number(range);
  return values;
}

void JsonNode::fail(const std::string& what_and_hint) const {
  throw CommandError(Exit::kBadInput, fmt::format("{}: {}{}", file_, place(), what_and_hint));
}

std::string JsonNode::place() const {
  std::vector<const JsonNode*> way;
  for (const JsonNode* node = this; node->parent_; node = node->parent_) way.push_back(node);
  std::string text;
  for (auto node = way.rbegin(); node != way.rend(); ++node) {
    if ((*node)->key_) {
      text += fmt::format("{}{}", text.empty() ? "" : ".", (*node)->key_);
    } else {
      text += fmt::format("[{}]", (*node)->index_);
    }
  }
  return text.empty() ? text : text + ": ";
}

std::string JsonNode::shown() const {
  if (value_.is_object()) return "an object";
  if (value_.is_array()) return "an array";
  const std::string text = value_.dump(-1, ' ', false, Json::error_handler_t::replace);
  constexpr std::size_t kLongest = 40;  // enough for any number and most words
  return text.size() <= kLongest ? text : text.substr(0, kLongest) + "...";
}

JsonNode::Json parse_json(const std::string& text, const std::string& file) {
  DuplicateKeys duplicates(file);
  const auto watch = [&](int, JsonNode::Json::parse_event_t event, JsonNode::Json& value) {
    return duplicates(event, value);
  };
  try {
    return JsonNode::Json::parse(text, watch);
  } catch (const JsonNode::Json::parse_error& error) {
    throw CommandError(Exit::kBadInput, fmt::format("{}:{}: not JSON: {}", file, line_of(text, error.byte),
                                                    text.empty() ? "the file is empty" : error.what()));
  } catch (const JsonNode::Json::out_of_range& error) {
    throw CommandError(Exit::kBadInput, fmt::format("{}: a number is too large: {}", file, error.what()));
  }
}

}  // namespace hotblade::pipeline
