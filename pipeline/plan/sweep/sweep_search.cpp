#include "pipeline/plan/sweep/sweep_search.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <utility>

#include "pipeline/plan/direction/body_axes.hpp"
#include "pipeline/plan/sweep/sweep_strip.hpp"
#include "robot/blade/blade_section.hpp"

namespace hotblade::pipeline {

namespace {

using Eigen::Vector3d;

constexpr double kInfinite = std::numeric_limits<double>::infinity();

// How a direction is split.
struct Parts {
  std::size_t along_sweep = 1, along_ribs = 1;
  // Widths of the parts along the sweep and along the ribs, sum 1; empty: even ones.
  std::vector<double> sweep_shares = {}, rib_shares = {};
  [[nodiscard]] std::size_t count() const { return along_sweep * along_ribs; }
};

// What a fit costs and how close it is.
struct Effort {
  int coefficients, sections;
  double sample_mm;
  std::vector<double> exponents;
  int most_iterations;
};

const Effort& cheap() {
  static const Effort effort{5, 10, 45, {2, 8}, 15};
  return effort;
}
const Effort& close() {
  static const Effort effort{7, 16, 35, {2, 8}, 15};
  return effort;
}
Effort final_effort(int coefficients) {
  return {coefficients, coefficients > 10 ? 48 : 40, 20, {2, 4, 8, 16}, 20};
}

// A fit, what weight moves the cut where the design is steepest, and how stable its blade is.
struct PartFit : SweepFitReport {
  double sag_mm = 0, margin = 0;
  std::shared_ptr<const SweepSag> formed_by;  // what the fitted sections were moved by; none: weightless
  std::shared_ptr<const SweepSag> sag;        // of the fit itself
};

// One direction and split, with a fit of each part.
struct Candidate {
  Vector3d normal{0, 0, 0};
  std::size_t named = 0;  // place among the directions: decides between equals
  Parts parts;
  std::vector<SweepWindow> windows;
  std::vector<PartFit> fits;
  double deviation_mm = kInfinite;  // with what its blade's limits are missed by
};

// +1 where the waste lies on the faces' front, -1 behind them; 0 where the design is upright and `keep` says
// nothing about it.
double waste_side(const surface::TriangleMesh& mesh, Keep keep) {
  if (keep == Keep::kBack) return 1;
  if (keep == Keep::kFront) return -1;
  constexpr double kLeastLean = 0.1;
  double up = 0, area = 0;
  for (const auto& t : mesh.triangles()) {
    const auto at = [&](std::size_t i) -> const Vector3d& {
      return mesh.vertices()[static_cast<std::size_t>(t[i])];
    };
    const Vector3d normal = (at(1) - at(0)).cross(at(2) - at(0));
    up += normal.z();
    area += normal.norm();
  }
  if (!(std::abs(up) >= kLeastLean * area)) return 0;
  return (keep == Keep::kBelow) == (up > 0) ? 1 : -1;
}

class Search {
 public:
  Search(const surface::DesignSurface& design, double waste_side, const Settings& settings,
         const WatchSweeps& watch)
      : mesh_(design.mesh),
        settings_(settings),
        watch_(watch),
        surface_(waste_surface(design.mesh, waste_side)) {}

  void run(const AcceptSweep& accept) {
    constexpr std::size_t kMostParts = 4, kMostTries = 3;
    const std::vector<Vector3d> normals = directions();
    std::size_t tries = 0;
    for (std::size_t parts = 1; parts <= kMostParts && tries < kMostTries; ++parts) {
      share_ = static_cast<double>(parts - 1) / kMostParts;
      const std::vector<Candidate> near = refined(rank(normals, parts));
      for (const Candidate& candidate : near) {
        const SweptPlan plan = plan_of(candidate);
        if (accept(plan)) return;
      }
      tries += near.empty() ? 0 : 1;
    }
  }

 private:
  [[nodiscard]] double tolerance() const { return settings_.design.tolerance_mm; }

  [[nodiscard]] std::vector<Vector3d> directions() const {
    if (settings_.slice.direction) {
      const auto& d = *settings_.slice.direction;
      return {Vector3d(d[0], d[1], d[2]).normalized()};
    }
    const BodyAxes body = body_axes(mesh_);
    std::vector<Vector3d> all = along_borders(mesh_, body);
    if (const auto n = least_steep(mesh_)) all.push_back(*n);
    for (const Vector3d& n : hemisphere(body)) all.push_back(n);
    std::vector<Vector3d> apart;
    constexpr double kSame = 0.9986;  // within 3 degrees
    for (const Vector3d& n : all) {
      const bool known = std::any_of(apart.begin(), apart.end(),
                                     [&](const Vector3d& m) { return std::abs(m.dot(n)) > kSame; });
      if (!known) apart.push_back(with_sense(mesh_, body, n));
    }
    return apart;
  }

