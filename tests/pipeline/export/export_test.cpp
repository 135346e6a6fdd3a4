#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>
#include <regex>
#include <sstream>

#include "pipeline/export/robot_programs.hpp"
#include "pipeline/export/surface_files.hpp"
#include "pipeline/export/waypoint_files.hpp"
#include "pipeline/settings/error.hpp"
#include "pipeline/verify/swept_surface.hpp"
#include "surface/read/design_surface.hpp"
#include "tests/pipeline/program/armed_vault.hpp"
#include "tests/pipeline/temporary_directory.hpp"
#include "tests/pipeline/vault_program.hpp"

namespace hotblade::pipeline {
namespace {

using ::testing::HasSubstr;

Program two_strips() {
  testing::VaultOptions options;
  options.strips = 2;
  return testing::vault_program(options);
}

std::vector<double> numbers_in(const std::string& text) {
  static const std::regex number("-?[0-9]+\\.[0-9]+");
  std::vector<double> all;
  for (std::sregex_iterator i(text.begin(), text.end(), number), end; i != end; ++i)
    all.push_back(std::stod(i->str()));
  return all;
}

std::vector<std::string> lines_with(const std::string& text, const std::string& word) {
  std::vector<std::string> found;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.find(word) != std::string::npos) found.push_back(line);
  }
  return found;
}

double angle_between(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  return a.angularDistance(b);
}

// Turns about Z, then the new Y, then the new X.
Eigen::Quaterniond from_kuka(double a_deg, double b_deg, double c_deg) {
  constexpr double kDegree = std::numbers::pi / 180;
  return Eigen::AngleAxisd(a_deg * kDegree, Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(b_deg * kDegree, Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(c_deg * kDegree, Eigen::Vector3d::UnitX());
}

TEST(JointsCsv, HoldsEveryJointInDegrees) {
  const Program program = testing::with_joints();
  const std::vector<ExportedFile> files = joints_csv(program);
  ASSERT_EQ(files.size(), 2U);
  EXPECT_EQ(files[1].name, "S002_joints.csv");
  std::istringstream lines(files[1].text);
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line,
            "index,t_s,phase,heat,a1_deg,a2_deg,a3_deg,a4_deg,a5_deg,a6_deg,b1_deg,b2_deg,b3_deg,b4_deg,b5_"
            "deg,b6_deg");
  std::size_t i = 0;
  for (; std::getline(lines, line); ++i) {
    const BladePose& pose = program.strips[1].poses.at(i);
    std::istringstream cells(line);
    std::vector<std::string> found;
    for (std::string cell; std::getline(cells, cell, ',');) found.push_back(cell);
    ASSERT_EQ(found.size(), 16U);
    EXPECT_NEAR(std::stod(found[1]), pose.t, 1e-6);
    for (std::size_t k = 0; k < kArmJoints; ++k) {
      constexpr double kDegrees = 180 / std::numbers::pi;
      EXPECT_NEAR(std::stod(found[4 + k]), pose.joints->a[k] * kDegrees, 1e-6);
      EXPECT_NEAR(std::stod(found[10 + k]), pose.joints->b[k] * kDegrees, 1e-6);
    }
  }
  EXPECT_EQ(i, program.strips[1].poses.size());
}

TEST(JointsCsv, NeedsAProgramWithJoints) {
  EXPECT_THROW((void)joints_csv(two_strips()), Error);
}

TEST(KukaAngles, TurnBackToTheOrientationAlsoWhereAxesFallTogether) {
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 2000; ++i) {
    Eigen::Quaterniond q(normal(random), normal(random), normal(random), normal(random));
    q.normalize();
    if (i % 4 == 0) q = from_kuka(40 * normal(random), i % 8 == 0 ? 90 : -90, 40 * normal(random));
    const KukaAngles k = kuka_angles(q);
    EXPECT_LT(angle_between(from_kuka(k.a, k.b, k.c), q), 1e-7);
    EXPECT_LE(std::abs(k.b), 90.0);
  }
}

