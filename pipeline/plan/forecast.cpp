#include "pipeline/plan/forecast.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <Eigen/Dense>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <span>
#include <stdexcept>
#include <utility>

#include "pipeline/plan/direction/body_axes.hpp"
#include "pipeline/plan/face_plans.hpp"
#include "pipeline/plan/ribs/rib_fit.hpp"
#include "pipeline/plan/sweep/sweep_directions.hpp"
#include "pipeline/plan/thinned.hpp"
#include "pipeline/verify/design_faces.hpp"
#include "robot/blade/blade_section.hpp"
#include "surface/read/blocks.hpp"
#include "surface/slice/smooth_faces.hpp"

namespace hotblade::pipeline {

namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kInf = std::numeric_limits<double>::infinity();

// Cells of a grid over a design, about: at most, and at least where its mesh has as many points.
constexpr double kCells = 6000, kLeastCells = 1000;

// The unit normal times twice the area.
Vector3d doubled_area(const surface::TriangleMesh& mesh, const std::array<int, 3>& t) {
  const auto at = [&](std::size_t i) -> const Vector3d& {
    return mesh.vertices()[static_cast<std::size_t>(t[i])];
  };
  return (at(1) - at(0)).cross(at(2) - at(0));
}

double area_of(const surface::TriangleMesh& mesh) {
  double area = 0;
  for (const auto& t : mesh.triangles()) area += 0.5 * doubled_area(mesh, t).norm();
  return area;
}

// Of the area's mean normal towards z, from -1 to 1.
double lean_of(const surface::TriangleMesh& mesh) {
  double up = 0, area = 0;
  for (const auto& t : mesh.triangles()) {
    const Vector3d n = doubled_area(mesh, t);
    up += n.z();
    area += n.norm();
  }
  return area > 0 ? up / area : 0;
}

// The surface at a point: its normal, two unit vectors square to it, the curvatures in them, and its area.
struct Curved {
  Vector3d at, normal, e1, e2;
  Matrix2d curvature;  // of sections along e1, e2
  double area = 0;
};

// Vertices about each, by the mesh's edges: of one after the other, each once for every triangle there.
class Neighbours {
 public:
  explicit Neighbours(const surface::TriangleMesh& mesh) : first_(mesh.vertices().size() + 1, 0) {
    for (const auto& t : mesh.triangles())
      for (const int v : t) first_[static_cast<std::size_t>(v) + 1] += 2;
    for (std::size_t v = 1; v < first_.size(); ++v) first_[v] += first_[v - 1];
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    all_.resize(first_.back());
    for (const auto& t : mesh.triangles()) {
      for (std::size_t i = 0; i < 3; ++i) {
        std::size_t& at = next[static_cast<std::size_t>(t[i])];
        all_[at++] = t[(i + 1) % 3];
        all_[at++] = t[(i + 2) % 3];
      }
    }
  }

  [[nodiscard]] std::span<const int> of(int v) const {
    const auto i = static_cast<std::size_t>(v);
    return std::span(all_).subspan(first_[i], first_[i + 1] - first_[i]);
  }

  // Two rings about a vertex, without it, ascending.
  void rings(int v, std::vector<int>& both) const {
    const std::span<const int> ring = of(v);
    both.assign(ring.begin(), ring.end());
    unique(both);
    for (std::size_t i = 0, near = both.size(); i < near; ++i) {
      const std::span<const int> further = of(both[i]);
      both.insert(both.end(), further.begin(), further.end());
    }
    unique(both);
    both.erase(std::remove(both.begin(), both.end(), v), both.end());
  }

 private:
  static void unique(std::vector<int>& some) {
    std::sort(some.begin(), some.end());
    some.erase(std::unique(some.begin(), some.end()), some.end());
  }

