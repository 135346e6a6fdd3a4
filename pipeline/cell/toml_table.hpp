// A table of a TOML file, read key by key: every value is checked where it stands, and keys that nobody asked
// for are errors. Messages read `file:line: arm[0].base.p: what`.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hotblade::pipeline {

class TomlTable {
 public:
  // Throws Error (kBadSettings) where the text is no TOML.
  static TomlTable parse(const std::string& text, const std::string& file);
  TomlTable(TomlTable&&) noexcept;
  ~TomlTable();

  // Throws Error (kBadSettings) naming the key's line, or the table's.
  [[noreturn]] void fail(std::string_view key, const std::string& what) const;

  [[nodiscard]] bool has(std::string_view key) const;
  // Each returns the value of a key, absent where the key is not there.
  [[nodiscard]] std::optional<std::string> text(std::string_view key);
  [[nodiscard]] std::optional<bool> flag(std::string_view key);
  [[nodiscard]] std::optional<double> number(std::string_view key, double least, double most);
  [[nodiscard]] std::optional<int> whole(std::string_view key, int least, int most);
  template <std::size_t N>
  [[nodiscard]] std::optional<std::array<double, N>> numbers(std::string_view key, double least,
                                                             double most) {
    const auto values = list(key, N, least, most);
    if (!values) return std::nullopt;
    std::array<double, N> fixed;
    for (std::size_t i = 0; i < N; ++i) fixed[i] = (*values)[i];
    return fixed;
  }
  [[nodiscard]] std::optional<TomlTable> table(std::string_view key);
  // The tables of an array, none where the key is not there.
  [[nodiscard]] std::vector<TomlTable> tables(std::string_view key);

  // Throws Error for the first key that was not read.
  void expect_all_read() const;

 private:
  struct Content;
  explicit TomlTable(std::unique_ptr<Content> content);
  [[nodiscard]] std::optional<std::vector<double>> list(std::string_view key, std::size_t count, double least,
                                                        double most);
  std::unique_ptr<Content> content_;
};

}  // namespace hotblade::pipeline
