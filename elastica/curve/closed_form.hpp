// Elastica in closed form, by Jacobi's elliptic functions: any point of a curve at the same cost, however
// long it is.
//
// Up to similarity an elastica is xi_k(s) = (2 E(s,k) - s, 2k (1 - cn(s,k))), E(s,k) = Int_0^s dn^2, for one
// modulus k >= 0: k < 1 with inflections, k = 1 the separatrix, k > 1 without, k = infinity the circle
// (docs/elastica.md). The elliptic functions are extended beyond 1 by the reciprocal modulus:
//   sn(u,k) = sn(ku,1/k)/k,  cn(u,k) = dn(ku,1/k),  dn(u,k) = cn(ku,1/k),  E(u,k) = (1/k) Int_0^(ku)
//   cn(v,1/k)^2 dv.
// Many samples of one modulus share one descending Landen ladder; batches run on the machine's SIMD
// (elastica/kernels/simd.hpp).
#pragma once

#include <optional>
#include <span>

#include "elastica/curve/elastica.hpp"
#include "elastica/kernels/jacobi.h"
#include "elastica/kernels/simd.hpp"

namespace hotblade::elastica {

// Where the values go: spans of one size, of which any may be empty and is then left out.
struct JacobiBatch {
  std::span<double> sn, cn, dn, e;
};

// Jacobi's functions sn, cn, dn and E at many arguments of one modulus. Errors stay below 1e-13 of max(1,
// |u|), tested against 50 digits for |u| up to three periods.
class Jacobi {
 public:
  // Throws std::logic_error unless 0 <= modulus < infinity.
  explicit Jacobi(double modulus);
  void sample(std::span<const double> u, const JacobiBatch& out, Simd simd = best_simd()) const;
  [[nodiscard]] double modulus() const { return modulus_; }
  // The least p > 0 with cn(u + p) = cn(u): 4K for k < 1, 2K(1/k)/k above, infinity at 1.
  [[nodiscard]] double period() const { return period_; }
  // The number of levels of the ladder, which is what a sample costs.
  [[nodiscard]] int levels() const { return ladder_.levels; }

 private:
  double modulus_, period_;
  hb_ladder ladder_;
};

enum class Regime { kInflectional, kSeparatrix, kWinding };

// What a curve looks like up to similarity, and where on that shape it starts.
struct Shape {
  Regime regime = Regime::kInflectional;
  double modulus = 0;  // k; infinity for a circle
  // |1 - k^2| of the inflectional, |1 - 1/k^2| of the winding, without cancellation.
  double complement_sq = 0;
  double rate = 0;   // argument per arc length: sqrt|lambda|, times k when winding; negative turning right
  double phase = 0;  // argument at s = 0, of modulus k, or 1/k when winding
  double axis = 0;   // direction of the axis, rad: atan2(lambda2, lambda1)
  double quarter_period = 0;  // K of that modulus; infinity on the separatrix
};

struct CurveBatch {
  std::span<double> x, y, tangent_x, tangent_y, kappa;  // any may be empty
};

// A curve in closed form. There is none where it is ill conditioned: the curve turns too little for its
// length to show which shape it is (length * sqrt(kappa^2 + |lambda|) small, straight lines included); one
// Taylor piece (ElasticaCurve) is exact there.
class ClosedForm {
 public:
  // The closed form of a curve, absent where it is ill conditioned. Throws std::logic_error as ElasticaCurve
  // does, but takes any number of windings.
  [[nodiscard]] static std::optional<ClosedForm> of(const Elastica& elastica);

  [[nodiscard]] CurvePoint at(double s) const;  // any s, also outside [0, length]
  void sample(std::span<const double> s, const CurveBatch& out, Simd simd = best_simd()) const;
  [[nodiscard]] const Shape& shape() const { return shape_; }
  // The arc length after which the curvature repeats; infinity on the separatrix and on a circle.
  [[nodiscard]] double period() const;
  // The quarter period K of the ladder; it is finite on the separatrix too, where it lies beyond everything
  // that moves.
  [[nodiscard]] double quarter_argument() const;
  // The least v >= 0 at which the tangent is square to the axis: am(v) = pi/4 when winding, k sn(v) =
  // sin(pi/4) otherwise, it is absent when the curve never turns so far.
  [[nodiscard]] std::optional<double> argument_square_to_axis() const;
  // The state form, made again from the shape alone: start, axis, rate, modulus and phase.
  [[nodiscard]] Elastica state() const;

 private:
  ClosedForm() = default;
  Elastica elastica_;
  Shape shape_;
  hb_ladder ladder_{};
  hb_closed_form form_{};
};

// Writes the points of any curve at these arc lengths, by the closed form, or by Taylor pieces where those
// are better conditioned.
void sample_points(const Elastica& elastica, std::span<const double> s, const CurveBatch& out);

}  // namespace hotblade::elastica
