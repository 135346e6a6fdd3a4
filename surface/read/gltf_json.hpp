// A value of glTF's JSON that knows its path, for sources of the reader only.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

namespace hotblade::surface {

class GltfJson {
 public:
  // Parses text that begins at a byte of the file. Throws MeshError with the byte where it is no JSON.
  static nlohmann::json parse(std::string_view text, const std::string& name, std::size_t first_byte);

  GltfJson(const nlohmann::json& value, std::string path, const std::string& name)
      : value_(&value), path_(std::move(path)), name_(&name) {}

  // Throws MeshError with the path.
  [[noreturn]] void fail(const std::string& what) const;

  // Of an object.
  [[nodiscard]] std::optional<GltfJson> find(const char* key) const;
  [[nodiscard]] GltfJson field(const char* key) const;
  // Of an array.
  [[nodiscard]] std::size_t size() const;
  [[nodiscard]] GltfJson item(std::size_t index) const;
  // The item that a number of the file names, of an array of the whole file, which `key` is.
  [[nodiscard]] GltfJson named_item(const char* key, const GltfJson& root) const;

  [[nodiscard]] std::size_t count() const;  // a whole number from 0 to 2^53
  [[nodiscard]] double number() const;      // a finite one
  [[nodiscard]] std::string text() const;
  // The count of a field, or what stands for it where there is none.
  [[nodiscard]] std::size_t count_or(const char* key, std::size_t absent) const;

  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  const nlohmann::json* value_;
  std::string path_;
  const std::string* name_;
};

}  // namespace hotblade::surface
