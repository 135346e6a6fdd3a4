#include "pipeline/plan/sweep/sweep_strip.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "elastica/fit/even_points.hpp"
#include "gpu/backend/stop.hpp"
#include "pipeline/plan/motion/blade.hpp"
#include "pipeline/plan/motion/strip_block.hpp"
#include "pipeline/plan/sweep/moved_surface.hpp"
#include "pipeline/plan/sweep/sweep_block.hpp"
#include "robot/blade/blade_section.hpp"
#include "surface/read/blocks.hpp"

namespace hotblade::pipeline {

namespace {

using Eigen::Vector2d;

// What a strip forms goes on past the design's border by this much, to cut right through it; its ribs by
// twice as much.
constexpr double kBeyondMm = 5;

// A sample and where along the rib it lies.
struct Foot {
  double s_mm = 0;
  Vector2d q{0, 0};
  double away_mm = 0;
  bool at_seam = false;
};

// A point of a section in the axes of the family's curve there.
Vector2d in_curve(const Vector2d& q, const SweepFamily& family, const SweepState& state) {
  const double c = std::cos(state.theta), n = std::sin(state.theta);
  const Vector2d d = q - Vector2d(family.x_mm, state.y);
  return {c * d.x() + n * d.y(), -n * d.x() + c * d.y()};
}

// The feet of a section's samples on the family's curve there, ascending. They are sought from the middle
// outwards, each from the last one's: where a section turns up steeply, x says little of a place on it.
std::vector<Foot> feet_of(const SweepSection& section, const SweepFamily& family, const SweepState& state,
                          const SweepCurve& curve) {
  std::vector<Vector2d> own;
  for (const SweepSample& sample : section.samples) own.push_back(in_curve(sample.q, family, state));
  const auto middle =
      std::partition_point(section.samples.begin(), section.samples.end(),
                           [&](const SweepSample& sample) { return sample.q.x() < family.x_mm; });
  const auto from = middle - section.samples.begin(), count = std::ssize(own);
  std::vector<Foot> feet;
  const auto seek = [&](std::ptrdiff_t i, std::ptrdiff_t beside) {
    const auto at = static_cast<std::size_t>(i);
    const Vector2d& q = own[at];
    double guess = q.x();
    if (!feet.empty() && beside >= 0 && beside < count && beside != i) {
      const double way = (q - own[static_cast<std::size_t>(beside)]).norm();
      guess = feet.back().s_mm + (i > beside ? way : -way);
    }
    const double s = curve.nearest(q, guess);
    feet.push_back(
        {s, section.samples[at].q, (q - curve.at(s).position).norm(), section.samples[at].at_seam});
  };
  for (std::ptrdiff_t i = from; i < count; ++i) seek(i, i > from ? i - 1 : i);
  const std::vector<Foot> upper = std::exchange(feet, {});
  for (std::ptrdiff_t i = from - 1; i >= 0; --i) seek(i, i + 1 < from ? i + 1 : i);
  feet.insert(feet.end(), upper.begin(), upper.end());
  std::sort(feet.begin(), feet.end(), [](const Foot& a, const Foot& b) { return a.s_mm < b.s_mm; });
  return feet;
}

// Where the feet of lone points lie, each on the curve at its own offset.
std::vector<double> feet_of(std::span<const std::pair<double, Vector2d>> points, const SweepFamily& family,
                            double reach_mm) {
  std::vector<double> feet(points.size());
  // Nothing but a few lanes' worth is won by more at once.
  constexpr std::size_t kAtOnce = 64;
  surface::for_blocks(points.size(), kAtOnce, [&](std::size_t first, std::size_t last) {
    gpu::stop_point();
    std::vector<SweepCurve::Ask> asked;
    std::vector<Vector2d> own;
    for (std::size_t i = first; i < last; ++i) {
      const SweepState state = family.at(points[i].first);
      own.push_back(in_curve(points[i].second, family, state));
      asked.push_back({state.bend, reach_mm, own.back().x()});
    }
    const std::vector<SweepCurve> curves = SweepCurve::all(asked);
    for (std::size_t k = 0; k < own.size(); ++k) {
      double& foot = feet[first + k];
      foot = curves[k].nearest(own[k], own[k].x());
      if (curves[k].is_open_at(foot)) foot = SweepCurve(asked[k].bend, reach_mm).nearest(own[k], own[k].x());
    }
  });
  return feet;
}

// Between samples along a section, in mm.
constexpr double kSampleMm = 10;

// Evenly spaced by arc length along the polyline through the feet, and along the rib where the design has a
// hole: there any chord would do, and count as a deviation. The rib's middle is where feet have s = 0.
std::vector<Vector2d> target_of(const std::vector<Foot>& feet, const elastica::Elastica& rib) {
  // Samples are farther apart where a section is steep, up to kMaxSlopeRad.
  constexpr double kHoleMm = 2.5 * kSampleMm;
  std::vector<Vector2d> line;
  for (std::size_t i = 0; i < feet.size(); ++i) {
    const double hole = i > 0 ? feet[i].s_mm - feet[i - 1].s_mm : 0;
    const int steps = hole > kHoleMm ? static_cast<int>(std::ceil(hole / kSampleMm)) : 0;
    for (int k = 1; k < steps; ++k)
      line.push_back(point_at(rib, 0.5 * rib.length + feet[i - 1].s_mm + hole * k / steps).position());
    if (line.empty() || feet[i].q != line.back()) line.push_back(feet[i].q);
  }
  if (line.size() < 2) return {};
  return elastica::evenly_spaced(line, kRibSamples);
}

class StripMaker {
 public:
  StripMaker(const MovedSurface& moved, const SweepFitReport& fit, double least_blade_mm,
             const Settings& settings)
      : moved_(moved), axes_(moved.axes()), fit_(fit), least_blade_mm_(least_blade_mm), settings_(settings) {}

