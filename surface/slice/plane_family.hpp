// The planes a design is cut by: parallel ones, or a fan of half planes that turn about an axis. One number,
// the offset in mm, tells the planes of a family apart.
#pragma once

#include <Eigen/Core>
#include <stdexcept>
#include <string>

#include "surface/read/design_surface.hpp"

namespace hotblade::surface {

// A line that half planes turn about.
struct FanAxis {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();       // mm, design frame
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  // of any length but zero
};

// The design and the axis do not go together; what() reads `place: what (value, limit): hint`.
struct FanError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Parallel: plane k is { p : normal . (p - centre) = offset }. Fan: offset is the angle about the axis times
// a fixed radius, that of the outermost point of the design, so that offsets are distances between the planes
// there. A direction that is carried along by the planes is given at offset 0 and `turned` to others.
class PlaneFamily {
 public:
  PlaneFamily() = default;  // parallel planes square to x
  // Returns parallel planes: `normal` is a unit vector, and offset 0 goes through `centre`.
  [[nodiscard]] static PlaneFamily parallel(const Eigen::Vector3d& normal,
                                            const Eigen::Vector3d& centre = Eigen::Vector3d::Zero());
  // Returns a fan: offset 0 is the half plane towards `reference`, a direction that need not be square to the
  // axis; offsets grow right-handed about the axis. Throws std::logic_error when an argument is not finite,
  // the radius not positive, or the reference along the axis.
  [[nodiscard]] static PlaneFamily fan(const FanAxis& axis, const Eigen::Vector3d& reference,
                                       double radius_mm);

  [[nodiscard]] bool turns() const { return radius_mm_ > 0; }
  // Tells whether the design goes all the way round the axis: it is cut open at half a turn from offset 0
  // (surface/slice/ring.hpp).
  [[nodiscard]] bool closed() const { return closed_; }
  [[nodiscard]] double radius_mm() const { return radius_mm_; }  // 0: parallel
  // Returns a point of every plane, on the axis; of parallel planes a point of the one at offset 0. In-plane
  // coordinates are measured from it.
  [[nodiscard]] const Eigen::Vector3d& centre() const { return centre_; }
  [[nodiscard]] const Eigen::Vector3d& axis() const { return axis_; }  // unit; zero: parallel

  [[nodiscard]] double offset(const Eigen::Vector3d& p) const;              // of the plane through p
  [[nodiscard]] double distance_from_axis(const Eigen::Vector3d& p) const;  // fans only
  [[nodiscard]] double angle(double offset_mm) const;                       // rad from offset 0; 0: parallel
  // Returns the unit normal of the plane at an offset, towards larger offsets.
  [[nodiscard]] Eigen::Vector3d normal(double offset_mm) const { return turned(normal_, offset_mm); }
  // Returns a direction given at offset 0 as the plane at another offset carries it.
  [[nodiscard]] Eigen::Vector3d turned(const Eigen::Vector3d& at_zero, double offset_mm) const;
  // Return both of the plane through a point, which takes no angle.
  [[nodiscard]] Eigen::Vector3d normal_at(const Eigen::Vector3d& p) const { return turned_to(normal_, p); }
  [[nodiscard]] Eigen::Vector3d turned_to(const Eigen::Vector3d& at_zero, const Eigen::Vector3d& p) const;

  // Returns the share in [0, 1] of the way from a to b, whose offsets lie on both sides of a plane's, at
  // which it passes through the plane.
  [[nodiscard]] double crossing(const Eigen::Vector3d& a, double offset_a, const Eigen::Vector3d& b,
                                double offset_b, double offset_mm) const;

  // Returns what messages call a plane: `normal . p = 12.500 mm` or `12.500 degrees about the axis`.
  [[nodiscard]] std::string describe(double offset_mm) const;

 private:
  // By the cosine and sine of the turn.
  [[nodiscard]] Eigen::Vector3d turned_by(const Eigen::Vector3d& at_zero, double c, double s) const;

  Eigen::Vector3d normal_ = Eigen::Vector3d::UnitX(), centre_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d axis_ = Eigen::Vector3d::Zero(), reference_ = Eigen::Vector3d::Zero();
  double radius_mm_ = 0;
  bool closed_ = false;

  friend PlaneFamily fan_about(const TriangleMesh& mesh, const FanAxis& axis);
};

// Returns parallel planes for a design: offset 0 goes through the centre of its area, so that offsets and
// in-plane coordinates move and turn with the design and have the same digits wherever it lies.
[[nodiscard]] PlaneFamily parallel_about(const TriangleMesh& mesh, const Eigen::Vector3d& normal);

// Returns the fan about an axis for a design: offset 0 lies in the middle of the angle that the design takes
// up, and the radius is that of its outermost vertex. Of a design that goes all the way round it, offset 0
// lies towards that vertex. Throws FanError when the axis crosses the design or comes nearer to it than a
// millimetre.
[[nodiscard]] PlaneFamily fan_about(const TriangleMesh& mesh, const FanAxis& axis);

}  // namespace hotblade::surface