  [[nodiscard]] SweepFrame frame_of(const Vector3d& normal) const {
    return sweep_frame(surface_, normal, surface::parallel_about(mesh_, normal).centre());
  }

  // Along the sweep and along x.
  using Extent = Eigen::AlignedBox<double, 2>;
  [[nodiscard]] Extent extent_of(const Vector3d& normal) const {
    const SweepFrame frame = frame_of(normal);
    Extent box;
    for (const Vector3d& p : surface_.points) {
      const Vector3d d = p - frame.centre;
      box.extend(Eigen::Vector2d(d.dot(frame.sweep), d.dot(frame.x)));
    }
    return box;
  }

  // Whether parts may be small enough for the blocks and blades there are.
  [[nodiscard]] bool may_fit(const Extent& extent, const Parts& parts) const {
    const auto& stock = settings_.stock.max_size_mm;
    const double edge = *std::max_element(stock.begin(), stock.end()) - 2 * settings_.stock.border_mm;
    const double rib = settings_.blade.free_lengths_mm.back() - 2 * clear_mm();
    const Eigen::Vector2d size = extent.sizes();
    const double piece = std::min(edge, rib);
    // Splits beyond those that the length asks for are the user's to allow.
    const double least = std::ceil(size.y() / piece);
    return piece > 0 && size.x() <= edge * static_cast<double>(parts.along_sweep) &&
           size.y() <= piece * static_cast<double>(parts.along_ribs) &&
           static_cast<double>(parts.along_ribs) <= least + settings_.fit.max_splits;
  }

  // The windows of the parts of the design's extent.
  [[nodiscard]] std::vector<SweepWindow> windows_of(const Vector3d& normal, const Parts& parts) const {
    if (parts.count() == 1) return {SweepWindow{}};
    const Extent box = extent_of(normal);
    const auto cuts = [&](Eigen::Index axis, const std::vector<double>& shares) {
      std::vector<double> at{-kInfinite};
      double passed = 0;
      for (std::size_t i = 0; i + 1 < shares.size(); ++i) {
        passed += shares[i];
        at.push_back(box.min()[axis] + passed * box.sizes()[axis]);
      }
      at.push_back(kInfinite);
      return at;
    };
    const std::vector<double> along = cuts(0, shares_of(parts.sweep_shares, parts.along_sweep)),
                              across = cuts(1, shares_of(parts.rib_shares, parts.along_ribs));
    std::vector<SweepWindow> windows;
    for (std::size_t s = 0; s < parts.along_sweep; ++s) {
      for (std::size_t r = 0; r < parts.along_ribs; ++r)
        windows.push_back({along[s], along[s + 1], across[r], across[r + 1]});
    }
    return windows;
  }

  static std::vector<double> shares_of(const std::vector<double>& shares, std::size_t parts) {
    return shares.empty() ? std::vector<double>(parts, 1 / static_cast<double>(parts)) : shares;
  }

  // Parts that are hard to follow made narrower and the others wider, as long as that helps the worst.
  [[nodiscard]] Candidate balanced(Candidate best) const {
    constexpr int kRounds = 5;
    constexpr double kBy = 0.3;  // a family's deviation grows with about the cube of its width
    if (best.parts.count() == 1 || !std::isfinite(best.deviation_mm)) return best;
    for (int round = 0; round < kRounds; ++round) {
      Parts parts = best.parts;
      std::vector<double> along(parts.along_sweep, 0), across(parts.along_ribs, 0);
      for (std::size_t i = 0; i < best.fits.size(); ++i) {
        const double bad = std::max(badness(best.fits[i]), 1e-3 * best.deviation_mm);
        double& s = along[i / parts.along_ribs];
        double& r = across[i % parts.along_ribs];
        s = std::max(s, bad);
        r = std::max(r, bad);
      }
      const auto narrowed = [&](const std::vector<double>& before, const std::vector<double>& bad) {
        std::vector<double> shares = shares_of(before, bad.size());
        double sum = 0;
        for (std::size_t i = 0; i < bad.size(); ++i) sum += shares[i] *= std::pow(bad[i], -kBy);
        for (double& share : shares) share /= sum;
        return shares;
      };
      parts.sweep_shares = narrowed(parts.sweep_shares, along);
      parts.rib_shares = narrowed(parts.rib_shares, across);
      Candidate other = fitted(best.normal, best.named, parts, cheap());
      if (!(other.deviation_mm < best.deviation_mm)) return best;
      best = std::move(other);
    }
    return best;
  }

