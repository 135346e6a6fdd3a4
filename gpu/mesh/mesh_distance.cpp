#include "gpu/mesh/mesh_distance.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>
#include <numeric>
#include <optional>
#include <stdexcept>

#include "gpu/backend/backend_choice.hpp"
#include "gpu/backend/blocks.hpp"
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
// Points that are copied or looked through by one thread at a time.
constexpr std::size_t kCopied = 8192;
// Points that share a way into the tree.
constexpr std::size_t kGroup = 16;
// The entry of a group holds what is within this many times the farthest that a start packet of the group
// before reached.
constexpr float kEntryReach = 1.5f;

constexpr double kFar = HOTBLADE_FAR;

// Candidates a search has room for at first: more than the triangles around any ordinary vertex.
constexpr std::size_t kCandidates = 64;

// Points that the host is timed with, spread over all, and the device, which few do not fill.
constexpr std::size_t kTimed = 8192, kTimedOnDevice = 1 << 18;

using Order = std::vector<std::uint32_t>;

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
  void answer_on_host(Points points, std::span<const std::uint32_t> order, std::span<Nearest> answers) const;
  void answer_on_device(const MeshSearchOnDevice& device, Points points, std::span<Nearest> answers) const;
  std::shared_ptr<const MeshSearchOnDevice> choose(Points points, std::span<Nearest> answers,
                                                   std::optional<Order>& left) const;
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
  search.entry(tree.nodes().data(), low32.data(), high32.data(), radius, &memory.entry);
}

Nearest MeshDistance::Impl::answer(const Vector3d& q, Memory& memory) const {
  const double size = q.cwiseAbs().maxCoeff();
  if (size > kFar) {
    std::vector<Candidate> all(frame.triangles.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = {0, static_cast<int>(i)};
    return settle(q, all);
  }
  const float error = HOTBLADE_POSITION_ERROR * (1 + static_cast<float>(size));
  const SearchInput input{tree.nodes().data(),
                          tree.packets().data(),
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

// Points of this order.
void MeshDistance::Impl::answer_on_host(Points points, std::span<const std::uint32_t> order,
                                        std::span<Nearest> answers) const {
  const std::size_t blocks = (order.size() + kBlock - 1) / kBlock;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, blocks, 1), [&](const auto& range) {
    Memory memory;
    std::array<Vector3d, kGroup> group;
    const std::size_t end = std::min(order.size(), range.end() * kBlock);
    for (std::size_t first = range.begin() * kBlock; first < end; first += kGroup) {
      stop_point();
      const auto some = order.subspan(first, std::min(kGroup, end - first));
      for (std::size_t i = 0; i < some.size(); ++i) group[i] = frame.local(points[some[i]]);
      enter(std::span(group).first(some.size()), memory);
      for (std::size_t i = 0; i < some.size(); ++i) answers[some[i]] = answer(group[i], memory);
    }
  });
  stop_point();
}

// What the device leaves open, points too far for single precision among it, the host answers.
void MeshDistance::Impl::answer_on_device(const MeshSearchOnDevice& device, Points points,
                                          std::span<Nearest> answers) const {
  device.nearest(points, [&](std::size_t first, std::span<const Nearest> found) {
    for_each_block(found.size(), kCopied, [&](std::size_t begin, std::size_t end) {
      Memory memory;
      for (std::size_t i = begin; i != end; ++i) {
        answers[first + i] =
            found[i].triangle >= 0 ? found[i] : answer(frame.local(points[first + i]), memory);
      }
    });
  });
}

namespace {

// Calls take(first) for the first of each run of kBlock points, spread over all: `count` of these at most.
template <typename Take>
void for_runs(std::size_t points, std::size_t count, const Take& take) {
  const std::size_t runs = std::min((points + kBlock - 1) / kBlock, count / kBlock);
  for (std::size_t run = 0; run < runs; ++run) take(points / runs * run);
}

// Runs of points, one after the other.
std::vector<Vector3d> sample(std::span<const Vector3d> points, std::size_t count) {
  std::vector<Vector3d> sample;
  for_runs(points.size(), count, [&](std::size_t first) {
    const auto run = points.subspan(first, std::min(kBlock, points.size() - first));
    sample.insert(sample.end(), run.begin(), run.end());
  });
  return sample;
}

// An order in which runs of it come first, and how many points these have.
struct RunsFirst {
  Order order;
  std::size_t in_runs = 0;
};

RunsFirst runs_first(Order order, std::size_t count) {
  if (order.size() <= count) return {std::move(order), order.size()};
  RunsFirst sorted;
  sorted.order.reserve(order.size());
  std::vector<char> in_run(order.size(), 0);
  for_runs(order.size(), count, [&](std::size_t first) {
    for (std::size_t i = first; i < std::min(first + kBlock, order.size()); ++i) {
      in_run[i] = 1;
      sorted.order.push_back(order[i]);
    }
  });
  sorted.in_runs = sorted.order.size();
  for (std::size_t i = 0; i < order.size(); ++i)
    if (in_run[i] == 0) sorted.order.push_back(order[i]);
  return sorted;
}

// As coherent_order(), with all points of it where that says nothing.
Order order_of(std::span<const Vector3d> points) {
  Order order = coherent_order(points);
  if (!order.empty()) return order;
  order.resize(points.size());
  std::iota(order.begin(), order.end(), 0U);
  return order;
}

}  // namespace

// The device that is to answer, or null for the host. What the host answered as it was timed is not left to
// it.
std::shared_ptr<const MeshSearchOnDevice> MeshDistance::Impl::choose(Points points,
                                                                     std::span<Nearest> answers,
                                                                     std::optional<Order>& left) const {
  if (points.empty()) return nullptr;
  return choice.choose(
      [&] {
        const RunsFirst all = runs_first(order_of(points), kTimed);
        const std::span<const std::uint32_t> order(all.order);
        const double seconds =
            host_seconds(points.size(), all.in_runs, [&](std::size_t first, std::size_t count) {
              answer_on_host(points, order.subspan(first, count), answers);
            });
        const auto rest = order.subspan(all.in_runs);
        left.emplace(rest.begin(), rest.end());
        return seconds;
      },
      [&] { return std::make_shared<const MeshSearchOnDevice>(frame, tree); },
      [&](const MeshSearchOnDevice& device) {
        const std::vector<Vector3d> part = sample(points, kTimedOnDevice);
        std::vector<Nearest> ignored(part.size());
        return device_seconds(points.size(), part.size(), [&](std::size_t n) {
          answer_on_device(device, std::span(part).first(n), ignored);
        });
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
  std::vector<Nearest> answers(points.size());
  query(points, answers);
  return answers;
}

void MeshDistance::query(std::span<const Vector3d> points, std::span<Nearest> answers) const {
  if (answers.size() != points.size())
    throw std::logic_error("MeshDistance::query: spans of different sizes");
  std::atomic<bool> finite = true;
  for_each_in_blocks(points.size(), kCopied, [&](std::size_t i) {
    if (!points[i].allFinite()) finite = false;
  });
  if (!finite) throw std::logic_error("MeshDistance::query: a point is not finite");
  std::optional<Order> left;
  if (const auto device = impl_->choose(points, answers, left)) {
    try {
      impl_->answer_on_device(*device, points, answers);
      return;
    } catch (const DeviceError& error) {
      impl_->choice.drop(error);
    }
  }
  impl_->answer_on_host(points, left ? *left : order_of(points), answers);
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
