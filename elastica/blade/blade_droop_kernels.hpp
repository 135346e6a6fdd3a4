// The droop of elastica/blade/gravity.hpp over SIMD lanes: the form of gravity.cpp, assembled and eliminated
// cell by cell. Only the sources that are compiled once per instruction set include it.
#pragma once

#include "elastica/blade/blade_kernels.hpp"

namespace hotblade::elastica {
namespace {

constexpr size_t kDroopInner = kDroopCells - 1;
constexpr double kDroopStep = 1.0 / kDroopCells;

// The form of one cell on (psi, phi) at its nodes 0 and 1.
struct DroopCell {
  hb_lanes psi_same, psi_other, phi_same, phi_other;
  hb_lanes both0, both1, psi0_phi1, psi1_phi0;
};

// What the elimination leaves of each inner node: inverse pivot, the block to the node before, and the right
// sides of load and constraint.
struct DroopNode {
  hb_lanes i00, i01, i11;
  hb_lanes l00, l01, l10, l11;
  hb_lanes load_psi, load_phi, mean_psi, mean_phi;
};
static_assert(kDroopInner * sizeof(DroopNode) <= kScratchDoubles * sizeof(double));

HOTBLADE_LANES_INLINE DroopCell droop_cell(const hb_elastica_field* f, const BladeTangent& at, double torsion,
                                           double upright) {
  constexpr double h = kDroopStep;
  const hb_lanes kappa = at.kappa, k2 = kappa * kappa;
  const hb_lanes compression = HB_FMA(f->l1, at.c, f->l2 * at.s);
  const hb_lanes kappa_slope = HB_FMA(f->l2, at.c, -(f->l1 * at.s));
  const hb_lanes psi2 = (torsion - 1) * k2 - compression, phi2 = (upright - 1) * k2;
  const hb_lanes psi_phi = kappa_slope * (h / 8);
  const hb_lanes psi_slope = kappa * ((1 - 2 * torsion) / 4), phi_slope = kappa * ((2 * upright - 1) / 4);
  DroopCell c;
  c.psi_same = 0.25 * h * psi2 + upright / h;
  c.psi_other = 0.25 * h * psi2 - upright / h;
  c.phi_same = 0.25 * h * phi2 + torsion / h;
  c.phi_other = 0.25 * h * phi2 - torsion / h;
  c.both0 = psi_phi - psi_slope - phi_slope;
  c.both1 = psi_phi + psi_slope + phi_slope;
  c.psi0_phi1 = psi_phi + psi_slope - phi_slope;
  c.psi1_phi0 = psi_phi - psi_slope + phi_slope;
  return c;
}

// Eliminates the nodes in order and returns the number of negative eigenvalues.
hb_lanes droop_eliminate(const BladeField& f, hb_lanes load, const DroopLanes& b, DroopNode* nodes) {
  const hb_lanes zero = HB_BROADCAST(0.0), one = HB_BROADCAST(1.0), step = HB_BROADCAST(kDroopStep);
  TangentSeries middle;
  begin(f, middle);
  go_on(f, 0.5 * kDroopStep, middle);
  DroopCell left = droop_cell(&f.field, middle.last, b.torsion, b.upright);
  hb_lanes negative = zero;
  for (size_t i = 0; i < kDroopInner; ++i) {
    go_on(f, (static_cast<double>(i) + 1.5) * kDroopStep, middle);
    const DroopCell right = droop_cell(&f.field, middle.last, b.torsion, b.upright);
    DroopNode& node = nodes[i];
    hb_lanes p00 = left.psi_same + right.psi_same, p01 = left.both1 + right.both0,
             p11 = left.phi_same + right.phi_same;
    const double rest = 0.5 - (static_cast<double>(i) + 1) * kDroopStep;
    hb_lanes load_psi = load * (-kDroopStep * rest), load_phi = zero, mean_psi = step, mean_phi = zero;
    node.l00 = left.psi_other;
    node.l01 = left.psi1_phi0;
    node.l10 = left.psi0_phi1;
    node.l11 = left.phi_other;
    if (i > 0) {
      const DroopNode& q = nodes[i - 1];
      const hb_lanes f00 = HB_FMA(node.l00, q.i00, node.l01 * q.i01),
                     f01 = HB_FMA(node.l00, q.i01, node.l01 * q.i11);
      const hb_lanes f10 = HB_FMA(node.l10, q.i00, node.l11 * q.i01),
                     f11 = HB_FMA(node.l10, q.i01, node.l11 * q.i11);
      p00 -= HB_FMA(f00, node.l00, f01 * node.l01);
      p01 -= HB_FMA(f00, node.l10, f01 * node.l11);
      p11 -= HB_FMA(f10, node.l10, f11 * node.l11);
      load_psi -= HB_FMA(f00, q.load_psi, f01 * q.load_phi);
      load_phi -= HB_FMA(f10, q.load_psi, f11 * q.load_phi);
      mean_psi -= HB_FMA(f00, q.mean_psi, f01 * q.mean_phi);
      mean_phi -= HB_FMA(f10, q.mean_psi, f11 * q.mean_phi);
    }
    const hb_lanes det = p00 * p11 - p01 * p01, inverse = one / det;
    negative += HB_SELECT(det < zero, one, HB_SELECT(p00 + p11 < zero, one + one, zero));
    node.i00 = p11 * inverse;
    node.i01 = -p01 * inverse;
    node.i11 = p00 * inverse;
    node.load_psi = load_psi;
    node.load_phi = load_phi;
    node.mean_psi = mean_psi;
    node.mean_phi = mean_phi;
    left = right;
  }
  return negative;
}

// The right sides become solutions; Int psi of both is returned.
struct DroopMeans {
  hb_lanes loaded, compliance;
};

DroopMeans droop_substitute(DroopNode* nodes) {
  DroopMeans sum = {HB_BROADCAST(0.0), HB_BROADCAST(0.0)};
  for (size_t i = kDroopInner; i-- > 0;) {
    DroopNode& node = nodes[i];
    hb_lanes a = node.load_psi, c = node.load_phi, d = node.mean_psi, e = node.mean_phi;
    if (i + 1 < kDroopInner) {
      const DroopNode& q = nodes[i + 1];
      a -= HB_FMA(q.l00, q.load_psi, q.l10 * q.load_phi);
      c -= HB_FMA(q.l01, q.load_psi, q.l11 * q.load_phi);
      d -= HB_FMA(q.l00, q.mean_psi, q.l10 * q.mean_phi);
      e -= HB_FMA(q.l01, q.mean_psi, q.l11 * q.mean_phi);
    }
    node.load_psi = HB_FMA(node.i00, a, node.i01 * c);
    node.load_phi = HB_FMA(node.i01, a, node.i11 * c);
    node.mean_psi = HB_FMA(node.i00, d, node.i01 * e);
    node.mean_phi = HB_FMA(node.i01, d, node.i11 * e);
    sum.loaded = HB_FMA(node.load_psi, HB_BROADCAST(kDroopStep), sum.loaded);
    sum.compliance = HB_FMA(node.mean_psi, HB_BROADCAST(kDroopStep), sum.compliance);
  }
  return sum;
}

[[maybe_unused]] void droops_of(const DroopLanes& b, size_t n) {
  DroopNode* nodes = reinterpret_cast<DroopNode*>(b.scratch);
  const hb_lanes zero = HB_BROADCAST(0.0), one = HB_BROADCAST(1.0);
  for (size_t i = 0; i < n; i += HB_LANES) {
    const size_t count = n - i < HB_LANES ? n - i : HB_LANES;
    const hb_lanes first = hb_load(b.first + i, count), last = hb_load(b.last + i, count);
    const hb_lanes negative =
        droop_eliminate(load_blades(b.blades, i, count), hb_load(b.load + i, count), b, nodes);
    const DroopMeans means = droop_substitute(nodes);
    const hb_lanes pull = means.loaded / means.compliance;
    hb_lanes before = zero, shift = zero, most_shift = zero, most_twist = zero;
    for (size_t k = 0; k <= kDroopInner; ++k) {
      const bool inner = k < kDroopInner;
      const hb_lanes psi = inner ? HB_FMA(-pull, nodes[k].mean_psi, nodes[k].load_psi) : zero;
      const hb_lanes phi = inner ? HB_FMA(-pull, nodes[k].mean_phi, nodes[k].load_phi) : zero;
      shift = HB_FMA(HB_BROADCAST(-0.5 * kDroopStep), before + psi, shift);
      before = psi;
      if (b.shifts) {
        hb_store(b.shifts + k * b.stride + i, shift, count);
        hb_store(b.twists + k * b.stride + i, phi, count);
      }
      const double node = static_cast<double>(k + 1);
      const hb_lanes_mask in = (first <= node) & (last >= node);
      const hb_lanes size = HB_ABS(shift), twist = HB_ABS(phi);
      most_shift = HB_SELECT(in & (size > most_shift), size, most_shift);
      most_twist = HB_SELECT(in & (twist > most_twist), twist, most_twist);
    }
    const hb_lanes index = negative + HB_SELECT(means.compliance > zero, one, zero);
    hb_store(b.shift + i, most_shift, count);
    hb_store(b.twist + i, most_twist, count);
    hb_store(b.stable + i, HB_SELECT(index == one, one, zero), count);
  }
}

}  // namespace
}  // namespace hotblade::elastica
