#include "elastica/blade/gravity.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "elastica/curve/placement.hpp"
#include "elastica/linear/solve.hpp"

namespace hotblade::elastica {

namespace {

constexpr int kSagCells = kGravityCells;
constexpr std::size_t kSagInner = kSagCells - 1;
constexpr double kStep = 1.0 / kSagCells;

// Middles of the cells, the blade scaled to length 1.
struct Middle {
  double cos = 0, sin = 0, kappa = 0;  // of theta - theta(length / 2)
  double kappa_slope = 0;              // kappa'
  double compression = 0;              // lambda1 cos theta + lambda2 sin theta
};

// The force on a blade along and across its middle tangent, the blade scaled to length 1.
Eigen::Vector2d middle_force(const Elastica& e, double turn) {
  return force_along(e, turn) * (e.length * e.length);
}

// Of a cell whose middle has a tangent at this angle to the blade's middle tangent, and this curvature.
Middle middle_of(const Eigen::Vector2d& force, double cos, double sin, double kappa) {
  const double along = force.x(), across = force.y();
  return {cos, sin, kappa, across * cos - along * sin, along * cos + across * sin};
}

std::vector<Middle> cell_middles(const ElasticaCurve& curve) {
  const Elastica& e = curve.elastica();
  const double turn = curve.at(0.5 * e.length).theta;
  const Eigen::Vector2d force = middle_force(e, turn);
  std::vector<Middle> middles;
  middles.reserve(kSagCells);
  for (int i = 0; i < kSagCells; ++i) {
    const CurvePoint p = curve.at(e.length * (i + 0.5) * kStep);
    middles.push_back(
        middle_of(force, std::cos(p.theta - turn), std::sin(p.theta - turn), p.kappa * e.length));
  }
  return middles;
}

// A symmetric block tridiagonal matrix over the inner nodes.
template <int N>
struct BlockTridiagonal {
  using Block = Eigen::Matrix<double, N, N>;
  std::vector<Block> diagonal = std::vector<Block>(kSagInner, Block::Zero());
  std::vector<Block> lower = std::vector<Block>(kSagInner, Block::Zero());  // row i, column i - 1

