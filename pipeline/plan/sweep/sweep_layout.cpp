#include "pipeline/plan/sweep/sweep_layout.hpp"

#include "gpu/backend/stop.hpp"
#include "pipeline/plan/sweep/section_beziers.hpp"
#include "pipeline/plan/sweep/sweep_cuts.hpp"
#include "pipeline/plan/sweep/sweep_directions.hpp"
#include "pipeline/plan/sweep/sweep_few.hpp"
#include "robot/blade/blade_section.hpp"
#include "surface/read/blocks.hpp"

#include <tbb/parallel_for.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

namespace hotblade::pipeline {

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Box = Eigen::AlignedBox<double, 2>;

// A part's points move by half a band and its sag to where they are formed, and the part goes on past its
// seams by kSeamOverlapMm.
constexpr double kReachMm = 60;
// Share of the area that may be too steep for planes: the 98 of a hundred vertices that sections are judged
// by.
constexpr double kLittle = 0.02;
// That parts share their whole's axes up to.
constexpr double kSharedTurn_rad = 1;

// A number that grows with the angle between two directions, of which these are the sine and the cosine times
// any length: 0 to 2, as the angle goes to half a turn.
double angle_order(double sine, double cosine) {
  const double share = sine / (sine + std::abs(cosine));
  return cosine >= 0 ? share : 2 - share;
}

double angle_of_order(double order) {
  return order <= 1 ? std::atan2(order, 1 - order) : std::atan2(2 - order, 1 - order);
}

// Between y and the normals, in the planes: of 98 of a hundred vertices behind the seams.
double normals_turn_rad(const WasteSurface& surface, const std::vector<SweepSeam>& seams,
                        const RibAxes& axes) {
  std::vector<double> turns;
  turns.reserve(surface.points.size());
  Frame plane = axes.plane(0);
  for (std::size_t i = 0; i < surface.points.size(); ++i) {
    const Vector3d& n = surface.normals[i];
    if (n.isZero() || !lies_behind(seams, surface.points[i])) continue;
    if (axes.planes.turns()) plane = axes.plane_at(surface.points[i]);
    const double sine = std::abs(n.dot(plane.x)), cosine = n.dot(plane.y);
    // A normal along the planes' own lies in no direction of theirs.
    turns.push_back(sine > 0 || cosine != 0 ? angle_order(sine, cosine) : 0);
  }
  if (turns.empty()) return 0;
  const auto at =
      turns.begin() + static_cast<std::ptrdiff_t>((1 - kLittle) * static_cast<double>(turns.size() - 1));
  std::nth_element(turns.begin(), at, turns.end());
  return angle_of_order(*at);
}

// By how much a part is too large for any block or blade; at most 1: it is not.
double excess_of(const PartFit& fit) {
  const bool too_long = fit.refusal && fit.refusal->limit == Limit::kRibLength;
  return std::max(fit.stock_share, too_long ? fit.refusal->value / fit.refusal->bound : 1);
}

}  // namespace

bool hangs_too_far(const SweepPart& part, const PartFit& fit, double most_mm) {
  return part.axes.planes.turns() && fit.sag_mm > most_mm;
}

void Layout::add(FittedPart part) {
  cost_mm = std::max(cost_mm, part.fit.cost_mm);
  parts.push_back(std::move(part.part));
  fits.push_back(std::move(part.fit));
}

Eigen::Vector2d turn_of(const Layout& layout, double most_rad) {
  double scale = 0;
  for (const PartFit& fit : layout.fits) scale = std::max(scale, fit.turn.scale_mm);
  PlaneTurn all;
  for (const PartFit& fit : layout.fits) {
    const PlaneTurn part = fit.turn.at_scale(scale);
    all.gradient += part.gradient;
    all.matrix += part.matrix;
  }
  constexpr double kDamping = 1e-3;
  Eigen::Matrix2d damped = all.matrix;
  damped.diagonal() += kDamping * Eigen::Vector2d::Constant(all.matrix.trace());
  const Eigen::Vector2d step = -damped.ldlt().solve(all.gradient);
  if (!step.allFinite()) return {0, 0};
  return step.norm() > most_rad ? Eigen::Vector2d(most_rad / step.norm() * step) : step;
}

