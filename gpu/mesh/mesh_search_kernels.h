// The host's search of a mesh tree with eight lanes, compiled once for each instruction set. The file that
// includes it uses nothing of the standard library: an inline function of it, compiled for AVX2, could be the one
// the linker keeps for the whole program.
#pragma once

#include "gpu/mesh/mesh_search.hpp"

namespace hotblade::gpu {
namespace {

typedef float Lanes __attribute__((vector_size(32)));
typedef int LaneInts __attribute__((vector_size(32)));

#define REAL Lanes
#include "gpu/kernels/triangle.h"
#undef REAL

inline Lanes load(const float* p) {
  Lanes v;
  __builtin_memcpy(&v, p, sizeof v);
  return v;
}

// One bit a lane that is set.
inline unsigned bits(LaneInts mask) {
#if defined(__AVX__)
  return static_cast<unsigned>(__builtin_ia32_movmskps256(reinterpret_cast<Lanes>(mask)));
#else
  unsigned set = 0;
  for (int i = 0; i < HOTBLADE_TREE_WIDTH; ++i) set |= (static_cast<unsigned>(mask[i]) >> 31) << i;
  return set;
#endif
}

inline Lanes root(Lanes v) {
#if defined(__AVX__)
  return __builtin_ia32_sqrtps256(v);
#else
  for (int i = 0; i < HOTBLADE_TREE_WIDTH; ++i) v[i] = __builtin_sqrtf(v[i]);
  return v;
#endif
}

// Of the lanes that hold a number; infinity when none does.
inline float smallest(Lanes v) {
  v = v < __builtin_inff() ? v : Lanes{} + __builtin_inff();
  const auto fold = [&v](LaneInts from) {
    const Lanes other = __builtin_shuffle(v, from);
    v = other < v ? other : v;
  };
  fold(LaneInts{4, 5, 6, 7, 0, 1, 2, 3});
  fold(LaneInts{2, 3, 0, 1, 6, 7, 4, 5});
  fold(LaneInts{1, 0, 3, 2, 5, 4, 7, 6});
  return v[0];
}

// From the box low..high to each child; from a point when both are one.
inline Lanes box_distance_sq(const TreeNode& node, const Lanes (&low)[3], const Lanes (&high)[3]) {
  Lanes sum = {};
  for (int k = 0; k < 3; ++k) {
    const Lanes below = load(node.low[k]) - high[k], above = low[k] - load(node.high[k]);
    Lanes d = below > above ? below : above;
    d = d > 0.0f ? d : Lanes{};
    sum += d * d;
  }
  return sum;
}

inline Lanes packet_distance_sq(const TrianglePacket& p, const Lanes (&q)[3]) {
  return triangle_distance_sq(q[0] - load(p.origin[0]), q[1] - load(p.origin[1]), q[2] - load(p.origin[2]),
                              load(p.u[0]), load(p.u[1]), load(p.u[2]), load(p.v[0]), load(p.v[1]), load(p.v[2]),
                              load(p.base), load(p.foot), load(p.rise), load(p.inv_left), load(p.inv_right));
}

// A search under way.
struct Walk {
  const SearchInput& input;
  Candidate* candidates;
  int capacity;
  SearchOutput found{__builtin_inff(), -1, 0, 0};
  float radius_sq = __builtin_inff(), radius = __builtin_inff();  // no box farther can hold the nearest
  bool full = false;

  void drop_far() {
    int kept = 0;
    for (int i = 0; i < found.count; ++i) {
      if (candidates[i].at_least <= found.at_most) candidates[kept++] = candidates[i];
    }
    found.count = kept;
  }

  void keep(float at_least, int triangle) {
    if (found.count >= capacity) drop_far();
    if (found.count >= capacity) {
      full = true;
      return;
    }
    candidates[found.count++] = {at_least, triangle};
  }

  // A box's distance is computed a few roundings too large at most; the shared error holds those of its corners and
  // the point, the factor those of squaring and summing.
  void shrink(float at_most, int packet) {
    found.at_most = at_most;
    found.packet = packet;
    radius = (at_most + input.error) * (1 + 0x10p-24f);
    radius_sq = radius * radius;
  }

