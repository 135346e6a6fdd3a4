#include "pipeline/plan/motion/timed_stretch.hpp"

#include <algorithm>
#include <cmath>

#include "elastica/blade/blade_batch.hpp"
#include "pipeline/plan/motion/blocks.hpp"
#include "pipeline/plan/motion/clamp_plane.hpp"
#include "pipeline/program/clamps.hpp"
#include "robot/blade/common_plane.hpp"
#include "robot/pose/motion.hpp"
#include "robot/pose/rates.hpp"

namespace hotblade::pipeline {

namespace {

// Of a blade, as far apart as those of a rib about.
constexpr std::size_t kAlongPoints = 33;

ClampedShapes clamped(std::vector<BladeShape> shapes, const StripPlan& strip) {
  ClampedShapes all{std::move(shapes), {}, {}};
  all.frames.resize(all.shapes.size());
  all.pairs.resize(all.shapes.size());
  in_blocks(all.shapes.size(), [&](std::size_t from, std::size_t to) {
    std::vector<elastica::Elastica> blades;
    for (std::size_t i = from; i < to; ++i) {
      all.frames[i] = strip.swept_plane(all.shapes[i].offset_mm);
      blades.push_back(all.shapes[i].blade);
    }
    const auto pairs = clamps(blades, std::span(all.frames).subspan(from, to - from));
    std::copy(pairs.begin(), pairs.end(), all.pairs.begin() + static_cast<std::ptrdiff_t>(from));
  });
  return all;
}

// How far from a point in the block the way to one outside stays in it, as a share of the way.
double share_inside(const Block& block, const Eigen::Vector3d& in, const Eigen::Vector3d& out) {
  const Eigen::Vector3d from = block.local(in), to = block.local(out);
  double share = 1;
  for (int axis = 0; axis < 3; ++axis) {
    if (to[axis] < 0) share = std::min(share, from[axis] / (from[axis] - to[axis]));
    if (to[axis] > block.size_mm[axis])
      share = std::min(share, (block.size_mm[axis] - from[axis]) / (to[axis] - from[axis]));
  }
  return share;
}

// From where to where the points along a blade are in the block.
void measure_in_block(const Block& block, PathSample& sample) {
  const std::vector<Eigen::Vector3d>& along = sample.along;
  const auto in = [&](const Eigen::Vector3d& p) { return block.contains(p); };
  const auto first = std::ranges::find_if(along, in);
  if (first == along.end()) return;
  auto last = along.end() - 1;
  while (!in(*last)) --last;
  sample.block_from = static_cast<double>(first - along.begin());
  sample.block_to = static_cast<double>(last - along.begin());
  if (first != along.begin()) sample.block_from -= share_inside(block, *first, *(first - 1));
  if (last + 1 != along.end()) sample.block_to += share_inside(block, *last, *(last + 1));
}

std::vector<PathSample> path_samples(const Stretch& stretch, const StripPlan& strip) {
  std::vector<double> parameters;
  for (int i = 0; i <= stretch.samples; ++i) parameters.push_back(static_cast<double>(i) / stretch.samples);
  const ClampedShapes all = clamped(shapes_at(stretch, parameters), strip);
  std::vector<PathSample> samples(all.pairs.size());
  in_blocks(samples.size(), [&](std::size_t from, std::size_t to) {
    std::vector<elastica::Elastica> blades;
    std::vector<elastica::Part> foam;
    for (std::size_t i = from; i < to; ++i) {
      const BladeShape& shape = all.shapes[i];
      blades.push_back(shape.blade);
      foam.push_back(shape.in_foam ? elastica::Part{shape.rib0, shape.rib1} : elastica::Part{});
    }
    const elastica::PartPlaces points = elastica::sample_places(blades, foam, kFeedPoints);
    std::vector<elastica::Part> whole(blades.size());
    for (std::size_t i = 0; i < blades.size(); ++i)
      if (foam[i].last > foam[i].first) whole[i] = {0, blades[i].length};
    const elastica::PartPlaces all_along = elastica::sample_places(blades, whole, kAlongPoints);
    for (std::size_t i = from; i < to; ++i) {
      PathSample& sample = samples[i];
      sample.a = all.pairs[i].a;
      sample.b = all.pairs[i].b;
      if (!(foam[i - from].last > foam[i - from].first)) continue;
      sample.in_foam.reserve(kFeedPoints);
      for (std::size_t k = 0; k < kFeedPoints; ++k) {
        const Eigen::Vector2d q = points.at(i - from, k);
        sample.in_foam.push_back(all.frames[i].point(q.x(), q.y()));
      }
      sample.along.reserve(kAlongPoints);
      for (std::size_t k = 0; k < kAlongPoints; ++k) {
        const Eigen::Vector2d q = all_along.at(i - from, k);
        sample.along.push_back(all.frames[i].point(q.x(), q.y()));
      }
      measure_in_block(strip.block, sample);
    }
  });
  return samples;
}

// A limit holds up to this use: the waypoints are written and read as numbers of some digits.
constexpr double kHolds = 0.995;
// A place that exceeds a limit is brought to this use of it.
constexpr double kAimed = 0.97;

double worst_use(const std::vector<WaypointUse>& uses) {
  double worst = 0;
  for (const WaypointUse& use : uses)
    worst = std::max({worst, use.rate2, *std::max_element(use.accel.begin(), use.accel.end())});
  return worst;
}

// Lowers the shares about the waypoints that use too much. Each place is lowered by its own excess once,
// however many waypoints see it.
void lower_shares(const std::vector<WaypointUse>& uses, const TimeLaw& law, LawShares& shares) {
  const std::size_t n = shares.rate2.size();
  const auto last = static_cast<double>(n - 1);
  LawShares by{std::vector<double>(n, 1.0), {}};
  by.accel.fill(std::vector<double>(n, 1.0));
  const auto about = [&](std::vector<double>& factors, std::size_t from, std::size_t to, double use) {
    const auto i0 = static_cast<std::size_t>(std::floor(law.sigma[from] * last)),
               i1 = static_cast<std::size_t>(std::min(last, std::ceil(law.sigma[to] * last)));
    for (std::size_t i = i0; i <= i1; ++i) factors[i] = std::min(factors[i], kAimed / use);
  };
  for (std::size_t k = 0; k < uses.size(); ++k) {
    const std::size_t before = k > 0 ? k - 1 : 0, behind = std::min(k + 1, uses.size() - 1);
    if (uses[k].rate2 > kHolds) about(by.rate2, before, k, uses[k].rate2);
    for (std::size_t t = 0; t < kTracks; ++t)
      if (uses[k].accel[t] > kHolds) about(by.accel[t], before, behind, uses[k].accel[t]);
  }
  for (std::size_t i = 0; i < n; ++i) {
    shares.rate2[i] *= by.rate2[i];
    for (std::size_t t = 0; t < kTracks; ++t) shares.accel[t][i] *= by.accel[t][i];
  }
}

void lower_all(LawShares& shares, double factor) {
  const auto lower = [factor](std::vector<double>& all) {
    for (double& share : all) share *= factor;
  };
  lower(shares.rate2);
  for (auto& accel : shares.accel) lower(accel);
}

// How far the clamps leave a common plane half-way to the next waypoint, where that is most.
double off_plane_between(const ClampPoses& p, const ClampPoses& q) {
  const ClampPoses halfway = robot::interpolate(p, q, 0.5);
  return off_plane_mm(halfway.a, halfway.b);
}

}  // namespace

std::vector<WaypointUse> waypoint_uses(std::span<const ClampPoses> pairs, double step_s,
                                       const MotionSettings& limits, bool planes_turn) {
  std::vector<WaypointUse> uses(pairs.size());
  const auto squared = [](double x) { return x * x; };
  for (const bool is_a : {true, false}) {
    const Track place = is_a ? kPlaceA : kPlaceB, turn = is_a ? kTurnA : kTurnB;
    const auto clamp = is_a ? &ClampPoses::a : &ClampPoses::b;
    robot::ClampRates rates;
    for (std::size_t k = 1; k <= pairs.size(); ++k) {
      const bool ends = k == pairs.size();
      const robot::ClampRates then =
          ends ? robot::ClampRates{} : robot::rates_between(pairs[k - 1].*clamp, pairs[k].*clamp, step_s);
      const double outside_s = 0;
      const robot::ClampAccelerations change =
          robot::accelerations_between(rates, then, k == 1 ? outside_s : step_s, ends ? outside_s : step_s);
      uses[k - 1].accel[place] = change.linear_mm_s2 / limits.accel_mm_s2;
      uses[k - 1].accel[turn] = change.angular_rad_s2 / limits.angular_accel_rad_s2;
      if (!ends) {
        uses[k].rate2 = std::max({uses[k].rate2, squared(then.linear.norm() / limits.travel_mm_s),
                                  squared(then.angular.norm() / limits.angular_rad_s)});
      }
      rates = then;
    }
  }
  // Half-way between waypoints clamps stray from the plane by the square of the step.
  for (std::size_t k = 1; planes_turn && k < pairs.size(); ++k)
    uses[k].rate2 =
        std::max(uses[k].rate2, off_plane_between(pairs[k - 1], pairs[k]) / robot::kMaxOffPlane_mm);
  return uses;
}

TimedStretch timed(const Stretch& stretch, const StripPlan& strip, const Settings& settings) {
  const std::vector<PathSample> samples = path_samples(stretch, strip);
  LawShares shares = first_shares(samples);
  // Slowing a place moves the waypoints of all that follow, so that a few rounds are needed; rounds beyond
  // those slow the whole stretch with it.
  constexpr int kLocalTries = 40, kTries = 100;
  constexpr double kSlower = 0.9;
  for (int i = 0;; ++i) {
    TimeLaw law = fastest_time_law(samples, settings.motion, shares);
    ClampedShapes at = clamped(shapes_at(stretch, law.sigma), strip);
    if (!(law.duration_s > 0)) return {std::move(law), std::move(at)};
    const std::vector<WaypointUse> uses =
        waypoint_uses(at.pairs, law.step_s, settings.motion, strip.planes.turns());
    if (worst_use(uses) <= kHolds || i == kTries) return {std::move(law), std::move(at)};
    lower_shares(uses, law, shares);
    if (i >= kLocalTries) lower_all(shares, kSlower);
  }
}

}  // namespace hotblade::pipeline
