#include "gpu/mesh/mesh_tree.hpp"

#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "gpu/backend/stop.hpp"

namespace hotblade::gpu {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kWidth = HOTBLADE_TREE_WIDTH;
// Bins a split is chosen from; more gain under 1 % of the search time.
constexpr int kBins = 16;
// Of so few items weighing the bins costs more than filling them.
constexpr std::size_t kFew = 48;
constexpr int kBinsOfFew = 8;
// From this depth on nodes are halved by count, so that the depth, and with it the search's stack, stays
// bounded for every input: 8 levels of any shape and at most 10 balanced ones for 2^31 triangles.
constexpr int kBalancedDepth = 8;
static_assert((kBalancedDepth + 10) * (HOTBLADE_TREE_WIDTH - 1) < HOTBLADE_TREE_STACK,
              "update the stack's size");
// Parts of a mesh this small are built by one thread.
constexpr std::size_t kSerial = 8192;

// Four numbers at once: x, y, z and one that means nothing.
typedef float Four __attribute__((vector_size(16)));
typedef int FourInts __attribute__((vector_size(16)));

Four all(float a) {
  return Four{a, a, a, a};
}
Four least(Four a, Four b) {
  return a < b ? a : b;
}
Four largest(Four a, Four b) {
  return a > b ? a : b;
}

struct Box {
  Four low = all(std::numeric_limits<float>::infinity());
  Four high = all(-std::numeric_limits<float>::infinity());
  void add(Four other_low, Four other_high) {
    low = least(low, other_low);
    high = largest(high, other_high);
  }
  void add(const Box& other) { add(other.low, other.high); }
  [[nodiscard]] float half_area() const {
    const Four d = high - low;
    return d[0] * d[1] + d[1] * d[2] + d[2] * d[0];
  }
};

// A triangle and its box.
struct Item {
  float low[4];
  float high[3];
  int triangle = 0;

  [[nodiscard]] Four low4() const { return load(low); }
  // Without the triangle's bits, which are no number to calculate with.
  [[nodiscard]] Four high4() const {
    return reinterpret_cast<Four>(reinterpret_cast<FourInts>(load(high)) & FourInts{-1, -1, -1, 0});
  }
  // Twice the centre.
  [[nodiscard]] Four centre() const { return low4() + high4(); }
  [[nodiscard]] float centre(int axis) const { return low[axis] + high[axis]; }

