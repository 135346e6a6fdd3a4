// The barrel vault that vault_program() cuts, as a design.
#pragma once

#include <utility>

#include "surface/read/design_surface.hpp"
#include "tests/pipeline/vault_program.hpp"

namespace hotblade::pipeline::testing {

inline surface::DesignSurface vault_design(int strips) {
  surface::TriangleSoup soup;
  const int columns = 24, rows = 30 * strips;
  for (int row = 0; row <= rows; ++row) {
    for (int column = 0; column <= columns; ++column) {
      const double angle = kVaultHalfAngle * (2.0 * column / columns - 1);
      soup.vertices.emplace_back(kVaultRadius * std::sin(angle), kVaultStripWidth * strips * row / rows,
                                 kVaultRadius * (std::cos(angle) - std::cos(kVaultHalfAngle)));
    }
  }
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const int a = row * (columns + 1) + column, b = a + 1, c = a + columns + 1, d = c + 1;
      soup.triangles.push_back({a, b, d});
      soup.triangles.push_back({a, d, c});
    }
  }
  surface::DesignSurface design;
  design.mesh = surface::TriangleMesh(std::move(soup));
  design.file_name = "vault.obj";
  design.units = "mm";
  return design;
}

}  // namespace hotblade::pipeline::testing
