#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cmath>

#include "tests/bench/distance_peers.hpp"

namespace hotblade::bench {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

class Cgal : public Peer {
 public:
  explicit Cgal(const PeerMesh& mesh) {
    const auto corner = [&](int i) {
      const auto& v = mesh.vertices[static_cast<std::size_t>(i)];
      return Kernel::Point_3(v[0], v[1], v[2]);
    };
    for (const auto& t : mesh.triangles) triangles_.emplace_back(corner(t[0]), corner(t[1]), corner(t[2]));
    tree_.insert(triangles_.cbegin(), triangles_.cend());
    tree_.build();
    tree_.accelerate_distance_queries();
  }
  void query(const std::vector<std::array<double, 3>>& points,
             std::vector<double>& distances) const override {
    distances.resize(points.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.size(), 256), [&](const auto& range) {
      for (std::size_t i = range.begin(); i != range.end(); ++i) {
        const Kernel::Point_3 p(points[i][0], points[i][1], points[i][2]);
        distances[i] = std::sqrt(CGAL::squared_distance(p, tree_.closest_point(p)));
      }
    });
  }

 private:
  Triangles triangles_;
  Tree tree_;
};

}  // namespace

std::unique_ptr<Peer> cgal_tree(const PeerMesh& mesh) {
  return std::make_unique<Cgal>(mesh);
}

}  // namespace hotblade::bench
