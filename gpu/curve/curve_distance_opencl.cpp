#include "gpu/curve/curve_distance_opencl.hpp"

namespace hotblade::gpu {

extern const char* const curve_distance_source;

CurveSearchOnDevice::CurveSearchOnDevice(const CurvePieces& curve)
    : device_(shared_opencl_device()), portions_(*device_, sizeof(Eigen::Vector2d), sizeof(Eigen::Vector2d)) {
  device_->require_fp64();
  kernel_ = device_->kernel(curve_distance_source, "curve_nearest");
  const hb_curve_whole whole = curve.whole.value_or(hb_curve_whole{});
  whole_ = device_->upload(&whole, sizeof whole);
  pieces_ = device_->upload(curve.pieces.data(), curve.pieces.size() * sizeof(hb_curve_piece));
  kernel_.set(0, whole_);
  kernel_.set(1, static_cast<int>(curve.whole.has_value()));
  kernel_.set(2, pieces_);
  kernel_.set(3, static_cast<int>(curve.pieces.size()));
  kernel_.set(4, curve.sag);
}

void CurveSearchOnDevice::nearest(std::size_t count, const Fill& fill, const Take& take) const {
  const std::lock_guard lock(turn_);
  portions_.run(
      *device_, kernel_, 5, count,
      [&](std::size_t first, std::size_t n, void* into) {
        fill(first, std::span(static_cast<Eigen::Vector2d*>(into), n));
      },
      [&](std::size_t first, std::size_t n, const void* from) {
        take(first, std::span(static_cast<const Eigen::Vector2d*>(from), n));
      });
}

}  // namespace hotblade::gpu
