#include "gpu/curve/pair_distance.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "elastica/kernels/curve_pair.h"
#include "elastica/kernels/hausdorff_search.hpp"
#include "gpu/curve/curve_lanes.hpp"

namespace hotblade::gpu {
namespace {

using Eigen::Vector2d;
using Bezier = std::array<Vector2d, 4>;
using elastica::hausdorff_search::HausdorffRange;
using elastica::hausdorff_search::Point;

// Pairs of one task.
constexpr std::size_t kBlock = 1024;
// Extents whose squares and cubes neither overflow nor vanish.
constexpr double kGreatestExtent = 1e140, kLeastLength = 1e-100;
constexpr int kLeastPanels = 8, kLeastSamples = 16;
// Bounds that are wider than the tolerance by less than this get narrow by twice the samples, twice at most:
// they close with the square of their number, near curves' with the third power.
constexpr double kWorthMoreSamples = 12;
constexpr int kRounds = 3;

// A pair in its frame: the elastica starts at the origin, everything lies within [-2, 2].
struct Frame {
  PairNumbers numbers{};
  double scale = 1, omega = 0, bezier_bend = 0, tolerance = 0;
  PairStatus status = PairStatus::kOk;
};

bool all_finite(const Bezier& b, const ElasticaState& e) {
  for (const double v : {e.x, e.y, e.theta, e.kappa, e.lambda1, e.lambda2, e.length}) {
    if (!std::isfinite(v)) return false;
  }
  return std::all_of(b.begin(), b.end(), [](const Vector2d& p) { return p.allFinite(); });
}

// The power of two that brings an extent into [1/2, 1).
double scale_of(double extent) {
  int exponent = 0;
  (void)std::frexp(extent, &exponent);
  return extent > 0 ? std::ldexp(1.0, std::clamp(-exponent, -500, 500)) : 1;
}

void set_elastica(const ElasticaState& e, Frame& f) {
  const double c = std::cos(e.theta), s = std::sin(e.theta), length = e.length * f.scale;
  const double kappa = e.kappa / f.scale, l1 = e.lambda1 / f.scale / f.scale,
               l2 = e.lambda2 / f.scale / f.scale;
  const double lambda = std::hypot(l1, l2);
  // kappa^2/2 - (lambda1 cos + lambda2 sin) is constant along the curve, and |kappa'| <= |lambda|.
  const double crest = std::sqrt(kappa * kappa + 2 * std::max(0.0, lambda - (l1 * c + l2 * s)));
  f.omega = std::sqrt(crest * crest + lambda);
  const double bend = std::min(crest, std::abs(kappa) + lambda * length);
  // A straight one may be run through in one step.
  const double step = f.omega > HB_STEP_OMEGA / 4 ? HB_STEP_OMEGA / f.omega : 4;
  const double values[] = {kappa, l1, l2, step, c, s, length, bend};
  std::copy(std::begin(values), std::end(values), f.numbers.v + 8);
}

Frame frame_of(const Bezier& bezier, const ElasticaState& e, double tolerance) {
  Frame f;
  f.status = PairStatus::kInvalid;
  if (!all_finite(bezier, e) || e.length < 0) return f;
  const Vector2d start(e.x, e.y);
  double extent = e.length;
  for (const Vector2d& p : bezier) extent = std::max(extent, (p - start).lpNorm<Eigen::Infinity>());
  if (!(extent < kGreatestExtent)) return f;
  f.scale = scale_of(extent);
  f.tolerance = tolerance * f.scale;
  for (int axis = 0; axis < 2; ++axis) {
    double b[4];
    for (std::size_t k = 0; k < 4; ++k) b[k] = (bezier[k][axis] - start[axis]) * f.scale;
    double* v = f.numbers.v + 4 * axis;
    v[0] = b[0];
    v[1] = 3 * (b[1] - b[0]);
    v[2] = 3 * ((b[2] - b[1]) - (b[1] - b[0]));
    v[3] = (b[3] - b[0]) - 3 * (b[2] - b[1]);
  }
  const double* v = f.numbers.v;
  f.bezier_bend =
      std::max(std::hypot(2 * v[2], 2 * v[6]), std::hypot(2 * v[2] + 6 * v[3], 2 * v[6] + 6 * v[7]));
  set_elastica(e, f);
  f.status = f.omega * f.numbers.v[14] <= kMostWinding ? PairStatus::kOk : PairStatus::kTooTight;
  return f;
}

// The least power of two times `least` that reaches `wanted`.
int rounded_up(double wanted, int least) {
  double n = least;
  while (n < wanted && n < 4 * kMostPairSamples) n *= 2;
  return static_cast<int>(n);
}

int panels_of(const Frame& f) {
  return rounded_up(f.omega * f.numbers.v[14], kLeastPanels);
}

// As many as suffice for curves that follow each other, by the third derivatives of kernels/curve_pair.h's
// bound; others take more in the next rounds, or the search.
int samples_of(const Frame& f) {
  const double* v = f.numbers.v;
  const double length = v[14], bend = v[15] * length, tension = std::hypot(v[9], v[10]) * length * length;
  const double third =
      6 * std::hypot(v[3], v[7]) + (tension + bend * bend) * length + 3 * bend * f.bezier_bend;
  return rounded_up(std::cbrt(third / (16 * 0.5 * f.tolerance)), kLeastSamples);
}

class BezierSide {
 public:
  explicit BezierSide(const Frame& f) : v_(f.numbers.v) {}
  [[nodiscard]] Point at(double u) const {
    Point p;
    p.u = u;
    for (int axis = 0; axis < 2; ++axis) {
      const double* v = v_ + 4 * axis;
      p.p[axis] = ((v[3] * u + v[2]) * u + v[1]) * u + v[0];
      p.d1[axis] = (3 * v[3] * u + 2 * v[2]) * u + v[1];
      p.d2[axis] = 6 * v[3] * u + 2 * v[2];
    }
    return p;
  }
  // The second derivative is affine.
  [[nodiscard]] static double bend(const Point& a, const Point& b) {
    return std::max(a.d2.norm(), b.d2.norm());
  }

