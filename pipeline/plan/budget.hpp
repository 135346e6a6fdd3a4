// The error budget: what each step of the chain may add, in mm, each line computed on its own.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "pipeline/program.hpp"
#include "pipeline/settings.hpp"
#include "surface/design_surface.hpp"

namespace hotblade::pipeline {

// Sag of the blade's middle out of a horizontal rib plane, clamped ends, section upright:
// rho A g l^4 / (384 E I), I = thickness width^3 / 12 (clamped beam under its own weight).
[[nodiscard]] double droop_mm(const BladeSettings& blade, double length_mm);

// Height of the mesh's chords over the surface it stands for, from the angle between neighbouring faces: 99%
// of the edges stay below; creases are the design's own.
[[nodiscard]] double mesh_chord_mm(const surface::TriangleMesh& mesh);

// Lines: mesh, fit, between_ribs, interpolation, quantisation, gravity_droop.
[[nodiscard]] std::vector<std::pair<std::string, double>> error_budget(const surface::DesignSurface& design,
                                                                       const Settings& settings,
                                                                       const Program& program);

}  // namespace hotblade::pipeline
