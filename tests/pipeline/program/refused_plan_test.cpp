// What a refused plan found is kept for looking at, and is no program to anything that takes one.
#include "pipeline/program/refused_plan.hpp"

#include <gmock/gmock.h>

#include <fstream>
#include <limits>

#include "pipeline/program/strip_jobs.hpp"
#include "pipeline/settings/error.hpp"
#include "tests/pipeline/temporary_directory.hpp"
#include "tests/pipeline/vault_program.hpp"

namespace hotblade::pipeline {
namespace {

using testing::vault_program;

class RefusedPlanFile : public ::testing::Test {
 protected:
  void write(const RefusedPlan& plan) const { std::ofstream(file_, std::ios::binary) << to_json(plan); }

  static RefusedPlan refused() {
    RefusedPlan plan;
    plan.found = vault_program();
    plan.found.verification.status = VerificationStatus::kRefused;
    plan.reasons = {{"S001: radius 55 mm (limit 70 mm)", std::nullopt},
                    {"S001 \"at\",\n\"found\": {", Eigen::Vector3d(1, -2.5, 1.0 / 3)}};
    return plan;
  }

  testing::TemporaryDirectory directory_;
  std::filesystem::path file_ = directory_ / "refused.json";
};

TEST_F(RefusedPlanFile, ReadsBackAsItWasWritten) {
  const RefusedPlan plan = refused();
  write(plan);
  EXPECT_TRUE(is_refused_plan(file_));
  const RefusedPlan back = read_refused_plan(file_);
  EXPECT_EQ(to_json(back.found), to_json(plan.found));
  ASSERT_EQ(back.reasons.size(), 2u);
  EXPECT_EQ(back.reasons[0].message, plan.reasons[0].message);
  EXPECT_FALSE(back.reasons[0].at);
  EXPECT_EQ(back.reasons[1].message, plan.reasons[1].message);
  EXPECT_EQ(back.reasons[1].at, plan.reasons[1].at);
}

TEST_F(RefusedPlanFile, KeepsReasonAndDesignWhereNoStripCanBeRead) {
  RefusedPlan none = refused(), broken = refused();
  none.found.strips.clear();
  broken.found.strips.front().poses.front().margin = std::numeric_limits<double>::quiet_NaN();
  RefusedPlan apart = refused();
  apart.found.strips.front().poses[1].t = apart.found.strips.front().poses[0].t;  // no time passes
  for (const RefusedPlan& plan : {none, broken, apart}) {
    write(plan);
    const RefusedPlan back = read_refused_plan(file_);
    EXPECT_TRUE(back.found.strips.empty());
    EXPECT_EQ(back.found.design.sha256, plan.found.design.sha256);
    EXPECT_EQ(back.reasons.front().message, plan.reasons.front().message);
  }
}

TEST_F(RefusedPlanFile, IsNoProgram) {
  write(refused());
  for (const bool overridden : {false, true}) {
    try {
      (void)read_strip_jobs(file_, overridden);
      ADD_FAILURE() << "jobs were made of a refused plan";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind, ErrorKind::kNotCuttable);
      EXPECT_THAT(error.what(),
                  ::testing::HasSubstr("is what a refused plan found, not a program (S001: radius"));
    }
  }
}

TEST_F(RefusedPlanFile, ATornOneAndAProgramAreNoRefusedPlan) {
  const std::string whole = to_json(refused());
  for (const std::string& text :
       {whole.substr(0, whole.size() / 2), whole.substr(0, 60), to_json(vault_program()), std::string()}) {
    std::ofstream(file_, std::ios::binary | std::ios::trunc) << text;
    EXPECT_THROW((void)read_refused_plan(file_), Error) << text.substr(0, 80);
  }
  EXPECT_FALSE(is_refused_plan(file_));
  EXPECT_FALSE(is_refused_plan(directory_ / "missing.json"));
}

}  // namespace
}  // namespace hotblade::pipeline
