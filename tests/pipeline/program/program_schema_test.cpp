// The JSON Schema that ships with the project accepts what hotblade writes and refuses what it would not
// read.
#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>

#include "pipeline/program/program.hpp"
#include "tests/paths.hpp"
#include "tests/pipeline/program/armed_vault.hpp"
#include "tests/pipeline/vault_program.hpp"

namespace hotblade::pipeline {
namespace {

using Adapter = valijson::adapters::NlohmannJsonAdapter;

class ProgramSchema : public ::testing::Test {
 protected:
  ProgramSchema() {
    std::ifstream file(hotblade::testing::source_dir() + "/docs/program.schema.json");
    document_ = nlohmann::json::parse(file);
    valijson::SchemaParser parser(valijson::SchemaParser::kDraft7);
    parser.populateSchema(Adapter(document_), schema_);
  }

  bool accepts(const nlohmann::json& program) {
    valijson::Validator validator;
    return validator.validate(schema_, Adapter(program), nullptr);
  }

  nlohmann::json document_;
  valijson::Schema schema_;
};

nlohmann::json vault() {
  return nlohmann::json::parse(to_json(testing::vault_program({.strips = 2})));
}

TEST_F(ProgramSchema, AcceptsAGeneratedProgram) {
  EXPECT_TRUE(accepts(vault()));
}

TEST_F(ProgramSchema, AcceptsVersion1) {
  nlohmann::json program = vault();
  program["version"] = 1;
  program["design"].erase("format");
  EXPECT_TRUE(accepts(program));
}

TEST_F(ProgramSchema, AcceptsAProgramWithArms) {
  nlohmann::json program = nlohmann::json::parse(to_json(testing::with_joints()));
  EXPECT_TRUE(accepts(program));
  program["strips"][0]["arms"]["a"]["branch"][0] = 2;
  EXPECT_FALSE(accepts(program));
}

TEST_F(ProgramSchema, RefusesABrokenProgram) {
  const std::pair<const char*, std::function<void(nlohmann::json&)>> breakages[] = {
      {"format", [](nlohmann::json& j) { j["format"] = "gcode"; }},
      {"version", [](nlohmann::json& j) { j["version"] = 3; }},
      {"version of other keys", [](nlohmann::json& j) { j["version"] = 1; }},
      {"no format of the design", [](nlohmann::json& j) { j["design"].erase("format"); }},
      {"design's format", [](nlohmann::json& j) { j["design"]["format"] = "step"; }},
      {"missing key", [](nlohmann::json& j) { j.erase("overrides"); }},
      {"unknown key", [](nlohmann::json& j) { j["note"] = 1; }},
      {"hash", [](nlohmann::json& j) { j["design"]["sha256"] = "abc"; }},
      {"path", [](nlohmann::json& j) { j["design"]["file"] = "a/b.obj"; }},
      {"keep", [](nlohmann::json& j) { j["design"]["keep"] = "left"; }},
      {"no strips", [](nlohmann::json& j) { j["strips"] = nlohmann::json::array(); }},
      {"flat stock", [](nlohmann::json& j) { j["strips"][0]["stock"]["size_mm"][0] = 0; }},
      {"bezier of three", [](nlohmann::json& j) { j["strips"][0]["ribs"][0]["bezier"].erase(3); }},
      {"phase", [](nlohmann::json& j) { j["strips"][0]["poses"][5]["phase"] = "dance"; }},
      {"time", [](nlohmann::json& j) { j["strips"][0]["poses"][5]["t"] = -1; }},
      {"heat", [](nlohmann::json& j) { j["strips"][0]["poses"][5]["heat"] = 1; }},
      {"quaternion", [](nlohmann::json& j) { j["strips"][0]["poses"][5]["a"]["q"].erase(3); }},
      {"number as text", [](nlohmann::json& j) { j["strips"][0]["poses"][5]["margin"] = "1"; }},
      {"rib", [](nlohmann::json& j) { j["strips"][0]["poses"][5]["rib"] = 1.5; }},
      {"status", [](nlohmann::json& j) { j["verification"]["status"] = "fine"; }},
      {"budget", [](nlohmann::json& j) { j["verification"]["budget_mm"]["mesh"] = -1; }},
  };
  for (const auto& [name, break_it] : breakages) {
    nlohmann::json json = vault();
    break_it(json);
    EXPECT_FALSE(accepts(json)) << name;
  }
}

}  // namespace
}  // namespace hotblade::pipeline
