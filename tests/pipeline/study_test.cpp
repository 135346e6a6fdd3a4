// hotblade study and what it is made of.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>

#include "pipeline/study/distribution.hpp"
#include "pipeline/study/random_curves.hpp"
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

class StudyCommand : public ::testing::TestWithParam<const char*> {};

TEST_P(StudyCommand, WritesTheSameBytesWithOneAndTwoThreads) {
  const testing::TemporaryDirectory directory;
  std::vector<std::string> printed;
  for (const char* jobs : {"1", "2"}) {
    const testing::Ended run =
        testing::hotblade({"study", GetParam(), "--samples", "130", "--checked", "2", "--seed", "7", "--json",
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

INSTANTIATE_TEST_SUITE_P(EveryStudy, StudyCommand, ::testing::Values("projection", "zone"),
                         [](const auto& one) { return std::string(one.param); });

TEST(StudyCommandLine, DoesNotOverwriteWithoutForce) {
  const testing::TemporaryDirectory directory;
  const std::vector<std::string> words{"study",     "zone", "--samples", "100",
                                       "--checked", "1",    "-o",        (directory / "out").string()};
  EXPECT_EQ(testing::hotblade(words).code, 0);
  EXPECT_EQ(testing::hotblade(words).code, 7);
}

}  // namespace
}  // namespace hotblade::pipeline::study
