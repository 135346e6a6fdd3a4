#include "gpu/mesh/mesh_distance.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <mutex>
#include <optional>
#include <stdexcept>

#include "gpu/backend/backend_choice.hpp"
#include "gpu/backend/stop.hpp"
#include "gpu/mesh/mesh_distance_opencl.hpp"
#include "gpu/mesh/mesh_frame.hpp"
#include "gpu/mesh/mesh_search.hpp"
#include "gpu/mesh/mesh_side.hpp"
#include "gpu/mesh/mesh_tree.hpp"
#include "gpu/mesh/point_order.hpp"

namespace hotblade::gpu {
namespace {

using Eigen::Vector3d;

// Points answered one after the other by one thread, each search started where the answer before was.
constexpr std::size_t kBlock = 256;
// Points that share a way into the tree.
constexpr std::size_t kGroup = 16;
// The entry of a group holds what is within this many times the farthest that a start packet of the group
// before reached.
constexpr float kEntryReach = 1.5f;

// Points farther than this many mesh sizes are compared with every triangle: single precision tells no two
// triangles apart from there.
constexpr double kFar = 0x1p+20;

// Candidates a search has room for at first: more than the triangles around any ordinary vertex.
constexpr std::size_t kCandidates = 64;

// Points whose candidates are on the device while the host settles as many.
constexpr std::size_t kPortion = std::size_t{1} << 20;

// Points that both backends are timed with, spread over all.
constexpr std::size_t kTimed = 8192;

using Order = std::vector<std::uint32_t>;

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

struct MeshDistance::Impl {
  explicit Impl(Backend wanted) : choice(wanted) {}

  MeshFrame frame;
  MeshTree tree;
  MeshSearch search = mesh_search();
  mutable std::once_flag side_once;
  mutable std::optional<MeshSide> side;

  mutable BackendChoice<MeshSearchOnDevice> choice;

  // What one thread keeps from point to point.
  struct Memory {
    std::vector<Candidate> candidates{kCandidates};
    Entry entry{{}, -1};
    int packet = -1;
    float start = 0;  // farthest of the group under way
  };
  void enter(std::span<const Vector3d> local_points, Memory& memory) const;
  Nearest answer(const Vector3d& local_point, Memory& memory) const;
  Nearest settle(const Vector3d& local_point, std::span<const Candidate> candidates) const;

