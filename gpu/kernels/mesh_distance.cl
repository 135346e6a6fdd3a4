// The nearest triangle of many points, one work item a point: the search of gpu/mesh/mesh_search_kernels.h, lane by
// lane, in single precision; what it keeps is settled in double precision by the host's own formula.
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#pragma OPENCL FP_CONTRACT OFF

#define REAL float
#include "gpu/kernels/triangle.h"
#include "gpu/kernels/mesh_tree.h"
#include "gpu/kernels/triangle_exact.h"

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

// Keeps every triangle that can be the nearest of a point of the tree's frame, `error` being its share of the bound
// (mesh_tree.h).
static void find_candidates(__global const struct TreeNode* nodes, __global const struct TrianglePacket* packets,
                            float x, float y, float z, float error, Kept* kept) {
  int top = 1;
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
      visit_packet(packets + ~child, x, y, z, error, kept);
      const float radius = (kept->at_most + error) * (1.0f + 0x10p-24f);
      radius_sq = radius * radius;
      continue;
    }
    const int first = top;
    for (int i = 0; i < HOTBLADE_TREE_WIDTH; ++i) {
      const float sq = box_distance_sq(nodes + child, i, x, y, z);
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
}

static hb_vec3 vertex_at(__global const double* vertices, int i) {
  hb_vec3 v;
  v.x = vertices[3 * (size_t)i];
  v.y = vertices[3 * (size_t)i + 1];
  v.z = vertices[3 * (size_t)i + 2];
  return v;
}

// Laid out as gpu/mesh/mesh_distance.hpp's Nearest.
struct NearestOnDevice {
  double distance;
  int triangle;
  int unused;
  double x, y, z;
};

// points: x, y, z of each; frame: the centre of the mesh's frame and its scale; answers: the nearest triangle of each,
// of several at one distance the lowest, or -1 where the host has to search.
__kernel void mesh_nearest(__global const struct TreeNode* nodes, __global const struct TrianglePacket* packets,
                           __global const double* vertices, __global const int* triangles, const double4 frame,
                           __global const double* points, __global struct NearestOnDevice* answers,
                           const int count) {
  const int id = (int)get_global_id(0);
  if (id >= count) return;
  hb_vec3 q = vertex_at(points, id);
  q.x = (q.x - frame.x) * frame.w;
  q.y = (q.y - frame.y) * frame.w;
  q.z = (q.z - frame.z) * frame.w;
  const double size = fmax(fabs(q.x), fmax(fabs(q.y), fabs(q.z)));
  Kept kept;
  kept.count = 0;
  kept.at_most = INFINITY;
  // Single precision tells no two triangles apart from there.
  if (size <= HOTBLADE_FAR) {
    find_candidates(nodes, packets, (float)q.x, (float)q.y, (float)q.z,
                    HOTBLADE_POSITION_ERROR * (1.0f + (float)size), &kept);
  }
  hb_triangle_foot best;
  best.distance_sq = INFINITY;
  best.x = best.y = best.z = 0.0;
  int nearest = -1;
  for (int i = 0; i < kept.count && kept.count <= SLOTS; ++i) {
    const int triangle = kept.triangle[i];
    if (kept.at_least[i] > kept.at_most) continue;
    __global const int* corner = triangles + 3 * (size_t)triangle;
    const hb_triangle_foot foot = hb_nearest_of_triangle(
        vertex_at(vertices, corner[0]), vertex_at(vertices, corner[1]), vertex_at(vertices, corner[2]), q);
    if (nearest < 0 || foot.distance_sq < best.distance_sq ||
        (foot.distance_sq == best.distance_sq && triangle < nearest)) {
      best = foot;
      nearest = triangle;
    }
  }
  // Exact, as the scale is a power of two.
  const double back = 1.0 / frame.w;
  struct NearestOnDevice answer;
  answer.distance = sqrt(best.distance_sq) * back;
  answer.triangle = nearest;
  answer.unused = 0;
  answer.x = frame.x + best.x * back;
  answer.y = frame.y + best.y * back;
  answer.z = frame.z + best.z * back;
  answers[id] = answer;
}
