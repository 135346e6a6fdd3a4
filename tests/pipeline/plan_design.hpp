// Designs made in code for the planner's tests, as read from an OBJ file.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include "pipeline/settings/settings.hpp"
#include "surface/read/design_surface.hpp"
#include "tests/pipeline/temporary_directory.hpp"

namespace hotblade::pipeline {

// A grid surface over [0, 1]^2, written as an OBJ and read back; `keep` says which cells have faces.
inline surface::DesignSurface grid_design(const std::string& name, int nu, int nv,
                                          const std::function<Eigen::Vector3d(double, double)>& p,
                                          const std::function<bool(int, int)>& keep = {}) {
  const testing::TemporaryDirectory directory;
  const std::filesystem::path file = directory / (name + ".obj");
  {
    std::ofstream out(file);
    out.precision(17);
    for (int i = 0; i <= nu; ++i) {
      for (int j = 0; j <= nv; ++j) {
        const Eigen::Vector3d q = p(static_cast<double>(i) / nu, static_cast<double>(j) / nv);
        out << "v " << q.x() << " " << q.y() << " " << q.z() << "\n";
      }
    }
    for (int i = 0; i < nu; ++i) {
      for (int j = 0; j < nv; ++j) {
        if (keep && !keep(i, j)) continue;
        const int a = i * (nv + 1) + j + 1, c = a + nv + 1;
        out << "f " << a << " " << c << " " << c + 1 << "\nf " << a << " " << c + 1 << " " << a + 1 << "\n";
      }
    }
  }
  return surface::read_obj(file, {"mm", 'z'});
}

// Part of a cylinder along x: radius 400 mm, 300 mm long, 0.6 rad wide. Its sections are elastica (circles).
inline surface::DesignSurface cylinder_design(int n = 120) {
  return grid_design("cylinder", 4, n, [](double u, double v) {
    const double phi = 0.6 * (v - 0.5);
    return Eigen::Vector3d(300 * u, 400 * std::sin(phi), 400 * std::cos(phi));
  });
}

inline Settings along_x() {
  Settings settings;
  settings.design.units = "mm";
  settings.slice.direction = {{1, 0, 0}};
  return settings;
}

inline Settings back_kept() {
  Settings settings;
  settings.design.units = "mm";
  settings.design.keep = Keep::kBack;
  return settings;
}

}  // namespace hotblade::pipeline
