#include "pipeline/program/json_node.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "pipeline/settings/error.hpp"
#include "pipeline/settings/json_bytes.hpp"
#include "pipeline/settings/json_text.hpp"

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

// Grows the tree from the parser's events. Against nlohmann's own it refuses a second key of the same name in
// one object, and items may be taken out of it while it grows.
class TreeGrower {
 public:
  using Json = JsonNode::Json;

  TreeGrower(const std::string& file, const JsonTaker& taker) : file_(file), taker_(taker) {}
  [[nodiscard]] Json result() { return std::move(root_); }

  // The events that nlohmann::json::sax_parse() calls.
  bool null() { return add(nullptr); }
  bool boolean(bool value) { return add(value); }
  bool number_integer(Json::number_integer_t value) { return add(value); }
  bool number_unsigned(Json::number_unsigned_t value) { return add(value); }
  bool number_float(Json::number_float_t value, const std::string&) { return add(value); }
  bool string(std::string& value) { return add(std::move(value)); }
  bool binary(Json::binary_t& value) { return add(std::move(value)); }
  bool start_object(std::size_t) { return open(Json::value_t::object); }
  bool start_array(std::size_t) { return open(Json::value_t::array); }
  bool key(std::string& name) {
    Json& object = *open_.back();
    if (object.contains(name)) {
      throw Error(ErrorKind::kBadInput,
                  fmt::format("{}: key \"{}\" stands twice in one object", file_, name));
    }
    if (open_.size() == 1) root_key_ = name;
    slot_ = &object[std::move(name)];
    return true;
  }
  bool end_object() { return close(); }
  bool end_array() { return close(); }
  template <typename Error>
  bool parse_error(std::size_t, const std::string&, const Error& error) {
    throw error;
  }

 private:
  template <typename Value>
  Json* place(Value&& value) {
    if (open_.empty()) return &(root_ = std::forward<Value>(value));
    if (open_.back()->is_object()) return &(*slot_ = std::forward<Value>(value));
    open_.back()->push_back(std::forward<Value>(value));
    return &open_.back()->back();
  }

  template <typename Value>
  bool add(Value&& value) {
    finished(*place(Json(std::forward<Value>(value))));
    return true;
  }

  bool open(Json::value_t type) {
    open_.push_back(place(Json(type)));
    return true;
  }

  bool close() {
    Json& value = *open_.back();
    open_.pop_back();
    finished(value);
    return true;
  }

  void finished(const Json& value) {
    if (open_.size() == 1 && taker_.see) taker_.see(root_key_, value);
    const bool item =
        open_.size() == 2 && open_.back()->is_array() && taker_.array && root_key_ == taker_.array;
    if (item && taker_.take(value)) open_.back()->get_ref<Json::array_t&>().pop_back();
  }

  const std::string& file_;
  const JsonTaker& taker_;
  Json root_;
  // Objects and arrays not closed yet. An array's last item and an object's last value do not move while one
  // of these is open in them.
  std::vector<Json*> open_;
  Json* slot_ = nullptr;  // where the value of the key just read goes
  std::string root_key_;
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
  if (!range.holds(value)) fail(fmt::format("out of range ({}, {})", value, limits(range)));
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
  throw Error(ErrorKind::kBadInput, fmt::format("{}: {}{}", file_, place(), what_and_hint));
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
  const std::string text = json_text(value_);
  constexpr std::size_t kLongest = 40;  // enough for any number and most words
  return text.size() <= kLongest ? text : text.substr(0, kLongest) + "...";
}

namespace {

// The parser's words without its name of the error and the place, which stands before them.
std::string parser_words(const std::string& what) {
  const auto at = what.find("parse error"), end = what.find(": ", at);
  return at == std::string::npos || end == std::string::npos ? what : what.substr(end + 2);
}

// The parser counts bytes from 1.
bool at_nul(const std::string& text, std::size_t byte) {
  return byte > 0 && byte <= text.size() && text[byte - 1] == '\0';
}

}  // namespace

JsonNode::Json parse_json(const std::string& text, const std::string& file) {
  return parse_json(text, file, JsonTaker{nullptr, {}, {}});
}

JsonNode::Json parse_json(const std::string& text, const std::string& file, const JsonTaker& taker) {
  try {
    TreeGrower grower(file, taker);
    JsonNode::Json::sax_parse(json_begin(text), json_end(text), &grower);
    return grower.result();
  } catch (const JsonNode::Json::parse_error& error) {
    throw Error(ErrorKind::kBadInput, fmt::format("{}:{}: not JSON: {}", file, line_of(text, error.byte),
                                                  text.empty()               ? "the file is empty"
                                                  : at_nul(text, error.byte) ? "a NUL byte"
                                                                             : parser_words(error.what())));
  } catch (const JsonNode::Json::out_of_range& error) {
    throw Error(ErrorKind::kBadInput, fmt::format("{}: a number is too large: {}", file, error.what()));
  }
}

}  // namespace hotblade::pipeline