  // Adds a cell's form on the values at both of its nodes; those of the clamped nodes are zero.
  void add(std::size_t cell, const Eigen::Matrix<double, 2 * N, 2 * N>& form) {
    if (cell > 0) diagonal[cell - 1] += form.template topLeftCorner<N, N>();
    if (cell < kSagInner) diagonal[cell] += form.template bottomRightCorner<N, N>();
    if (cell > 0 && cell < kSagInner) lower[cell] += form.template bottomLeftCorner<N, N>();
  }
};

template <int N, int R>
struct BandSolution {
  std::vector<Eigen::Matrix<double, N, R>> x;
  int negative = 0;  // negative eigenvalues of the matrix
};

template <int N>
int negative_eigenvalues(const Eigen::Matrix<double, N, N>& block) {
  if constexpr (N == 1) return block(0, 0) < 0 ? 1 : 0;
  const double det = block.determinant();
  return det < 0 ? 1 : block.trace() < 0 ? 2 : 0;
}

// Gauss elimination by blocks; the pivots' signs are the matrix's inertia.
template <int N, int R>
BandSolution<N, R> solve(const BlockTridiagonal<N>& m, std::vector<Eigen::Matrix<double, N, R>> right) {
  std::vector<Eigen::Matrix<double, N, N>> inverse(kSagInner);
  BandSolution<N, R> solved{std::move(right), 0};
  for (std::size_t i = 0; i < kSagInner; ++i) {
    Eigen::Matrix<double, N, N> pivot = m.diagonal[i];
    if (i > 0) {
      const Eigen::Matrix<double, N, N> factor = m.lower[i] * inverse[i - 1];
      pivot -= factor * m.lower[i].transpose();
      solved.x[i] -= factor * solved.x[i - 1];
    }
    solved.negative += negative_eigenvalues<N>(pivot);
    inverse[i] = pivot.inverse();
  }
  for (std::size_t i = kSagInner; i-- > 0;) {
    if (i + 1 < kSagInner) solved.x[i] -= m.lower[i + 1].transpose() * solved.x[i + 1];
    solved.x[i] = (inverse[i] * solved.x[i]).eval();
  }
  return solved;
}

void require_finite(const Elastica& e, double load) {
  if (!std::isfinite(load)) throw std::logic_error("a load on a blade must be finite");
  if (!(e.length > 0)) throw std::logic_error("a loaded blade needs a length above 0");
}

BlockTridiagonal<1> plane_form(const std::vector<Middle>& middles) {
  BlockTridiagonal<1> form;
  const Eigen::Matrix2d slope = (Eigen::Matrix2d() << 1, -1, -1, 1).finished() / kStep;
  for (std::size_t i = 0; i < middles.size(); ++i) {
    form.add(i, slope - 0.25 * kStep * middles[i].compression * Eigen::Matrix2d::Ones());
  }
  return form;
}

// The form of elastica/blade/gravity.hpp on (psi, phi) at both nodes of a cell, by its value and slope at the
// middle: with twist phi' - kappa psi and bend psi' + kappa phi multiplied out.
Eigen::Matrix4d lateral_cell(const Middle& m, const StiffnessRatios& ratios) {
  const double t = ratios.torsion, u = ratios.upright, k2 = m.kappa * m.kappa;
  // Coefficients of psi^2, phi^2, psi phi, psi phi' and phi psi'; those of psi'^2 and phi'^2 are u and t.
  const double psi2 = (t - 1) * k2 - m.compression, phi2 = (u - 1) * k2;
  const double psi_phi = m.kappa_slope / 8 * kStep;
  const double psi_slope = m.kappa * (1 - 2 * t) / 4, phi_slope = m.kappa * (2 * u - 1) / 4;
  const double psi_same = 0.25 * kStep * psi2 + u / kStep, psi_other = 0.25 * kStep * psi2 - u / kStep;
  const double phi_same = 0.25 * kStep * phi2 + t / kStep, phi_other = 0.25 * kStep * phi2 - t / kStep;
  // Of psi and phi at the nodes 0 and 1: both at one node, then psi at one and phi at the other.
  const double both0 = psi_phi - psi_slope - phi_slope, both1 = psi_phi + psi_slope + phi_slope;
  const double psi0_phi1 = psi_phi + psi_slope - phi_slope, psi1_phi0 = psi_phi - psi_slope + phi_slope;
  Eigen::Matrix4d form;
  form << psi_same, both0, psi_other, psi0_phi1,  //
      both0, phi_same, psi1_phi0, phi_other,      //
      psi_other, psi1_phi0, psi_same, both1,      //
      psi0_phi1, phi_other, both1, phi_same;
  return form;
}

BlockTridiagonal<2> lateral_form(const std::vector<Middle>& middles, const StiffnessRatios& ratios,
                                 double shift) {
  if (!(ratios.upright > 0) || !(ratios.torsion > 0)) {
    throw std::logic_error("stiffness ratios of a blade must be positive");
  }
  BlockTridiagonal<2> form;
  for (std::size_t i = 0; i < middles.size(); ++i) form.add(i, lateral_cell(middles[i], ratios));
  for (auto& block : form.diagonal) block -= shift * kStep * Eigen::Matrix2d::Identity();
  return form;
}

// Eigenvalues of the lateral form below sigma among variations with Int psi = 0, which keep the end in the
// plane.
int lateral_eigenvalues_below(const std::vector<Middle>& middles, const StiffnessRatios& ratios,
                              double sigma) {
  const std::vector<Eigen::Vector2d> mean(kSagInner, Eigen::Vector2d(kStep, 0));
  const auto solved = solve<2, 1>(lateral_form(middles, ratios, sigma), mean);
  double compliance = 0;
  for (const auto& x : solved.x) compliance += kStep * x[0];
  return solved.negative + (compliance > 0 ? 1 : 0) - 1;
}

PlaneShift plane_shift_of(const Elastica& e, const Eigen::Vector2d& load, double turn,
                          const std::vector<Middle>& middles) {
  const double l3 = std::pow(e.length, 3);
  // The load in the axes of the middle tangent.
  const Eigen::Vector2d q = l3 * (Eigen::Rotation2Dd(-turn) * load);
  // Right sides: the load's moment about the rest of the blade, and the two constraints that keep the end
  // point.
  std::vector<Eigen::RowVector3d> right(kSagInner, Eigen::RowVector3d::Zero());
  for (std::size_t i = 0; i < middles.size(); ++i) {
    const Middle& m = middles[i];
    const double rest = 0.5 - (static_cast<double>(i) + 0.5) * kStep;
    const Eigen::RowVector3d half =
        0.5 * kStep * Eigen::RowVector3d((q.y() * m.cos - q.x() * m.sin) * rest, m.cos, m.sin);
    if (i > 0) right[i - 1] += half;
    if (i < kSagInner) right[i] += half;
  }
  const auto solved = solve<1, 3>(plane_form(middles), right);
  Eigen::Matrix2d compliance = Eigen::Matrix2d::Zero();
  Eigen::Vector2d off = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < kSagInner; ++i) {
    compliance += right[i].tail<2>().transpose() * solved.x[i].tail<2>();
    off += right[i].tail<2>().transpose() * solved.x[i][0];
  }
  // On a straight blade the second constraint is empty, and the pseudo-inverse leaves it out.
  const Eigen::Vector2d force = shortest_solution(compliance, off);
  PlaneShift result;
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();
  result.shift.push_back(shift);
  double before = 0;
  for (std::size_t i = 0; i < middles.size(); ++i) {
    const double after = i < kSagInner ? solved.x[i][0] - solved.x[i].tail<2>().dot(force) : 0;
    shift += 0.5 * kStep * (before + after) * Eigen::Vector2d(-middles[i].sin, middles[i].cos);
    before = after;
    result.shift.push_back(e.length * (Eigen::Rotation2Dd(turn) * shift));
    result.largest = std::max(result.largest, result.shift.back().norm());
  }
  return result;
}

}  // namespace

