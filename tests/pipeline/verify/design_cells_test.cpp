#include "pipeline/verify/design_cells.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <stdexcept>

namespace hotblade::pipeline {
namespace {

struct Faces {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<int, 3>> triangles;
  [[nodiscard]] MeshView view() const { return {vertices, triangles}; }
};

// Faces of all sizes, needles among them.
Faces random_faces(int count) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> log_size(-2, 2);
  Faces faces;
  for (int t = 0; t < count; ++t) {
    const double size = std::pow(10, log_size(random)), width = t % 3 == 0 ? 1e-3 : 1;
    for (int i = 0; i < 3; ++i) {
      faces.vertices.emplace_back(100.0 * t + size * normal(random), size * width * normal(random), 0);
    }
    faces.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  return faces;
}

// A square of n x n quadrilaterals, two faces each.
Faces square(int n) {
  Faces faces;
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= n; ++j) faces.vertices.emplace_back(10 * i, 10 * j, 0);
  }
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const int a = i * (n + 1) + j, b = a + n + 1;
      faces.triangles.push_back({a, b, b + 1});
      faces.triangles.push_back({a, b + 1, a + 1});
    }
  }
  return faces;
}

// No edge is wanted (0) where a cell is settled.
void divide(DesignCells& cells, const std::vector<double>& wanted_mm) {
  std::vector<DesignCells::Cut> cuts(wanted_mm.size());
  for (std::size_t i = 0; i < cuts.size(); ++i) {
    if (wanted_mm[i] > 0) cuts[i] = cells.cut_to(cells.cells().at(i), wanted_mm[i]);
  }
  cells.divide(cuts);
}

double area_of(const DesignCells& cells) {
  double area = 0;
  for (const DesignCells::Cell& cell : cells.cells()) area += cells.area_mm2(cell);
  return area;
}

TEST(DesignCells, KeepTheAreaHoweverTheyAreDivided) {
  const Faces faces = random_faces(500);
  DesignCells cells(faces.view());
  const double whole = area_of(cells);
  double settled = 0;
  std::mt19937_64 random(7);
  for (int round = 0; round < 8; ++round) {
    std::vector<double> wanted_mm(cells.cells().size());
    for (std::size_t i = 0; i < wanted_mm.size(); ++i) {
      wanted_mm[i] = random() % 4 != 0 ? 0.3 * cells.longest_edge_mm(cells.cells()[i]) : 0;
      if (wanted_mm[i] == 0) settled += cells.area_mm2(cells.cells()[i]);
    }
    divide(cells, wanted_mm);
    EXPECT_NEAR(settled + area_of(cells), whole, 1e-9 * whole);
  }
}

TEST(DesignCells, ShareTheMiddleOfAnEdge) {
  constexpr int kSide = 8;
  const Faces faces = square(kSide);
  DesignCells cells(faces.view());
  // The diagonals first, then what was the squares' sides: as a grid of half the step, with its centres.
  for (int round = 0; round < 2; ++round) divide(cells, std::vector<double>(cells.cells().size(), 1));
  EXPECT_EQ(cells.cells().size(), 8U * kSide * kSide);
  EXPECT_EQ(cells.points().size(), static_cast<std::size_t>((2 * kSide + 1) * (2 * kSide + 1)));
  std::set<std::array<double, 2>> places;
  for (const Eigen::Vector3d& p : cells.points()) places.insert({p.x(), p.y()});
  EXPECT_EQ(places.size(), cells.points().size());
}

TEST(DesignCells, OfANeedleAreAsManyAsItIsLong) {
  Faces needle;
  needle.vertices = {{0, 0, 0}, {1000, 0, 0}, {500, 1e-3, 0}};
  needle.triangles = {{0, 1, 2}};
  DesignCells cells(needle.view());
  std::size_t settled = 0;
  while (!cells.cells().empty()) {
    std::vector<double> wanted_mm;
    for (const DesignCells::Cell& cell : cells.cells()) {
      wanted_mm.push_back(cells.longest_edge_mm(cell) > 10 ? 10 : 0);
      settled += wanted_mm.back() > 0 ? 0 : 1;
    }
    divide(cells, wanted_mm);
  }
  EXPECT_GE(settled, 100U);
  EXPECT_LE(settled, 300U);
}

TEST(DesignCells, AreCutOneByOne) {
  DesignCells cells(square(2).view());
  EXPECT_THROW(cells.divide(std::vector<DesignCells::Cut>(3)), std::logic_error);
}

}  // namespace
}  // namespace hotblade::pipeline
