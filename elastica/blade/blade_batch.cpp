#include "elastica/blade/blade_batch.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <new>
#include <stdexcept>

#include "elastica/blade/blade_lanes.hpp"
#include "elastica/blade/stability.hpp"
#include "elastica/curve/placement.hpp"

namespace hotblade::elastica {

namespace {

static_assert(kDroopCells == kGravityCells);

const BladeKernels& kernels(Simd simd) {
  if (!supported(simd)) throw std::logic_error("blade batch: instruction set not supported by this machine");
  switch (simd) {
    case Simd::kAvx512:
      return kBladeAvx512;
    case Simd::kAvx2:
      return kBladeAvx2;
    case Simd::kBaseline:
      break;
  }
  return kBladeBaseline;
}

void expect_size(std::size_t n, std::size_t size) {
  if (n != size) throw std::logic_error("blade batch: spans of different sizes");
}

void expect_finite(const Elastica& e) {
  for (const double v : {e.x, e.y, e.theta, e.kappa, e.lambda1, e.lambda2, e.length}) {
    if (!std::isfinite(v)) throw std::logic_error("elastica parameters must be finite");
  }
}

// A few blades at a time: as many as the widest lanes take, and a few times that.
constexpr std::size_t kBlock = 64;
using Block = std::array<double, kBlock>;

// Each thread keeps one: fetched anew for every call its pages would cost as much as the work.
class Scratch {
 public:
  Scratch()
      : doubles_(static_cast<double*>(
            ::operator new (kScratchDoubles * sizeof(double), std::align_val_t{kScratchAlignment}))) {}
  ~Scratch() { ::operator delete (doubles_, std::align_val_t{kScratchAlignment}); }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

  static double* of_this_thread() {
    static thread_local const Scratch scratch;
    return scratch.doubles_;
  }

 private:
  double* doubles_;
};

// Some blades made `unit` long, at the origin along x.
struct UnitBlock {
  Block kappa, lambda1, lambda2, cos, sin;

