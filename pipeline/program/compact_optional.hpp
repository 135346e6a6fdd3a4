// An optional that takes no more memory than what it may hold: a program has a million poses.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

namespace hotblade::pipeline {

// What stands for "absent": nothing that a T may be. A specialisation has `absent()` and `is_absent(value)`.
template <typename T>
struct Absence;

template <>
struct Absence<double> {
  static double absent() { return std::numeric_limits<double>::quiet_NaN(); }
  static bool is_absent(double value) { return std::isnan(value); }
};

template <>
struct Absence<int> {
  static int absent() { return std::numeric_limits<int>::min(); }
  static bool is_absent(int value) { return value == absent(); }
};

template <>
struct Absence<std::array<double, 2>> {
  static std::array<double, 2> absent() { return {Absence<double>::absent(), Absence<double>::absent()}; }
  static bool is_absent(const std::array<double, 2>& value) { return std::isnan(value[0]); }
};

// As std::optional, of which it is made and which it turns into.
template <typename T>
class CompactOptional {
 public:
  CompactOptional() = default;
  CompactOptional(std::nullopt_t) {}
  // Throws std::logic_error where the value is what stands for "absent": what could not be computed must not
  // pass for what was not.
  CompactOptional(const T& value) : value_(value) {
    if (!has_value()) throw std::logic_error("a value that stands for none");
  }
  CompactOptional(const std::optional<T>& other) {
    if (other) *this = *other;
  }
  operator std::optional<T>() const { return has_value() ? std::optional<T>(value_) : std::nullopt; }

  [[nodiscard]] bool has_value() const { return !Absence<T>::is_absent(value_); }
  explicit operator bool() const { return has_value(); }
  // Undefined where it is absent.
  [[nodiscard]] const T& operator*() const { return value_; }
  [[nodiscard]] T& operator*() { return value_; }
  [[nodiscard]] const T* operator->() const { return &value_; }
  [[nodiscard]] T* operator->() { return &value_; }
  // Throws std::bad_optional_access where it is absent.
  [[nodiscard]] const T& value() const { return has_value() ? value_ : throw std::bad_optional_access(); }
  [[nodiscard]] T value_or(const T& other) const { return has_value() ? value_ : other; }
  void reset() { value_ = Absence<T>::absent(); }
  friend bool operator==(const CompactOptional& a, const std::optional<T>& b) {
    return b ? a.has_value() && *a == *b : !a.has_value();
  }

 private:
  T value_ = Absence<T>::absent();
};

}  // namespace hotblade::pipeline
