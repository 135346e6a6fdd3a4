#include "gpu/mesh_distance.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "gpu/mesh_frame.hpp"
#include "gpu/mesh_search.hpp"
#include "gpu/mesh_tree.hpp"
#include "gpu/point_order.hpp"

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

}  // namespace

struct MeshDistance::Impl {
  MeshFrame frame;
  MeshTree tree;
  MeshSearch search = mesh_search();

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
};

// The nearest of the candidates in double precision; of equal ones the lowest.
Nearest MeshDistance::Impl::settle(const Vector3d& q, std::span<const Candidate> candidates) const {
  Nearest nearest;
  TriangleDistance best{std::numeric_limits<double>::infinity(), {0, 0, 0}};
  for (const Candidate& candidate : candidates) {
    const TriangleDistance d = frame.distance(candidate.triangle, q);
    if (d.distance_sq < best.distance_sq || nearest.triangle < 0 ||
        (d.distance_sq == best.distance_sq && candidate.triangle < nearest.triangle)) {
      best = d;
      nearest.triangle = candidate.triangle;
    }
  }
  nearest.distance = std::sqrt(best.distance_sq) / frame.scale;
  nearest.point = frame.centre + best.nearest / frame.scale;
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

MeshDistance::MeshDistance(std::span<const Vector3d> vertices, std::span<const std::array<int, 3>> triangles)
    : impl_(std::make_unique<Impl>()) {
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
  const std::vector<std::uint32_t> order = coherent_order(points);
  std::vector<Nearest> answers(points.size());
  const std::size_t blocks = (points.size() + kBlock - 1) / kBlock;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, blocks, 1), [&](const auto& range) {
    Impl::Memory memory;
    const auto index = [&](std::size_t i) { return order.empty() ? i : order[i]; };
    std::array<Vector3d, kGroup> group;
    const std::size_t end = std::min(points.size(), range.end() * kBlock);
    for (std::size_t first = range.begin() * kBlock; first < end; first += kGroup) {
      const std::size_t count = std::min(kGroup, end - first);
      for (std::size_t i = 0; i < count; ++i) group[i] = impl_->frame.local(points[index(first + i)]);
      impl_->enter(std::span(group).first(count), memory);
      for (std::size_t i = 0; i < count; ++i) answers[index(first + i)] = impl_->answer(group[i], memory);
    }
  });
  return answers;
}

std::string backend_name() {
  return "cpu";
}

}  // namespace hotblade::gpu