  void set(std::size_t i, const Elastica& e, double unit) {
    expect_finite(e);
    cos[i] = std::cos(e.theta);
    sin[i] = std::sin(e.theta);
    kappa[i] = e.kappa * unit;
    const Eigen::Vector2d force = force_in_axes(e, cos[i], sin[i]);
    lambda1[i] = force.x() * unit * unit;
    lambda2[i] = force.y() * unit * unit;
  }
  [[nodiscard]] UnitBlades lanes() const { return {kappa.data(), lambda1.data(), lambda2.data()}; }
  [[nodiscard]] double rate(std::size_t i) const { return taylor_rate(0, kappa[i], lambda1[i], lambda2[i]); }
};

// Taylor steps of a blade that ElasticaCurve would refuse are too many.
void expect_evaluable(double rate) {
  if (!(rate <= kStepOmega * ElasticaCurve::kMaxPieces))
    throw std::logic_error("elastica winds too tightly for its length to be evaluated");
}

}  // namespace

void points_at(std::span<const Elastica> blades, std::span<const double> s, std::span<CurvePoint> out,
               Simd simd) {
  expect_size(blades.size(), s.size());
  expect_size(blades.size(), out.size());
  UnitBlock unit;
  Block first, x, y, turn;
  for (std::size_t from = 0; from < blades.size(); from += kBlock) {
    const std::size_t n = std::min(kBlock, blades.size() - from);
    for (std::size_t i = 0; i < n; ++i) {
      const double length = std::abs(s[from + i]);
      unit.set(i, blades[from + i], length);
      expect_evaluable(unit.rate(i));
      first[i] = length > 0 ? s[from + i] / length : 0;
    }
    kernels(simd).parts(
        {unit.lanes(), first.data(), first.data(), 1, x.data(), y.data(), nullptr, nullptr, turn.data()}, n);
    for (std::size_t i = 0; i < n; ++i) {
      const Elastica& e = blades[from + i];
      const double length = std::abs(s[from + i]), dx = length * (unit.cos[i] * x[i] - unit.sin[i] * y[i]),
                   dy = length * (unit.sin[i] * x[i] + unit.cos[i] * y[i]);
      out[from + i] = {e.x + dx, e.y + dy, e.theta + turn[i], e.kappa - e.lambda1 * dy + e.lambda2 * dx};
    }
  }
}

namespace {

// Blocks of blades for sample_parts: calls work(unit, parts' lanes without what they write, lengths, first,
// count).
template <typename Work>
void by_parts(std::span<const Elastica> blades, std::span<const Part> parts, std::size_t points,
              const Work& work) {
  UnitBlock unit;
  Block first, last, length;
  for (std::size_t from = 0; from < blades.size(); from += kBlock) {
    const std::size_t n = std::min(kBlock, blades.size() - from);
    for (std::size_t i = 0; i < n; ++i) {
      const Part& part = parts[from + i];
      length[i] = std::max(std::abs(part.first), std::abs(part.last));
      unit.set(i, blades[from + i], length[i]);
      expect_evaluable(unit.rate(i));
      first[i] = length[i] > 0 ? part.first / length[i] : 0;
      last[i] = length[i] > 0 ? part.last / length[i] : 0;
    }
    work(unit, PartLanes{unit.lanes(), first.data(), last.data(), points}, length, from, n);
  }
}

void expect_points(std::size_t blades, std::size_t parts, std::size_t points) {
  expect_size(blades, parts);
  if (points < 2) throw std::logic_error("a part needs at least 2 points");
}

}  // namespace

PartPlaces sample_places(std::span<const Elastica> blades, std::span<const Part> parts, std::size_t points,
                         Simd simd) {
  expect_points(blades.size(), parts.size(), points);
  PartPlaces all;
  all.points = points;
  all.x.resize(blades.size() * points);
  all.y.resize(blades.size() * points);
  by_parts(blades, parts, points,
           [&](const UnitBlock& unit, PartLanes lanes, const Block& length, std::size_t from, std::size_t n) {
             lanes.x = &all.x[from * points];
             lanes.y = &all.y[from * points];
             kernels(simd).parts(lanes, n);
             for (std::size_t i = 0; i < n; ++i) {
               const Elastica& e = blades[from + i];
               const double co = unit.cos[i], si = unit.sin[i];
               for (std::size_t k = (from + i) * points; k < (from + i + 1) * points; ++k) {
                 const double x = all.x[k], y = all.y[k];
                 all.x[k] = e.x + length[i] * (co * x - si * y);
                 all.y[k] = e.y + length[i] * (si * x + co * y);
               }
             }
           });
  return all;
}

PartPoints sample_parts(std::span<const Elastica> blades, std::span<const Part> parts, std::size_t points,
                        Simd simd) {
  expect_points(blades.size(), parts.size(), points);
  PartPoints all;
  all.points = points;
  for (auto* v : {&all.x, &all.y, &all.cos, &all.sin, &all.turn, &all.curvature})
    v->resize(blades.size() * points);
  by_parts(blades, parts, points,
           [&](const UnitBlock& unit, PartLanes lanes, const Block& length, std::size_t from, std::size_t n) {
             const std::size_t at = from * points;
             lanes.x = &all.x[at];
             lanes.y = &all.y[at];
             lanes.cos = &all.cos[at];
             lanes.sin = &all.sin[at];
             lanes.turn = &all.turn[at];
             kernels(simd).parts(lanes, n);
             for (std::size_t i = 0; i < n; ++i) {
               const Elastica& e = blades[from + i];
               const double co = unit.cos[i], si = unit.sin[i];
               for (std::size_t k = at + i * points; k < at + (i + 1) * points; ++k) {
                 const double x = all.x[k], y = all.y[k], c = all.cos[k], s = all.sin[k];
                 const double dx = length[i] * (co * x - si * y), dy = length[i] * (si * x + co * y);
                 all.x[k] = e.x + dx;
                 all.y[k] = e.y + dy;
                 all.cos[k] = co * c - si * s;
                 all.sin[k] = si * c + co * s;
                 all.curvature[k] = e.kappa - e.lambda1 * dy + e.lambda2 * dx;
               }
             }
           });
  return all;
}

namespace {

// Curvature peaks where the tangent points along the force. So many points cannot hide such a passage: where
// it turns back, the curve has no curvature.
bool shows_peaks(const Elastica& e, std::size_t points) {
  constexpr double kClose = 0.5;
  const double rate = taylor_rate(e.theta, e.kappa, e.lambda1, e.lambda2);
  return rate * e.length <= kClose * static_cast<double>(points - 1);
}

}  // namespace

std::size_t curvature_points(std::span<const Elastica> blades, std::size_t most) {
  std::size_t points = 9;
  for (const Elastica& e : blades) {
    while (points < most && !shows_peaks(e, points)) points = 2 * points - 1;
  }
  return std::min(points, most);
}

double max_abs_curvature(const Elastica& e, const PartPoints& whole, std::size_t i) {
  if (!shows_peaks(e, whole.points)) return ElasticaCurve(e).max_abs_curvature();
  const std::size_t first = i * whole.points, last = first + whole.points - 1;
  const double ends = std::max(std::abs(e.kappa), std::abs(whole.curvature[last]));
  bool left = false, along = false;
  for (std::size_t k = first; k <= last; ++k) {
    const bool is_left = e.lambda1 * whole.sin[k] - e.lambda2 * whole.cos[k] >= 0;
    const bool is_along = e.lambda1 * whole.cos[k] + e.lambda2 * whole.sin[k] > 0;
    if (k > first && is_left != left && is_along && along) {
      const double force = std::hypot(e.lambda1, e.lambda2);
      const double start = e.lambda1 * std::cos(e.theta) + e.lambda2 * std::sin(e.theta);
      return std::max(ends, std::sqrt(e.kappa * e.kappa + 2 * (force - start)));
    }
    left = is_left;
    along = is_along;
  }
  return ends;
}

namespace {

// Calls `set(k, i)` for the blades that the lanes take, the k-th of which is blade i, and `flush(index)` for
// the blades of each block, which are set by then in `unit`; and `alone(i)` for those that wind too tightly.
template <typename Set, typename Alone, typename Flush>
void by_blocks(std::span<const Elastica> blades, UnitBlock& unit, const Set& set, const Alone& alone,
               const Flush& flush) {
  std::array<std::size_t, kBlock> index;
  std::size_t n = 0;
  for (std::size_t i = 0; i < blades.size(); ++i) {
    const Elastica& e = blades[i];
    unit.set(n, e, e.length);
    if (!(e.length > 0) || !(unit.rate(n) <= kBatchRate)) {
      alone(i);
      continue;
    }
    set(n, i);
    index[n] = i;
    if (++n < kBlock) continue;
    flush(std::span<const std::size_t>(index));
    n = 0;
  }
  if (n > 0) flush(std::span<const std::size_t>(index).first(n));
}

}  // namespace

void stability_margins(std::span<const Elastica> blades, std::span<double> out, Simd simd) {
  expect_size(blades.size(), out.size());
  UnitBlock unit;
  Block margin;
  by_blocks(
      blades, unit, [](std::size_t, std::size_t) {},
      [&](std::size_t i) { out[i] = stability_margin(blades[i]); },
      [&](std::span<const std::size_t> index) {
        kernels(simd).margins({unit.lanes(), margin.data(), Scratch::of_this_thread()}, index.size());
        for (std::size_t k = 0; k < index.size(); ++k) out[index[k]] = margin[k];
      });
}

namespace {

DroopReach reach_of(const Elastica& e, const DroopLoad& load, const StiffnessRatios& ratios) {
  const Droop droop = elastica::droop(e, load.load, ratios);
  DroopReach reach{0, 0, droop.stable};
  for (std::size_t k = load.first; k <= load.last; ++k) {
    reach.shift = std::max(reach.shift, std::abs(droop.shift[k]));
    reach.twist = std::max(reach.twist, std::abs(droop.twist[k]));
  }
  return reach;
}

void expect_droop(const Elastica& e, const DroopLoad& load) {
  if (!std::isfinite(load.load)) throw std::logic_error("a load on a blade must be finite");
  if (!(e.length > 0)) throw std::logic_error("a loaded blade needs a length above 0");
  if (load.first > load.last || load.last > kGravityCells) throw std::logic_error("droop: no such nodes");
}

void expect_ratios(const StiffnessRatios& ratios) {
  if (!(ratios.upright > 0) || !(ratios.torsion > 0))
    throw std::logic_error("stiffness ratios of a blade must be positive");
}

// What the lanes of a block are given, and what they say.
struct DroopBlock {
  Block load, first, last, shift, twist, stable;