 private:
  static Four load(const float* from) {
    Four v;
    std::memcpy(&v, from, sizeof v);
    return v;
  }
};
using Items = std::span<Item>;

// Rounded so that the box holds the triangle.
Item item_of(const std::array<Vector3d, 3>& corner, int triangle) {
  Item item{};
  item.triangle = triangle;
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  for (int k = 0; k < 3; ++k) {
    const double low = std::min({corner[0][k], corner[1][k], corner[2][k]}),
                 high = std::max({corner[0][k], corner[1][k], corner[2][k]});
    item.low[k] = static_cast<float>(low);
    item.high[k] = static_cast<float>(high);
    if (static_cast<double>(item.low[k]) > low) item.low[k] = std::nextafter(item.low[k], -kInfinity);
    if (static_cast<double>(item.high[k]) < high) item.high[k] = std::nextafter(item.high[k], kInfinity);
  }
  return item;
}

// A part of the items with its boxes; that of the centres is twice as large, as they are.
struct Part {
  Items items;
  Box box, centres;
  [[nodiscard]] std::size_t size() const { return items.size(); }
};

Part measure_serially(Items items) {
  Part part{items, {}, {}};
  for (const Item& item : items) {
    const Four low = item.low4(), high = item.high4();
    part.box.add(low, high);
    part.centres.add(low + high, low + high);
  }
  return part;
}

// Runs over(items of a piece) on all cores and joins the results in order.
template <typename Result, typename Over, typename Join>
Result over_pieces(Items items, const Over& over, const Join& join) {
  if (items.size() <= kSerial) return over(items);
  Result all = tbb::parallel_deterministic_reduce(
      tbb::blocked_range<std::size_t>(0, items.size(), kSerial), Result{},
      [&](const auto& range, const Result& before) {
        return join(before, over(items.subspan(range.begin(), range.size())));
      },
      join);
  stop_point();
  return all;
}

Part measure(Items items) {
  Part part = over_pieces<Part>(items, measure_serially, [](Part a, const Part& b) {
    a.box.add(b.box);
    a.centres.add(b.centres);
    return a;
  });
  part.items = items;
  return part;
}

using Halves = std::array<Items, 2>;

Halves halve_by_count(const Part& part) {
  const Four extent = part.centres.high - part.centres.low;
  int axis = extent[1] > extent[0] ? 1 : 0;
  if (extent[2] > extent[axis]) axis = 2;
  const std::size_t middle = part.size() / 2;
  std::nth_element(part.items.begin(), part.items.begin() + static_cast<std::ptrdiff_t>(middle),
                   part.items.end(), [axis](const Item& a, const Item& b) {
                     const float x = a.centre(axis), y = b.centre(axis);
                     return x < y || (x == y && a.triangle < b.triangle);
                   });
  return {part.items.first(middle), part.items.subspan(middle)};
}

// Of one axis.
template <int kCount>
struct Bins {
  std::array<Box, kCount> box;
  std::array<std::size_t, kCount> count{};
};
template <int kCount>
using AllBins = std::array<Bins<kCount>, 3>;

struct Split {
  float cost = std::numeric_limits<float>::infinity();
  int axis = -1, bin = 0;
};

// Leaves are whole packets: a side costs its area times its packets.
template <int kCount>
void consider_axis(const Bins<kCount>& bins, int axis, Split& best) {
  const auto cost = [](const Box& box, std::size_t count) {
    return box.half_area() * static_cast<float>((count + kWidth - 1) / kWidth);
  };
  std::array<float, kCount> right_cost{};
  Box right;
  std::size_t right_count = 0;
  for (std::size_t i = kCount - 1; i > 0; --i) {
    right.add(bins.box[i]);
    right_count += bins.count[i];
    right_cost[i] = right_count > 0 ? cost(right, right_count) : std::numeric_limits<float>::infinity();
  }
  Box left;
  std::size_t left_count = 0;
  for (std::size_t i = 1; i < kCount; ++i) {
    left.add(bins.box[i - 1]);
    left_count += bins.count[i - 1];
    if (left_count == 0) continue;
    const float total = cost(left, left_count) + right_cost[i];
    if (total < best.cost) best = {total, axis, static_cast<int>(i)};
  }
}

// Which bin an item is in on each axis; all in one on an axis without extent.
template <int kCount>
struct Binning {
  explicit Binning(const Box& centres) : low(centres.low) {
    const Four extent = centres.high - centres.low;
    for (int k = 0; k < 3; ++k) scale[k] = extent[k] > 0 ? kCount / extent[k] : 0;
  }
  [[nodiscard]] FourInts of(Four centre) const {
    return __builtin_convertvector(least((centre - low) * scale, all(kCount - 1)), FourInts);
  }
  // The same roundings for one axis.
  [[nodiscard]] int of(const Item& item, int axis) const {
    return static_cast<int>(std::min((item.centre(axis) - low[axis]) * scale[axis], float{kCount - 1}));
  }
  Four low, scale = all(0);
};

template <int kCount>
AllBins<kCount> fill(Items items, const Binning<kCount>& binning) {
  return over_pieces<AllBins<kCount>>(
      items,
      [&](Items piece) {
        AllBins<kCount> bins;
        for (const Item& item : piece) {
          const Four low = item.low4(), high = item.high4();
          const FourInts at = binning.of(low + high);
          for (std::size_t axis = 0; axis < 3; ++axis) {
            const auto bin = static_cast<std::size_t>(at[static_cast<int>(axis)]);
            bins[axis].box[bin].add(low, high);
            ++bins[axis].count[bin];
          }
        }
        return bins;
      },
      [](AllBins<kCount> a, const AllBins<kCount>& b) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
          for (std::size_t bin = 0; bin < kCount; ++bin) {
            a[axis].box[bin].add(b[axis].box[bin]);
            a[axis].count[bin] += b[axis].count[bin];
          }
        }
        return a;
      });
}

template <int kCount>
Halves split_by_area(const Part& part) {
  const Binning<kCount> binning(part.centres);
  const AllBins<kCount> bins = fill(part.items, binning);
  Split best;
  for (int axis = 0; axis < 3; ++axis) {
    if (binning.scale[axis] > 0) consider_axis(bins[static_cast<std::size_t>(axis)], axis, best);
  }
  if (best.axis < 0) return halve_by_count(part);
  const auto middle = std::partition(part.items.begin(), part.items.end(), [&](const Item& item) {
    return binning.of(item, best.axis) < best.bin;
  });
  const auto left = static_cast<std::size_t>(middle - part.items.begin());
  return {part.items.first(left), part.items.subspan(left)};
}

