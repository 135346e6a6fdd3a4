#include "pipeline/plan/motion/blade.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "elastica/blade/stability.hpp"
#include "gpu/backend/stop.hpp"
#include "pipeline/plan/motion/clamps_between.hpp"
#include "robot/blade/blade_branch.hpp"
#include "robot/blade/blade_section.hpp"

namespace hotblade::pipeline {

namespace {

using elastica::Elastica;

// Checks in the order a candidate passes them: who fails a later one came further.
constexpr std::array kChecks{Limit::kRibRadius,      Limit::kRibLength, Limit::kBladeYield,
                             Limit::kClampClearance, Limit::kFreePart,  Limit::kSelfCrossing,
                             Limit::kPlannedMargin,  Limit::kSag};

// How many of them a candidate passed that is stopped by this limit; all of them where none stops it.
std::size_t checks_passed(Limit limit) {
  return static_cast<std::size_t>(std::find(kChecks.begin(), kChecks.end(), limit) - kChecks.begin());
}

struct RibCheck {
  Limit limit = Limit::kNone;
  double value = 0;
  double margin = std::numeric_limits<double>::infinity();
  double curvature = 0, clamp_curvature = 0, clearance = 0, sag_mm = 0;
};

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

bool segments_cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c,
                    const Eigen::Vector2d& d) {
  return cross(b - a, c - a) * cross(b - a, d - a) < 0 && cross(d - c, a - c) * cross(d - c, b - c) < 0;
}

using Points = std::vector<Eigen::Vector2d>;

// Whether a blade crosses itself, by its samples. A curve that does closes a loop with one corner, which
// turns by more than half a turn: one that turns less in all need not be searched.
bool turns_into_itself(const elastica::PartPoints& whole, std::size_t i) {
  // A little less than half a turn: samples miss some of the turning where the curve's sense changes.
  constexpr double kHalfTurn = 0.95 * std::numbers::pi;
  const std::size_t first = i * whole.points;
  double turning = 0;
  for (std::size_t n = first + 1; n < first + whole.points; ++n)
    turning += std::abs(whole.turn[n] - whole.turn[n - 1]);
  if (turning < kHalfTurn) return false;
  for (std::size_t k = 0; k + 1 < whole.points; ++k) {
    for (std::size_t j = k + 2; j + 1 < whole.points; ++j) {
      if (segments_cross(whole.at(i, k), whole.at(i, k + 1), whole.at(i, j), whole.at(i, j + 1))) return true;
    }
  }
  return false;
}

// Depth of a point on the kept side (the right) of the cutting part; 0 on the waste side and past its ends.
double depth_behind(const Eigen::Vector2d& q, const Points& part) {
  double nearest = std::numeric_limits<double>::infinity(), depth = 0;
  for (std::size_t i = 0; i + 1 < part.size(); ++i) {
    const Eigen::Vector2d ab = part[i + 1] - part[i];
    const double t = (q - part[i]).dot(ab) / ab.squaredNorm();
    const Eigen::Vector2d away = q - part[i] - std::clamp(t, 0.0, 1.0) * ab;
    const double squared = away.squaredNorm();
    if (!(squared < nearest)) continue;
    nearest = squared;
    const bool past_end = (i == 0 && t < 0) || (i + 2 == part.size() && t > 1);
    depth = !past_end && cross(ab, away) < 0 ? std::sqrt(squared) : 0;
  }
  return depth;
}

// Share of the tolerance that weight may use up. A longer or more strongly bent blade sags more, so that
// another split can always bring it down.
constexpr double kSagShare = 0.25;

// A point of the plane that a block is seen from.
Eigen::Vector3d in_plane(const Eigen::Vector2d& q) {
  return {q.x(), q.y(), 0};
}

// Rounding puts a plane on the block's face this far outside of it.
constexpr double kOnFace_mm = 1e-9;

// The samples of a blade beside its foam interval that lie in the block.
Points free_in_stock(const elastica::PartPoints& whole, std::size_t i, const elastica::Part& interval,
                     double length, const Block& block) {
  const double step_mm = length / static_cast<double>(whole.points - 1);
  Points free;
  std::size_t k = 0;
  while (k < whole.points) {
    const double s = length * static_cast<double>(k) / static_cast<double>(whole.points - 1);
    if (s >= interval.first && s <= interval.last) {
      ++k;
      continue;
    }
    const Eigen::Vector2d q = whole.at(i, k);
    const double away_mm = block.distance_mm(in_plane(q));
    if (away_mm <= kOnFace_mm) free.push_back(q);
    // No sample is in the block that is nearer along the blade than the block is. Rounding is far less.
    constexpr double kSure = 0.999;
    k += std::max<std::size_t>(1, static_cast<std::size_t>(kSure * std::max(0.0, away_mm) / step_mm));
  }
  return free;
}

// A rib with what it sees of the block, and gravity in its axes and along its plane's normal.
struct PlacedRib {
  const RibFit& rib;
  Block block;
  Eigen::Vector3d down;
};

// What weight moves the cut at this rib: droop where the design is steepest, half the section's width tilted
// by the twist, and the sag in the plane where that is not level.
double sag_error_mm(const Elastica& blade, double s0, const PlacedRib& placed,
                    const BladeSettings& settings) {
  const RibFit& rib = placed.rib;
  const robot::BladeSag sag = robot::blade_sag(blade, settings, placed.down, s0, s0 + rib.elastica.length);
  if (!sag.stable) return std::numeric_limits<double>::infinity();
  return sag.droop_mm * std::sin(rib.max_slope_rad) + 0.5 * settings.width_mm * sag.twist_rad +
         sag.in_plane_mm;
}

// Between ribs the clamps pass the block a little nearer than at them: by a percent on ribs 300 mm apart.
constexpr double kClearanceReserve = 1.04;

// How a blade of this length bends that is the rib and goes on beyond its ends, with `share` of what is
// beyond on clamp A's side; the rest is not checked.
RibCheck check_bends(const RibFit& rib, double length, double share, const Settings& settings) {
  RibCheck c;
  const double sharpest = max_curvature_per_mm(settings.blade);
  const double own = elastica::ElasticaCurve(rib.elastica).max_abs_curvature();
  if (own > sharpest) return {Limit::kRibRadius, 1 / own};
  const double spare = length - rib.elastica.length;
  if (spare <= 0) return {Limit::kRibLength, rib.elastica.length};
  if (const double turns = turns_at_most(rib.elastica, length); !(turns < kMostTurnsRad))
    return {Limit::kBladeYield, length / turns};
  const elastica::ElasticaCurve curve(extended(rib.elastica, length, share));
  c.curvature = curve.max_abs_curvature();
  if (c.curvature > sharpest) return {Limit::kBladeYield, 1 / c.curvature};
  const elastica::CurvePoint a = curve.at(0), b = curve.at(length);
  c.clamp_curvature = std::max(std::abs(a.kappa), std::abs(b.kappa));
  return c;
}

RibCheck check_rib(const PlacedRib& placed, double length, double share, double most_sag_mm,
                   const Settings& settings) {
  const RibFit& rib = placed.rib;
  RibCheck c = check_bends(rib, length, share, settings);
  if (c.limit != Limit::kNone) return c;
  const elastica::ElasticaCurve curve(extended(rib.elastica, length, share));
  c.clearance = std::min(placed.block.distance_mm(in_plane(curve.at(0).position())),
                         placed.block.distance_mm(in_plane(curve.at(length).position())));
  if (c.clearance < kClearanceReserve * settings.stock.clearance_mm)
    return {Limit::kClampClearance, c.clearance};
  const double s0 = share * (length - rib.elastica.length);
  const FreeParts free = examine_free_parts(curve.elastica(), s0, s0 + rib.elastica.length, placed.block);
  if (free.depth_mm > kFreePartDepthMm) return {Limit::kFreePart, free.depth_mm};
  if (free.crosses_itself) return {Limit::kSelfCrossing, 1};
  c.margin = elastica::stability_margin(curve);
  if (c.margin < settings.blade.min_margin) return {Limit::kPlannedMargin, c.margin};
  c.sag_mm = sag_error_mm(curve.elastica(), s0, placed, settings.blade);
  if (!(c.sag_mm <= most_sag_mm)) return {Limit::kSag, c.sag_mm};
  return c;
}

// What is allowed of a limit.
double bound_of(Limit limit, double most_sag_mm, const Settings& settings) {
  switch (limit) {
    case Limit::kRibRadius:
    case Limit::kBladeYield:
      return 1 / max_curvature_per_mm(settings.blade);
    case Limit::kRibLength:
      return settings.blade.free_lengths_mm.back();
    case Limit::kClampClearance:
      return kClearanceReserve * settings.stock.clearance_mm;
    case Limit::kFreePart:
      return kFreePartDepthMm;
    case Limit::kSag:
      return most_sag_mm;
    case Limit::kPlannedMargin:
      return settings.blade.min_margin;
    default:
      return 0;  // no self-crossing
  }
}

// What is known of the limit while blades are chosen, beside what it means.
std::string note_of(Limit limit) {
  switch (limit) {
    case Limit::kBladeYield:
      return "the blade would yield beyond the rib's ends";
    case Limit::kFreePart:
      return "the rib turns too far for the blade to leave the block";
    case Limit::kPlannedMargin:
      return "the blade could snap through";
    default:
      return "";
  }
}

Refusal refusal_of(const RibCheck& c, double most_sag_mm, const Settings& settings) {
  return {"", "", c.limit, c.value, bound_of(c.limit, most_sag_mm, settings), note_of(c.limit)};
}

// The earlier check, then the larger amount: depth, length and sag grow with the harm, everything else
// shrinks with it.
bool worse(const RibCheck& a, const RibCheck& b) {
  if (a.limit != b.limit) return checks_passed(a.limit) < checks_passed(b.limit);
  const bool grows = a.limit == Limit::kRibLength || a.limit == Limit::kFreePart || a.limit == Limit::kSag;
  return grows ? a.value > b.value : a.value < b.value;
}

BladeChoice summarise(const std::vector<RibCheck>& checks, double length, double share) {
  BladeChoice choice{length, share, checks.front().margin, 0, checks.front().clearance};
  for (const RibCheck& c : checks) {
    choice.smallest_margin = std::min(choice.smallest_margin, c.margin);
    choice.largest_curvature_per_mm = std::max(choice.largest_curvature_per_mm, c.curvature);
    choice.clamp_curvature_per_mm = std::max(choice.clamp_curvature_per_mm, c.clamp_curvature);
    choice.smallest_clearance_mm = std::min(choice.smallest_clearance_mm, c.clearance);
    choice.sag_mm = std::max(choice.sag_mm, c.sag_mm);
  }
  return choice;
}

// Whether q loads blade and clamps less than p; differences below a percent are no reason for an uneven
// share.
bool less_loaded(const BladeChoice& q, const BladeChoice& p) {
  constexpr double kWorthIt = 0.99;
  if (q.largest_curvature_per_mm < kWorthIt * p.largest_curvature_per_mm) return true;
  if (kWorthIt * q.largest_curvature_per_mm > p.largest_curvature_per_mm) return false;
  return q.clamp_curvature_per_mm < kWorthIt * p.clamp_curvature_per_mm;
}

// Whether an uneven share would be the better choice if all of it held.
bool may_load_less(const std::vector<PlacedRib>& ribs, double length, double share, const BladeChoice& than,
                   const Settings& settings) {
  std::vector<RibCheck> checks;
  for (const PlacedRib& placed : ribs) {
    checks.push_back(check_bends(placed.rib, length, share, settings));
    if (checks.back().limit != Limit::kNone) return false;
  }
  return less_loaded(summarise(checks, length, share), than);
}

// What the shares of one length came to.
struct LengthTrial {
  std::optional<BladeChoice> choice;
  RibCheck furthest;  // the worst rib of the share that came furthest, when there is no choice
  int rib = -1;
};

LengthTrial try_length(const std::vector<PlacedRib>& ribs, const ClampsBetween& between, double length,
                       double most_sag_mm, const Settings& settings) {
  // Of the extension, on clamp A's side; the more even ones first.
  constexpr std::array<double, 9> kShares{0.5, 0.4, 0.6, 0.3, 0.7, 0.2, 0.8, 0.1, 0.9};
  LengthTrial trial;
  for (const double share : kShares) {
    if (trial.choice && !may_load_less(ribs, length, share, *trial.choice, settings)) continue;
    std::vector<RibCheck> checks(ribs.size());
    tbb::parallel_for(std::size_t{0}, ribs.size(), [&](std::size_t i) {
      gpu::stop_point();
      checks[i] = check_rib(ribs[i], length, share, most_sag_mm, settings);
    });
    gpu::stop_point();
    auto worst = std::min_element(checks.begin(), checks.end(), worse);
    if (worst->limit == Limit::kNone) {
      const auto [clearance, rib] = between.least(length, share, settings.stock.clearance_mm);
      if (clearance < settings.stock.clearance_mm) {
        worst = checks.begin() + rib;
        worst->limit = Limit::kClampClearance;
        worst->value = clearance;
      }
    }
    if (worst->limit == Limit::kNone) {
      const BladeChoice choice = summarise(checks, length, share);
      if (!trial.choice || less_loaded(choice, *trial.choice)) trial.choice = choice;
    } else if (trial.rib < 0 || worse(trial.furthest, *worst)) {
      trial.furthest = *worst;
      trial.rib = static_cast<int>(worst - checks.begin());
    }
    // No share changes the rib itself or the length, and hardly one the sag.
    if (worst->limit == Limit::kRibRadius || worst->limit == Limit::kRibLength ||
        worst->limit == Limit::kSag || stable_as_can_be(worst->limit, worst->value))
      break;
  }
  return trial;
}

}  // namespace

