// The binary data of a glTF, for sources of the reader only: its buffers, and numbers in them.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "surface/read/gltf_json.hpp"

namespace hotblade::surface {

// glTF's numbers of the types that are read.
inline constexpr std::size_t kGltfUint8 = 5121, kGltfUint16 = 5123, kGltfUint32 = 5125, kGltfFloat = 5126;

// A list of vectors or numbers in a buffer, all of which are there.
struct GltfList {
  std::string_view bytes;  // from the first one on
  std::size_t count = 0, stride = 0;
  std::size_t component = 0;  // glTF's number of the type
  std::string path;           // of its accessor
};

class GltfBuffers {
 public:
  // `chunk` is the binary chunk of a GLB; null data without one. What is given has to outlive this.
  GltfBuffers(const GltfJson& root, std::string_view chunk, const std::filesystem::path& file,
              const std::function<std::string(const std::filesystem::path&)>& read_file);

  // Returns what an accessor, named by its number, holds. `type` is the shape that it has to have (VEC3 or
  // SCALAR), `components` the types it may have.
  [[nodiscard]] GltfList list(const GltfJson& accessor_number, std::string_view type,
                              std::span<const std::size_t> components);

  // Returns the bytes of the files beside, in the order of the buffers.
  [[nodiscard]] std::string take_beside();

 private:
  std::string_view bytes_of(const GltfJson& buffer, std::size_t index);
  std::string load(const GltfJson& uri, bool& beside);
  [[nodiscard]] std::filesystem::path path_beside(const GltfJson& uri) const;

  struct Buffer {
    bool loaded = false, beside = false;
    std::string own;  // unless it is the chunk
    std::string_view bytes;
  };

  const GltfJson& root_;
  std::string_view chunk_;
  std::filesystem::path file_;
  const std::function<std::string(const std::filesystem::path&)>& read_file_;
  std::vector<Buffer> buffers_;
};

}  // namespace hotblade::surface
