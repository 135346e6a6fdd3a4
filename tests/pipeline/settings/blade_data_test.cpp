// The blades that ship with the program.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "pipeline/settings/settings.hpp"
#include "robot/blade/blade_section.hpp"

#include "tests/paths.hpp"

namespace hotblade::pipeline {
namespace {

namespace fs = std::filesystem;

TEST(BladeData, EveryShippedBladeIsAValidConfigurationThatNamesItsSources) {
  std::size_t blades = 0;
  for (const auto& entry : fs::directory_iterator(hotblade::testing::source_dir() + "/samples/blades")) {
    const Settings settings = resolve({{entry.path()}, {}, {}});
    EXPECT_GT(1 / max_curvature_per_mm(settings.blade), 30) << entry.path();
    EXPECT_LT(1 / max_curvature_per_mm(settings.blade), 200) << entry.path();
    std::ostringstream text;
    text << std::ifstream(entry.path()).rdbuf();
    EXPECT_NE(text.str().find("# Sources:"), std::string::npos) << entry.path();
    ++blades;
  }
  EXPECT_GE(blades, 2u);
}

TEST(BladeData, TheShippedFoamMeltsTheDefaultBandAtTheDefaultFeedAndNamesItsSources) {
  const std::string file = hotblade::testing::source_dir() + "/samples/foams/eps_20.toml";
  const Settings settings = resolve({{file}, {}, {}});
  EXPECT_NEAR(settings.blade.band_mm(settings.motion.feed_mm_s), Settings{}.blade.kerf_mm, 1e-9);
  EXPECT_NEAR(settings.blade.band_mm(2), 1.75, 0.01);
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  EXPECT_NE(text.str().find("# Where the numbers are from:"), std::string::npos);
}

TEST(BladeData, TheDefaultsAreTheSpringSteelThatShips) {
  const Settings shipped =
      resolve({{hotblade::testing::source_dir() + "/samples/blades/spring_steel_1_4310.toml"}, {}, {}});
  const Settings defaults;
  EXPECT_EQ(to_toml(shipped), to_toml(defaults));
}

TEST(BladeData, TheThinBladeBendsToTheRadiusItPromises) {
  const Settings thin =
      resolve({{hotblade::testing::source_dir() + "/samples/blades/carbon_steel_c67s.toml"}, {}, {}});
  EXPECT_NEAR(1 / max_curvature_per_mm(thin.blade), 43.5, 0.5);
}

}  // namespace
}  // namespace hotblade::pipeline
