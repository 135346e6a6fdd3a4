// Searches the samples' directions as `plan` does and once more with every candidate planned, and prints both
// as a Markdown table: direction_table [NAME]...
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <exception>
#include <string>
#include <vector>

#include "pipeline/plan/direction/direction.hpp"
#include "samples/sample_surfaces.hpp"
#include "surface/read/design_surface.hpp"

namespace {

using namespace hotblade;

double cpu_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

std::string describe(const pipeline::DirectionScore& d) {
  const Eigen::Vector3d v = d.fan ? d.fan->direction : d.normal;
  return fmt::format("{} ({:.3f}, {:.3f}, {:.3f})", d.fan ? "fan about" : "across", v.x() + 0.0, v.y() + 0.0,
                     v.z() + 0.0);
}

std::string row(const std::string& name) {
  const std::string base = std::string(HOTBLADE_SOURCE_DIR) + "/samples/" + name;
  pipeline::Settings settings = pipeline::resolve({{base + ".toml"}, {}, {}});
  settings.slice.direction.reset();
  settings.slice.fan_axis.reset();
  const surface::DesignSurface design =
      surface::read_obj(base + ".obj", {settings.design.units, settings.design.up.front()});
  const double start = cpu_seconds();
  const auto found = pipeline::rank_directions(design, settings);
  const double bounded = cpu_seconds();
  const auto all = pipeline::rank_directions(design, settings, pipeline::DirectionSearch::kAll);
  const double end = cpu_seconds();
  const auto planned = std::count_if(found.begin(), found.end(), [](const auto& d) { return !d.estimated; });
  const auto fans = std::count_if(all.begin(), all.end(), [](const auto& d) { return d.fan.has_value(); });
  const pipeline::DirectionScore& best = found.front();
  return fmt::format(
      "| {} | {} | {} | {} | {} | {:.2f} | {} | {:.3f} | {:.3f} / {:.3f} | {:.2f} | {} | {:.1f} / {:.1f} |",
      name, all.size(), fans, planned, describe(best), best.score, best.strips, best.deviation_mm,
      best.mean_sine, best.max_sine, all.front().score,
      all.front().score == best.score ? "same" : describe(all.front()), bounded - start, end - bounded);
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> names(argv + 1, argv + argc);
  if (names.empty()) {
    for (const auto& surface : samples::sample_surfaces()) names.push_back(surface.name);
  }
  std::puts(
      "| sample | candidates | of them fans | planned | found | score | strips | deviation mm | mean / max "
      "sin "
      "slope | best of all | which | processor s, all |\n|---|---|---|---|---|---|---|---|---|---|---|---|");
  bool all = true;
  for (const std::string& name : names) {
    try {
      std::puts(row(name).c_str());
    } catch (const std::exception& error) {
      std::fprintf(stderr, "%s: %s\n", name.c_str(), error.what());
      all = false;
    }
    std::fflush(stdout);
  }
  return all ? 0 : 1;
}
