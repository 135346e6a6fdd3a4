#include "surface/self_crossings.hpp"

#include <CGAL/Box_intersection_d/Box_with_info_d.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <vector>

#include "surface/place_text.hpp"

namespace hotblade::surface {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Point2 = Kernel::Point_2;
using Triangle = std::array<Point, 3>;
using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, int, CGAL::Box_intersection_d::ID_EXPLICIT>;
using Signs = std::array<CGAL::Sign, 3>;

std::size_t count(const Signs& signs, CGAL::Sign wanted) {
  return static_cast<std::size_t>(std::count(signs.begin(), signs.end(), wanted));
}

// CGAL::orientation, told at once where two of the points are one, as of neighbours: there the filter of the
// exact predicate would fail.
CGAL::Sign orientation(const Point& a, const Point& b, const Point& c, const Point& d) {
  if (d == a || d == b || d == c || c == a || c == b || a == b) return CGAL::ZERO;
  return CGAL::orientation(a, b, c, d);
}

// On which side of the plane of t the corners of u lie.
Signs sides(const Triangle& t, const Triangle& u) {
  return {orientation(t[0], t[1], t[2], u[0]), orientation(t[0], t[1], t[2], u[1]),
          orientation(t[0], t[1], t[2], u[2])};
}

bool passes_through(const Signs& signs) {
  return count(signs, CGAL::POSITIVE) > 0 && count(signs, CGAL::NEGATIVE) > 0;
}

// Brings the corner that is alone on its side to the front, keeping the sense; says on which side it is.
CGAL::Sign alone_first(Triangle& t, const Signs& signs) {
  const CGAL::Sign side = count(signs, CGAL::POSITIVE) == 1 ? CGAL::POSITIVE : CGAL::NEGATIVE;
  std::rotate(t.begin(), t.begin() + (std::find(signs.begin(), signs.end(), side) - signs.begin()), t.end());
  return side;
}

// Each triangle passes through the other's plane: both hold an interval of the line where the planes meet,
// and cross where these overlap (Guigue and Devillers 2003).
bool intervals_overlap(Triangle t, const Signs& of_t, Triangle u, const Signs& of_u) {
  const CGAL::Sign t_side = alone_first(t, of_t), u_side = alone_first(u, of_u);
  if (t_side == CGAL::NEGATIVE) std::swap(u[1], u[2]);
  if (u_side == CGAL::NEGATIVE) std::swap(t[1], t[2]);
  return orientation(t[1], u[0], t[0], u[1]) == CGAL::NEGATIVE &&
         orientation(t[0], u[0], t[2], u[2]) == CGAL::NEGATIVE;
}

// Counter-clockwise, seen along an axis across which the plane is not upright.
std::array<Point2, 3> flattened(const Triangle& t, int axis) {
  std::array<Point2, 3> flat;
  for (std::size_t i = 0; i < 3; ++i) flat[i] = Point2(t[i][(axis + 1) % 3], t[i][(axis + 2) % 3]);
  if (CGAL::orientation(flat[0], flat[1], flat[2]) == CGAL::RIGHT_TURN) std::swap(flat[1], flat[2]);
  return flat;
}

// Does an edge of t have all of u on its right or on its line?
bool edge_parts(const std::array<Point2, 3>& t, const std::array<Point2, 3>& u) {
  for (std::size_t i = 0; i < 3; ++i) {
    const bool parts = std::none_of(u.begin(), u.end(), [&](const Point2& p) {
      return CGAL::orientation(t[i], t[(i + 1) % 3], p) == CGAL::LEFT_TURN;
    });
    if (parts) return true;
  }
  return false;
}

// Two triangles of one plane overlap unless an edge of either parts them.
bool areas_overlap(const Triangle& t, const Triangle& u) {
  const auto normal = CGAL::cross_product(t[1] - t[0], t[2] - t[0]);
  int axis = 0;
  for (int i = 1; i < 3; ++i) {
    if (std::abs(normal[i]) > std::abs(normal[axis])) axis = i;
  }
  const auto a = flattened(t, axis), b = flattened(u, axis);
  return !edge_parts(a, b) && !edge_parts(b, a);
}

bool cross(const Triangle& t, const Triangle& u) {
  const Signs of_u = sides(t, u);
  if (!passes_through(of_u)) return count(of_u, CGAL::ZERO) == 3 && areas_overlap(t, u);
  const Signs of_t = sides(u, t);
  return passes_through(of_t) && intervals_overlap(t, of_t, u, of_u);
}

class Faces {
 public:
  explicit Faces(const TriangleMesh& mesh) : mesh_(mesh) {}

  [[nodiscard]] Triangle triangle(int f) const {
    Triangle t;
    for (std::size_t i = 0; i < 3; ++i) {
      const Eigen::Vector3d& p = corner(f, i);
      t[i] = Point(p.x(), p.y(), p.z());
    }
    return t;
  }

  [[nodiscard]] Box box(int f) const {
    Box box(f);
    for (std::size_t i = 0; i < 3; ++i) {
      Eigen::Vector3d p = corner(f, i);
      box.extend(p.data());
    }
    return box;
  }

  // The middle of what the boxes of both faces have in common: a place to look at.
  [[nodiscard]] Eigen::Vector3d between(int f, int g) const {
    const Eigen::AlignedBox3d a = bounds(f), b = bounds(g);
    return a.intersection(b).center();
  }

 private:
  [[nodiscard]] const Eigen::Vector3d& corner(int f, std::size_t i) const {
    return mesh_.vertices[static_cast<std::size_t>(mesh_.triangles[static_cast<std::size_t>(f)][i])];
  }
  [[nodiscard]] Eigen::AlignedBox3d bounds(int f) const {
    Eigen::AlignedBox3d box;
    for (std::size_t i = 0; i < 3; ++i) box.extend(corner(f, i));
    return box;
  }
  const TriangleMesh& mesh_;
};

}  // namespace

SelfCrossings find_self_crossings(const TriangleMesh& mesh) {
  const Faces faces(mesh);
  std::vector<Box> boxes;
  boxes.reserve(mesh.triangles.size());
  for (int f = 0; f < static_cast<int>(mesh.triangles.size()); ++f) boxes.push_back(faces.box(f));
  SelfCrossings result;
  CGAL::box_self_intersection_d(boxes.begin(), boxes.end(), [&](const Box& a, const Box& b) {
    if (!cross(faces.triangle(a.info()), faces.triangle(b.info()))) return;
    const std::array<int, 2> pair{std::min(a.info(), b.info()), std::max(a.info(), b.info())};
    if (result.pairs++ == 0 || pair < result.faces) result.faces = pair;
  });
  if (result.pairs > 0) result.at = faces.between(result.faces[0], result.faces[1]);
  return result;
}

std::string self_crossings_text(const DesignSurface& design) {
  const SelfCrossings found = find_self_crossings(design.mesh);
  if (found.pairs == 0) return "";
  const auto line = [&](int f) { return std::to_string(design.face_line[static_cast<std::size_t>(f)]); };
  return std::to_string(found.pairs) +
         (found.pairs == 1 ? " pair of faces crosses" : " pairs of faces cross") +
         ", the first those of lines " + line(found.faces[0]) + " and " + line(found.faces[1]) + " near " +
         place_text(found.at) + ": only one of them can be cut there, trim the sheets";
}

}  // namespace hotblade::surface