  std::vector<std::size_t> first_;  // of each vertex in `all_`
  std::vector<int> all_;
};

// The second derivatives of the quadric through a point that fits best to others about it, heights over its
// tangent plane; nothing where they do not determine one.
std::optional<Matrix2d> second_form(const Curved& c, std::span<const Vector3d> points,
                                    std::span<const int> about) {
  constexpr std::size_t kUnknowns = 5;
  if (about.size() < kUnknowns + 1) return std::nullopt;
  double far = 0;
  for (const int w : about) far = std::max(far, (points[static_cast<std::size_t>(w)] - c.at).norm());
  using Vector5 = Eigen::Matrix<double, 5, 1>;
  Eigen::Matrix<double, 5, 5> normal = Eigen::Matrix<double, 5, 5>::Zero();
  Vector5 right = Vector5::Zero();
  for (const int w : about) {
    const Vector3d d = (points[static_cast<std::size_t>(w)] - c.at) / far;
    const double x = d.dot(c.e1), y = d.dot(c.e2);
    const Vector5 row(0.5 * x * x, x * y, 0.5 * y * y, x, y);
    normal += row * row.transpose();
    right += d.dot(c.normal) * row;
  }
  const Eigen::LDLT<Eigen::Matrix<double, 5, 5>> solver(normal);
  constexpr double kDetermined = 1e-10;  // of the largest pivot: neighbours on a line say nothing of the rest
  const Vector5 pivots = solver.vectorD();
  if (!(pivots.minCoeff() > kDetermined * pivots.maxCoeff())) return std::nullopt;
  const Vector5 q = solver.solve(right);
  // The tangent plane leans by the two slopes: the second form in its own axes, to first order of them.
  const double length = std::sqrt(1 + q[3] * q[3] + q[4] * q[4]);
  Matrix2d second, first;
  second << q[0], q[1], q[1], q[2];
  first << 1 + q[3] * q[3], q[3] * q[4], q[3] * q[4], 1 + q[4] * q[4];
  const Eigen::LLT<Matrix2d> root(first);
  const Matrix2d l = root.matrixL();
  const Matrix2d inverse = l.inverse();
  return Matrix2d(inverse * second * inverse.transpose() / (length * far));
}

// One of so many vertices, about, in no order that rows of a grid have.
std::vector<std::size_t> some_of(std::size_t vertices, std::size_t every) {
  constexpr std::uint64_t kSpread = 0x9E3779B97F4A7C15;
  std::vector<std::size_t> some;
  for (std::size_t v = 0; v < vertices; ++v)
    if (((v * kSpread) >> 32) % every == 0) some.push_back(v);
  return some;
}

// At one of so many vertices.
std::vector<Curved> curved_points(const surface::TriangleMesh& mesh, std::size_t every = 1) {
  const std::size_t n = mesh.vertices().size();
  const Neighbours about(mesh);
  std::vector<Vector3d> normals(n, Vector3d::Zero());
  std::vector<double> areas(n, 0.0);
  for (const auto& t : mesh.triangles()) {
    const Vector3d d = doubled_area(mesh, t);
    const double share = d.norm() / 6;
    for (const int v : t) {
      normals[static_cast<std::size_t>(v)] += d;
      areas[static_cast<std::size_t>(v)] += share;
    }
  }
  std::vector<char> on_border(n, 0);
  for (const int corner : mesh.border()) {
    on_border[static_cast<std::size_t>(surface::vertex_at(mesh, corner))] = 1;
    on_border[static_cast<std::size_t>(surface::vertex_at(mesh, surface::next_corner(corner)))] = 1;
  }
  const std::vector<std::size_t> asked = some_of(n, every);
  std::vector<std::optional<Curved>> found(asked.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, found.size()), [&](const auto& range) {
    std::vector<int> both;
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      const std::size_t v = asked[i];
      // At the border one side is missing; the points beside it speak for it.
      if (on_border[v] || !(areas[v] > 0) || !(normals[v].norm() > 0)) continue;
      Curved c{mesh.vertices()[v], normals[v].normalized(), {}, {}, {}, areas[v]};
      c.e1 = c.normal.unitOrthogonal();
      c.e2 = c.normal.cross(c.e1);
      about.rings(static_cast<int>(v), both);
      if (const auto form = second_form(c, mesh.vertices(), both)) {
        c.curvature = *form;
        found[i] = c;
      }
    }
  });
  std::vector<Curved> curved;
  for (const auto& c : found)
    if (c) curved.push_back(*c);
  return curved;
}

