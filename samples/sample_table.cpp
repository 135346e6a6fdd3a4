// Plans the samples and prints what came out as a Markdown table: sample_table [NAME]...
// or two of them, finely meshed, at five tolerances:              sample_table --tolerances [NAME]...
// Each is planned in a process of its own, so that the peak memory is its own.
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "pipeline/plan/plan.hpp"
#include "pipeline/verify/foam_share.hpp"
#include "samples/sample_surfaces.hpp"

namespace {

using namespace hotblade;

// A sample, in which mesh and at which tolerance; 0: that of its job file.
struct Case {
  std::string name;
  std::filesystem::path obj;
  double tolerance_mm = 0;
};

std::filesystem::path sample_file(const std::string& name, const char* extension) {
  return std::filesystem::path(HOTBLADE_SOURCE_DIR) / "samples" / (name + extension);
}

// Wall time of reading and planning; writing and pictures are not in it.
std::string row(const Case& c) {
  const std::string& name = c.name;
  const auto start = std::chrono::steady_clock::now();
  pipeline::Settings settings = pipeline::resolve({{sample_file(name, ".toml")}, {}, {}});
  if (c.tolerance_mm > 0) settings.design.tolerance_mm = c.tolerance_mm;
  const surface::DesignSurface design =
      surface::read_obj(c.obj, {settings.design.units, settings.design.up.front()});
  const pipeline::PlanResult result = pipeline::plan(design, settings, {});
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::size_t ribs = 0;
  double kink = 0, gap = 0, kept = 0, volume = 0, duration = 0;
  for (std::size_t i = 0; i < result.strips.size(); ++i) {
    const pipeline::StripFacts& f = result.strips[i];
    ribs += f.ribs;
    kink = std::max(kink, f.seam.kink_deg);
    gap = std::max(gap, f.seam.gap_mm);
    kept += f.stock_volume_mm3 * pipeline::foam_kept_share(result.program.strips[i]);
    volume += f.stock_volume_mm3;
    duration += f.motion.duration_s;
  }
  const std::vector<double>& beziers_mm = result.verification.ribs.bezier_mm;
  const double bezier_mm = beziers_mm.empty() ? 0 : *std::max_element(beziers_mm.begin(), beziers_mm.end());
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  const pipeline::Deviation& d = result.verification.deviation;
  return fmt::format(
      "| {} | {} | {} | {} | {:.3g} | {:.3f} | {:.3f} | {:.3f} / {:.2f} | {:.4f} / {} | {:.0f} | {:.0f} | "
      "{:.0f} | "
      "{:.2f} | {} | {} |",
      name, design.health.triangles, result.strips.size(), ribs, settings.design.tolerance_mm, d.max, d.p99,
      gap, kink, bezier_mm, result.verification.ribs.far.size(), volume > 0 ? 100 * kept / volume : 0,
      result.verification.uncut_mm2, duration / 60, seconds, used.ru_maxrss * 1024 / 1000000,
      pipeline::name(result.program.verification.status));
}

bool print_row(const Case& c) {
  std::fflush(stdout);
  const pid_t child = fork();
  if (child < 0) return false;
  if (child == 0) {
    int status = 0;
    try {
      std::puts(row(c).c_str());
    } catch (const std::exception& error) {
      std::fprintf(stderr, "%s: %s\n", c.name.c_str(), error.what());
      status = 1;
    }
    std::fflush(stdout);
    _exit(status);
  }
  int status = 0;
  return waitpid(child, &status, 0) == child && status == 0;
}

std::vector<Case> committed(std::vector<std::string> names) {
  if (names.empty()) {
    for (const auto& surface : samples::sample_surfaces()) names.push_back(surface.name);
  }
  std::vector<Case> cases;
  for (const std::string& name : names) cases.push_back({name, sample_file(name, ".obj")});
  return cases;
}

// Meshes whose chords are less than 0.02 mm high: a fifth of the smallest tolerance.
std::vector<Case> at_tolerances(std::vector<std::string> names, const std::filesystem::path& directory) {
  constexpr double kChordMm = 0.02;
  if (names.empty()) names = {"bump", "wave_wall"};
  std::vector<Case> cases;
  for (const std::string& name : names) {
    const std::filesystem::path obj = directory / (name + ".obj");
    for (const auto& surface : samples::sample_surfaces()) {
      if (surface.name != name) continue;
      const auto triangles = static_cast<double>(samples::triangle_count(surface));
      std::ofstream(obj, std::ios::binary)
          << samples::obj_text(*samples::refined(name, triangles * surface.chord_mm / kChordMm));
    }
    for (const double tolerance_mm : {2.0, 1.0, 0.5, 0.2, 0.1}) cases.push_back({name, obj, tolerance_mm});
  }
  return cases;
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> names(argv + 1, argv + argc);
  const bool tolerances = !names.empty() && names.front() == "--tolerances";
  if (tolerances) names.erase(names.begin());
  const std::filesystem::path directory =
      std::filesystem::temp_directory_path() / ("hotblade-samples-" + std::to_string(getpid()));
  std::filesystem::create_directory(directory);
  std::puts(
      "| sample | triangles | strips | ribs | tolerance mm | deviation max mm | p99 mm | seams: gap mm / "
      "kink deg | Bezier max mm / over a tenth | foam kept % | uncut mm2 | machine min | plan s | peak MB | "
      "status |");
  std::puts("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|");
  bool all = true;
  for (const Case& c : tolerances ? at_tolerances(names, directory) : committed(names))
    all = print_row(c) && all;
  std::filesystem::remove_all(directory);
  return all ? 0 : 1;
}
