#include "gpu/curve/curve_distance.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "gpu/backend/backend_choice.hpp"
#include "gpu/backend/blocks.hpp"
#include "gpu/backend/stop.hpp"
#include "gpu/curve/curve_distance_opencl.hpp"
#include "gpu/curve/curve_lanes.hpp"
#include "gpu/curve/curve_search.hpp"

namespace hotblade::gpu {
namespace {

using Eigen::Vector2d;

// Points of one task, whose unsure ones are settled while they are in the cache.
constexpr std::size_t kBlock = 2048;
// Points that the host is timed with, and the device, which few do not fill.
constexpr std::size_t kTimed = 65536, kTimedOnDevice = 1 << 20;

// The points of a query and where their answers go.
struct Query {
  std::span<const double> x, y;
  std::span<double> distance, t;
  [[nodiscard]] std::size_t size() const { return x.size(); }
  [[nodiscard]] Query part(std::size_t first, std::size_t n) const {
    return {x.subspan(first, n), y.subspan(first, n), distance.subspan(first, n), t.subspan(first, n)};
  }
};

}  // namespace

const CurveLanes& curve_lanes() {
#if defined(__x86_64__)
  const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  if (avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl")) {
    return kCurveAvx512;
  }
  if (avx2) return kCurveAvx2;
#endif
  return kCurveBaseline;
}

struct CurveDistance::Impl {
  Impl(CurvePieces pieces, Backend backend) : curve(std::move(pieces)), choice(backend) {}

  void settle(const Query& q, std::size_t i) const;
  std::size_t on_host(const Query& q) const;
  std::size_t on_host_block(const Query& q) const;
  std::size_t on_device(const CurveSearchOnDevice& device, const Query& q) const;

  CurvePieces curve;
  CurveLanes lanes = curve_lanes();
  mutable BackendChoice<CurveSearchOnDevice> choice;
};

void CurveDistance::Impl::settle(const Query& q, std::size_t i) const {
  const Vector2d local = curve.local({q.x[i], q.y[i]});
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  const CurveNearest nearest =
      local.allFinite() ? nearest_by_search(curve, local, kErrorRel / 8) : CurveNearest{kNaN, kNaN};
  q.distance[i] = nearest.distance / curve.scale;
  q.t[i] = nearest.t;
}

// The whole curve at once where it is one polynomial, then the pieces for what is left, then the careful
// search.
std::size_t CurveDistance::Impl::on_host_block(const Query& q) const {
  std::array<unsigned, kBlock + 8> unsure, still;
  CurveQueries all{q.x.data(), q.y.data(),        curve.origin.x(), curve.origin.y(), curve.scale,
                   q.size(),   q.distance.data(), q.t.data(),       unsure.data()};
  const int count = static_cast<int>(curve.pieces.size());
  std::size_t left =
      curve.whole ? lanes.whole(*curve.whole, all) : lanes.pieces(curve.pieces.data(), count, curve.sag, all);
  if (curve.whole && left > 0) {
    std::array<std::array<double, kBlock>, 4> some;
    for (std::size_t i = 0; i < left; ++i) {
      some[0][i] = q.x[unsure[i]];
      some[1][i] = q.y[unsure[i]];
    }
    all = {some[0].data(), some[1].data(), all.ox,         all.oy,      all.scale,
           left,           some[2].data(), some[3].data(), still.data()};
    const std::size_t last = lanes.pieces(curve.pieces.data(), count, curve.sag, all);
    for (std::size_t i = 0; i < left; ++i) {
      q.distance[unsure[i]] = some[2][i];
      q.t[unsure[i]] = some[3][i];
    }
    for (std::size_t i = 0; i < last; ++i) still[i] = unsure[still[i]];
    unsure = still;
    left = last;
  }
  for (std::size_t i = 0; i < left; ++i) settle(q, unsure[i]);
  return left;
}

std::size_t CurveDistance::Impl::on_host(const Query& q) const {
  std::atomic<std::size_t> careful = 0;
  const std::size_t blocks = (q.size() + kBlock - 1) / kBlock;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, blocks), [&](const auto& range) {
    for (std::size_t block = range.begin(); block != range.end(); ++block) {
      careful += on_host_block(q.part(block * kBlock, std::min(kBlock, q.size() - block * kBlock)));
    }
  });
  stop_point();
  return careful;
}

std::size_t CurveDistance::Impl::on_device(const CurveSearchOnDevice& device, const Query& q) const {
  std::atomic<std::size_t> careful = 0;
  device.nearest(
      q.size(),
      [&](std::size_t first, std::span<Vector2d> into) {
        for_each_in_blocks(into.size(), kBlock, [&](std::size_t i) {
          into[i] = curve.local({q.x[first + i], q.y[first + i]});
        });
      },
      [&](std::size_t first, std::span<const Vector2d> answers) {
        for_each_in_blocks(answers.size(), kBlock, [&](std::size_t i) {
          if (answers[i].x() >= 0) {
            q.distance[first + i] = answers[i].x() / curve.scale;
            q.t[first + i] = answers[i].y();
          } else {
            ++careful;
            settle(q, first + i);
          }
        });
      });
  return careful;
}

CurveDistance::CurveDistance(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
CurveDistance::~CurveDistance() = default;
CurveDistance::CurveDistance(CurveDistance&&) noexcept = default;
CurveDistance& CurveDistance::operator=(CurveDistance&&) noexcept = default;

CurveDistance CurveDistance::to_cubic(const std::array<Vector2d, 4>& control, Backend backend) {
  return CurveDistance(std::make_unique<Impl>(pieces_of_cubic(control), backend));
}

CurveDistance CurveDistance::to_quadratics(std::span<const std::array<Vector2d, 3>> chain, Backend backend) {
  return CurveDistance(std::make_unique<Impl>(pieces_of_quadratics(chain), backend));
}

std::size_t CurveDistance::query(std::span<const double> x, std::span<const double> y,
                                 std::span<double> distance, std::span<double> t) const {
  if (y.size() != x.size() || distance.size() != x.size() || t.size() != x.size()) {
    throw std::logic_error("CurveDistance::query: spans of different sizes");
  }
  const Query q{x, y, distance, t};
  std::size_t known = 0, careful = 0;  // what the host answered as it was timed
  const auto device = impl_->choice.choose(
      [&] {
        known = std::min(kTimed, q.size());
        return host_seconds(q.size(), known, [&](std::size_t first, std::size_t count) {
          careful += impl_->on_host(q.part(first, count));
        });
      },
      [&] { return std::make_shared<const CurveSearchOnDevice>(impl_->curve); },
      [&](const CurveSearchOnDevice& search) {
        return device_seconds(q.size(), std::min(kTimedOnDevice, q.size()),
                              [&](std::size_t n) { (void)impl_->on_device(search, q.part(0, n)); });
      });
  if (device) {
    try {
      return impl_->on_device(*device, q);
    } catch (const DeviceError& error) {
      impl_->choice.drop(error);
    }
  }
  return careful + impl_->on_host(q.part(known, q.size() - known));
}

BackendUse CurveDistance::used() const {
  return impl_->choice.used();
}

}  // namespace hotblade::gpu