TEST(Rapid, ReadsBackToTheWaypointsWithTheSameMoveNumbersInBothArms) {
  const Program program = two_strips();
  const std::vector<ExportedFile> files = rapid_programs(program);
  ASSERT_EQ(files.size(), 2u);
  std::vector<std::string> ids[2];
  for (std::size_t arm = 0; arm < 2; ++arm) {
    const std::vector<std::string> moves = lines_with(files[arm].text, "MoveL ");
    ASSERT_EQ(moves.size(), 2 * (program.strips[0].poses.size() - 1));
    std::size_t move = 0;
    for (const Strip& strip : program.strips) {
      const std::vector<robot::Waypoint> path = waypoints(strip);
      for (std::size_t i = 1; i < path.size(); ++i, ++move) {
        const robot::Waypoint& w = path[i];
        const Pose& pose = arm == 0 ? w.a : w.b;
        const std::vector<double> n = numbers_in(moves[move]);
        ASSERT_EQ(n.size(), 8u) << moves[move];
        EXPECT_LT((Eigen::Vector3d(n[0], n[1], n[2]) - pose.p).norm(), 1e-4);
        EXPECT_LT(angle_between(Eigen::Quaterniond(n[3], n[4], n[5], n[6]), pose.q), 1e-7);
        EXPECT_NEAR(n[7], 1e-6 * (w.t_us - path[i - 1].t_us), 1e-9);
        ids[arm].push_back(moves[move].substr(moves[move].find("\\ID"), 8));
      }
    }
  }
  EXPECT_EQ(ids[0], ids[1]);
}

TEST(Krl, ReadsBackToTheWaypointsAndItsTimesAddUp) {
  const Program program = two_strips();
  const std::vector<ExportedFile> files = krl_programs(program);
  ASSERT_EQ(files.size(), 2u);
  for (std::size_t arm = 0; arm < 2; ++arm) {
    const auto moves = lines_with(files[arm].text, "SLIN ");
    const auto parts = lines_with(files[arm].text, "TIME_BLOCK PART");
    const auto ends = lines_with(files[arm].text, "TIME_BLOCK END");
    ASSERT_EQ(parts.size(), moves.size());
    ASSERT_EQ(ends.size(), 2u);
    std::size_t move = 0;
    for (std::size_t s = 0; s < 2; ++s) {
      const std::vector<robot::Waypoint> path = waypoints(program.strips[s]);
      double sum = 0;
      for (std::size_t i = 1; i < path.size(); ++i, ++move) {
        const Pose& pose = arm == 0 ? path[i].a : path[i].b;
        const std::vector<double> n = numbers_in(moves.at(move));
        ASSERT_EQ(n.size(), 6u);
        EXPECT_LT((Eigen::Vector3d(n[0], n[1], n[2]) - pose.p).norm(), 1e-4);
        EXPECT_LT(angle_between(from_kuka(n[3], n[4], n[5]), pose.q), 1e-7);
        sum += numbers_in(parts[move]).at(0);
      }
      EXPECT_NEAR(numbers_in(ends[s]).at(0), sum, 1e-5);
      EXPECT_NEAR(sum, 1e-6 * path.back().t_us, 1e-5);
    }
  }
}

TEST(RobotPrograms, SwitchTheHeatOnArmAAloneAndOffAtTheEnd) {
  const Program program = two_strips();
  const auto rapid = rapid_programs(program);
  EXPECT_TRUE(lines_with(rapid[1].text, "SetDO").empty());
  EXPECT_THAT(lines_with(rapid[0].text, "SetDO").back(), HasSubstr("hb_heat,0"));
  const auto krl = krl_programs(program);
  EXPECT_TRUE(lines_with(krl[1].text, "hb_heat=").empty());
  EXPECT_THAT(lines_with(krl[0].text, "hb_heat=").back(), HasSubstr("FALSE"));
}

