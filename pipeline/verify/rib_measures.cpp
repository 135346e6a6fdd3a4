#include "pipeline/verify/rib_measures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "gpu/curve/lambda_residuals.hpp"
#include "gpu/curve/pair_distance.hpp"

namespace hotblade::pipeline {
namespace {

using Cubic = std::array<Eigen::Vector2d, 4>;

std::vector<const Rib*> ribs_of(const Program& program) {
  std::vector<const Rib*> ribs;
  for (const Strip& strip : program.strips) {
    for (const Rib& rib : strip.ribs) ribs.push_back(&rib);
  }
  return ribs;
}

std::vector<Cubic> cubics_of(std::span<const Rib* const> ribs) {
  std::vector<Cubic> cubics;
  for (const Rib* rib : ribs) cubics.push_back(rib->bezier);
  return cubics;
}

// Distance of the farther inner control point from the chord's line, in chords; infinity without a chord.
double bend_of(const Cubic& b) {
  const Eigen::Vector2d chord = b[3] - b[0];
  const auto off = [&](const Eigen::Vector2d& p) {
    return std::abs(chord.x() * (p - b[0]).y() - chord.y() * (p - b[0]).x()) / chord.squaredNorm();
  };
  return chord.squaredNorm() > 0 ? std::max(off(b[1]), off(b[2])) : std::numeric_limits<double>::infinity();
}

// Numbers of one rib against what was measured.
class Comparison {
 public:
  Comparison(const Rib& rib, std::vector<RibMismatch>& mismatches) : rib_(rib), mismatches_(mismatches) {}

  void differences(const RibMeasure& m) const {
    compare("l2", rib_.l2, m.l2, kRibDifferenceRel * m.l2 + kRibDifferenceAbs);
    compare("h1", rib_.h1, m.h1, kRibDifferenceRel * m.h1 + kRibDifferenceAbs);
    compare("hausdorff_mm", rib_.hausdorff_mm, m.hausdorff_mm,
            kRibHausdorffRel * rib_.elastica.length + m.hausdorff_error_mm);
  }
  void residual(double measured) const {
    compare("lambda_residual", rib_.lambda_residual, measured, kRibResidualAbs);
  }

 private:
  // Written so that a measure that is not a number is a mismatch.
  void compare(const char* number, double stated, double measured, double bound) const {
    if (!(std::abs(stated - measured) <= bound))
      mismatches_.push_back({rib_.id, number, stated, measured, bound});
  }

  const Rib& rib_;
  std::vector<RibMismatch>& mismatches_;
};

}  // namespace

RibMeasures measured_ribs(const Program& program, gpu::Backend backend) {
  const std::vector<const Rib*> ribs = ribs_of(program);
  const std::vector<Cubic> cubics = cubics_of(ribs);
  std::vector<gpu::ElasticaState> elastica;
  for (const Rib* rib : ribs) {
    const elastica::Elastica& e = rib->elastica;
    elastica.push_back({e.x, e.y, e.theta, e.kappa, e.lambda1, e.lambda2, e.length});
  }
  std::vector<gpu::PairDistance> answers(ribs.size());
  const gpu::PairDistances pairs(backend);
  (void)pairs.query(cubics, elastica, kRibHausdorffErrorMm, answers);
  RibMeasures measures;
  for (const gpu::PairDistance& a : answers) {
    measures.ribs.push_back({a.l2, a.h1, a.hausdorff, a.hausdorff_error});
  }
  measures.used = pairs.used();
  return measures;
}

RibCheck check_ribs(const Program& program, gpu::Backend backend) {
  const std::vector<const Rib*> ribs = ribs_of(program);
  const RibMeasures measures = measured_ribs(program, backend);
  const std::vector<Cubic> cubics = cubics_of(ribs);
  std::vector<double> residuals(ribs.size());
  std::vector<gpu::ResidualStatus> status(ribs.size());
  gpu::LambdaResiduals(backend).query(cubics, residuals, status);
  RibCheck check{ribs.size(), {}, measures.used};
  for (std::size_t i = 0; i < ribs.size(); ++i) {
    const Comparison comparison(*ribs[i], check.mismatches);
    comparison.differences(measures.ribs[i]);
    if (status[i] == gpu::ResidualStatus::kOk && bend_of(cubics[i]) >= kRibResidualLeastBend)
      comparison.residual(residuals[i]);
  }
  return check;
}

std::string describe(const RibMismatch& m) {
  return fmt::format("{}: {} is {:.6g} in the program, {:.6g} when measured (bound {:.1e})", m.rib, m.number,
                     m.stated, m.measured, m.bound);
}

}  // namespace hotblade::pipeline
