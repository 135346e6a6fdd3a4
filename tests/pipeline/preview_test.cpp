#include <gmock/gmock.h>

#include <cstdlib>
#include <set>

#include "pipeline/atomic_file.hpp"
#include "pipeline/command_error.hpp"
#include "pipeline/preview/draw.hpp"
#include "tests/pipeline/vault_program.hpp"

namespace hotblade::pipeline::preview {
namespace {

using testing::vault_program;

surface::DesignSurface vault_design(int strips) {
  using namespace testing;
  surface::DesignSurface design;
  const int columns = 24, rows = 30 * strips;
  for (int row = 0; row <= rows; ++row) {
    for (int column = 0; column <= columns; ++column) {
      const double angle = kVaultHalfAngle * (2.0 * column / columns - 1);
      design.mesh.vertices.emplace_back(kVaultRadius * std::sin(angle), kVaultStripWidth * strips * row / rows,
                                        kVaultRadius * (std::cos(angle) - std::cos(kVaultHalfAngle)));
    }
  }
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const int a = row * (columns + 1) + column, b = a + 1, c = a + columns + 1, d = c + 1;
      design.mesh.triangles.push_back({a, b, d});
      design.mesh.triangles.push_back({a, d, c});
    }
  }
  design.file_name = "vault.obj";
  design.units = "mm";
  return design;
}

TEST(Picture, IsWritten) {
  const auto design = vault_design(2);
  const Program program = vault_program({.strips = 2, .poses = 120, .half_band_mm = 0, .bulge_mm = 1.4});
  write_file_atomically("/tmp/w/vault_dev.png", png_of(scene_of(program, &design, {}), {}), true);
  write_file_atomically("/tmp/w/vault_strip.png", png_of(scene_of(program, nullptr, {}), {}), true);
  SceneOptions at;
  at.strip = "S001";
  at.at_s = 3.1;
  write_file_atomically("/tmp/w/vault_at.png", png_of(scene_of(program, &design, at), {}), true);
  write_file_atomically("/tmp/w/vault_design.png", png_of(scene_of(design), {}), true);
}

}  // namespace
}  // namespace hotblade::pipeline::preview
