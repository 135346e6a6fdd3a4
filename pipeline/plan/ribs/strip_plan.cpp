#include "pipeline/plan/ribs/strip_plan.hpp"

#include <algorithm>
#include <cmath>

#include "pipeline/plan/ribs/fade.hpp"

namespace hotblade::pipeline {

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

Frame StripPlan::swept_plane(double offset_mm) const {
  if (!planes.turns()) return plane(offset_mm);
  const double first = ribs.front().offset_mm, last = ribs.back().offset_mm;
  const double inside = std::clamp(offset_mm, first, last), outside = offset_mm - inside;
  const double turned = faded_mm(outside);  // the rest goes straight on
  Frame frame = plane(inside + turned);
  frame.origin += (outside - turned) * planes.normal(inside);
  return frame;
}

elastica::Elastica extended(const elastica::Elastica& rib, double blade_length_mm, double share_a) {
  const double before = share_a * (blade_length_mm - rib.length);
  return segment(rib, -before, blade_length_mm - before);
}

}  // namespace hotblade::pipeline
