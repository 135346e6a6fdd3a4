// The samples in the cells that come with the program: joints found, and measured again.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/cell/cell_file.hpp"
#include "pipeline/plan/arms/arms.hpp"
#include "pipeline/plan/arms/check_joints.hpp"
#include "pipeline/plan/plan.hpp"
#include "surface/read/design_surface.hpp"
#include "tests/paths.hpp"

namespace hotblade::pipeline {
namespace {

using ::testing::HasSubstr;

class PlanSample : public ::testing::TestWithParam<const char*> {};

INSTANTIATE_TEST_SUITE_P(All, PlanSample,
                         ::testing::Values("barrel_vault", "branch", "bump", "hypar", "petal", "ragged",
                                           "s_wall", "saddle", "wave_wall", "window"),
                         [](const auto& sample) { return std::string(sample.param); });

TEST_P(PlanSample, BothCellsServe) {
  const std::string base = hotblade::testing::source_dir() + "/samples/" + GetParam();
  const Settings settings = resolve({{base + ".toml"}, {}, {}});
  const PlanResult result =
      plan(surface::read_obj(base + ".obj", {settings.design.units, 'z'}), settings, {});
  ASSERT_TRUE(result.refusals.empty());
  for (const std::string& name : embedded_cells()) {
    const robot::Cell cell = read_cell(name);
    const ArmedProgram armed = with_arms(result.program, cell);
    for (const Refusal& refusal : armed.report.refusals) {
      // Times are those of the plan: the tightest strip of the wave wall asks too much of a joint wherever it
      // is clear of the table.
      if (std::string(GetParam()) == "wave_wall" && name == "two_irb4600" && refusal.strip == "S005") {
        EXPECT_THAT(describe(refusal), HasSubstr("4 too fast for a joint, 1 not clear"));
        continue;
      }
      ADD_FAILURE() << name << ": " << describe(refusal);
    }
    if (!armed.program.cell) continue;
    const JointCheck check = check_joints(armed.program, cell);
    for (const std::string& line : check.breaches) ADD_FAILURE() << name << ": " << line;
    EXPECT_GE(check.joint_margin_rad, 10 * robot::kDegree_rad)
        << name << ": a margin that would be warned of";
    // The cuts are those of the plan: arms change where blocks stand, and nothing else.
    for (std::size_t i = 0; i < armed.program.strips.size(); ++i) {
      const Strip &with = armed.program.strips[i], &without = result.program.strips[i];
      ASSERT_EQ(with.poses.size(), without.poses.size());
      EXPECT_EQ(with.poses.back().t, without.poses.back().t);
      EXPECT_EQ(with.poses.back().a.p, without.poses.back().a.p);
    }
  }
}

}  // namespace
}  // namespace hotblade::pipeline
