#include "pipeline/export/rib_files.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <numbers>
#include <regex>
#include <sstream>

#include "tests/paths.hpp"
#include "tests/pipeline/temporary_directory.hpp"
#include "tests/pipeline/vault_program.hpp"

namespace hotblade::pipeline {
namespace {

using Eigen::Vector2d;

Program bent_program() {
  Program program = testing::vault_program({});
  // One rib with a vertex and an inflection, one straight.
  program.strips[0].ribs[0].elastica = {10, 5, 0.4, 2e-3, 1.2e-5, -4e-6, 700};
  program.strips[0].ribs[1].elastica = {0, 0, 0.1, 0, 0, 0, 300};
  return program;
}

// Points along what a file draws: the machine's own reading of it.
using Path = std::vector<Vector2d>;

void add_arc(Path& path, const Vector2d& to, const Vector2d& centre, bool anticlockwise) {
  const Vector2d from = path.back(), a = from - centre, b = to - centre;
  double turn = std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
  if (anticlockwise && turn < 0) turn += 2 * std::numbers::pi;
  if (!anticlockwise && turn > 0) turn -= 2 * std::numbers::pi;
  for (int i = 1; i <= 50; ++i) {
    const double t = turn * i / 50;
    path.push_back(centre + Vector2d(std::cos(t) * a.x() - std::sin(t) * a.y(),
                                     std::sin(t) * a.x() + std::cos(t) * a.y()));
  }
}

Path read_gcode(const std::string& text) {
  Path path;
  static const std::regex word("([GXYIJ])(-?[0-9.]+)");
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() || line[0] == '(' || line.find('X') == std::string::npos) continue;
    std::map<char, double> w;
    for (std::sregex_iterator i(line.begin(), line.end(), word), end; i != end; ++i) {
      w[(*i)[1].str()[0]] = std::stod((*i)[2].str());
    }
    const Vector2d to{w['X'], w['Y']};
    if (w['G'] >= 2) {
      add_arc(path, to, path.back() + Vector2d(w['I'], w['J']), w['G'] == 3);
    } else {
      path.push_back(to);
    }
  }
  return path;
}

double distance_to_path(const Path& path, const Vector2d& p) {
  double best = INFINITY;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const Vector2d d = path[i + 1] - path[i];
    const double t = d.squaredNorm() > 0 ? std::clamp((p - path[i]).dot(d) / d.squaredNorm(), 0.0, 1.0) : 0;
    best = std::min(best, (path[i] + t * d - p).norm());
  }
  return best;
}

double length_of(const Path& path) {
  double sum = 0;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) sum += (path[i + 1] - path[i]).norm();
  return sum;
}

TEST(RibFiles, AsGcodeFollowTheRibWithinTheToleranceTheyState) {
  const Program program = bent_program();
  const elastica::Elastica& rib = program.strips[0].ribs[0].elastica;
  for (const bool arcs : {false, true}) {
    const auto files = rib_files(program, "gcode", {arcs, 0.02});
    EXPECT_EQ(files[0].name, program.strips[0].ribs[0].id + ".nc");
    const Path path = read_gcode(files[0].text);
    for (const elastica::CurvePoint& p : elastica::sample(rib, 300)) {
      EXPECT_LT(distance_to_path(path, p.position()), 0.0201) << arcs;
    }
    EXPECT_NEAR(length_of(path), rib.length, arcs ? 1e-3 : 0.05);  // the reader's arcs are 50 chords
    EXPECT_THAT(files[0].text, ::testing::HasSubstr("length 700.000000 mm"));
    EXPECT_THAT(files[0].text, ::testing::HasSubstr(arcs ? " arcs, " : " chords, "));
    EXPECT_EQ(files[0].text.find("G3") != std::string::npos, arcs);
  }
}

TEST(RibFiles, StateNoErrorOverTheTolerance) {
  Program program = bent_program();
  // An inflection where it is nearly straight: arcs that are written as lines count too.
  program.strips[0].ribs[0].elastica = {0, 0, 0, 2e-9, -1e-8, 3e-11, 700};
  program.strips[0].ribs[1].elastica = {0, 0, 0.1, 1e-10, 0, 0, 300};
  static const std::regex within("within ([0-9.]+) mm");
  for (const double tolerance : {0.01, 1e-4, 1e-5}) {
    for (const bool arcs : {false, true}) {
      for (const ExportedFile& file : rib_files(program, "gcode", {arcs, tolerance})) {
        std::smatch stated;
        ASSERT_TRUE(std::regex_search(file.text, stated, within)) << file.name;
        EXPECT_LE(std::stod(stated[1]), tolerance) << file.name << (arcs ? " arcs" : " chords");
      }
    }
  }
}

