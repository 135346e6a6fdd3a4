#include "pipeline/plan/ribs/joint_fit.hpp"

#include <ceres/ceres.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "elastica/curve/elastica.hpp"

namespace hotblade::pipeline {

namespace {

using elastica::Elastica;
using elastica::MidState;

constexpr int kState = 7, kClamp = 6;
// Every fourth point that a rib follows: an elastica's seven numbers are decided by far fewer.
constexpr int kPoints = 17;
// A radian at a clamp counts as much as this many mm: the scale of the clamps' distance to the foam.
constexpr double kArmMm = 100;
// Shared ends pull a thousand times as strongly as a point; they are made exact afterwards.
constexpr double kEndWeight = 1e3;
// Keeps what neither points nor neighbours decide where it was: the blade beyond a rib's ends stays calm, and
// the way from the flat arc to the first rib stable. A unit of tension times length^2 weighs as much as a
// thousandth of the rib's length.
constexpr double kStayWeight = 1e-3;

using State = std::array<double, kState>;
using Clamps = Eigen::Matrix<double, kClamp, 1>;

// Numbers of order one: lengths by the rib's length, curvature and tensions made pure.
struct Scale {
  double length;

  [[nodiscard]] State pack(const MidState& m) const {
    const double l = length;
    return {m.x / l, m.y / l, m.theta, m.kappa * l, m.tension1 * l * l, m.tension2 * l * l, m.length / l};
  }
  [[nodiscard]] MidState unpack(const double* s) const {
    const double l = length;
    MidState m;
    m.x = s[0] * l;
    m.y = s[1] * l;
    m.theta = s[2];
    m.kappa = s[3] / l;
    m.tension1 = s[4] / (l * l);
    m.tension2 = s[5] / (l * l);
    m.length = std::max(1e-3, s[6]) * l;
    return m;
  }
};

// Points of one rib, its shared ends, and where it was.
struct RibResidual {
  const RibFit* rib;
  Scale scale;
  State start;
  double blade_length_mm;

  static constexpr int kResiduals = 2 * kPoints + 6 + kState;

  bool operator()(const double* s, double* r) const {
    const MidState mid = scale.unpack(s);
    if (winds_up(mid, blade_length_mm)) return false;  // a step too far: the solver takes a shorter one
    const Elastica e = from_mid_state(mid);
    const std::vector<elastica::CurvePoint> on = sample(e, kPoints);
    const std::vector<Eigen::Vector2d>& followed = rib->followed();
    const std::size_t stride = (followed.size() - 1) / (kPoints - 1);
    for (std::size_t i = 0; i < kPoints; ++i) {
      const double count = rib->weights.empty() ? 1 : std::sqrt(rib->weights[i * stride] * kRibSamples);
      const Eigen::Vector2d d = count * (on[i].position() - followed[i * stride]) / scale.length;
      *r++ = d.x();
      *r++ = d.y();
    }
    for (const auto& [clamp, is] :
         {std::pair{&rib->clamp_start, &on.front()}, std::pair{&rib->clamp_end, &on.back()}}) {
      const bool held = clamp->has_value();
      *r++ = held ? kEndWeight * (is->x - (*clamp)->x) / scale.length : 0;
      *r++ = held ? kEndWeight * (is->y - (*clamp)->y) / scale.length : 0;
      *r++ = held ? kEndWeight * std::sin(is->theta - (*clamp)->theta) : 0;
    }
    for (std::size_t i = 0; i < kState; ++i) *r++ = kStayWeight * (s[i] - start[i]);
    return true;
  }
};

// Positions and directions of both clamps, mm.
Clamps clamps_of(const Elastica& rib, const JointFitOptions& options) {
  const double before = options.share_a * (options.blade_length_mm - rib.length);
  const elastica::CurvePoint a = point_at(rib, -before), b = point_at(rib, options.blade_length_mm - before);
  return Clamps(a.x, a.y, kArmMm * a.theta, b.x, b.y, kArmMm * b.theta);
}

// Second derivative along the sweep from three ribs with uneven spacing: weights of the three.
Eigen::Vector3d second_difference(double h0, double h1) {
  return Eigen::Vector3d(2 / (h0 * (h0 + h1)), -2 / (h0 * h1), 2 / (h1 * (h0 + h1)));
}

// weight * (second difference of the clamps over three ribs), as a pure number.
class ClampBend : public ceres::SizedCostFunction<kClamp, kState, kState, kState> {
 public:
  ClampBend(std::array<Scale, 3> scales, const Eigen::Vector3d& difference, double weight,
            const JointFitOptions& options)
      : scales_(scales), difference_(difference), weight_(weight), options_(options) {}

