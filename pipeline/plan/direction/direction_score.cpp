#include "pipeline/plan/direction/direction_score.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "surface/slice/slice.hpp"

namespace hotblade::pipeline {

namespace {

using surface::PlaneFamily;

// Enough sections for a strip's five ribs and to see a chain change, for three ribs in every block, and for
// a fan's blocks to be as narrow as 11 degrees: in wider ones long blades sag.
constexpr double kSections = 9, kSectionsABlock = 2, kSectionsATurn = 64;
// One percent of the design left out weighs as much as one more strip.
constexpr double kUncoveredWeight = 100;
// Ribs that grow from one corner of the design and shrink to another one's are cut by a blade that nothing
// guides at both ends: a coarse plan of few ribs sees less of it than it costs.
constexpr double kRaggedWeight = 2;

struct Extent {
  double low = std::numeric_limits<double>::infinity(), high = -low;
};

Extent extent(const surface::TriangleMesh& mesh, const PlaneFamily& planes) {
  const double half_turn = std::numbers::pi * planes.radius_mm();
  if (planes.closed()) return {-half_turn, half_turn};
  Extent found;
  for (const Eigen::Vector3d& p : mesh.vertices()) {
    const double h = planes.offset(p);
    found.low = std::min(found.low, h);
    found.high = std::max(found.high, h);
  }
  return found;
}

// Of the sweep, what each section stands for: half-way to its neighbours, and to the design's ends.
std::map<double, double> widths(const surface::RibGraph& graph, const Extent& ends) {
  std::map<double, double> all;
  const auto& sections = graph.sections;
  for (std::size_t k = 0; k < sections.size(); ++k) {
    const double at = sections[k].offset_mm;
    const double from = k > 0 ? 0.5 * (sections[k - 1].offset_mm + at) : ends.low;
    const double to = k + 1 < sections.size() ? 0.5 * (at + sections[k + 1].offset_mm) : ends.high;
    all.emplace(at, to - from);
  }
  return all;
}

// Faces that no section stands for.
double too_steep_mm2(const surface::TriangleMesh& mesh, const PlaneFamily& planes) {
  const double limit = std::sin(kUnseenSlopeRad);
  double sum = 0;
  for (const auto& t : mesh.triangles()) {
    const auto at = [&](std::size_t i) { return mesh.vertices()[static_cast<std::size_t>(t[i])]; };
    const Eigen::Vector3d cross = (at(1) - at(0)).cross(at(2) - at(0));
    const Eigen::Vector3d sweep = planes.normal(planes.offset((at(0) + at(1) + at(2)) / 3));
    if (std::abs(cross.dot(sweep)) > limit * cross.norm()) sum += 0.5 * cross.norm();
  }
  return sum;
}

// How much the ribs of a chain grow and shrink, as a share of the longest: 0 where the borders are square to
// the planes, 2 from corner to corner. Short ribs at a corner say little about the blade's shape and cost
// ribs.
double raggedness(const ChainTarget& chain) {
  double change = 0, longest = 0;
  for (std::size_t i = 0; i < chain.ribs.size(); ++i) {
    longest = std::max(longest, chain.ribs[i].s.back());
    if (i > 0) change += std::abs(chain.ribs[i].s.back() - chain.ribs[i - 1].s.back());
  }
  return change / longest;
}

void measure_slopes(const DirectionTrial& trial, DirectionScore& score) {
  double sum = 0, ribs = 0, area = 0, leaning = 0;
  std::size_t k = 0;
  for (const ChainTarget& chain : trial.targets.chains) {
    score.raggedness += raggedness(chain);
    for (const RibTarget& rib : chain.ribs) {
      const double width = trial.section_mm[k++];
      sum += rib.max_slope_rad / kMaxSlopeRad;
      ribs += 1;
      area += width * rib.area_mm;
      leaning += width * rib.leaning_mm;
      score.max_sine = std::max(score.max_sine, std::sin(rib.max_slope_rad));
    }
  }
  score.steepness = ribs > 0 ? sum / ribs : 1;
  score.mean_sine = area > 0 ? leaning / area : 1;
}

// Area of the ribs of each chain, per rib.
std::vector<std::vector<double>> rib_areas(const DirectionTrial& trial) {
  std::vector<std::vector<double>> areas;
  std::size_t k = 0;
  for (const ChainTarget& chain : trial.targets.chains) {
    auto& of = areas.emplace_back();
    for (const RibTarget& rib : chain.ribs) of.push_back(trial.section_mm[k++] * rib.area_mm);
  }
  return areas;
}

// Neighbouring runs share a rib, half of which is each one's.
double area_of(const LaidOutRun& run, const std::vector<double>& areas) {
  double sum = 0;
  for (std::size_t i = run.first; i <= run.last; ++i) {
    const bool shared = (i == run.first && i > 0) || (i == run.last && i + 1 < areas.size());
    sum += (shared ? 0.5 : 1) * areas[i];
  }
  return sum;
}

void add_up(DirectionScore& score, double served_mm2, const DirectionTrial& trial, const Settings& settings) {
  double all = trial.unseen_mm2;
  for (const auto& chain : rib_areas(trial)) {
    for (const double area : chain) all += area;
  }
  // Sums in another order round differently.
  constexpr double kRounding = 1e-12;
  const double left_out = all > 0 ? 1 - served_mm2 / all : 1;
  score.covered_share = 1 - (left_out > kRounding ? left_out : 0);
  score.score = static_cast<double>(score.strips) + kUncoveredWeight * (1 - score.covered_share) +
                score.deviation_mm / settings.design.tolerance_mm + kRaggedWeight * score.raggedness +
                score.steepness + (score.fan ? kFanScore : 0);
}

// Strips at the least, if every run is served.
void bound(DirectionTrial& trial, const Settings& settings) {
  const auto areas = rib_areas(trial);
  double served = 0;
  std::vector<std::size_t> runs(areas.size(), 0), most(areas.size(), 0);
  for (const LaidOutRun& run : least_runs(trial.targets, settings)) {
    const std::size_t strips = least_strips(trial.targets.chains[run.chain], run, settings);
    served += area_of(run, areas[run.chain]);
    trial.score.strips += strips;
    ++runs[run.chain];
    most[run.chain] = std::max(most[run.chain], strips);
  }
  if (trial.score.fan) {
    // Its runs are not fixed: the longest rib is in one of them.
    trial.score.strips = 0;
    for (std::size_t i = 0; i < runs.size(); ++i) trial.score.strips += runs[i] + most[i] - 1;
  }
  add_up(trial.score, served, trial, settings);
}

DirectionTrial try_planes(const surface::DesignSurface& design, const PlaneFamily& planes,
                          const std::optional<surface::FanAxis>& fan, const Settings& settings) {
  DirectionTrial trial;
  trial.score.normal = planes.normal(0);
  trial.score.fan = fan;
  surface::SliceOptions options;
  options.normal = trial.score.normal;
  options.fan = fan;
  const Extent ends = extent(design.mesh, planes);
  const double wide = ends.high - ends.low;
  const double block =
      *std::max_element(settings.stock.max_size_mm.begin(), settings.stock.max_size_mm.end()) -
      2 * settings.stock.border_mm;
  constexpr double kMostSections = 2000;  // of a design of 600 m
  const double blocks = block > 0 ? std::ceil(wide / block) : 1;
  const double turns = planes.angle(wide) / (2 * std::numbers::pi);
  const double wanted = std::max(kSectionsABlock * blocks + 1, std::ceil(kSectionsATurn * turns));
  const double count = std::clamp(wanted, kSections, kMostSections);
  trial.unseen_mm2 = too_steep_mm2(design.mesh, planes);
  if (wide > 2 * count * options.end_inset_mm) {
    // Even sections in the middles of slabs: a border that is not quite parallel to the planes then does not
    // leave a sliver for the first and the last of them. Rounding must not add a plane.
    options.spacing_mm = (1 + 1e-9) * wide / count;
    options.end_inset_mm = 0.5 * wide / count;
    const surface::RibGraph graph = slice(design, options);
    const std::map<double, double> width = widths(graph, ends);
    for (const surface::Section& section : graph.sections) {
      for (const surface::SectionPiece& piece : section.pieces) {
        trial.unseen_mm2 +=
            width.at(section.offset_mm) * area_rate(piece, graph.planes, section.offset_mm).area_mm;
      }
    }
    trial.targets = make_targets(graph, settings);
    // Directions are compared by what each chain takes on its own: bounds and areas are by chain.
    trial.targets.bridges.clear();
    for (const ChainTarget& chain : trial.targets.chains) {
      for (const RibTarget& rib : chain.ribs) {
        trial.section_mm.push_back(width.at(rib.offset_mm));
        trial.unseen_mm2 -= trial.section_mm.back() * rib.area_mm;
      }
    }
    trial.unseen_mm2 = std::max(0.0, trial.unseen_mm2);
  }
  measure_slopes(trial, trial.score);
  bound(trial, settings);
  return trial;
}

// Do the clamps stay clear of the table from the first rib to the end of the lead-out?
bool clear_of_table(const StripPlan& strip, const Settings& settings) {
  const double last = strip.ribs.back().offset_mm;
  double lowest = std::numeric_limits<double>::infinity();
  const auto look = [&](const RibFit& rib, double offset) {
    const elastica::Elastica blade = extended(rib.elastica, strip.blade_length_mm, strip.share_a);
    const Frame plane = strip.swept_plane(offset);
    for (const double s : {0.0, blade.length}) {
      const auto p = elastica::point_at(blade, s);
      const Pose at{plane.point(p.x, p.y), Eigen::Quaterniond::Identity()};
      lowest = std::min(lowest, transformed(strip.design_to_cell, at).p.z());
    }
  };
  for (const RibFit& rib : strip.ribs) look(rib, rib.offset_mm);
  look(strip.ribs.back(),
       last + settings.stock.border_mm + std::max(settings.motion.lead_mm, settings.stock.clearance_mm));
  return lowest >= settings.stock.clearance_mm;
}

DirectionScore score_layout(const StripLayout& layout, const DirectionTrial& trial,
                            const Settings& settings) {
  DirectionScore result = trial.score;
  result.estimated = false;
  result.strips = 0;
  const auto areas = rib_areas(trial);
  double served = 0;
  auto strip = layout.strips.begin();
  for (const LaidOutRun& run : layout.runs) {
    const auto end = strip + static_cast<std::ptrdiff_t>(run.strips);
    const bool clear = std::all_of(
        strip, end, [&](const StripPlan& s) { return !s.planes.turns() || clear_of_table(s, settings); });
    strip = end;
    if (run.strips > 0 && clear) served += area_of(run, areas[run.chain]);
    result.strips += std::max(run.strips, least_strips(trial.targets.chains[run.chain], run, settings));
  }
  for (const StripPlan& s : layout.strips) {
    for (const RibFit& rib : s.ribs) result.deviation_mm = std::max(result.deviation_mm, rib.deviation_mm);
  }
  add_up(result, served, trial, settings);
  return result;
}

}  // namespace

DirectionTrial try_direction(const surface::DesignSurface& design, const Eigen::Vector3d& normal,
                             const Settings& settings) {
  return try_planes(design, parallel_about(design.mesh, normal), std::nullopt, settings);
}

DirectionTrial try_fan(const surface::DesignSurface& design, const surface::FanAxis& axis,
                       const Settings& settings) {
  return try_planes(design, fan_about(design.mesh, axis), axis, settings);
}

DirectionScore plan_coarsely(const DirectionTrial& trial, const Settings& settings, double most) {
  const double room = most - trial.score.score;
  if (!(room > 0)) return trial.score;
  constexpr double kManyMore = 1000;
  const auto more = static_cast<std::size_t>(std::min(room, kManyMore));
  DirectionScore result = score_layout(lay_out_strips(trial.targets, settings, more), trial, settings);
  // What was refused might only have needed more strips than allowed here.
  if (room >= kManyMore || result.covered_share >= trial.score.covered_share) return result;
  if (result.score >= most) return trial.score;
  return score_layout(lay_out_strips(trial.targets, settings), trial, settings);
}

}  // namespace hotblade::pipeline