bool stable_as_can_be(Limit limit, double value) {
  constexpr double kStraight = 4 * std::numbers::pi * std::numbers::pi;
  return limit == Limit::kPlannedMargin && value >= kStraight;
}

// All its tangents are within a right angle of each other.
bool makes_no_loop(const Elastica& blade) {
  return blade.length * robot::curvature_bound(blade) < std::numbers::pi / 2;
}

FreeParts examine_free_parts(const Elastica& blade, double s0, double s1, const Block& block) {
  const elastica::Part all{0, blade.length}, part{s0, s1};
  return examine_free_parts({&blade, 1}, elastica::sample_parts({&blade, 1}, {&all, 1}, kBladeSamples),
                            {&part, 1}, {&block, 1})
      .front();
}

std::vector<FreeParts> examine_free_parts(std::span<const Elastica> blades, const elastica::PartPoints& whole,
                                          std::span<const elastica::Part> intervals,
                                          std::span<const Block> blocks) {
  if (blades.size() != intervals.size() || blades.size() != blocks.size())
    throw std::logic_error("free parts are asked for beside one interval and block of each blade");
  std::vector<FreeParts> free;
  // Of the few blades whose free parts are in the stock: which, where there, and what they cut.
  std::vector<std::size_t> in_stock;
  std::vector<Points> points_in_stock;
  std::vector<Elastica> cutting;
  std::vector<elastica::Part> cut;
  for (std::size_t i = 0; i < blades.size(); ++i) {
    // Its distance from a place beyond its cutting part falls all along that to its end.
    if (makes_no_loop(blades[i])) {
      free.push_back({false, 0});
      continue;
    }
    free.push_back({turns_into_itself(whole, i), 0});
    Points points = free_in_stock(whole, i, intervals[i], blades[i].length, blocks[i]);
    if (points.empty()) continue;
    in_stock.push_back(i);
    points_in_stock.push_back(std::move(points));
    cutting.push_back(blades[i]);
    cut.push_back(intervals[i]);
  }
  const elastica::PartPlaces points = elastica::sample_places(cutting, cut, kBladeSamples);
  Points part(kBladeSamples);
  for (std::size_t n = 0; n < in_stock.size(); ++n) {
    for (std::size_t k = 0; k < kBladeSamples; ++k) part[k] = points.at(n, k);
    double& depth_mm = free[in_stock[n]].depth_mm;
    for (const Eigen::Vector2d& q : points_in_stock[n]) depth_mm = std::max(depth_mm, depth_behind(q, part));
  }
  return free;
}

