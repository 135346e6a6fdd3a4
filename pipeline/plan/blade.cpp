#include "pipeline/plan/blade.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "elastica/stability.hpp"

namespace hotblade::pipeline {

namespace {

using elastica::Elastica;

constexpr int kBladeSamples = 97;

// Checks in the order a candidate passes them; a later stage means that it came further.
enum Stage { kRibCurvature, kLength, kCurvature, kClearance, kReentry, kCrossing, kMargin, kSag, kPassed };

struct RibCheck {
  Stage stage = kPassed;
  double value = 0;
  double margin = std::numeric_limits<double>::infinity();
  double curvature = 0, clamp_curvature = 0, clearance = 0;
};

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

bool segments_cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c,
                    const Eigen::Vector2d& d) {
  return cross(b - a, c - a) * cross(b - a, d - a) < 0 && cross(d - c, a - c) * cross(d - c, b - c) < 0;
}

bool crosses_itself(const std::vector<Eigen::Vector2d>& q) {
  for (std::size_t i = 0; i + 1 < q.size(); ++i) {
    for (std::size_t j = i + 2; j + 1 < q.size(); ++j) {
      if (segments_cross(q[i], q[i + 1], q[j], q[j + 1])) return true;
    }
  }
  return false;
}

// Depth of a point on the kept side (the right) of the cutting part; 0 on the waste side and past its ends.
double depth_behind(const Eigen::Vector2d& q, const std::vector<Eigen::Vector2d>& part) {
  double nearest = std::numeric_limits<double>::infinity(), depth = 0;
  for (std::size_t i = 0; i + 1 < part.size(); ++i) {
    const Eigen::Vector2d ab = part[i + 1] - part[i];
    const double t = (q - part[i]).dot(ab) / ab.squaredNorm();
    const Eigen::Vector2d away = q - part[i] - std::clamp(t, 0.0, 1.0) * ab;
    if (!(away.norm() < nearest)) continue;
    nearest = away.norm();
    const bool past_end = (i == 0 && t < 0) || (i + 2 == part.size() && t > 1);
    depth = !past_end && cross(ab, away) < 0 ? nearest : 0;
  }
  return depth;
}

// Share of the tolerance that weight may use up. A longer or more strongly bent blade sags more, so that
// another split can always bring it down.
constexpr double kSagShare = 0.25;

// What weight moves the cut at this rib, in a level plane: droop where the design is steepest, and half the
// section's width tilted by the twist.
double sag_error_mm(const Elastica& blade, double s0, const RibFit& rib, const BladeSettings& settings) {
  const robot::BladeSag sag = robot::blade_sag(blade, blade_section(settings), -Eigen::Vector3d::UnitZ(), s0,
                                               s0 + rib.elastica.length);
  if (!sag.stable) return std::numeric_limits<double>::infinity();
  return sag.droop_mm * std::sin(rib.max_slope_rad) + 0.5 * settings.width_mm * sag.twist_rad;
}

RibCheck check_rib(const RibFit& rib, double length, double share, const StockRect& rect,
                   const Settings& settings) {
  RibCheck c;
  const double sharpest = max_curvature_per_mm(settings.blade);
  const double own = elastica::ElasticaCurve(rib.elastica).max_abs_curvature();
  if (own > sharpest) return {kRibCurvature, 1 / own};
  const double spare = length - rib.elastica.length;
  if (spare <= 0) return {kLength, rib.elastica.length};
  // A curve that winds this fast has lost any blade long before, and is not worth evaluating.
  const Elastica& e = rib.elastica;
  const double rate = elastica::taylor_rate(e.theta, e.kappa, e.lambda1, e.lambda2);
  constexpr double kWinds = 100;
  if (rate * length > kWinds) return {kCurvature, 1 / rate};
  const Elastica blade = extended(e, length, share);
  const elastica::ElasticaCurve curve(blade);
  c.curvature = curve.max_abs_curvature();
  if (c.curvature > sharpest) return {kCurvature, 1 / c.curvature};
  const elastica::CurvePoint a = curve.at(0), b = curve.at(length);
  c.clamp_curvature = std::max(std::abs(a.kappa), std::abs(b.kappa));
  c.clearance = std::min(rect.distance(a.position()), rect.distance(b.position()));
  if (c.clearance < settings.stock.clearance_mm) return {kClearance, c.clearance};
  const double s0 = share * spare;
  const FreeParts free = examine_free_parts(blade, s0, s0 + rib.elastica.length, rect);
  if (free.depth_mm > kFreePartDepthMm) return {kReentry, free.depth_mm};
  if (free.crosses_itself) return {kCrossing, 1};
  c.margin = elastica::stability_margin(blade);
  if (c.margin < settings.blade.min_margin) return {kMargin, c.margin};
  const double sag = sag_error_mm(blade, s0, rib, settings.blade);
  if (!(sag <= kSagShare * settings.design.tolerance_mm)) return {kSag, sag};
  return c;
}

Refusal refusal_of(const RibCheck& c, double length, const Settings& settings) {
  switch (c.stage) {
    case kRibCurvature:
      return {
          "",
          "",
          "radius of a rib (bending stress over yield strength and safety)",
          c.value,
          1 / max_curvature_per_mm(settings.blade),
          "mm",
          "the design bends more sharply than the blade can: thinner blade, lower blade.safety, or another "
          "slice.direction"};
    case kLength:
      return {"",
              "",
              "rib length",
              c.value,
              settings.blade.free_lengths_mm.back(),
              "mm",
              "add a longer blade to blade.free_lengths_mm or allow more splits"};
    case kCurvature:
      return {"",
              "",
              "blade radius",
              c.value,
              1 / max_curvature_per_mm(settings.blade),
              "mm",
              "beyond the rib's ends the blade would exceed yield: allow more splits or a thinner blade"};
    case kClearance:
      return {"",
              "",
              "clamp clearance to the stock",
              c.value,
              settings.stock.clearance_mm,
              "mm",
              "add a longer blade to blade.free_lengths_mm or lower stock.border_mm"};
    case kReentry:
      return {"",
              "",
              "depth of the blade's free part in the kept foam",
              c.value,
              kFreePartDepthMm,
              "mm",
              "the rib turns too far for the blade to leave the block: allow more splits"};
    case kCrossing:
      return {
          "", "", "self-crossings of the blade", c.value, 0, "", "allow more splits or add a shorter blade"};
    case kSag:
      return {"",
              "",
              "sag of the blade under its weight",
              c.value,
              kSagShare * settings.design.tolerance_mm,
              "mm",
              "allow more splits, or a wider or shorter blade"};
    default:
      return {"",
              "",
              "stability margin (snap-through)",
              c.value,
              settings.blade.min_margin,
              "",
              "the blade could snap through: allow more splits or add a shorter blade than " +
                  std::to_string(int(length)) + " mm"};
  }
}

// The earlier stage, then the larger amount: depth, length and sag grow with the harm, everything else
// shrinks with it.
bool worse(const RibCheck& a, const RibCheck& b) {
  if (a.stage != b.stage) return a.stage < b.stage;
  return a.stage == kLength || a.stage == kReentry || a.stage == kSag ? a.value > b.value : a.value < b.value;
}

BladeChoice summarise(const std::vector<RibCheck>& checks, double length, double share) {
  BladeChoice choice{length, share, checks.front().margin, 0, checks.front().clearance};
  for (const RibCheck& c : checks) {
    choice.smallest_margin = std::min(choice.smallest_margin, c.margin);
    choice.largest_curvature_per_mm = std::max(choice.largest_curvature_per_mm, c.curvature);
    choice.clamp_curvature_per_mm = std::max(choice.clamp_curvature_per_mm, c.clamp_curvature);
    choice.smallest_clearance_mm = std::min(choice.smallest_clearance_mm, c.clearance);
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

// What the shares of one length came to.
struct LengthTrial {
  std::optional<BladeChoice> choice;
  RibCheck furthest;  // the worst rib of the share that came furthest, when there is no choice
  int rib = -1;
};

LengthTrial try_length(const std::vector<RibFit>& ribs, double length, const StockRect& rect,
                       const Settings& settings) {
  // Of the extension, on clamp A's side; the more even ones first.
  constexpr std::array<double, 9> kShares{0.5, 0.4, 0.6, 0.3, 0.7, 0.2, 0.8, 0.1, 0.9};
  LengthTrial trial;
  for (const double share : kShares) {
    std::vector<RibCheck> checks(ribs.size());
    tbb::parallel_for(std::size_t{0}, ribs.size(),
                      [&](std::size_t i) { checks[i] = check_rib(ribs[i], length, share, rect, settings); });
    const auto worst = std::min_element(checks.begin(), checks.end(), worse);
    if (worst->stage == kPassed) {
      const BladeChoice choice = summarise(checks, length, share);
      if (!trial.choice || less_loaded(choice, *trial.choice)) trial.choice = choice;
    } else if (trial.rib < 0 || worse(trial.furthest, *worst)) {
      trial.furthest = *worst;
      trial.rib = static_cast<int>(worst - checks.begin());
    }
    // No share changes the rib itself or the length, and hardly one the sag.
    if (worst->stage == kRibCurvature || worst->stage == kLength || worst->stage == kSag) break;
  }
  return trial;
}

}  // namespace

double StockRect::distance(const Eigen::Vector2d& q) const {
  const Eigen::Vector2d out = (low - q).cwiseMax(q - high).cwiseMax(0);
  return out.norm();
}

FreeParts examine_free_parts(const Elastica& blade, double s0, double s1, const StockRect& rect) {
  const elastica::ElasticaCurve curve(blade);
  std::vector<Eigen::Vector2d> all, part;
  for (int i = 0; i < kBladeSamples; ++i) {
    all.push_back(curve.at(blade.length * i / (kBladeSamples - 1)).position());
    part.push_back(curve.at(s0 + (s1 - s0) * i / (kBladeSamples - 1)).position());
  }
  FreeParts free{crosses_itself(all), 0};
  for (int i = 0; i < kBladeSamples; ++i) {
    const double s = blade.length * i / (kBladeSamples - 1);
    const Eigen::Vector2d& q = all[static_cast<std::size_t>(i)];
    if ((s < s0 || s > s1) && rect.distance(q) <= 0)
      free.depth_mm = std::max(free.depth_mm, depth_behind(q, part));
  }
  return free;
}

StockRect stock_rect(const std::vector<RibFit>& ribs, const StockSettings& settings) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  StockRect rect{Eigen::Vector2d(kInf, kInf), Eigen::Vector2d(-kInf, -kInf)};
  for (const RibFit& rib : ribs) {
    for (const Eigen::Vector2d& q : rib.target) {
      rect.low = rect.low.cwiseMin(q);
      rect.high = rect.high.cwiseMax(q);
    }
  }
  rect.low -= Eigen::Vector2d(settings.border_mm, settings.base_mm);
  rect.high += Eigen::Vector2d(settings.border_mm, settings.border_mm);
  return rect;
}

BladeReport choose_blade(const std::vector<RibFit>& ribs, const StockRect& rect, const Settings& settings) {
  BladeReport report;
  int furthest = -1;
  std::vector<std::string> details;
  for (const double length : settings.blade.free_lengths_mm) {
    const LengthTrial trial = try_length(ribs, length, rect, settings);
    if (trial.choice) {
      report.choice = trial.choice;
      return report;
    }
    const Refusal refusal = refusal_of(trial.furthest, length, settings);
    details.push_back(fmt::format("blade of {:.0f} mm: {}", length, describe_amount(refusal)));
    if (trial.furthest.stage > furthest) {
      furthest = trial.furthest.stage;
      report.refusal = refusal;
      report.rib = trial.rib;
      report.rib_too_sharp = trial.furthest.stage == kRibCurvature;
    }
    // No length changes the rib itself, and a longer blade sags more.
    if (trial.furthest.stage == kRibCurvature || trial.furthest.stage == kSag) break;
  }
  report.refusal.details = std::move(details);
  return report;
}

}  // namespace hotblade::pipeline
