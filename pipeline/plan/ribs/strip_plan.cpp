#include "pipeline/plan/ribs/strip_plan.hpp"

#include <algorithm>
#include <cmath>

#include "pipeline/plan/ribs/fade.hpp"

namespace hotblade::pipeline {

namespace {

bool same(const DesignPart& a, const DesignPart& b) {
  return a.first == b.first && a.last == b.last;
}

bool same(const elastica::Elastica& a, const elastica::Elastica& b) {
  return a.x == b.x && a.y == b.y && a.theta == b.theta && a.kappa == b.kappa && a.lambda1 == b.lambda1 &&
         a.lambda2 == b.lambda2 && a.length == b.length;
}

bool same(const RibFit& a, const RibFit& b) {
  return a.offset_mm == b.offset_mm && a.deviation_mm == b.deviation_mm &&
         a.max_slope_rad == b.max_slope_rad && same(a.own, b.own) && same(a.elastica, b.elastica) &&
         a.target == b.target;
}

bool same(const FormedPart& a, const FormedPart& b) {
  return a.offset_mm == b.offset_mm && same(a.part, b.part);
}

bool same(const RibAxes& a, const RibAxes& b) {
  const surface::PlaneFamily &p = a.planes, &q = b.planes;
  return a.sweep == b.sweep && a.x == b.x && a.y == b.y && p.normal(0) == q.normal(0) &&
         p.centre() == q.centre() && p.axis() == q.axis() && p.radius_mm() == q.radius_mm() &&
         p.closed() == q.closed();
}

bool same(const Block& a, const Block& b) {
  return a.size_mm == b.size_mm && a.frame.origin == b.frame.origin && a.frame.x == b.frame.x &&
         a.frame.y == b.frame.y;
}

template <typename Each>
bool same(const std::vector<Each>& a, const std::vector<Each>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const Each& p, const Each& q) { return same(p, q); });
}

}  // namespace

bool same_blades(const StripPlan& a, const StripPlan& b) {
  const RibAxes &axes = a, &others = b;
  return a.blade_length_mm == b.blade_length_mm && a.share_a == b.share_a && same(a.ribs, b.ribs) &&
         same(a.formed, b.formed) && a.on_mm == b.on_mm && same(axes, others) && same(a.block, b.block) &&
         a.design_to_cell.p == b.design_to_cell.p &&
         a.design_to_cell.q.coeffs() == b.design_to_cell.q.coeffs();
}

DesignPart StripPlan::formed_at(double offset_mm) const {
  if (formed.empty()) return {};
  const auto above = std::upper_bound(formed.begin(), formed.end(), offset_mm,
                                      [](double mm, const FormedPart& f) { return mm < f.offset_mm; });
  const auto k = static_cast<std::size_t>(
      std::clamp<std::ptrdiff_t>(above - formed.begin() - 1, 0, std::ssize(formed) - 1));
  const std::size_t next = std::min(k + 1, formed.size() - 1);
  // Each section stands for its neighbours too, so that a straight line between two of them misses nothing
  // of a border that bulges out.
  const auto hull = [&](std::size_t i) {
    DesignPart part = formed[i].part;
    for (const std::size_t j : {i > 0 ? i - 1 : i, std::min(i + 1, formed.size() - 1)}) {
      part.first = std::min(part.first, formed[j].part.first);
      part.last = std::max(part.last, formed[j].part.last);
    }
    return part;
  };
  const DesignPart a = hull(k), b = hull(next);
  const double gap = formed[next].offset_mm - formed[k].offset_mm;
  const double t = gap > 0 ? std::clamp((offset_mm - formed[k].offset_mm) / gap, 0.0, 1.0) : 0;
  DesignPart part{a.first + t * (b.first - a.first), a.last + t * (b.last - a.last)};
  // Where a share of the ribs has no design, as between two bays of a border, the cut goes on in the waste.
  constexpr double kLeastShare = 0.01;
  if (part.last - part.first >= kLeastShare) return part;
  const double middle = std::clamp(0.5 * (part.first + part.last), 0.5 * kLeastShare, 1 - 0.5 * kLeastShare);
  return {middle - 0.5 * kLeastShare, middle + 0.5 * kLeastShare};
}

double way_on_mm(const StripPlan& strip, double width_mm, double over_mm) {
  double ratio = 1;  // of the planes' distance where they are the farthest apart to that at the design
  if (strip.planes.turns()) {
    for (const RibFit* rib : {&strip.ribs.front(), &strip.ribs.back()}) {
      const Frame plane = strip.plane(rib->offset_mm);
      const DesignPart part = strip.formed_at(rib->offset_mm);
      for (const double share : {part.first, 0.5 * (part.first + part.last), part.last}) {
        const auto p = elastica::point_at(rib->elastica, share * rib->elastica.length);
        ratio = std::max(ratio,
                         strip.planes.radius_mm() / strip.planes.distance_from_axis(plane.point(p.x, p.y)));
      }
    }
  }
  return std::clamp(0.5 * width_mm * ratio - over_mm, 0.0, kMostOnMm);
}

Frame StripPlan::swept_plane(double offset_mm) const {
  if (!planes.turns()) return plane(offset_mm);
  const double first = ribs.front().offset_mm, last = ribs.back().offset_mm;
  const double inside = std::clamp(offset_mm, first, last), outside = offset_mm - inside;
  const double turned = faded_mm(outside, on_mm);  // the rest goes straight on
  Frame frame = plane(inside + turned);
  frame.origin += (outside - turned) * planes.normal(inside);
  return frame;
}

elastica::Elastica extended(const elastica::Elastica& rib, double blade_length_mm, double share_a) {
  const double before = share_a * (blade_length_mm - rib.length);
  return segment(rib, -before, blade_length_mm - before);
}

}  // namespace hotblade::pipeline