std::vector<std::pair<std::size_t, FacetRise>> coarsest(const Layout& layout, double tolerance_mm,
                                                        std::size_t most) {
  std::vector<std::pair<std::size_t, FacetRise>> parts;
  for (std::size_t i = 0; i < layout.parts.size(); ++i) {
    const FacetRise rise = smooth_over_facets(*layout.parts[i].surface, layout.parts[i].seams);
    if (layout.fits[i].holds() && rise.off_mm > tolerance_mm) parts.emplace_back(i, rise);
  }
  std::stable_sort(parts.begin(), parts.end(),
                   [](const auto& a, const auto& b) { return a.second.off_mm > b.second.off_mm; });
  if (parts.size() > most) parts.resize(most);
  return parts;
}

bool layout_before(const Layout& a, const Layout& b) {
  return std::pair(a.cost_mm, a.named) < std::pair(b.cost_mm, b.named);
}

namespace {

std::shared_ptr<const WasteSurface> with_few(WasteSurface surface, const surface::TriangleMesh& mesh,
                                             const Settings& settings) {
  const double least_radius_mm = 1 / max_curvature_per_mm(settings.blade);
  surface.few = few_of(surface, mesh, cell_for(least_radius_mm, settings.design.tolerance_mm));
  return std::make_shared<WasteSurface>(std::move(surface));
}

}  // namespace

SweepLayouts::SweepLayouts(const surface::TriangleMesh& mesh, WasteSurface surface,
                           std::vector<surface::PlaneFamily> planes, const Settings& settings,
                           const PartFitter& fitter)
    : mesh_(mesh),
      surface_(with_few(std::move(surface), mesh, settings)),
      lean_(lean_of(*surface_)),
      all_planes_(std::move(planes)),
      settings_(settings),
      fitter_(fitter) {
  const std::vector<double> steep = too_steep_shares(*surface_, {}, all_planes_);
  for (std::size_t i = 0; i < all_planes_.size(); ++i)
    if (steep[i] <= kLittle) planes_.push_back(all_planes_[i]);
  if (planes_.empty()) planes_ = all_planes_;
  whole_.resize(planes_.size());
  tbb::parallel_for(std::size_t{0}, planes_.size(), [&](std::size_t i) { whole_[i] = whole_in(planes_[i]); });
  gpu::stop_point();
}

SweepLayouts::Whole SweepLayouts::whole_in(const surface::PlaneFamily& planes) const {
  Whole whole{axes(planes), {}, {}};
  whole.box = extent_of(whole.axes);
  whole.least = least_grid(whole.box);
  return whole;
}

double SweepLayouts::turn_in(const RibAxes& axes) const {
  return normals_turn_rad(surface_->few ? *surface_->few : *surface_, {}, axes);
}

RibAxes SweepLayouts::axes(const surface::PlaneFamily& planes) const {
  return planes.turns() ? sweep_axes(*surface_, planes) : parallel_axes(lean_, planes);
}

Box SweepLayouts::extent_of(const RibAxes& axes) const {
  Box box;
  for (const Vector3d& p : surface_->points) {
    const Frame plane = axes.plane_at(p);
    box.extend(Vector2d(axes.planes.offset(p), (p - plane.origin).dot(plane.x)));
  }
  return box;
}

SweepGrid SweepLayouts::least_grid(const Box& extent) const {
  const double edge = fitter_.longest_edge_mm(), rib = std::min(edge, fitter_.longest_rib_mm());
  const auto needed = [](double size, double most) {
    constexpr double kRounding = 1e-9;
    return most > 0 ? static_cast<std::size_t>(std::max(1.0, std::ceil(size / most - kRounding))) : 1;
  };
  // Blades that reach over no more than a part goes past its seams reach over no part: one says so.
  return {needed(extent.sizes().x(), edge), rib > 2 * kSeamOverlapMm ? needed(extent.sizes().y(), rib) : 1};
}

std::size_t SweepLayouts::fewest_parts() const {
  std::size_t fewest = std::numeric_limits<std::size_t>::max();
  for (const Whole& whole : whole_) fewest = std::min(fewest, whole.least.count());
  return fewest;
}

