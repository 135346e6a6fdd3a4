// Meshes with known geometry, and a way to hand OBJ text to the reader.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numbers>
#include <random>
#include <string>

#include "surface/read/design_surface.hpp"

namespace hotblade::surface {

// A file in the test's own folder under the build, removed at the end of its scope.
class ScratchFile {
 public:
  explicit ScratchFile(const std::string& content, const std::string& name = "in.obj") {
    static std::mt19937_64 random{std::random_device{}()};
    folder_ = std::filesystem::temp_directory_path() / ("hotblade_surface_" + std::to_string(random()));
    std::filesystem::create_directories(folder_);
    path_ = folder_ / name;
    std::ofstream(path_, std::ios::binary) << content;
  }
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;
  ~ScratchFile() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

 private:
  std::filesystem::path folder_, path_;
};

inline DesignSurface read_text(const std::string& obj, const ReadOptions& options = {"mm", 'z'}) {
  const ScratchFile file(obj);
  return read_obj(file.path(), options);
}

// The message of the exception E that f throws; fails the comparison it is used in when there is none.
template <class E>
std::string message_of(const std::function<void()>& f) {
  try {
    f();
  } catch (const E& e) {
    return e.what();
  }
  return "(nothing thrown)";
}

inline DesignSurface from_mesh(TriangleSoup soup) {
  DesignSurface design;
  design.mesh = TriangleMesh(std::move(soup));
  return design;
}

// A grid of columns x rows cells over parameters in [0, 1]^2; `keep(i, j)` says which cells have faces.
inline TriangleSoup grid(
    int columns, int rows, const std::function<Eigen::Vector3d(double, double)>& f,
    const std::function<bool(int, int)>& keep = [](int, int) { return true; }, bool wrap = false) {
  TriangleSoup mesh;
  const int stride = wrap ? columns : columns + 1;
  for (int j = 0; j <= rows; ++j) {
    for (int i = 0; i < stride; ++i) {
      mesh.vertices.push_back(f(static_cast<double>(i) / columns, static_cast<double>(j) / rows));
    }
  }
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      if (!keep(i, j)) continue;
      const int a = j * stride + i, b = j * stride + (i + 1) % stride;
      mesh.triangles.push_back({a, b, b + stride});
      mesh.triangles.push_back({a, b + stride, a + stride});
    }
  }
  return mesh;
}

// Upright tube of the given radius about the z axis, normals outwards.
inline TriangleSoup tube(double radius, double height, int around, int up) {
  return grid(
      around, up,
      [=](double s, double t) {
        const double a = 2 * std::numbers::pi * s;
        return Eigen::Vector3d(radius * std::cos(a), radius * std::sin(a), height * t);
      },
      [](int, int) { return true; }, true);
}

// The part of a sphere of the given radius over a square of the given half width, normals upwards.
inline TriangleSoup dome(double radius, double half, int cells) {
  return grid(cells, cells, [=](double s, double t) {
    const double x = half * (2 * s - 1), y = half * (2 * t - 1);
    return Eigen::Vector3d(x, y, std::sqrt(radius * radius - x * x - y * y));
  });
}

inline std::string to_obj(const TriangleSoup& mesh) {
  std::string text;
  char line[120];
  for (const auto& p : mesh.vertices) {
    std::snprintf(line, sizeof line, "v %.17g %.17g %.17g\n", p.x(), p.y(), p.z());
    text += line;
  }
  for (const auto& t : mesh.triangles) {
    std::snprintf(line, sizeof line, "f %d %d %d\n", t[0] + 1, t[1] + 1, t[2] + 1);
    text += line;
  }
  return text;
}

}  // namespace hotblade::surface