 private:
  const double* v_;
};

// The elastica by one step from the nearest of even nodes.
class ElasticaSide {
 public:
  explicit ElasticaSide(const Frame& f)
      : field_{f.numbers.v[8], f.numbers.v[9], f.numbers.v[10], f.numbers.v[11]},
        length_(f.numbers.v[14]),
        tension_(std::hypot(f.numbers.v[9], f.numbers.v[10])) {
    const int steps = 1 + static_cast<int>(length_ / field_.most_step);
    node_step_ = length_ / steps;
    hb_elastica_point p{0, 0, f.numbers.v[12], f.numbers.v[13]};
    for (int i = 0; i <= steps; ++i) {
      nodes_.push_back(p);
      hb_elastica_step(&field_, node_step_, &p);
    }
  }
  [[nodiscard]] Point at(double u) const {
    const double place = u * static_cast<double>(nodes_.size() - 1), node = std::round(place);
    hb_elastica_point q = nodes_[static_cast<std::size_t>(node)];
    hb_elastica_step(&field_, (place - node) * node_step_, &q);
    const double pull = length_ * length_ * hb_elastica_curvature(&field_, &q);
    return {u, {q.x, q.y}, length_ * Vector2d(q.c, q.s), pull * Vector2d(-q.s, q.c)};
  }
  // |kappa'| <= |lambda|.
  [[nodiscard]] double bend(const Point& a, const Point& b) const {
    const double slack = tension_ * length_ * length_ * length_ * std::abs(b.u - a.u);
    return 0.5 * (a.d2.norm() + b.d2.norm() + slack);
  }

 private:
  hb_elastica_field field_;
  double length_, tension_, node_step_ = 0;
  std::vector<hb_elastica_point> nodes_;
};

// One block's pairs on their way.
class Block {
 public:
  Block(std::span<const Bezier> beziers, std::span<const ElasticaState> elastica, double tolerance) {
    for (std::size_t i = 0; i < beziers.size(); ++i) {
      frames_.push_back(frame_of(beziers[i], elastica[i], tolerance));
      numbers_.push_back(frames_.back().numbers);
    }
    for (auto* column : {&l2_, &h1_, &length_, &lower_, &upper_}) column->resize(frames_.size());
  }

  // Returns how many pairs needed the careful search.
  std::size_t answer(std::span<PairDistance> out) {
    differences();
    const std::size_t careful = bounds();
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = result(i);
    return careful;
  }

 private:
  [[nodiscard]] bool answerable(std::size_t i) const { return frames_[i].status == PairStatus::kOk; }
  // Room for rounding on either side of the bounds.
  [[nodiscard]] static double narrow(const Frame& f) { return f.tolerance - 2 * kPairErrorRel; }

