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
  const Answers a = curve("residual", std::string(kArch) +
                                          "\nnot json\n{\"bezier\":[[0,0],[1,1]]}\n"
                                          "{\"bezier\":[[0,0],[1,1e300],[2,1],[3,0]]}\n[1]\n" +
                                          kArch + "\n");
  EXPECT_EQ(a.code, 3);
  ASSERT_EQ(a.lines.size(), 6u);
  EXPECT_EQ(a.lines[0], a.lines[5]);
  EXPECT_GT(a.lines[0]["lambda_residual"], 0);
  const char* reasons[] = {"not JSON", "4 needed", "out of range", "missing"};
  for (std::size_t i = 0; i < 4; ++i) {
    const std::string error = a.lines[i + 1].at("error");
    EXPECT_THAT(error, ::testing::HasSubstr("line " + std::to_string(i + 2)));
    EXPECT_THAT(error, ::testing::HasSubstr(reasons[i]));
  }
}

TEST(CurveCommand, ReadsALineToItsEnd) {
  const Answers a = curve("residual", kArch + std::string("\0 zzz\n", 6) + kArch + "\n");
  EXPECT_EQ(a.code, 3);
  ASSERT_EQ(a.lines.size(), 2u);
  EXPECT_THAT(a.lines[0].at("error").get<std::string>(), ::testing::HasSubstr("line 1: not JSON"));
}

