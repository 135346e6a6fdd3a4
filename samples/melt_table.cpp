// What it is worth to know that foam melts wider where the blade goes slower: melt_table [NAME]...
//
// Parts that turn are planned twice at three feeds: with one band, the one of the feed, and with the band by
// the local speed. Both programs are streamed to the controller's simulator, and what it executed is measured
// against the design in foam that melts by the speed. Prints two Markdown tables: the deviations, and the
// band along the rib where it differs most. Exit code 1 where a plan is refused or the coupled plan of a bend
// is not five times nearer.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "pipeline/plan/plan.hpp"
#include "pipeline/run/dryrun.hpp"
#include "pipeline/verify/as_cut.hpp"
#include "pipeline/verify/blade_speeds.hpp"
#include "samples/bends.hpp"

namespace {

namespace fs = std::filesystem;
using namespace hotblade;

constexpr std::array kFeedsMmS{3.0, 7.0, 15.0};
constexpr double kTimesNearer = 5;

const robot::Melt& foam() {
  static const robot::Melt foam = samples::bend_foam();
  return foam;
}

// A design and the settings of its job.
struct Part {
  std::string name;
  bool is_bend = false;  // or a sample that one blade does not fit as exactly
  surface::DesignSurface design;
  pipeline::Settings settings;
};

Part bend(const samples::SampleSurface& surface, const fs::path& directory) {
  const fs::path obj = directory / (surface.name + ".obj");
  std::ofstream(obj, std::ios::binary) << samples::obj_text(surface);
  return {surface.name, true, surface::read_obj(obj, {.units = surface.units}),
          samples::bend_settings(surface)};
}

Part corner() {
  const fs::path samples = fs::path(HOTBLADE_SOURCE_DIR) / "samples";
  const pipeline::Settings settings = pipeline::resolve({{samples / "corner.toml"}, {}, {}});
  return {"corner", false, surface::read_obj(samples / "corner.obj", {.units = settings.design.units}),
          settings};
}

// The largest deviation of what the simulator executes of a program, where foam melts like this.
double as_cut_mm(pipeline::Program program, const robot::Melt& foam, const surface::DesignSurface& design,
                 const fs::path& directory) {
  const fs::path file = directory / "program.json", log = directory / "execution.jsonl";
  fs::remove(log);
  std::ofstream(file, std::ios::binary) << pipeline::to_json(program);
  pipeline::StripJobs work = pipeline::read_strip_jobs(file, false);
  pipeline::DryRunOptions options;
  options.log_file = log;
  options.limits = pipeline::planned_limits(work.program);
  options.blade = pipeline::planned_blade(work.program);
  if (!pipeline::dry_run(work.jobs, options).holds()) throw std::runtime_error("the dry run does not hold");
  work.program.blade.melt = foam;
  pipeline::VerifyOptions how;
  how.tolerance_mm = work.program.verification.tolerance_mm;
  return pipeline::as_cut(work.program, pipeline::read_executed(work, log), design, how).cut.deviation.max;
}

// The bands along a rib, from its first end to its last.
struct RibBands {
  static constexpr std::size_t kPlaces = 9;
  std::string rib;
  std::array<double, kPlaces> speed_mm_s{}, band_mm{};
  [[nodiscard]] double spread_mm() const {
    const auto [least, most] = std::minmax_element(band_mm.begin(), band_mm.end());
    return *most - *least;
  }
};

// Of all ribs, the one along which the band differs most.
RibBands worst_rib(const pipeline::Program& program) {
  RibBands worst;
  for (const pipeline::Strip& strip : program.strips) {
    const pipeline::BladeSpeeds speeds(strip.poses);
    for (const pipeline::Rib& rib : strip.ribs) {
      RibBands bands{rib.id, {}, {}};
      const auto points = elastica::sample(rib.elastica, RibBands::kPlaces);
      for (std::size_t i = 0; i < points.size(); ++i) {
        bands.speed_mm_s[i] = speeds.at(rib.frame.point(points[i].x, points[i].y));
        bands.band_mm[i] = foam().band_mm(bands.speed_mm_s[i]);
      }
      if (worst.rib.empty() || bands.spread_mm() > worst.spread_mm()) worst = bands;
    }
  }
  return worst;
}

struct Row {
  std::string part;
  double feed_mm_s = 0;
  bool passed = false, is_bend = false;
  double one_known_mm = 0, one_mm = 0, coupled_mm = 0;
  RibBands bands;

