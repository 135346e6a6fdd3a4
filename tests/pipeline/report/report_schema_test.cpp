// The JSON Schema of report.json accepts what a plan writes, passed or refused, and refuses what it never
// writes.
#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>

#include "pipeline/report/emit.hpp"
#include "pipeline/report/json/report_json.hpp"
#include "tests/paths.hpp"
#include "tests/pipeline/plan_design.hpp"

namespace hotblade::pipeline {
namespace {

using Json = nlohmann::json;
using Adapter = valijson::adapters::NlohmannJsonAdapter;

class ReportSchema : public ::testing::Test {
 protected:
  ReportSchema() {
    std::ifstream file(hotblade::testing::source_dir() + "/docs/report.schema.json");
    document_ = Json::parse(file);
    valijson::SchemaParser parser(valijson::SchemaParser::kDraft7);
    parser.populateSchema(Adapter(document_), schema_);
  }

  // The first thing that is wrong; empty: nothing.
  std::string wrong(const Json& report) {
    valijson::Validator validator;
    valijson::ValidationResults results;
    if (validator.validate(schema_, Adapter(report), &results)) return "";
    valijson::ValidationResults::Error error;
    std::string text = "refused";
    while (results.popError(error)) text += "; " + error.description;
    return text;
  }

  Json document_;
  valijson::Schema schema_;
};

TEST_F(ReportSchema, AcceptsTheReportsOfPassedAndRefusedPlans) {
  PlanResult result = plan(cylinder_design(), along_x(), {});
  EXPECT_EQ(wrong(Json::parse(report_json(result))), "");
  result.refusals.push_back(
      {"S001", "S001R002", Limit::kDeviation, 1.2, 1, "a hint", "at (1, 2, 3)", "", {"a", "b"}});
  result.program.verification.status = VerificationStatus::kRefused;
  result.remedies = {{{"design.tolerance_mm=1.3"}, "", "measured", 1.2, 1.3, 2, "amber"}};
  const Json refused = Json::parse(report_json(result, std::string(64, 'a')));
  EXPECT_EQ(wrong(refused), "");
  EXPECT_EQ(refused["remedies"][0]["set"][0], "design.tolerance_mm=1.3");
}

// A refused plan of many strips is shown as it was looked at, without what its clamps may err.
TEST_F(ReportSchema, AcceptsStripsWhoseClampsWereNotLookedAt) {
  PlanResult result = plan(cylinder_design(), along_x(), {});
  EXPECT_TRUE(Json::parse(report_json(result))["strips"][0]["margin_mm_min"].is_number());
  for (StripFacts& strip : result.strips) strip.motion.rib_sensitivity_mm.clear();
  const Json report = Json::parse(report_json(result));
  EXPECT_EQ(wrong(report), "");
  for (const Json& strip : report["strips"]) {
    for (const char* key :
         {"clamp_error_mm", "margin_mm_min", "snap_margin_mm_min", "straight_margin_mm_min"})
      EXPECT_TRUE(strip[key].is_null()) << key;
    for (const Json& rib : strip["rib_facts"])
      for (const auto& [name, mm] : rib["clamp_sensitivity_mm"].items()) EXPECT_TRUE(mm.is_null()) << name;
  }
}

TEST_F(ReportSchema, NamesEveryFigureThatAReportHas) {
  Settings settings = along_x();
  settings.stock.sizes_mm = {{1250, 1250, 600}};
  const Json report = Json::parse(report_json(plan(cylinder_design(), settings, {})));
  EXPECT_EQ(wrong(report), "");
  EXPECT_EQ(report["foam"]["bought"][0]["pieces"].size(), report["strips"].size());
  for (const auto& [key, value] : report.items()) EXPECT_TRUE(document_["properties"].contains(key)) << key;
}

TEST_F(ReportSchema, RefusesABrokenReport) {
  const Json good = Json::parse(report_json(plan(cylinder_design(), along_x(), {})));
  const std::pair<const char*, std::function<void(Json&)>> breakages[] = {
      {"format", [](Json& j) { j["format"] = "hotblade-program"; }},
      {"status", [](Json& j) { j["status"] = "fine"; }},
      {"hash", [](Json& j) { j["design"]["sha256"] = "abc"; }},
      {"no deviation", [](Json& j) { j.erase("deviation_mm"); }},
      {"areas_mm2", [](Json& j) { j["histogram"]["areas_mm2"][0] = -0.5; }},
      {"budget", [](Json& j) { j["budget_mm"]["mesh"] = "0.1"; }},
      {"share", [](Json& j) { j["strips"][0]["foam_kept_share"] = 1.5; }},
      {"no radius", [](Json& j) { j["strips"][0].erase("blade_radius_min_mm"); }},
      {"remedy",
       [](Json& j) {
         j["remedies"].push_back({{"setting", "tolerance"}});
       }},
      {"warnings", [](Json& j) { j["warnings"] = "none"; }},
  };
  for (const auto& [name, break_it] : breakages) {
    Json json = good;
    break_it(json);
    EXPECT_NE(wrong(json), "") << name;
  }
}

}  // namespace
}  // namespace hotblade::pipeline
