#include "pipeline/plan/sweep/sweep_seams.hpp"

#include "gpu/backend/stop.hpp"
#include "pipeline/plan/sweep/sweep_lanes.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <tuple>

namespace hotblade::pipeline {

namespace {

using Eigen::Vector3d;

// Places of a seam: one for each cell of a grid.
constexpr double kCellMm = 15;

double beyond(const SweepSeam& seam, const Vector3d& p) {
  return seam.normal.dot(p) - seam.at_mm;
}

bool opposite(const SweepSeam& a, const SweepSeam& b) {
  return a.normal == -b.normal && a.at_mm == -b.at_mm;
}

// Behind all seams of a part but one.
bool inside(const SeamSide& part, const SweepSeam& but, const Vector3d& p) {
  return std::all_of(part.seams->begin(), part.seams->end(), [&](const SweepSeam& seam) {
    return (seam.normal == but.normal && seam.at_mm == but.at_mm) || beyond(seam, p) <= 0;
  });
}

struct SurfacePoint {
  Vector3d at, normal;
  SurfaceBend bend;
};

// Where a plane meets the triangles near a part: points on edges and some between, nearer than half a cell.
template <typename Take>
void cut(const WasteSurface& surface, const SweepSeam& seam, const Take& take) {
  for (const auto& triangle : surface.triangles) {
    std::array<SurfacePoint, 2> ends;
    std::size_t found = 0;
    for (std::size_t c = 0; c < 3 && found < 2; ++c) {
      auto a = static_cast<std::size_t>(triangle[c]), b = static_cast<std::size_t>(triangle[(c + 1) % 3]);
      double from = beyond(seam, surface.points[a]), to = beyond(seam, surface.points[b]);
      if ((from <= 0) == (to <= 0)) continue;
      if (from > to) {
        std::swap(a, b);
        std::swap(from, to);
      }
      const double t = from / (from - to);
      ends[found++] = {surface.points[a] + t * (surface.points[b] - surface.points[a]),
                       surface.normals[a] + t * (surface.normals[b] - surface.normals[a]),
                       between(surface.bends[a], surface.bends[b], t)};
    }
    if (found < 2) continue;
    const auto pieces =
        std::max(1, static_cast<int>(std::ceil(2 * (ends[1].at - ends[0].at).norm() / kCellMm)));
    for (int i = 0; i <= pieces; ++i) {
      const double t = static_cast<double>(i) / pieces;
      take(SurfacePoint{ends[0].at + t * (ends[1].at - ends[0].at),
                        ends[0].normal + t * (ends[1].normal - ends[0].normal),
                        between(ends[0].bend, ends[1].bend, t)});
    }
  }
}

// The point nearest to the middle of each cell, by coordinates that move with the design.
class Cells {
 public:
  void add(const Vector3d& at, const SurfacePoint& p) {
    // Off the round numbers that designs' grids start at: rounding decides nothing.
    constexpr double kShift = 0.3719;
    const Vector3d place = (at / kCellMm).array() + kShift, cell = place.array().floor();
    const double away = (place - cell - Vector3d::Constant(0.5)).squaredNorm();
    const std::tuple key{static_cast<long>(cell.x()), static_cast<long>(cell.y()),
                         static_cast<long>(cell.z())};
    const auto [held, fresh] = cells_.try_emplace(key, away, p);
    if (!fresh && away < held->second.first) held->second = {away, p};
  }
  [[nodiscard]] const auto& points() const { return cells_; }