// The bend of an area whose points have these curvatures.
Bending bend_of(const std::vector<Curved>& points, const std::vector<double>& curvatures,
                double blade_radius_mm) {
  constexpr double kLeftOut = 1e-3;
  std::vector<std::size_t> order(points.size());
  double all = 0, sharper = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    order[i] = i;
    all += points[i].area;
    if (curvatures[i] * blade_radius_mm > 1) sharper += points[i].area;
  }
  const auto sharper_than = [&](std::size_t i, std::size_t j) {
    return curvatures[i] != curvatures[j] ? curvatures[i] > curvatures[j] : i < j;
  };
  // The sharpest few are looked at, and the rest only where those have next to no area.
  const std::size_t few = std::min(order.size(), order.size() / 20 + 10);
  std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(few), order.end(),
                    sharper_than);
  Bending bend{kInf, Vector3d::Zero(), all > 0 ? sharper / all : 0};
  double left_out = 0;
  for (std::size_t k = 0; k < order.size(); ++k) {
    if (k == few) std::sort(order.begin() + static_cast<std::ptrdiff_t>(few), order.end(), sharper_than);
    const std::size_t i = order[k];
    left_out += points[i].area;
    if (left_out <= kLeftOut * all) continue;
    bend.radius_mm = curvatures[i] > 0 ? 1 / curvatures[i] : kInf;
    bend.at = points[i].at;
    break;
  }
  return bend;
}

Bending surface_bend(const std::vector<Curved>& points, double blade_radius_mm) {
  std::vector<double> curvatures;
  for (const Curved& c : points) {
    const Eigen::SelfAdjointEigenSolver<Matrix2d> solver(c.curvature, Eigen::EigenvaluesOnly);
    curvatures.push_back(solver.eigenvalues().cwiseAbs().maxCoeff());
  }
  return bend_of(points, curvatures, blade_radius_mm);
}

// Of sections by planes: what is too steep against them counts as straight, as no blade forms it anyway.
Bending section_bend(const std::vector<Curved>& points, const surface::PlaneFamily& planes,
                     double blade_radius_mm) {
  std::vector<double> curvatures;
  for (const Curved& c : points) {
    const Vector3d across = planes.normal_at(c.at);
    const double sine = std::min(1.0, std::abs(c.normal.dot(across)));
    if (sine > std::sin(kMaxSlopeRad)) {
      curvatures.push_back(0);
      continue;
    }
    const Vector3d along = across.cross(c.normal).normalized();
    const Vector2d t(along.dot(c.e1), along.dot(c.e2));
    // Meusnier: a section at a slant bends more sharply than the normal one along the same tangent.
    curvatures.push_back(std::abs(t.dot(c.curvature * t)) / std::sqrt(1 - sine * sine));
  }
  return bend_of(points, curvatures, blade_radius_mm);
}

// Takes of these planes those that leave least of the area too steep or too sharply bent for the blade; of
// equal ones those whose sections bend least.
void choose_planes(const surface::TriangleMesh& mesh, const std::vector<Curved>& points,
                   const std::vector<surface::PlaneFamily>& all, Forecast& f) {
  WasteSurface faces;  // neither normals nor border are asked for
  faces.points.assign(mesh.vertices().begin(), mesh.vertices().end());
  faces.triangles.assign(mesh.triangles().begin(), mesh.triangles().end());
  const std::vector<double> steep = too_steep_shares(faces, {}, all);
  std::vector<std::pair<double, Bending>> tried(all.size());
  tbb::parallel_for(std::size_t{0}, all.size(), [&](std::size_t i) {
    tried[i] = {steep[i], section_bend(points, all[i], f.blade_radius_mm)};
  });
  const auto better = [](const auto& a, const auto& b) {
    constexpr double kSame = 1e-3;  // of the area
    const double lost_a = a.first + a.second.sharper_share, lost_b = b.first + b.second.sharper_share;
    if (std::abs(lost_a - lost_b) > kSame) return lost_a < lost_b;
    return a.second.radius_mm > b.second.radius_mm;
  };
  std::size_t best = 0;
  for (std::size_t i = 1; i < tried.size(); ++i)
    if (better(tried[i], tried[best])) best = i;
  f.planes = all[best].normal(0);
  f.steep_share = tried[best].first;
  f.sections = tried[best].second;
}

