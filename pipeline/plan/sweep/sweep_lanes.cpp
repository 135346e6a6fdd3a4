#include "pipeline/plan/sweep/sweep_lanes.hpp"

#include <algorithm>
#include <cmath>

#include "elastica/kernels/lanes.hpp"
#include "elastica/kernels/simd.hpp"
#include "pipeline/plan/sweep/sweep_step.hpp"

namespace hotblade::pipeline {

namespace {

using elastica::lanes::absolute;
using elastica::lanes::any;
using elastica::lanes::kLanes;
using elastica::lanes::Lanes;
using elastica::lanes::Mask;
using elastica::lanes::pick;
using sweep_step::kLeastBent;
using sweep_step::kLongestNearest_mm;
using sweep_step::kNearEnough_mm;
using sweep_step::kNearestSteps;

// A section's curve and the axes that it lies in.
struct Section {
  const SweepPoint* middle = nullptr;  // of its nodes
  double step_mm = 0, steps_per_mm = 0, low_mm = 0, high_mm = 0;
  Bend bend;
  double x_mm = 0, y_mm = 0, cosine = 1, sine = 0;  // of its middle
};

Section section_of(const SweepState& state, const SweepCurve& curve, double x_mm) {
  Section s;
  s.middle = curve.nodes().data() + curve.before();
  s.step_mm = curve.step_mm();
  s.steps_per_mm = 1 / s.step_mm;
  s.low_mm = -curve.before() * s.step_mm;
  s.high_mm = curve.behind() * s.step_mm;
  s.bend = curve.bend();
  s.x_mm = x_mm;
  s.y_mm = state.y;
  s.cosine = std::cos(-state.theta);
  s.sine = std::sin(-state.theta);
  return s;
}

HOTBLADE_INLINE Lanes clamped(const Section& section, const Lanes& s) {
  const Lanes low = Lanes{} + section.low_mm, high = Lanes{} + section.high_mm;
  return pick(s > low, pick(high < s, high, s), low);
}

// The nodes nearest to some arc lengths, the ways from there, and the curvatures' derivatives by arc length.
struct Onward {
  const SweepPoint* node[kLanes];
  Lanes d, x, y, tx, ty, kappa, k1, k2, way_x, way_y;
};

HOTBLADE_INLINE Onward onward(const Section& section, const Lanes& s) {
  constexpr double kRound = 6755399441055744.0;  // 1.5 * 2^52: what is added to it is rounded
  Onward on{};
  const Lanes at = (s * section.steps_per_mm + kRound) - kRound;
  for (int lane = 0; lane < kLanes; ++lane) {
    const SweepPoint* node = section.middle + static_cast<int>(at[lane]);
    on.node[lane] = node;
    on.x[lane] = node->position[0];
    on.y[lane] = node->position[1];
    on.tx[lane] = node->tangent[0];
    on.ty[lane] = node->tangent[1];
    on.kappa[lane] = node->kappa;
  }
  const Lanes d = s - at * section.step_mm, d2 = d * d, d3 = d2 * d, d4 = d3 * d, k = on.kappa;
  const double t1 = section.bend.tension1, t2 = section.bend.tension2;
  on.d = d;
  on.k1 = t2 * on.tx - t1 * on.ty;
  on.k2 = k * (t2 * -on.ty - t1 * on.tx);
  const Lanes along = d - k * k * (d3 * (1 / 6.0)) - k * on.k1 * (d4 * (1 / 8.0)),
              across =
                  k * (d2 * (1 / 2.0)) + on.k1 * (d3 * (1 / 6.0)) + (on.k2 - k * k * k) * (d4 * (1 / 24.0));
  on.way_x = along * on.tx + across * -on.ty;
  on.way_y = along * on.ty + across * on.tx;
  return on;
}

// A number of the node that each lane is at.
template <typename Number>
HOTBLADE_INLINE Lanes of_nodes(const Onward& on, const Number& number) {
  Lanes numbers{};
  for (int lane = 0; lane < kLanes; ++lane) numbers[lane] = number(*on.node[lane]);
  return numbers;
}

// SweepCurve::nearest, as often as the slowest lane asks for.
HOTBLADE_INLINE Lanes nearest(const Section& section, const Lanes& qx, const Lanes& qy, const Lanes& guess) {
  Lanes s = clamped(section, guess);
  Mask open = s == s;
  for (int i = 0; i < kNearestSteps && any(open); ++i) {
    const Onward on = onward(section, s);
    const Lanes away_x = qx - on.x - on.way_x, away_y = qy - on.y - on.way_y;
    const Lanes turn = on.kappa * on.d + on.k1 * on.d * on.d * (1 / 2.0), square = turn * turn;
    const Lanes c = 1 - square * (1 / 2.0) + square * square * (1 / 24.0),
                n = turn * (1 - square * (1 / 6.0));
    const Lanes tx = c * on.tx - n * on.ty, ty = n * on.tx + c * on.ty;
    const Lanes kappa = on.kappa + on.k1 * on.d;
    const Lanes bent = 1 - kappa * (tx * away_y - ty * away_x);
    const Lanes least = Lanes{} + kLeastBent, longest = Lanes{} + kLongestNearest_mm;
    const Lanes asked = (away_x * tx + away_y * ty) / pick(bent < least, least, bent);
    const Lanes step = pick(asked < -longest, -longest, pick(longest < asked, longest, asked));
    const Lanes next = clamped(section, s + step);
    const Mask settled = absolute(next - s) <= kNearEnough_mm;
    s = pick(open, next, s);
    open = open & ~settled;
  }
  return s;
}

// sample_term of as many samples.
struct Terms {
  Lanes foot, away, by[5], point_x, point_y;
};

HOTBLADE_INLINE Terms terms_of(const Section& section, const SweepSample* samples, const double* feet,
                               int count) {
  Lanes px{}, py{}, cosine{}, guess{};
  for (int lane = 0; lane < kLanes; ++lane) {
    const int at = std::min(lane, count - 1);
    px[lane] = samples[at].q[0];
    py[lane] = samples[at].q[1];
    cosine[lane] = samples[at].cosine;
    guess[lane] = feet[at];
  }
  const double c = section.cosine, n = section.sine;
  const Lanes dx = px - section.x_mm, dy = py - section.y_mm;
  const Lanes qx = c * dx + -n * dy, qy = n * dx + c * dy;
  Terms terms;
  terms.foot = nearest(section, qx, qy, guess);
  const Onward on = onward(section, terms.foot);
  // SweepCurve::at, as far as a distance needs it.
  const Lanes d = on.d, d2 = d * d, d3 = d2 * d;
  const Lanes x = on.x + on.way_x, y = on.y + on.way_y;
  const Lanes theta = of_nodes(on, [](const SweepPoint& p) { return p.theta; });
  const Lanes angle = theta + on.kappa * d + on.k1 * (d2 * (1 / 2.0)) + on.k2 * (d3 * (1 / 6.0)) - theta;
  const sweep_step::Tangents<Lanes> tangent =
      sweep_step::Tangents<Lanes>{on.tx, on.ty}.turned(sweep_step::turn_of<kLanes>(angle));
  const Lanes tx = tangent.c, ty = tangent.n;
  const Lanes nx = -ty, ny = tx;
  const double t1 = section.bend.tension1, t2 = section.bend.tension2;
  const Lanes bends = t2 * -on.ty - t1 * on.tx;
  terms.away = cosine * ((qx - x) * nx + (qy - y) * ny);
  terms.by[0] = -cosine * (-n * nx + c * ny);
  terms.by[1] = -cosine * (ny * x - nx * y);
#pragma GCC unroll 3
  for (int k = 0; k < 3; ++k) {
    const Lanes theta_by = of_nodes(on, [k](const SweepPoint&p) { return p.theta_by_bend[k]; }),
                kappa_by = of_nodes(on, [k](const SweepPoint&p) { return p.kappa_by_bend[k]; }),
                x_by = of_nodes(on, [k](const SweepPoint&p) { return p.by_bend(0, k); }),
                y_by = of_nodes(on, [k](const SweepPoint&p) { return p.by_bend(1, k); });
    const Lanes slope = theta_by * bends + (k == 0 ? Lanes{} : k == 1 ? -on.ty : on.tx);
    const Lanes bent = d2 * (1 / 2.0) * kappa_by + d3 * (1 / 6.0) * slope;
    const Lanes by_x = x_by + -on.way_y * theta_by + -on.ty * bent,
                by_y = y_by + on.way_x * theta_by + on.tx * bent;
    terms.by[2 + k] = -cosine * (nx * by_x + ny * by_y);
  }
  terms.point_x = cosine * c * nx + cosine * n * ny;
  terms.point_y = cosine * -n * nx + cosine * c * ny;
  return terms;
}

// Values of each lane that has a sample.
HOTBLADE_INLINE void put(const Lanes& values, int count, double* to) {
  for (int lane = 0; lane < count; ++lane) to[lane] = values[lane];
}

HOTBLADE_INLINE double sum_of(const Lanes& a) {
  return ((a[0] + a[1]) + (a[2] + a[3])) + ((a[4] + a[5]) + (a[6] + a[7]));
}

HOTBLADE_INLINE Lanes powered(const Lanes& base, int exponent) {
  Lanes power = Lanes{} + 1, square = base;
  for (int left = exponent; left > 0; left /= 2, square *= square)
    if (left % 2 == 1) power *= square;
  return power;
}

// Where the sums go, and what they are of.
struct Distances {
  const SweepSample* samples = nullptr;
  int count = 0;
  double *feet = nullptr, *away = nullptr;
};

HOTBLADE_INLINE void distance_body(const Section& section, const DistancePower& power,
                                   const Distances& distances, DistanceSums& sums) {
  Lanes value{}, most{}, gradient[5]{}, matrix[15]{};
  const double first = power.exponent / power.samples,
               second = power.exponent * (power.exponent - 1) / power.samples;
  for (int i = 0; i < distances.count; i += kLanes) {
    const int count = std::min(kLanes, distances.count - i);
    const Terms t = terms_of(section, distances.samples + i, distances.feet + i, count);
    put(t.foot, count, distances.feet + i);
    put(t.away, count, distances.away + i);
    const Lanes ratio = t.away / power.scale_mm, size = absolute(t.away);
    Lanes scaled = powered(ratio * ratio, power.exponent / 2 - 1);
    for (int lane = count; lane < kLanes; ++lane) scaled[lane] = 0;
    most = pick(size <= most, most, size);
    value += scaled * t.away * t.away / power.samples;
    const Lanes pull = first * scaled * t.away, weight = second * scaled;
    int entry = 0;
#pragma GCC unroll 5
    for (int k = 0; k < 5; ++k) {
      gradient[k] += pull * t.by[k];
      const Lanes weighted = weight * t.by[k];
#pragma GCC unroll 5
      for (int l = k; l < 5; ++l) matrix[entry++] += weighted * t.by[l];
    }
  }
  sums.value = sum_of(value);
  int entry = 0;
  for (int k = 0; k < 5; ++k) {
    sums.gradient[k] = sum_of(gradient[k]);
    for (int l = k; l < 5; ++l, ++entry) sums.matrix(k, l) = sums.matrix(l, k) = sum_of(matrix[entry]);
  }
  for (int lane = 0; lane < kLanes; ++lane)
    if (!(most[lane] <= sums.max_mm)) sums.max_mm = most[lane];
}

HOTBLADE_INLINE void terms_body(const Section& section, std::span<const SweepSample> samples,
                                const double* feet, SampleTerm* out) {
  const int all = static_cast<int>(samples.size());
  for (int i = 0; i < all; i += kLanes) {
    const int count = std::min(kLanes, all - i);
    const Terms t = terms_of(section, samples.data() + i, feet + i, count);
    for (int lane = 0; lane < count; ++lane) {
      SampleTerm& term = out[i + lane];
      term.foot_mm = t.foot[lane];
      term.away_mm = t.away[lane];
      for (int k = 0; k < 5; ++k) term.by[k] = t.by[k][lane];
      term.by_point = {t.point_x[lane], t.point_y[lane]};
    }
  }
}

#if defined(__x86_64__)
HOTBLADE_AVX512 void distances_512(const Section& section, const DistancePower& power,
                                   const Distances& distances, DistanceSums& sums) {
  distance_body(section, power, distances, sums);
}
HOTBLADE_AVX2 void distances_256(const Section& section, const DistancePower& power,
                                 const Distances& distances, DistanceSums& sums) {
  distance_body(section, power, distances, sums);
}
HOTBLADE_AVX512 void terms_512(const Section& section, std::span<const SweepSample> samples,
                               const double* feet, SampleTerm* out) {
  terms_body(section, samples, feet, out);
}
HOTBLADE_AVX2 void terms_256(const Section& section, std::span<const SweepSample> samples, const double* feet,
                             SampleTerm* out) {
  terms_body(section, samples, feet, out);
}
#endif

}  // namespace

DistancePower::Weight DistancePower::of(double away_mm) const {
  const double ratio = away_mm / scale_mm;
  double scaled = 1, square = ratio * ratio;
  for (int left = exponent / 2 - 1; left > 0; left /= 2, square *= square)
    if (left % 2 == 1) scaled *= square;
  return {scaled * away_mm * away_mm / samples, exponent / samples * scaled * away_mm,
          exponent * (exponent - 1) / samples * scaled};
}

DistanceSums distance_sums(std::span<const SweepSample> samples, const SweepState& state,
                           const SweepCurve& curve, double x_mm, const DistancePower& power,
                           std::span<double> feet_mm, std::span<double> away_mm, elastica::Simd simd) {
  DistanceSums sums;
  const Section section = section_of(state, curve, x_mm);
  const Distances distances{samples.data(), static_cast<int>(samples.size()), feet_mm.data(), away_mm.data()};
#if defined(__x86_64__)
  if (simd == elastica::Simd::kAvx512) {
    distances_512(section, power, distances, sums);
    return sums;
  }
  if (simd == elastica::Simd::kAvx2) {
    distances_256(section, power, distances, sums);
    return sums;
  }
#endif
  static_cast<void>(simd);
  distance_body(section, power, distances, sums);
  return sums;
}

void sample_terms(std::span<const SweepSample> samples, const SweepState& state, const SweepCurve& curve,
                  double x_mm, std::span<const double> feet_mm, std::span<SampleTerm> terms,
                  elastica::Simd simd) {
  const Section section = section_of(state, curve, x_mm);
#if defined(__x86_64__)
  if (simd == elastica::Simd::kAvx512) return terms_512(section, samples, feet_mm.data(), terms.data());
  if (simd == elastica::Simd::kAvx2) return terms_256(section, samples, feet_mm.data(), terms.data());
#endif
  static_cast<void>(simd);
  terms_body(section, samples, feet_mm.data(), terms.data());
}

std::vector<SampleTerm> lone_terms(std::span<const LoneSample> samples) {
  std::vector<SweepCurve::Ask> asked;
  for (const LoneSample& s : samples) asked.push_back({s.state.bend, s.reach_mm, s.foot_mm});
  const std::vector<SweepCurve> curves = SweepCurve::all(asked);
  std::vector<SampleTerm> terms;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const LoneSample& s = samples[i];
    SampleTerm term = sample_term(*s.sample, s.state, curves[i], s.x_mm, s.foot_mm);
    if (curves[i].is_open_at(term.foot_mm))
      term = sample_term(*s.sample, s.state, SweepCurve(s.state.bend, s.reach_mm), s.x_mm, s.foot_mm);
    terms.push_back(term);
  }
  return terms;
}

}  // namespace hotblade::pipeline
