// The residual by 24 nodes alone, without its bound: what the batch is measured against. Only for sources
// that are compiled once per instruction set (elastica/kernels/simd_lanes.h).
#pragma once

#include "elastica/kernels/simd_lanes.h"
// Lanes first.
#include "elastica/kernels/lambda_residual.h"
#include "tests/bench/plain_residuals.hpp"

namespace {

void residuals_by_24_nodes(const double* const* in, double* e, size_t n) {
  for (size_t i = 0; i < n; i += HB_LANES) {
    const size_t count = n - i < HB_LANES ? n - i : HB_LANES;
    const auto leg = [&](int k) { return hb_load(in[k] + i, count) - hb_load(in[k % 2] + i, count); };
    hb_legs p = {leg(2), leg(3), leg(4), leg(5), leg(6), leg(7)};
    const hb_lanes frame = hb_unit_frame(&p);
    const hb_cubic c = hb_cubic_of_legs(&p);
    const hb_lanes shape = hb_residual_status(&p, &c);
    hb_nodes nodes;
    const hb_moments m = hb_residual_moments(&c, &nodes);
    const hb_affine f = hb_affine_of_moments(&c, &m);
    const hb_lanes value = hb_root_share(hb_squared_misfit(&nodes, &f), m.kk);
    const hb_lanes zero = HB_BROADCAST(0.0), half = HB_BROADCAST(0.5);
    hb_store(e + i, HB_SELECT(frame > half, zero, HB_SELECT(shape > half, zero, value)), count);
  }
}

}  // namespace
