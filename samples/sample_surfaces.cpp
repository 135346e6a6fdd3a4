#include "samples/sample_surfaces.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string_view>
#include <unordered_map>

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

// Up along x, down along y: 70 mm at the short edges, -50 mm at the long ones.
Vector3d saddle(double u, double v) {
  const double x = (u - 500) / 500, y = (v - 400) / 400;
  return {u, v, 70 * x * x - 50 * y * y};
}

// A shallow arch that is flatter on one side.
Vector3d window(double u, double v) {
  const double across = (v - 350) / 350, rise = 70 - 20 * u / 1000;
  return {u, v, rise * (1 - across * across)};
}

bool beside_the_window(double u, double v) {
  return !(u > 350 && u < 650 && v > 245 && v < 455);
}

// Two and a half waves along 4 m; the amplitude grows from 90 to 130 mm upwards and the crests lean.
Vector3d wave_wall(double u, double v) {
  const double amplitude = 110 - 20 * std::cos(pi * v / 1000);
  return {u, amplitude * std::sin(2 * pi * (u + 0.12 * v) / 1600), v};
}

// A roof over 20 x 15 m, 3.4 m high, with a fold of the ridge to one side.
Vector3d roof(double u, double v) {
  const double x = (u - 10000) / 10000, y = (v - 7500) / 7500;
  const double arch = (1 - 0.7 * x * x) * (1 - 0.75 * y * y);
  return {u, v, 3400 * arch + 260 * std::sin(pi * x) * std::cos(0.5 * pi * y)};
}

// Round, 450 mm high, 147 to 205 mm in radius; u runs once around, at a rate that makes it 2 pi * 170 long.
Vector3d vase(double u, double v) {
  const double turn = u / 170, radius = 170 + 35 * std::sin(2 * pi * v / 620 - 0.7);
  return {radius * std::cos(turn), radius * std::sin(turn), v};
}

// One trunk that parts into two arms: a gap opens between them beyond u = 400. v counts the width without
// the gap, and 10 mm of v at the middle are the gap.
double gap_mm(double u) {
  const double t = std::max(0.0, (u - 400) / 500);
  return 150 * t * t;
}
Vector3d branch(double u, double v) {
  const double y = v <= 300 ? v - 300 - 0.5 * gap_mm(u) : v - 310 + 0.5 * gap_mm(u);
  return {u, y, 60 * std::sin(pi * u / 900) - 40 * (y / 300) * (y / 300)};
}
bool beside_the_gap(double, double v) {
  return v < 300 || v > 310;
}

// An arch whose long borders wave in and out, not in step.
Vector3d ragged(double u, double v) {
  const double low = 45 * std::sin(2 * pi * u / 310), high = 600 + 35 * std::sin(2 * pi * u / 230 + 1);
  const double y = low + (high - low) * v / 600;
  return {u, y, 90 - 90 * ((y - 300) / 330) * ((y - 300) / 330) + 25 * std::sin(pi * u / 800)};
}

// A shell arched both ways whose long borders are round: 60 mm wide at one end, 140 at the other and 530
// between them.
Vector3d petal(double u, double v) {
  const double t = u / 1000, across = v / 280 - 1;
  const double y = across * (30 + 40 * t + 215 * std::sin(pi * t));
  return {u, y, 110 * std::sin(pi * (0.15 + 0.7 * t)) - 70 * (y / 280) * (y / 280)};
}

// An arch bent round a corner: 400 mm span, its rise 80 to 100 mm, from 300 to 700 mm off the z axis, about
// which it turns by 69 degrees. u runs at 500 mm off the axis.
Vector3d corner(double u, double v) {
  const double turn = (u - 300) / 500, out = 300 + v, across = (v - 200) / 200;
  const double rise = 80 + 20 * std::sin(pi * u / 600);
  return {out * std::sin(turn), out * std::cos(turn), rise * (1 - across * across)};
}

bool has_cell(const SampleSurface& s, int i, int j) {
  return s.has == nullptr || s.has(s.u_mm * (i + 0.5) / s.u_cells, s.v_mm * (j + 0.5) / s.v_cells);
}

bool has_corner(const SampleSurface& s, int i, int j) {
  for (int b = std::max(0, j - 1); b <= std::min(j, s.v_cells - 1); ++b) {
    for (int a = std::max(0, i - 1); a <= std::min(i, s.u_cells - 1); ++a) {
      if (has_cell(s, a, b)) return true;
    }
  }
  return false;
}

}  // namespace

