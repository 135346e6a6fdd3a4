#include "pipeline/plan/blade.hpp"

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
enum Stage { kRibCurvature, kLength, kCurvature, kClearance, kReentry, kCrossing, kMargin, kPassed };

struct RibCheck {
  Stage stage = kPassed;
  double value = 0;
  double margin = std::numeric_limits<double>::infinity();
  double curvature = 0, clearance = 0;
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
  const Eigen::Vector2d a = curve.at(0).position(), b = curve.at(length).position();
  c.clearance = std::min(rect.distance(a), rect.distance(b));
  if (c.clearance < settings.stock.clearance_mm) return {kClearance, c.clearance};
  const double s0 = share * spare;
  const FreeParts free = examine_free_parts(blade, s0, s0 + rib.elastica.length, rect);
  if (free.depth_mm > kFreePartDepthMm) return {kReentry, free.depth_mm};
  if (free.crosses_itself) return {kCrossing, 1};
  c.margin = elastica::stability_margin(blade);
  if (c.margin < settings.blade.min_margin) return {kMargin, c.margin};
  return c;
}

Refusal refusal_of(const RibCheck& c, double length, const Settings& settings) {
  switch (c.stage) {
    case kRibCurvature:
      return {
          "",
          "",
          "radius of a rib",
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
    default:
      return {"",
              "",
              "stability margin",
              c.value,
              settings.blade.min_margin,
              "",
              "the blade could snap: allow more splits or add a shorter blade than " +
                  std::to_string(int(length)) + " mm"};
  }
}

// The earlier stage, then the larger amount: depth and length grow with the harm, everything else shrinks
// with it.
bool worse(const RibCheck& a, const RibCheck& b) {
  if (a.stage != b.stage) return a.stage < b.stage;
  return a.stage == kLength || a.stage == kReentry ? a.value > b.value : a.value < b.value;
}

BladeChoice summarise(const std::vector<RibCheck>& checks, double length, double share) {
  BladeChoice choice{length, share, checks.front().margin, 0, checks.front().clearance};
  for (const RibCheck& c : checks) {
    choice.smallest_margin = std::min(choice.smallest_margin, c.margin);
    choice.largest_curvature_per_mm = std::max(choice.largest_curvature_per_mm, c.curvature);
    choice.smallest_clearance_mm = std::min(choice.smallest_clearance_mm, c.clearance);
  }
  return choice;
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
  // Shares of the extension on clamp A's side, the even one first; of those that serve, the least bent one is
  // taken.
  constexpr std::array<double, 5> kShares{0.5, 0.4, 0.6, 0.3, 0.7};
  for (const double length : settings.blade.free_lengths_mm) {
    for (const double share : kShares) {
      std::vector<RibCheck> checks(ribs.size());
      tbb::parallel_for(std::size_t{0}, ribs.size(), [&](std::size_t i) {
        checks[i] = check_rib(ribs[i], length, share, rect, settings);
      });
      const auto worst = std::min_element(checks.begin(), checks.end(), worse);
      if (worst->stage == kPassed) {
        const BladeChoice choice = summarise(checks, length, share);
        if (!report.choice || choice.largest_curvature_per_mm < report.choice->largest_curvature_per_mm) {
          report.choice = choice;
        }
      } else if (worst->stage > furthest) {
        furthest = worst->stage;
        report.refusal = refusal_of(*worst, length, settings);
        report.rib = static_cast<int>(worst - checks.begin());
        report.rib_too_sharp = worst->stage == kRibCurvature;
      }
      if (worst->stage == kRibCurvature) return report;  // no length and no share changes the rib itself
      if (worst->stage == kLength) break;                // nor a share the length
    }
    if (report.choice) break;
  }
  return report;
}

}  // namespace hotblade::pipeline
