#include "surface/read/gltf_json.hpp"

#include <cmath>

#include "surface/read/design_surface.hpp"
#include "surface/read/words.hpp"

namespace hotblade::surface {

nlohmann::json GltfJson::parse(std::string_view text, const std::string& name, std::size_t first_byte) {
  const auto bad_byte = [&](std::size_t byte) {
    return MeshError(name + ": byte " + std::to_string(first_byte + byte) +
                     ": not the JSON of a glTF: it is cut short or damaged, export it again");
  };
  // The parser takes a NUL for the end. At the very end they fill a chunk up, as some programs write it.
  const std::size_t nul = text.find('\0');
  if (nul != std::string_view::npos && text.find_first_not_of('\0', nul) != std::string_view::npos)
    throw bad_byte(nul + 1);
  try {
    return nlohmann::json::parse(text);
  } catch (const nlohmann::json::parse_error& error) {
    throw bad_byte(error.byte);
  } catch (const nlohmann::json::exception& error) {
    throw MeshError(name + ": not the JSON of a glTF (" + shown_token(error.what()) + "): export it again");
  }
}

void GltfJson::fail(const std::string& what) const {
  throw MeshError(*name_ + ": " + (path_.empty() ? "glTF" : path_) + ": " + what);
}

std::optional<GltfJson> GltfJson::find(const char* key) const {
  if (!value_->is_object()) fail("is no object: the file is damaged");
  const auto found = value_->find(key);
  if (found == value_->end()) return std::nullopt;
  return GltfJson(*found, path_ + (path_.empty() ? "" : ".") + key, *name_);
}

GltfJson GltfJson::field(const char* key) const {
  if (std::optional<GltfJson> found = find(key)) return *std::move(found);
  fail(std::string("has no ") + key + ": the file is damaged");
}

std::size_t GltfJson::size() const {
  if (!value_->is_array()) fail("is no array: the file is damaged");
  return value_->size();
}

GltfJson GltfJson::item(std::size_t index) const {
  if (index >= size()) fail("has no item " + std::to_string(index) + ": the file is damaged");
  return GltfJson((*value_)[index], path_ + "[" + std::to_string(index) + "]", *name_);
}

GltfJson GltfJson::named_item(const char* key, const GltfJson& root) const {
  const std::size_t index = count();
  const std::optional<GltfJson> list = root.find(key);
  const std::size_t items = list ? list->size() : 0;
  if (index >= items) {
    fail("out of range (" + std::to_string(index) + ", the file has " + std::to_string(items) + " " + key +
         "): the file is damaged");
  }
  return list->item(index);
}

std::size_t GltfJson::count() const {
  constexpr double kMost = 9007199254740992.0;  // 2^53: beyond, JSON's numbers are not exact
  const double value = number();
  if (value < 0 || value > kMost || value != std::floor(value))
    fail("is no count (" + shown_token(value_->dump()) + "): a whole number from 0 is due");
  return static_cast<std::size_t>(value);
}

double GltfJson::number() const {
  if (!value_->is_number()) fail("is no number: the file is damaged");
  const double value = value_->get<double>();
  if (!std::isfinite(value)) fail("is no finite number: repair the node in the CAD program");
  return value;
}

std::string GltfJson::text() const {
  if (!value_->is_string()) fail("is no text: the file is damaged");
  return value_->get<std::string>();
}

std::size_t GltfJson::count_or(const char* key, std::size_t absent) const {
  const std::optional<GltfJson> found = find(key);
  return found ? found->count() : absent;
}

}  // namespace hotblade::surface