SweepPart SweepLayouts::part_behind(const RibAxes& axes, std::vector<SweepSeam> seams,
                                    const std::shared_ptr<const WasteSurface>& within) const {
  SweepPart part{axes, std::move(seams), within, 0};
  if (!part.seams.empty())
    part.surface = std::make_shared<WasteSurface>(part_of(*within, part.seams, kReachMm));
  return part;
}

bool SweepLayouts::meets_design(const SweepPart& part) const {
  const auto inside = [&](const Vector3d& p) { return lies_behind(part.seams, p); };
  const std::vector<Vector3d>& points = part.surface->points;
  return std::any_of(points.begin(), points.end(), inside) || !fitter_.measured(part).extent.isEmpty();
}

std::vector<SweepPart> SweepLayouts::parts_of(const Whole& whole, const SweepGrid& grid) const {
  const RibAxes& axes = whole.axes;
  const Box& box = whole.box;
  const std::vector<double> along = cuts(box.min().x(), box.max().x(), even_shares(grid.along_sweep));
  std::vector<std::vector<SweepPart>> rows(grid.along_sweep);
  const bool turns = grid.along_ribs > 1 && turn_in(axes) > kSharedTurn_rad;
  surface::for_blocks(rows.size(), 1, [&](std::size_t s, std::size_t) {
    std::vector<SweepSeam> ends;
    if (s > 0) ends.push_back(seam_across_sweep(axes, along[s - 1], -1));
    if (s < along.size()) ends.push_back(seam_across_sweep(axes, along[s], 1));
    const SweepPart row = part_behind(axes, std::move(ends), surface_);
    const Range offsets(s > 0 ? along[s - 1] : box.min().x(), s < along.size() ? along[s] : box.max().x());
    const std::vector<std::vector<SweepSeam>> across =
        turns && !axes.planes.turns()
            ? even_lengths(mesh_, axes, offsets, grid.along_ribs)
            : even_widths(axes, box.center().x(), {box.min().y(), box.max().y()}, grid.along_ribs);
    for (const std::vector<SweepSeam>& own : across) {
      std::vector<SweepSeam> seams = row.seams;
      seams.insert(seams.end(), own.begin(), own.end());
      SweepPart part = grid.along_ribs > 1 ? part_behind(axes, std::move(seams), row.surface) : row;
      if (turns) part.axes = sweep_axes(*part.surface, axes.planes);
      // A triangle's grid has cells without design.
      if (grid.count() > 1 && !meets_design(part)) continue;
      part.rib_splits = static_cast<int>(grid.along_ribs - std::min(grid.along_ribs, whole.least.along_ribs));
      rows[s].push_back(std::move(part));
    }
  });
  std::vector<SweepPart> parts;
  for (std::vector<SweepPart>& row : rows)
    parts.insert(parts.end(), std::move_iterator(row.begin()), std::move_iterator(row.end()));
  return parts;
}

Layout SweepLayouts::fitted(const surface::PlaneFamily& planes, std::size_t named, const SweepGrid& grid,
                            const SweepEffort& effort, const Layout* start) const {
  return fitted(whole_in(planes), named, grid, effort, start);
}

Layout SweepLayouts::fitted(const Whole& whole, std::size_t named, const SweepGrid& grid,
                            const SweepEffort& effort, const Layout* start) const {
  Layout layout{whole.axes.planes, named, grid};
  layout.parts = parts_of(whole, grid);
  fit_parts(layout, effort, start);
  return layout;
}

void SweepLayouts::fit_parts(Layout& layout, const SweepEffort& effort, const Layout* start) const {
  layout.fits.resize(layout.parts.size());
  tbb::parallel_for(std::size_t{0}, layout.parts.size(), [&](std::size_t i) {
    layout.fits[i] = fitter_.fit(layout.parts[i], effort, start ? &start->fits[i] : nullptr);
  });
  gpu::stop_point();
  for (const PartFit& fit : layout.fits) layout.cost_mm = std::max(layout.cost_mm, fit.cost_mm);
}

