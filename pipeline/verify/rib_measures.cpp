#include "pipeline/verify/rib_measures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "gpu/curve/lambda_residuals.hpp"
#include "gpu/curve/pair_distance.hpp"
#include "pipeline/sayings/saying.hpp"

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

// The cubics of some ribs, rib by rib.
struct Cubics {
  std::vector<Cubic> all;
  std::vector<std::size_t> count;  // by rib
};

Cubics cubics_of(std::span<const Rib* const> ribs) {
  Cubics cubics;
  for (const Rib* rib : ribs) {
    const std::vector<Cubic> own = pipeline::cubics(*rib);
    cubics.all.insert(cubics.all.end(), own.begin(), own.end());
    cubics.count.push_back(own.size());
  }
  return cubics;
}

// Of n cubics for equal lengths: squared distances are relative to a part's length, squared angles are means.
RibMeasure together(std::span<const gpu::PairDistance> parts) {
  if (parts.size() == 1) return {parts[0].l2, parts[0].h1, parts[0].hausdorff, parts[0].hausdorff_error};
  const auto n = static_cast<double>(parts.size());
  double distance2 = 0, angle2 = 0;
  RibMeasure m;
  for (const gpu::PairDistance& p : parts) {
    distance2 += p.l2 * p.l2 / (n * n * n);
    angle2 += std::max(0.0, p.h1 * p.h1 - p.l2 * p.l2) / n;
    m.hausdorff_mm = std::max(m.hausdorff_mm, p.hausdorff);
    m.hausdorff_error_mm = std::max(m.hausdorff_error_mm, p.hausdorff_error);
    if (!std::isfinite(p.hausdorff) || !std::isfinite(p.h1))
      distance2 = std::numeric_limits<double>::quiet_NaN();
  }
  m.l2 = std::sqrt(distance2);
  m.h1 = std::sqrt(distance2 + angle2);
  return m;
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
  void residual(double measured, double bound) const {
    compare("lambda_residual", rib_.lambda_residual, measured, kRibResidualAbs + bound);
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

// A distance counts as over the limit where it is proven to be.
void hold_beziers(const Program& program, const RibMeasures& measures, double tolerance_mm, RibCheck& check) {
  check.bezier_limit_mm = kBezierShare * tolerance_mm;
  auto measure = measures.ribs.begin();
  for (const Strip& strip : program.strips) {
    for (const Rib& rib : strip.ribs) {
      const double least = measure->hausdorff_mm - measure->hausdorff_error_mm;
      check.bezier_mm.push_back(measure->hausdorff_mm);
      // Written so that what is not a number is over it.
      if (!(least <= check.bezier_limit_mm) || !std::isfinite(measure->h1)) {
        const double proven = std::isfinite(measure->h1) ? least : std::numeric_limits<double>::quiet_NaN();
        check.far.push_back({strip.id, rib.id, proven, check.bezier_limit_mm});
      }
      ++measure;
    }
  }
}

}  // namespace

RibMeasures measured_ribs(const Program& program, gpu::Backend backend) {
  const std::vector<const Rib*> ribs = ribs_of(program);
  const Cubics cubics = cubics_of(ribs);
  std::vector<gpu::ElasticaState> elastica;
  for (std::size_t i = 0; i < ribs.size(); ++i) {
    const double length = ribs[i]->elastica.length / static_cast<double>(cubics.count[i]);
    for (std::size_t k = 0; k < cubics.count[i]; ++k) {
      const elastica::Elastica e = cubics.count[i] == 1
                                       ? ribs[i]->elastica
                                       : segment(ribs[i]->elastica, static_cast<double>(k) * length,
                                                 static_cast<double>(k + 1) * length);
      elastica.push_back({e.x, e.y, e.theta, e.kappa, e.lambda1, e.lambda2, e.length});
    }
  }
  std::vector<gpu::PairDistance> answers(cubics.all.size());
  const gpu::PairDistances pairs(backend);
  (void)pairs.query(cubics.all, elastica, kRibHausdorffErrorMm, answers);
  RibMeasures measures;
  std::size_t first = 0;
  for (const std::size_t count : cubics.count) {
    measures.ribs.push_back(together(std::span(answers).subspan(first, count)));
    first += count;
  }
  measures.used = pairs.used();
  return measures;
}

RibCheck check_ribs(const Program& program, double tolerance_mm, gpu::Backend backend) {
  const std::vector<const Rib*> ribs = ribs_of(program);
  const RibMeasures measures = measured_ribs(program, backend);
  const Cubics cubics = cubics_of(ribs);
  std::vector<double> residuals(cubics.all.size()), bounds(cubics.all.size());
  std::vector<gpu::ResidualStatus> status(cubics.all.size());
  gpu::LambdaResiduals(backend).query(cubics.all, residuals, status, bounds);
  RibCheck check;
  check.ribs = ribs.size();
  check.used = measures.used;
  hold_beziers(program, measures, tolerance_mm, check);
  std::size_t first = 0;
  for (std::size_t i = 0; i < ribs.size(); ++i) {
    const Comparison comparison(*ribs[i], check.mismatches);
    comparison.differences(measures.ribs[i]);
    // A rib's residual is the largest of its cubics'.
    double largest = 0, bound = 0;
    bool known = true;
    for (std::size_t k = first; k < first + cubics.count[i]; ++k) {
      known =
          known && status[k] == gpu::ResidualStatus::kOk && bend_of(cubics.all[k]) >= kRibResidualLeastBend;
      largest = std::max(largest, residuals[k]);
      bound = std::max(bound, bounds[k]);
    }
    if (known) comparison.residual(largest, bound);
    first += cubics.count[i];
  }
  return check;
}

std::string describe(const RibMismatch& m) {
  return fmt::format("{}: {} is {:.6g} in the program, {:.6g} when measured (bound {:.1e})", m.rib, m.number,
                     m.stated, m.measured, m.bound);
}

std::string describe(const FarBezier& b) {
  const std::string off = std::isfinite(b.hausdorff_mm)
                              ? fmt::format("Bezier {:.4g} mm off its elastica", b.hausdorff_mm)
                              : std::string("Bezier or elastica that cannot be measured");
  return fmt::format("strip {}, rib {}: {} (limit {:.4g} mm)", b.strip, b.rib, off, b.limit_mm);
}

Refusal refusal_of(const FarBezier& b) {
  Refusal refusal{b.strip, b.rib, Limit::kRibDeviation, b.hausdorff_mm, b.limit_mm};
  refusal.when = say(Saying::kFromItsBezier);
  refusal.note = say(Saying::kTenthForBezier);
  return refusal;
}

std::string describe_beziers(const RibCheck& check) {
  std::vector<double> sorted = check.bezier_mm;
  std::sort(sorted.begin(), sorted.end());
  const auto at = [&](double share) {
    return sorted.empty()
               ? 0.0
               : sorted[static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size() - 1)))];
  };
  return fmt::format(
      "Beziers of {} ribs off their elastica: max {:.4f} mm, p99 {:.4f} mm, {} over {:.4g} mm, a tenth of "
      "the "
      "tolerance",
      check.ribs, at(1), at(0.99), check.far.size(), check.bezier_limit_mm);
}

}  // namespace hotblade::pipeline
