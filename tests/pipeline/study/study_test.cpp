// hotblade study and what it is made of.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>

#include "pipeline/study/arc_measures.hpp"
#include "pipeline/study/distribution.hpp"
#include "pipeline/study/quadratic_oracle.hpp"
#include "pipeline/study/random_curves.hpp"
#include "pipeline/study/study.hpp"
#include "pipeline/study/svg_plot.hpp"
#include "tests/pipeline/run_program.hpp"

namespace hotblade::pipeline::study {
namespace {

TEST(Distribution, PutsQuantilesAtTheirRanks) {
  std::vector<double> values;
  for (int i = 0; i < 1000; ++i) values.push_back((i * 387 % 1000) + 1);  // 1 to 1000, shuffled
  const Distribution d = distribution(values);
  EXPECT_NEAR(d.mean, 500.5, 1e-9);
  EXPECT_EQ(d.median, 501);
  EXPECT_EQ(d.p99, 991);
  EXPECT_EQ(d.p9999, 1000);
  EXPECT_EQ(d.max, 1000);
}

TEST(CurveRandom, IsUniformAndADifferentStreamForEverySeedAndIndex) {
  double sum = 0, square = 0;
  constexpr int n = 100000;
  for (int i = 0; i < n; ++i) {
    const double v = CurveRandom(5, static_cast<std::uint64_t>(i)).unit();
    sum += v / n;
    square += v * v / n;
  }
  // Standard errors 0.0009 and 0.0009.
  EXPECT_NEAR(sum, 0.5, 0.004);
  EXPECT_NEAR(square, 1.0 / 3, 0.004);
  EXPECT_NE(CurveRandom(1, 2).unit(), CurveRandom(2, 1).unit());
}

TEST(DiscCurve, LiesInTheUnitDiscAndInsideTheConstraints) {
  const elastica::AngleConstraints narrow{std::numbers::pi / 3, 0.1 * std::numbers::pi};
  for (std::uint64_t i = 0; i < 500; ++i) {
    const elastica::Bezier b = disc_curve(3, i, narrow);
    for (const auto& p : b) EXPECT_LE(p.norm(), 1);
    EXPECT_TRUE(angle_constraints_hold(*elastica::standard_position(b), narrow));
  }
}

TEST(SvgPlot, RefusesAnAxisWithoutLength) {
  EXPECT_THROW(SvgPlot({"t", "x", "y", 1, 1, 0, 1}), std::logic_error);
}

TEST(SvgPlot, LeavesOutPointsOutsideTheAxesAndEscapesText) {
  SvgPlot plot({"a < b & c", "x", "y", 0, 1, 0, 1});
  const Eigen::Vector2d dots[] = {{0.5, 0.5}, {2, 0.5}, {0.5, std::nan("")}};
  plot.points(dots, "#123456", 2, "dots");
  const SvgPlot plots[] = {plot};
  const std::string svg = svg_page(plots);
  const std::size_t path = svg.find("<path d=\"M");
  ASSERT_NE(path, std::string::npos);
  EXPECT_EQ(svg.substr(path, svg.find("fill", path) - path).find('M', 10), std::string::npos);
  EXPECT_NE(svg.find("a &lt; b &amp; c"), std::string::npos);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
}

TEST(DistanceToArc, IsThatOfTheNearestOfManyPoints) {
  for (std::uint64_t i = 0; i < 300; ++i) {
    CurveRandom random(4, i);
    const double kappa = i % 3 == 0 ? 1e-7 * random.between(-1, 1) : random.between(-2, 2);
    const elastica::Arc arc{random.between(-1, 1), random.between(-1, 1), random.between(-3, 3),
                            i % 7 == 0 ? 0 : kappa, random.between(0.1, 3)};
    const Eigen::Vector2d p{random.between(-3, 3), random.between(-3, 3)};
    double nearest = INFINITY;
    constexpr int n = 4000;
    for (int k = 0; k <= n; ++k)
      nearest = std::min(nearest, (point_at(arc, arc.length * k / n).position() - p).norm());
    EXPECT_LE(distance_to(arc, p), nearest + 1e-14);
    EXPECT_GE(distance_to(arc, p), nearest - arc.length / n);
  }
}

TEST(RandomSpiral, RunsSmoothlyFromOneCurvatureToTheOtherOverItsLength) {
  CurveRandom random(6, 0);
  const auto arcs = random_spiral(random, 1.5, 0.2, 1.4);
  double length = 0;
  for (std::size_t i = 0; i < arcs.size(); ++i) {
    length += arcs[i].length;
    if (i == 0) continue;
    EXPECT_LE(arcs[i].kappa, arcs[i - 1].kappa);
    const elastica::CurvePoint joint = point_at(arcs[i - 1], arcs[i - 1].length);
    EXPECT_EQ(joint.x, arcs[i].x);
    EXPECT_EQ(joint.theta, arcs[i].theta);
  }
  EXPECT_EQ(arcs.front().kappa, 1.5);
  EXPECT_NEAR(arcs.back().kappa, 0.2, 1e-15);
  EXPECT_NEAR(length, 1.4, 1e-14);
}

TEST(BisectedArcs, OfACircleAreTwoForEverySpiralAndHalveWhereTheToleranceAsks) {
  const elastica::ElasticaCurve circle({0, 0, 0, 0.01, 0, 0, 250});
  const double whole[] = {0, 250}, two[] = {0, 100, 250};
  EXPECT_EQ(bisected_arcs(circle, whole, 1e-9, Joint::kEqualChords).arcs, 2u);
  EXPECT_EQ(bisected_arcs(circle, two, 1e-9, Joint::kEqualChords).arcs, 4u);
  const elastica::ElasticaCurve blade({0, 0, 0.2, 3e-3, 2e-5, -1e-5, 200});
  const double ends[] = {0, 200};
  EXPECT_GT(bisected_arcs(blade, ends, 1e-6, Joint::kEqualChords).arcs,
            bisected_arcs(blade, ends, 1e-2, Joint::kEqualChords).arcs);
}

TEST(StudyArcs, FindsNoArcBeyondItsBoundAndNoBrokenTheorem) {
  const StudyReport report = study_arcs({10, 400, 3, {}});
  const auto& f = report.figures;
  for (const auto& row : f.at("fits")) {
    EXPECT_LT(row.at("length_off"), 1e-12);
    EXPECT_EQ(row.at("above_bound"), 0);
    EXPECT_LE(row.at("largest_share_of_bound"), 1);
    EXPECT_GT(row.at("largest_share_of_bound"), 0.1);
    EXPECT_GT(row.at("plain_length_off"), 1e3 * row.at("length_off").get<double>());
    EXPECT_GT(row.at("biarcs"), row.at("halved_length_kept"));  // the bound is no measurement
  }
  EXPECT_NEAR(f.at("order_of_bound"), 3, 0.05);
  EXPECT_NEAR(f.at("order_of_deviation"), 3, 0.05);
  EXPECT_GT(f.at("spirals"), 390);
  for (const auto& broken : f.at("broken")) EXPECT_EQ(broken, 0);
  ASSERT_EQ(f.at("oval_contacts_pi").size(), 2u);
  EXPECT_NEAR(f.at("oval_contacts_pi")[0], 0.79, 0.005);
  EXPECT_NEAR(f.at("oval_contacts_pi")[1], 1.07, 0.005);
  EXPECT_TRUE(f.at("oval_contacts_pi_k1_0.42").empty());
}

TEST(Quadrature, IsExactOnThePartOfTheUnitParabola) {
  // y = x^2 over [0, 1/2], where 2x runs to 1: length (sqrt 2 + asinh 1)/4; energy Int 2 (1 + 4 x^2)^-5/2 dx,
  // which is s - s^3/3 at s = 1/sqrt 2.
  const QuadraticIntegrals q =
      quadrature({Eigen::Vector2d(0, 0), Eigen::Vector2d(0.25, 0), Eigen::Vector2d(0.5, 0.25)});
  const double s = std::sqrt(0.5);
  EXPECT_DOUBLE_EQ(q.length, (std::sqrt(2.0) + std::asinh(1.0)) / 4);
  EXPECT_DOUBLE_EQ(q.energy, s - s * s * s / 3);
}

TEST(Quadrature, DoesNotKnowTheDirectionOfTravelOrTheScale) {
  for (std::uint64_t i = 0; i < 50; ++i) {
    const elastica::Quadratic q = random_triangle(9, i);
    const QuadraticIntegrals one = quadrature(q), back = quadrature({q[2], q[1], q[0]}),
                             large = quadrature({8 * q[0], 8 * q[1], 8 * q[2]});
    EXPECT_DOUBLE_EQ(one.length, back.length);
    EXPECT_DOUBLE_EQ(one.energy, back.energy);
    EXPECT_DOUBLE_EQ(8 * one.length, large.length);
    EXPECT_DOUBLE_EQ(one.energy / 8, large.energy);
  }
}

TEST(SampledMinima, OfALineLieWhereSymmetryPutsThem) {
  TangentProblem p;
  p.b0 = {-1, 0.5};
  p.b2 = {1, 0.5};
  p.place = {3, 0};
  const auto found = sampled_minima(p, 1001);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_LT((found[0].b1 - Eigen::Vector2d(0, -0.5)).norm(), found[0].step);
}

TEST(TangentLocus, MakesCurvesThatTouchTheCircle) {
  TangentProblem p;
  p.b0 = {-2, 1};
  p.b2 = {2, 1.5};
  p.radius = 1;
  p.circle = true;
  int tried = 0;
  for (int i = 0; i < 360; ++i) {
    const double theta = i * std::numbers::pi / 180;
    const Eigen::Vector2d b1 = locus(p, theta), n{std::cos(theta), std::sin(theta)};
    if (!b1.allFinite()) continue;
    ++tried;
    // On the side of the tangent where its ends are, the curve comes down to it and does not cross.
    const double side = std::copysign(1.0, n.dot(p.b0) - 1);
    double nearest = INFINITY;
    for (int k = 0; k <= 2000; ++k) {
      const Eigen::Vector2d at = elastica::point_at({p.b0, b1, p.b2}, k / 2000.0);
      nearest = std::min(nearest, side * (n.dot(at) - 1));
    }
    EXPECT_LT(nearest, 1e-5 * (1 + b1.squaredNorm()));
    EXPECT_GT(nearest, -1e-13 * (1 + b1.squaredNorm()));
  }
  EXPECT_GT(tried, 100);
}

TEST(StudyQuadratic, FindsFormsRightToRoundingAndNoMinimumMissed) {
  const StudyReport report = study_quadratic({500, 210, 3, {}});
  const auto& f = report.figures;
  for (const auto& row : f.at("relative_errors")) {
    EXPECT_EQ(row.at("count"), 100);
    EXPECT_LT(row.at("length").at("max"), 3e-15);
    EXPECT_LT(row.at("energy").at("max"), 3e-15);
    EXPECT_GT(row.at("energy").at("max"), 0);
  }
  std::size_t sampled = 0;
  ASSERT_EQ(f.at("tangent").size(), 14u);
  for (const auto& row : f.at("tangent")) {
    EXPECT_EQ(row.at("problems"), 15);
    EXPECT_EQ(row.at("missed"), 0) << row;
    EXPECT_EQ(row.at("undercut"), 0) << row;
    EXPECT_LT(row.at("tangency"), 1e-13) << row;
    sampled += row.at("sampled").get<std::size_t>();
  }
  EXPECT_GT(sampled, 210u);
  EXPECT_EQ(report.remarks.size(), 4u);  // the speeds, which are no part of the figures
}

struct SmallStudy {
  const char* name;
  const char *samples, *checked;
};
class StudyCommand : public ::testing::TestWithParam<SmallStudy> {};

TEST_P(StudyCommand, WritesTheSameBytesWithOneAndTwoThreads) {
  const testing::TemporaryDirectory directory;
  std::vector<std::string> printed;
  for (const char* jobs : {"1", "2"}) {
    const testing::Ended run = testing::hotblade({"study", GetParam().name, "--samples", GetParam().samples,
                                                  "--checked", GetParam().checked, "--seed", "7", "--json",
                                                  "--jobs", jobs, "-o", (directory / jobs).string()});
    ASSERT_EQ(run.code, 0) << run.err;
    printed.push_back(run.out);
    EXPECT_TRUE(nlohmann::json::accept(run.out));
  }
  EXPECT_EQ(printed[0], printed[1]);
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(directory / "1")) {
    const auto other = directory / "2" / entry.path().filename();
    EXPECT_EQ(testing::read_bytes(entry.path()), testing::read_bytes(other)) << other;
    ++files;
  }
  EXPECT_GE(files, 2u);
}

INSTANTIATE_TEST_SUITE_P(EveryStudy, StudyCommand,
                         ::testing::Values(SmallStudy{"projection", "130", "2"},
                                           SmallStudy{"zone", "130", "2"}, SmallStudy{"arcs", "8", "200"},
                                           SmallStudy{"quadratic", "300", "70"}),
                         [](const auto& one) { return std::string(one.param.name); });

TEST(StudyCommandLine, DoesNotOverwriteWithoutForce) {
  const testing::TemporaryDirectory directory;
  const std::vector<std::string> words{"study",     "zone", "--samples", "100",
                                       "--checked", "1",    "-o",        (directory / "out").string()};
  EXPECT_EQ(testing::hotblade(words).code, 0);
  EXPECT_EQ(testing::hotblade(words).code, 7);
}

}  // namespace
}  // namespace hotblade::pipeline::study