  SweptStrip run() {
    SweptStrip made;
    const double left = settings_.design.tolerance_mm - fit_.max_mm;
    if (!(left > 0)) {
      made.refusal = {"", "", Limit::kDeviation, fit_.max_mm, settings_.design.tolerance_mm};
      return made;
    }
    gather();
    std::vector<RibFit> ribs = make_ribs();
    enclose(ribs);
    // What the fit leaves of the tolerance may be used up by what of the sag is not known; in a fan, where
    // nothing is moved against it, by all of it as well.
    const double sag = left / (robot::kSagUnknownShare + (axes_.planes.turns() ? 1 : 0));
    const RibAxes& axes = axes_;
    const BladeReport blade =
        choose_blade(ribs, axes, block_around(ribs, axes, settings_.stock), settings_, sag, least_blade_mm_);
    if (!blade.choice) {
      made.refusal = blade.refusal;
      return made;
    }
    StripPlan strip = make_strip_plan(axes, ribs, *blade.choice, settings_);
    strip.formed = formed();
    strip.on_mm = way_on_mm(strip, settings_.blade.width_mm, kOverMm);
    if (!fits_stock(strip, settings_)) {
      made.refusal = {
          "", "", Limit::kBlockEdge, strip.block.size_mm.maxCoeff(),
          *std::max_element(settings_.stock.max_size_mm.begin(), settings_.stock.max_size_mm.end())};
      return made;
    }
    made.blade = {strip.blade_length_mm,
                  0.5 * length_mm_ + strip.share_a * (strip.blade_length_mm - length_mm_)};
    made.strip = std::move(strip);
    return made;
  }

 private:
  [[nodiscard]] double rib_offset(int rib) const {
    const SweepFamily& f = fit_.family;
    return f.first_mm + (f.last_mm - f.first_mm) * rib / (rib_count() - 1);
  }

  // As many as the family has coefficients, or more where they shall be closer.
  [[nodiscard]] int rib_count() const {
    const double most = settings_.slice.spacing_mm, extent = fit_.family.last_mm - fit_.family.first_mm;
    return std::max(fit_.family.count(), most > 0 ? 1 + static_cast<int>(std::ceil(extent / most)) : 0);
  }