Halves split(const Part& part, int depth) {
  if (depth >= kBalancedDepth) return halve_by_count(part);
  return part.size() > kFew ? split_by_area<kBins>(part) : split_by_area<kBinsOfFew>(part);
}

// Children of one node: the part with the largest area that is no leaf yet is split, until there are eight.
std::vector<Part> children_of(const Part& whole, int depth) {
  std::vector<Part> parts{whole};
  while (parts.size() < kWidth) {
    std::ptrdiff_t widest = -1;
    float area = -1;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      // In balanced depths the count decides, which keeps them balanced.
      const float size =
          depth >= kBalancedDepth ? static_cast<float>(parts[i].size()) : parts[i].box.half_area();
      if (parts[i].size() <= kWidth || size <= area) continue;
      area = size;
      widest = static_cast<std::ptrdiff_t>(i);
    }
    if (widest < 0) break;
    const Halves halves = split(parts[static_cast<std::size_t>(widest)], depth);
    parts[static_cast<std::size_t>(widest)] = measure(halves[0]);
    parts.push_back(measure(halves[1]));
  }
  return parts;
}

Vector3d any_normal(const Vector3d& u) {
  Eigen::Index smallest = 0;
  u.cwiseAbs().minCoeff(&smallest);
  return u.cross(Vector3d::Unit(smallest)).normalized();
}

float inverse_sq(float x, float y) {
  const float sq = x * x + y * y;
  return sq > std::numeric_limits<float>::min() ? 1 / sq : 0;
}

void set_lane(TrianglePacket& packet, std::size_t lane, std::array<Vector3d, 3> p, int triangle) {
  const double l0 = (p[1] - p[0]).squaredNorm(), l1 = (p[2] - p[1]).squaredNorm(),
               l2 = (p[0] - p[2]).squaredNorm();
  if (l1 > l0 && l1 >= l2) {
    std::rotate(p.begin(), p.begin() + 1, p.end());
  } else if (l2 > l0) {
    std::rotate(p.begin(), p.begin() + 2, p.end());
  }
  const Vector3d e0 = p[1] - p[0], e1 = p[2] - p[0];
  // Shorter edges, whose squares vanish, are points in single precision.
  constexpr double kPoint = 1e-150;
  const double base = e0.norm();
  const Vector3d u = base > kPoint ? Vector3d(e0 / base) : Vector3d(Vector3d::UnitX());
  Vector3d v = e1 - e1.dot(u) * u;
  // A needle's height keeps few digits and leans towards its base: made square to it again.
  const double height = v.norm();
  v = height > kPoint ? Vector3d(v / height) : any_normal(u);
  v -= v.dot(u) * u;
  v = v.norm() > 0.5 ? v.normalized() : any_normal(u);
  for (int k = 0; k < 3; ++k) {
    packet.origin[k][lane] = static_cast<float>(p[0][k]);
    packet.u[k][lane] = static_cast<float>(u[k]);
    packet.v[k][lane] = static_cast<float>(v[k]);
  }
  packet.base[lane] = static_cast<float>(base);
  packet.foot[lane] = std::clamp(static_cast<float>(e1.dot(u)), 0.0f, packet.base[lane]);
  packet.rise[lane] = std::max(0.0f, static_cast<float>(e1.dot(v)));
  packet.inv_left[lane] = inverse_sq(packet.foot[lane], packet.rise[lane]);
  packet.inv_right[lane] = inverse_sq(packet.foot[lane] - packet.base[lane], packet.rise[lane]);
  packet.triangle[lane] = triangle;
}

// A tree that grows: its packets are told by their items until all are known.
struct Growing {
  std::vector<TreeNode> nodes;
  std::vector<Items> leaves;
};

void set_empty(TrianglePacket& packet, std::size_t lane) {
  for (int k = 0; k < 3; ++k) packet.origin[k][lane] = packet.u[k][lane] = packet.v[k][lane] = 0;
  packet.origin[0][lane] = std::numeric_limits<float>::quiet_NaN();
  packet.base[lane] = packet.foot[lane] = packet.rise[lane] = 0;
  packet.inv_left[lane] = packet.inv_right[lane] = 0;
  packet.triangle[lane] = -1;
}

