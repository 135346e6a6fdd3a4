#include "pipeline/plan/sweep/sweep_joint.hpp"

#include "gpu/backend/stop.hpp"
#include "pipeline/plan/sweep/sweep_problem.hpp"
#include "pipeline/plan/sweep/sweep_terms.hpp"

#include <ceres/ceres.h>
#include <tbb/parallel_for.h>
#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <exception>
#include <map>
#include <memory>
#include <span>
#include <stdexcept>

namespace hotblade::pipeline {

namespace {

constexpr int kState = 5;
constexpr std::size_t kSpan = 4;  // coefficients that count at a place
// The power that distances count by: high enough that the largest are held, low enough for steps of a few
// iterations.
constexpr double kExponent = 8;
static_assert(kExponent == 8, "terms are written out for it");
// A gap counts as three times as large a deviation of a whole strip: at a tenth of this weight gaps of the
// samples are twice as large, at ten times it deviations grow by a tenth and blades come near to a snap.
constexpr double kSeamWeight = 10;
// What a single sample is off by beyond what its part may deviate, against a seam's mean gap: with it a part
// goes beyond by a tenth of what it would without, with a tenth of it by twice as much.
constexpr double kOverWeight = 100;

// The unknowns of one part: a block of five for each coefficient.
struct Unknowns {
  const JointPart* part = nullptr;
  SweepBasis basis;
  ByState units;
  double scale_mm = 1, samples = 0;
  std::vector<double> values;

  explicit Unknowns(const JointPart& p)
      : part(&p), basis(p.start.count()), units(unknown_units(p.data, p.start.x_mm)) {
    for (const SweepSection& section : p.data.sections)
      samples += static_cast<double>(section.samples.size());
    for (int i = 0; i < p.start.count(); ++i) {
      const ByState v = p.start.coefficients.col(i).cwiseQuotient(units);
      values.insert(values.end(), v.begin(), v.end());
    }
  }
  [[nodiscard]] double* block(int i) { return values.data() + static_cast<std::ptrdiff_t>(kState) * i; }
  [[nodiscard]] BasisValues at(double offset_mm) const {
    const SweepFamily& f = part->start;
    return basis.at((offset_mm - f.first_mm) / (f.last_mm - f.first_mm));
  }
  [[nodiscard]] SweepState state(const BasisValues& at) const {
    ByState v = ByState::Zero();
    for (std::size_t k = 0; k < kSpan; ++k)
      v += at.value[k] *
           Eigen::Map<const ByState>(values.data() + static_cast<std::ptrdiff_t>(kState) *
                                                         (at.first + static_cast<std::ptrdiff_t>(k)));
    v = v.cwiseProduct(units);
    return {v[0], v[1], {v[2], v[3], v[4]}};
  }
  [[nodiscard]] double half_blade() const { return 0.5 * part->options.blade_length_mm; }
  [[nodiscard]] SweepFamily family() const {
    SweepFamily family = part->start;
    for (int i = 0; i < basis.count(); ++i)
      family.coefficients.col(i) =
          Eigen::Map<const ByState>(values.data() + static_cast<std::ptrdiff_t>(kState) * i)
              .cwiseProduct(units);
    return family;
  }
};

// One section of a part. However many residuals it has, they depend on the five numbers of one state: turned
// by an orthogonal matrix (QR) all but six of them are zero, and with the six the sum of squares and its
// derivatives are the same.
struct SectionTerms {
  static constexpr int kResiduals = kState + 1;

  Unknowns* unknowns = nullptr;
  const SweepSection* section = nullptr;
  BasisValues at;
  std::vector<double> feet;
  Eigen::Matrix<double, kResiduals, 1> residuals;
  Eigen::Matrix<double, kResiduals, kState> by;  // the residuals' derivatives by the unknowns' state

