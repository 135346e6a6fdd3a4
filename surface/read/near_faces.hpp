// Which faces of a mesh lie near each other: the pairs whose bounding boxes meet.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "surface/read/design_surface.hpp"

namespace hotblade::surface {

// Faces in the order of a space-filling curve, four to a leaf, under a complete binary tree of boxes in
// single precision, rounded outwards: 60 bytes a face, and a search in proportion to the faces of a surface.
// Refers to nothing of the mesh once built. Throws std::logic_error when a vertex index is out of range.
class NearFaces {
 public:
  explicit NearFaces(const TriangleMesh& mesh);

  // The search falls into portions that may run side by side, the same whatever the number of threads.
  [[nodiscard]] std::size_t portions() const { return portions_.size(); }

  // Calls meet(f, g) once for every two faces of this portion whose boxes meet, and for a few more that lie
  // within rounding to single precision of each other.
  void visit(std::size_t portion, const std::function<void(int, int)>& meet) const;

 private:
  using Four = float __attribute__((vector_size(16)));  // x, y, z and nothing
  struct Box {
    Four low, high;
    [[nodiscard]] bool meets(const Box& other) const;
    void add(const Box& other);
  };
  using Meet = std::function<void(int, int)>;

  [[nodiscard]] Box box_of(const TriangleMesh& mesh, std::size_t face) const;
  void sort_faces(const TriangleMesh& mesh);
  void grow_tree();
  void divide();
  void within(std::size_t node, const Meet& meet) const;
  void between(std::size_t node, std::size_t other, const Meet& meet) const;
  void compare(std::size_t leaf, std::size_t other, const Meet& meet) const;

  std::vector<int> faces_;  // in the curve's order
  std::vector<Box> boxes_;  // of faces_
  std::vector<Box> nodes_;  // node i has children 2 i and 2 i + 1; leaves are nodes_[leaves_] and after
  std::size_t leaves_ = 0;  // a power of two
  std::vector<std::array<std::size_t, 2>> portions_;  // two nodes, or one twice
};

}  // namespace hotblade::surface