  // Foam between a rib's end and its clamp, and a little more.
  [[nodiscard]] double clear_mm() const {
    constexpr double kReserve = 1.05, kMoreMm = 1;
    return settings_.stock.border_mm + kReserve * settings_.stock.clearance_mm + kMoreMm;
  }

  // The shortest blade that reaches over ribs of this length; 0: none does.
  [[nodiscard]] double blade_for(double rib_mm) const {
    for (const double length : settings_.blade.free_lengths_mm) {
      if (length >= rib_mm + 2 * clear_mm()) return length;
    }
    return 0;
  }

  [[nodiscard]] bool block_fits(const SweepData& data) const {
    const StockSettings& stock = settings_.stock;
    const Vector3d more(2 * stock.border_mm, stock.base_mm + stock.border_mm, 2 * stock.border_mm + kOverMm);
    Vector3d size = data.high - data.low + more,
             most(stock.max_size_mm[0], stock.max_size_mm[1], stock.max_size_mm[2]);
    std::sort(size.begin(), size.end());
    std::sort(most.begin(), most.end());
    return (size.array() <= most.array()).all();
  }

  // Nothing where no blade of the list or no block can serve.
  [[nodiscard]] std::optional<PartFit> fit_part(const SweepFrame& frame, const SweepWindow& window,
                                                const Effort& effort, const PartFit* start,
                                                double calm) const {
    watch_(share_);
    const std::shared_ptr<const SweepSag> formed_by = start && start->sag->stable() ? start->sag : nullptr;
    const SweepData data = sweep_sections(
        surface_, frame,
        section_options(settings_, window, effort.sections, effort.sample_mm, formed_by.get()));
    if (data.sections.empty() || data.steepest_rad > kMaxSlopeRad || !block_fits(data)) return std::nullopt;
    SweepFitOptions options;
    options.coefficients = effort.coefficients;
    options.exponents = effort.exponents;
    options.most_iterations = effort.most_iterations;
    options.over_first_mm = std::isfinite(window.first_mm) ? 0 : 0.5 * kOverMm;
    options.over_last_mm = std::isfinite(window.last_mm) ? 0 : 0.5 * kOverMm;
    options.calm = calm;
    constexpr double kRadiusReserve = 1.06;
    options.smallest_radius_mm = kRadiusReserve / max_curvature_per_mm(settings_.blade);
    const Eigen::Vector2d around(clear_mm(), clear_mm());
    options.block = SweepFitOptions::Box{
        data.low.head<2>() - around - Eigen::Vector2d(0, settings_.stock.base_mm - settings_.stock.border_mm),
        data.high.head<2>() + around};
    // The rib's length is not known before it is fitted: its width first, then what the fit says.
    double rib = start ? rib_length(*start) : data.high.x() - data.low.x();
    constexpr int kLooks = 4;
    constexpr double kDeep_mm = 1;  // a clamp in the block's clearance that the fit could not get out
    std::optional<PartFit> fit;
    for (int look = 0; look < kLooks; ++look) {
      const double blade = blade_for(rib);
      if (blade == 0) return std::nullopt;
      if (fit && blade <= options.blade_length_mm) break;
      options.blade_length_mm = blade;
      const std::optional<SweepFamily> from = fit     ? std::optional(fit->family)
                                              : start ? std::optional(start->family)
                                                      : std::nullopt;
      fit.emplace();
      static_cast<SweepFitReport&>(*fit) = fit_sweep(data, options, from ? &*from : nullptr);
      rib = rib_length(*fit);
      // Ends that leave the block steeply are longer.
      if (fit->clamp_depth_mm > kDeep_mm && blade < settings_.blade.free_lengths_mm.back())
        rib = std::max(rib, blade - 2 * clear_mm() + 1);
    }
    fit->formed_by = formed_by;
    weigh(*fit, {options.blade_length_mm, 0.5 * options.blade_length_mm}, data.steepest_rad);
    return fit;
  }

  // Sag and margin of a strip whose planes lie level.
  void weigh(PartFit& fit, const SweepBlade& blade, double steepest_rad) const {
    fit.sag = std::make_shared<SweepSag>(fit.family, blade, settings_.blade);
    fit.margin = fit.sag->smallest_margin();
    fit.sag_mm = fit.sag->moved_mm(fit.arc_low_mm, fit.arc_high_mm, steepest_rad);
  }

