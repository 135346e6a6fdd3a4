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

// What the elimination leaves of each inner node: the block to the node behind by this one's inverse pivot,
// and what the load and the force that holds the end would make of it, were all nodes behind at rest.
struct DroopNode {
  hb_lanes f00, f01, f10, f11;
  hb_lanes load_psi, load_phi, mean_psi, mean_phi;
};
static_assert(kDroopInner * sizeof(DroopNode) <= kScratchDoubles * sizeof(double));

// What all cells of a blade have in common. Along an elastica kappa^2 / 2 less the force along the tangent,
// lambda1 cos theta + lambda2 sin theta, is constant.
struct DroopForm {
  hb_lanes psi_alone;  // of a cell without curvature
  double psi_k2, phi_k2, psi_stiff, phi_stiff, slopes, counter_slopes;
};

HOTBLADE_LANES_INLINE DroopForm droop_form(const BladeField& f, double torsion, double upright) {
  constexpr double h = kDroopStep;
  const hb_lanes force = f.field.l1 - 0.5 * f.field.k * f.field.k;
  DroopForm form;
  form.psi_alone = -0.25 * h * force;
  form.psi_k2 = 0.25 * h * (torsion - 1.5);
  form.phi_k2 = 0.25 * h * (upright - 1);
  form.psi_stiff = upright / h;
  form.phi_stiff = torsion / h;
  // Of psi phi' and phi psi'.
  form.slopes = (1 - 2 * torsion) / 4 + (2 * upright - 1) / 4;
  form.counter_slopes = (1 - 2 * torsion) / 4 - (2 * upright - 1) / 4;
  return form;
}

HOTBLADE_LANES_INLINE DroopCell droop_cell(const DroopForm& form, const BladeBend& at) {
  const hb_lanes k2 = at.kappa * at.kappa, psi_phi = at.slope * (kDroopStep / 8);
  const hb_lanes slopes = HB_BROADCAST(form.slopes), counter = HB_BROADCAST(form.counter_slopes);
  DroopCell c;
  // The stiffness is added last: rounded into psi_alone, it would leave every cell the same error.
  const hb_lanes psi = HB_FMA(HB_BROADCAST(form.psi_k2), k2, form.psi_alone), phi = form.phi_k2 * k2;
  c.psi_same = psi + form.psi_stiff;
  c.psi_other = psi - form.psi_stiff;
  c.phi_same = phi + form.phi_stiff;
  c.phi_other = phi - form.phi_stiff;
  c.both0 = HB_FMA(-slopes, at.kappa, psi_phi);
  c.both1 = HB_FMA(slopes, at.kappa, psi_phi);
  c.psi0_phi1 = HB_FMA(counter, at.kappa, psi_phi);
  c.psi1_phi0 = HB_FMA(-counter, at.kappa, psi_phi);
  return c;
}

// Int psi under the load and under the force, and the number of negative eigenvalues of the form.
struct DroopSums {
  hb_lanes loaded, compliance, negative;
};

