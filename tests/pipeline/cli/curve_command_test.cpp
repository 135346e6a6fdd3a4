// hotblade curve as other programs call it.
#include <gmock/gmock.h>
#include <sys/wait.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/paths.hpp"
#include "tests/pipeline/temporary_directory.hpp"

namespace hotblade::pipeline {
namespace {

struct Answers {
  int code = 0;
  std::vector<nlohmann::json> lines;
};

Answers curve(const std::string& arguments, const std::string& input) {
  const testing::TemporaryDirectory directory;
  const std::string in = (directory / "in.jsonl").string();
  std::ofstream(in) << input;
  const std::string command = hotblade::testing::binary_dir() + "/hotblade curve " + arguments + " < " + in;
  FILE* pipe = ::popen(command.c_str(), "r");
  std::string out;
  char text[4096];
  while (std::fgets(text, sizeof text, pipe) != nullptr) out += text;
  Answers answers;
  answers.code = WEXITSTATUS(::pclose(pipe));
  std::istringstream stream(out);
  for (std::string line; std::getline(stream, line);) answers.lines.push_back(nlohmann::json::parse(line));
  return answers;
}

constexpr const char* kArch = R"({"bezier":[[0,0],[0.2,0.5],[0.8,0.5],[1,0]]})";

TEST(CurveCommand, AnswersEveryLineAtItsPlaceAndEndsWithThreeWhenOneWasBad) {
  const Answers a =
      curve("residual", std::string(kArch) +
                            "\nnot json\n{\"bezier\":[[0,0],[1,1]]}\n{\"bezier\":[[0,0],[0,0],[0,0],[0,0]]}\n"
                            "{\"bezier\":[[0,0],[1,1e300],[2,1],[3,0]]}\n[1]\n" +
                            kArch + "\n");
  EXPECT_EQ(a.code, 3);
  ASSERT_EQ(a.lines.size(), 7u);
  EXPECT_EQ(a.lines[0], a.lines[6]);
  EXPECT_GT(a.lines[0]["lambda_residual"], 0);
  const char* reasons[] = {"not JSON", "4 needed", "cusp", "out of range", "missing"};
  for (std::size_t i = 0; i < 5; ++i) {
    const std::string error = a.lines[i + 1].at("error");
    EXPECT_THAT(error, ::testing::HasSubstr("line " + std::to_string(i + 2)));
    EXPECT_THAT(error, ::testing::HasSubstr(reasons[i]));
  }
}

TEST(CurveCommand, OptimalProjectionIsAtLeastAsGoodAsFeedback) {
  const char* wave = R"({"bezier":[[0,0],[0.9,0.6],[0.3,-0.7],[1,0]]})";
  const Answers feedback = curve("project", wave), optimal = curve("project --method optimal", wave);
  EXPECT_EQ(feedback.code, 0);
  EXPECT_EQ(optimal.code, 0);
  EXPECT_LE(optimal.lines[0]["lambda_residual"].get<double>(),
            feedback.lines[0]["lambda_residual"].get<double>() + 1e-6);
  EXPECT_EQ(optimal.lines[0]["bezier"][0], (nlohmann::json{0.0, 0.0}));
  EXPECT_EQ(optimal.lines[0]["bezier"][3], (nlohmann::json{1.0, 0.0}));
}

TEST(CurveCommand, FitRecoversWhatSampleWrote) {
  const char* circle =
      R"({"elastica":{"x":1,"y":2,"theta":0.3,"kappa":0.5,"lambda1":0,"lambda2":0,"length":3},"n":200})";
  const Answers sampled = curve("sample", circle);
  ASSERT_EQ(sampled.code, 0);
  ASSERT_EQ(sampled.lines[0]["points"].size(), 200u);
  EXPECT_EQ(sampled.lines[0]["kappa"][100], 0.5);
  const Answers fitted = curve("fit", nlohmann::json{{"points", sampled.lines[0]["points"]}}.dump());
  ASSERT_EQ(fitted.code, 0);
  EXPECT_LT(fitted.lines[0]["hausdorff"], 3e-9);
  EXPECT_NEAR(fitted.lines[0]["elastica"]["kappa"], 0.5, 1e-7);
  EXPECT_NEAR(fitted.lines[0]["elastica"]["length"], 3, 1e-7);
}

TEST(CurveCommand, ClampedFitsKeepEndsAndTangents) {
  const Answers a = curve("fit --ends clamped", kArch), free = curve("fit", kArch);
  ASSERT_EQ(a.code, 0);
  EXPECT_EQ(a.lines[0]["status"], "ok");
  EXPECT_NEAR(a.lines[0]["elastica"]["theta"], std::atan2(0.5, 0.2), 1e-12);
  EXPECT_GE(a.lines[0]["l2"], free.lines[0]["l2"]);
  const Answers ends = curve("sample", nlohmann::json{{"elastica", a.lines[0]["elastica"]}, {"n", 2}}.dump());
  EXPECT_NEAR(ends.lines.at(0)["points"][1][0], 1, 1e-9);
  EXPECT_NEAR(ends.lines.at(0)["points"][1][1], 0, 1e-9);
  EXPECT_NEAR(ends.lines.at(0)["theta"][1], -std::atan2(0.5, 0.2), 1e-9);

  nlohmann::json points{{"points", nlohmann::json::array()}, {"tangents", {0.0, 1.0}}};
  for (int i = 0; i <= 20; ++i) points["points"].push_back({std::sin(i / 20.0), 1 - std::cos(i / 20.0)});
  const Answers arc = curve("fit --ends clamped", points.dump());
  EXPECT_EQ(arc.lines.at(0)["status"], "ok");
  EXPECT_NEAR(arc.lines.at(0)["elastica"]["kappa"], 1, 1e-6);
  points.erase("tangents");
  EXPECT_EQ(curve("fit --ends clamped", points.dump()).code, 3);
}

TEST(CurveCommand, EquilibriaListsShapesByEnergyAndNoneWhereThereIsNone) {
  const Answers a = curve("equilibria", R"({"a":[0,0,0.6],"b":[800,0,-0.6],"length":1000})"
                                        "\n"
                                        R"({"a":[0,0,0.6],"b":[800,0,-0.6],"length":1000,"max_energy":0.05})"
                                        "\n"
                                        R"({"a":[0,0,0],"b":[1001,0,0],"length":1000})"
                                        "\n"
                                        R"({"a":[0,0],"b":[1001,0,0],"length":1000})"
                                        "\n"
                                        R"({"a":[0,0,0],"b":[1001,0,0],"length":-1})"
                                        "\n");
  EXPECT_EQ(a.code, 3);
  ASSERT_EQ(a.lines.size(), 5u);
  const nlohmann::json& stable = a.lines[0]["equilibria"];
  ASSERT_EQ(stable.size(), 2u);
  EXPECT_NEAR(stable[0]["energy"], 2.955e-3, 1e-6);
  EXPECT_NEAR(stable[1]["energy"], 15.784e-3, 1e-6);
  EXPECT_EQ(stable[0]["stable"], true);
  EXPECT_EQ(stable[0]["inflections"], 2);
  EXPECT_EQ(stable[0]["elastica"]["length"], 1000.0);
  EXPECT_GT(a.lines[1]["equilibria"].size(), 4u);
  EXPECT_EQ(a.lines[1]["equilibria"].back()["stable"], false);
  EXPECT_TRUE(a.lines[2]["equilibria"].empty());
  EXPECT_TRUE(a.lines[3].contains("error"));
  EXPECT_TRUE(a.lines[4].contains("error"));
}

TEST(CurveCommand, ACurveThatCannotBeEvaluatedIsABadLineNotACrash) {
  const Answers a = curve(
      "sample",
      R"({"elastica":{"x":0,"y":0,"theta":0,"kappa":1e8,"lambda1":0,"lambda2":0,"length":1000},"n":9})");
  EXPECT_EQ(a.code, 3);
  EXPECT_TRUE(a.lines.at(0).contains("error"));
}

TEST(CurveCommand, QuadraticMeasuresACurveAndFindsTheTangentOnes) {
  const Answers a = curve("quadratic",
                          R"({"bezier":[[0,0],[3,0],[1,0]],"nearest":[4,0]}
{"ends":[[-1,0.5],[1,0.5]],"line":[[0,0],[1,0]],"minimise":"length"}
{"ends":[[-3,0.1],[3,0.2]],"circle":[0,0,1],"minimise":"energy"}
{"ends":[[-1,0.5],[1,-0.5]],"line":[[0,0],[1,0]],"minimise":"length"}
{"ends":[[-1,0.5],[1,0.5]],"circle":[0,0,-1],"minimise":"length"}
)");
  EXPECT_EQ(a.code, 3);
  ASSERT_EQ(a.lines.size(), 5u);
  EXPECT_NEAR(a.lines[0]["length"], 2.6, 1e-15);
  EXPECT_TRUE(a.lines[0]["energy"].is_null());  // infinite: it folds
  EXPECT_EQ(a.lines[0]["parabola"]["status"], "folded");
  EXPECT_NEAR(a.lines[0]["nearest"]["distance"], 2.2, 1e-15);
  EXPECT_NEAR(a.lines[1]["bezier"][1][1], -0.5, 1e-15);
  EXPECT_GT(a.lines[2]["candidates"].size(), 1u);
  EXPECT_EQ(a.lines[3]["status"], "infeasible");
  EXPECT_THAT(a.lines[4]["error"].get<std::string>(), ::testing::HasSubstr("must be positive"));
}

TEST(CurveCommand, ArcsKeepTheLengthWithinTheTolerance) {
  const char* lines =
      R"({"elastica":{"x":1,"y":2,"theta":0.3,"kappa":0.003,"lambda1":1e-5,"lambda2":0,"length":700}}
{"points":[[0,0],[1,1]]}
)";
  for (const char* order : {"biarc", "triarc"}) {
    const Answers a = curve(std::string("arcs --tolerance 0.01 --order ") + order, lines);
    EXPECT_EQ(a.code, 3);
    EXPECT_NEAR(a.lines.at(0)["length"], 700, 1e-9);
    EXPECT_LE(a.lines[0]["error_bound"], 0.01);
    EXPECT_EQ(a.lines[0]["arcs"][0]["start"], (nlohmann::json{1.0, 2.0}));
    EXPECT_TRUE(a.lines.at(1).contains("error"));
  }
}

}  // namespace
}  // namespace hotblade::pipeline