  static double rib_length(const SweepFitReport& fit) {
    return 2 * std::max(-fit.arc_low_mm, fit.arc_high_mm);
  }

  // How bad a fit is: its deviation, what of its sag is not known, and how far its blade misses its limits.
  [[nodiscard]] double badness(const PartFit& fit) const {
    constexpr double kPerMm = 0.1, kUnstable = 2;  // the latter in tolerances: a split may well cure it
    const bool stable = std::isfinite(fit.sag_mm) && fit.margin >= settings_.blade.min_margin;
    const double sag = stable ? robot::kSagUnknownShare * fit.sag_mm : kUnstable * tolerance();
    const double sharp = 1 - fit.smallest_radius_mm * max_curvature_per_mm(settings_.blade);
    return fit.max_mm + sag + kPerMm * fit.clamp_depth_mm + 100 * std::max(0.0, sharp);
  }

  [[nodiscard]] Candidate fitted(const Vector3d& normal, std::size_t named, const Parts& parts,
                                 const Effort& effort, double calm = 1,
                                 const Candidate* start = nullptr) const {
    Candidate candidate{normal, named, parts, windows_of(normal, parts), {}, kInfinite};
    const SweepFrame frame = frame_of(normal);
    double worst = 0;
    for (std::size_t i = 0; i < candidate.windows.size(); ++i) {
      const auto fit = fit_part(frame, candidate.windows[i], effort, start ? &start->fits[i] : nullptr, calm);
      if (!fit) return candidate;
      worst = std::max(worst, badness(*fit));
      candidate.fits.push_back(*fit);
    }
    candidate.deviation_mm = worst;
    return candidate;
  }

  // All directions and the ways to split them into so many parts, the best first.
  [[nodiscard]] std::vector<Candidate> rank(const std::vector<Vector3d>& normals, std::size_t parts) const {
    std::vector<Parts> splits;
    for (std::size_t s = 1; s <= parts; ++s) {
      if (parts % s == 0) splits.push_back({s, parts / s, {}, {}});
    }
    std::vector<Candidate> all(normals.size() * splits.size());
    tbb::parallel_for(std::size_t{0}, normals.size(), [&](std::size_t n) {
      const Extent extent = extent_of(normals[n]);
      for (std::size_t k = 0; k < splits.size(); ++k) {
        const std::size_t i = n * splits.size() + k;
        if (may_fit(extent, splits[k])) all[i] = fitted(normals[n], i, splits[k], cheap());
      }
    });
    std::sort(all.begin(), all.end(), better);
    constexpr std::size_t kBalanced = 6;
    tbb::parallel_for(std::size_t{0}, std::min(kBalanced, all.size()),
                      [&](std::size_t i) { all[i] = balanced(all[i]); });
    std::sort(all.begin(), all.end(), better);
    return all;
  }

  static bool better(const Candidate& a, const Candidate& b) {
    return std::pair(a.deviation_mm, a.named) < std::pair(b.deviation_mm, b.named);
  }

  // The best few with more coefficients, and turned to and fro; none where cheap fits are hopelessly far off.
  [[nodiscard]] std::vector<Candidate> refined(const std::vector<Candidate>& ranked) const {
    constexpr std::size_t kBest = 3;
    constexpr double kNear = 4;  // tolerances that a cheap fit comes down by at most
    std::vector<Candidate> best;
    for (const Candidate& c : ranked) {
      if (best.size() < kBest && c.deviation_mm <= kNear * tolerance()) best.push_back(c);
    }
    tbb::parallel_for(std::size_t{0}, best.size(), [&](std::size_t i) { best[i] = turned(best[i]); });
    constexpr double kHopeful = 1.5;  // tolerances
    std::erase_if(best, [&](const Candidate& c) { return !(c.deviation_mm <= kHopeful * tolerance()); });
    std::sort(best.begin(), best.end(), better);
    return best;
  }

  // Small turns of the planes about both axes across, smaller and smaller ones, as long as they help.
  [[nodiscard]] Candidate turned(const Candidate& from) const {
    Candidate best = fitted(from.normal, from.named, from.parts, close(), 1, &from);
    if (!std::isfinite(best.deviation_mm)) return from;
    if (settings_.slice.direction) return best;
    for (const double degrees : {6.0, 3.0, 1.5}) {
      const Vector3d middle = best.normal, u = frame_of(middle).x, v = frame_of(middle).y;
      for (const Vector3d& axis : {u, v}) {
        for (const double side : {-1.0, 1.0}) {
          const Vector3d n = Eigen::AngleAxisd(side * degrees * std::numbers::pi / 180, axis) * middle;
          Candidate other = fitted(n, from.named, from.parts, close(), 1, &best);
          if (other.deviation_mm < best.deviation_mm) best = std::move(other);
        }
      }
    }
    return best;
  }

