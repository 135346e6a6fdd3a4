#include "samples/sample_surfaces.hpp"

#include <cmath>
#include <cstdio>
#include <numbers>

namespace hotblade::samples {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

// Parabolic arches of 500 mm span whose rise grows from 80 to 140 mm along the vault.
Vector3d barrel_vault(double u, double v) {
  const double rise = 110 - 30 * std::cos(pi * u / 900);
  const double across = (v - 250) / 250;
  return {u, v, rise * (1 - across * across)};
}

// Every level is one period of a sine, with its inflection half-way; the amplitude grows from 60 to 80 mm
// upwards.
Vector3d s_wall(double u, double v) {
  const double amplitude = 70 - 10 * std::cos(pi * v / 400);
  return {u, amplitude * std::sin(2 * pi * u / 700), v};
}

// Straight along x and along y, corners 60 mm up and down.
Vector3d hypar(double u, double v) {
  const double x = u - 300, y = v - 300;
  return {x, y, 60 * (x / 300) * (y / 300)};
}

double hill(double u, double v, double centre_u, double centre_v, double width, double height) {
  const double du = u - centre_u, dv = v - centre_v;
  return height * std::exp(-(du * du + dv * dv) / (2 * width * width));
}

// Two hills of different size on a slanted wave.
Vector3d bump(double u, double v) {
  const double wave = 2.5 * std::sin(2 * pi * (u + 0.5 * v) / 540);
  return {u, v, hill(u, v, 270, 240, 180, 60) + hill(u, v, 660, 370, 140, 32) + wave};
}

}  // namespace

std::vector<SampleSurface> sample_surfaces() {
  return {
      {"barrel_vault", "Barrel vault, 900 x 500 mm, rise 80 to 140 mm", 900, 500, 42, 72, barrel_vault},
      {"s_wall", "S-shaped wall, 700 mm long, 400 mm high, amplitude 60 to 80 mm", 700, 400, 116, 26, s_wall},
      {"hypar", "Hyperbolic paraboloid, 600 x 600 mm, corners 60 mm up and down", 600, 600, 48, 48, hypar},
      {"bump", "Free-form hills, 900 x 600 mm", 900, 600, 78, 51, bump},
  };
}

std::string obj_text(const SampleSurface& surface) {
  std::string text =
      "# " + surface.about + "\n# Units: mm, +z up. Written by make_samples.\no " + surface.name + "\n";
  char line[96];
  for (int j = 0; j <= surface.v_cells; ++j) {
    for (int i = 0; i <= surface.u_cells; ++i) {
      // Rounded before adding zero, so that no zero is written as -0.000000.
      const Vector3d p =
          surface.point(surface.u_mm * i / surface.u_cells, surface.v_mm * j / surface.v_cells);
      const Vector3d rounded = (p * 1e6).array().round() / 1e6 + 0.0;
      std::snprintf(line, sizeof line, "v %.6f %.6f %.6f\n", rounded.x(), rounded.y(), rounded.z());
      text += line;
    }
  }
  const int row = surface.u_cells + 1;
  for (int j = 0; j < surface.v_cells; ++j) {
    for (int i = 0; i < surface.u_cells; ++i) {
      const int a = j * row + i + 1;
      std::snprintf(line, sizeof line, "f %d %d %d\nf %d %d %d\n", a, a + 1, a + row + 1, a, a + row + 1,
                    a + row);
      text += line;
    }
  }
  return text;
}

}  // namespace hotblade::samples
