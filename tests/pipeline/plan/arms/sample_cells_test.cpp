// The samples in the cells that come with the program: joints found, and measured again.
// HOTBLADE_CELL_SAMPLES=all takes the wave wall too, whose six strips take as long as five other samples.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cstdlib>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "pipeline/cell/cell_file.hpp"
#include "pipeline/plan/arms/arms.hpp"
#include "pipeline/plan/arms/check_joints.hpp"
#include "pipeline/plan/arms/strip_clearance.hpp"
#include "pipeline/plan/plan.hpp"
#include "pipeline/program/program_text.hpp"
#include "pipeline/program/strip_jobs.hpp"
#include "pipeline/run/dryrun.hpp"
#include "surface/read/design_surface.hpp"
#include "tests/paths.hpp"
#include "tests/pipeline/plan_design.hpp"
#include "tests/pipeline/temporary_directory.hpp"

namespace hotblade::pipeline {
namespace {

using ::testing::HasSubstr;

class PlanSample : public ::testing::TestWithParam<const char*> {};

std::vector<const char*> samples() {
  std::vector<const char*> names{"barrel_vault", "branch", "bump",   "hypar", "petal",
                                 "ragged",       "s_wall", "saddle", "vase",  "window"};
  const char* wanted = std::getenv("HOTBLADE_CELL_SAMPLES");
  if (wanted && std::string(wanted) == "all") names.push_back("wave_wall");
  return names;
}

INSTANTIATE_TEST_SUITE_P(All, PlanSample, ::testing::ValuesIn(samples()),
                         [](const auto& sample) { return std::string(sample.param); });

// The controller's own check, by code that shares nothing with that which found the joints.
void stream_to_a_controller_that_checks(const Program& program, const robot::Cell& cell) {
  const testing::TemporaryDirectory directory;
  std::ofstream(directory / "program.json") << to_json(program);
  const StripJobs work = read_strip_jobs(directory / "program.json", false);
  std::map<std::uint64_t, std::vector<robot::Standing>> blocks;
  for (std::size_t i = 0; i < work.jobs.size(); ++i)
    blocks[work.jobs[i].id] = surroundings(work.program.strips[i], cell);
  const MotionSettings& motion = program.settings.motion;
  DryRunOptions options;
  options.log_file = directory / "execution.jsonl";
  options.limits = planned_limits(program);
  options.blade = planned_blade(program);
  options.arms = std::make_shared<const robot::ArmCell>(
      cell, cell_id(cell_sha256(cell)), robot::ArmCell::Limits{motion.jerk_mm_s3, motion.angular_jerk_rad_s3},
      blocks);
  const DryRunReport report = dry_run(work.jobs, options);
  EXPECT_TRUE(report.holds()) << report.strips.back().stream.message;
}

TEST_P(PlanSample, BothCellsServe) {
  const std::string base = hotblade::testing::source_dir() + "/samples/" + GetParam();
  const Settings settings = resolve({{base + ".toml"}, {}, {}});
  const PlanResult result =
      plan(surface::read_obj(base + ".obj", {settings.design.units, 'z'}), settings, {});
  ASSERT_TRUE(result.refusals.empty());
  for (const std::string& name : embedded_cells()) {
    const robot::Cell cell = read_cell(name);
    const ArmedProgram armed = with_arms(result.program, cell);
    for (const Refusal& refusal : armed.report.refusals) ADD_FAILURE() << name << ": " << describe(refusal);
    if (!armed.program.cell) continue;
    const JointCheck check = check_joints(armed.program, cell);
    for (const std::string& line : check.breaches) ADD_FAILURE() << name << ": " << line;
    EXPECT_GE(check.joint_margin_rad, 10 * robot::kDegree_rad)
        << name << ": a margin that would be warned of";
    EXPECT_LE(check.speed_share, 1);
    EXPECT_LE(check.acceleration_share, 1);
    EXPECT_LE(check.jerk_share, 1);
    stream_to_a_controller_that_checks(armed.program, cell);
    // The cuts are those of the plan: arms change where blocks stand and when waypoints are met, nothing
    // else.
    for (std::size_t i = 0; i < armed.program.strips.size(); ++i) {
      const Strip &with = armed.program.strips[i], &without = result.program.strips[i];
      ASSERT_EQ(with.poses.size(), without.poses.size());
      for (std::size_t k = 0; k < with.poses.size(); ++k) {
        EXPECT_EQ(with.poses[k].a.p, without.poses[k].a.p);
        EXPECT_GE(with.poses[k].t, without.poses[k].t);
      }
      std::printf("%s in %s, %s: %.2f of %.2f s added, %.2f of that for jerk\n", GetParam(), name.c_str(),
                  with.id.c_str(), with.poses.back().t - without.poses.back().t, with.poses.back().t,
                  with.arms->jerk_s);
      EXPECT_LE(with.arms->jerk_s, 0.05 * without.poses.back().t);
    }
  }
}

// Plan and arms, whatever the number of threads.
TEST(PlannedSample, GivesTheSameBytesWithOneThreadAndTwoInACell) {
  std::string texts[2];
  for (const std::size_t threads : {1u, 2u}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const ArmedProgram armed =
        with_arms(plan(cylinder_design(), along_x(), {}).program, read_cell("two_irb4600"));
    ASSERT_TRUE(armed.report.refusals.empty()) << describe(armed.report.refusals.front());
    ASSERT_TRUE(armed.program.cell);
    texts[threads - 1] = to_json(armed.program);
  }
  EXPECT_EQ(texts[0], texts[1]);
}

// Blades turned by 90 degrees bring the wrists down to the table.
TEST(PlannedSample, RefusesWhatArmsCannot) {
  const std::string base = hotblade::testing::source_dir() + "/samples/corner";
  const Settings settings = resolve({{base + ".toml"}, {}, {}});
  const PlanResult result =
      plan(surface::read_obj(base + ".obj", {settings.design.units, 'z'}), settings, {});
  ASSERT_TRUE(result.refusals.empty());
  for (const std::string& name : embedded_cells()) {
    const ArmedProgram armed = with_arms(result.program, read_cell(name));
    EXPECT_FALSE(armed.program.cell) << name;
    ASSERT_FALSE(armed.report.refusals.empty()) << name;
    for (const Refusal& refusal : armed.report.refusals) {
      // Of two cells one is too near to its table, the other next to singular where its block is raised.
      EXPECT_THAT(describe(refusal),
                  ::testing::AnyOf(HasSubstr("from the plinth"), HasSubstr("from the table"),
                                   HasSubstr("next to singular: another jaw, or another place of the block")));
      EXPECT_THAT(describe(refusal), HasSubstr("of 10 choices of place and arms"));
    }
  }
}

}  // namespace
}  // namespace hotblade::pipeline