  // Calls run(queries, n) for the pairs of each n that count_of(i) gives, 0 for none.
  template <typename Count, typename Run>
  void by_count(int least, const Count& count_of, const Run& run) {
    std::vector<int> counts(frames_.size());
    for (std::size_t i = 0; i < counts.size(); ++i) counts[i] = count_of(i);
    std::vector<unsigned> index;
    for (int n = least; n <= kMostPairSamples; n *= 2) {
      index.clear();
      for (std::size_t i = 0; i < counts.size(); ++i) {
        if (counts[i] == n) index.push_back(static_cast<unsigned>(i));
      }
      if (!index.empty()) run(PairQueries{numbers_.data(), index.data(), index.size()}, n);
    }
  }

  void differences() {
    by_count(
        kLeastPanels, [&](std::size_t i) { return answerable(i) ? panels_of(frames_[i]) : 0; },
        [&](const PairQueries& q, int n) {
          curve_lanes().differences(q, n, l2_.data(), h1_.data(), length_.data());
        });
  }

  std::size_t bounds() {
    std::vector<int> samples(frames_.size());
    for (std::size_t i = 0; i < samples.size(); ++i) {
      upper_[i] = std::numeric_limits<double>::infinity();
      const int wanted = answerable(i) && narrow(frames_[i]) > 0 ? samples_of(frames_[i]) : 0;
      samples[i] = wanted <= kMostPairSamples ? wanted : 0;
    }
    for (int round = 0; round < kRounds; ++round) {
      by_count(
          kLeastSamples, [&](std::size_t i) { return samples[i]; },
          [&](const PairQueries& q, int n) { curve_lanes().hausdorff(q, n, lower_.data(), upper_.data()); });
      for (std::size_t i = 0; i < samples.size(); ++i) {
        const double gap = upper_[i] - lower_[i], narrow_enough = narrow(frames_[i]);
        const bool more = gap > narrow_enough && gap <= kWorthMoreSamples * narrow_enough;
        samples[i] = more && 2 * samples[i] <= kMostPairSamples ? 2 * samples[i] : 0;
      }
    }
    std::size_t careful = 0;
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      if (!answerable(i) || upper_[i] - lower_[i] <= narrow(frames_[i])) continue;
      search(i);
      ++careful;
    }
    return careful;
  }

  void search(std::size_t i) {
    const Frame& f = frames_[i];
    const HausdorffRange range = elastica::hausdorff_search::both_ways(
        BezierSide(f), ElasticaSide(f), std::max(narrow(f), 2 * kPairErrorRel));
    lower_[i] = range.lower;
    upper_[i] = range.upper;
  }

  [[nodiscard]] PairDistance result(std::size_t i) const {
    constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
    const Frame& f = frames_[i];
    PairDistance r{kNaN, kNaN, kNaN, kNaN, f.status};
    if (!answerable(i)) return r;
    const double upper = upper_[i] + kPairErrorRel, lower = std::max(0.0, lower_[i] - kPairErrorRel);
    r.hausdorff = upper / f.scale;
    r.hausdorff_error = (upper - lower) / f.scale;
    if (upper - lower > f.tolerance * (1 + 1e-12))
      r.status = PairStatus::kWide;  // rounding of the difference
    if (!(length_[i] > kLeastLength)) {
      r.status = PairStatus::kNoLength;
      return r;
    }
    r.l2 = l2_[i];
    r.h1 = h1_[i];
    return r;
  }

  std::vector<Frame> frames_;
  std::vector<PairNumbers> numbers_;
  std::vector<double> l2_, h1_, length_, lower_, upper_;
};

}  // namespace

std::size_t pair_distances(std::span<const Bezier> beziers, std::span<const ElasticaState> elastica,
                           double tolerance, std::span<PairDistance> out) {
  if (elastica.size() != beziers.size() || out.size() != beziers.size()) {
    throw std::logic_error("pair_distances: spans of different sizes");
  }
  if (!(tolerance > 0)) throw std::logic_error("pair_distances: needs a tolerance above 0");
  const std::size_t blocks = (beziers.size() + kBlock - 1) / kBlock;
  std::atomic<std::size_t> careful = 0;
  tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t block) {
    const std::size_t first = block * kBlock, n = std::min(kBlock, beziers.size() - first);
    careful +=
        Block(beziers.subspan(first, n), elastica.subspan(first, n), tolerance).answer(out.subspan(first, n));
  });
  return careful;
}

}  // namespace hotblade::gpu