// How many blocks the design takes about, if none is wasted at its border: each as deep along the sweep as
// its edges allow where the surface rises, and as long as a rib may be.
double SweepLayouts::blocks_in(const surface::PlaneFamily& planes) const {
  const auto& edges = settings_.stock.max_size_mm;
  const double deepest = fitter_.longest_edge_mm() - 2 * kSeamOverlapMm,
               longest = std::min(deepest, fitter_.longest_rib_mm() - 2 * kSeamOverlapMm),
               highest = *std::min_element(edges.begin(), edges.end()) - settings_.stock.base_mm -
                         settings_.stock.border_mm;
  double blocks = 0;
  for (const auto& triangle : surface_->triangles) {
    const auto corner = [&](std::size_t i) -> const Vector3d& {
      return surface_->points[static_cast<std::size_t>(triangle[i])];
    };
    const Vector3d twice = (corner(1) - corner(0)).cross(corner(2) - corner(0));
    const double area = 0.5 * twice.norm();
    if (!(area > 0)) continue;
    const Vector3d sweep = planes.normal_at(corner(0));
    const double along = std::abs(twice.dot(sweep)) / (2 * area),
                 across = std::sqrt(1 - std::min(1.0, along * along));
    const double rises = along * deepest > across * highest ? highest / along : deepest / across;
    blocks += area / (rises * longest);
  }
  return blocks;
}

Layout SweepLayouts::in_rows(std::vector<PlanesTried>& tried) const {
  constexpr double kNotMissed = std::numeric_limits<double>::infinity();  // no section is looked at
  std::vector<std::pair<double, std::size_t>> estimated;
  // A fan's rows are as deep as a block at one end only: it is for a strip, unless there is nothing else.
  const bool fans = std::all_of(planes_.begin(), planes_.end(),
                                [](const surface::PlaneFamily& planes) { return planes.turns(); });
  for (std::size_t i = 0; i < planes_.size(); ++i) {
    if (fans || !planes_[i].turns()) estimated.emplace_back(blocks_in(planes_[i]), i);
  }
  std::sort(estimated.begin(), estimated.end());
  // The estimate counts no waste at borders and no edge that is too long: the rows of other planes say more,
  // as long as these may be fewer.
  std::vector<Rows> laid;
  double fewest = std::numeric_limits<double>::infinity();
  for (const auto& [blocks, i] : estimated) {
    if (blocks >= fewest) break;
    laid.push_back(even_rows(whole_[i]));
    laid.back().blocks = blocks;
    fewest = std::min(fewest, static_cast<double>(laid.back().needs));
  }
  std::stable_sort(laid.begin(), laid.end(), [](const Rows& a, const Rows& b) { return a.needs < b.needs; });
  const Rows* best = nullptr;
  for (Rows& rows : laid) {
    // Rows that fit are hardly fewer than even ones.
    if (rows.rows.empty() || (best && rows.needs >= best->needs)) break;
    fit_rows(rows);
    if (!best || rows.needs < best->needs) best = &rows;
  }
  for (const Rows& rows : laid) {
    std::size_t widest = 1;
    for (const std::vector<FittedPart>& row : rows.rows) widest = std::max(widest, row.size());
    const PlanesTried of_rows{rows.axes.planes, rows.shares.size(), widest,    kNotMissed,
                              std::nullopt,     rows.blocks,        rows.needs};
    tried.insert(&rows == best ? tried.begin() : tried.end(), of_rows);
  }
  std::stable_sort(tried.begin() + (best ? 1 : 0), tried.end(),
                   [](const auto& a, const auto& b) { return a.strips_in_rows < b.strips_in_rows; });
  for (std::size_t n = laid.size(); n < estimated.size(); ++n) {
    const auto& [blocks, i] = estimated[n];
    const SweepGrid& least = whole_[i].least;
    tried.push_back({planes_[i], least.along_sweep, least.along_ribs, kNotMissed, std::nullopt, blocks, 0});
  }
  Layout layout{planes_.front(), 0, {}};
  if (!best) {
    layout.grid = {laid.front().needs, 1};
  } else {
    layout.planes = best->axes.planes;
    for (const std::vector<FittedPart>& row : best->rows) {
      for (const FittedPart& part : row) layout.add(part);
    }
  }
  layout.cost_mm = 0;
  fit_parts(layout, cheap_effort(), nullptr);
  return layout;
}

SweepLayouts::Rows SweepLayouts::even_rows(const Whole& whole) const {
  Rows rows{whole.axes, whole.box, {}, {}, {}};
  const double deepest = fitter_.longest_edge_mm() - 2 * kSeamOverlapMm;
  lay(rows, even_shares(static_cast<std::size_t>(std::ceil(rows.box.sizes().x() / deepest))));
  return rows;
}