TEST(CurveCommand, ResidualSaysItsErrorBoundAndACuspIsAnAnswer) {
  const Answers a = curve("residual", std::string(kArch) +
                                          "\n{\"bezier\":[[0,0],[1,1],[0,1],[1,0]]}\n"
                                          "{\"bezier\":[[0,0],[0,0],[2,1],[3,0]]}\n"
                                          "{\"bezier\":[[0,0],[1,1.0001],[0,1],[1,0]]}\n"
                                          "{\"bezier\":[[0,0],[1,0],[2,0],[3,0]]}\n");
  EXPECT_EQ(a.code, 0);
  ASSERT_EQ(a.lines.size(), 5u);
  for (const std::size_t i : {0U, 3U}) {
    EXPECT_EQ(a.lines[i]["status"], "ok");
    EXPECT_GT(a.lines[i]["bound"], 0);
    EXPECT_LT(a.lines[i]["bound"], 1e-8);
  }
  for (const std::size_t i : {1U, 2U}) {
    EXPECT_EQ(a.lines[i]["status"], "cusp");
    for (const char* key : {"lambda_residual", "lambda1", "lambda2", "alpha", "bound"})
      EXPECT_TRUE(a.lines[i].at(key).is_null()) << key;
  }
  // 24 nodes lose what a near-cusp has.
  EXPECT_GT(a.lines[3]["lambda_residual"], 0.9999);
  EXPECT_EQ(a.lines[4]["status"], "straight");
  EXPECT_EQ(a.lines[4]["lambda_residual"], 0);
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

// One period of an elastica with inflections that crosses itself.
constexpr const char* kLoop =
    R"("elastica":{"x":0,"y":0,"theta":2.6,"kappa":0,"lambda1":1,"lambda2":0,"length":12})";

TEST(CurveCommand, FeaturesAreWhereTheCurveHasThem) {
  const Answers a = curve("features", std::string("{") + kLoop + "}");
  ASSERT_EQ(a.code, 0);
  const nlohmann::json& f = a.lines.at(0);
  EXPECT_EQ(f["shape"]["regime"], "inflectional");
  // kappa^2/2 - cos theta is constant, so k = sin of half the angle at an inflection.
  EXPECT_NEAR(f["shape"]["modulus"], std::sin(1.3), 1e-12);
  ASSERT_GE(f["inflections"].size(), 2u);
  EXPECT_NEAR(f["inflections"][0]["s"], 0, 1e-9);
  const double period = f["period"];
  EXPECT_NEAR(f["inflections"][1]["s"], period / 2, 1e-9);
  EXPECT_NEAR(f["vertices"][0]["s"], period / 4, 1e-9);
  // Where two arc lengths are one point, the sampled curve says so too.
  ASSERT_GE(f["self_intersections"].size(), 1u);
  const nlohmann::json& crossing = f["self_intersections"][0];
  for (std::size_t end : {0u, 1u}) {
    auto cut = nlohmann::json::parse(std::string("{") + kLoop + ",\"n\":2}");
    cut["elastica"]["length"] = crossing["s"][end];
    const Answers at = curve("sample", cut.dump());
    for (std::size_t axis : {0u, 1u})
      EXPECT_NEAR(at.lines.at(0)["points"][1][axis], crossing["point"][axis], 1e-9);
  }
  const Answers line = curve(
      "features", R"({"elastica":{"x":0,"y":0,"theta":0,"kappa":0,"lambda1":0,"lambda2":0,"length":1}})");
  EXPECT_TRUE(line.lines.at(0)["shape"].is_null());
  EXPECT_TRUE(line.lines.at(0)["period"].is_null());
  EXPECT_TRUE(line.lines.at(0)["inflections"].empty());
}

TEST(CurveCommand, NearestIsNoFartherThanAnySample) {
  const char* points = R"("points":[[0.3,0.1],[1,1],[-2,0.5],[0.5,-3]])";
  const std::string lines = std::string("{") + kLoop + "," + points + "}\n" +
                            R"({"bezier":[[0,0],[0.2,0.5],[0.8,0.5],[1,0]],)" + points + "}\n" +
                            R"({"bezier":[[0,0],[0.5,1],[1,0]],)" + points + "}\n";
  const Answers sampled = curve("sample", std::string("{") + kLoop + ",\"n\":2001}");
  for (const char* backend : {"cpu", "opencl", "auto"}) {
    const Answers a = curve(std::string("nearest --backend ") + backend, lines);
    ASSERT_EQ(a.code, 0);
    ASSERT_EQ(a.lines.size(), 3u);
    const double bound = a.lines[0]["bound"];
    EXPECT_GT(bound, 0);
    EXPECT_LE(bound, 12e-9);
    const double at[][2] = {{0.3, 0.1}, {1, 1}, {-2, 0.5}, {0.5, -3}};
    for (std::size_t i = 0; i < 4; ++i) {
      double least = 1e9;
      for (const auto& p : sampled.lines.at(0)["points"])
        least = std::min(least, std::hypot(p[0].get<double>() - at[i][0], p[1].get<double>() - at[i][1]));
      const double distance = a.lines[0]["distance"][i], s = a.lines[0]["parameter"][i];
      EXPECT_LE(distance, least + bound);
      EXPECT_GE(distance, least - 12.0 / 2000);
      auto cut = nlohmann::json::parse(std::string("{") + kLoop + ",\"n\":2}");
      cut["elastica"]["length"] = std::max(s, 1e-300);
      const nlohmann::json foot = curve("sample", cut.dump()).lines.at(0)["points"][1];
      EXPECT_NEAR(std::hypot(foot[0].get<double>() - at[i][0], foot[1].get<double>() - at[i][1]), distance,
                  bound + 1e-12);
    }
    // The parabola y = 2 x (1 - x), by its own tool.
    const Answers one = curve("quadratic", R"({"bezier":[[0,0],[0.5,1],[1,0]],"nearest":[0.3,0.1]})");
    EXPECT_NEAR(a.lines[2]["distance"][0], one.lines.at(0)["nearest"]["distance"], 1e-12);
    EXPECT_NEAR(a.lines[2]["parameter"][0], one.lines[0]["nearest"]["t"], 1e-9);
    EXPECT_NEAR(a.lines[1]["distance"][2], std::hypot(2, 0.5), 1e-12);
  }
  const Answers bad = curve("nearest", std::string("{") + kLoop + "," + points + ",\"tolerance\":0}\n" +
                                           R"({"bezier":[[0,0],[1,1]],)" + points + "}");
  EXPECT_EQ(bad.code, 3);
  EXPECT_THAT(bad.lines.at(0)["error"].get<std::string>(), ::testing::HasSubstr("tolerance"));
  EXPECT_THAT(bad.lines.at(1)["error"].get<std::string>(), ::testing::HasSubstr("3 or 4 needed"));
}

TEST(CurveCommand, SplinesKeepTheirJointsAndLowerTheirResiduals) {
  const char* chain =
      R"({"chain":[[[0,0],[0.2,0.9],[0.7,0.6],[1,0.6]],[[1,0.6],[1.6,0.6],[1.9,0.3],[2,0]]]})";
  const Answers first = curve("residual", R"({"bezier":[[0,0],[0.2,0.9],[0.7,0.6],[1,0.6]]})");
  for (const char* continuity : {"g1", "c1"}) {
    const Answers a = curve(std::string("spline --continuity ") + continuity, chain);
    ASSERT_EQ(a.code, 0);
    const nlohmann::json& s = a.lines.at(0);
    EXPECT_EQ(s["status"], "ok");
    EXPECT_EQ(s["chain"][0][0], (nlohmann::json{0.0, 0.0}));
    EXPECT_EQ(s["chain"][0][3], s["chain"][1][0]);
    EXPECT_NEAR(s["chain"][0][2][1], 0.6, 1e-12);  // on the joint's tangent
    EXPECT_NEAR(s["chain"][1][1][1], 0.6, 1e-12);
    EXPECT_LT(s["lambda_residuals"][0], first.lines.at(0)["lambda_residual"]);
    if (continuity[0] == 'c') {
      EXPECT_NEAR(1 - s["chain"][0][2][0].get<double>(), s["chain"][1][1][0].get<double>() - 1, 1e-9);
    }
  }
  const Answers torn = curve("spline", R"({"chain":[[[0,0],[0,1],[1,1],[1,0]],[[2,0],[2,1],[3,1],[3,0]]]})");
  EXPECT_EQ(torn.code, 3);
}

TEST(CurveCommand, SplitPiecesJoinAndStayWithinTheirBound) {
  const char* hook = R"({"bezier":[[0,0],[400,900],[900,-200],[1000,300]]})";
  const Answers a = curve("split --tolerance 1 --candidates 12", hook);
  ASSERT_EQ(a.code, 0);
  const nlohmann::json& pieces = a.lines.at(0)["pieces"];
  EXPECT_EQ(a.lines[0]["status"], "ok");
  ASSERT_GE(pieces.size(), 1u);
  EXPECT_EQ(pieces.front()["from"], 0);
  EXPECT_EQ(pieces.back()["to"], 1);
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    EXPECT_LE(pieces[i]["error_bound"], 1);
    if (i == 0) continue;
    EXPECT_EQ(pieces[i]["from"], pieces[i - 1]["to"]);
    const Answers ends =
        curve("sample", nlohmann::json{{"elastica", pieces[i - 1]["elastica"]}, {"n", 2}}.dump());
    EXPECT_NEAR(ends.lines.at(0)["points"][1][0], pieces[i]["elastica"]["x"], 1e-6);
    EXPECT_NEAR(ends.lines[0]["points"][1][1], pieces[i]["elastica"]["y"], 1e-6);
  }
  // A wider tolerance takes no more pieces.
  EXPECT_LE(curve("split --tolerance 20 --candidates 12", hook).lines.at(0)["pieces"].size(), pieces.size());
}

TEST(CurveCommand, ALinesIdComesBackWithItsAnswer) {
  const Answers a = curve("residual", R"({"id":"arch 7","bezier":[[0,0],[0.2,0.5],[0.8,0.5],[1,0]]})"
                                      "\n"
                                      R"({"id":8,"bezier":[[0,0],[1,1]]})"
                                      "\n" +
                                          std::string(kArch) + "\n");
  ASSERT_EQ(a.lines.size(), 3u);
  EXPECT_EQ(a.lines[0]["id"], "arch 7");
  EXPECT_EQ(a.lines[1]["id"], 8);
  EXPECT_TRUE(a.lines[1].contains("error"));
  EXPECT_FALSE(a.lines[2].contains("id"));
}

}  // namespace
}  // namespace hotblade::pipeline
