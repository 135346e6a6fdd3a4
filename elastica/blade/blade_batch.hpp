// Points, stability margins and droops of many blades at once, one blade in each SIMD lane: what a plan asks
// of every pose of a motion.
//
// Each answer is that of the function named, to 1e-9 of its size, and depends on its own blade and the
// instruction set alone: splitting a batch changes no bit. Blades that wind faster than kBatchRate over their
// length go to that function itself. All spans of one call have the same size (std::logic_error); non-finite
// blades throw as ElasticaCurve does. Several threads may run at once.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "elastica/blade/gravity.hpp"
#include "elastica/curve/elastica.hpp"
#include "elastica/kernels/simd.hpp"

namespace hotblade::elastica {

// length * taylor_rate(): a cell of stability.hpp is one Taylor step of order 10 up to here.
inline constexpr double kBatchRate = 25.6;

// Writes point_at(blades[i], s[i]).
void points_at(std::span<const Elastica> blades, std::span<const double> s, std::span<CurvePoint> out,
               Simd simd = best_simd());

// The arc lengths at which a part of a blade begins and ends; they may lie outside [0, length].
struct Part {
  double first = 0, last = 0;
};

// Numbers in memory that is not cleared first: all of them are set at once.
class Unset {
 public:
  void resize(std::size_t size) {
    values_ = std::make_unique_for_overwrite<double[]>(size);
    size_ = size;
  }
  [[nodiscard]] double& operator[](std::size_t i) { return values_[i]; }
  [[nodiscard]] double operator[](std::size_t i) const { return values_[i]; }
  [[nodiscard]] const double* begin() const { return values_.get(); }
  [[nodiscard]] const double* end() const { return values_.get() + size_; }

 private:
  std::unique_ptr<double[]> values_;
  std::size_t size_ = 0;
};

// The places of points of some blades; those of one blade stand beside one another.
struct PartPlaces {
  std::size_t points = 0;  // of each blade
  Unset x, y;              // of blade i: [i * points, (i + 1) * points)
  [[nodiscard]] Eigen::Vector2d at(std::size_t blade, std::size_t k) const {
    return {x[blade * points + k], y[blade * points + k]};
  }
};

// The same with the curves' directions there.
struct PartPoints : PartPlaces {
  Unset cos, sin;   // of the tangent
  Unset turn;       // of the tangent since the blade's start, rad, not modulo 2 pi
  Unset curvature;  // signed
};

// Evenly spaced points on a part of every blade, both ends included; there must be at least 2
// (std::logic_error). The places are the same bits with and without their directions.
[[nodiscard]] PartPlaces sample_places(std::span<const Elastica> blades, std::span<const Part> parts,
                                       std::size_t points, Simd simd = best_simd());
[[nodiscard]] PartPoints sample_parts(std::span<const Elastica> blades, std::span<const Part> parts,
                                      std::size_t points, Simd simd = best_simd());

// The largest |kappa| of a blade, as ElasticaCurve(blade).max_abs_curvature() gives it, from the points of
// its whole length in `whole`, where it is blade `i`.
[[nodiscard]] double max_abs_curvature(const Elastica& blade, const PartPoints& whole, std::size_t i);
// Returns how many points that takes for each of these blades, one more than a power of two: at least 9, and
// `most` where it would take more.
[[nodiscard]] std::size_t curvature_points(std::span<const Elastica> blades, std::size_t most);

// Writes stability_margin(blades[i]).
void stability_margins(std::span<const Elastica> blades, std::span<double> out, Simd simd = best_simd());

// An even load along the plane's normal and the nodes of gravity.hpp between which the droop is wanted.
struct DroopLoad {
  double load = 0;
  std::size_t first = 0, last = kGravityCells;
};

// The largest shift and twist between the nodes asked for.
struct DroopReach {
  double shift = 0, twist = 0;
  bool stable = false;
};

// Writes the reach of droop(blades[i], loads[i].load, ratios).
void droops(std::span<const Elastica> blades, std::span<const DroopLoad> loads, const StiffnessRatios& ratios,
            std::span<DroopReach> out, Simd simd = best_simd());

// Returns plane_shift(blades[i], loads[i]).
[[nodiscard]] std::vector<PlaneShift> plane_shifts(std::span<const Elastica> blades,
                                                   std::span<const Eigen::Vector2d> loads,
                                                   Simd simd = best_simd());

// Returns droop(blades[i], loads[i], ratios).
[[nodiscard]] std::vector<Droop> droop_profiles(std::span<const Elastica> blades,
                                                std::span<const double> loads, const StiffnessRatios& ratios,
                                                Simd simd = best_simd());

}  // namespace hotblade::elastica
