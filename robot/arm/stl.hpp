// Binary STL, the meshes that URDF names.
#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace hotblade::robot {

// Returns the triangles of a binary STL in mm: its numbers, which URDF counts in metres, times `scale` each
// along its axis, times 1000. Normals and attributes are not read. Throws ModelError, the message beginning
// with `name`: too short for a header, another size than its count of triangles makes, text STL, no triangle,
// more than a million, or a corner that is not finite or over 100 m away.
[[nodiscard]] std::vector<std::array<Eigen::Vector3d, 3>> parse_stl(std::string_view bytes,
                                                                    const std::string& name,
                                                                    const Eigen::Vector3d& scale);

// The same of a file; ModelError with `missing` where it cannot be read.
[[nodiscard]] std::vector<std::array<Eigen::Vector3d, 3>> read_stl(const std::filesystem::path& file,
                                                                   const Eigen::Vector3d& scale);

}  // namespace hotblade::robot
