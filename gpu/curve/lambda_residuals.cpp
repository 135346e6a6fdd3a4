#include "gpu/curve/lambda_residuals.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <functional>
#include <stdexcept>

#include "gpu/backend/backend_choice.hpp"
#include "gpu/backend/blocks.hpp"
#include "gpu/backend/opencl_portions.hpp"
#include "gpu/backend/stop.hpp"
#include "gpu/curve/curve_lanes.hpp"

namespace hotblade::gpu {

extern const char* const lambda_residuals_source;

namespace {

using Curve = std::array<Eigen::Vector2d, 4>;
using Answer = std::array<double, 4>;  // e, status, bound, none
static_assert(sizeof(Curve) == 8 * sizeof(double), "the kernels read eight numbers a curve");

// Curves of one task; with which the host is timed, and the device, which few do not fill.
constexpr std::size_t kResidualBlock = 1024, kResidualsTimed = 16384, kResidualsTimedOnDevice = 1 << 18;

class ResidualsOnDevice {
 public:
  ResidualsOnDevice() : device_(shared_opencl_device()), portions_(*device_, sizeof(Curve), sizeof(Answer)) {
    device_->require_fp64();
    kernel_ = device_->kernel(lambda_residuals_source, "lambda_residuals");
  }
  [[nodiscard]] const DeviceFacts& facts() const { return device_->facts(); }
  using Fill = std::function<void(std::size_t first, std::span<Curve> into)>;
  using Take = std::function<void(std::size_t first, std::span<const Answer> answers)>;
  void run(std::size_t count, const Fill& fill, const Take& take) const {
    const std::lock_guard lock(turn_);
    portions_.run(
        *device_, kernel_, 0, count,
        [&](std::size_t first, std::size_t n, void* into) {
          fill(first, std::span(static_cast<Curve*>(into), n));
        },
        [&](std::size_t first, std::size_t n, const void* from) {
          take(first, std::span(static_cast<const Answer*>(from), n));
        });
  }

 private:
  std::shared_ptr<const OpenClDevice> device_;
  mutable std::mutex turn_;
  mutable DeviceKernel kernel_;
  mutable DevicePortions portions_;
};

struct ResidualQuery {
  std::span<const Curve> curves;
  std::span<double> e;
  std::span<ResidualStatus> status;
  std::span<double> bound;  // or empty
  [[nodiscard]] std::size_t size() const { return curves.size(); }
  [[nodiscard]] ResidualQuery part(std::size_t first, std::size_t n) const {
    return {curves.subspan(first, n), e.subspan(first, n), status.subspan(first, n),
            bound.empty() ? bound : bound.subspan(first, n)};
  }
};

void residuals_on_host(const ResidualQuery& q) {
  const CurveLanes& lanes = curve_lanes();
  // Whole blocks, so that a curve is in the same lane whatever the number of threads.
  const std::size_t blocks = (q.size() + kResidualBlock - 1) / kResidualBlock;
  tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t block) {
    const ResidualQuery part =
        q.part(block * kResidualBlock, std::min(kResidualBlock, q.size() - block * kResidualBlock));
    lanes.residuals(part.curves.data()->data()->data(), part.size(),
                    {part.e.data(), reinterpret_cast<std::uint8_t*>(part.status.data()),
                     part.bound.empty() ? nullptr : part.bound.data()});
  });
  stop_point();
}

void residuals_on_device(const ResidualsOnDevice& device, const ResidualQuery& q) {
  device.run(
      q.size(),
      [&](std::size_t first, std::span<Curve> into) {
        for_each_in_blocks(into.size(), kResidualBlock,
                           [&](std::size_t i) { into[i] = q.curves[first + i]; });
      },
      [&](std::size_t first, std::span<const Answer> answers) {
        for_each_in_blocks(answers.size(), kResidualBlock, [&](std::size_t i) {
          q.e[first + i] = answers[i][0];
          q.status[first + i] = static_cast<ResidualStatus>(answers[i][1]);
          if (!q.bound.empty()) q.bound[first + i] = answers[i][2];
        });
      });
}

}  // namespace

struct LambdaResiduals::Impl {
  explicit Impl(Backend backend) : choice(backend) {}
  mutable BackendChoice<ResidualsOnDevice> choice;
};

LambdaResiduals::LambdaResiduals(Backend backend) : impl_(std::make_unique<Impl>(backend)) {}
LambdaResiduals::~LambdaResiduals() = default;
LambdaResiduals::LambdaResiduals(LambdaResiduals&&) noexcept = default;
LambdaResiduals& LambdaResiduals::operator=(LambdaResiduals&&) noexcept = default;

void LambdaResiduals::query(std::span<const Curve> curves, std::span<double> e,
                            std::span<ResidualStatus> status, std::span<double> bound) const {
  if (e.size() != curves.size() || status.size() != curves.size() ||
      (!bound.empty() && bound.size() != curves.size())) {
    throw std::logic_error("LambdaResiduals::query: spans of different sizes");
  }
  const ResidualQuery q{curves, e, status, bound};
  std::size_t known = 0;  // what the host answered as it was timed
  const auto device = impl_->choice.choose(
      [&] {
        known = std::min(kResidualsTimed, q.size());
        return host_seconds(q.size(), known, [&](std::size_t first, std::size_t count) {
          residuals_on_host(q.part(first, count));
        });
      },
      [] { return std::make_shared<const ResidualsOnDevice>(); },
      [&](const ResidualsOnDevice& search) {
        return device_seconds(q.size(), std::min(kResidualsTimedOnDevice, q.size()),
                              [&](std::size_t n) { residuals_on_device(search, q.part(0, n)); });
      });
  if (device) {
    try {
      residuals_on_device(*device, q);
      return;
    } catch (const DeviceError& error) {
      impl_->choice.drop(error);
    }
  }
  residuals_on_host(q.part(known, q.size() - known));
}

BackendUse LambdaResiduals::used() const {
  return impl_->choice.used();
}

}  // namespace hotblade::gpu
