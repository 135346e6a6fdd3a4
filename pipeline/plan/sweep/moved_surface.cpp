#include "pipeline/plan/sweep/moved_surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "gpu/backend/stop.hpp"
#include "robot/blade/band_edge.hpp"
#include "surface/read/blocks.hpp"

namespace hotblade::pipeline {

namespace {

using Eigen::Vector3d;

Vector3d in_plane(const Frame& plane, double offset, const Vector3d& p) {
  const Vector3d d = p - plane.origin;
  return {d.dot(plane.x), d.dot(plane.y), offset};
}

Vector3d in_planes(const RibAxes& axes, const Vector3d& p) {
  return in_plane(axes.plane_at(p), axes.planes.offset(p), p);
}

// What is measured of a place of the design itself.
struct OwnVertex {
  Vector3d at;      // as MovedVertex has it
  double turn = 0;  // in the plane between the normal and y: 1 less the angle's cosine
};

MovedVertex moved(const Vector3d& point, const Vector3d& normal, const SurfaceBend& bend, const RibAxes& axes,
                  const SweepSectionOptions& options, OwnVertex& own) {
  MovedVertex v;
  const Frame plane = axes.plane_at(point);
  own.at = in_plane(plane, axes.planes.offset(point), point);
  double along = 0, bend_per_mm = 0;
  const auto stand = [&](const Vector3d& width) {
    along = normal.dot(width);
    bend_per_mm = bend.of(width - along * normal);
  };
  stand(axes.planes.normal_at(point));
  double kerf_mm = options.kerf_mm;
  const auto band = [&](double across) {
    return 0.5 * kerf_mm + robot::over_width_mm(across, bend_per_mm, options.width_mm);
  };
  // The width stands as it does where the blade passes.
  if (axes.planes.turns()) stand(axes.planes.normal_at(point + band(along) * normal));
  const Vector3d n(normal.dot(plane.x), normal.dot(plane.y), along);
  v.along = n.z();
  const double in_plane = n.head<2>().norm();
  own.turn = in_plane > 0 ? 1 - n.y() / in_plane : 0;
  if (options.bands) kerf_mm = options.bands->band_mm(point + band(n.z()) * normal);
  v.world = point + band(n.z()) * normal;
  v.at = in_planes(axes, v.world);
  if (options.sag) {
    const SweepSag::Value sag = options.sag->at(v.at.z(), v.at.x());
    // The width stands along the planes' normal, turned by the twist away from the curve's left.
    const double left = n.y() * std::cos(sag.theta) - n.x() * std::sin(sag.theta);
    v.world = point + band(n.z() - sag.twist_rad * left) * normal - sag.droop_mm * axes.sweep;
    v.at = in_planes(axes, v.world);
  }
  return v;
}

// A place of the moved surface with what is measured of it.
struct Place {
  MovedVertex moved;
  Vector3d own;  // of the design, in space
  OwnVertex own_vertex;
};

Place between(const Place& a, const Place& b, double t) {
  return {{a.moved.at + t * (b.moved.at - a.moved.at), a.moved.world + t * (b.moved.world - a.moved.world),
           a.moved.along + t * (b.moved.along - a.moved.along)},
          a.own + t * (b.own - a.own),
          {a.own_vertex.at + t * (b.own_vertex.at - a.own_vertex.at),
           a.own_vertex.turn + t * (b.own_vertex.turn - a.own_vertex.turn)}};
}

}  // namespace

std::uint64_t BehindSeams::all_of(std::size_t seams) {
  constexpr std::size_t kMost = 63;
  if (seams > kMost) throw std::logic_error("BehindSeams: more seams than bits");
  return (std::uint64_t{1} << seams) - 1;
}

// The extents of what of a moved surface lies behind its seams.
class MovedSurface::Measure {
 public:
  Measure(const MovedSurface& surface, const std::vector<OwnVertex>& own)
      : of_(surface), own_(own), extents_(surface.extents_) {}

  SweepData run() {
    constexpr double kInf = std::numeric_limits<double>::infinity();
    extents_.first_mm = kInf;
    extents_.last_mm = -kInf;
    extents_.low.setConstant(kInf);
    extents_.high.setConstant(-kInf);
    std::vector<char> met(of_.vertices_.size(), 0);  // by a triangle that lies behind all seams as it is
    for (auto* values : {&steeps_, &turns_}) values->reserve(met.size());
    points_.reserve(met.size());
    const auto& triangles = of_.surface_.triangles;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      gpu::stop_point();
      if (!of_.behind_.in_reach(triangles[t])) continue;
      const bool whole =
          !of_.axes().planes.closed() &&
          std::all_of(triangles[t].begin(), triangles[t].end(), [&](int c) { return of_.behind_.all(c); });
      if (whole) {
        for (const int c : triangles[t]) met[static_cast<std::size_t>(c)] = 1;
      } else {
        for (const Place& place : clipped(t)) extend(place);
      }
    }
    for (std::size_t i = 0; i < met.size(); ++i)
      if (met[i]) extend(of_.vertices_[i], own_[i], of_.surface_.points[i]);
    if (!(extents_.last_mm > extents_.first_mm)) return extents_;
    // A few bad facets of a file turn normals anyhow: what they come to is seen when the cut is verified.
    const auto most = [](std::vector<double>& values) {
      constexpr double kShare = 0.98;
      const auto at =
          values.begin() + static_cast<std::ptrdiff_t>(kShare * static_cast<double>(values.size() - 1));
      std::nth_element(values.begin(), at, values.end());
      return *at;
    };
    extents_.steepest_rad = std::asin(std::min(1.0, most(steeps_)));
    extents_.turn_rad = std::acos(std::clamp(1 - most(turns_), -1.0, 1.0));
    measure_size();
    find_seams();
    return extents_;
  }