std::vector<SampleSurface> sample_surfaces() {
  return {
      {"barrel_vault", "Barrel vault, 900 x 500 mm, rise 80 to 140 mm", 900, 500, 42, 72, barrel_vault},
      {"s_wall", "S-shaped wall, 700 mm long, 400 mm high, amplitude 60 to 80 mm", 700, 400, 116, 26, s_wall},
      {"hypar", "Hyperbolic paraboloid, 600 x 600 mm, corners 60 mm up and down", 600, 600, 48, 48, hypar},
      {"bump", "Free-form hills, 900 x 600 mm", 900, 600, 78, 51, bump},
      {"saddle", "Saddle shell, 1000 x 800 mm, 70 mm up and 50 mm down", 1000, 800, 50, 40, saddle},
      {"window", "Arched panel with a window, 1000 x 700 mm", 1000, 700, 40, 60, window, 0.05, 150, 1, "mm",
       beside_the_window},
      {"wave_wall", "Wave wall, 4 m long, 1 m high, amplitude 90 to 130 mm", 4000, 1000, 200, 20, wave_wall,
       0.25, 400},
      {"roof", "Roof shell, 20 x 15 m, 3.4 m high, in metres", 20000, 15000, 120, 90, roof, 0.9, 4000, 4,
       "m"},
      {"vase", "Vase, 450 mm high, radius 135 to 205 mm", 170 * 2 * pi, 450, 144, 48, vase, 0.1, 130},
      {"branch", "Panel that parts into two arms, 900 mm long", 900, 610, 45, 61, branch, 0.05, 150, 1, "mm",
       beside_the_gap},
      {"ragged", "Arch with ragged borders, 800 x 600 mm", 800, 600, 60, 50, ragged, 0.13, 150},
      {"petal", "Petal of a shell, 1000 mm long, 60 to 530 mm wide", 1000, 560, 60, 36, petal, 0.1, 150, 0.5},
      {"corner", "Arch of 400 mm span bent round a corner of 69 degrees", 600, 400, 60, 44, corner, 0.1, 150},
  };
}

std::size_t triangle_count(const SampleSurface& s) {
  std::size_t cells = 0;
  for (int j = 0; j < s.v_cells; ++j) {
    for (int i = 0; i < s.u_cells; ++i) cells += has_cell(s, i, j) ? 1U : 0U;
  }
  return 2 * cells;
}

std::optional<SampleSurface> refined(const std::string& name, double triangles) {
  for (SampleSurface& surface : sample_surfaces()) {
    if (surface.name != name) continue;
    const double by = std::sqrt(triangles / static_cast<double>(triangle_count(surface)));
    surface.u_cells = std::max(1, static_cast<int>(std::lround(by * surface.u_cells)));
    surface.v_cells = std::max(1, static_cast<int>(std::lround(by * surface.v_cells)));
    surface.chord_mm /= by * by;
    return surface;
  }
  return std::nullopt;
}

std::string obj_text(const SampleSurface& s) {
  const double unit_mm = std::string_view(s.units) == "m" ? 1000 : 1;
  std::string text =
      "# " + s.about + "\n# Units: " + s.units + ", +z up. Written by make_samples.\no " + s.name + "\n";
  char line[96];
  std::unordered_map<std::string, int> places;
  std::vector<int> number;  // of the grid's corners
  for (int j = 0; j <= s.v_cells; ++j) {
    for (int i = 0; i <= s.u_cells; ++i) {
      if (!has_corner(s, i, j)) {
        number.push_back(0);
        continue;
      }
      // Rounded before adding zero, so that no zero is written as -0.000000.
      const Vector3d p = s.point(s.u_mm * i / s.u_cells, s.v_mm * j / s.v_cells) / unit_mm;
      const Vector3d rounded = (p * 1e6).array().round() / 1e6 + 0.0;
      std::snprintf(line, sizeof line, "v %.6f %.6f %.6f\n", rounded.x(), rounded.y(), rounded.z());
      const auto [place, fresh] = places.try_emplace(line, static_cast<int>(places.size()) + 1);
      if (fresh) text += line;
      number.push_back(place->second);
    }
  }
  const auto at = [&](int i, int j) { return number[static_cast<std::size_t>(j * (s.u_cells + 1) + i)]; };
  for (int j = 0; j < s.v_cells; ++j) {
    for (int i = 0; i < s.u_cells; ++i) {
      if (!has_cell(s, i, j)) continue;
      const int a = at(i, j), c = at(i + 1, j + 1);
      std::snprintf(line, sizeof line, "f %d %d %d\nf %d %d %d\n", a, at(i + 1, j), c, a, c, at(i, j + 1));
      text += line;
    }
  }
  return text;
}

}  // namespace hotblade::samples
