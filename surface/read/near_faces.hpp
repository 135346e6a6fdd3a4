// Finds which faces of a mesh lie near each other: the pairs whose bounding boxes meet.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace hotblade::surface {

// Holds the faces in the order of a space-filling curve, sixteen to a leaf, under a binary tree of boxes in
// single precision, rounded outwards: 7 bytes a face, and a search in proportion to the faces of a surface.
class NearFaces {
 public:
  // Both spans have to outlive it. Throws std::logic_error when a vertex index is out of range.
  NearFaces(std::span<const Eigen::Vector3d> vertices, std::span<const std::array<int, 3>> triangles);

  // Returns the faces in the curve's order.
  [[nodiscard]] std::span<const int> order() const { return faces_; }

  // Leaves every two faces of a set out of the search where `holds(first, count)` is true of the set of
  // `count` faces from place `first` of the order on. It is asked of thousands of faces at once, and of their
  // halves where it is false, side by side; the sets are the same whatever the number of threads.
  void leave_out(const std::function<bool(std::size_t first, std::size_t count)>& holds);

  // Returns into how many portions the search falls; they may run side by side, and are the same whatever the
  // number of threads.
  [[nodiscard]] std::size_t portions() const { return portions_.size(); }

  // Calls meet(f, g) once for every two faces of this portion whose boxes meet.
  void visit(std::size_t portion, const std::function<void(int, int)>& meet) const;

 private:
  // With eight, searches of noise take as long, and the tree twice the memory.
  static constexpr std::size_t kLeaf = 16;
  struct Box {
    std::array<float, 3> low, high;
  };
  // Some of a leaf's faces, with their boxes.
  struct Some {
    std::size_t count = 0;
    std::array<Box, kLeaf + 1> boxes;  // and one to read past
    std::array<int, kLeaf> faces;
  };
  // Nodes of one level, in the curve's order: node i has the children 2 i and 2 i + 1 of the level below.
  struct Level {
    std::size_t first, count;  // in nodes_
  };
  using Meet = std::function<void(int, int)>;
  using Holds = std::function<bool(std::size_t, std::size_t)>;

  void sort_faces();
  void grow_tree();
  void enclose_leaves();
  [[nodiscard]] std::span<const int> faces_of(std::size_t leaf) const;
  [[nodiscard]] Box box_of(std::span<const int> faces) const;
  // Finds a leaf's faces whose boxes meet another box.
  void find(std::size_t leaf, const Box& within, Some& some) const;
  void enclose();
  void divide();
  void leave_out(std::size_t level, std::size_t node, const Holds& holds);
  [[nodiscard]] bool meet_in(std::size_t level, std::size_t node, std::size_t other) const;
  void within(std::size_t level, std::size_t node, const Meet& meet) const;
  void between(std::size_t level, std::size_t node, std::size_t other, const Meet& meet) const;
  void compare(std::size_t leaf, std::size_t other, const Meet& meet) const;

  std::span<const Eigen::Vector3d> vertices_;
  std::span<const std::array<int, 3>> triangles_;
  std::vector<int> faces_;      // in the curve's order
  std::vector<Box> nodes_;      // and one to read past
  std::vector<char> left_out_;  // of each node: no two of its faces are compared; empty: of none
  std::vector<Level> levels_;   // the leaves' first, the root's last
  std::size_t top_ = 0;         // the level that portions are made of
  std::vector<std::array<std::size_t, 2>> portions_;  // two nodes, or one twice
};

}  // namespace hotblade::surface