 private:
  [[nodiscard]] Place place(int v, const MovedVertex& moved) const {
    const auto i = static_cast<std::size_t>(v);
    return {moved, of_.surface_.points[i], own_[i]};
  }

  // What of a triangle lies behind all seams.
  [[nodiscard]] std::vector<Place> clipped(std::size_t t) const {
    const Triangle corners = of_.triangle(t);
    std::vector<Place> polygon;
    for (std::size_t c = 0; c < 3; ++c) polygon.push_back(place(of_.surface_.triangles[t][c], corners[c]));
    for (const SweepSeam& seam : of_.seams_) {
      std::vector<Place> next;
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Place &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        const double from = pipeline::behind(seam, a.moved.world), to = pipeline::behind(seam, b.moved.world);
        if (from >= 0) next.push_back(a);
        if ((from >= 0) != (to >= 0)) next.push_back(between(a, b, from / (from - to)));
      }
      polygon = std::move(next);
    }
    return polygon;
  }

  void extend(const Place& place) { extend(place.moved, place.own_vertex, place.own); }
  void extend(const MovedVertex& moved, const OwnVertex& own, const Vector3d& point) {
    extents_.first_mm = std::min(extents_.first_mm, moved.at.z());
    extents_.last_mm = std::max(extents_.last_mm, moved.at.z());
    extents_.low = extents_.low.cwiseMin(own.at.head<2>());
    extents_.high = extents_.high.cwiseMax(own.at.head<2>());
    steeps_.push_back(std::abs(moved.along));
    turns_.push_back(own.turn);
    points_.push_back(point);
  }

  void measure_size() {
    const double middle = 0.5 * (extents_.first_mm + extents_.last_mm);
    const Frame plane = of_.axes().plane(middle);
    const Vector3d sweep = of_.axes().planes.normal(middle);
    for (const Vector3d& p : points_)
      extents_.box.extend(Vector3d(p.dot(plane.x), p.dot(plane.y), p.dot(sweep)));
  }

  // Seams that lie along the planes end the sweep.
  void find_seams() {
    constexpr double kAlong = 0.99;
    const auto& planes = of_.axes().planes;
    for (const SweepSeam& seam : of_.seams_) {
      extents_.seam_first |= seam.normal.dot(planes.normal(extents_.first_mm)) < -kAlong;
      extents_.seam_last |= seam.normal.dot(planes.normal(extents_.last_mm)) > kAlong;
    }
  }

  const MovedSurface& of_;
  const std::vector<OwnVertex>& own_;
  SweepData extents_;
  std::vector<double> steeps_, turns_;  // sines of slopes and OwnVertex::turn of all that is measured
  std::vector<Vector3d> points_;        // of the design
};

MovedSurface::MovedSurface(const WasteSurface& surface, const RibAxes& axes,
                           const SweepSectionOptions& options)
    : surface_(surface), seams_(options.seams), vertices_(surface.points.size()) {
  extents_.axes = axes;
  std::vector<OwnVertex> own(vertices_.size());
  constexpr std::size_t kVertices = 1 << 12;
  surface::for_blocks(vertices_.size(), kVertices, [&](std::size_t first, std::size_t last) {
    gpu::stop_point();
    for (std::size_t i = first; i < last; ++i)
      vertices_[i] = moved(surface.points[i], surface.normals[i], surface.bends[i], axes, options, own[i]);
  });
  behind_ = BehindSeams(seams_, vertices_.size(), 0,
                        [&](std::size_t i) -> const Vector3d& { return vertices_[i].world; });
  extents_ = Measure(*this, own).run();
}

MovedSurface::Triangle MovedSurface::triangle(std::size_t t) const {
  Triangle corners;
  for (std::size_t c = 0; c < 3; ++c) corners[c] = vertex(surface_.triangles[t][c]);
  const double half_turn = std::numbers::pi * axes().planes.radius_mm();
  const auto [low, high] = std::minmax({corners[0].at.z(), corners[1].at.z(), corners[2].at.z()});
  if (half_turn > 0 && high - low > half_turn) {
    for (MovedVertex& v : corners) {
      if (v.at.z() < 0) v.at.z() += 2 * half_turn;
    }
  }
  return corners;
}

FormedPoint formed_point(const Vector3d& point, const Vector3d& normal, const SurfaceBend& bend,
                         const RibAxes& axes, const SweepSectionOptions& options) {
  OwnVertex own;
  const MovedVertex v = moved(point, normal, bend, axes, options, own);
  return {v.at.z(), {v.at.head<2>(), cosine_of(v.along), false}};
}

}  // namespace hotblade::pipeline