  bool Evaluate(double const* const* states, double* residuals, double** jacobians) const override {
    for (std::size_t k = 0; k < 3; ++k)
      if (winds_up(scales_[k].unpack(states[k]), options_.blade_length_mm)) return false;
    Eigen::Map<Clamps> r(residuals);
    r.setZero();
    for (std::size_t k = 0; k < 3; ++k) {
      const double w = weight_ * difference_[static_cast<Eigen::Index>(k)];
      r += w * at(k, states[k]);
      if (!jacobians || !jacobians[k]) continue;
      Eigen::Map<Eigen::Matrix<double, kClamp, kState, Eigen::RowMajor>> j(jacobians[k]);
      State s;
      std::copy(states[k], states[k] + kState, s.begin());
      for (std::size_t i = 0; i < kState; ++i) {
        // The cube root of rounding: where central differences are best.
        constexpr double kStep = 6e-6;
        const double was = s[i], step = kStep * std::max(1.0, std::abs(was));
        s[i] = was + step;
        const Clamps high = at(k, s.data());
        s[i] = was - step;
        const Clamps low = at(k, s.data());
        s[i] = was;
        j.col(static_cast<Eigen::Index>(i)) = w * (high - low) / (2 * step);
      }
    }
    return true;
  }

 private:
  [[nodiscard]] Clamps at(std::size_t k, const double* state) const {
    return clamps_of(from_mid_state(scales_[k].unpack(state)), options_);
  }