PlaneShift plane_shift(const Elastica& e, const Eigen::Vector2d& load) {
  require_finite(e, load.sum());
  const ElasticaCurve curve(e);
  return plane_shift_of(e, load, curve.at(0.5 * e.length).theta, cell_middles(curve));
}

PlaneShift plane_shift(const Elastica& e, const Eigen::Vector2d& load, const CellMiddles& at) {
  require_finite(e, load.sum());
  for (const std::size_t size : {at.cos.size(), at.sin.size(), at.curvature.size()}) {
    if (size != kSagCells) throw std::logic_error("a blade has one middle a cell");
  }
  const Eigen::Vector2d force = middle_force(e, at.turn);
  const double c = std::cos(at.turn), s = std::sin(at.turn);
  std::vector<Middle> middles;
  middles.reserve(kSagCells);
  for (std::size_t i = 0; i < kSagCells; ++i) {
    middles.push_back(middle_of(force, c * at.cos[i] + s * at.sin[i], c * at.sin[i] - s * at.cos[i],
                                at.curvature[i] * e.length));
  }
  return plane_shift_of(e, load, at.turn, middles);
}

namespace {

// The blade's answer to a load in the first column, held by the force in the second one that keeps its end in
// the plane. `first` and `last` are (psi, phi) of the clamped ends.
Droop held_in_plane(const Elastica& e, const BandSolution<2, 2>& solved, const Eigen::Vector2d& first,
                    const Eigen::Vector2d& last) {
  double loaded = 0.5 * kStep * (first[0] + last[0]), compliance = 0;
  for (const auto& x : solved.x) {
    loaded += kStep * x(0, 0);
    compliance += kStep * x(0, 1);
  }
  Droop result;
  result.stable = solved.negative + (compliance > 0 ? 1 : 0) == 1;
  result.shift.push_back(0);
  result.twist.push_back(first[1]);
  result.largest_twist = std::abs(first[1]);
  double before = first[0], shift = 0;
  for (std::size_t i = 0; i <= kSagInner; ++i) {
    const Eigen::Vector2d at =
        i < kSagInner ? Eigen::Vector2d(solved.x[i].col(0) - loaded / compliance * solved.x[i].col(1)) : last;
    shift -= 0.5 * kStep * (before + at[0]);
    before = at[0];
    result.shift.push_back(e.length * shift);
    result.twist.push_back(at[1]);
    result.largest = std::max(result.largest, std::abs(result.shift.back()));
    result.largest_twist = std::max(result.largest_twist, std::abs(at[1]));
  }
  return result;
}

}  // namespace

