// Writes the sample designs: make_samples DIRECTORY
// or one of them in a finer mesh:   make_samples FILE.obj NAME TRIANGLES
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
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

}  // namespace

int main(int argc, char** argv) {
  if (argc == 4) {
    const double triangles = std::atof(argv[3]);
    const auto surface = hotblade::samples::refined(argv[2], triangles);
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