void SweepLayouts::lay(Rows& rows, std::vector<double> shares) const {
  const double most = std::min(fitter_.longest_edge_mm(), fitter_.longest_rib_mm()) - 2 * kSeamOverlapMm;
  rows.shares = std::move(shares);
  rows.rows.clear();
  rows.over.assign(rows.shares.size(), 1);
  const double pieces = std::max(1.0, std::ceil(rows.box.sizes().y() / most));
  // A design may fill half of its box.
  constexpr std::size_t kMost = 2 * kMostStrips;
  rows.needs = rows.shares.size() * static_cast<std::size_t>(std::min<double>(pieces, kMost + 1));
  if (rows.needs > kMost) return;
  rows.rows = rows_of(rows.axes, rows.box, rows.shares, most);
  rows.needs = 0;
  for (std::size_t i = 0; i < rows.rows.size(); ++i) {
    for (const FittedPart& part : rows.rows[i]) {
      rows.over[i] = std::max(rows.over[i], part.fit.stock_share);
      // What cannot be a part as it is takes one more at least.
      rows.needs += part.fit.holds() ? 1 : 2;
    }
  }
}

// A row too steep for its depth is made narrower and the others deeper, as far as they may be; where that
// does not do, there are more rows.
void SweepLayouts::fit_rows(Rows& rows) const {
  constexpr int kRounds = 8, kVain = 2;
  const double deepest = fitter_.longest_edge_mm() - 2 * kSeamOverlapMm;
  Rows now = rows;
  int vain = 0;
  for (int round = 1; round < kRounds && rows.worst() > 1 && vain < kVain; ++round) {
    std::vector<double> shares = now.shares;
    double sum = 0;
    for (std::size_t i = 0; i < shares.size(); ++i) {
      constexpr double kReserve = 1.02;
      sum += shares[i] =
          now.over[i] > 1 ? shares[i] / (kReserve * now.over[i]) : deepest / rows.box.sizes().x();
    }
    if (sum < 1) {
      shares = even_shares(std::max(
          shares.size() + 1, static_cast<std::size_t>(std::ceil(static_cast<double>(shares.size()) / sum))));
    } else {
      for (double& share : shares) share /= sum;
    }
    lay(now, std::move(shares));
    if (now.rows.empty()) break;
    vain = now.worst() < rows.worst() ? 0 : vain + 1;
    if (vain == 0) rows = now;
  }
}

std::vector<std::vector<FittedPart>> SweepLayouts::rows_of(const RibAxes& axes, const Box& box,
                                                           const std::vector<double>& shares,
                                                           double most_mm) const {
  const std::vector<double> along = cuts(box.min().x(), box.max().x(), shares);
  std::vector<std::vector<FittedPart>> rows(shares.size());
  tbb::parallel_for(std::size_t{0}, rows.size(), [&](std::size_t row) {
    std::vector<SweepSeam> ends;
    if (row > 0) ends.push_back(seam_across_sweep(axes, along[row - 1], -1));
    if (row < along.size()) ends.push_back(seam_across_sweep(axes, along[row], 1));
    rows[row] = row_of(part_behind(axes, ends, surface_), most_mm);
  });
  gpu::stop_point();
  return rows;
}

// Slopes make blocks larger than what runs through them: rows whose parts do not fit are cut into more.
std::vector<FittedPart> SweepLayouts::row_of(const SweepPart& row, double most_mm) const {
  std::vector<FittedPart> best;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t more = 0; more <= std::max<std::size_t>(4, best.size() / 8); ++more) {
    std::vector<FittedPart> parts;
    double worst = 1;
    for (const auto& [from, to] : pieces_of(row, most_mm, more)) {
      std::vector<SweepSeam> seams = row.seams;
      if (std::isfinite(from)) seams.push_back(seam_across_ribs(row.axes, 0, from, -1));
      if (std::isfinite(to)) seams.push_back(seam_across_ribs(row.axes, 0, to, 1));
      SweepPart part = part_behind(row.axes, std::move(seams), row.surface);
      part.axes = sweep_axes(*part.surface, row.axes.planes);
      PartFit fit = fitter_.measured(part);
      worst = std::max(worst, excess_of(fit));
      parts.push_back({std::move(part), std::move(fit)});
    }
    // One more of n makes each smaller by a n-th at best.
    const double helps = std::min(0.02, 0.2 / static_cast<double>(parts.size()));
    if (worst > 1 && !(worst < (1 - helps) * least)) break;
    least = worst;
    best = std::move(parts);
    if (worst <= 1) break;
  }
  return best;
}

