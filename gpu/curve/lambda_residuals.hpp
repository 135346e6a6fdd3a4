// Computes the lambda-residuals of many cubic Beziers on either backend, by the formulas of
// elastica/kernels/graded_residual.h (what the residual is: elastica/bezier/lambda_residual.hpp). Backends
// and instruction sets differ by no more than their error bounds together; the number of threads changes no
// bit.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include "gpu/backend/backend.hpp"

namespace hotblade::gpu {

// Says whether a residual has a value; the order is that of the kernel's codes.
enum class ResidualStatus : std::uint8_t {
  kOk,
  kStraight,   // e = 0 by definition
  kCusp,       // the derivative vanishes somewhere: e has no value; near such a place it goes to 1
  kNotFinite,  // a coordinate is NaN, infinite, or beyond 1e140
};

// Answers concurrent queries safely.
class LambdaResiduals {
 public:
  explicit LambdaResiduals(Backend backend = Backend::kCpu);
  ~LambdaResiduals();
  LambdaResiduals(LambdaResiduals&&) noexcept;
  LambdaResiduals& operator=(LambdaResiduals&&) noexcept;

  // Writes e[i] and status[i] of curve i, by its control points, and bound[i], by which e[i] is off at most;
  // e and bound are 0 where the status is not kOk. An empty span of bounds asks for none. It runs on all
  // cores allowed. Throws std::logic_error when the spans differ in size.
  void query(std::span<const std::array<Eigen::Vector2d, 4>> curves, std::span<double> e,
             std::span<ResidualStatus> status, std::span<double> bound = {}) const;

  // Returns what answered the last query, and why.
  [[nodiscard]] BackendUse used() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hotblade::gpu
