// What weight does to the blades of a swept family, over the sweep and across it.
//
// Planes lie level, sweep downwards: a blade hangs along the sweep, so that the pose at an offset forms what
// lies lower by the droop. It is planned to form just that (sweep_sections.hpp), and the droop compensates
// itself. Of a fan only the middle plane is level: in the others a blade sags in its plane too, by which
// nothing is moved.
#pragma once

#include <array>
#include <vector>

#include "pipeline/plan/ribs/rib_axes.hpp"
#include "pipeline/plan/sweep/sweep_family.hpp"
#include "robot/blade/blade.hpp"

namespace hotblade::pipeline {

// Where on its family a blade is: free length, and how far before the middle it starts.
struct SweepBlade {
  double length_mm = 0, before_mm = 0;
};

class SweepSag {
 public:
  // Solved at a few places of the sweep, on its axes; in between and across linear.
  SweepSag(const SweepFamily& family, const RibAxes& axes, const SweepBlade& blade,
           const robot::Blade& section);

  struct Value {
    double droop_mm = 0;   // along the sweep
    double twist_rad = 0;  // about the tangent
    double theta = 0;      // of the tangent, on the frame's axes
  };
  // At the blade's point with this x; clamped to the blade and to the sweep.
  [[nodiscard]] Value at(double offset_mm, double x_mm) const;

  // Largest over the part between two arc lengths from the middle: what the cut is moved by where the design
  // is so steep, in tilted planes by the sag in them too; infinite where a blade tips out of its plane.
  [[nodiscard]] double moved_mm(double arc_low_mm, double arc_high_mm, double steepest_rad) const;

  [[nodiscard]] const SweepBlade& blade() const { return blade_; }
  [[nodiscard]] bool stable() const { return stable_; }
  [[nodiscard]] double smallest_margin() const {
    return margin_;
  }  // of the blades' stability in their planes

 private:
  static constexpr std::size_t kPlaces = 15;
  // A plan of many strips keeps a thousand sags. In single precision, which is a ten-thousandth of a
  // millimetre along a blade and less of how it hangs.
  struct Node {
    float x_mm = 0, s_mm = 0;  // s from the middle
    float droop_mm = 0, twist_rad = 0, theta = 0;
  };

  double first_mm_ = 0, last_mm_ = 1, half_width_mm_ = 0;
  SweepBlade blade_;
  bool stable_ = true;
  double margin_ = 0;
  std::array<std::vector<Node>, kPlaces> nodes_;         // ascending in x
  std::array<std::vector<float>, kPlaces> in_plane_mm_;  // at the nodes; empty where planes are level
};

}  // namespace hotblade::pipeline
