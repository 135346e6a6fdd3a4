#include "elastica/blade/end_map.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "elastica/blade/end_map_lanes.hpp"

namespace hotblade::elastica {

namespace {

// Negative eigenvalues with the end point held: those with the end free along the force, counted by Sturm's
// oscillation theorem (zeros of d theta/d kappa inside), plus those of the Schur complement of the end-point
// constraints, minus the constraints (Haynsworth's additivity).
int index_of(const Eigen::Matrix3d& f, int zeros, bool straight) {
  // At a zero itself the complement is unbounded; a value of rounding's size keeps its sign.
  const double head = f(2, 0) != 0 ? f(2, 0) : std::numeric_limits<double>::min();
  const Eigen::Matrix2d schur = f.block<2, 2>(0, 1) - f.block<2, 1>(0, 0) * f.block<1, 2>(2, 1) / head;
  if (straight) return zeros + (schur.trace() < 0 ? 1 : 0) - 1;
  const double det = f.determinant() / head;
  return zeros + (det < 0 ? 1 : schur.trace() < 0 ? 2 : 0) - 2;
}

JacobiFields fields_of(const FieldState& a, double s) {
  // Turning below which the blade is a line to rounding: the end point cannot move along it to first order.
  constexpr double kStraight = 1e-6;
  JacobiFields f;
  f.s = s;
  f.point = {a.x, a.y, a.theta, a.kappa};
  f.fields << a.dx[0], a.dx[1], a.dx[2], a.dy[0], a.dy[1], a.dy[2], a.dtheta[0], a.dtheta[1], a.dtheta[2];
  f.rates << a.rates[0], a.rates[1], a.rates[2];
  f.index = index_of(f.fields, a.zeros, a.largest_turn < kStraight);
  return f;
}

// Pieces for a curve, at least so many.
int pieces_of(const Elastica& e, int at_least) {
  for (const double v : {e.x, e.y, e.theta, e.kappa, e.lambda1, e.lambda2, e.length}) {
    if (!std::isfinite(v)) throw std::logic_error("elastica parameters must be finite");
  }
  const double wanted =
      std::ceil(e.length * taylor_rate(e.theta, e.kappa, e.lambda1, e.lambda2) / kStepOmega);
  if (!(e.length > 0) || !(wanted <= ElasticaCurve::kMaxPieces)) {
    throw std::logic_error("elastica has no length, or winds too tightly for it to be evaluated");
  }
  return std::max(at_least, static_cast<int>(wanted));
}

FieldRun run_of(const Elastica& e, int pieces) {
  return {e.x, e.y, e.theta, e.kappa, e.lambda1, e.lambda2, e.length / pieces, pieces};
}

const EndMapKernels& end_map_kernels(Simd simd) {
  // Four lanes fill the registers of AVX2: wider ones have nothing to add.
  return simd == Simd::kBaseline ? kEndMapBaseline : kEndMapAvx2;
}

}  // namespace

JacobiFields end_map(const Elastica& elastica, Exactness exactness, Simd simd) {
  const EndMapKernels& run = end_map_kernels(simd);
  FieldState last;
  (exactness == Exactness::kSearch ? run.in_searches : run.to_rounding)(
      run_of(elastica, pieces_of(elastica, 1)), &last, 1);
  return fields_of(last, elastica.length);
}

std::vector<JacobiFields> jacobi_fields(const Elastica& elastica, int at_least, Simd simd) {
  const int n = pieces_of(elastica, std::max(1, at_least));
  std::vector<FieldState> states(static_cast<std::size_t>(n));
  end_map_kernels(simd).to_rounding(run_of(elastica, n), states.data(), n);
  std::vector<JacobiFields> all;
  all.reserve(states.size());
  const double h = elastica.length / n;
  for (const FieldState& state : states)
    all.push_back(fields_of(state, h * (static_cast<double>(all.size()) + 1)));
  return all;
}

}  // namespace hotblade::elastica