// The side of a closed design that would be cut: the one that shows most of its faces; upwards where that is
// as good, and along an axis where that is nearly so.
std::array<double, 3> facing_of(const surface::TriangleMesh& mesh, double facing_max_deg) {
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const auto& t : mesh.triangles()) {
    const Vector3d d = doubled_area(mesh, t);
    if (const double size = d.norm(); size > 0) spread += d * d.transpose() / size;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
  Vector3d main = solver.eigenvectors().col(2);
  main *= main[2] < 0 ? -1 : 1;
  const std::array<Vector3d, 7> sides{Vector3d(0, 0, 1),
                                      Vector3d(0, 1, 0),
                                      Vector3d(0, -1, 0),
                                      Vector3d(1, 0, 0),
                                      Vector3d(-1, 0, 0),
                                      main,
                                      -main};
  const double least = std::cos(facing_max_deg * std::numbers::pi / 180);
  std::array<double, sides.size()> seen{};
  for (const auto& t : mesh.triangles()) {
    const Vector3d d = doubled_area(mesh, t);
    const double size = d.norm();
    for (std::size_t i = 0; i < sides.size(); ++i)
      if (const double towards = d.dot(sides[i]); towards > least * size) seen[i] += towards;
  }
  constexpr double kClearlyMore = 1.15;
  std::size_t best = 0;
  for (std::size_t i = 1; i < sides.size(); ++i)
    if (seen[i] > kClearlyMore * seen[best]) best = i;
  // Four digits are enough to name a direction.
  const auto rounded = [](double x) { return std::round(x * 1e4) / 1e4 + 0.0; };
  return {rounded(sides[best].x()), rounded(sides[best].y()), rounded(sides[best].z())};
}

surface::TriangleMesh facing_part(const surface::TriangleMesh& mesh, const std::array<double, 3>& facing,
                                  double facing_max_deg) {
  const Vector3d towards = Vector3d(facing.data()).normalized();
  const double least = std::cos(facing_max_deg * std::numbers::pi / 180);
  surface::TriangleSoup soup{{mesh.vertices().begin(), mesh.vertices().end()}, {}};
  for (const auto& t : mesh.triangles()) {
    const Vector3d d = doubled_area(mesh, t);
    if (d.dot(towards) > least * d.norm()) soup.triangles.push_back(t);
  }
  return surface::TriangleMesh(std::move(soup));
}

// Shares of the area, looked at along each axis.
Vector3d seen_along_axes(const surface::TriangleMesh& mesh) {
  Vector3d seen{0, 0, 0};
  double area = 0;
  for (const auto& t : mesh.triangles()) {
    const Vector3d n = doubled_area(mesh, t);
    seen += n.cwiseAbs();
    area += n.norm();
  }
  return area > 0 ? Vector3d(seen / area) : seen;
}

Shape shape_of(const surface::DesignSurface& design, double area_mm2, const Vector3d& seen,
               const Forecast& f) {
  Shape shape;
  shape.units = design.units;
  shape.size_mm = design.health.bbox_mm[1] - design.health.bbox_mm[0];
  shape.area_mm2 = area_mm2;
  shape.radius_mm = f.sections.radius_mm;
  shape.lost_share = f.sections.sharper_share + f.steep_share;
  shape.blade_radius_mm = f.blade_radius_mm;
  shape.facing = f.facing;
  shape.facing_share = f.facing_share;
  shape.upright = f.upright;
  shape.seen = seen;
  shape.up = design.up;
  return shape;
}

