#include "pipeline/plan/strips/share_strip.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "pipeline/plan/motion/strip_block.hpp"

namespace hotblade::pipeline {

namespace {

// An edge of a block that is longer than the stock's edge of the same rank; a block may be turned any way.
struct EdgeOver {
  double edge_mm = 0, stock_mm = 0;
};

std::optional<EdgeOver> edge_over_stock(Eigen::Vector3d size, const StockSettings& stock) {
  Eigen::Vector3d most(stock.max_size_mm[0], stock.max_size_mm[1], stock.max_size_mm[2]);
  std::sort(size.begin(), size.end());
  std::sort(most.begin(), most.end());
  for (int i = 0; i < 3; ++i) {
    if (size[i] > most[i]) return EdgeOver{size[i], most[i]};
  }
  return std::nullopt;
}

// Says where a rib is that a limit broke at.
void place_at_rib(const ChainTarget& chain, const std::vector<RibFit>& ribs, std::size_t i,
                  Refusal& refusal) {
  const std::vector<Eigen::Vector2d>& points = ribs[i].target.empty() ? ribs[i].course : ribs[i].target;
  const Eigen::Vector2d q = points[points.size() / 2];
  const Eigen::Vector3d p = chain.plane(ribs[i].offset_mm).point(q.x(), q.y());
  refusal.at = p;
  refusal.place = fmt::format("at ({:.1f}, {:.1f}, {:.1f})", p.x(), p.y(), p.z());
}

// The calmest fit within `allowed` that a blade can be extended from; else the refusal of the closest fit.
struct Served {
  std::vector<RibFit> ribs;
  BladeReport blade;
};

Served serve(const RibAxes& axes, const std::vector<RibFit>& closest, double allowed, Purpose purpose,
             const Settings& settings) {
  // From nearly circular arcs down to what the points alone say.
  constexpr std::array<double, 4> kTensionWeights{3e-3, 3e-4, 3e-5, kLeastTensionWeight};
  Served served;
  for (const double weight : kTensionWeights) {
    std::vector<RibFit> ribs = weight > kLeastTensionWeight ? calmed(closest, weight) : closest;
    if (ribs[worst_rib(ribs)].deviation_mm > allowed) continue;
    const Block block = block_around(ribs, axes, settings.stock);
    served.blade = choose_blade(ribs, axes, block, settings);
    if (served.blade.choice && purpose == Purpose::kStrip) {
      smooth_ribs(ribs, weight, 0.1 * allowed, allowed);
      served.blade = choose_blade(ribs, axes, block, settings);
    }
    served.ribs = std::move(ribs);
    if (served.blade.choice) break;
  }
  return served;
}

}  // namespace

std::size_t worst_rib(const std::vector<RibFit>& ribs) {
  return static_cast<std::size_t>(
      std::max_element(ribs.begin(), ribs.end(),
                       [](const RibFit& a, const RibFit& b) { return a.deviation_mm < b.deviation_mm; }) -
      ribs.begin());
}

double allowed_mm(const Settings& settings) {
  return settings.fit.deviation_share * settings.design.tolerance_mm;
}

StripPlan make_strip_plan(const RibAxes& axes, const std::vector<RibFit>& ribs, const BladeChoice& blade,
                          const Settings& settings) {
  StripPlan strip;
  static_cast<RibAxes&>(strip) = axes;
  strip.ribs = ribs;
  strip.blade_length_mm = blade.length_mm;
  strip.share_a = blade.share_a;
  strip.smallest_margin = blade.smallest_margin;
  strip.largest_curvature_per_mm = blade.largest_curvature_per_mm;
  strip.smallest_clearance_mm = blade.smallest_clearance_mm;
  strip.block = block_around(ribs, axes, settings.stock);
  strip.design_to_cell = on_table(ribs, axes, settings);
  return strip;
}

bool fits_stock(const StripPlan& strip, const Settings& settings) {
  return !edge_over_stock(strip.block.size_mm, settings.stock);
}

Attempt try_share(const ChainTarget& chain, const std::vector<RibFit>& closest, Purpose purpose,
                  const Settings& settings) {
  Attempt attempt;
  const double allowed = allowed_mm(settings);
  const std::size_t worst = worst_rib(closest);
  if (!(closest[worst].deviation_mm <= allowed)) {
    attempt.rib = worst;
    attempt.refusal = {"", "", Limit::kRibDeviation, closest[worst].deviation_mm, allowed};
    place_at_rib(chain, closest, worst, attempt.refusal);
    return attempt;
  }
  attempt.fitted = true;
  const Served served = serve(chain, closest, allowed, purpose, settings);
  if (!served.blade.choice) {
    attempt.refusal = served.blade.refusal;
    // A shorter piece follows the design more closely, so its radius only shrinks; half leaves room for the
    // slack that the tolerance gives.
    attempt.hopeless = served.blade.rib_too_sharp && attempt.refusal.value < 0.5 * attempt.refusal.bound;
    attempt.rib = static_cast<std::size_t>(std::max(0, served.blade.rib));
    place_at_rib(chain, served.ribs, attempt.rib, attempt.refusal);
    return attempt;
  }
  StripPlan strip = make_strip_plan(chain, served.ribs, *served.blade.choice, settings);
  if (const auto over = edge_over_stock(strip.block.size_mm, settings.stock)) {
    attempt.refusal = {"", "", Limit::kBlockEdge, over->edge_mm, over->stock_mm};
    place_at_rib(chain, strip.ribs, 0, attempt.refusal);
    return attempt;
  }
  attempt.strip = std::move(strip);
  return attempt;
}

std::optional<StripPlan> with_shorter_blade(const StripPlan& strip, const Settings& settings) {
  Settings shorter = settings;
  std::erase_if(shorter.blade.free_lengths_mm, [&](double mm) { return mm >= strip.blade_length_mm; });
  if (shorter.blade.free_lengths_mm.empty()) return std::nullopt;
  const Served served =
      serve(strip, calmed(strip.ribs, kLeastTensionWeight), allowed_mm(settings), Purpose::kStrip, shorter);
  if (!served.blade.choice) return std::nullopt;
  StripPlan next = make_strip_plan(strip, served.ribs, *served.blade.choice, settings);
  if (!fits_stock(next, settings)) return std::nullopt;
  next.id = strip.id;
  next.formed = strip.formed;
  next.seam_before = strip.seam_before;
  return next;
}

}  // namespace hotblade::pipeline