  void set(std::size_t k, const Elastica& e, const DroopLoad& of) {
    load[k] = of.load * e.length * e.length * e.length;
    first[k] = static_cast<double>(of.first);
    last[k] = static_cast<double>(of.last);
  }
  [[nodiscard]] DroopLanes lanes(const UnitBlock& unit, const StiffnessRatios& ratios) {
    return {unit.lanes(),   load.data(),  first.data(), last.data(),   ratios.upright,
            ratios.torsion, shift.data(), twist.data(), stable.data(), Scratch::of_this_thread()};
  }
};

}  // namespace

void droops(std::span<const Elastica> blades, std::span<const DroopLoad> loads, const StiffnessRatios& ratios,
            std::span<DroopReach> out, Simd simd) {
  expect_size(blades.size(), loads.size());
  expect_size(blades.size(), out.size());
  expect_ratios(ratios);
  for (std::size_t i = 0; i < blades.size(); ++i) expect_droop(blades[i], loads[i]);
  UnitBlock unit;
  DroopBlock block;
  by_blocks(
      blades, unit, [&](std::size_t k, std::size_t i) { block.set(k, blades[i], loads[i]); },
      [&](std::size_t i) { out[i] = reach_of(blades[i], loads[i], ratios); },
      [&](std::span<const std::size_t> index) {
        kernels(simd).droops(block.lanes(unit, ratios), index.size());
        for (std::size_t k = 0; k < index.size(); ++k)
          out[index[k]] = {blades[index[k]].length * block.shift[k], block.twist[k], block.stable[k] > 0};
      });
}

std::vector<PlaneShift> plane_shifts(std::span<const Elastica> blades, std::span<const Eigen::Vector2d> loads,
                                     Simd simd) {
  expect_size(blades.size(), loads.size());
  for (std::size_t i = 0; i < blades.size(); ++i) expect_droop(blades[i], {loads[i].sum()});
  constexpr std::size_t kCells = kGravityCells;
  constexpr double kShare = 1.0 / kGravityCells;
  std::vector<PlaneShift> shifts;
  shifts.reserve(blades.size());
  std::vector<Part> parts;
  std::vector<double> halves;
  std::array<CurvePoint, kBlock> middles;
  for (std::size_t from = 0; from < blades.size(); from += kBlock) {
    const std::span<const Elastica> some = blades.subspan(from, std::min(kBlock, blades.size() - from));
    parts.clear();
    halves.clear();
    for (const Elastica& e : some) {
      parts.push_back({0.5 * kShare * e.length, (1 - 0.5 * kShare) * e.length});
      halves.push_back(0.5 * e.length);
    }
    const PartPoints cells = sample_parts(some, parts, kCells, simd);
    points_at(some, halves, std::span(middles).first(some.size()), simd);
    for (std::size_t i = 0; i < some.size(); ++i) {
      const auto of_blade = [&](const Unset& values) {
        return std::span<const double>(values.begin(), values.end()).subspan(i * kCells, kCells);
      };
      const CellMiddles at{middles[i].theta, of_blade(cells.cos), of_blade(cells.sin),
                           of_blade(cells.curvature)};
      shifts.push_back(plane_shift(some[i], loads[from + i], at));
    }
  }
  return shifts;
}

std::vector<Droop> droop_profiles(std::span<const Elastica> blades, std::span<const double> loads,
                                  const StiffnessRatios& ratios, Simd simd) {
  expect_size(blades.size(), loads.size());
  expect_ratios(ratios);
  for (std::size_t i = 0; i < blades.size(); ++i) expect_droop(blades[i], {loads[i]});
  std::vector<Droop> profiles(blades.size());
  UnitBlock unit;
  DroopBlock block;
  constexpr std::size_t kNodes = kGravityCells;  // but the first, which is clamped
  const auto shifts = std::make_unique_for_overwrite<double[]>(kNodes * kBlock),
             twists = std::make_unique_for_overwrite<double[]>(kNodes * kBlock);
  by_blocks(
      blades, unit, [&](std::size_t k, std::size_t i) { block.set(k, blades[i], {loads[i]}); },
      [&](std::size_t i) { profiles[i] = droop(blades[i], loads[i], ratios); },
      [&](std::span<const std::size_t> index) {
        DroopLanes lanes = block.lanes(unit, ratios);
        lanes.shifts = shifts.get();
        lanes.twists = twists.get();
        lanes.stride = kBlock;
        kernels(simd).droops(lanes, index.size());
        for (std::size_t k = 0; k < index.size(); ++k) {
          Droop& profile = profiles[index[k]];
          const double length = blades[index[k]].length;
          profile.stable = block.stable[k] > 0;
          profile.shift.reserve(kNodes + 1);
          profile.twist.reserve(kNodes + 1);
          profile.shift.push_back(0);
          profile.twist.push_back(0);
          for (std::size_t node = 0; node < kNodes; ++node) {
            profile.shift.push_back(length * shifts[node * kBlock + k]);
            profile.twist.push_back(twists[node * kBlock + k]);
            profile.largest = std::max(profile.largest, std::abs(profile.shift.back()));
            profile.largest_twist = std::max(profile.largest_twist, std::abs(profile.twist.back()));
          }
        }
      });
  return profiles;
}

}  // namespace hotblade::elastica