 private:
  std::map<std::tuple<long, long, long>, std::pair<double, SurfacePoint>> cells_;
};

// A point as a part forms it, on its family's side of where closed planes are cut open.
FormedPoint formed_by(const SeamSide& part, const SurfacePoint& p, SweepSectionOptions options) {
  options.sag = part.sag;
  options.bands = part.bands;
  FormedPoint formed = formed_point(p.at, p.normal, p.bend, *part.axes, options);
  if (part.axes->planes.closed()) {
    const double turn = 2 * std::numbers::pi * part.axes->planes.radius_mm();
    formed.offset_mm += turn * std::round((0.5 * (part.first_mm + part.last_mm) - formed.offset_mm) / turn);
  }
  return formed;
}

std::optional<SeamPlace> place_at(const SurfacePoint& p, const SweepSeam& seam, const SeamSide& first,
                                  const SeamSide& second, const SweepSectionOptions& options) {
  constexpr double kAlong = 0.2;  // a surface that lies in the seam's plane is not crossed by it
  const Vector3d n = p.normal.normalized(), across = seam.normal - seam.normal.dot(n) * n;
  if (!(across.norm() > kAlong)) return std::nullopt;
  SeamPlace place;
  place.at = p.at;
  for (std::size_t i = 0; i < SeamPlace::kProbes; ++i) {
    const double step = kSeamProbeMm * (static_cast<double>(i) - 1);
    const SurfacePoint probe{p.at + step * across.normalized(), n, p.bend};
    place.on[0][i] = formed_by(first, probe, options);
    place.on[1][i] = formed_by(second, probe, options);
  }
  return place;
}

LoneSample lone(const FormedPoint& p, const SweepFamily& family, double reach_mm) {
  return {&p.sample, family.at(p.offset_mm), reach_mm, family.x_mm, p.sample.q.x() - family.x_mm};
}

}  // namespace

std::vector<PartSeam> seams_of(const std::vector<SeamSide>& parts, const SweepSectionOptions& options) {
  std::vector<PartSeam> seams;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    gpu::stop_point();
    for (std::size_t k = i + 1; k < parts.size(); ++k) {
      for (const SweepSeam& seam : *parts[i].seams) {
        const auto same = std::find_if(parts[k].seams->begin(), parts[k].seams->end(),
                                       [&](const SweepSeam& other) { return opposite(seam, other); });
        if (same == parts[k].seams->end()) continue;
        Cells cells;
        cut(*parts[i].surface, seam, [&](const SurfacePoint& p) {
          if (!inside(parts[i], seam, p.at) || !inside(parts[k], *same, p.at)) return;
          const FormedPoint formed = formed_by(parts[i], p, options);
          cells.add({formed.sample.q.x(), formed.sample.q.y(), formed.offset_mm}, p);
        });
        PartSeam met{i, k, {}};
        for (const auto& [cell, point] : cells.points()) {
          if (const auto place = place_at(point.second, seam, parts[i], parts[k], options))
            met.places.push_back(*place);
        }
        if (!met.places.empty()) seams.push_back(std::move(met));
      }
    }
  }
  return seams;
}

SeamFacts seam_facts(const PartSeam& seam, const SweepFamily& first, const SweepFamily& second,
                     double reach_mm) {
  SeamFacts facts;
  for (const SeamPlace& place : seam.places) {
    gpu::stop_point();
    std::vector<LoneSample> samples;
    for (std::size_t i = 0; i < SeamPlace::kProbes; ++i) {
      samples.push_back(lone(place.on[0][i], first, reach_mm));
      samples.push_back(lone(place.on[1][i], second, reach_mm));
    }
    const std::vector<SampleTerm> terms = lone_terms(samples);
    std::array<double, SeamPlace::kProbes> gap{};
    for (std::size_t i = 0; i < gap.size(); ++i) gap[i] = terms[2 * i].away_mm - terms[2 * i + 1].away_mm;
    facts.gap_mm = std::max(facts.gap_mm, std::abs(gap[1]));
    const double kink = std::atan(std::abs(gap[2] - gap[0]) / (2 * kSeamProbeMm));
    facts.kink_deg = std::max(facts.kink_deg, kink * 180 / std::numbers::pi);
  }
  return facts;
}

}  // namespace hotblade::pipeline