  [[nodiscard]] SweepCurve::Ask ask() {
    state_ = unknowns->state(at);
    return {state_.bend, unknowns->half_blade()};
  }
  // With the curve that was asked for.
  void evaluate(const SweepCurve& curve) {
    const SweepState& state = state_;
    const SweepFitOptions& options = unknowns->part->options;
    const double x = unknowns->part->start.x_mm;
    rows_.clear();
    const double samples = std::sqrt(unknowns->samples), over_weight = std::sqrt(kOverWeight);
    terms_.resize(feet.size());
    sample_terms(section->samples, state, curve, x, feet, terms_);
    for (std::size_t i = 0; i < feet.size(); ++i) {
      const SampleTerm& term = terms_[i];
      feet[i] = term.foot_mm;
      const double share = std::abs(term.away_mm) / unknowns->scale_mm, grown = share * share * share;
      add(grown * term.away_mm / samples, 0.5 * kExponent * grown / samples, term.by);
      const double over_mm = std::abs(term.away_mm) - unknowns->part->most_mm;
      if (over_mm > 0) add(over_weight * std::copysign(over_mm, term.away_mm), over_weight, term.by);
    }
    const double weight = 1 / std::sqrt(static_cast<double>(unknowns->part->data.sections.size()));
    const auto limit = [&](const LimitTerm& term) { add(weight * term.over, weight, term.by); };
    for (const SweepPoint& node : curve.nodes()) limit(radius_term(node, options));
    for (const SweepPoint* end : {&curve.nodes().front(), &curve.nodes().back()}) {
      limit(turn_term(*end, state, options));
      limit(clamp_term(*end, state, x, options));
    }
    limit(tension_term(state, curve, options));
    limit(clamp_error_term(state, curve, section->samples.front().q.x() - x,
                           section->samples.back().q.x() - x, options));
    gather();
  }

 private:
  using Row = Eigen::Matrix<double, kResiduals, 1>;

  // Limits that hold add nothing.
  void add(double residual, double factor, const ByState& by_state) {
    if (residual == 0 && by_state.isZero(0)) return;
    Row row;
    row << factor * by_state.cwiseProduct(unknowns->units), residual;
    rows_.push_back(row);
  }
  void gather() {
    while (rows_.size() < kResiduals) rows_.emplace_back(Row::Zero());
    using Rows = Eigen::Matrix<double, kResiduals, Eigen::Dynamic>;
    Eigen::Matrix<double, Eigen::Dynamic, kResiduals> all =
        Eigen::Map<const Rows>(rows_.front().data(), kResiduals, std::ssize(rows_)).transpose();
    const Eigen::HouseholderQR<Eigen::Ref<decltype(all)>> turned(all);
    const Eigen::Matrix<double, kResiduals, kResiduals> six =
        all.topRows<kResiduals>().triangularView<Eigen::Upper>();
    by = six.leftCols<kState>();
    residuals = six.col(kState);
  }

  SweepState state_;
  std::vector<SampleTerm> terms_;
  std::vector<Row> rows_;
};

// One probe of a seam.
struct ProbeTerms {
  struct Side {
    Unknowns* unknowns = nullptr;
    const FormedPoint* point = nullptr;
    BasisValues at;
    double foot_mm = 0;
    ByState by = ByState::Zero();

    [[nodiscard]] LoneSample sample() const {
      return {&point->sample, unknowns->state(at), unknowns->half_blade(), unknowns->part->start.x_mm,
              foot_mm};
    }
  };
  std::array<Side, 2> sides;
  double weight = 1, residual = 0;

  // With the terms of both sides' samples.
  void evaluate(std::span<const SampleTerm, 2> terms) {
    residual = 0;
    double sign = weight;
    for (std::size_t k = 0; k < sides.size(); ++k) {
      Side& side = sides[k];
      const SampleTerm& term = terms[k];
      side.foot_mm = term.foot_mm;
      residual += sign * term.away_mm;
      side.by = sign * term.by.cwiseProduct(side.unknowns->units);
      sign = -sign;
    }
  }
};

// All terms that need a curve, evaluated side by side before the solver asks for them one by one.
class Terms : public ceres::EvaluationCallback {
 public:
  std::vector<std::unique_ptr<SectionTerms>> sections;
  std::vector<std::unique_ptr<ProbeTerms>> probes;

  void PrepareForEvaluation(bool /*evaluate_jacobians*/, bool new_evaluation_point) override {
    if (!new_evaluation_point) return;
    in_groups(sections.size(), [&](std::size_t from, std::size_t to) {
      std::vector<SweepCurve::Ask> asked;
      for (std::size_t i = from; i < to; ++i) asked.push_back(sections[i]->ask());
      const std::vector<SweepCurve> curves = SweepCurve::all(asked);
      for (std::size_t i = from; i < to; ++i) sections[i]->evaluate(curves[i - from]);
    });
    in_groups(probes.size(), [&](std::size_t from, std::size_t to) {
      std::vector<LoneSample> samples;
      for (std::size_t i = from; i < to; ++i)
        for (const ProbeTerms::Side& side : probes[i]->sides) samples.push_back(side.sample());
      const std::vector<SampleTerm> terms = lone_terms(samples);
      for (std::size_t i = from; i < to; ++i)
        probes[i]->evaluate(std::span<const SampleTerm, 2>(&terms[2 * (i - from)], 2));
    });
  }

