#include "pipeline/plan/motion/strip_block.hpp"

#include <algorithm>
#include <limits>

namespace hotblade::pipeline {
namespace {

// A box in the axes of the ribs' middle plane, with the sweep as the third.
struct Enclosure {
  Eigen::Vector3d centre, x, y, sweep;  // origin and axes
  Eigen::Vector3d low, high;            // corners along x, y, sweep
};

Enclosure enclosure(const std::vector<RibFit>& ribs, const RibAxes& axes, const StockSettings& settings) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  const double first = ribs.front().offset_mm, last = ribs.back().offset_mm;
  const double middle_mm = 0.5 * (first + last);
  const bool tilted = axes.planes.turns();
  Enclosure box;
  box.centre = axes.planes.centre();
  const Frame middle = axes.plane(middle_mm);
  box.x = middle.x;
  box.y = middle.y;
  box.sweep = axes.planes.normal(middle_mm);
  box.low.setConstant(kInf);
  box.high.setConstant(-kInf);
  // Between two ribs of a fan the design bulges out: each rib's points are turned half-way to its neighbours.
  const auto enclose = [&](const RibFit& rib, double offset) {
    const Frame plane = axes.plane(offset);
    const auto add = [&](const Eigen::Vector2d& q) {
      const Eigen::Vector3d p = plane.point(q.x(), q.y()) - box.centre;
      const Eigen::Vector3d at = tilted ? Eigen::Vector3d(p.dot(box.x), p.dot(box.y), p.dot(box.sweep))
                                        : Eigen::Vector3d(q.x(), q.y(), offset);
      box.low = box.low.cwiseMin(at);
      box.high = box.high.cwiseMax(at);
    };
    for (const Eigen::Vector2d& q : rib.target) add(q);
    for (const Eigen::Vector2d& q : rib.beside) add(q);
  };
  for (std::size_t i = 0; i < ribs.size(); ++i) {
    const double offset = ribs[i].offset_mm;
    enclose(ribs[i], offset);
    if (!tilted) continue;
    if (i > 0) enclose(ribs[i], 0.5 * (offset + ribs[i - 1].offset_mm));
    if (i + 1 < ribs.size()) enclose(ribs[i], 0.5 * (offset + ribs[i + 1].offset_mm));
  }
  box.low -= Eigen::Vector3d(settings.border_mm, settings.base_mm, settings.border_mm);
  box.high += Eigen::Vector3d::Constant(settings.border_mm);
  return box;
}

}  // namespace

Block block_around(const std::vector<RibFit>& ribs, const RibAxes& axes, const StockSettings& settings) {
  const Enclosure e = enclosure(ribs, axes, settings);
  const bool along = axes.x.cross(axes.y).dot(axes.sweep) > 0;
  Block block{{e.centre + (along ? e.low.z() : e.high.z()) * e.sweep, e.x, e.y}, e.high - e.low};
  block.frame.origin = block.frame.point(e.low.x(), e.low.y());
  return block;
}

Pose on_table(const std::vector<RibFit>& ribs, const RibAxes& axes, const Settings& settings) {
  const Enclosure e = enclosure(ribs, axes, settings.stock);
  Eigen::Matrix3d r;
  r.row(0) = e.x;
  r.row(1) = -e.sweep.cross(e.x);
  r.row(2) = -e.sweep;
  const Eigen::Vector2d middle = 0.5 * (e.low.head<2>() + e.high.head<2>());
  const Eigen::Vector3d foot = e.centre + middle.x() * e.x + middle.y() * e.y + e.high.z() * e.sweep;
  Pose design_to_cell;
  design_to_cell.q = robot::canonical(Eigen::Quaterniond(r));
  const double plinth = settings.machine.plinth_mm > 0 ? settings.machine.plinth_mm : kUsualPlinthMm;
  design_to_cell.p = Eigen::Vector3d(0, 0, plinth) - design_to_cell.q.toRotationMatrix() * foot;
  return design_to_cell;
}

StripPlan make_strip_plan(const RibAxes& axes, const std::vector<RibFit>& ribs, const BladeChoice& blade,
                          const Settings& settings) {
  StripPlan strip;
  static_cast<RibAxes&>(strip) = axes;
  strip.ribs = ribs;
  // Only the block asks for them, and they are most of what a plan of many ribs holds.
  for (RibFit& rib : strip.ribs) std::vector<Eigen::Vector2d>().swap(rib.beside);
  strip.blade_length_mm = blade.length_mm;
  strip.share_a = blade.share_a;
  strip.smallest_margin = blade.smallest_margin;
  strip.largest_curvature_per_mm = blade.largest_curvature_per_mm;
  strip.smallest_clearance_mm = blade.smallest_clearance_mm;
  strip.sag_mm = blade.sag_mm;
  strip.block = block_around(ribs, axes, settings.stock);
  strip.design_to_cell = on_table(ribs, axes, settings);
  return strip;
}

bool fits_stock(const StripPlan& strip, const Settings& settings) {
  const auto& edges = settings.stock.max_size_mm;
  Eigen::Vector3d size = strip.block.size_mm, most(edges[0], edges[1], edges[2]);
  std::sort(size.begin(), size.end());
  std::sort(most.begin(), most.end());
  return (size.array() <= most.array()).all();
}

}  // namespace hotblade::pipeline
