#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>
#include <regex>
#include <sstream>

#include "pipeline/export/robot_jobs.hpp"
#include "pipeline/export/robot_programs.hpp"
#include "pipeline/export/surface_files.hpp"
#include "pipeline/export/waypoint_files.hpp"
#include "pipeline/program/straight_start.hpp"
#include "pipeline/settings/error.hpp"
#include "pipeline/verify/swept_surface.hpp"
#include "surface/read/design_surface.hpp"
#include "tests/pipeline/program/armed_vault.hpp"
#include "tests/pipeline/temporary_directory.hpp"
#include "tests/pipeline/vault_program.hpp"

namespace hotblade::pipeline {
namespace {

using ::testing::HasSubstr;

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
      EXPECT_NEAR(std::stod(found[4 + k]), program.strips[1].joints[i].a[k] * kDegrees, 1e-6);
      EXPECT_NEAR(std::stod(found[10 + k]), program.strips[1].joints[i].b[k] * kDegrees, 1e-6);
    }
  }
  EXPECT_EQ(i, program.strips[1].poses.size());
}

TEST(JointsCsv, NeedsAProgramWithJoints) {
  EXPECT_THROW((void)joints_csv(testing::vault_program({.strips = 2})), Error);
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

// What of a strip's files one task has: the moves behind those that bend the straight blade.
std::vector<std::string> moves_of(const std::vector<ExportedFile>& files, const std::string& name,
                                  const std::string& word) {
  std::vector<std::string> all;
  for (const ExportedFile& file : files) {
    if (file.name != name) continue;
    all = lines_with(file.text, word);
  }
  if (all.size() < kStartMoves) return {};
  all.erase(all.begin(), all.begin() + kStartMoves);
  return all;
}

TEST(Rapid, ReadsBackToTheWaypointsWithTheSameMoveNumbersInBothArms) {
  const Program program = testing::vault_program({.strips = 2});
  const std::vector<ExportedFile> files = rapid_programs(program, nullptr, RobotMoves::kCartesian);
  ASSERT_EQ(files.size(), 6u) << "a file a strip and one that calls them, for two arms";
  for (const Strip& strip : program.strips) {
    std::vector<std::string> ids[2];
    for (std::size_t arm = 0; arm < 2; ++arm) {
      const auto moves = moves_of(files, "hb_" + strip.id + (arm == 0 ? "_a.mod" : "_b.mod"), "\\ID:=");
      const std::vector<robot::Waypoint> path = waypoints(strip);
      ASSERT_EQ(moves.size(), path.size() - 1);
      for (std::size_t i = 1; i < path.size(); ++i) {
        const robot::Waypoint& w = path[i];
        const Pose& pose = arm == 0 ? w.a : w.b;
        const std::vector<double> n = numbers_in(moves[i - 1]);
        ASSERT_EQ(n.size(), 8u) << moves[i - 1];
        EXPECT_LT((Eigen::Vector3d(n[0], n[1], n[2]) - pose.p).norm(), 1e-4);
        EXPECT_LT(angle_between(Eigen::Quaterniond(n[3], n[4], n[5], n[6]), pose.q), 1e-7);
        EXPECT_NEAR(n[7], 1e-6 * (w.t_us - path[i - 1].t_us), 1e-9);
        ids[arm].push_back(moves[i - 1].substr(moves[i - 1].find("\\ID"), 8));
      }
      EXPECT_THAT(moves.back(), HasSubstr(",fine,"));
    }
    EXPECT_EQ(ids[0], ids[1]);
  }
}

TEST(Krl, ReadsBackToTheWaypointsAndItsTimesAddUp) {
  const Program program = testing::vault_program({.strips = 2});
  const std::vector<ExportedFile> files = krl_programs(program, nullptr, RobotMoves::kCartesian);
  ASSERT_EQ(files.size(), 6u);
  for (const Strip& strip : program.strips) {
    for (std::size_t arm = 0; arm < 2; ++arm) {
      const std::string name = "hb_" + strip.id + (arm == 0 ? "_a.src" : "_b.src");
      const auto moves = moves_of(files, name, "SPL {"), parts = moves_of(files, name, "TIME_BLOCK PART");
      const std::vector<robot::Waypoint> path = waypoints(strip);
      ASSERT_EQ(moves.size(), path.size() - 1);
      ASSERT_EQ(parts.size(), moves.size());
      double sum = 0;
      for (std::size_t i = 1; i < path.size(); ++i) {
        const Pose& pose = arm == 0 ? path[i].a : path[i].b;
        const std::vector<double> n = numbers_in(moves[i - 1]);
        ASSERT_EQ(n.size(), 6u);
        EXPECT_LT((Eigen::Vector3d(n[0], n[1], n[2]) - pose.p).norm(), 1e-4);
        EXPECT_LT(angle_between(from_kuka(n[3], n[4], n[5]), pose.q), 1e-7);
      }
      const auto file =
          std::find_if(files.begin(), files.end(), [&](const auto& f) { return f.name == name; });
      EXPECT_TRUE(lines_with(file->text, "SLIN").empty());
      for (const std::string& part : lines_with(file->text, "TIME_BLOCK PART")) sum += numbers_in(part).at(0);
      EXPECT_NEAR(sum, 100.0 * static_cast<double>(lines_with(file->text, "TIME_BLOCK END").size()), 1e-9);
      double seconds = 0;
      for (const std::string& end : lines_with(file->text, "TIME_BLOCK END"))
        seconds += numbers_in(end).at(0);
      EXPECT_NEAR(seconds, 4 + 1e-6 * path.back().t_us, 1e-5) << "with the blade's bending";
    }
  }
}

TEST(RobotPrograms, SwitchTheHeatOnTheFirstArmAloneWhereItStopsAndOffAtTheEnd) {
  const Program program = testing::vault_program({.strips = 2});
  for (const ExportedFile& file : rapid_programs(program, nullptr, RobotMoves::kCartesian)) {
    const auto lines = lines_with(file.text, "SetDO");
    if (file.name.find("_a.mod") == std::string::npos || file.name.find("main") != std::string::npos) {
      EXPECT_TRUE(lines.empty()) << file.name;
      continue;
    }
    EXPECT_THAT(lines.back(), HasSubstr("hb_heat,0"));
    EXPECT_THAT(file.text, HasSubstr("SetDO hb_heat,1"));
    // Behind a change of the output stands a move that stopped, or a wait.
    std::istringstream all(file.text);
    std::string before;
    for (std::string line; std::getline(all, line); before = line) {
      if (line.find("SetDO hb_heat,1") == std::string::npos) continue;
      EXPECT_TRUE(before.find(",fine,") != std::string::npos || before.find("WaitTime") != std::string::npos)
          << before;
    }
  }
  for (const ExportedFile& file : krl_programs(program, nullptr, RobotMoves::kCartesian)) {
    const auto lines = lines_with(file.text, "hb_heat=");
    if (file.name.find("_b.src") != std::string::npos) {
      EXPECT_TRUE(lines.empty()) << file.name;
    } else if (file.name.find("main") == std::string::npos) {
      EXPECT_THAT(lines.back(), HasSubstr("FALSE"));
    }
  }
}

TEST(RobotPrograms, AreAsciiAndSplitLongStrips) {
  Program program = testing::vault_program({.strips = 2});
  program.design.file = "Gew\xC3\xB6lbe \"A\".obj";
  for (const auto& files : {rapid_programs(program, nullptr, RobotMoves::kCartesian),
                            krl_programs(program, nullptr, RobotMoves::kCartesian)}) {
    for (const ExportedFile& file : files) {
      for (const char c : file.text) EXPECT_TRUE(c == '\n' || (c >= ' ' && c <= '~')) << file.name;
    }
    EXPECT_THAT(files.front().text, HasSubstr("Gew_lbe _A_.obj"));
  }
  testing::VaultOptions options;
  options.poses = static_cast<int>(kMostMoves) + 100;
  const Program long_strip = testing::vault_program(options);
  const auto files = rapid_programs(long_strip, nullptr, RobotMoves::kCartesian);
  ASSERT_EQ(files.size(), 6u) << "two modules for the strip, and one that calls, for two arms";
  for (const ExportedFile& file : files) EXPECT_LE(lines_with(file.text, "\\ID:=").size(), kMostMoves);
  EXPECT_THAT(files.front().text, HasSubstr("hb_S001_2_a.mod"));
}

TEST(RobotPrograms, PutTheStraightBladeInBeforeTheyBendIt) {
  const Program program = testing::vault_program({.strips = 2});
  const auto tasks = robot_tasks(program, nullptr);
  for (std::size_t s = 0; s < program.strips.size(); ++s) {
    const RobotJob &a = tasks[0].jobs[s], &b = tasks[1].jobs[s];
    const Eigen::Vector3d along = b.load.pose.p - a.load.pose.p;
    EXPECT_NEAR(along.norm(), program.strips[s].blade_length_mm, 1e-6);
    for (const RobotJob* job : {&a, &b})
      EXPECT_NEAR((job->load.pose.q * Eigen::Vector3d::UnitX()).dot(along.normalized()), 1, 1e-12);
    // From there the jaws come together evenly, and end where the strip begins.
    double before = along.norm();
    for (int k = 0; k < kStartMoves; ++k) {
      const auto i = static_cast<std::size_t>(k);
      const double chord = (b.steps[i].to.pose.p - a.steps[i].to.pose.p).norm();
      EXPECT_LE(chord, before + 1e-9);
      before = chord;
    }
    const Pose first = waypoints(program.strips[s]).front().a;
    EXPECT_LE((a.steps[kStartMoves - 1].to.pose.p - first.p).norm(), 1e-9);
    EXPECT_LE((a.steps[kStartMoves - 2].to.pose.p - first.p).norm(), 1.0) << "no jump to the first waypoint";
  }
}

TEST(WaypointCsv, HoldsEveryWaypoint) {
  const Program program = testing::vault_program({.strips = 2});
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
  const Program program = testing::vault_program({.strips = 2});
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
  const Program program = testing::vault_program({.strips = 2});
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
  const Program program = testing::vault_program({.strips = 2});
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