  [[nodiscard]] DesignPart part_of(double low_mm, double high_mm) const {
    return {0.5 + low_mm / length_mm_, 0.5 + high_mm / length_mm_};
  }

  // Feet at the ribs and, close to each other, all along the strip.
  void gather() {
    constexpr int kSections = 64;
    SweepSectionOptions options = section_options(settings_, {}, kSections, kSampleMm, nullptr, nullptr);
    for (int i = 0; i < rib_count(); ++i) options.extra_mm.push_back(rib_offset(i));
    const SweepData data = sweep_sections(moved_, options);
    const double longest = settings_.blade.free_lengths_mm.back();
    feet_.resize(data.sections.size());
    slopes_.resize(data.sections.size());
    constexpr std::size_t kSectionsAtOnce = 8;
    surface::for_blocks(feet_.size(), kSectionsAtOnce, [&](std::size_t first, std::size_t last) {
      gpu::stop_point();
      std::vector<SweepState> states;
      std::vector<SweepCurve::Ask> asked;
      for (std::size_t k = first; k < last; ++k) {
        states.push_back(fit_.family.at(data.sections[k].offset_mm));
        asked.push_back({states.back().bend, longest});
      }
      const std::vector<SweepCurve> curves = SweepCurve::all(asked);
      for (std::size_t k = first; k < last; ++k) {
        const SweepSection& section = data.sections[k];
        feet_[k] = feet_of(section, fit_.family, states[k - first], curves[k - first]);
        double least = 1;
        for (const SweepSample& sample : section.samples) least = std::min(least, sample.cosine);
        slopes_[k] = std::acos(least);
      }
    });
    double reach = 0;
    for (std::size_t k = 0; k < feet_.size(); ++k) {
      reach = std::max({reach, -feet_[k].front().s_mm, feet_[k].back().s_mm});
      offsets_.push_back(data.sections[k].offset_mm);
    }
    const std::vector<double> border = feet_of(data.border, fit_.family, longest);
    for (std::size_t i = 0; i < border.size(); ++i) {
      border_.emplace_back(data.border[i].first, border[i]);
      reach = std::max(reach, std::abs(border[i]));
    }
    length_mm_ = 2 * (reach + 2 * kBeyondMm);
  }

  // The section nearest to an offset.
  [[nodiscard]] std::size_t nearest(double offset_mm) const {
    const auto above = std::lower_bound(offsets_.begin(), offsets_.end(), offset_mm);
    const auto k = static_cast<std::size_t>(above - offsets_.begin());
    if (k == offsets_.size()) return k - 1;
    return k > 0 && offset_mm - offsets_[k - 1] < offsets_[k] - offset_mm ? k - 1 : k;
  }

  [[nodiscard]] RibFit make_rib(double offset_mm) const {
    constexpr double kSamePlaneMm = 1e-6;
    RibFit rib;
    rib.offset_mm = offset_mm;
    rib.elastica = from_mid_state(fit_.family.mid_state(offset_mm, length_mm_));
    for (const elastica::CurvePoint& p : sample(rib.elastica, kRibSamples))
      rib.course.push_back(p.position());
    const std::size_t k = nearest(offset_mm);
    rib.max_slope_rad = slopes_[k];
    rib.own = {0.5, 0.5};
    if (std::abs(offsets_[k] - offset_mm) <= kSamePlaneMm) {
      rib.target = target_of(feet_[k], rib.elastica);
      if (!rib.target.empty()) rib.own = part_of(feet_[k].front().s_mm, feet_[k].back().s_mm);
      for (const Foot& foot : feet_[k]) rib.deviation_mm = std::max(rib.deviation_mm, foot.away_mm);
    }
    give_bezier(rib, rib.course, settings_.fit);
    rib.converged = fit_.converged;
    return rib;
  }

