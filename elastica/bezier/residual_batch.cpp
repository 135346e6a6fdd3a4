#include "elastica/bezier/residual_batch.hpp"

#include <algorithm>
#include <initializer_list>
#include <stdexcept>

#include "elastica/bezier/residual_lanes.hpp"

namespace hotblade::elastica {

namespace {

static_assert(sizeof(ResidualStatus) == 1, "the kernels write statuses as bytes");

const ResidualKernels& kernels(Simd simd) {
  if (!supported(simd))
    throw std::logic_error("residual batch: instruction set not supported by this machine");
  switch (simd) {
    case Simd::kAvx512:
      return kResidualAvx512;
    case Simd::kAvx2:
      return kResidualAvx2;
    case Simd::kBaseline:
      break;
  }
  return kResidualBaseline;
}

std::size_t common_size(std::initializer_list<std::size_t> sizes) {
  if (std::adjacent_find(sizes.begin(), sizes.end(), std::not_equal_to<>()) != sizes.end()) {
    throw std::logic_error("residual batch: spans of different sizes");
  }
  return *sizes.begin();
}

// An empty span of bounds asks for none.
std::size_t bound_size(const ResidualBatch& out) {
  return out.bound.empty() ? out.e.size() : out.bound.size();
}

double* bound_data(const ResidualBatch& out) {
  return out.bound.empty() ? nullptr : out.bound.data();
}

ResidualLanes lanes_of(const EdgeBatch& c, const ResidualBatch& out) {
  ResidualLanes lanes{};
  const double* const in[] = {c.a1.data(), c.a2.data(), c.l1.data(), c.l2.data()};
  std::copy(std::begin(in), std::end(in), lanes.in);
  lanes.e = out.e.data();
  lanes.bound = bound_data(out);
  lanes.status = reinterpret_cast<std::uint8_t*>(out.status.data());
  return lanes;
}

}  // namespace

void lambda_residuals(const BezierBatch& c, const ResidualBatch& out, Simd simd) {
  const std::size_t n =
      common_size({c.x0.size(), c.y0.size(), c.x1.size(), c.y1.size(), c.x2.size(), c.y2.size(), c.x3.size(),
                   c.y3.size(), out.e.size(), out.status.size(), bound_size(out)});
  const ResidualLanes lanes{{c.x0.data(), c.y0.data(), c.x1.data(), c.y1.data(), c.x2.data(), c.y2.data(),
                             c.x3.data(), c.y3.data()},
                            out.e.data(),
                            bound_data(out),
                            reinterpret_cast<std::uint8_t*>(out.status.data()),
                            nullptr,
                            nullptr};
  kernels(simd).curves(lanes, n);
}

void lambda_residuals(const BezierRows& c, const ResidualBatch& out, Simd simd) {
  constexpr std::size_t kNumbers = 8;
  const std::size_t n = common_size({out.e.size(), out.status.size(), bound_size(out)});
  if (c.points.size() != kNumbers * n) throw std::logic_error("residual batch: spans of different sizes");
  ResidualLanes lanes{};
  lanes.in[0] = c.points.data();
  lanes.e = out.e.data();
  lanes.bound = bound_data(out);
  lanes.status = reinterpret_cast<std::uint8_t*>(out.status.data());
  kernels(simd).rows(lanes, n);
}

void lambda_residuals(const EdgeBatch& c, const ResidualBatch& out, Simd simd) {
  const std::size_t n = common_size(
      {c.a1.size(), c.a2.size(), c.l1.size(), c.l2.size(), out.e.size(), out.status.size(), bound_size(out)});
  kernels(simd).edges(lanes_of(c, out), n);
}

void lambda_residual_gradients(const EdgeBatch& c, const ResidualBatch& out, std::span<double> by_l1,
                               std::span<double> by_l2, Simd simd) {
  const std::size_t n = common_size({c.a1.size(), c.a2.size(), c.l1.size(), c.l2.size(), out.e.size(),
                                     out.status.size(), by_l1.size(), by_l2.size(), bound_size(out)});
  ResidualLanes lanes = lanes_of(c, out);
  lanes.by_l1 = by_l1.data();
  lanes.by_l2 = by_l2.data();
  kernels(simd).gradients(lanes, n);
}

}  // namespace hotblade::elastica