std::vector<std::pair<double, double>> SweepLayouts::pieces_of(const SweepPart& row, double most_mm,
                                                               std::size_t more) const {
  constexpr int kSections = 8;
  constexpr double kSampleMm = 40;
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  const SweepData data = sweep_sections(
      *row.surface, row.axes, section_options(settings_, row.seams, kSections, kSampleMm, nullptr, nullptr));
  if (data.sections.empty()) return {};
  // Of all sections, how far they run between places of x at most.
  const double low = data.low.x(), width = data.high.x() - low;
  const auto count = static_cast<std::size_t>(std::ceil(width / kSampleMm)) + 1;
  std::vector<double> run(count, 0);
  for (const SweepSection& section : data.sections) {
    std::vector<double> own(count, 0);
    for (std::size_t i = 1; i < section.samples.size(); ++i) {
      const Vector2d &p = section.samples[i - 1].q, &q = section.samples[i].q;
      // Spread over the places that it runs through.
      const double bin = width / static_cast<double>(count), from = (p.x() - low) / bin,
                   to = (q.x() - low) / bin;
      const auto place = [&](double at) {
        return static_cast<std::size_t>(std::clamp(at, 0.0, static_cast<double>(count - 1)));
      };
      for (std::size_t k = place(from); k <= place(to); ++k) {
        const double inside =
            std::min(to, static_cast<double>(k + 1)) - std::max(from, static_cast<double>(k));
        own[k] += to > from ? (q - p).norm() * std::clamp(inside / (to - from), 0.0, 1.0) : 0;
      }
    }
    for (std::size_t i = 0; i < count; ++i) run[i] = std::max(run[i], own[i]);
  }
  const double whole = std::accumulate(run.begin(), run.end(), 0.0);
  const auto pieces = static_cast<std::size_t>(std::max(1.0, std::ceil(whole / most_mm))) + more;
  std::vector<std::pair<double, double>> parts;
  double from = -kInfinite, passed = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const auto wanted = [&] {
      return whole * static_cast<double>(parts.size() + 1) / static_cast<double>(pieces);
    };
    // Pieces may be shorter than the places are apart.
    while (parts.size() + 1 < pieces && run[i] > 0 && passed + run[i] >= wanted()) {
      const double share =
          (static_cast<double>(i) + (wanted() - passed) / run[i]) / static_cast<double>(count);
      parts.emplace_back(from, low + share * width);
      from = parts.back().second;
    }
    passed += run[i];
  }
  parts.emplace_back(from, kInfinite);
  return parts;
}

std::vector<EvenSplit> SweepLayouts::even_splits(std::size_t parts) const {
  // Splits beyond those that the length asks for are the user's to allow.
  const auto may = [&](const SweepGrid& least, const SweepGrid& grid) {
    return grid.along_sweep >= least.along_sweep && grid.along_ribs >= least.along_ribs &&
           grid.along_ribs <= least.along_ribs + static_cast<std::size_t>(settings_.fit.max_splits);
  };
  std::vector<EvenSplit> splits;
  std::vector<SectionQuestion> questions;
  std::size_t named = 0;
  for (std::size_t n = 0; n < planes_.size(); ++n) {
    for (std::size_t s = 1; s <= parts; ++s) {
      if (parts % s != 0) continue;
      const SweepGrid grid{s, parts / s};
      if (may(whole_[n].least, grid)) {
        splits.push_back({planes_[n], n, named, grid});
        questions.push_back({n, grid.along_ribs});
      }
      ++named;
    }
  }
  const std::vector<double> misses = elastica_misses_mm(mesh_, planes_, questions);
  for (std::size_t i = 0; i < splits.size(); ++i) splits[i].missed_mm = misses[i];
  std::stable_sort(splits.begin(), splits.end(),
                   [](const EvenSplit& a, const EvenSplit& b) { return a.missed_mm < b.missed_mm; });
  return splits;
}

