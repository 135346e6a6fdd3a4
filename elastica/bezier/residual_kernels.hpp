// The batch loops of the lambda-residual over SIMD lanes. Only the sources that are compiled once per
// instruction set include it (elastica/kernels/simd_lanes.h).
#pragma once

#include "elastica/kernels/simd_lanes.h"
// The lanes come first: what follows is written in them.
#include "elastica/bezier/residual_lanes.hpp"
#include "elastica/kernels/edge_residual.h"
#include "elastica/kernels/sincos.h"

namespace hotblade::elastica {
namespace {

size_t lanes_at(size_t i, size_t n) {
  return n - i < HB_LANES ? n - i : HB_LANES;
}

void store_status(uint8_t* to, hb_lanes status, size_t count) {
  for (size_t i = 0; i < count; ++i) to[i] = static_cast<uint8_t>(status[i]);
}

void residuals_of_curves(const ResidualLanes& b, size_t n) {
  for (size_t i = 0; i < n; i += HB_LANES) {
    const size_t count = lanes_at(i, n);
    const auto leg = [&](int k) { return hb_load(b.in[k] + i, count) - hb_load(b.in[k % 2] + i, count); };
    const hb_legs legs = {leg(2), leg(3), leg(4), leg(5), leg(6), leg(7)};
    const hb_residual r = hb_lambda_residual(&legs);
    hb_store(b.e + i, r.e, count);
    store_status(b.status + i, r.status, count);
  }
}

hb_edges load_edges(const ResidualLanes& b, size_t i, size_t count) {
  const hb_sincos first = hb_sincos_of(hb_load(b.in[0] + i, count));
  const hb_sincos second = hb_sincos_of(hb_load(b.in[1] + i, count));
  return {
      first.cos, first.sin, second.cos, second.sin, hb_load(b.in[2] + i, count), hb_load(b.in[3] + i, count)};
}

void residuals_of_edges(const ResidualLanes& b, size_t n) {
  for (size_t i = 0; i < n; i += HB_LANES) {
    const size_t count = lanes_at(i, n);
    const hb_edges edges = load_edges(b, i, count);
    const hb_residual r = hb_edge_residual_of(&edges);
    hb_store(b.e + i, r.e, count);
    store_status(b.status + i, r.status, count);
  }
}

void gradients_of_edges(const ResidualLanes& b, size_t n) {
  for (size_t i = 0; i < n; i += HB_LANES) {
    const size_t count = lanes_at(i, n);
    const hb_edges edges = load_edges(b, i, count);
    const hb_edge_residual r = hb_edge_residual_gradient(&edges);
    hb_store(b.e + i, r.e, count);
    hb_store(b.by_l1 + i, r.by_l1, count);
    hb_store(b.by_l2 + i, r.by_l2, count);
    store_status(b.status + i, r.status, count);
  }
}

constexpr ResidualKernels kResidualKernels = {residuals_of_curves, residuals_of_edges, gradients_of_edges};

}  // namespace
}  // namespace hotblade::elastica
