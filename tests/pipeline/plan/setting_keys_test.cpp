// Every setting is read: whatever key is changed, a plan comes out otherwise.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "pipeline/plan/plan.hpp"
#include "pipeline/program/read_design.hpp"
#include "pipeline/settings/settings.hpp"
#include "pipeline/verify/refusal.hpp"
#include "tests/pipeline/temporary_directory.hpp"

namespace hotblade::pipeline {
namespace {

// 240 mm across, 120 mm along x: a vault, or another height over (x, y).
using Height = std::function<double(double x, double y)>;
double vault(double, double y) {
  return std::sqrt(400 * 400 - y * y) - 380;
}

class DesignFile {
 public:
  explicit DesignFile(const std::filesystem::path& file) : out_(file) { out_.precision(17); }

  void patch(double x0, double x1, const Height& z, const std::function<bool(double, double)>& keep = {}) {
    constexpr int kAcross = 40, kAlong = 8;
    const auto x_of = [&](double i) { return x0 + (x1 - x0) * i / kAlong; };
    const auto y_of = [](double j) { return 240 * (j / kAcross - 0.5); };
    for (int i = 0; i <= kAlong; ++i)
      for (int j = 0; j <= kAcross; ++j)
        out_ << "v " << x_of(i) << " " << y_of(j) << " " << z(x_of(i), y_of(j)) << "\n";
    for (int i = 0; i < kAlong; ++i) {
      for (int j = 0; j < kAcross; ++j) {
        if (keep && !keep(x_of(i + 0.5), y_of(j + 0.5))) continue;
        const int a = first_ + i * (kAcross + 1) + j, c = a + kAcross + 1;
        out_ << "f " << a << " " << c << " " << c + 1 << "\nf " << a << " " << c + 1 << " " << a + 1 << "\n";
      }
    }
    first_ += (kAlong + 1) * (kAcross + 1);
  }
  void line(const std::string& text) { out_ << text << "\n"; }

