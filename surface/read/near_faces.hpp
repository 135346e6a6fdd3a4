// Finds which faces of a mesh lie near each other: the pairs whose bounding boxes meet.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace hotblade::surface {

// Holds the faces in the order of a space-filling curve, eight to a leaf, under a binary tree of boxes in
// single precision, rounded outwards; a face's own box is kept in bytes, as shares of its leaf's: 16 bytes a
// face, and a search in proportion to the faces of a surface.
class NearFaces {
 public:
  // Refers to neither span once built. Throws std::logic_error when a vertex index is out of range.
  NearFaces(std::span<const Eigen::Vector3d> vertices, std::span<const std::array<int, 3>> triangles);

  // Returns into how many portions the search falls; they may run side by side, and are the same whatever the
  // number of threads.
  [[nodiscard]] std::size_t portions() const { return portions_.size(); }

  // Calls meet(f, g) once for every two faces of this portion whose boxes meet, and for a few more whose
  // boxes are less than a hundredth of a leaf's size apart.
  void visit(std::size_t portion, const std::function<void(int, int)>& meet) const;

 private:
  static constexpr std::size_t kLeaf = 8;
  struct Box {
    std::array<float, 3> low, high;
  };
  // Of each of a leaf's faces, axis by axis: how far its box begins over the leaf's lowest number and ends
  // under its highest, in steps of a 255th of the leaf's size.
  struct LeafBoxes {
    std::array<std::array<std::uint8_t, kLeaf>, 3> low, high;
  };
  // Some of a leaf's faces, with their boxes as numbers.
  struct Unpacked {
    std::size_t count = 0;
    std::array<Box, kLeaf + 1> boxes;  // and one to read past
    std::array<int, kLeaf> faces;
  };
  // Nodes of one level, in the curve's order: node i has the children 2 i and 2 i + 1 of the level below.
  struct Level {
    std::size_t first, count;  // in nodes_
  };
  using Meet = std::function<void(int, int)>;

  void sort_faces(std::span<const Eigen::Vector3d> vertices, std::span<const std::array<int, 3>> triangles);
  void pack_leaves(std::span<const Eigen::Vector3d> vertices, std::span<const std::array<int, 3>> triangles);
  void pack_leaf(std::size_t leaf, std::span<const Box> boxes);
  void unpack(std::size_t leaf, const Box& within, Unpacked& some) const;
  void grow_tree();
  void enclose();
  void divide();
  [[nodiscard]] bool meet_in(std::size_t level, std::size_t node, std::size_t other) const;
  void within(std::size_t level, std::size_t node, const Meet& meet) const;
  void between(std::size_t level, std::size_t node, std::size_t other, const Meet& meet) const;
  void compare(std::size_t leaf, std::size_t other, const Meet& meet) const;

  std::vector<int> faces_;  // in the curve's order
  std::vector<LeafBoxes> leaves_;
  std::vector<Box> nodes_;                            // and one to read past
  std::vector<Level> levels_;                         // the leaves' first, the root's last
  std::size_t top_ = 0;                               // the level that portions are made of
  std::vector<std::array<std::size_t, 2>> portions_;  // two nodes, or one twice
};

}  // namespace hotblade::surface