  void visit_packet(int index, const Lanes (&q)[3]) {
    const TrianglePacket& packet = input.packets[index];
    const Lanes distance = root(packet_distance_sq(packet, q));
    const Lanes error = input.error + HOTBLADE_SHAPE_ERROR * (distance + load(packet.base));
    const float at_most = smallest(distance + error);
    if (at_most < found.at_most) shrink(at_most, index);
    const Lanes at_least = distance - error;
    for (unsigned rest = bits(at_least <= found.at_most); rest != 0; rest &= rest - 1) {
      const int i = __builtin_ctz(rest);
      keep(at_least[i], packet.triangle[i]);
    }
  }
};

struct Waiting {
  float distance_sq;
  int child;
};

// What is waited for soon is asked from memory now.
template <typename Part>
inline void prefetch(const Part* part) {
  const char* bytes = reinterpret_cast<const char*>(part);
  for (unsigned i = 0; i < sizeof(Part); i += 64) __builtin_prefetch(bytes + i);
}

// Puts the children within reach on the stack, the nearest on top.
inline int push_children(const TreeNode& node, const Walk& walk, const Lanes (&q)[3], Waiting* stack, int top) {
  const Lanes sq = box_distance_sq(node, q, q);
  const int first = top;
  for (unsigned rest = bits(sq <= walk.radius_sq); rest != 0; rest &= rest - 1) {
    const int i = __builtin_ctz(rest), child = node.child[i];
    if (child >= 0) {
      prefetch(walk.input.nodes + child);
    } else {
      prefetch(walk.input.packets + ~child);
    }
    const float d = sq[i];
    int at = top++;
    while (at > first && stack[at - 1].distance_sq < d) {
      stack[at] = stack[at - 1];
      --at;
    }
    stack[at] = {d, child};
  }
  return top;
}

inline SearchOutput search_tree(const SearchInput& input, Candidate* candidates, int capacity) {
  Walk walk{input, candidates, capacity};
  const Lanes q[3] = {Lanes{} + input.point[0], Lanes{} + input.point[1], Lanes{} + input.point[2]};
  if (input.start_packet >= 0) walk.visit_packet(input.start_packet, q);
  walk.found.start = walk.radius;
  const bool near = walk.radius <= input.entry->radius;
  Waiting stack[HOTBLADE_TREE_STACK];
  int top = push_children(near ? input.entry->node : input.nodes[0], walk, q, stack, 0);
  while (top > 0) {
    const Waiting next = stack[--top];
    if (next.distance_sq > walk.radius_sq) continue;
    if (next.child >= 0) {
      top = push_children(input.nodes[next.child], walk, q, stack, top);
    } else if (~next.child != input.start_packet) {
      walk.visit_packet(~next.child, q);
    }
  }
  walk.drop_far();
  if (walk.full) walk.found.count = capacity + 1;
  return walk.found;
}

inline void copy_child(const TreeNode& from, int i, TreeNode& to, int at) {
  for (int k = 0; k < 3; ++k) {
    to.low[k][at] = from.low[k][i];
    to.high[k][at] = from.high[k][i];
  }
  to.child[at] = from.child[i];
}

// The entry's largest child that is a node, by the sum of its box's sides; -1 when there is none.
inline int largest_node(const TreeNode& entry, int count) {
  int largest = -1;
  float size = -1;
  for (int i = 0; i < count; ++i) {
    float sides = 0;
    for (int k = 0; k < 3; ++k) sides += entry.high[k][i] - entry.low[k][i];
    if (entry.child[i] < 0 || !(sides > size)) continue;
    size = sides;
    largest = i;
  }
  return largest;
}

inline void find_entry(const TreeNode* nodes, const float low[3], const float high[3], float radius, Entry* entry) {
  const Lanes box_low[3] = {Lanes{} + low[0], Lanes{} + low[1], Lanes{} + low[2]},
              box_high[3] = {Lanes{} + high[0], Lanes{} + high[1], Lanes{} + high[2]};
  // The factor holds the roundings of squaring and summing.
  const float reach = radius * (1 + 0x20p-24f);
  const auto near = [&](int node) {
    return bits(box_distance_sq(nodes[node], box_low, box_high) <= reach * reach);
  };
  entry->radius = radius;
  entry->node = nodes[0];
  int count = 0;
  for (unsigned rest = near(0); rest != 0; rest &= rest - 1) {
    copy_child(nodes[0], __builtin_ctz(rest), entry->node, count++);
  }
  for (int parent = largest_node(entry->node, count); parent >= 0; parent = largest_node(entry->node, count)) {
    const TreeNode& node = nodes[entry->node.child[parent]];
    const unsigned children = near(entry->node.child[parent]);
    if (count - 1 + __builtin_popcount(children) > HOTBLADE_TREE_WIDTH) break;
    copy_child(entry->node, --count, entry->node, parent);
    for (unsigned rest = children; rest != 0; rest &= rest - 1) {
      copy_child(node, __builtin_ctz(rest), entry->node, count++);
    }
  }
  for (int i = count; i < HOTBLADE_TREE_WIDTH; ++i) {
    for (int k = 0; k < 3; ++k) {
      entry->node.low[k][i] = __builtin_inff();
      entry->node.high[k][i] = -__builtin_inff();
    }
  }
}

}  // namespace
}  // namespace hotblade::gpu