Layout SweepLayouts::fitted(const EvenSplit& split) const {
  return fitted(whole_[split.family], split.named, split.grid, cheap_effort(), nullptr);
}

FittedPart SweepLayouts::in_best_planes(FittedPart best) const {
  constexpr double kNear = 4;  // tolerances: a split or two brings it down
  const std::vector<double> steep = too_steep_shares(*best.part.surface, best.part.seams, all_planes_);
  for (std::size_t i = 0; i < all_planes_.size(); ++i) {
    if (steep[i] > kLittle) continue;
    SweepPart part = best.part;
    part.axes = sweep_axes(*part.surface, all_planes_[i]);
    // Planes that the design faces away from in any case: sections would only say so.
    if (normals_turn_rad(*part.surface, part.seams, part.axes) > std::max(kMostTurnRad, best.fit.turn_rad))
      continue;
    PartFit fit = fitter_.fit(part, cheap_effort());
    if (fit.cost_mm < best.fit.cost_mm && !hangs_too_far(part, fit, kNear * settings_.design.tolerance_mm))
      best = {std::move(part), std::move(fit)};
  }
  return best;
}

std::vector<FittedPart> SweepLayouts::halves(const SweepPart& part, const PartFit& fit,
                                             const std::optional<Refusal>& why) const {
  constexpr double kLeastMm = 50;  // of a part that is split
  const Box& box = fit.extent;
  if (box.isEmpty()) return {};
  const bool parted = why && why->limit == Limit::kGap && fit.gap;
  const bool too_large =
      parted || (why && (why->limit == Limit::kRibLength || why->limit == Limit::kBlockEdge));
  const auto split = [&](bool across_ribs, double share) {
    std::vector<FittedPart> two;
    for (const double side : {1.0, -1.0}) {
      const Vector2d at = box.min() + share * box.sizes();
      std::vector<SweepSeam> seams = part.seams;
      seams.push_back(across_ribs ? seam_across_ribs(part.axes, box.center().x(), at.y(), side)
                                  : seam_across_sweep(part.axes, at.x(), side));
      SweepPart half = part_behind(part.axes, std::move(seams), part.surface);
      half.rib_splits = part.rib_splits + (across_ribs && !too_large ? 1 : 0);
      if (fit.turn_rad > kSharedTurn_rad) half.axes = sweep_axes(*half.surface, part.axes.planes);
      PartFit fitted = fitter_.fit(half, cheap_effort());
      two.push_back({std::move(half), std::move(fitted)});
      const std::optional<Refusal>& refusal = two.back().fit.refusal;
      const bool faces_away =
          refusal && (refusal->limit == Limit::kSlope || refusal->limit == Limit::kFacing);
      if (faces_away || hangs_too_far(two.back().part, two.back().fit, settings_.design.tolerance_mm))
        two.back() = in_best_planes(std::move(two.back()));
    }
    return two;
  };
  const auto worst = [](const std::vector<FittedPart>& two) {
    return std::max(two[0].fit.cost_mm, two[1].fit.cost_mm);
  };
  std::vector<FittedPart> best;
  // Strips that part at a gap meet in its middle.
  if (parted) {
    const double at = 0.5 * (fit.gap->low_mm + fit.gap->high_mm);
    return split(true, std::clamp((at - box.min().y()) / box.sizes().y(), 0.0, 1.0));
  }
  for (const bool across_ribs : {false, true}) {
    const double size = box.sizes()[across_ribs ? 1 : 0];
    if (size < kLeastMm || (across_ribs && !too_large && part.rib_splits >= settings_.fit.max_splits))
      continue;
    std::vector<FittedPart> two = split(across_ribs, 0.5);
    if (worst(two) < kHopeless_mm) {
      const double first = narrowing(two[0].fit.cost_mm), second = narrowing(two[1].fit.cost_mm);
      std::vector<FittedPart> other = split(across_ribs, first / (first + second));
      if (worst(other) < worst(two)) two = std::move(other);
    }
    if (best.empty() || worst(two) < worst(best)) best = std::move(two);
  }
  return best;
}

}  // namespace hotblade::pipeline
