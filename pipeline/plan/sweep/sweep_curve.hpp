// One elastica from its middle to both sides, with its derivatives: what a section of a swept family needs.
//
// In the axes of its middle point, tangent along x, the curve obeys theta' = kappa + tension2 x - tension1 y
// (MidState's tensions). The variational equations for kappa and both tensions are solved with it, by the
// classical fourth-order steps of Runge and Kutta; between the nodes the curve goes on as a Taylor series.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <optional>
#include <span>
#include <vector>

#include "elastica/kernels/simd.hpp"

namespace hotblade::pipeline {

// What bends the curve: kappa in 1/mm, tensions in 1/mm^2.
struct Bend {
  double kappa = 0, tension1 = 0, tension2 = 0;
};

// A point of the curve, and how it moves with kappa, tension1 and tension2 at a fixed arc length.
struct SweepPoint {
  Eigen::Vector2d position{0, 0}, tangent{1, 0};
  double theta = 0, kappa = 0;
  Eigen::Matrix<double, 2, 3> by_bend = Eigen::Matrix<double, 2, 3>::Zero();
  Eigen::RowVector3d theta_by_bend{0, 0, 0}, kappa_by_bend{0, 0, 0};

  [[nodiscard]] Eigen::Vector2d normal() const { return {-tangent.y(), tangent.x()}; }  // on the left
};

class SweepCurve {
 public:
  // Reaches `reach_mm` > 0 to both sides of the middle in steps of 20 to 60 mm; or the part of it around a
  // place, from the middle on: as far as Newton's way from there to a nearest point may lead.
  struct Ask {
    Bend bend;
    double reach_mm = 0;
    std::optional<double> place_mm{};
  };
  // Returns the curves of many states, walked side by side.
  [[nodiscard]] static std::vector<SweepCurve> all(std::span<const Ask> asked,
                                                   elastica::Simd simd = elastica::best_simd());
  SweepCurve(const Bend& bend, double reach_mm);

  // Of the part that there is: its ends, where these are not the curve's own.
  [[nodiscard]] bool is_open_at(double s_mm) const {
    return (before_ < half_ && s_mm <= -before_ * step_mm_) ||
           (behind_ < half_ && s_mm >= behind_ * step_mm_);
  }
  // Of the whole curve, to either side.
  [[nodiscard]] double reach_mm() const { return half_ * step_mm_; }
  [[nodiscard]] const Bend& bend() const { return bend_; }
  // From its middle on, `behind` steps forwards and `before` backwards.
  [[nodiscard]] double step_mm() const { return step_mm_; }
  [[nodiscard]] int before() const { return before_; }
  [[nodiscard]] int behind() const { return behind_; }
  // Nodes from one end of what there is to the other, the middle among them.
  [[nodiscard]] const std::vector<SweepPoint>& nodes() const { return nodes_; }
  [[nodiscard]] SweepPoint at(double s_mm) const;  // clamped to what there is
  // Arc length of the point nearest to q, by Newton steps from `guess_mm`; an end of the curve where it lies
  // beyond.
  [[nodiscard]] double nearest(const Eigen::Vector2d& q, double guess_mm) const;

 private:
  friend class SweepWalk;
  explicit SweepCurve(const Ask& ask);  // not walked yet
  void walk();
  // The way from the node nearest to s, and the curvature with its derivatives by arc length there.
  struct Onward {
    const SweepPoint* node = nullptr;
    double d = 0, k1 = 0, k2 = 0;
    Eigen::Vector2d way{0, 0};
  };
  [[nodiscard]] Onward onward(double s) const;
  [[nodiscard]] double clamped(double s_mm) const {
    const double low = -before_ * step_mm_, high = behind_ * step_mm_;
    return s_mm > low ? std::min(s_mm, high) : low;  // no number: there too
  }

  Bend bend_;
  double step_mm_ = 0;
  int half_ = 0;                 // steps to either side, of the whole curve
  int before_ = 0, behind_ = 0;  // of what there is of it
  std::vector<SweepPoint> nodes_;
};

}  // namespace hotblade::pipeline