class Builder {
 public:
  Builder(std::span<const Vector3d> vertices, std::span<const std::array<int, 3>> triangles)
      : vertices_(vertices), triangles_(triangles) {}

  // Appends the node of `part` and all below it.
  void build(const Part& part, int depth, Growing& tree) const {
    const std::size_t node = tree.nodes.size();
    tree.nodes.push_back(empty_node());
    const std::vector<Part> parts = children_of(part, depth);
    if (part.size() <= kSerial) {
      for (std::size_t i = 0; i < parts.size(); ++i) append(parts[i], node, i, depth, tree);
      return;
    }
    // Each child grows its own tree; they are put one behind the other, whatever thread made them.
    std::array<Growing, kWidth> grown;
    tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t i) {
      if (parts[i].size() > kWidth) build(parts[i], depth + 1, grown[i]);
    });
    stop_point();
    for (std::size_t i = 0; i < parts.size(); ++i) {
      if (parts[i].size() <= kWidth) {
        append(parts[i], node, i, depth, tree);
      } else {
        stop_point();
        set_child(tree.nodes[node], i, parts[i].box, static_cast<int>(tree.nodes.size()));
        join(grown[i], tree);
        grown[i] = {};  // or all of a large tree is held twice
      }
    }
  }

  [[nodiscard]] Item item(std::size_t triangle) const {
    return item_of(corners(static_cast<int>(triangle)), static_cast<int>(triangle));
  }

  void fill(Items items, TrianglePacket& packet) const {
    for (std::size_t i = 0; i < items.size(); ++i)
      set_lane(packet, i, corners(items[i].triangle), items[i].triangle);
    for (std::size_t i = items.size(); i < kWidth; ++i) set_empty(packet, i);
  }

 private:
  static TreeNode empty_node() {
    TreeNode node;
    for (std::size_t i = 0; i < kWidth; ++i) set_child(node, i, Box{}, 0);
    return node;
  }

  static void set_child(TreeNode& node, std::size_t lane, const Box& box, int child) {
    for (int k = 0; k < 3; ++k) {
      node.low[k][lane] = box.low[k];
      node.high[k][lane] = box.high[k];
    }
    node.child[lane] = child;
  }

  [[nodiscard]] std::array<Vector3d, 3> corners(int triangle) const {
    std::array<Vector3d, 3> p;
    for (std::size_t k = 0; k < 3; ++k) {
      p[k] = vertices_[static_cast<std::size_t>(triangles_[static_cast<std::size_t>(triangle)][k])];
    }
    return p;
  }

  void append(const Part& part, std::size_t node, std::size_t lane, int depth, Growing& tree) const {
    if (part.size() > kWidth) {
      set_child(tree.nodes[node], lane, part.box, static_cast<int>(tree.nodes.size()));
      build(part, depth + 1, tree);
      return;
    }
    set_child(tree.nodes[node], lane, part.box, ~static_cast<int>(tree.leaves.size()));
    tree.leaves.push_back(part.items);
  }

  static void join(const Growing& part, Growing& tree) {
    const int nodes = static_cast<int>(tree.nodes.size()), leaves = static_cast<int>(tree.leaves.size());
    for (TreeNode node : part.nodes) {
      for (int& child : node.child) child += child >= 0 ? nodes : -leaves;
      tree.nodes.push_back(node);
    }
    tree.leaves.insert(tree.leaves.end(), part.leaves.begin(), part.leaves.end());
  }

  std::span<const Vector3d> vertices_;
  std::span<const std::array<int, 3>> triangles_;
};

}  // namespace

MeshTree build_mesh_tree(std::span<const Vector3d> vertices, std::span<const std::array<int, 3>> triangles) {
  const Builder builder(vertices, triangles);
  std::vector<Item> items(triangles.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, items.size(), kSerial), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) items[i] = builder.item(i);
  });
  stop_point();
  Growing grown;
  builder.build(measure(items), 0, grown);
  MeshTree tree(std::move(grown.nodes), grown.leaves.size());
  constexpr std::size_t kPackets = 512;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, grown.leaves.size(), kPackets),
                    [&](const auto& range) {
                      stop_point();
                      for (std::size_t i = range.begin(); i != range.end(); ++i)
                        builder.fill(grown.leaves[i], tree.packet(i));
                    });
  stop_point();
  return tree;
}

}  // namespace hotblade::gpu