BladeReport choose_blade(const std::vector<RibFit>& ribs, const RibAxes& axes, const Block& block,
                         const Settings& settings, std::optional<double> sag_mm, double least_mm) {
  const double most_sag_mm = sag_mm.value_or(kSagShare * settings.design.tolerance_mm);
  const Eigen::Vector3d down = axes.planes.normal(0.5 * (ribs.front().offset_mm + ribs.back().offset_mm));
  std::vector<PlacedRib> placed;
  for (const RibFit& rib : ribs) {
    const Frame plane = axes.plane(rib.offset_mm);
    PlacedRib& seen = placed.emplace_back(PlacedRib{rib, block.seen_from(plane), -Eigen::Vector3d::UnitZ()});
    // Level planes see gravity along their normals exactly.
    if (axes.planes.turns()) seen.down = {down.dot(plane.x), down.dot(plane.y), down.dot(plane.normal())};
  }
  const ClampsBetween between(ribs, axes, block);
  BladeReport report;
  std::size_t furthest = 0;
  std::vector<std::string> details;
  for (const double length : settings.blade.free_lengths_mm) {
    if (length < least_mm) continue;
    const LengthTrial trial = try_length(placed, between, length, most_sag_mm, settings);
    if (trial.choice) {
      report.choice = trial.choice;
      return report;
    }
    const Refusal refusal = refusal_of(trial.furthest, most_sag_mm, settings);
    details.push_back(fmt::format("blade of {:.0f} mm: {}", length, describe_amount(refusal)));
    const std::size_t passed = checks_passed(trial.furthest.limit);
    if (report.rib < 0 || passed > furthest) {
      furthest = passed;
      report.refusal = refusal;
      report.rib = trial.rib;
      report.rib_too_sharp = trial.furthest.limit == Limit::kRibRadius;
    }
    // No length changes the rib itself, and a longer blade sags more.
    if (trial.furthest.limit == Limit::kRibRadius || trial.furthest.limit == Limit::kSag) break;
  }
  report.refusal.details = std::move(details);
  return report;
}

}  // namespace hotblade::pipeline
