// Poses on the grids that programs are written in.
//
// A program's numbers are its doubles' shortest texts, so a double with 17 digits costs a pose a kilobyte,
// and most of those digits say nothing. Poses are therefore put on grids before they are measured: what is
// judged, verified and streamed is what the file says.
#pragma once

#include <span>

#include "pipeline/program/program.hpp"

namespace hotblade::pipeline {

// Rounds where the blade and both clamps are: lengths to 1e-8 mm, unit vectors, quaternions and angles to
// 1e-12, curvatures and lambdas to 12 digits. That moves no point of a blade of 3 m by more than 1e-7 mm.
void round_geometry(std::span<BladePose> poses);

// Rounds the margins that a pose is judged by to 6 digits; that of the clamps, a bound from below, down.
void round_judgement(std::span<BladePose> poses);

// Returns one of a pose's loads as programs have it: 6 digits, and kLargestLoad at most.
[[nodiscard]] float load_of(double value);

// Rounds both arms' joints to 1e-11 rad, which is 3e-8 mm at a reach of 3 m.
void round_joints(std::span<ClampJoints> joints);

}  // namespace hotblade::pipeline