bool planes_are_given(const SliceSettings& slice) {
  return slice.direction || slice.fan_axis;
}

// Its size is judged by the planes that suit it: by others where most is lost in those that were given.
Shape shape_in_any_planes(const Shape& in_given, const surface::TriangleMesh& mesh,
                          const std::vector<Curved>& points, const Settings& settings, Forecast f) {
  if (!planes_are_given(settings.slice) || !is_mostly_lost(in_given)) return in_given;
  SliceSettings free = settings.slice;
  free.direction.reset();
  free.fan_axis.reset();
  choose_planes(mesh, points, sweep_planes(mesh, free), f);
  const double lost = f.sections.sharper_share + f.steep_share;
  if (lost >= in_given.lost_share) return in_given;
  Shape shape = in_given;
  shape.radius_mm = f.sections.radius_mm;
  shape.lost_share = lost;
  shape.lost_in_given = in_given.lost_share;
  return shape;
}

// The faces of a design that would be cut.
struct CutFaces {
  surface::TriangleMesh mesh;
  double area_mm2 = 0;

  CutFaces(const surface::DesignSurface& design, const Settings& settings, Forecast& f)
      : mesh(design.mesh), area_mm2(design.health.area_mm2) {
    if (design.health.closed && !settings.design.facing) {
      const std::array<double, 3> facing = facing_of(design.mesh, settings.design.facing_max_deg);
      const surface::TriangleMesh faces = facing_part(design.mesh, facing, settings.design.facing_max_deg);
      // None where hardly any angle between faces and direction is allowed.
      if (const double faced = area_of(faces); faced > 0) {
        f.facing = facing;
        f.facing_share = faced / area_mm2;
        mesh = faces;
        area_mm2 = faced;
      }
    }
    if (!(area_mm2 > 0)) throw std::logic_error("forecast: a design without area");
  }

  // Two rings of cells so wide reach as far as a bend of the blade's radius has to for the depth of the
  // tolerance. A design that is small for that keeps some cells.
  void thin(double blade_radius_mm, double tolerance_mm) {
    const double passed_over = std::sqrt(blade_radius_mm * tolerance_mm / 2);
    const surface::TriangleMesh few = thinned(
        mesh,
        std::max(std::sqrt(area_mm2 / kCells), std::min(passed_over, std::sqrt(area_mm2 / kLeastCells))));
    if (!few.triangles().empty()) mesh = few;
  }
};

// What a forecast begins with.
Forecast begun(const Settings& settings) {
  Forecast f;
  f.blade_radius_mm = 1 / robot::max_curvature_per_mm(settings.blade);
  return f;
}

// Of the faces that would be cut, thinned.
void tell_lean(const surface::TriangleMesh& cut, Forecast& f) {
  f.lean = lean_of(cut);
  f.upright = waste_side(cut, Keep::kBelow) == 0;
}

}  // namespace

