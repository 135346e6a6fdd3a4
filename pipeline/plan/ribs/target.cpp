#include "pipeline/plan/ribs/target.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "pipeline/plan/ribs/bridge.hpp"

namespace hotblade::pipeline {

namespace {

// A side that most of the chain faces: +1 when the waste is on the face normals' side.
// `keep` below and above go by z; an upright surface has no such side.
struct WasteSide {
  double sign = 0;
  double lean = 0;  // mean of |component that decides|, 0..1
};

WasteSide waste_side(const surface::RibGraph& graph, const surface::Chain& chain, Keep keep) {
  if (keep == Keep::kBack) return {1, 1};
  if (keep == Keep::kFront) return {-1, 1};
  double z = 0, weight = 0;
  for (const surface::RibRef& ref : chain.ribs) {
    const auto& points = graph.sections[static_cast<std::size_t>(ref.section)]
                             .pieces[static_cast<std::size_t>(ref.piece)]
                             .points;
    for (std::size_t i = 1; i < points.size(); ++i) {
      const double length = (points[i].p - points[i - 1].p).norm();
      z += length * 0.5 * (points[i].normal.z() + points[i - 1].normal.z());
      weight += length;
    }
  }
  const double mean = weight > 0 ? z / weight : 0;
  const double up = keep == Keep::kBelow ? 1 : -1;
  return {mean * up >= 0 ? 1.0 : -1.0, std::abs(mean)};
}

// The section's points in the chain's axes, moved towards the waste.
RibTarget offset_rib(const surface::SectionPiece& piece, double offset_mm, const ChainTarget& axes,
                     double waste, const Settings& settings) {
  const Frame plane = axes.plane(offset_mm);
  const Eigen::Vector3d sweep = axes.planes.normal(offset_mm), &centre = axes.planes.centre();
  RibTarget rib;
  rib.offset_mm = offset_mm;
  for (const surface::SectionPoint& point : piece.points) {
    const Eigen::Vector3d n = waste * point.normal;
    const double along = std::min(1.0, std::abs(n.dot(sweep)));
    rib.max_slope_rad = std::max(rib.max_slope_rad, std::asin(along));
    const Eigen::Vector2d in_plane(n.dot(plane.x), n.dot(plane.y));
    const double cosine = in_plane.norm();
    Eigen::Vector2d q((point.p - centre).dot(plane.x), (point.p - centre).dot(plane.y));
    // half / cos(slope) along in_plane / cos(slope)
    constexpr double kSmallestCosine =
        0.05;  // such ribs are left out by kMaxSlopeRad; this only avoids a division
    if (cosine > kSmallestCosine) q += 0.5 * melted_band_mm(settings, along) / (cosine * cosine) * in_plane;
    if (!rib.points.empty() && (q - rib.points.back()).norm() <= 0) continue;
    rib.s.push_back(rib.points.empty() ? 0 : rib.s.back() + (q - rib.points.back()).norm());
    rib.points.push_back(q);
  }
  const AreaRate rate = area_rate(piece, axes.planes, offset_mm);
  rib.area_mm = rate.area_mm;
  rib.leaning_mm = rate.leaning_mm;
  return rib;
}

// Axes of a chain: x along the mean chord, y on the waste side. Fails when the waste changes sides along the
// ribs.
bool set_axes(const surface::RibGraph& graph, const surface::Chain& chain, double waste, ChainTarget& axes) {
  Eigen::Vector3d chord = Eigen::Vector3d::Zero();
  double left = 0, total = 0;
  for (const surface::RibRef& ref : chain.ribs) {
    const surface::Section& section = graph.sections[static_cast<std::size_t>(ref.section)];
    const auto& points = section.pieces[static_cast<std::size_t>(ref.piece)].points;
    const Eigen::Vector3d sweep = graph.planes.normal(section.offset_mm);
    chord += graph.planes.turned(points.back().p - points.front().p, -section.offset_mm);
    for (std::size_t i = 1; i < points.size(); ++i) {
      const Eigen::Vector3d d = points[i].p - points[i - 1].p;
      const Eigen::Vector3d n = waste * (points[i].normal + points[i - 1].normal).normalized();
      left += sweep.cross(d).dot(n);
      total += d.norm();
    }
  }
  axes.planes = graph.planes;
  axes.sweep = graph.planes.normal(0);
  axes.x = (chord - chord.dot(axes.sweep) * axes.sweep).normalized();
  axes.y = (left >= 0 ? 1.0 : -1.0) * axes.sweep.cross(axes.x);
  // On ribs that can be cut at all the waste lies within 60 degrees of the plane and across the rib: a mean
  // below a tenth says that it changes sides.
  constexpr double kLeast = 0.1;
  return std::abs(left) > kLeast * total && chord.norm() > 0;
}

Eigen::Vector3d first_point(const surface::RibGraph& graph, const surface::Chain& chain) {
  const auto& ref = chain.ribs.front();
  return graph.sections[static_cast<std::size_t>(ref.section)]
      .pieces[static_cast<std::size_t>(ref.piece)]
      .points.front()
      .p;
}

std::string place_of(const surface::RibGraph& graph, const surface::Chain& chain) {
  const Eigen::Vector3d p = first_point(graph, chain);
  return fmt::format("chain at ({:.1f}, {:.1f}, {:.1f})", p.x(), p.y(), p.z());
}

double degrees(double rad) {
  return rad * 180 / std::numbers::pi;
}

void add_chain(const surface::RibGraph& graph, const surface::Chain& chain, const Settings& settings,
               TargetReport& report) {
  ChainTarget target;
  target.place = place_of(graph, chain);
  const WasteSide side = waste_side(graph, chain, settings.design.keep);
  constexpr double kLeastLean = 0.1;
  if (side.lean < kLeastLean) {
    report.refusals.push_back({target.place, "", Limit::kLean, side.lean, kLeastLean,
                               "design.keep = \"" + std::string(name(settings.design.keep)) +
                                   "\" says nothing about an upright surface"});
    report.refusals.back().at = first_point(graph, chain);
    return;
  }
  if (!set_axes(graph, chain, side.sign, target)) {
    report.refusals.push_back({target.place, "", Limit::kWasteSide, 0, 0.1});
    report.refusals.back().at = first_point(graph, chain);
    return;
  }
  std::size_t steep = 0;
  double steepest = 0;
  const auto finish = [&](ChainTarget& run) {
    if (run.ribs.size() >= 2) report.chains.push_back(run);
    run.ribs.clear();
  };
  ChainTarget run = target;
  for (const surface::RibRef& ref : chain.ribs) {
    const surface::Section& section = graph.sections[static_cast<std::size_t>(ref.section)];
    RibTarget rib = offset_rib(section.pieces[static_cast<std::size_t>(ref.piece)], section.offset_mm, target,
                               side.sign, settings);
    if (rib.max_slope_rad <= kMaxSlopeRad && rib.points.size() >= 2) {
      run.ribs.push_back(std::move(rib));
      continue;
    }
    ++steep;
    steepest = std::max(steepest, rib.max_slope_rad);
    finish(run);
  }
  finish(run);
  if (steep > 0) {
    report.warnings.push_back(fmt::format("{}: {} of {} ribs left out, slope {:.0f} degrees (limit {:.0f})",
                                          target.place, steep, chain.ribs.size(), degrees(steepest),
                                          degrees(kMaxSlopeRad)));
  }
}

// One rib of the pieces of a section and what fills the gaps between them; nothing when they cannot be
// filled.
std::optional<RibTarget> bridged_rib(const surface::RibGraph& graph, const std::vector<surface::RibRef>& refs,
                                     const ChainTarget& axes, double waste, const Settings& settings) {
  std::optional<RibTarget> whole;
  for (const surface::RibRef& ref : refs) {
    const surface::Section& section = graph.sections[static_cast<std::size_t>(ref.section)];
    RibTarget part = offset_rib(section.pieces[static_cast<std::size_t>(ref.piece)], section.offset_mm, axes,
                                waste, settings);
    if (part.max_slope_rad > kMaxSlopeRad || part.points.size() < 2) return std::nullopt;
    if (!whole) {
      whole = std::move(part);
      continue;
    }
    auto fill = fill_gap(whole->points, part.points);
    if (!fill) return std::nullopt;
    fill->insert(fill->end(), part.points.begin(), part.points.end());
    for (const Eigen::Vector2d& q : *fill) {
      const double step = (q - whole->points.back()).norm();
      if (!(step > 0)) continue;
      whole->s.push_back(whole->s.back() + step);
      whole->points.push_back(q);
    }
    whole->max_slope_rad = std::max(whole->max_slope_rad, part.max_slope_rad);
  }
  return whole;
}

// `target_of` names the one target of each chain of the graph that has just one.
void add_bridge(const surface::RibGraph& graph, const surface::Bridge& bridge, const Settings& settings,
                const std::vector<std::optional<std::size_t>>& target_of, TargetReport& report) {
  BridgeTarget out;
  surface::Chain all;
  for (const auto& refs : bridge.ribs) all.ribs.insert(all.ribs.end(), refs.begin(), refs.end());
  const WasteSide side = waste_side(graph, all, settings.design.keep);
  if (!set_axes(graph, all, side.sign, out.target)) return;
  out.target.place = place_of(graph, all);
  for (const int chain : bridge.chains) {
    const auto& target = target_of[static_cast<std::size_t>(chain)];
    if (!target) return;
    out.chains.push_back(*target);
  }
  for (const auto& refs : bridge.ribs) {
    auto rib = bridged_rib(graph, refs, out.target, side.sign, settings);
    if (!rib) return;
    out.target.ribs.push_back(std::move(*rib));
  }
  report.bridges.push_back(std::move(out));
}

}  // namespace

double melted_band_mm(const Settings& settings, double along) {
  return settings.blade.kerf_mm + settings.blade.width_mm * std::abs(along);
}

AreaRate area_rate(const surface::SectionPiece& piece, const surface::PlaneFamily& planes, double offset_mm) {
  const Eigen::Vector3d sweep = planes.normal(offset_mm);
  AreaRate rate;
  const std::size_t count = piece.points.size(), edges = piece.closed ? count : count - 1;
  for (std::size_t i = 0; i < edges; ++i) {
    const surface::SectionPoint &a = piece.points[i], &b = piece.points[(i + 1) % count];
    const double sine = std::abs((a.normal + b.normal).normalized().dot(sweep));
    const double moves =
        planes.turns() ? planes.distance_from_axis(0.5 * (a.p + b.p)) / planes.radius_mm() : 1;
    const double area = (b.p - a.p).norm() * moves /
                        std::max(std::cos(kUnseenSlopeRad), std::sqrt(1 - std::min(1.0, sine * sine)));
    rate.area_mm += area;
    rate.leaning_mm += area * sine;
  }
  return rate;
}

TargetReport make_targets(const surface::RibGraph& graph, const Settings& settings) {
  TargetReport report;
  std::vector<std::optional<std::size_t>> target_of;
  for (const surface::Chain& chain : graph.chains) {
    const std::size_t before = report.chains.size(), refused = report.refusals.size();
    target_of.emplace_back();
    if (chain.ribs.size() >= 2) {
      add_chain(graph, chain, settings, report);
      const bool whole = report.chains.size() == before + 1 && report.refusals.size() == refused &&
                         report.chains.back().ribs.size() == chain.ribs.size();
      if (whole) target_of.back() = before;
    } else {
      report.warnings.push_back(place_of(graph, chain) + ": a single rib makes no strip, left out");
    }
  }
  if (settings.slice.gaps == Gaps::kBridge) {
    for (const surface::Bridge& bridge : graph.bridges)
      add_bridge(graph, bridge, settings, target_of, report);
  }
  return report;
}

DesignPart RibTarget::own_of(double u0, double u1) const {
  if (!own) return {};
  const auto in_share = [&](double at) { return std::clamp((at / s.back() - u0) / (u1 - u0), 0.0, 1.0); };
  return {in_share(own->first), in_share(own->last)};
}

std::vector<Eigen::Vector2d> resample(const RibTarget& rib, double u0, double u1, int n) {
  std::vector<Eigen::Vector2d> points;
  points.reserve(static_cast<std::size_t>(n));
  std::size_t i = 1;
  for (int k = 0; k < n; ++k) {
    const double s = rib.s.back() * (u0 + (u1 - u0) * k / (n - 1));
    while (i + 1 < rib.s.size() && rib.s[i] < s) ++i;
    const double t = std::clamp((s - rib.s[i - 1]) / (rib.s[i] - rib.s[i - 1]), 0.0, 1.0);
    points.push_back(rib.points[i - 1] + t * (rib.points[i] - rib.points[i - 1]));
  }
  return points;
}

}  // namespace hotblade::pipeline