  std::array<Scale, 3> scales_;
  Eigen::Vector3d difference_;
  double weight_;
  JointFitOptions options_;
};

// Directions of neighbouring ribs on one branch of the circle, so that their differences are small.
std::vector<MidState> states_of(const std::vector<RibFit>& ribs) {
  std::vector<MidState> states;
  for (const RibFit& rib : ribs) {
    MidState m = mid_state(rib.elastica);
    if (!states.empty())
      m.theta = states.back().theta + std::remainder(m.theta - states.back().theta, 2 * std::numbers::pi);
    states.push_back(m);
  }
  return states;
}

void add_bends(ceres::Problem& problem, const std::vector<RibFit>& ribs, std::vector<State>& states,
               double weight, const JointFitOptions& options) {
  const double mean = (ribs.back().offset_mm - ribs.front().offset_mm) / static_cast<double>(ribs.size() - 1);
  for (std::size_t i = 1; i + 1 < ribs.size(); ++i) {
    const double h0 = ribs[i].offset_mm - ribs[i - 1].offset_mm,
                 h1 = ribs[i + 1].offset_mm - ribs[i].offset_mm;
    const std::array<Scale, 3> scales{Scale{ribs[i - 1].elastica.length}, Scale{ribs[i].elastica.length},
                                      Scale{ribs[i + 1].elastica.length}};
    // The integral of the squared second derivative over the sweep, made pure by length and mean spacing.
    const double pure = weight * mean * mean * std::sqrt((h0 + h1) / 2 / mean) / ribs[i].elastica.length;
    problem.AddResidualBlock(new ClampBend(scales, second_difference(h0, h1), pure, options), nullptr,
                             states[i - 1].data(), states[i].data(), states[i + 1].data());
  }
}

// All ribs at one weight; empty when the solver has no answer.
std::vector<MidState> solve(const std::vector<RibFit>& ribs, double weight, const JointFitOptions& options) {
  const std::vector<MidState> start = states_of(ribs);
  std::vector<State> states;
  ceres::Problem problem;
  for (std::size_t i = 0; i < ribs.size(); ++i)
    states.push_back(Scale{ribs[i].elastica.length}.pack(start[i]));
  for (std::size_t i = 0; i < ribs.size(); ++i) {
    using Cost = ceres::NumericDiffCostFunction<RibResidual, ceres::CENTRAL, RibResidual::kResiduals, kState>;
    const Scale scale{ribs[i].elastica.length};
    problem.AddResidualBlock(new Cost(new RibResidual{&ribs[i], scale, states[i], options.blade_length_mm}),
                             nullptr, states[i].data());
  }
  add_bends(problem, ribs, states, weight, options);
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  solver.num_threads = 1;
  // The solver goes on until nothing moves but rounding, or for 200 iterations: what an early stop leaves
  // open would differ with the rounding of the design's coordinates.
  solver.max_num_iterations = 200;
  solver.function_tolerance = 1e-14;
  solver.parameter_tolerance = 1e-13;
  solver.gradient_tolerance = 1e-16;
  solver.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  std::vector<MidState> solved;
  if (!summary.IsSolutionUsable()) return solved;
  for (std::size_t i = 0; i < ribs.size(); ++i) {
    solved.push_back(Scale{ribs[i].elastica.length}.unpack(states[i].data()));
  }
  return solved;
}

bool within(const RibFit& rib, const RibFit& was, const JointFitOptions& options) {
  return rib.deviation_mm <=
         std::max(was.deviation_mm, std::min(was.deviation_mm + options.allowance_mm, options.most_mm));
}

}  // namespace

double clamp_acceleration_mm_s2(const std::vector<RibFit>& ribs, const JointFitOptions& options) {
  double largest = 0;
  for (std::size_t i = 1; i + 1 < ribs.size(); ++i) {
    const double h0 = ribs[i].offset_mm - ribs[i - 1].offset_mm,
                 h1 = ribs[i + 1].offset_mm - ribs[i].offset_mm;
    const Eigen::Vector3d d = second_difference(h0, h1);
    Clamps bend = Clamps::Zero();
    for (std::size_t k = 0; k < 3; ++k)
      bend += d[static_cast<Eigen::Index>(k)] * clamps_of(ribs[i + k - 1].elastica, options);
    largest = std::max({largest, bend.segment<2>(0).norm(), bend.segment<2>(3).norm()});
  }
  return options.feed_mm_s * options.feed_mm_s * largest;
}

JointFitReport joint_fit(std::vector<RibFit>& ribs, const JointFitOptions& options) {
  JointFitReport report;
  for (const RibFit& rib : ribs)
    if (winds_up(mid_state(rib.elastica), options.blade_length_mm)) return report;
  report.acceleration_before_mm_s2 = report.acceleration_after_mm_s2 =
      clamp_acceleration_mm_s2(ribs, options);
  if (ribs.size() < 3) return report;
  // Decades: between two of them the clamps' acceleration changes by less than a factor of two.
  for (const double weight : {10.0, 1.0, 0.1, 0.01}) {
    const std::vector<MidState> solved = solve(ribs, weight, options);
    std::vector<RibFit> candidate = ribs;
    bool good = !solved.empty();
    for (std::size_t i = 0; good && i < ribs.size(); ++i) {
      settle(candidate[i], solved[i]);
      good = within(candidate[i], ribs[i], options);
    }
    if (!good) continue;
    const double after = clamp_acceleration_mm_s2(candidate, options);
    if (!(after < report.acceleration_before_mm_s2)) continue;
    report.acceleration_after_mm_s2 = after;
    report.weight = weight;
    ribs = std::move(candidate);
    break;
  }
  return report;
}

}  // namespace hotblade::pipeline