 private:
  // As many as are walked at once.
  template <typename Work>
  static void in_groups(std::size_t count, const Work& work) {
    constexpr std::size_t kGroup = 8;
    tbb::parallel_for(std::size_t{0}, (count + kGroup - 1) / kGroup, [&](std::size_t group) {
      if (!gpu::stop_asked()) work(group * kGroup, std::min(count, (group + 1) * kGroup));
    });
  }
};

// Tells after each step how far the work is. Nothing may be thrown through the solver: it is told to end, and
// what it then says is not used.
class Watched : public ceres::IterationCallback {
 public:
  Watched(const std::function<void()>& watch, std::size_t fits) : watch_(watch), fits_(fits) {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& /*summary*/) override {
    if (gpu::stop_asked()) return ceres::SOLVER_ABORT;
    try {
      for (std::size_t i = 0; watch_ && i < fits_; ++i) watch_();
    } catch (...) {
      thrown_ = std::current_exception();
    }
    return thrown_ ? ceres::SOLVER_ABORT : ceres::SOLVER_CONTINUE;
  }
  void rethrow() const {
    if (thrown_) std::rethrow_exception(thrown_);
  }

 private:
  const std::function<void()>& watch_;
  std::size_t fits_;
  std::exception_ptr thrown_;
};

class SectionCost : public ceres::CostFunction {
 public:
  explicit SectionCost(const SectionTerms& terms) : terms_(terms) {
    set_num_residuals(SectionTerms::kResiduals);
    mutable_parameter_block_sizes()->assign(kSpan, kState);
  }
  bool Evaluate(double const* const* /*unknowns*/, double* residuals, double** jacobians) const override {
    std::copy(terms_.residuals.begin(), terms_.residuals.end(), residuals);
    if (!jacobians) return true;
    using RowMajor = Eigen::Matrix<double, SectionTerms::kResiduals, kState, Eigen::RowMajor>;
    for (std::size_t k = 0; k < kSpan; ++k) {
      if (!jacobians[k]) continue;
      Eigen::Map<RowMajor> jacobian(jacobians[k]);
      jacobian = terms_.at.value[k] * terms_.by;
    }
    return true;
  }

 private:
  const SectionTerms& terms_;
};

// Probes of the same blocks, a row each: the solver's lists are as long as it has costs with two blocks each,
// and made in one go that nothing can stop.
class ProbesCost : public ceres::CostFunction {
 public:
  explicit ProbesCost(std::vector<const ProbeTerms*> probes) : probes_(std::move(probes)) {
    set_num_residuals(static_cast<int>(probes_.size()));
    mutable_parameter_block_sizes()->assign(2 * kSpan, kState);
  }
  bool Evaluate(double const* const* /*unknowns*/, double* residuals, double** jacobians) const override {
    for (std::size_t i = 0; i < probes_.size(); ++i) residuals[i] = probes_[i]->residual;
    if (!jacobians) return true;
    using Rows = Eigen::Matrix<double, kState, Eigen::Dynamic>;
    for (std::size_t k = 0; k < 2 * kSpan; ++k) {
      if (!jacobians[k]) continue;
      Eigen::Map<Rows> rows(jacobians[k], kState, std::ssize(probes_));
      for (std::size_t i = 0; i < probes_.size(); ++i) {
        const ProbeTerms::Side& side = probes_[i]->sides[k / kSpan];
        rows.col(static_cast<std::ptrdiff_t>(i)) = side.at.value[k % kSpan] * side.by;
      }
    }
    return true;
  }

