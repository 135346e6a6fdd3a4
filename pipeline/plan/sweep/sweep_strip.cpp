#include "pipeline/plan/sweep/sweep_strip.hpp"

#include <algorithm>
#include <cmath>

#include "pipeline/plan/motion/blade.hpp"
#include "pipeline/plan/motion/strip_block.hpp"
#include "pipeline/plan/strips/share_strip.hpp"
#include "robot/blade/blade_section.hpp"

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
};

// The feet of a section's samples on the family's curve there, ascending.
std::vector<Foot> feet_of(const SweepSection& section, const SweepFamily& family, double reach_mm) {
  const SweepState state = family.at(section.offset_mm);
  const SweepCurve curve(state.bend, reach_mm);
  const double c = std::cos(state.theta), n = std::sin(state.theta);
  std::vector<Foot> feet;
  for (const SweepSample& sample : section.samples) {
    const Vector2d d = sample.q - Vector2d(family.x_mm, state.y);
    const Vector2d q(c * d.x() + n * d.y(), -n * d.x() + c * d.y());
    const double s = curve.nearest(q, q.x());
    feet.push_back({s, sample.q, (q - curve.at(s).position).norm()});
  }
  std::sort(feet.begin(), feet.end(), [](const Foot& a, const Foot& b) { return a.s_mm < b.s_mm; });
  return feet;
}

// Evenly spaced by arc length along the polyline through the feet.
std::vector<Vector2d> even_points(const std::vector<Foot>& feet) {
  RibTarget line;
  for (const Foot& foot : feet) {
    const double step = line.points.empty() ? 0 : (foot.q - line.points.back()).norm();
    if (!line.points.empty() && !(step > 0)) continue;
    line.s.push_back(line.points.empty() ? 0 : line.s.back() + step);
    line.points.push_back(foot.q);
  }
  if (line.points.size() < 2) return {};
  return resample(line, 0, 1, kRibSamples);
}

class StripMaker {
 public:
  StripMaker(const WasteSurface& surface, const SweepWindow& window, const SweepFrame& frame,
             const SweepFitReport& fit, const SweepSag* sag, const Settings& settings)
      : surface_(surface), window_(window), frame_(frame), fit_(fit), sag_(sag), settings_(settings) {}

  SweptStrip run(const RibAxes& axes) {
    gather();
    std::vector<RibFit> ribs = make_ribs();
    enclose(ribs);
    SweptStrip made;
    // What the fit leaves of the tolerance may be used up by what of the sag is not known.
    const double sag = std::max(0.0, settings_.design.tolerance_mm - fit_.max_mm) / robot::kSagUnknownShare;
    const BladeReport blade =
        choose_blade(ribs, axes, block_around(ribs, axes, settings_.stock), settings_, sag);
    if (!blade.choice) {
      made.refusal = blade.refusal;
      return made;
    }
    StripPlan strip = make_strip_plan(axes, ribs, *blade.choice, settings_);
    strip.formed = formed();
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
    return f.first_mm + (f.last_mm - f.first_mm) * rib / (f.count() - 1);
  }

  [[nodiscard]] DesignPart part_of(double low_mm, double high_mm) const {
    return {0.5 + low_mm / length_mm_, 0.5 + high_mm / length_mm_};
  }

  // Feet at the ribs and, close to each other, all along the strip.
  void gather() {
    constexpr int kSections = 64;
    constexpr double kSampleMm = 10;
    SweepSectionOptions options = section_options(settings_, window_, kSections, kSampleMm, sag_);
    for (int i = 0; i < fit_.family.count(); ++i) options.extra_mm.push_back(rib_offset(i));
    const SweepData data = sweep_sections(surface_, frame_, options);
    double reach = 0;
    for (const SweepSection& section : data.sections) {
      feet_.push_back(feet_of(section, fit_.family, settings_.blade.free_lengths_mm.back()));
      reach = std::max({reach, -feet_.back().front().s_mm, feet_.back().back().s_mm});
      offsets_.push_back(section.offset_mm);
      double least = 1;
      for (const SweepSample& sample : section.samples) least = std::min(least, sample.cosine);
      slopes_.push_back(std::acos(least));
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
    rib.weights.assign(kRibSamples, 1.0 / kRibSamples);
    const std::size_t k = nearest(offset_mm);
    rib.max_slope_rad = slopes_[k];
    rib.own = {0.5, 0.5};
    if (std::abs(offsets_[k] - offset_mm) <= kSamePlaneMm) {
      rib.target = even_points(feet_[k]);
      if (!rib.target.empty()) rib.own = part_of(feet_[k].front().s_mm, feet_[k].back().s_mm);
      for (const Foot& foot : feet_[k]) rib.deviation_mm = std::max(rib.deviation_mm, foot.away_mm);
    }
    give_bezier(rib, rib.course, settings_.fit);
    rib.converged = fit_.converged;
    return rib;
  }

  [[nodiscard]] std::vector<RibFit> make_ribs() const {
    std::vector<RibFit> ribs;
    for (int i = 0; i < fit_.family.count(); ++i) ribs.push_back(make_rib(rib_offset(i)));
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
    const double low_beyond = std::isfinite(window_.low_mm) ? 0 : kBeyondMm,
                 high_beyond = std::isfinite(window_.high_mm) ? 0 : kBeyondMm;
    std::vector<FormedPart> parts;
    for (int i = 0; i <= places; ++i) {
      const double offset = offsets_.front() + extent * i / places;
      double low = length_mm_, high = -length_mm_;
      for (std::size_t k = 0; k < feet_.size(); ++k) {
        if (std::abs(offsets_[k] - offset) > extent / places) continue;
        low = std::min(low, feet_[k].front().s_mm - low_beyond);
        high = std::max(high, feet_[k].back().s_mm + high_beyond);
      }
      if (high > low) parts.push_back({offset, part_of(low, high)});
    }
    return parts;
  }

  const WasteSurface& surface_;
  SweepWindow window_;
  SweepFrame frame_;
  const SweepFitReport& fit_;
  const SweepSag* sag_;
  const Settings& settings_;
  std::vector<double> offsets_, slopes_;  // of the sections
  std::vector<std::vector<Foot>> feet_;
  double length_mm_ = 0;  // of all ribs
};

}  // namespace

SweepSectionOptions section_options(const Settings& settings, const SweepWindow& window, int count,
                                    double sample_mm, const SweepSag* sag) {
  const SweepWindow wider{window.first_mm - kSeamOverlapMm, window.last_mm + kSeamOverlapMm,
                          window.low_mm - kSeamOverlapMm, window.high_mm + kSeamOverlapMm};
  return {settings.blade.kerf_mm, settings.blade.width_mm, count, sample_mm, wider, {}, sag};
}

SweptStrip make_swept_strip(const WasteSurface& surface, const surface::PlaneFamily& planes,
                            const SweepWindow& window, const SweepFitReport& fit, const SweepSag* sag,
                            const Settings& settings) {
  const SweepFrame frame = sweep_frame(surface, planes.normal(0), planes.centre());
  RibAxes axes;
  axes.planes = planes;
  axes.sweep = frame.sweep;
  axes.x = frame.x;
  axes.y = frame.y;
  return StripMaker(surface, window, frame, fit, sag, settings).run(axes);
}

}  // namespace hotblade::pipeline