 private:
  std::ofstream out_;
  int first_ = 1;
};

enum class Design { kVault, kTorn, kWindow, kBump, kDome, kGroups, kStep, kQuartic, kFold };

std::filesystem::path write(Design design, const std::filesystem::path& directory) {
  const std::filesystem::path path = directory / "design.obj";
  DesignFile file(path);
  switch (design) {
    case Design::kVault:
      file.patch(0, 120, vault);
      break;
    case Design::kTorn:
      file.patch(0, 60, vault);
      file.patch(60.02, 120, vault);
      break;
    case Design::kWindow:
      file.patch(0, 120, vault, [](double x, double y) { return std::abs(x - 60) > 20 || std::abs(y) > 40; });
      break;
    case Design::kBump:
      file.patch(0, 120, [](double, double y) { return 5 * std::exp(-y * y / 900); });
      break;
    case Design::kDome:
      file.patch(0, 120, [](double x, double y) { return -(x - 60) * (x - 60) / 300 - y * y / 800; });
      break;
    case Design::kQuartic:  // that one strip does not follow
      file.patch(0, 120, [](double, double y) { return -25 * std::pow(std::abs(y) / 120, 4); });
      break;
    case Design::kFold:  // of 20 degrees
      file.patch(0, 120, [](double, double y) { return -0.176 * std::abs(y); });
      break;
    case Design::kStep:  // with a wall down at its end, square to x, which no rib plane meets
      file.patch(0, 120, [](double, double) { return 0.0; });
      file.patch(120, 120.001, [](double x, double) { return -6e4 * (x - 120); });
      break;
    case Design::kGroups:
      file.line("g near");
      file.patch(0, 60, vault);
      file.line("g far");
      file.patch(100, 160, vault);
      break;
  }
  return path;
}

// What comes out of a design with these settings, without the settings themselves that a program repeats.
std::string outcome(Design design, const std::vector<std::string>& assignments) {
  const Settings settings = resolve({{}, assignments, {}});
  const testing::TemporaryDirectory directory;
  const std::filesystem::path file = write(design, directory.path());
  PlanResult result;
  try {
    result = plan(read_design(file, settings.design), settings, {});
  } catch (const std::exception& error) {
    return std::string("not planned: ") + error.what();
  }
  Program& program = result.program;
  program.settings = {};
  program.blade = program.settings.blade;
  program.design = {};
  program.verification.tolerance_mm = 0;
  std::string text = to_json(program);
  for (const Refusal& r : result.refusals) text += describe(r) + "\n";
  for (const std::string& warning : result.warnings) text += warning + "\n";
  return text;
}

// What a key is changed to, and what has to be so for it to count.
struct Change {
  const char *key, *value;
  std::vector<std::string> with{};
  Design design = Design::kVault;
};

const std::string kAlongX = "slice.direction=[1, 0, 0]";
const std::string kFan = "slice.fan_axis=[60, 0, -400, 0, 1, 0]";

const std::vector<Change>& changes() {
  static const std::vector<Change> all{
      {"design.units", "cm", {kAlongX}},
      {"design.up", "y", {kAlongX}},
      {"design.format", "stl", {kAlongX}},
      {"design.keep", "above", {kAlongX}},
      {"design.group", "far", {kAlongX}, Design::kGroups},
      {"design.facing", "[0, 1, 1]", {kAlongX, "design.facing_max_deg=45"}},
      {"design.facing_max_deg", "10", {kAlongX, "design.facing=[0, 0, 1]"}},
      {"design.stitch_mm", "0.1", {kAlongX}, Design::kTorn},
      {"design.tolerance_mm", "0.3", {kAlongX}, Design::kDome},
      {"design.max_uncut_share", "1", {kAlongX}, Design::kStep},
      {"design.over_budget", "refuse", {kAlongX, "machine.clamp_error_mm=2"}},
      {"slice.direction", "[1, 0.2, 0]", {kAlongX}},
      {"slice.fan_axis", "[60, 0, -400, 0, 1, 0]"},
      {"slice.spacing_mm", "5", {kAlongX}},
      {"slice.gaps", "apart", {kAlongX}, Design::kWindow},
      {"slice.shallow_folds", "parted", {"slice.direction=[0, 1, 0]"}, Design::kFold},
      {"fit.lambda_threshold", "0", {kAlongX}},
      {"fit.deviation_share", "0.1", {kAlongX}, Design::kDome},
      {"fit.max_splits", "0", {kAlongX}, Design::kQuartic},
      {"blade.free_lengths_mm", "[700]", {kAlongX}},
      {"blade.width_mm", "20", {kAlongX}},
      {"blade.thickness_mm", "0.3", {kAlongX}},
      {"blade.youngs_modulus_mpa", "100000", {kAlongX}},
      {"blade.poisson_ratio", "0.45", {kAlongX}},
      {"blade.yield_strength_mpa", "100", {kAlongX}, Design::kDome},
      {"blade.safety", "10", {kAlongX}},
      {"blade.density_kg_m3", "20000", {kAlongX}},
      {"blade.kerf_mm", "2", {kAlongX}},
      {"blade.min_margin", "1000", {kAlongX}},
      {"blade.min_margin_mm", "20", {kAlongX}, Design::kFold},
      {"blade.length_error_mm", "1", {kAlongX}},
      {"blade.stiffness_error", "0.1", {kAlongX}},
      {"foam.band_mm_at_mm_s", "[[1, 2.6], [3, 1.6], [7, 1.2]]", {kAlongX}},
      {"foam.melt_mm2_s", "15", {kAlongX, "foam.melt_mm2_s=12", "foam.loss_mm_s=5"}},
      {"foam.loss_mm_s", "4", {kAlongX, "foam.melt_mm2_s=12", "foam.loss_mm_s=5"}},
      {"stock.max_size_mm", "[150, 150, 150]", {kAlongX}},
      {"stock.base_mm", "80", {kAlongX}},
      {"stock.border_mm", "30", {kAlongX}},
      {"stock.clearance_mm", "55", {kAlongX}},
      {"motion.feed_mm_s", "3", {kAlongX}},
      {"motion.min_feed_mm_s", "7", {kFan}},
      {"motion.travel_mm_s", "20", {kAlongX}},
      {"motion.accel_mm_s2", "50", {kAlongX}},
      {"motion.jerk_mm_s3", "500", {kAlongX}},
      {"motion.angular_jerk_rad_s3", "1", {kAlongX}},
      {"motion.angular_rad_s", "0.01", {kAlongX}},
      {"motion.angular_accel_rad_s2", "0.01", {kAlongX}},
      {"motion.waypoint_s", "0.02", {kAlongX}},
      {"motion.preheat_s", "5", {kAlongX}},
      {"motion.approach_mm", "100", {kAlongX}},
      {"motion.lead_mm", "50", {kAlongX}},
      {"machine.envelope_mm", "[300, 300, 300]", {kAlongX}},
      {"machine.plinth_mm", "500", {kAlongX}},
      {"machine.clamp_error_mm", "0.5", {kAlongX}},
      {"machine.clamp_error_rad", "0.01", {kAlongX}},
      {"machine.clamp_a_shift_mm", "[0.5, 0, 0]", {kAlongX}},
      {"machine.clamp_a_turn_rad", "[0, 0, 0.002]", {kAlongX}},
      {"machine.clamp_b_shift_mm", "[0, 0.5, 0]", {kAlongX}},
      {"machine.clamp_b_turn_rad", "[0, 0.002, 0]", {kAlongX}},
  };
  return all;
}

TEST(SettingKeys, AllOfThemAreTried) {
  std::set<std::string> tried, known;
  for (const Change& c : changes()) tried.insert(c.key);
  for (const SettingInfo& info : describe_settings()) {
    // What stands on the sheets changes no cut: tests/pipeline/report/sheets_test.cpp and
    // tests/pipeline/stock/foam_to_buy_test.cpp try these.
    const bool sheets =
        info.key.starts_with("job.") || info.key == "stock.sizes_mm" || info.key == "stock.saw_mm";
    if (!sheets) known.insert(info.key);
  }
  EXPECT_EQ(tried, known);
}

TEST(SettingKeys, EachOneChangesWhatComesOut) {
  std::map<std::pair<Design, std::vector<std::string>>, std::string> before;
  for (const Change& c : changes()) {
    std::vector<std::string> assignments{"design.units=mm"};
    assignments.insert(assignments.end(), c.with.begin(), c.with.end());
    const auto [at, first] = before.try_emplace({c.design, assignments});
    if (first) at->second = outcome(c.design, assignments);
    assignments.push_back(std::string(c.key) + "=" + c.value);
    // Twice the same text is no failure of its own, so both are compared as a whole and not printed.
    EXPECT_TRUE(at->second != outcome(c.design, assignments))
        << c.key << " = " << c.value << " changes nothing";
  }
  // The comparison says nothing unless the same settings give the same outcome.
  EXPECT_TRUE(outcome(Design::kVault, {"design.units=mm", kAlongX}) ==
              (before[{Design::kVault, {"design.units=mm", kAlongX}}]));
}

}  // namespace
}  // namespace hotblade::pipeline