 private:
  std::vector<const ProbeTerms*> probes_;
};

// The sum of some blocks with weights, number by number, times a weight each.
class LinearCost : public ceres::CostFunction {
 public:
  LinearCost(std::vector<double> parts, ByState weights)
      : parts_(std::move(parts)), weights_(std::move(weights)) {
    set_num_residuals(kState);
    mutable_parameter_block_sizes()->assign(parts_.size(), kState);
  }
  bool Evaluate(double const* const* unknowns, double* residuals, double** jacobians) const override {
    Eigen::Map<ByState> sum(residuals);
    sum.setZero();
    for (std::size_t k = 0; k < parts_.size(); ++k) {
      sum += parts_[k] * weights_.cwiseProduct(Eigen::Map<const ByState>(unknowns[k]));
      if (!jacobians || !jacobians[k]) continue;
      Eigen::Map<Eigen::Matrix<double, kState, kState, Eigen::RowMajor>> jacobian(jacobians[k]);
      jacobian = (parts_[k] * weights_).asDiagonal();
    }
    return true;
  }

 private:
  std::vector<double> parts_;
  ByState weights_;
};

void add_smoothness(ceres::Problem& problem, Unknowns& unknowns) {
  ByState smooth, calm;
  for (int k = 0; k < kState; ++k) {
    smooth[k] = smooth_weight(k, unknowns.basis.count());
    calm[k] = calm_weight(k, unknowns.part->options.calm);
  }
  for (int i = 0; i < unknowns.basis.count(); ++i) {
    problem.AddResidualBlock(new LinearCost({1.0}, calm), nullptr, unknowns.block(i));
    if (i + 2 >= unknowns.basis.count()) continue;
    const std::array<double, 3> bend = unknowns.basis.second_difference(i);
    problem.AddResidualBlock(new LinearCost({bend[0], bend[1], bend[2]}, smooth), nullptr, unknowns.block(i),
                             unknowns.block(i + 1), unknowns.block(i + 2));
  }
}

std::vector<double*> blocks_at(Unknowns& unknowns, const BasisValues& at) {
  std::vector<double*> blocks;
  for (std::size_t k = 0; k < kSpan; ++k) blocks.push_back(unknowns.block(at.first + static_cast<int>(k)));
  return blocks;
}

// Probes that depend on the same blocks, together; in the order of the first of each.
std::vector<std::vector<const ProbeTerms*>> by_blocks(
    const std::vector<std::unique_ptr<ProbeTerms>>& probes) {
  std::vector<std::vector<const ProbeTerms*>> together;
  std::map<std::array<const double*, 2>, std::size_t> known;
  for (const auto& probe : probes) {
    std::array<const double*, 2> first{};
    for (std::size_t i = 0; i < 2; ++i) {
      const ProbeTerms::Side& side = probe->sides[i];
      first[i] = side.unknowns->block(side.at.first);
    }
    const auto [held, fresh] = known.try_emplace(first, together.size());
    if (fresh) together.emplace_back();
    together[held->second].push_back(probe.get());
  }
  return together;
}

// At most so many places along a seam, both of its ends among them.
std::vector<const SeamPlace*> spread(const std::vector<SeamPlace>& places, std::size_t most) {
  std::vector<const SeamPlace*> all;
  for (const SeamPlace& place : places) all.push_back(&place);
  if (all.size() <= most) return all;
  const auto farther = [&](const SeamPlace* from) {
    return *std::max_element(all.begin(), all.end(), [&](const SeamPlace* p, const SeamPlace* q) {
      return (p->at - from->at).squaredNorm() < (q->at - from->at).squaredNorm();
    });
  };
  const SeamPlace *end = farther(all.front()), *other = farther(end);
  const Eigen::Vector3d along = other->at - end->at;
  std::stable_sort(all.begin(), all.end(), [&](const SeamPlace* p, const SeamPlace* q) {
    return along.dot(p->at) < along.dot(q->at);
  });
  std::vector<const SeamPlace*> some;
  for (std::size_t i = 0; i < most; ++i) some.push_back(all[i * (all.size() - 1) / (most - 1)]);
  return some;
}

SweepFitReport report_of(const Unknowns& unknowns, const ceres::Solver::Summary& summary) {
  const JointPart& part = *unknowns.part;
  SweepFitReport report = measured_family(part.data, part.options, unknowns.family());
  report.iterations = static_cast<int>(summary.iterations.size());
  report.converged = summary.IsSolutionUsable();
  return report;
}

}  // namespace

std::vector<SweepFitReport> fit_together(const std::vector<JointPart>& parts,
                                         const std::vector<PartSeam>& seams,
                                         const std::function<void()>& watch) {
  std::vector<Unknowns> unknowns;
  Terms terms;
  for (const JointPart& part : parts) {
    if (part.data.sections.empty()) throw std::logic_error("a sweep needs a section");
    unknowns.emplace_back(part);
  }
  std::vector<SweepEvaluation> own(unknowns.size());
  tbb::parallel_for(std::size_t{0}, unknowns.size(), [&](std::size_t i) {
    const JointPart& part = *unknowns[i].part;
    if (part.held) return;
    const SweepProblem problem(part.data, part.options, part.start);
    own[i] = problem.evaluate(problem.pack(part.start), problem.first_feet());
  });
  gpu::stop_point();
  for (std::size_t i = 0; i < unknowns.size(); ++i) {
    Unknowns& u = unknowns[i];
    if (u.part->held) continue;
    u.scale_mm = std::max(own[i].max_mm, u.part->wanted_mm);
    auto foot = own[i].feet.begin();
    for (const SweepSection& section : u.part->data.sections) {
      auto made = std::make_unique<SectionTerms>();
      made->unknowns = &u;
      made->section = &section;
      made->at = u.at(section.offset_mm);
      made->feet.assign(foot, foot + std::ssize(section.samples));
      foot += std::ssize(section.samples);
      terms.sections.push_back(std::move(made));
    }
  }
  for (const PartSeam& seam : seams) {
    // What stands between two families bends no more often than they do.
    constexpr std::size_t kPerCoefficient = 6;
    const int coefficients =
        std::max(unknowns[seam.first].basis.count(), unknowns[seam.second].basis.count());
    const std::vector<const SeamPlace*> places =
        spread(seam.places, kPerCoefficient * static_cast<std::size_t>(1 + coefficients));
    const double weight = std::sqrt(kSeamWeight / static_cast<double>(SeamPlace::kProbes * places.size()));
    for (const SeamPlace* place : places) {
      for (std::size_t i = 0; i < SeamPlace::kProbes; ++i) {
        auto probe = std::make_unique<ProbeTerms>();
        probe->weight = weight;
        for (std::size_t side = 0; side < 2; ++side) {
          Unknowns& u = unknowns[side == 0 ? seam.first : seam.second];
          const FormedPoint& point = place->on[side][i];
          probe->sides[side] = {&u, &point, u.at(point.offset_mm), point.sample.q.x() - u.part->start.x_mm};
        }
        terms.probes.push_back(std::move(probe));
      }
    }
  }
  // The costs take their sizes from a first evaluation.
  terms.PrepareForEvaluation(true, true);
  gpu::stop_point();
  ceres::Problem::Options owned;
  owned.evaluation_callback = &terms;
  ceres::Problem problem(owned);
  for (const auto& section : terms.sections)
    problem.AddResidualBlock(new SectionCost(*section), nullptr, blocks_at(*section->unknowns, section->at));
  for (std::vector<const ProbeTerms*>& probes : by_blocks(terms.probes)) {
    std::vector<double*> blocks;
    for (const ProbeTerms::Side& side : probes.front()->sides) {
      const std::vector<double*> some = blocks_at(*side.unknowns, side.at);
      blocks.insert(blocks.end(), some.begin(), some.end());
    }
    problem.AddResidualBlock(new ProbesCost(std::move(probes)), nullptr, blocks);
  }
  for (Unknowns& u : unknowns) {
    if (!u.part->held) {
      add_smoothness(problem, u);
      continue;
    }
    for (int k = 0; k < u.basis.count(); ++k) {
      if (problem.HasParameterBlock(u.block(k))) problem.SetParameterBlockConstant(u.block(k));
    }
  }
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  solver.num_threads = 1;  // sums of several threads would differ with their number
  solver.max_num_iterations = 15;
  solver.function_tolerance = 1e-4;
  solver.logging_type = ceres::SILENT;
  // A step takes about what the fits of an eighth of the parts take.
  constexpr std::size_t kPartsPerFit = 8;
  Watched watched(watch, 1 + parts.size() / kPartsPerFit);
  solver.callbacks = {&watched};
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  gpu::stop_point();
  watched.rethrow();
  std::vector<SweepFitReport> reports(unknowns.size());
  tbb::parallel_for(std::size_t{0}, unknowns.size(), [&](std::size_t i) {
    if (!unknowns[i].part->held) reports[i] = report_of(unknowns[i], summary);
  });
  gpu::stop_point();
  return reports;
}

}  // namespace hotblade::pipeline