Forecast forecast(const surface::DesignSurface& design, const Settings& settings) {
  Forecast f = begun(settings);
  CutFaces cut(design, settings, f);
  const double area = cut.area_mm2;
  f.strips_lower_bound = strips_lower_bound(area, settings);
  const surface::TriangleMesh whole = cut.mesh;
  Vector3d seen = Vector3d::Zero();
  surface::side_by_side(
      [&] {
        const auto faces = [&](const Settings& with) {
          const auto found = surface::smooth_faces(whole, crease_limits(with, with.blade));
          const bool apart = found.size() == 1 && design.health.components > 1;
          return apart ? parts_apart(found.front()).size() : found.size();
        };
        f.faces = f.faces_between_folds = faces(settings);
        if (settings.slice.shallow_folds != ShallowFolds::kAuto) return;
        Settings parted = settings;
        parted.slice.shallow_folds = ShallowFolds::kParted;
        f.faces_between_folds = faces(parted);
      },
      [&] {
        cut.thin(f.blade_radius_mm, settings.design.tolerance_mm);
        seen = seen_along_axes(design.mesh);
      });
  tell_lean(cut.mesh, f);
  const std::vector<Curved> points = curved_points(cut.mesh);
  f.surface = surface_bend(points, f.blade_radius_mm);
  choose_planes(cut.mesh, points, sweep_planes(cut.mesh, settings.slice), f);
  const Shape shape = shape_in_any_planes(shape_of(design, area, seen, f), cut.mesh, points, settings, f);
  f.odd_size = odd_size(shape, settings);
  f.planes_warning = planes_warning(shape);
  f.reasons = reasons(shape, settings);
  f.suggestions = suggestions(shape, f.odd_size, settings);
  return f;
}

namespace {

std::vector<surface::PlaneFamily> along_axes(const surface::TriangleMesh& mesh) {
  std::vector<surface::PlaneFamily> along;
  const BodyAxes body = body_axes(mesh);
  for (const Vector3d& n : body.axes) along.push_back(surface::PlaneFamily::parallel(n, body.centre));
  return along;
}

// Whether some points of the design alone say that its size is usual. Those of a finer mesh bend more sharply
// than of one that is thinned, if anything.
bool some_say_usual(const surface::TriangleMesh& mesh, const Vector3d& seen, double area,
                    const surface::DesignSurface& design, const Settings& settings, Forecast f) {
  // Of an area's share so many tell a fiftieth of the whole; four times that is left.
  constexpr std::size_t kSome = 600;
  constexpr double kReserve = 0.08;
  const std::vector<Curved> points =
      curved_points(mesh, std::max<std::size_t>(1, mesh.vertices().size() / kSome));
  if (points.empty()) return false;
  choose_planes(mesh, points, along_axes(mesh), f);
  Shape shape = shape_of(design, area, seen, f);
  shape.lost_share += kReserve;
  return is_of_usual_size(shape, settings);
}

}  // namespace

FirstLook first_look(const surface::DesignSurface& design, const Settings& settings) {
  // Of more vertices a mesh that is thinned first is looked at sooner.
  constexpr std::size_t kThinned = 2 * static_cast<std::size_t>(kCells);
  Forecast f = begun(settings);
  CutFaces cut(design, settings, f);
  const double area = cut.area_mm2;
  const Vector3d seen = seen_along_axes(design.mesh);
  const bool free = !planes_are_given(settings.slice);
  // Of no size that asks for more, and in planes along its axes most of the design is followed: the best
  // planes say the same.
  const auto usual = [&] {
    return FirstLook{std::nullopt, std::nullopt,
                     suggestions(shape_of(design, area, seen, f), std::nullopt, settings)};
  };
  const bool thin = cut.mesh.vertices().size() > kThinned;
  if (thin) cut.thin(f.blade_radius_mm, settings.design.tolerance_mm);
  tell_lean(cut.mesh, f);
  if (free && some_say_usual(cut.mesh, seen, area, design, settings, f)) return usual();
  if (!thin) cut.thin(f.blade_radius_mm, settings.design.tolerance_mm);
  tell_lean(cut.mesh, f);
  const std::vector<Curved> points = curved_points(cut.mesh);
  if (free) {
    choose_planes(cut.mesh, points, along_axes(cut.mesh), f);
    if (is_of_usual_size(shape_of(design, area, seen, f), settings)) return usual();
  }
  choose_planes(cut.mesh, points, sweep_planes(cut.mesh, settings.slice), f);
  const Shape shape = shape_in_any_planes(shape_of(design, area, seen, f), cut.mesh, points, settings, f);
  const std::optional<OddSize> odd = odd_size(shape, settings);
  return {odd, planes_warning(shape), suggestions(shape, odd, settings)};
}

}  // namespace hotblade::pipeline