// Eliminates the nodes in order. The integrals are sums of products of the reduced right sides.
DroopSums droop_eliminate(const BladeField& f, hb_lanes load, const DroopLanes& b, DroopNode* nodes) {
  const hb_lanes zero = HB_BROADCAST(0.0), one = HB_BROADCAST(1.0), step = HB_BROADCAST(kDroopStep);
  const DroopForm form = droop_form(f, b.torsion, b.upright);
  TangentSeries middle;
  begin(f, kDroopStep, middle);
  DroopCell left = droop_cell(form, bend_on(f, 0.5, middle));
  DroopSums sums = {zero, zero, zero};
  hb_lanes i00 = zero, i01 = zero, i11 = zero;  // the inverse pivot of the node before and its right sides
  hb_lanes load_psi = zero, load_phi = zero, mean_psi = zero, mean_phi = zero;
  for (size_t i = 0; i < kDroopInner; ++i) {
    const DroopCell right = droop_cell(form, bend_on(f, static_cast<double>(i) + 1.5, middle));
    const hb_lanes l00 = left.psi_other, l01 = left.psi1_phi0, l10 = left.psi0_phi1, l11 = left.phi_other;
    const hb_lanes f00 = HB_FMA(l00, i00, l01 * i01), f01 = HB_FMA(l00, i01, l01 * i11);
    const hb_lanes f10 = HB_FMA(l10, i00, l11 * i01), f11 = HB_FMA(l10, i01, l11 * i11);
    const auto less = [](hb_lanes value, hb_lanes a, hb_lanes x, hb_lanes c, hb_lanes y) {
      return HB_FMA(-c, y, HB_FMA(-a, x, value));
    };
    const hb_lanes p00 = less(left.psi_same + right.psi_same, f00, l00, f01, l01),
                   p01 = less(left.both1 + right.both0, f00, l10, f01, l11),
                   p11 = less(left.phi_same + right.phi_same, f10, l10, f11, l11);
    const double rest = 0.5 - (static_cast<double>(i) + 1) * kDroopStep;
    const hb_lanes before[] = {load_psi, load_phi, mean_psi, mean_phi};
    load_psi = less(load * (-kDroopStep * rest), f00, before[0], f01, before[1]);
    load_phi = less(zero, f10, before[0], f11, before[1]);
    mean_psi = less(step, f00, before[2], f01, before[3]);
    mean_phi = less(zero, f10, before[2], f11, before[3]);
    const hb_lanes det = HB_FMA(p00, p11, -(p01 * p01)), inverse = one / det;
    sums.negative += HB_SELECT(det < zero, one, HB_SELECT(p00 < zero, one + one, zero));
    i00 = p11 * inverse;
    i01 = -p01 * inverse;
    i11 = p00 * inverse;
    if (i > 0) {
      DroopNode& last = nodes[i - 1];
      last.f00 = f00;
      last.f01 = f01;
      last.f10 = f10;
      last.f11 = f11;
    }
    DroopNode& node = nodes[i];
    node.load_psi = HB_FMA(i00, load_psi, i01 * load_phi);
    node.load_phi = HB_FMA(i01, load_psi, i11 * load_phi);
    node.mean_psi = HB_FMA(i00, mean_psi, i01 * mean_phi);
    node.mean_phi = HB_FMA(i01, mean_psi, i11 * mean_phi);
    sums.loaded = HB_FMA(mean_phi, node.load_phi, HB_FMA(mean_psi, node.load_psi, sums.loaded));
    sums.compliance = HB_FMA(mean_phi, node.mean_phi, HB_FMA(mean_psi, node.mean_psi, sums.compliance));
    left = right;
  }
  DroopNode& end = nodes[kDroopInner - 1];
  end.f00 = end.f01 = end.f10 = end.f11 = zero;
  return sums;
}

[[maybe_unused]] void droops_of(const DroopLanes& b, size_t n) {
  DroopNode* nodes = reinterpret_cast<DroopNode*>(b.scratch);
  const hb_lanes zero = HB_BROADCAST(0.0), one = HB_BROADCAST(1.0);
  for (size_t i = 0; i < n; i += HB_LANES) {
    const size_t count = n - i < HB_LANES ? n - i : HB_LANES;
    const hb_lanes first = hb_load(b.first + i, count), last = hb_load(b.last + i, count);
    const DroopSums sums =
        droop_eliminate(load_blades(b.blades, i, count), hb_load(b.load + i, count), b, nodes);
    const hb_lanes pull = sums.loaded / sums.compliance;
    // From the end, which stays in the plane, back to the start.
    hb_lanes psi = zero, phi = zero, shift = zero, most_shift = zero, most_twist = zero;
    for (size_t k = kDroopInner + 1; k-- > 0;) {
      if (b.shifts) {
        hb_store(b.shifts + k * b.stride + i, shift, count);
        hb_store(b.twists + k * b.stride + i, phi, count);
      }
      const double number = static_cast<double>(k + 1);
      const hb_lanes_mask in = (first <= number) & (last >= number);
      most_shift = HB_MAX(HB_SELECT(in, HB_ABS(shift), zero), most_shift);
      most_twist = HB_MAX(HB_SELECT(in, HB_ABS(phi), zero), most_twist);
      if (k == 0) break;
      const DroopNode& node = nodes[k - 1];
      const hb_lanes behind = psi, turn = phi;
      psi = HB_FMA(-node.f10, turn, HB_FMA(-node.f00, behind, HB_FMA(-pull, node.mean_psi, node.load_psi)));
      phi = HB_FMA(-node.f11, turn, HB_FMA(-node.f01, behind, HB_FMA(-pull, node.mean_phi, node.load_phi)));
      shift = HB_FMA(HB_BROADCAST(0.5 * kDroopStep), behind + psi, shift);
    }
    const hb_lanes index = sums.negative + HB_SELECT(sums.compliance > zero, one, zero);
    hb_store(b.shift + i, most_shift, count);
    hb_store(b.twist + i, most_twist, count);
    hb_store(b.stable + i, HB_SELECT(index == one, one, zero), count);
  }
}

}  // namespace
}  // namespace hotblade::elastica
