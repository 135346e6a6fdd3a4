#include "pipeline/report/foam_share.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "elastica/elastica.hpp"

namespace hotblade::pipeline {

namespace {

// A sag of a 200th of the chord between samples is a percent of a percent of the area.
constexpr int kBladeSamples = 200;

// The block's edges as the blade sees them: along the rib, towards the waste, along the sweep.
class BlockSection {
 public:
  BlockSection(const Stock& stock, const Frame& rib) : origin_(stock.frame.origin) {
    const std::array<Eigen::Vector3d, 3> edges{stock.frame.x, stock.frame.y, stock.frame.normal()};
    const std::array<Eigen::Vector3d, 3> wanted{rib.x, rib.y, rib.normal()};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto nearest = std::max_element(edges.begin(), edges.end(), [&](const auto& p, const auto& q) {
        return std::abs(p.dot(wanted[k])) < std::abs(q.dot(wanted[k]));
      });
      size_[static_cast<Eigen::Index>(k)] = stock.size_mm[nearest - edges.begin()];
      axes_[k] = *nearest;
      // Heights are counted from the kept side up.
      if (nearest->dot(wanted[k]) < 0) {
        origin_ += size_[static_cast<Eigen::Index>(k)] * *nearest;
        axes_[k] = -*nearest;
      }
    }
  }

  [[nodiscard]] const Eigen::Vector3d& size() const { return size_; }
  [[nodiscard]] Eigen::Vector3d place(const Eigen::Vector3d& p) const {
    const Eigen::Vector3d d = p - origin_;
    return {d.dot(axes_[0]), d.dot(axes_[1]), d.dot(axes_[2])};
  }

  // Area between the blade and the block's kept edge, mm2. A curve held inside the rectangle adds nothing
  // where it runs beside it and the full height where it runs above it.
  [[nodiscard]] double kept_area_mm2(const BladePose& pose) const {
    const elastica::ElasticaCurve curve(pose.blade);
    const auto held = [&](int i) -> Eigen::Vector2d {
      const Eigen::Vector2d q = curve.at(pose.blade.length * i / kBladeSamples).position();
      const Eigen::Vector3d b = place(pose.frame.point(q.x(), q.y()));
      return {std::clamp(b.x(), 0.0, size_.x()), std::clamp(b.y(), 0.0, size_.y())};
    };
    double area = 0;
    Eigen::Vector2d from = held(0);
    for (int i = 1; i <= kBladeSamples; ++i) {
      const Eigen::Vector2d to = held(i);
      area += 0.5 * (from.y() + to.y()) * (to.x() - from.x());
      from = to;
    }
    return std::abs(area);
  }

 private:
  Eigen::Vector3d origin_, size_;
  std::array<Eigen::Vector3d, 3> axes_;
};

}  // namespace

double foam_kept_share(const Strip& strip) {
  if (strip.poses.empty()) return 0;
  const BlockSection block(strip.stock, strip.poses.front().frame);
  const double section = block.size().x() * block.size().y();
  double kept = 0, whole = 0, depth_before = 0, area_before = 0;
  bool inside_before = false;
  for (const BladePose& pose : strip.poses) {
    const double depth = block.place(pose.frame.origin).z();
    const bool sweeps = pose.phase == "lead_in" || pose.phase == "cut" || pose.phase == "lead_out";
    const bool inside = sweeps && depth >= 0 && depth <= block.size().z();
    const double area = inside ? block.kept_area_mm2(pose) : 0;
    if (inside && inside_before) {
      const double step = std::abs(depth - depth_before);
      kept += 0.5 * (area + area_before) * step;
      whole += section * step;
    }
    inside_before = inside;
    depth_before = depth;
    area_before = area;
  }
  return whole > 0 ? kept / whole : 0;
}

}  // namespace hotblade::pipeline
