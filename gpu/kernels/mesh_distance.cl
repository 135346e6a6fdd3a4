// Candidates for the nearest triangle of many points, one work item a point: the search of kernels/mesh_search.h,
// lane by lane. What it keeps is settled on the host in double precision.
#pragma OPENCL FP_CONTRACT OFF

#define REAL float
#include "gpu/kernels/triangle.h"
#include "gpu/kernels/mesh_tree.h"

// Candidates a point has room for; with more the host searches itself.
#define SLOTS 4

typedef struct {
  float at_least[SLOTS];
  int triangle[SLOTS];
  int count;
  float at_most;
} Kept;

static void keep(Kept* kept, float at_least, int triangle) {
  if (kept->count == SLOTS) {
    int left = 0;
    for (int i = 0; i < SLOTS; ++i) {
      if (kept->at_least[i] <= kept->at_most) {
        kept->at_least[left] = kept->at_least[i];
        kept->triangle[left++] = kept->triangle[i];
      }
    }
    kept->count = left;
  }
  if (kept->count >= SLOTS) {
    kept->count = SLOTS + 1;  // too many: stays so
    return;
  }
  kept->at_least[kept->count] = at_least;
  kept->triangle[kept->count++] = triangle;
}

static void visit_packet(__global const struct TrianglePacket* p, float x, float y, float z, float error,
                         Kept* kept) {
  for (int i = 0; i < HOTBLADE_TREE_WIDTH; ++i) {
    const float distance = sqrt(triangle_distance_sq(
        x - p->origin[0][i], y - p->origin[1][i], z - p->origin[2][i], p->u[0][i], p->u[1][i], p->u[2][i],
        p->v[0][i], p->v[1][i], p->v[2][i], p->base[i], p->foot[i], p->rise[i], p->inv_left[i], p->inv_right[i]));
    const float off = error + HOTBLADE_SHAPE_ERROR * (distance + p->base[i]);
    if (p->triangle[i] < 0 || !(distance - off <= kept->at_most)) continue;
    if (distance + off < kept->at_most) kept->at_most = distance + off;
    keep(kept, distance - off, p->triangle[i]);
  }
}

static float box_distance_sq(__global const struct TreeNode* node, int i, float x, float y, float z) {
  const float dx = fmax(0.0f, fmax(node->low[0][i] - x, x - node->high[0][i]));
  const float dy = fmax(0.0f, fmax(node->low[1][i] - y, y - node->high[1][i]));
  const float dz = fmax(0.0f, fmax(node->low[2][i] - z, z - node->high[2][i]));
  return dx * dx + dy * dy + dz * dz;
}

// points: x, y, z and the shared error of each; found: SLOTS triangles a point, -1 where there are fewer, and
// -2 in the first when they did not fit.
__kernel void mesh_candidates(__global const struct TreeNode* nodes, __global const struct TrianglePacket* packets,
                              __global const float4* points, __global int* found, const int count) {
  const int id = (int)get_global_id(0);
  if (id >= count) return;
  const float4 q = points[id];
  Kept kept;
  kept.count = 0;
  kept.at_most = INFINITY;
  // A point that is no number is the host's.
  int top = q.w >= 0.0f ? 1 : 0;
  float radius_sq = INFINITY;
  float waiting_sq[HOTBLADE_TREE_STACK];
  int waiting[HOTBLADE_TREE_STACK];
  waiting_sq[0] = 0.0f;
  waiting[0] = 0;
  while (top > 0) {
    --top;
    if (waiting_sq[top] > radius_sq) continue;
    const int child = waiting[top];
    if (child < 0) {
      visit_packet(packets + ~child, q.x, q.y, q.z, q.w, &kept);
      const float radius = (kept.at_most + q.w) * (1.0f + 0x10p-24f);
      radius_sq = radius * radius;
      continue;
    }
    const int first = top;
    for (int i = 0; i < HOTBLADE_TREE_WIDTH; ++i) {
      const float sq = box_distance_sq(nodes + child, i, q.x, q.y, q.z);
      if (!(sq <= radius_sq) || sq == INFINITY) continue;
      int at = top++;
      while (at > first && waiting_sq[at - 1] < sq) {
        waiting_sq[at] = waiting_sq[at - 1];
        waiting[at] = waiting[at - 1];
        --at;
      }
      waiting_sq[at] = sq;
      waiting[at] = nodes[child].child[i];
    }
  }
  for (int i = 0; i < SLOTS; ++i) {
    const bool used = i < kept.count && kept.count <= SLOTS && kept.at_least[i] <= kept.at_most;
    found[SLOTS * id + i] = used ? kept.triangle[i] : -1;
  }
  if (kept.count > SLOTS) found[SLOTS * id] = -2;
}