  [[nodiscard]] std::vector<RibFit> make_ribs() const {
    std::vector<RibFit> ribs(static_cast<std::size_t>(rib_count()));
    surface::for_blocks(ribs.size(), 1, [&](std::size_t i, std::size_t) {
      gpu::stop_point();
      ribs[i] = make_rib(rib_offset(static_cast<int>(i)));
    });
    return ribs;
  }

  // The block holds all sections, each with the rib next to it, and the first and last with the end ribs.
  void enclose(std::vector<RibFit>& ribs) const {
    for (std::size_t k = 0; k < feet_.size(); ++k) {
      std::size_t r = 0;
      while (r + 1 < ribs.size() &&
             std::abs(ribs[r + 1].offset_mm - offsets_[k]) < std::abs(ribs[r].offset_mm - offsets_[k]))
        ++r;
      if (k == 0) r = 0;
      if (k + 1 == feet_.size()) r = ribs.size() - 1;
      for (const Foot& foot : feet_[k]) ribs[r].beside.push_back(foot.q);
    }
  }

  // A few places stand for all sections around them: where what is formed changed faster than the blade
  // moves, as at the tip of a round border, the surface between two poses would be all askew.
  [[nodiscard]] std::vector<FormedPart> formed() const {
    constexpr int kPlaces = 16;
    constexpr double kLeastStepMm = 15;
    const double extent = offsets_.back() - offsets_.front();
    const int places = std::clamp(static_cast<int>(extent / kLeastStepMm), 1, kPlaces);
    std::vector<FormedPart> parts;
    for (int i = 0; i <= places; ++i) {
      const double offset = offsets_.front() + extent * i / places;
      double low = length_mm_, high = -length_mm_;
      const std::size_t here = nearest(offset);
      for (std::size_t k = 0; k < feet_.size(); ++k) {
        if (std::abs(offsets_[k] - offset) > extent / places) continue;
        for (const Foot& foot : {feet_[k].front(), feet_[k].back()}) {
          // At a seam the design goes on, and the next strip forms it: no more than was looked at here.
          if (foot.at_seam && k != here) continue;
          low = std::min(low, foot.s_mm - (foot.at_seam ? 0 : kBeyondMm));
          high = std::max(high, foot.s_mm + (foot.at_seam ? 0 : kBeyondMm));
        }
      }
      for (const auto& [at, s] : border_) {
        if (std::abs(at - offset) > extent / places) continue;
        low = std::min(low, s - kBeyondMm);
        high = std::max(high, s + kBeyondMm);
      }
      if (high > low) parts.push_back({offset, part_of(low, high)});
    }
    return parts;
  }

  const MovedSurface& moved_;
  const RibAxes& axes_;
  const SweepFitReport& fit_;
  double least_blade_mm_;
  const Settings& settings_;
  std::vector<double> offsets_, slopes_;  // of the sections
  std::vector<std::vector<Foot>> feet_;
  std::vector<std::pair<double, double>> border_;  // its points' offsets and feet
  double length_mm_ = 0;                           // of all ribs
};

}  // namespace

SweepSectionOptions section_options(const Settings& settings, const std::vector<SweepSeam>& seams, int count,
                                    double sample_mm, const SweepSag* sag, const SweptBands* bands) {
  // Before anything is known of speeds, that of the feed.
  const double kerf_mm = settings.blade.band_mm(settings.motion.feed_mm_s);
  SweepSectionOptions options{kerf_mm, settings.blade.width_mm, count, sample_mm, seams, {}, sag, bands};
  // A slit narrower than what the blade melts is cut away anyhow.
  if (settings.slice.gaps == Gaps::kApart) options.gap_mm = kerf_mm;
  options.gap_behind_mm = kSeamOverlapMm;
  for (SweepSeam& seam : options.seams) seam.at_mm += kSeamOverlapMm;
  return options;
}

SweptStrip make_swept_strip(const MovedSurface& moved, const SweepFitReport& fit, double least_blade_mm,
                            const Settings& settings) {
  return StripMaker(moved, fit, least_blade_mm, settings).run();
}

}  // namespace hotblade::pipeline