  using Points = std::span<const Vector3d>;
  void answer_on_host(Points points, const Order& order, std::vector<Nearest>& answers) const;
  void answer_on_device(const MeshSearchOnDevice& device, Points points, const Order& order,
                        std::vector<Nearest>& answers) const;
  void settle_portion(Points points, const Order& order, std::size_t first,
                      std::span<const MeshSearchOnDevice::Found> found, std::vector<Nearest>& answers) const;
  Eigen::Vector4f device_point(const Vector3d& point) const;
  std::vector<Vector3d> sample(Points points, const Order& order) const;
  std::shared_ptr<const MeshSearchOnDevice> choose(Points points, const Order& order) const;
};

// The nearest of the candidates in double precision; of equal ones the lowest.
Nearest MeshDistance::Impl::settle(const Vector3d& q, std::span<const Candidate> candidates) const {
  Nearest nearest;
  TriangleDistance best;
  best.distance_sq = std::numeric_limits<double>::infinity();
  for (const Candidate& candidate : candidates) {
    const TriangleDistance d = frame.distance(candidate.triangle, q);
    if (d.distance_sq < best.distance_sq || nearest.triangle < 0 ||
        (d.distance_sq == best.distance_sq && candidate.triangle < nearest.triangle)) {
      best = d;
      nearest.triangle = candidate.triangle;
    }
  }
  const double back = 1 / frame.scale;  // exact, of a power of two
  nearest.distance = std::sqrt(best.distance_sq) * back;
  nearest.point = frame.centre + best.nearest * back;
  return nearest;
}

// Finds the group's entry from how far the group before had to look.
void MeshDistance::Impl::enter(std::span<const Vector3d> group, Memory& memory) const {
  Vector3d low = group[0], high = group[0];
  for (const Vector3d& q : group) {
    low = low.cwiseMin(q);
    high = high.cwiseMax(q);
  }
  const float radius = kEntryReach * memory.start;
  memory.start = 0;
  memory.entry.radius = -1;
  if (!(radius > 0) || std::max(high.maxCoeff(), -low.minCoeff()) > kFar) return;
  const Eigen::Vector3f low32 = low.cast<float>(), high32 = high.cast<float>();
  search.entry(tree.nodes.data(), low32.data(), high32.data(), radius, &memory.entry);
}

Nearest MeshDistance::Impl::answer(const Vector3d& q, Memory& memory) const {
  const double size = q.cwiseAbs().maxCoeff();
  if (size > kFar) {
    std::vector<Candidate> all(frame.triangles.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = {0, static_cast<int>(i)};
    return settle(q, all);
  }
  const float error = HOTBLADE_POSITION_ERROR * (1 + static_cast<float>(size));
  const SearchInput input{tree.nodes.data(),
                          tree.packets.data(),
                          &memory.entry,
                          {static_cast<float>(q.x()), static_cast<float>(q.y()), static_cast<float>(q.z())},
                          error,
                          memory.packet};
  for (;;) {
    const SearchOutput found =
        search.candidates(input, memory.candidates.data(), static_cast<int>(memory.candidates.size()));
    const auto count = static_cast<std::size_t>(found.count);
    if (count <= memory.candidates.size()) {
      memory.packet = found.packet;
      // A thread's first search starts nowhere and says nothing about the next.
      if (input.start_packet >= 0) memory.start = std::max(memory.start, found.start);
      return settle(q, std::span(memory.candidates).first(count));
    }
    memory.candidates.resize(std::min(16 * memory.candidates.size(), frame.triangles.size() + kCandidates));
  }
}

void MeshDistance::Impl::answer_on_host(Points points, const Order& order,
                                        std::vector<Nearest>& answers) const {
  const std::size_t blocks = (points.size() + kBlock - 1) / kBlock;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, blocks, 1), [&](const auto& range) {
    Memory memory;
    const auto index = [&](std::size_t i) { return order.empty() ? i : order[i]; };
    std::array<Vector3d, kGroup> group;
    const std::size_t end = std::min(points.size(), range.end() * kBlock);
    for (std::size_t first = range.begin() * kBlock; first < end; first += kGroup) {
      stop_point();
      const std::size_t count = std::min(kGroup, end - first);
      for (std::size_t i = 0; i < count; ++i) group[i] = frame.local(points[index(first + i)]);
      enter(std::span(group).first(count), memory);
      for (std::size_t i = 0; i < count; ++i) answers[index(first + i)] = answer(group[i], memory);
    }
  });
  stop_point();
}

// A point too far for single precision becomes no number: the device finds nothing, and the host answers.
Eigen::Vector4f MeshDistance::Impl::device_point(const Vector3d& point) const {
  const Vector3d q = frame.local(point);
  const double size = q.cwiseAbs().maxCoeff();
  if (size > kFar) return Eigen::Vector4f::Constant(std::numeric_limits<float>::quiet_NaN());
  Eigen::Vector4f p;
  p << q.cast<float>(), HOTBLADE_POSITION_ERROR * (1 + static_cast<float>(size));
  return p;
}

void MeshDistance::Impl::settle_portion(Points points, const Order& order, std::size_t first,
                                        std::span<const MeshSearchOnDevice::Found> found,
                                        std::vector<Nearest>& answers) const {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, found.size(), kBlock), [&](const auto& range) {
    Memory memory;
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      const std::size_t at = order.empty() ? first + i : order[first + i];
      const Vector3d q = frame.local(points[at]);
      std::array<Candidate, MeshSearchOnDevice::kSlots> candidates;
      std::size_t count = 0;
      for (const int triangle : found[i]) {
        if (triangle >= 0) candidates[count++] = {0, triangle};
      }
      const bool incomplete = count == 0 || found[i][0] == MeshSearchOnDevice::kTooMany;
      answers[at] = incomplete ? answer(q, memory) : settle(q, std::span(candidates).first(count));
    }
  });
  stop_point();
}

// The device works on one portion while the host settles the one before.
void MeshDistance::Impl::answer_on_device(const MeshSearchOnDevice& device, Points points, const Order& order,
                                          std::vector<Nearest>& answers) const {
  std::array<std::vector<MeshSearchOnDevice::Found>, 2> found;
  std::vector<Eigen::Vector4f> asked;
  const auto ask = [&](std::size_t first, std::vector<MeshSearchOnDevice::Found>& into) {
    const std::size_t count = std::min(kPortion, points.size() - first);
    asked.resize(count);
    into.resize(count);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, kBlock), [&](const auto& range) {
      for (std::size_t i = range.begin(); i != range.end(); ++i) {
        asked[i] = device_point(points[order.empty() ? first + i : order[first + i]]);
      }
    });
    stop_point();
    device.candidates(asked, into);
  };
  ask(0, found[0]);
  for (std::size_t first = 0, turn = 0; first < points.size(); first += kPortion, turn = 1 - turn) {
    tbb::parallel_invoke([&] { settle_portion(points, order, first, found[turn], answers); },
                         [&] {
                           if (first + kPortion < points.size()) ask(first + kPortion, found[1 - turn]);
                         });
    stop_point();
  }
}

