// How far what a cell really cuts is from the design.
#pragma once

#include "pipeline/calibrate/cut_mesh.hpp"
#include "pipeline/calibrate/registration.hpp"
#include "pipeline/verify/verify.hpp"

namespace hotblade::pipeline::testing {

// Returns the largest distance, mm, from the design of what a cell with these errors cuts of a program of one
// strip: where it was cut, or laid where it fits the design best, as a part that was taken off its table.
// From the cut to the design alone: a cut that stands aside by a millimetre leaves a strip of the design bare
// in the program's grid, but not in foam, as the blade goes on past the design.
inline double true_deviation_mm(const Program& program, const ErrorVector& truth,
                                const surface::DesignSurface& design, bool laid_best) {
  constexpr double kSampleMm = 2.5;
  SweptSurface cut = cut_with(thinned_to(program, 0, kSampleMm), truth, kSampleMm);
  SweptSurface should;
  should.vertices.assign(design.mesh.vertices().begin(), design.mesh.vertices().end());
  should.triangles.assign(design.mesh.triangles().begin(), design.mesh.triangles().end());
  constexpr int kRounds = 60;
  const Eigen::Isometry3d fit = !laid_best ? Eigen::Isometry3d::Identity()
                                           : drawn_to(CutMesh(should), some_of(cut.vertices, 4000),
                                                      Eigen::Isometry3d::Identity(), kRounds)
                                                 .scan_to_design;
  // The cut stands towards the waste by nothing: its vertices are on the band's edge already.
  for (Eigen::Vector3d& p : cut.vertices) p = fit * p;
  for (Eigen::Vector3d& n : cut.normals) n = fit.linear() * n;
  for (Eigen::Vector3d& n : cut.plane_normals) n = fit.linear() * n;
  VerifyOptions options;
  options.edge_mm = 1;
  return measure(cut, program, design, options).strip_max_mm.at(0);
}

}  // namespace hotblade::pipeline::testing
