// Searches a mesh tree on the host, in single precision, for the instruction set at hand.
#pragma once

#include "gpu/kernels/mesh_tree.h"

namespace hotblade::gpu {

// Names a triangle that may be the nearest, and the least that its distance can truly be.
struct Candidate {
  float at_least;
  int triangle;
};

// Leads into the tree below its root: it holds all that lies within `radius` of a group of points.
struct Entry {
  TreeNode node;
  float radius;
};

// Holds the tree's parts, and one point of the tree's frame.
struct SearchInput {
  const TreeNode* nodes;
  const TrianglePacket* packets;
  const Entry* entry;  // of a group with this point
  float point[3];
  float error;       // the part of a distance's error that all triangles share, see mesh_tree.h
  int start_packet;  // a packet likely to be near, or -1
};

struct SearchOutput {
  float at_most;  // the true distance is no more
  int packet;     // where that was found
  float start;    // how far the search reached from the start packet
  int count;      // candidates; more than the capacity when they did not fit, and then they are incomplete
};

// Writes every triangle whose true distance can be the smallest.
using FindCandidates = SearchOutput (*)(const SearchInput&, Candidate* candidates, int capacity);

// Goes down from the root as far as eight children hold everything within `radius` of the box low..high.
using FindEntry = void (*)(const TreeNode* nodes, const float low[3], const float high[3], float radius,
                           Entry* entry);

struct MeshSearch {
  FindCandidates candidates;
  FindEntry entry;
};

[[nodiscard]] MeshSearch mesh_search_baseline();
[[nodiscard]] MeshSearch mesh_search_avx2();

// Returns the fastest that this processor runs.
[[nodiscard]] MeshSearch mesh_search();

}  // namespace hotblade::gpu
