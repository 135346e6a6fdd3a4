// One line of an execution log, as execution_log.cpp writes it, taken apart.
#pragma once

#include <array>
#include <charconv>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>

#include "robot/controller/controller_journal.hpp"

namespace hotblade::robot {

// Reads known fields out of one line of an execution log.
class Line {
 public:
  Line(std::string_view text, const std::string& place) : text_(text), place_(place) {}

  // Return what stands behind a key: as text, without a string's quotes, as a number, as bytes in hex. All
  // fail for a key that is not there and a value of another kind.
  [[nodiscard]] std::string_view raw_value(std::string_view key) const {
    std::string wanted(1, '"');
    wanted.append(key).append("\":");
    const auto at = text_.find(wanted);
    if (at == std::string_view::npos) fail(key);
    const auto from = at + wanted.size();
    const auto to = text_.find_first_of(",}", from);
    if (to == std::string_view::npos || to == from) fail(key);
    return text_.substr(from, to - from);
  }
  [[nodiscard]] std::string_view string(std::string_view key) const {
    const auto value = raw_value(key);
    if (value.size() < 2 || value.front() != '"' || value.back() != '"') fail(key);
    return value.substr(1, value.size() - 2);
  }
  template <typename Number>
  [[nodiscard]] Number number(std::string_view key, std::string_view value, int base = 10) const {
    Number result{};
    std::from_chars_result parsed{};
    if constexpr (std::is_floating_point_v<Number>) {
      parsed = std::from_chars(value.data(), value.data() + value.size(), result);
    } else {
      parsed = std::from_chars(value.data(), value.data() + value.size(), result, base);
    }
    if (parsed.ec != std::errc() || parsed.ptr != value.data() + value.size()) fail(key);
    return result;
  }
  template <std::size_t N>
  void bytes(std::string_view key, std::array<std::uint8_t, N>& out) const {
    const auto text = string(key);
    if (text.size() != 2 * N) fail(key);
    for (std::size_t i = 0; i < N; ++i) out[i] = number<std::uint8_t>(key, text.substr(2 * i, 2), 16);
  }
  // Throws LogError that names the line and the key.
  [[noreturn]] void fail(std::string_view key) const {
    throw LogError(place_ + ": no valid " + std::string(key) + ": not a line of an execution log");
  }

 private:
  std::string_view text_;
  const std::string& place_;
};

}  // namespace hotblade::robot
