// What a plan says of its ribs, against the one-pair routines, and what verify finds when a program says
// otherwise.
#include "pipeline/verify/rib_measures.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "elastica/bezier/curve_distance.hpp"
#include "elastica/bezier/lambda_residual.hpp"
#include "elastica/fit/bezier_spline.hpp"
#include "pipeline/plan/plan.hpp"
#include "tests/pipeline/plan_design.hpp"

namespace hotblade::pipeline {
namespace {

const Program& arch_program() {
  static const Program program = plan(cylinder_design(), along_x(), {}).program;
  return program;
}

std::vector<Rib> ribs_of(const Program& program) {
  std::vector<Rib> ribs;
  for (const Strip& strip : program.strips) ribs.insert(ribs.end(), strip.ribs.begin(), strip.ribs.end());
  return ribs;
}

RibCheck checked(const Program& program) {
  return check_ribs(program, program.verification.tolerance_mm, gpu::Backend::kCpu);
}

TEST(RibMeasures, OfAPlanAreThoseOfTheOnePairRoutine) {
  const std::vector<Rib> ribs = ribs_of(arch_program());
  ASSERT_GT(ribs.size(), 3u);
  for (const Rib& rib : ribs) {
    ASSERT_EQ(cubics(rib).size(), 1u);
    const elastica::CurveDistance d = distance(cubics(rib)[0], rib.elastica);
    EXPECT_NEAR(rib.l2, d.l2, 1e-4 * d.l2 + 1e-9) << rib.id;
    EXPECT_NEAR(rib.h1, d.h1, 1e-4 * d.h1 + 1e-9) << rib.id;
    // Both bound the distance from above.
    EXPECT_GE(rib.hausdorff_mm, d.hausdorff - d.hausdorff_error - 1e-9) << rib.id;
    EXPECT_LE(rib.hausdorff_mm - kRibHausdorffErrorMm, d.hausdorff + 1e-9) << rib.id;
  }
}

TEST(RibMeasures, AreTheSameBitsAsThePlansOnEveryBackend) {
  const std::vector<Rib> ribs = ribs_of(arch_program());
  for (const gpu::Backend backend : {gpu::Backend::kCpu, gpu::Backend::kAuto, gpu::Backend::kOpenCl}) {
    const RibMeasures measures = measured_ribs(arch_program(), backend);
    ASSERT_EQ(measures.ribs.size(), ribs.size());
    for (std::size_t i = 0; i < ribs.size(); ++i) {
      const double is[] = {measures.ribs[i].l2, measures.ribs[i].h1, measures.ribs[i].hausdorff_mm},
                   stated[] = {ribs[i].l2, ribs[i].h1, ribs[i].hausdorff_mm};
      EXPECT_EQ(std::memcmp(is, stated, sizeof is), 0) << ribs[i].id;
      EXPECT_LE(measures.ribs[i].hausdorff_error_mm, kRibHausdorffErrorMm * (1 + 1e-9));
    }
  }
}

TEST(RibMeasures, OfAPlanAgreeWithItsProgram) {
  const RibCheck check = checked(arch_program());
  EXPECT_EQ(check.ribs, ribs_of(arch_program()).size());
  EXPECT_TRUE(check.mismatches.empty()) << describe(check.mismatches.front());
}

TEST(RibMeasures, FindEveryNumberThatIsNotWhatWasMeasured) {
  struct Change {
    const char* name;
    double Rib::*number;
    double by;
  };
  const Rib& sound = arch_program().strips[0].ribs[1];
  const Change changes[] = {{"l2", &Rib::l2, 0.1 * sound.l2},
                            {"h1", &Rib::h1, -0.1 * sound.h1},
                            {"hausdorff_mm", &Rib::hausdorff_mm, 0.005},
                            {"lambda_residual", &Rib::lambda_residual, 1e-5}};
  for (const Change& change : changes) {
    Program program = arch_program();
    double& number = program.strips[0].ribs[1].*change.number;
    const double was = number;
    number += change.by;
    const RibCheck check = checked(program);
    ASSERT_EQ(check.mismatches.size(), 1u) << change.name;
    EXPECT_EQ(check.mismatches[0].rib, sound.id);
    EXPECT_EQ(check.mismatches[0].number, change.name);
    EXPECT_EQ(check.mismatches[0].stated, number);
    EXPECT_NEAR(check.mismatches[0].measured, was, check.mismatches[0].bound);
  }
}

TEST(RibMeasures, FindACurveThatIsNotTheOneMeasured) {
  Program program = arch_program();
  Rib& rib = program.strips[0].ribs[2];
  rib.elastica.kappa *= 1.01;
  for (const RibMismatch& m : checked(program).mismatches) EXPECT_EQ(m.rib, rib.id);
  EXPECT_EQ(checked(program).mismatches.size(), 3u);
  // One that winds beyond any blade has no measures to agree with.
  rib.elastica.kappa = 10;
  const RibCheck wound = checked(program);
  ASSERT_EQ(wound.mismatches.size(), 3u);
  EXPECT_TRUE(std::isnan(wound.mismatches[0].measured));
}

TEST(RibMeasures, OfProgramsOfVersion01Agree) {
  Program program = arch_program();
  for (Strip& strip : program.strips) {
    for (Rib& rib : strip.ribs) {
      const elastica::CurveDistance d = distance(cubics(rib)[0], rib.elastica);
      rib.l2 = d.l2;
      rib.h1 = d.h1;
      rib.hausdorff_mm = d.hausdorff;
      rib.lambda_residual = elastica::lambda_residual(cubics(rib)[0]).value;
    }
  }
  EXPECT_TRUE(checked(program).mismatches.empty());
}

TEST(RibMeasures, OfSeveralCubicsAreThoseOfAllTogether) {
  Program program = arch_program();
  Rib& rib = program.strips[0].ribs[1];
  const double near_mm = 1e-3;
  const std::vector<elastica::Bezier> pieces = elastica::bezier_spline(rib.elastica, near_mm);
  ASSERT_GT(pieces.size(), 1u);
  rib.bezier = {pieces[0][0]};
  double residual = 0;
  for (const elastica::Bezier& piece : pieces) {
    rib.bezier.insert(rib.bezier.end(), piece.begin() + 1, piece.end());
    residual = std::max(residual, elastica::lambda_residual(piece).value);
  }
  const RibMeasure m = measured_ribs(program, gpu::Backend::kCpu).ribs[1];
  EXPECT_LE(m.hausdorff_mm, near_mm + kRibHausdorffErrorMm);
  // The same by dense points at equal shares of the length: the cubics run along it almost evenly.
  constexpr int kDense = 4000;
  const double length = rib.elastica.length, n = static_cast<double>(pieces.size());
  double squares = 0;
  for (int i = 0; i < kDense; ++i) {
    const double share = (i + 0.5) / kDense;
    const auto piece = static_cast<std::size_t>(share * n);
    const Eigen::Vector2d p = elastica::evaluate(pieces[piece], share * n - static_cast<double>(piece)).p;
    squares += (p - elastica::point_at(rib.elastica, share * length).position()).squaredNorm() / kDense;
  }
  EXPECT_NEAR(m.l2, std::sqrt(squares) / length, 0.05 * m.l2 + 1e-9);
  rib.l2 = m.l2;
  rib.h1 = m.h1;
  rib.hausdorff_mm = m.hausdorff_mm;
  rib.lambda_residual = residual;
  EXPECT_TRUE(checked(program).mismatches.empty());
  rib.h1 *= 1.5;
  EXPECT_EQ(checked(program).mismatches.size(), 1u);
}

TEST(RibMeasures, HoldBeziersToATenthOfTheTolerance) {
  const RibCheck sound = checked(arch_program());
  const double limit_mm = 0.1 * arch_program().verification.tolerance_mm;
  EXPECT_DOUBLE_EQ(sound.bezier_limit_mm, limit_mm);
  EXPECT_TRUE(sound.far.empty());
  ASSERT_EQ(sound.bezier_mm.size(), sound.ribs);
  EXPECT_LE(*std::max_element(sound.bezier_mm.begin(), sound.bezier_mm.end()),
            limit_mm + kRibHausdorffErrorMm);

  Program program = arch_program();
  Rib& rib = program.strips[0].ribs[1];
  for (Eigen::Vector2d& p : rib.bezier) p.y() += 3 * limit_mm;
  const RibCheck moved = checked(program);
  ASSERT_EQ(moved.far.size(), 1u);
  EXPECT_EQ(moved.far[0].strip, program.strips[0].id);
  EXPECT_EQ(moved.far[0].rib, rib.id);
  EXPECT_NEAR(moved.far[0].hausdorff_mm, 3 * limit_mm, limit_mm);
  EXPECT_EQ(moved.far[0].limit_mm, limit_mm);
  const std::string line = describe(moved.far[0]);
  EXPECT_NE(line.find("strip " + program.strips[0].id + ", rib " + rib.id), std::string::npos) << line;
  EXPECT_NE(line.find("limit 0.1 mm"), std::string::npos) << line;
  const std::string refusal = describe(refusal_of(moved.far[0]));
  EXPECT_NE(refusal.find(rib.id + ": deviation of an elastica"), std::string::npos) << refusal;
  EXPECT_NE(refusal.find("from its Bezier"), std::string::npos) << refusal;
  EXPECT_NE(describe_beziers(moved).find("1 over 0.1 mm"), std::string::npos) << describe_beziers(moved);
}

TEST(RibMeasures, ThatCannotBeTakenAreOverTheLimit) {
  Program program = arch_program();
  program.strips[0].ribs[2].elastica.kappa = 10;
  const RibCheck wound = checked(program);
  ASSERT_EQ(wound.far.size(), 1u);
  EXPECT_NE(describe(wound.far[0]).find("cannot be measured"), std::string::npos);
}

TEST(RibMeasures, OfNoRibsAreNone) {
  EXPECT_TRUE(measured_ribs({}, gpu::Backend::kCpu).ribs.empty());
  EXPECT_EQ(checked({}).ribs, 0u);
}

}  // namespace
}  // namespace hotblade::pipeline
