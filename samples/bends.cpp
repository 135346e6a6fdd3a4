#include "samples/bends.hpp"

#include <array>
#include <cmath>

namespace hotblade::samples {

namespace {

using Eigen::Vector3d;

// From the axis to the inner and the outer end of each part.
constexpr double kInnerMm = 150, kOuterMm = 420, kSpanMm = kOuterMm - kInnerMm;

// Height of a circular arc of this radius over its chord from 0 to kSpanMm.
double arc_mm(double along, double radius_mm) {
  const double from_middle = along - kSpanMm / 2;
  return std::sqrt(radius_mm * radius_mm - from_middle * from_middle) -
         std::sqrt(radius_mm * radius_mm - kSpanMm * kSpanMm / 4);
}

// The place at a distance from the axis and a height, turned about z; u runs at the outer end.
Vector3d turned(double u, double out, double height) {
  const double turn = u / kOuterMm;
  return {out * std::sin(turn), out * std::cos(turn), height};
}

// A pipe's upper side.
Vector3d elbow(double u, double v) {
  return turned(u, kInnerMm + v, arc_mm(v, 260));
}

// The underside of a spiral stair, arched, that rises by 35 mm a radian.
Vector3d stair(double u, double v) {
  constexpr double kRise = 35;
  return turned(u, kInnerMm + v, kRise * u / kOuterMm + arc_mm(v, 280));
}

// A track whose outer side rises as it turns: its section rolls about its inner end.
Vector3d bank(double u, double v) {
  const double roll = 0.05 + 0.15 * u / kOuterMm, height = arc_mm(v, 300);
  return turned(u, kInnerMm + v * std::cos(roll) - height * std::sin(roll),
                v * std::sin(roll) + height * std::cos(roll));
}

}  // namespace

std::vector<SampleSurface> bends() {
  // By 0.4 rad: planes that turn farther tilt out of the level, and the blade sags in them.
  constexpr double kTurnMm = 0.4 * kOuterMm, kChordMm = 0.01, kRadiusMm = 200, kToleranceMm = 0.5;
  constexpr int kTurns = 60, kAcross = 90;
  return {
      {"elbow", "Upper side of a pipe of 260 mm radius round a corner", kTurnMm, kSpanMm, kTurns, kAcross,
       elbow, kChordMm, kRadiusMm, kToleranceMm},
      {"stair", "Underside of a spiral stair, arched, that rises by 35 mm a radian", kTurnMm, kSpanMm, kTurns,
       kAcross, stair, kChordMm, kRadiusMm, kToleranceMm},
      {"bank", "Banked track whose outer side rises as it turns", kTurnMm, kSpanMm, kTurns, kAcross, bank,
       kChordMm, kRadiusMm, kToleranceMm},
  };
}

pipeline::Settings bend_settings(const SampleSurface& bend) {
  pipeline::Settings settings;
  settings.design.units = bend.units;
  settings.design.keep = pipeline::Keep::kBelow;
  settings.design.tolerance_mm = bend.tolerance_mm;
  settings.slice.fan_axis = std::array<double, 6>{0, 0, 0, 0, 0, 1};
  settings.blade.thickness_mm = 0.65;
  settings.blade.free_lengths_mm = {400, 450, 500, 550, 600};
  return settings;
}

robot::Melt bend_foam() {
  return {{{1, 2.6}, {3, 1.6}, {7, 1.0}, {15, 0.7}}, 0, 0};
}

}  // namespace hotblade::samples
