#include "robot/controller/execution_poses.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "elastica/blade/continuation.hpp"
#include "robot/client/client.hpp"
#include "tests/robot/controller/simulator_fixture.hpp"
#include "tests/robot/wire/sample_job.hpp"

namespace hotblade::robot {
namespace {

ControllerOptions instant() {
  ControllerOptions options;
  options.time_scale = kAsFastAsDataComes;
  return options;
}

std::map<std::uint64_t, std::vector<LoggedPose>> poses_after_streaming(const Job& job,
                                                                       const ControllerOptions& options) {
  testing::Simulator simulator(options);
  StreamOptions stream_options;
  stream_options.port = simulator.port();
  EXPECT_EQ(stream(job, stream_options).outcome, StreamOutcome::kDone);
  simulator.stop();
  return read_execution_poses(simulator.log_file());
}

TEST(ExecutionPoses, AreTheInterpolatedMotionWithItsShapes) {
  const Job job = testing::sample_job(120);
  const auto jobs = poses_after_streaming(job, instant());
  ASSERT_EQ(jobs.size(), 1u);
  const auto& poses = jobs.at(job.id);
  ASSERT_GE(poses.size(), 595u);
  const auto waypoints = testing::sample_waypoints(120);
  for (const LoggedPose& p : poses) {
    ASSERT_TRUE(p.blade);
    EXPECT_DOUBLE_EQ(p.blade->length, testing::kBladeLength_mm);
    const Waypoint& from = waypoints[p.sequence];
    const Waypoint& to = waypoints[std::min<std::size_t>(p.sequence + 1, waypoints.size() - 1)];
    // On the line between both, to the registers' micrometre and the log's tenth of one.
    const Eigen::Vector3d way = to.b.p - from.b.p, on = p.b.p - from.b.p;
    const double share = way.norm() > 0 ? on.dot(way) / way.squaredNorm() : 0;
    EXPECT_LT((on - share * way).norm(), 2e-3);
    EXPECT_EQ(p.heat, from.heat);
    const auto ends = elastica::clamps_of(*p.blade);
    const Eigen::Vector3d b = p.a.q.conjugate() * (p.b.p - p.a.p);
    EXPECT_NEAR(ends.b.x, b.x(), 1e-3);
    EXPECT_NEAR(ends.b.y, b.y(), 1e-3);
  }
}

TEST(ExecutionPoses, HaveNoShapesWithoutTheEquilibrium) {
  ControllerOptions options = instant();
  options.blade.equilibrium = false;
  const Job job = testing::sample_job(120);
  const auto jobs = poses_after_streaming(job, options);
  ASSERT_FALSE(jobs.at(job.id).empty());
  EXPECT_FALSE(jobs.at(job.id).front().blade);
}

TEST(ExecutionPoses, ALineThatIsNoneIsNamedWithItsNumber) {
  const auto file =
      std::filesystem::temp_directory_path() / ("poses_" + std::to_string(::getpid()) + ".jsonl");
  const std::string good =
      R"({"ev":"pose","job":"00000000000000ff","seq":3,"t":1.5,"a":{"p":[1,2,3],"q":[1,0,0,0]},)"
      R"("b":{"p":[4,5,6],"q":[0,1,0,0]},"blade":null,"heat":true,"state":"RUNNING","path":1.25,"following_mm":0})";
  std::ofstream(file) << good << "\n" << good.substr(0, 90);  // torn
  const auto jobs = read_execution_poses(file);
  ASSERT_EQ(jobs.at(255).size(), 1u);
  EXPECT_EQ(jobs.at(255)[0].sequence, 3u);
  EXPECT_TRUE(jobs.at(255)[0].heat);
  EXPECT_EQ(jobs.at(255)[0].path_s, 1.25);
  EXPECT_EQ(jobs.at(255)[0].b.p, Eigen::Vector3d(4, 5, 6));
  for (const auto& [from, to] :
       {std::pair{"[1,0,0,0]", "[1,1,0,0]"}, {"[1,2,3]", "[1,nan,3]"}, {"\"seq\"", "\"sek\""}}) {
    std::string bad = good;
    bad.replace(bad.find(from), std::string(from).size(), to);
    std::ofstream(file) << good << "\n" << bad << "\n";
    try {
      (void)read_execution_poses(file);
      FAIL() << bad;
    } catch (const LogError& error) {
      EXPECT_NE(std::string(error.what()).find(".jsonl:2:"), std::string::npos) << error.what();
    }
  }
  std::filesystem::remove(file);
  EXPECT_THROW((void)read_execution_poses(file), LogError);
}

}  // namespace
}  // namespace hotblade::robot