  [[nodiscard]] double ratio() const { return one_mm / coupled_mm; }
  // What the speed adds to a plan that could have known: none where the coupled plan is the nearer one.
  [[nodiscard]] double one_adds_mm() const { return one_mm - one_known_mm; }
  [[nodiscard]] double coupled_adds_mm() const { return std::max(0.0, coupled_mm - one_known_mm); }
  [[nodiscard]] bool holds() const { return passed && (!is_bend || ratio() >= kTimesNearer); }
};

Row measured(const Part& part, double feed_mm_s, const fs::path& directory) {
  Row row;
  row.part = part.name;
  row.feed_mm_s = feed_mm_s;
  row.is_bend = part.is_bend;
  pipeline::Settings settings = part.settings;
  settings.motion.feed_mm_s = feed_mm_s;
  settings.blade.kerf_mm = foam().band_mm(feed_mm_s);
  const pipeline::PlanResult one = pipeline::plan(part.design, settings, {});
  settings.blade.melt = foam();
  const pipeline::PlanResult coupled = pipeline::plan(part.design, settings, {});
  for (const pipeline::PlanResult* plan : {&one, &coupled}) {
    if (plan->program.verification.status == pipeline::VerificationStatus::kPassed) continue;
    fmt::print(stderr, "{} at {} mm/s is refused\n", part.name, feed_mm_s);
    for (const pipeline::Refusal& refusal : plan->refusals) fmt::print(stderr, "  {}\n", describe(refusal));
    return row;
  }
  row.passed = true;
  row.one_known_mm = as_cut_mm(one.program, {}, part.design, directory);
  row.one_mm = as_cut_mm(one.program, foam(), part.design, directory);
  row.coupled_mm = as_cut_mm(coupled.program, foam(), part.design, directory);
  row.bands = worst_rib(coupled.program);
  return row;
}

std::string deviations(const Row& row) {
  if (!row.passed) return fmt::format("| {} | {:g} | refused |", row.part, row.feed_mm_s);
  const auto [least, most] = std::minmax_element(row.bands.band_mm.begin(), row.bands.band_mm.end());
  return fmt::format("| {} | {:g} | {:.2f} to {:.2f} | {:.3f} | {:.3f} | {:.3f} | {:.1f} | {:.3f} | {:.3f} |",
                     row.part, row.feed_mm_s, *least, *most, row.one_known_mm, row.one_mm, row.coupled_mm,
                     row.ratio(), row.one_adds_mm(), row.coupled_adds_mm());
}

void print_bands(const std::vector<Row>& rows) {
  std::printf("\n| part, rib | feed mm/s |");
  for (std::size_t i = 0; i < RibBands::kPlaces; ++i)
    fmt::print(" {:.3g} |", 100.0 * static_cast<double>(i) / (RibBands::kPlaces - 1));
  std::printf("\n|---|---|");
  for (std::size_t i = 0; i < RibBands::kPlaces; ++i) std::printf("---|");
  std::puts("");
  for (const Row& row : rows) {
    if (!row.passed) continue;
    fmt::print("| {} {} | {:g} |", row.part, row.bands.rib, row.feed_mm_s);
    for (std::size_t i = 0; i < RibBands::kPlaces; ++i)
      fmt::print(" {:.2f} ({:.2g}) |", row.bands.band_mm[i], row.bands.speed_mm_s[i]);
    std::puts("");
  }
}

bool all_hold(const std::vector<std::string>& names, const fs::path& directory) {
  std::vector<Part> parts;
  for (const samples::SampleSurface& surface : samples::bends()) parts.push_back(bend(surface, directory));
  parts.push_back(corner());
  std::puts(
      "| part | feed mm/s | band along the worst rib mm | one band, foam as planned mm | one band, foam by "
      "speed "
      "mm | coupled mm | times nearer | speed adds to one band mm | to coupled mm |\n"
      "|---|---|---|---|---|---|---|---|---|");
  std::vector<Row> rows;
  for (const Part& part : parts) {
    if (!names.empty() && std::find(names.begin(), names.end(), part.name) == names.end()) continue;
    for (const double feed_mm_s : kFeedsMmS) {
      rows.push_back(measured(part, feed_mm_s, directory));
      std::puts(deviations(rows.back()).c_str());
      std::fflush(stdout);
    }
  }
  print_bands(rows);
  return std::all_of(rows.begin(), rows.end(), [](const Row& row) { return row.holds(); });
}

}  // namespace

int main(int argc, char** argv) {
  const fs::path directory = fs::temp_directory_path() / ("hotblade-melt-" + std::to_string(getpid()));
  bool hold = false;
  try {
    fs::create_directory(directory);
    hold = all_hold({argv + 1, argv + argc}, directory);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
  }
  std::error_code ignored;
  fs::remove_all(directory, ignored);
  return hold ? 0 : 1;
}
