// Writes the sample designs: make_samples DIRECTORY
// or one of them in a finer mesh:   make_samples FILE.obj NAME TRIANGLES
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <optional>
#include <string>

#include "samples/sample_surfaces.hpp"

namespace {

using hotblade::samples::SampleSurface;

bool written(const std::filesystem::path& file, const SampleSurface& surface) {
  std::ofstream out(file, std::ios::binary);
  out << hotblade::samples::obj_text(surface);
  out.close();
  if (!out) std::cerr << file.string() << ": cannot write: does the directory exist?\n";
  return static_cast<bool>(out);
}

// The sample with its cells divided evenly until it has about this many triangles.
std::optional<SampleSurface> refined(const std::string& name, double triangles) {
  for (SampleSurface& surface : hotblade::samples::sample_surfaces()) {
    if (surface.name != name) continue;
    const double by = std::sqrt(triangles / static_cast<double>(triangle_count(surface)));
    surface.u_cells = std::max(1, static_cast<int>(std::lround(by * surface.u_cells)));
    surface.v_cells = std::max(1, static_cast<int>(std::lround(by * surface.v_cells)));
    return surface;
  }
  return std::nullopt;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 4) {
    const double triangles = std::atof(argv[3]);
    const auto surface = refined(argv[2], triangles);
    if (!surface || !(triangles >= 2 && triangles <= 1e8)) {
      std::cerr << argv[2] << ", " << argv[3] << ": no such sample or count (2 to 100000000)\n";
      return 2;
    }
    return written(argv[1], *surface) ? 0 : 7;
  }
  if (argc != 2) {
    std::cerr << "usage: make_samples DIRECTORY | FILE.obj NAME TRIANGLES\n";
    return 2;
  }
  for (const SampleSurface& surface : hotblade::samples::sample_surfaces()) {
    if (!written(std::filesystem::path(argv[1]) / (surface.name + ".obj"), surface)) return 7;
  }
  return 0;
}
