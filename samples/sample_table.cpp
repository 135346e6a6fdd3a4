// Plans the samples and prints what came out as a Markdown table: sample_table [NAME]...
// Each is planned in a process of its own, so that the peak memory is its own.
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "pipeline/plan/plan.hpp"
#include "pipeline/report/foam_share.hpp"
#include "samples/sample_surfaces.hpp"

namespace {

using namespace hotblade;

// Wall time of reading and planning; writing and pictures are not in it.
std::string row(const std::string& name) {
  const auto start = std::chrono::steady_clock::now();
  const std::string base = std::string(HOTBLADE_SOURCE_DIR) + "/samples/" + name;
  const pipeline::Settings settings = pipeline::resolve({{base + ".toml"}, {}, {}});
  const surface::DesignSurface design =
      surface::read_obj(base + ".obj", {settings.design.units, settings.design.up.front()});
  const pipeline::PlanResult result = pipeline::plan(design, settings, {});
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::size_t ribs = 0;
  double kink = 0, gap = 0, kept = 0, volume = 0, duration = 0;
  for (std::size_t i = 0; i < result.strips.size(); ++i) {
    const pipeline::StripFacts& f = result.strips[i];
    ribs += f.ribs;
    kink = std::max(kink, f.seam_kink_deg);
    gap = std::max(gap, f.seam_gap_mm);
    kept += f.stock_volume_mm3 * pipeline::foam_kept_share(result.program.strips[i]);
    volume += f.stock_volume_mm3;
    duration += f.duration_s;
  }
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  const pipeline::Deviation& d = result.verification.deviation;
  return fmt::format(
      "| {} | {} | {} | {} | {:.3g} | {:.3f} | {:.3f} | {:.3f} / {:.2f} | {:.0f} | {:.0f} | {:.0f} | {:.2f} "
      "| "
      "{} | {} |",
      name, design.health.triangles, result.strips.size(), ribs, settings.design.tolerance_mm, d.max, d.p99,
      gap, kink, volume > 0 ? 100 * kept / volume : 0, result.verification.uncut_mm2, duration / 60, seconds,
      used.ru_maxrss / 1024, result.program.verification.status);
}

bool print_row(const std::string& name) {
  std::fflush(stdout);
  const pid_t child = fork();
  if (child < 0) return false;
  if (child == 0) {
    int status = 0;
    try {
      std::puts(row(name).c_str());
    } catch (const std::exception& error) {
      std::fprintf(stderr, "%s: %s\n", name.c_str(), error.what());
      status = 1;
    }
    std::fflush(stdout);
    _exit(status);
  }
  int status = 0;
  return waitpid(child, &status, 0) == child && status == 0;
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> names(argv + 1, argv + argc);
  if (names.empty()) {
    for (const auto& surface : samples::sample_surfaces()) names.push_back(surface.name);
  }
  std::puts(
      "| sample | triangles | strips | ribs | tolerance mm | deviation max mm | p99 mm | seams: gap mm / "
      "kink "
      "deg | foam kept % | uncut mm2 | machine min | plan s | peak MB | status |");
  std::puts("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|");
  bool all = true;
  for (const std::string& name : names) all = print_row(name) && all;
  return all ? 0 : 1;
}
