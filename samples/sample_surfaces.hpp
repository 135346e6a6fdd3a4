// The sample designs as formulas, and how finely each is meshed. +z up.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

namespace hotblade::samples {

// A surface over the rectangle [0, u_mm] x [0, v_mm], meshed by u_cells x v_cells rectangles of two triangles
// each. What it promises of itself holds for the whole rectangle and is tested.
struct SampleSurface {
  std::string name;
  std::string about;  // one line for the OBJ's head
  double u_mm, v_mm;
  int u_cells, v_cells;
  Eigen::Vector3d (*point)(double u, double v);  // mm
  double chord_mm = 0.05;                        // the mesh lies within this of the formula
  double radius_mm = 150;                        // no principal curvature is sharper
  double tolerance_mm = 1;                       // of its job file
  const char* units = "mm";                      // the OBJ's: mm or m
  bool (*has)(double u, double v) = nullptr;     // is the cell around this point part of it? nullptr: all are
};

[[nodiscard]] std::vector<SampleSurface> sample_surfaces();

// Triangles that the mesh of a sample has.
[[nodiscard]] std::size_t triangle_count(const SampleSurface& surface);

// A sample with its cells divided evenly until it has about this many triangles; nothing when there is none
// of that name. The chords' height shrinks in proportion to the triangles' area.
[[nodiscard]] std::optional<SampleSurface> refined(const std::string& name, double triangles);

// The OBJ text of a sample: vertices to 1e-6 of the unit, each place once, faces counter-clockwise seen from
// the side of u x v.
[[nodiscard]] std::string obj_text(const SampleSurface& surface);

}  // namespace hotblade::samples
