// Lays out the search tree over a mesh in memory, on the host and on a device: nodes of eight children, leaves
// of up to eight triangles, both laid out child by child so that eight lanes load at once.
#ifndef HOTBLADE_GPU_KERNELS_MESH_TREE_H
#define HOTBLADE_GPU_KERNELS_MESH_TREE_H

#define HOTBLADE_TREE_WIDTH 8
// Enough for every tree the builder makes (mesh_tree.cpp, kBalancedDepth).
#define HOTBLADE_TREE_STACK 128

// Points farther than this many mesh sizes are compared with every triangle: single precision tells no two triangles
// apart from there.
#define HOTBLADE_FAR 0x1p+20

// How far the distance d computed by triangle.h can be from the true one, with e = 2^-24 and the mesh scaled into
// [-1, 1]^3: HOTBLADE_POSITION_ERROR S + HOTBLADE_SHAPE_ERROR (d + base), S = 1 + max |coordinate of the point|.
// Position: point and origin are each rounded, sqrt(3) eS together, and a box test loses 2 eS; 4 holds both.
// Shape: with r = point - origin, |r| <= d + base by the triangle's size, the difference costs 2 e|r|; the axes u
// and v are off by e and n = u x v by 6 e, each product sums three terms: 4, 4 and 9 e|r|, together 10.7; corners
// in the plane 2 e base; side of an edge 4 e|r|; foot on an edge 5 e|r| along it and 4 e|r| more in the offset;
// squares, sum and root (up to 3 ulp on a device) 6 e d. Sum 34, rounded up.
#define HOTBLADE_POSITION_ERROR 0x4p-24f
#define HOTBLADE_SHAPE_ERROR 0x28p-24f

// Boxes hold their triangles in every rounding; an empty child has an inverted, infinite box. child >= 0 is a
// node, otherwise ~child is a packet.
struct TreeNode {
  float low[3][HOTBLADE_TREE_WIDTH];
  float high[3][HOTBLADE_TREE_WIDTH];
  int child[HOTBLADE_TREE_WIDTH];
};

// Triangles in the frames of triangle.h. An empty lane has NaN for its origin and -1 for its triangle.
struct TrianglePacket {
  float origin[3][HOTBLADE_TREE_WIDTH];
  float u[3][HOTBLADE_TREE_WIDTH];
  float v[3][HOTBLADE_TREE_WIDTH];
  float base[HOTBLADE_TREE_WIDTH];
  float foot[HOTBLADE_TREE_WIDTH];
  float rise[HOTBLADE_TREE_WIDTH];
  float inv_left[HOTBLADE_TREE_WIDTH];
  float inv_right[HOTBLADE_TREE_WIDTH];
  int triangle[HOTBLADE_TREE_WIDTH];
};

#endif