Droop droop(const Elastica& e, double load, const StiffnessRatios& ratios) {
  require_finite(e, load);
  const std::vector<Middle> middles = cell_middles(ElasticaCurve(e));
  std::vector<Eigen::Matrix2d> right(kSagInner, Eigen::Matrix2d::Zero());
  const double weight = -kStep * load * std::pow(e.length, 3);
  for (std::size_t i = 0; i < kSagInner; ++i) {
    const double rest = 0.5 - (static_cast<double>(i) + 1) * kStep;
    right[i].row(0) << weight * rest, kStep;
  }
  return held_in_plane(e, solve<2, 2>(lateral_form(middles, ratios, 0), right), Eigen::Vector2d::Zero(),
                       Eigen::Vector2d::Zero());
}

Droop turned_ends(const Elastica& e, const EndTurns& turns, const StiffnessRatios& ratios) {
  require_finite(e, turns.phi_a + turns.psi_a + turns.phi_b + turns.psi_b);
  const std::vector<Middle> middles = cell_middles(ElasticaCurve(e));
  const Eigen::Vector2d first(turns.psi_a, turns.phi_a), last(turns.psi_b, turns.phi_b);
  std::vector<Eigen::Matrix2d> right(kSagInner, Eigen::Matrix2d::Zero());
  for (auto& r : right) r(0, 1) = kStep;
  // What the turned ends ask of the nodes beside them.
  right.front().col(0) -= lateral_cell(middles.front(), ratios).bottomLeftCorner<2, 2>() * first;
  right.back().col(0) -= lateral_cell(middles.back(), ratios).topRightCorner<2, 2>() * last;
  return held_in_plane(e, solve<2, 2>(lateral_form(middles, ratios, 0), right), first, last);
}

double lateral_margin(const Elastica& e, const StiffnessRatios& ratios) {
  require_finite(e, 0);
  const std::vector<Middle> middles = cell_middles(ElasticaCurve(e));
  double bound = 0;
  for (const Middle& m : middles) {
    bound = std::max(bound, m.kappa * m.kappa + std::abs(m.kappa_slope) + std::abs(m.compression));
  }
  // Below: squares completed with v and u leave -kappa^2 / (4 C), -kappa^2 / (4 A) and the forces. Above:
  // twist alone, phi = sin(pi s).
  double low = -(1 + 0.25 / ratios.torsion + 0.25 / ratios.upright) * bound - 1;
  double high = 10 * ratios.torsion + ratios.upright * bound + 1;
  constexpr double kRelative = 1e-6;
  while (high - low > kRelative * (1 + std::abs(high) + std::abs(low))) {
    const double middle = 0.5 * (low + high);
    (lateral_eigenvalues_below(middles, ratios, middle) > 0 ? high : low) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace hotblade::elastica
