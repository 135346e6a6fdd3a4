// Finds which faces of a mesh lie near each other: the pairs whose bounding boxes meet.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace hotblade::surface {

// Holds the faces in the order of a space-filling curve, eight to a leaf, under a binary tree of boxes in
// single precision, rounded outwards: 34 bytes a face, and a search in proportion to the faces of a surface.
class NearFaces {
 public:
  // Refers to neither span once built. Throws std::logic_error when a vertex index is out of range.
  NearFaces(std::span<const Eigen::Vector3d> vertices, std::span<const std::array<int, 3>> triangles);

  // Returns into how many portions the search falls; they may run side by side, and are the same whatever the
  // number of threads.
  [[nodiscard]] std::size_t portions() const { return portions_.size(); }

  // Calls meet(f, g) once for every two faces of this portion whose boxes meet, and for a few more that lie
  // within rounding to single precision of each other.
  void visit(std::size_t portion, const std::function<void(int, int)>& meet) const;

 private:
  struct Box {
    std::array<float, 3> low, high;
  };
  // Nodes of one level, in the curve's order: node i has the children 2 i and 2 i + 1 of the level below.
  struct Level {
    std::size_t first, count;  // in nodes_
  };
  using Meet = std::function<void(int, int)>;

  void sort_faces(std::span<const Eigen::Vector3d> vertices, std::span<const std::array<int, 3>> triangles);
  void grow_tree();
  void divide();
  [[nodiscard]] bool meet_in(std::size_t level, std::size_t node, std::size_t other) const;
  void within(std::size_t level, std::size_t node, const Meet& meet) const;
  void between(std::size_t level, std::size_t node, std::size_t other, const Meet& meet) const;
  void compare(std::size_t leaf, std::size_t other, const Meet& meet) const;

  std::vector<int> faces_;                            // in the curve's order
  std::vector<Box> boxes_;                            // of faces_, and one to read past
  std::vector<Box> nodes_;                            // and one to read past
  std::vector<Level> levels_;                         // the leaves' first, the root's last
  std::size_t top_ = 0;                               // the level that portions are made of
  std::vector<std::array<std::size_t, 2>> portions_;  // two nodes, or one twice
};

}  // namespace hotblade::surface