  // Closer and closer fits with more and more ribs, as long as these help; calmer ones where the blade does
  // not serve.
  [[nodiscard]] SweptPlan plan_of(const Candidate& candidate) const {
    // Of what one rib may deviate: edges, corners and what lies between samples have the rest.
    constexpr double kWanted = 0.5;
    constexpr double kHelps = 0.8;  // of the deviation before
    SweptPlan best{
        candidate.normal, candidate.parts.along_sweep, candidate.parts.along_ribs, kInfinite, 0, {}, {}};
    for (const double calm : {1.0, 6.0}) {
      Candidate fit = candidate;
      for (const int coefficients : {5, 7, 10, 14}) {
        const Effort effort = final_effort(coefficients);
        fit = fitted(candidate.normal, candidate.named, candidate.parts, effort, calm, &fit);
        if (!std::isfinite(fit.deviation_mm)) break;
        SweptPlan plan = strips_of(fit, effort, calm);
        const double before = best.strips.empty() ? kInfinite : best.deviation_mm;
        if (plan.strips.empty() && best.strips.empty() && !(plan.deviation_mm > best.deviation_mm))
          best = plan;
        if (!plan.strips.empty() && plan.deviation_mm < kHelps * before) best = std::move(plan);
        if (best.strips.empty()) continue;
        if (best.deviation_mm <= kWanted * settings_.fit.deviation_share * tolerance()) return best;
      }
      if (!best.strips.empty()) return best;
    }
    return best;
  }

  // A strip whose blade is not the one that its sections were moved for is fitted once more.
  [[nodiscard]] SweptStrip strip_of(const surface::PlaneFamily& planes, const SweepWindow& window,
                                    const Effort& effort, double calm, PartFit& fit) const {
    constexpr int kLooks = 3;
    constexpr double kSameBladeMm = 5;
    SweptStrip made;
    for (int look = 0; look < kLooks; ++look) {
      made = make_swept_strip(surface_, planes, window, fit, fit.formed_by.get(), settings_);
      if (!made.strip) return made;
      const SweepBlade was = fit.formed_by ? fit.formed_by->blade() : SweepBlade{};
      if (std::abs(was.length_mm - made.blade.length_mm) <= kSameBladeMm &&
          std::abs(was.before_mm - made.blade.before_mm) <= kSameBladeMm)
        return made;
      PartFit start = fit;
      start.sag = std::make_shared<SweepSag>(fit.family, made.blade, settings_.blade);
      const auto again = fit_part(frame_of(planes.normal(0)), window, effort, &start, calm);
      if (!again) return made;
      fit = *again;
    }
    return made;
  }

  [[nodiscard]] SweptPlan strips_of(const Candidate& fitted, const Effort& effort, double calm) const {
    SweptPlan plan{fitted.normal, fitted.parts.along_sweep, fitted.parts.along_ribs, 0, 0, {}, {}};
    const surface::PlaneFamily planes = surface::parallel_about(mesh_, fitted.normal);
    for (std::size_t i = 0; i < fitted.fits.size(); ++i) {
      PartFit fit = fitted.fits[i];
      SweptStrip made = strip_of(planes, fitted.windows[i], effort, calm, fit);
      plan.deviation_mm = std::max(plan.deviation_mm, fit.max_mm);
      plan.sag_mm = std::max(plan.sag_mm, fit.sag_mm);
      if (!made.strip) {
        plan.refusal = made.refusal;
        plan.refusal->strip = fmt::format("S{:03}", i + 1);
        plan.strips.clear();
        return plan;
      }
      made.strip->id = fmt::format("S{:03}", i + 1);
      plan.strips.push_back(std::move(*made.strip));
    }
    return plan;
  }

  static constexpr double kOverMm = 8;  // of a family beyond the design, both ends together

  const surface::TriangleMesh& mesh_;
  const Settings& settings_;
  const WatchSweeps& watch_;
  WasteSurface surface_;
  double share_ = 0;  // of the search that is done
};

}  // namespace

void search_sweeps(const surface::DesignSurface& design, const Settings& settings, const AcceptSweep& accept,
                   const WatchSweeps& watch) {
  const double side = waste_side(design.mesh, settings.design.keep);
  if (side != 0) Search(design, side, settings, watch).run(accept);
}

}  // namespace hotblade::pipeline