TEST(RibFiles, OfStraightRibsHaveNoArcs) {
  const auto files = rib_files(bent_program(), "gcode", {true, 0.02});
  EXPECT_EQ(files[1].text.find("G3"), std::string::npos);
  EXPECT_NEAR(length_of(read_gcode(files[1].text)), 300, 1e-5);
}

struct DxfVertex {
  Vector2d at;
  double bulge;
};

// The polylines of a DXF file; group codes and values come in pairs of lines.
std::vector<std::vector<DxfVertex>> read_dxf(const std::string& text) {
  std::vector<std::vector<DxfVertex>> polylines;
  std::istringstream lines(text);
  std::string code, value, entity;
  while (std::getline(lines, code) && std::getline(lines, value)) {
    if (code == "0") entity = value;
    if (entity != "LWPOLYLINE") continue;
    if (code == "0") polylines.emplace_back();
    if (code == "10") polylines.back().push_back({{std::stod(value), 0}, 0});
    if (code == "20") polylines.back().back().at.y() = std::stod(value);
    if (code == "42") polylines.back().back().bulge = std::stod(value);
  }
  EXPECT_EQ(value, "EOF");
  return polylines;
}

// A bulge is the tangent of a quarter of the turning.
double dxf_length(const std::vector<DxfVertex>& polyline) {
  double sum = 0;
  for (std::size_t i = 0; i + 1 < polyline.size(); ++i) {
    const double chord = (polyline[i + 1].at - polyline[i].at).norm(),
                 half = 2 * std::atan(polyline[i].bulge);
    sum += half != 0 ? chord * half / std::sin(half) : chord;
  }
  return sum;
}

TEST(RibFiles, AsDxfHaveAPolylineARibWithBulgesOnlyForArcs) {
  const Program program = bent_program();
  for (const bool arcs : {false, true}) {
    const auto files = rib_files(program, "dxf", {arcs, 0.02});
    ASSERT_EQ(files.size(), program.strips.size());
    const auto polylines = read_dxf(files[0].text);
    ASSERT_EQ(polylines.size(), program.strips[0].ribs.size());
    EXPECT_NEAR(dxf_length(polylines[0]), 700, arcs ? 1e-6 : 0.05);
    EXPECT_EQ(polylines[0][0].bulge != 0, arcs);
    EXPECT_NEAR(dxf_length(polylines[1]), 300, 1e-6);
    EXPECT_EQ(polylines[1].size(), 2u);
    const elastica::ElasticaCurve rib(program.strips[0].ribs[0].elastica);
    const Vector2d chord = rib.at(700).position() - rib.at(0).position();
    EXPECT_LT((polylines[0].back().at - polylines[0].front().at - chord).norm(), 1e-6);
  }
}

TEST(RibFiles, AsSvgAndCsvNameEveryRib) {
  const Program program = bent_program();
  for (const bool arcs : {false, true}) {
    const std::string svg = rib_files(program, "svg", {arcs, 0.02})[0].text;
    const std::string csv = rib_files(program, "csv", {arcs, 0.02})[0].text;
    for (const Rib& rib : program.strips[0].ribs) {
      EXPECT_THAT(svg, ::testing::HasSubstr("id=\"" + rib.id + "\""));
      EXPECT_THAT(csv, ::testing::HasSubstr("\n" + rib.id + ",0,"));
      EXPECT_THAT(csv, ::testing::HasSubstr("# " + rib.id + " length"));
    }
    EXPECT_EQ(svg.find("A") != std::string::npos, arcs);
    EXPECT_EQ(svg.find("nan"), std::string::npos);
  }
}

TEST(RibsCommand, WritesFilesOnceAndRefusesToOverwrite) {
  const testing::TemporaryDirectory directory;
  const std::string file = (directory / "program.json").string(), out = (directory / "ribs").string();
  std::ofstream(file) << to_json(bent_program());
  const auto run = [](const std::string& arguments) {
    const std::string command = hotblade::testing::binary_dir() + "/hotblade " + arguments;
    return WEXITSTATUS(std::system((command + " > /dev/null 2>&1").c_str()));
  };
  const std::string command = "ribs " + file + " --format dxf --arcs -o " + out;
  EXPECT_EQ(run(command), 0);
  EXPECT_EQ(run(command), 7);
  EXPECT_EQ(run(command + " --force"), 0);
  EXPECT_EQ(run("ribs " + file + " --format pdf -o " + out), 2);
}

}  // namespace
}  // namespace hotblade::pipeline
