#include "surface/read/gltf_buffers.hpp"

#include <algorithm>
#include <span>

#include "surface/read/words.hpp"

namespace hotblade::surface {
namespace {

std::size_t bytes_of_component(std::size_t component) {
  if (component == kGltfUint8) return 1;
  return component == kGltfUint16 ? 2 : 4;
}

// Absent for text that is no base64.
std::optional<std::string> decode_base64(std::string_view text) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::array<int, 256> value;
  value.fill(-1);
  for (std::size_t i = 0; i < kDigits.size(); ++i)
    value[static_cast<unsigned char>(kDigits[i])] = static_cast<int>(i);
  if (text.size() % 4 == 0 && text.ends_with('=')) text.remove_suffix(text.ends_with("==") ? 2 : 1);
  if (text.size() % 4 == 1) return std::nullopt;
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3 + 2);
  unsigned int bits = 0;
  int held = 0;
  for (const char c : text) {
    const int digit = value[static_cast<unsigned char>(c)];
    if (digit < 0) return std::nullopt;
    bits = bits << 6 | static_cast<unsigned int>(digit);
    held += 6;
    if (held < 8) continue;
    held -= 8;
    bytes += static_cast<char>(bits >> held & 0xffU);
  }
  return bytes;
}

// A URI's %20 and the like as bytes; absent where the digits are none.
std::optional<std::string> decode_percent(const std::string& uri) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] != '%') {
      text += uri[i];
      continue;
    }
    unsigned int value = 0;
    for (int k = 0; k < 2; ++k) {
      const char c = ++i < uri.size() ? uri[i] : '?';
      const std::size_t digit = kDigits.find(c >= 'A' && c <= 'F' ? static_cast<char>(c - 'A' + 'a') : c);
      if (digit == std::string_view::npos) return std::nullopt;
      value = 16 * value + static_cast<unsigned int>(digit);
    }
    if (value == 0) return std::nullopt;
    text += static_cast<char>(value);
  }
  return text;
}

}  // namespace

GltfBuffers::GltfBuffers(const GltfJson& root, std::string_view chunk, const std::filesystem::path& file,
                         const std::function<std::string(const std::filesystem::path&)>& read_file)
    : root_(root), chunk_(chunk), file_(file), read_file_(read_file) {
  const std::optional<GltfJson> buffers = root.find("buffers");
  buffers_.resize(buffers ? buffers->size() : 0);
}

GltfList GltfBuffers::list(const GltfJson& accessor_number, std::string_view type,
                           std::span<const std::size_t> components) {
  const GltfJson accessor = accessor_number.named_item("accessors", root_);
  if (accessor.find("sparse")) accessor.field("sparse").fail("sparse data are not read: export without them");
  if (const GltfJson given = accessor.field("type"); given.text() != type)
    given.fail("not the type that is due ('" + shown_token(given.text()) + "', " + std::string(type) + ")");
  const GltfJson component = accessor.field("componentType");
  GltfList list;
  list.path = accessor.path();
  list.component = component.count();
  if (std::find(components.begin(), components.end(), list.component) == components.end()) {
    component.fail("not a type of number that is read here (" + std::to_string(list.component) +
                   "): export without quantization");
  }
  list.count = accessor.field("count").count();
  if (list.count == 0) accessor.field("count").fail("is 0: the file is damaged");
  const std::optional<GltfJson> view_number = accessor.find("bufferView");
  if (!view_number) accessor.fail("has no bufferView: compressed or empty data are not read");
  const GltfJson view = view_number->named_item("bufferViews", root_);
  const GltfJson buffer_number = view.field("buffer");
  const GltfJson buffer = buffer_number.named_item("buffers", root_);
  const std::string_view whole = bytes_of(buffer, buffer_number.count());
  const std::size_t begin = view.count_or("byteOffset", 0), length = view.field("byteLength").count();
  if (begin > whole.size() || length > whole.size() - begin) {
    view.fail("goes beyond its buffer (" + std::to_string(begin) + " and " + std::to_string(length) +
              " bytes, the buffer has " + std::to_string(whole.size()) + "): the file is damaged");
  }
  const std::size_t item = bytes_of_component(list.component) * (type == "VEC3" ? 3 : 1);
  list.stride = view.count_or("byteStride", item);
  constexpr std::size_t kLargestStride = 252;  // of the specification
  if (list.stride < item || list.stride > kLargestStride)
    view.fail("byteStride out of range (" + std::to_string(list.stride) + ", " + std::to_string(item) +
              " to 252): the file is damaged");
  const std::size_t offset = accessor.count_or("byteOffset", 0);
  if (offset > length || item > length - offset || list.count - 1 > (length - offset - item) / list.stride) {
    accessor.fail("goes beyond its bufferView (" + std::to_string(list.count) + " items from byte " +
                  std::to_string(offset) + ", the view has " + std::to_string(length) +
                  " bytes): the file is damaged");
  }
  list.bytes = whole.substr(begin + offset);
  return list;
}

std::string_view GltfBuffers::bytes_of(const GltfJson& buffer, std::size_t index) {
  Buffer& there = buffers_[index];
  if (there.loaded) return there.bytes;
  const std::size_t length = buffer.field("byteLength").count();
  if (const std::optional<GltfJson> uri = buffer.find("uri")) {
    there.own = load(*uri, there.beside);
    there.bytes = there.own;
  } else {
    if (index != 0 || chunk_.data() == nullptr) buffer.fail("has no uri, and there is no binary chunk");
    there.bytes = chunk_;
  }
  if (there.bytes.size() < length) {
    buffer.fail("shorter than it says (" + std::to_string(there.bytes.size()) + " bytes of " +
                std::to_string(length) + "): the file is cut short, export it again");
  }
  there.bytes = there.bytes.substr(0, length);
  there.loaded = true;
  return there.bytes;
}

std::string GltfBuffers::load(const GltfJson& uri, bool& beside) {
  const std::string text = uri.text();
  constexpr std::string_view kBase64 = ";base64,";
  if (text.starts_with("data:")) {
    const std::size_t at = text.find(kBase64);
    if (at == std::string::npos || at > 100) uri.fail("data that are not in base64 are not read");
    std::optional<std::string> bytes = decode_base64(std::string_view(text).substr(at + kBase64.size()));
    if (!bytes) uri.fail("no base64: the file is damaged");
    return *std::move(bytes);
  }
  beside = true;
  return read_file_(path_beside(uri));
}

std::filesystem::path GltfBuffers::path_beside(const GltfJson& uri) const {
  namespace fs = std::filesystem;
  const std::optional<std::string> text = decode_percent(uri.text());
  const auto refuse = [&uri] {
    uri.fail("a buffer outside the file's folder ('" + shown_token(uri.text()) +
             "'): put it beside the file, or export a GLB");
  };
  if (!text || text->empty() || text->find(':') != std::string::npos || text->find('\\') != std::string::npos)
    refuse();
  std::error_code error;
  const fs::path folder = fs::canonical(fs::absolute(file_).parent_path(), error);
  const fs::path named = fs::weakly_canonical(folder / *text, error);
  // Links are followed before they are compared.
  const auto [end, unused] = std::mismatch(folder.begin(), folder.end(), named.begin(), named.end());
  if (error || end != folder.end() || fs::path(*text).is_absolute()) refuse();
  if (fs::exists(named, error) && !fs::is_regular_file(named, error)) refuse();
  return named;
}

std::string GltfBuffers::take_beside() {
  std::string all;
  for (const Buffer& buffer : buffers_) {
    if (buffer.beside) all += buffer.own;
  }
  return all;
}

}  // namespace hotblade::surface
