#include "surface/read/self_crossings.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <vector>

#include "surface/read/half_edges.hpp"
#include "surface/read/near_faces.hpp"
#include "surface/read/place_text.hpp"
#include "surface/read/single_layers.hpp"
#include "surface/read/spread_fans.hpp"
#include "surface/read/warning.hpp"

namespace hotblade::surface {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Point2 = Kernel::Point_2;
using Triangle = std::array<Point, 3>;
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
  explicit Faces(const TriangleMesh& mesh) : mesh_(mesh), spread_(mesh) {
    for (const Eigen::Vector3d& p : mesh.vertices())
      largest_ = std::max(largest_, p.lpNorm<Eigen::Infinity>());
  }

  [[nodiscard]] Triangle triangle(int f) const {
    Triangle t;
    for (std::size_t i = 0; i < 3; ++i) {
      const Eigen::Vector3d& p = corner(f, i);
      t[i] = Point(p.x(), p.y(), p.z());
    }
    return t;
  }

  // Told in plain numbers, without a doubt: they are side by side about a vertex, or a plane parts the faces,
  // or, where they share a corner or an edge, parts them but for that. True of nearly all neighbours of a
  // surface, flat ones among them, whose exact predicates would fail their filters. False: not known.
  [[nodiscard]] bool surely_apart(int f, int g) const {
    const auto &t = mesh_.triangles()[static_cast<std::size_t>(f)],
               &u = mesh_.triangles()[static_cast<std::size_t>(g)];
    for (const int v : t)
      if ((v == u[0] || v == u[1] || v == u[2]) && spread_.holds(v)) return true;
    // Shared corners last.
    std::array<int, 3> own_t{}, own_u{};
    std::size_t count = 0, shared = 3, count_u = 0, shared_u = 3;
    for (const int v : t) own_t[v == u[0] || v == u[1] || v == u[2] ? --shared : count++] = v;
    for (const int v : u) own_u[v == t[0] || v == t[1] || v == t[2] ? --shared_u : count_u++] = v;
    if (count == 0 || count != count_u) return false;
    const Eigen::Vector3d& origin = vertex(own_t[2]);
    std::array<Eigen::Vector3d, 3> a, b;
    for (std::size_t i = 0; i < 3; ++i) {
      a[i] = vertex(own_t[i]) - origin;
      b[i] = vertex(own_u[i]) - origin;
    }
    if (count == 1) return edge_parted(a[0], b[0], a[1]);
    if (count == 3) return parted(b[0] + b[1] + b[2] - a[0] - a[1] - a[2], a, b, 3);
    // Long and short edges at the corner: their directions alone tell then.
    return parted(b[0] + b[1] - a[0] - a[1], a, b, 2) ||
           parted(b[0].normalized() + b[1].normalized() - a[0].normalized() - a[1].normalized(), a, b, 2);
  }

  // The middle of what the boxes of both faces have in common: a place to look at.
  [[nodiscard]] Eigen::Vector3d between(int f, int g) const {
    const Eigen::AlignedBox3d a = bounds(f), b = bounds(g);
    return a.intersection(b).center();
  }

 private:
  [[nodiscard]] const Eigen::Vector3d& vertex(int v) const {
    return mesh_.vertices()[static_cast<std::size_t>(v)];
  }
  // A difference of coordinates is off by half an ulp of itself, and so is each of the five operations of a
  // product's sum: together less than this times the largest coordinate and the sum of |across|.
  static constexpr double kRounding = 64 * std::numeric_limits<double>::epsilon();

  // Do the first `own` corners of a lie below those of b along `across`, by more than rounding, and with two
  // of them on both sides of the shared corner at the origin?
  [[nodiscard]] bool parted(const Eigen::Vector3d& across, const std::array<Eigen::Vector3d, 3>& a,
                            const std::array<Eigen::Vector3d, 3>& b, std::size_t own) const {
    double highest = -std::numeric_limits<double>::infinity(), lowest = -highest;
    for (std::size_t i = 0; i < own; ++i) {
      highest = std::max(highest, across.dot(a[i]));
      lowest = std::min(lowest, across.dot(b[i]));
    }
    const double doubt = kRounding * largest_ * across.lpNorm<1>();
    return own == 3 ? highest + doubt < lowest : highest + doubt < 0 && doubt < lowest;
  }

  // The same for an edge from the origin and the corners a and b beyond it on either side.
  [[nodiscard]] bool edge_parted(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                 const Eigen::Vector3d& edge) const {
    const double squared = edge.squaredNorm();
    const Eigen::Vector3d d = b - a, across = squared * d - d.dot(edge) * edge;
    // What rounding leaves of it along the edge: the plane meets the edge's line at this slope, and may lie
    // on its wrong side as far out as a corner is; 1 + r^2 is more than r.
    const double along = across.dot(edge), reach = std::max(a.squaredNorm(), b.squaredNorm()) / squared;
    const double doubt = kRounding * largest_ * across.lpNorm<1>() + std::abs(along) * (2 + reach);
    return across.dot(a) + doubt < std::min(0.0, along) && std::max(0.0, along) + doubt < across.dot(b);
  }

  [[nodiscard]] const Eigen::Vector3d& corner(int f, std::size_t i) const {
    return mesh_.vertices()[static_cast<std::size_t>(mesh_.triangles()[static_cast<std::size_t>(f)][i])];
  }
  [[nodiscard]] Eigen::AlignedBox3d bounds(int f) const {
    Eigen::AlignedBox3d box;
    for (std::size_t i = 0; i < 3; ++i) box.extend(corner(f, i));
    return box;
  }
  const TriangleMesh& mesh_;
  SpreadFans spread_;
  double largest_ = 0;  // coordinate
};

}  // namespace

SelfCrossings find_self_crossings(const TriangleMesh& mesh, const std::function<void()>& watch) {
  const auto look = [&] {
    if (watch) watch();
  };
  const Faces faces(mesh);
  NearFaces near(mesh.vertices(), mesh.triangles());
  if (!mesh.triangles().empty() && mesh.half_edges().plain()) {
    const SingleLayers layers(mesh, near.order());
    near.leave_out([&](std::size_t first, std::size_t count) {
      look();
      return layers.holds(first, count);
    });
  }
  std::vector<SelfCrossings> found(near.portions());
  tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t i) {
    look();
    near.visit(i, [&](int f, int g) {
      if (faces.surely_apart(f, g) || !cross(faces.triangle(f), faces.triangle(g))) return;
      found[i].count({std::min(f, g), std::max(f, g)}, 1);
    });
  });
  look();  // a search that was ended beside others may return half done
  SelfCrossings result;
  for (const SelfCrossings& part : found) {
    if (part.pairs > 0) result.count(part.faces, part.pairs);
  }
  if (result.pairs > 0) result.at = faces.between(result.faces[0], result.faces[1]);
  return result;
}

std::string self_crossings_text(const DesignSurface& design, const std::function<void()>& watch) {
  const SelfCrossings found = find_self_crossings(design.mesh, watch);
  if (found.pairs == 0) return "";
  const auto place = [&](int f) { return std::to_string(design.face_place[static_cast<std::size_t>(f)]); };
  return text_of(
      found.pairs, Warning::kFacesCross,
      {std::string(design.place), place(found.faces[0]), place(found.faces[1]), place_text(found.at)});
}

}  // namespace hotblade::surface
