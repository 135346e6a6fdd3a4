#include "pipeline/verify/width_lanes.hpp"

#include <algorithm>
#include <limits>

namespace hotblade::pipeline {

namespace {

using elastica::lanes::absolute;
using elastica::lanes::any;
using elastica::lanes::Cell;
using elastica::lanes::kLanes;
using elastica::lanes::Lanes;
using elastica::lanes::Mask;
using elastica::lanes::pick;
using Passed = WidthOverRow::Passed;

// Poses farther apart than this share of the width leave open how deep the blade was between them.
constexpr double kTold = 0.5;

struct Lanes3 {
  Lanes x, y, z;
};

HOTBLADE_INLINE Lanes3 cross(const Lanes3& a, const Lanes3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
HOTBLADE_INLINE Lanes dot(const Lanes3& a, const Lanes3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
HOTBLADE_INLINE Lanes3 lanes(const std::array<Cell, 3>& cells) {
  return {cells[0].v, cells[1].v, cells[2].v};
}

// Numbers from `first` on, the last of `count` again where there are fewer than lanes.
HOTBLADE_INLINE Lanes numbers(const double* first, std::size_t count) {
  Lanes out;
  if (count >= kLanes) {
    __builtin_memcpy(&out, first, sizeof out);
  } else {
    for (std::size_t lane = 0; lane < kLanes; ++lane) out[lane] = first[std::min(lane, count - 1)];
  }
  return out;
}

// A pose's frame, and how its plane's normal differs from the row's.
struct Turned {
  Eigen::Vector3d origin, x, y, normal;
};

// The row's places, and the same of the pose's blade.
struct Places {
  std::size_t count;
  double half_mm;  // of the width
  const double *x, *y, *cos, *sin, *curvature;
};

// The normal through each of the row's places meets the ribbon of the pose: its middle line there, by the
// point, the tangent and the curvature at the same place of the blade, and its width.
HOTBLADE_INLINE Passed pass_body(WidthCell* c, const Turned& turned, const Places& on) {
  Mask reaches{}, untold{};
  for (std::size_t place = 0; place < on.count; ++c, place += kLanes) {
    const std::size_t count = on.count - place;
    const Lanes px = numbers(on.x + place, count), py = numbers(on.y + place, count),
                cosine = numbers(on.cos + place, count), sine = numbers(on.sin + place, count),
                curvature = numbers(on.curvature + place, count);
    const Lanes3 n = lanes(c->normal), was = lanes(c->plane_normal), own = lanes(c->own);
    const Lanes3 width{was.x + turned.normal.x(), was.y + turned.normal.y(), was.z + turned.normal.z()};
    const Lanes3 tangent{cosine * turned.x.x() + sine * turned.y.x(),
                         cosine * turned.x.y() + sine * turned.y.y(),
                         cosine * turned.x.z() + sine * turned.y.z()},
        left{cosine * turned.y.x() - sine * turned.x.x(), cosine * turned.y.y() - sine * turned.x.y(),
             cosine * turned.y.z() - sine * turned.x.z()},
        away{turned.origin.x() + px * turned.x.x() + py * turned.y.x() - own.x,
             turned.origin.y() + px * turned.x.y() + py * turned.y.y() - own.y,
             turned.origin.z() + px * turned.x.z() + py * turned.y.z() - own.z};
    // away + width u + tangent s + left curvature s^2 / 2 = height n
    const Lanes3 up = cross(width, tangent);
    const Lanes by_size = 1.0 / dot(n, up);
    const Lanes s = -dot(away, cross(n, width)) * by_size;
    const Lanes height = (dot(away, up) + 0.5 * curvature * s * s * dot(left, up)) * by_size;
    // The width's length differs from 1 by a blade's twist times the planes' turn: of a thousandth the root's
    // second term leaves 1e-7.
    const Lanes length = 0.5 + 0.5 * dot(width, width);
    const Lanes along = -dot(away, cross(tangent, n)) * by_size * length;

    const Lanes before_height = c->height.v, before_along = c->along.v;
    c->height.v = height;
    c->along.v = along;
    const Lanes from = absolute(before_along), to = absolute(along), half = Lanes{} + on.half_mm;
    const Mask reached = from <= half, beyond = to > half;
    reaches |= to <= half;
    untold |= ~(absolute(height) < std::numeric_limits<double>::max()) |
              (reached & (absolute(along - before_along) > kTold * 2 * half));
    const Lanes share = pick(beyond, (half - from) / (to - from), Lanes{} + 1.0);
    const Lanes depth = (share - 1.0) * before_height - share * height;
    const Lanes deepest = c->deepest.v;
    c->deepest.v = pick(reached & (depth > deepest), depth, deepest);
  }
  if (any(untold)) return Passed::kUntold;
  return any(reaches) ? Passed::kNot : Passed::kAll;
}

#if defined(__x86_64__)
HOTBLADE_AVX512 Passed pass_512(WidthCell* cells, const Turned& turned, const Places& on) {
  return pass_body(cells, turned, on);
}
HOTBLADE_AVX2 Passed pass_256(WidthCell* cells, const Turned& turned, const Places& on) {
  return pass_body(cells, turned, on);
}
#endif

}  // namespace

WidthOverRow::WidthOverRow(const BladePose& row, const elastica::Part& part,
                           std::span<const Eigen::Vector3d> normals,
                           std::span<const Eigen::Vector3d> plane_normals, double width_mm)
    : row_normal_(row.frame.normal()),
      places_(normals.size()),
      half_mm_(0.5 * width_mm),
      cells_((normals.size() + kLanes - 1) / kLanes) {
  const elastica::PartPlaces own = elastica::sample_places({&row.blade, 1}, {&part, 1}, places_);
  for (std::size_t i = 0; i < cells_.size() * kLanes; ++i) {
    const std::size_t j = std::min(i, places_ - 1), lane = i % kLanes;
    WidthCell& cell = cells_[i / kLanes];
    const Eigen::Vector2d q = own.at(0, j);
    const Eigen::Vector3d point = row.frame.point(q.x(), q.y());
    for (std::size_t k = 0; k < 3; ++k) {
      const auto axis = static_cast<Eigen::Index>(k);
      cell.normal[k].v[lane] = normals[j][axis];
      cell.plane_normal[k].v[lane] = plane_normals[j][axis];
      cell.own[k].v[lane] = point[axis];
    }
    cell.deepest.v[lane] = 0;
  }
}

void WidthOverRow::start_side() {
  for (WidthCell& cell : cells_) cell.height.v = cell.along.v = Lanes{};
}

Passed WidthOverRow::pass(const BladePose& pose, const elastica::PartPoints& on, std::size_t first,
                          elastica::Simd simd) {
  const Frame frame = pose.frame;
  const Turned turned{frame.origin, frame.x, frame.y, frame.normal() - row_normal_};
  const Places places{places_,
                      half_mm_,
                      on.x.begin() + first,
                      on.y.begin() + first,
                      on.cos.begin() + first,
                      on.sin.begin() + first,
                      on.curvature.begin() + first};
#if defined(__x86_64__)
  if (simd == elastica::Simd::kAvx512) return pass_512(cells_.data(), turned, places);
  if (simd == elastica::Simd::kAvx2) return pass_256(cells_.data(), turned, places);
#endif
  static_cast<void>(simd);
  return pass_body(cells_.data(), turned, places);
}

std::vector<double> WidthOverRow::deepest_mm() const {
  std::vector<double> all(places_);
  for (std::size_t j = 0; j < all.size(); ++j) all[j] = cells_[j / kLanes].deepest.v[j % kLanes];
  return all;
}

}  // namespace hotblade::pipeline
