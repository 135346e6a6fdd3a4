// Broken input for everything that reads text from outside: designs, programs, settings, cells,
// arms and their meshes.
// usage: hotblade_fuzz [ROUNDS [SEED]]. Each reader must either accept or throw the error it promises;
// anything else, and any report of the sanitizers it is built with, ends the run. The seed makes a run
// repeatable.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <random>
#include <string>
#include <utility>

#include "pipeline/cell/cell_file.hpp"
#include "pipeline/cell/embedded.hpp"
#include "pipeline/program/program.hpp"
#include "pipeline/settings/error.hpp"
#include "pipeline/settings/settings.hpp"
#include "robot/arm/model_file.hpp"
#include "robot/arm/stl.hpp"
#include "robot/arm/urdf.hpp"
#include "surface/read/design_surface.hpp"
#include "surface/slice/slice.hpp"
#include "tests/fuzz/broken_text.hpp"
#include "tests/pipeline/program/armed_vault.hpp"

namespace {

using namespace hotblade;
namespace fs = std::filesystem;

// Tokens that have broken readers before.
constexpr const char* kTokens[] = {"nan",         "inf",  "-1",    "0",        "1e999",      "4294967296",
                                   "-2147483649", "\\\n", "\x01",  "\r\n",     "f ",         "v ",
                                   "/",           "//",   "{",     "]",        "\"",         "null",
                                   "1e-320",      "= ",   "[[x]]", "\xff\xfe", "9999999999", ","};

std::string slurp(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string broken(std::string text, std::mt19937_64& random) {
  return testing::broken(std::move(text), kTokens, random);
}

void read_design(const std::string& text, const fs::path& file) {
  std::ofstream(file, std::ios::binary) << text;
  try {
    const surface::DesignSurface design = surface::read_obj(file, {"mm", 'z'});
    if (!design.health.blockers.empty() || design.mesh.triangles().empty()) return;
    const std::vector<double> offsets{-10, 0, 0.5, 10};
    (void)surface::slice(design.mesh, surface::parallel_about(design.mesh, Eigen::Vector3d::UnitX()),
                         offsets);
  } catch (const surface::MeshError&) {
  } catch (const surface::FileError&) {
  }
}

void read_program(const std::string& text) {
  try {
    (void)pipeline::parse_program(text, "fuzz.json");
  } catch (const pipeline::Error&) {
  }
}

void read_settings(const std::string& text, const fs::path& file) {
  std::ofstream(file, std::ios::binary) << text;
  try {
    (void)pipeline::resolve({{file}, {}, {}});
  } catch (const pipeline::Error&) {
  }
}

void read_cell(const std::string& text) {
  try {
    (void)pipeline::to_toml(pipeline::parse_cell(text, "fuzz.toml", {}));
  } catch (const pipeline::Error&) {
  }
}

// An arm that was taken has joints for where it is.
void read_arm(const std::string& text) {
  try {
    const robot::Arm arm = robot::parse_urdf(text, "fuzz.urdf", {}).arm;
    (void)robot::inverse(arm, robot::forward(arm, robot::JointAngles::Constant(0.3)));
  } catch (const robot::ModelError&) {
  }
}

void read_mesh(const std::string& bytes) {
  try {
    (void)robot::parse_stl(bytes, "fuzz.stl", Eigen::Vector3d::Ones());
  } catch (const robot::ModelError&) {
  }
}

std::string small_stl() {
  std::string bytes(84 + 2 * 50, '\0');
  bytes[80] = 2;
  return bytes;
}

std::string embedded(const std::string& path) {
  for (const pipeline::EmbeddedFile& file : pipeline::embedded_files()) {
    if (path == file.path) return file.text;
  }
  return "";
}

// A small design: the first rows of a sample would not mesh, so a grid of its own.
std::string small_obj() {
  std::string text = "# grid\no grid\n";
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) {
      text +=
          "v " + std::to_string(40 * i) + " " + std::to_string(40 * j) + " " + std::to_string(i * j) + ".5\n";
    }
  }
  for (int i = 0; i < 5; ++i) {
    for (int j = 1; j < 6; ++j) {
      const int a = 6 * i + j;
      text += "f " + std::to_string(a) + " " + std::to_string(a + 6) + " " + std::to_string(a + 7) + " " +
              std::to_string(a + 1) + "\n";
    }
  }
  return text;
}

// A strip of a few ribs and poses, held by arms.
std::string small_program() {
  pipeline::Program program = pipeline::testing::with_joints();
  program.strips.resize(1);
  pipeline::Strip& strip = program.strips.front();
  constexpr std::size_t kRibs = 2, kPoses = 3;
  strip.ribs.resize(std::min(kRibs, strip.ribs.size()));
  strip.poses.resize(kPoses);
  for (pipeline::BladePose& pose : strip.poses) pose.rib.reset();
  if (!strip.arms->clamp_times_s.empty()) strip.arms->clamp_times_s.resize(kPoses);
  std::string text = to_json(program);
  (void)pipeline::parse_program(text, "fuzz.json");  // whole, it is read
  return text;
}

}  // namespace

int main(int argc, char** argv) {
  const long rounds = argc > 1 ? std::atol(argv[1]) : 20000;
  const unsigned long seed = argc > 2 ? std::strtoul(argv[2], nullptr, 10) : 1;
  std::mt19937_64 random(seed);
  const fs::path directory = fs::temp_directory_path() / ("hotblade_fuzz_" + std::to_string(seed));
  fs::create_directories(directory);
  const std::string obj = small_obj(), program = small_program(), cell = embedded("cells/two_irb4600.toml"),
                    arm = embedded("arms/kuka_kr50_r2500/arm.urdf"), mesh = small_stl(),
                    settings = slurp(std::string(HOTBLADE_SOURCE_DIR) + "/samples/barrel_vault.toml");
  for (long i = 0; i < rounds; ++i) {
    try {
      read_design(broken(obj, random), directory / "fuzz.obj");
      read_program(broken(program, random));
      read_settings(broken(settings, random), directory / "fuzz.toml");
      read_cell(broken(cell, random));
      read_arm(broken(arm, random));
      read_mesh(broken(mesh, random));
    } catch (const std::exception& error) {
      std::printf("round %ld of seed %lu: %s\ninputs left in %s\n", i, seed, error.what(), directory.c_str());
      return 1;
    }
  }
  fs::remove_all(directory);
  std::printf("%ld rounds of seed %lu: every input was read or refused as promised, %ld of each reader\n",
              rounds, seed, rounds);
  return 0;
}