TEST(WaypointCsv, HoldsEveryWaypoint) {
  const Program program = two_strips();
  const std::vector<ExportedFile> files = waypoint_csv(program);
  ASSERT_EQ(files.size(), 2u);
  for (std::size_t s = 0; s < 2; ++s) {
    EXPECT_EQ(files[s].name, program.strips[s].id + ".csv");
    const std::vector<robot::Waypoint> path = waypoints(program.strips[s]);
    std::istringstream lines(files[s].text);
    std::string line;
    std::getline(lines, line);
    const auto columns = std::count(line.begin(), line.end(), ',') + 1;
    EXPECT_EQ(columns, 18);
    for (const robot::Waypoint& w : path) {
      ASSERT_TRUE(std::getline(lines, line));
      EXPECT_EQ(std::count(line.begin(), line.end(), ',') + 1, columns);
      const std::vector<double> n = numbers_in(line);
      ASSERT_EQ(n.size(), 15u);
      EXPECT_NEAR(n[0], 1e-6 * w.t_us, 1e-9);
      EXPECT_LT((Eigen::Vector3d(n[1], n[2], n[3]) - w.a.p).norm(), 1e-6);
      EXPECT_LT((Eigen::Vector3d(n[8], n[9], n[10]) - w.b.p).norm(), 1e-6);
      EXPECT_LT(angle_between(Eigen::Quaterniond(n[11], n[12], n[13], n[14]), w.b.q), 1e-7);
    }
    EXPECT_FALSE(std::getline(lines, line));
  }
}

TEST(WaypointCompas, FramesAreOrthonormalAndLieOnTheClamps) {
  const Program program = two_strips();
  const auto job = nlohmann::json::parse(waypoint_compas(program).at(1).text);
  const std::vector<robot::Waypoint> path = waypoints(program.strips[1]);
  ASSERT_EQ(job["clamp_b"].size(), path.size());
  ASSERT_EQ(job["times_s"].size(), path.size());
  const auto vector = [](const nlohmann::json& j) {
    return Eigen::Vector3d(j[0].get<double>(), j[1].get<double>(), j[2].get<double>());
  };
  for (std::size_t i = 0; i < path.size(); ++i) {
    const auto& data = job["clamp_b"][i]["data"];
    EXPECT_LT((vector(data["point"]) - path[i].b.p).norm(), 1e-9);
    EXPECT_NEAR(vector(data["xaxis"]).norm(), 1, 1e-12);
    EXPECT_NEAR(vector(data["xaxis"]).dot(vector(data["yaxis"])), 0, 1e-12);
    EXPECT_LT((vector(data["xaxis"]) - path[i].b.q * Eigen::Vector3d::UnitX()).norm(), 1e-12);
  }
}

TEST(AsCutObj, ReadsBackAsTheSweptSurface) {
  const Program program = two_strips();
  const testing::TemporaryDirectory directory;
  const ExportedFile file = as_cut_obj(program, 5);
  std::ofstream(directory / file.name) << file.text;
  const surface::DesignSurface read = surface::read_obj(directory / file.name, {"mm", 'z'});
  const SweptSurface swept = swept_surface(program, 5);
  ASSERT_EQ(read.health.file_vertices, swept.vertices.size());
  EXPECT_EQ(read.health.file_faces, swept.triangles.size());
  for (const Eigen::Vector3d& p : read.mesh.vertices()) {
    EXPECT_NEAR(std::hypot(p.x(), p.z() + testing::kVaultRadius * std::cos(testing::kVaultHalfAngle)),
                testing::kVaultRadius, 0.05);
  }
}

TEST(AsCutPly, SaysAsManyVerticesAndFacesAsItHolds) {
  const Program program = two_strips();
  const std::string text = as_cut_ply(program, 5).text;
  const SweptSurface swept = swept_surface(program, 5);
  EXPECT_THAT(text, HasSubstr("element vertex " + std::to_string(swept.vertices.size()) + "\n"));
  EXPECT_THAT(text, HasSubstr("element face " + std::to_string(swept.triangles.size()) + "\n"));
  const std::string body = text.substr(text.find("end_header\n") + 11);
  EXPECT_EQ(static_cast<std::size_t>(std::count(body.begin(), body.end(), '\n')),
            swept.vertices.size() + swept.triangles.size());
}

}  // namespace
}  // namespace hotblade::pipeline
