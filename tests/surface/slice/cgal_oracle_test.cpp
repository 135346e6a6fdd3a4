// CGAL's mesh slicer as an independent judge of the sections: other data structure, exact predicates.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_slicer.h>
#include <CGAL/Surface_mesh.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "surface/slice/slice.hpp"
#include "tests/surface/meshes.hpp"
#include "tests/surface/slice/even_sections.hpp"

namespace hotblade::surface {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using CgalMesh = CGAL::Surface_mesh<Kernel::Point_3>;

CgalMesh to_cgal(const TriangleSoup& mesh) {
  CgalMesh out;
  std::vector<CgalMesh::Vertex_index> vertices;
  for (const auto& p : mesh.vertices)
    vertices.push_back(out.add_vertex(Kernel::Point_3(p.x(), p.y(), p.z())));
  const auto at = [&](int v) { return vertices[static_cast<std::size_t>(v)]; };
  for (const auto& t : mesh.triangles) out.add_face(at(t[0]), at(t[1]), at(t[2]));
  return out;
}

double total_length(const std::vector<std::vector<Kernel::Point_3>>& polylines) {
  double length = 0;
  for (const auto& line : polylines) {
    for (std::size_t i = 1; i < line.size(); ++i)
      length += std::sqrt(CGAL::squared_distance(line[i - 1], line[i]));
  }
  return length;
}

void expect_same_sections(const TriangleSoup& mesh, const Eigen::Vector3d& normal, double inset) {
  const CgalMesh cgal_mesh = to_cgal(mesh);
  const CGAL::Polygon_mesh_slicer<CgalMesh, Kernel> slicer(cgal_mesh);
  const EvenSections graph = even_sections(mesh, normal, 10, inset);
  const Eigen::Vector3d n = graph.planes.normal(0);
  for (const Section& section : graph.sections) {
    std::vector<std::vector<Kernel::Point_3>> polylines;
    const double height = n.dot(graph.planes.centre()) + section.offset_mm;
    slicer(Kernel::Plane_3(n.x(), n.y(), n.z(), -height), std::back_inserter(polylines));
    std::erase_if(polylines, [](const auto& line) { return line.size() < 2; });
    double length = 0;
    for (const SectionPiece& piece : section.pieces) length += piece.length_mm;
    EXPECT_NEAR(length, total_length(polylines), 1e-7)
        << "normal " << n.transpose() << " at " << section.offset_mm;
  }
}

TEST(SliceAgainstCgal, FindsTheSameLengthsOnRandomPlanes) {
  std::mt19937 random(21);
  std::normal_distribution<double> any;
  const auto wave = [](double s, double t) {
    return Eigen::Vector3d(300 * s, 200 * t, 40 * std::sin(9 * s + 2 * t) + 10 * std::cos(9 * t));
  };
  const auto frame = [](int i, int j) { return i < 10 || i > 16 || j < 5 || j > 9; };
  const std::vector<TriangleSoup> meshes = {dome(400, 150, 12), tube(80, 150, 30, 7),
                                            grid(30, 20, wave, frame)};
  for (const TriangleSoup& mesh : meshes) {
    for (int round = 0; round < 25; ++round) {
      expect_same_sections(mesh, Eigen::Vector3d(any(random), any(random), any(random)), 0.05);
    }
  }
}

TEST(SliceAgainstCgal, FindsTheSameLengthsThroughVertices) {
  const auto ramp = [](double s, double t) { return Eigen::Vector3d(100 * s, 100 * t, 50 * s * t); };
  const TriangleSoup mesh = grid(10, 10, ramp);
  expect_same_sections(mesh, Eigen::Vector3d::UnitX(), 10);
  expect_same_sections(mesh, Eigen::Vector3d::UnitY(), 10);
}

}  // namespace
}  // namespace hotblade::surface
