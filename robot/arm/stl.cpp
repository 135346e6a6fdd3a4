#include "robot/arm/stl.hpp"

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "robot/arm/model_file.hpp"

namespace hotblade::robot {
namespace {

static_assert(std::endian::native == std::endian::little, "STL is little-endian");

constexpr std::size_t kHeader = 80, kCount = 4, kFacet = 50, kNormal = 12;
// Two hundred times what collision meshes of arms have: beyond, it is a model to be looked at.
constexpr std::uint32_t kMostTriangles = 1'000'000;
// No arm and no fence reaches so far: the mesh is in millimetres.
constexpr double kFarthest_mm = 1e5;

template <typename T>
T value_at(std::string_view bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

}  // namespace

std::vector<std::array<Eigen::Vector3d, 3>> parse_stl(std::string_view bytes, const std::string& name,
                                                      const Eigen::Vector3d& scale) {
  const auto fail = [&name](const std::string& what) { throw ModelError(name + ": " + what); };
  if (bytes.size() < kHeader + kCount) {
    fail(std::to_string(bytes.size()) + " bytes, a binary STL has at least " +
         std::to_string(kHeader + kCount));
  }
  const auto count = value_at<std::uint32_t>(bytes, kHeader);
  const std::size_t size = kHeader + kCount + kFacet * count;
  if (bytes.size() != size) {
    if (bytes.starts_with("solid")) fail("is a text STL: save it as binary STL");
    fail(std::to_string(bytes.size()) + " bytes, " + std::to_string(count) + " triangles make " +
         std::to_string(size) + ": is the file cut off?");
  }
  if (count == 0) fail("no triangle");
  if (count > kMostTriangles) {
    fail(std::to_string(count) + " triangles, " + std::to_string(kMostTriangles) +
         " at most: use the collision mesh, not the one for pictures");
  }
  std::vector<std::array<Eigen::Vector3d, 3>> triangles(count);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t at = kHeader + kCount + kFacet * i + kNormal + 12 * k + 4 * axis;
        const int component = static_cast<int>(axis);
        const double mm = 1000.0 * static_cast<double>(value_at<float>(bytes, at)) * scale[component];
        if (!std::isfinite(mm)) fail("triangle " + std::to_string(i) + ": a corner is not finite");
        if (std::abs(mm) > kFarthest_mm) {
          fail("triangle " + std::to_string(i) +
               ": a corner is over 100 m away: is the mesh in millimetres? "
               "URDF counts in metres");
        }
        triangles[i][k][component] = mm;
      }
    }
  }
  return triangles;
}

std::vector<std::array<Eigen::Vector3d, 3>> read_stl(const std::filesystem::path& file,
                                                     const Eigen::Vector3d& scale) {
  return parse_stl(read_model_file(file, kHeader + kCount + std::size_t{kFacet} * kMostTriangles),
                   file.string(), scale);
}

}  // namespace hotblade::robot
