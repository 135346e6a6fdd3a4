// Which blade cuts a strip: the shortest free length whose extension clears the stock, bends within yield, is
// stable and neither crosses itself nor re-enters the part. Of the ways to share the extension between both
// sides, the one that loads blade and clamps least: the force is the same for all, so the largest moment in
// the blade decides, then the larger of the two clamps' moments, then the more even share.
#pragma once

#include <optional>
#include <vector>

#include "pipeline/plan/strips.hpp"

namespace hotblade::pipeline {

struct BladeChoice {
  double length_mm = 0, share_a = 0.5;
  double smallest_margin = 0, largest_curvature_per_mm = 0, smallest_clearance_mm = 0;
  double clamp_curvature_per_mm =
      0;  // the larger of both clamps and all ribs: the moment there over the stiffness
};

struct BladeReport {
  std::optional<BladeChoice> choice;
  // The limit that stopped the candidate that came furthest, when there is no choice; its details say which
  // limit stopped the best share of each length. Rib index in `rib`, or -1.
  Refusal refusal;
  int rib = -1;
  bool rib_too_sharp =
      false;  // the rib itself, without extension, bends beyond the limit: no split helps much
};

// Rectangle of the stock in the strip's plane.
struct StockRect {
  Eigen::Vector2d low, high;
  [[nodiscard]] double distance(const Eigen::Vector2d& q) const;  // 0 inside
};

// What the free parts of a blade do beside its foam interval [s0, s1].
struct FreeParts {
  bool crosses_itself = false;
  // Largest depth of a free part, inside the stock, on the kept side of the part that cuts; 0 when there is
  // none.
  double depth_mm = 0;
};
[[nodiscard]] FreeParts examine_free_parts(const elastica::Elastica& blade, double s0, double s1,
                                           const StockRect& rect);
// Deeper is a cut into the part; less is the sampling of the blade's curve.
inline constexpr double kFreePartDepthMm = 0.1;

[[nodiscard]] StockRect stock_rect(const std::vector<RibFit>& ribs, const StockSettings& settings);

[[nodiscard]] BladeReport choose_blade(const std::vector<RibFit>& ribs, const StockRect& rect,
                                       const Settings& settings);

}  // namespace hotblade::pipeline