// Runs of neighbours spread over all points, as many as both backends are timed with.
std::vector<Vector3d> MeshDistance::Impl::sample(Points points, const Order& order) const {
  std::vector<Vector3d> sample;
  const std::size_t runs = std::min((points.size() + kBlock - 1) / kBlock, kTimed / kBlock);
  for (std::size_t run = 0; run < runs; ++run) {
    const std::size_t first = points.size() / runs * run;
    for (std::size_t i = first; i < std::min(first + kBlock, points.size()); ++i) {
      sample.push_back(points[order.empty() ? i : order[i]]);
    }
  }
  return sample;
}

// Seconds for all points by what the sample took, without the sample's first run, which warms up.
template <typename Run>
double predicted_s(std::size_t points, std::size_t sample, const Run& run) {
  run();
  const auto start = std::chrono::steady_clock::now();
  run();
  return seconds_since(start) * static_cast<double>(points) / static_cast<double>(sample);
}

// The device that is to answer, or null for the host.
std::shared_ptr<const MeshSearchOnDevice> MeshDistance::Impl::choose(Points points,
                                                                     const Order& order) const {
  if (points.empty()) return nullptr;
  std::vector<Vector3d> part;
  std::vector<Nearest> ignored;
  return choice.choose(
      [&] {
        part = sample(points, order);
        ignored.resize(part.size());
        return predicted_s(points.size(), part.size(), [&] { answer_on_host(part, {}, ignored); });
      },
      [&] { return std::make_shared<const MeshSearchOnDevice>(tree); },
      [&](const MeshSearchOnDevice& device) {
        return predicted_s(points.size(), part.size(), [&] { answer_on_device(device, part, {}, ignored); });
      });
}

MeshDistance::MeshDistance(std::span<const Vector3d> vertices, std::span<const std::array<int, 3>> triangles,
                           Backend backend)
    : impl_(std::make_unique<Impl>(backend)) {
  impl_->frame = make_mesh_frame(vertices, triangles);
  impl_->tree = build_mesh_tree(impl_->frame.vertices, impl_->frame.triangles);
}

MeshDistance::~MeshDistance() = default;
MeshDistance::MeshDistance(MeshDistance&&) noexcept = default;
MeshDistance& MeshDistance::operator=(MeshDistance&&) noexcept = default;

std::vector<Nearest> MeshDistance::query(std::span<const Vector3d> points) const {
  for (const Vector3d& p : points) {
    if (!p.allFinite()) throw std::logic_error("MeshDistance::query: a point is not finite");
  }
  std::vector<Nearest> answers(points.size());
  const Order order = coherent_order(points);
  const auto device = impl_->choose(points, order);
  if (device) {
    try {
      impl_->answer_on_device(*device, points, order, answers);
      return answers;
    } catch (const DeviceError& error) {
      impl_->choice.drop(error);
    }
  }
  impl_->answer_on_host(points, order, answers);
  return answers;
}

std::vector<Side> MeshDistance::sides(std::span<const Vector3d> points,
                                      std::span<const Nearest> answers) const {
  if (points.size() != answers.size())
    throw std::logic_error("MeshDistance::sides: spans of different sizes");
  const MeshFrame& frame = impl_->frame;
  for (const Nearest& answer : answers) {
    if (answer.triangle < 0 || static_cast<std::size_t>(answer.triangle) >= frame.triangles.size()) {
      throw std::logic_error("MeshDistance::sides: an answer's triangle is not of this mesh");
    }
  }
  std::call_once(impl_->side_once, [&] { impl_->side.emplace(frame); });
  std::vector<Side> sides(points.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.size(), kBlock), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      const Vector3d q = frame.local(points[i]);
      const double rounding = kDistanceErrorRel * std::max(1.0, q.cwiseAbs().maxCoeff());
      const double height = impl_->side->height(frame, answers[i].triangle, q, rounding);
      sides[i] = height > 0 ? Side::kBefore : (height < 0 ? Side::kBehind : Side::kNeither);
    }
  });
  stop_point();
  return sides;
}

BackendUse MeshDistance::used() const {
  return impl_->choice.used();
}

}  // namespace hotblade::gpu
