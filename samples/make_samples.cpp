// Writes the sample designs: make_samples DIRECTORY
#include <filesystem>
#include <fstream>
#include <iostream>

#include "samples/sample_surfaces.hpp"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: make_samples DIRECTORY\n";
    return 2;
  }
  for (const auto& surface : hotblade::samples::sample_surfaces()) {
    const std::filesystem::path file = std::filesystem::path(argv[1]) / (surface.name + ".obj");
    std::ofstream out(file, std::ios::binary);
    out << hotblade::samples::obj_text(surface);
    out.close();
    if (!out) {
      std::cerr << file.string() << ": cannot write: does the directory exist?\n";
      return 7;
    }
  }
  return 0;
}
