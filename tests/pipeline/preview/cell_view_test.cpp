// Arms in scenes, pictures and files: they hold the blade where the program has its clamps.
#include "pipeline/preview/cell_view.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "pipeline/cell/cell_file.hpp"
#include "pipeline/plan/arms/arms.hpp"
#include "pipeline/plan/arms/strip_clearance.hpp"
#include "pipeline/preview/drawing/draw_parts.hpp"
#include "pipeline/preview/drawing/exchange.hpp"
#include "pipeline/preview/view_model.hpp"
#include "tests/pipeline/vault_program.hpp"

namespace hotblade::pipeline::preview {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

class CellView : public ::testing::Test {
 protected:
  CellView() : cell_(read_cell("two_irb4600")) {
    Program vault = testing::vault_program();
    vault.settings.machine.envelope_mm = {4000, 4000, 3000};
    program_ = with_arms(vault, cell_).program;
    shown_.cell = &cell_;
    for (const Strip& strip : program_.strips) shown_.standing[strip.id] = surroundings(strip, cell_);
  }

  robot::Cell cell_;
  Program program_;
  CellShown shown_;
};

TEST_F(CellView, ToolsHoldTheBladeAtEveryPose) {
  ASSERT_TRUE(program_.cell);
  const Strip& strip = program_.strips[0];
  for (std::size_t k = 0; k < strip.poses.size(); ++k) {
    const BladePose& pose = strip.poses[k];
    for (const CellPart& part : cell_parts(shown_, strip, k)) {
      if (part.kind != CellPartKind::kTool) continue;
      const bool first = part.name == "arm_" + cell_.arms[0].id + "_tool";
      const robot::CellArm& arm = cell_.arms[first ? 0 : 1];
      const Eigen::Vector3d jaw = part.place * arm.tool.jaw_p_mm;
      EXPECT_LE((jaw - (strip.arms->a.arm == arm.id ? pose.a : pose.b).p).norm(), 1e-6) << part.name;
    }
  }
}

TEST_F(CellView, PlacesAreThoseOfTheParts) {
  const Strip& strip = program_.strips[0];
  const std::size_t pose = strip.poses.size() / 2;
  const std::vector<CellPart> parts = cell_parts(shown_, strip, pose);
  const auto places = cell_places(shown_, strip, pose);
  ASSERT_EQ(parts.size(), places.size());
  for (std::size_t i = 0; i < parts.size(); ++i)
    EXPECT_EQ((parts[i].place.matrix() - places[i].at.matrix()).norm(), 0) << parts[i].name;
  const auto has = [&](const std::string& name) {
    return std::any_of(parts.begin(), parts.end(), [&](const CellPart& part) { return part.name == name; });
  };
  for (const char* name : {"arm_R1_base_link", "arm_R1_link_6", "arm_R2_tool", "the table", "the plinth"})
    EXPECT_TRUE(has(name)) << name;
}

TEST_F(CellView, ColoursLinksByTheMarginsOfTheirJoints) {
  const Strip& strip = program_.strips[0];
  const std::size_t pose = 7;
  for (const CellPart& part : cell_parts(shown_, strip, pose)) EXPECT_FALSE(part.margin_rad) << part.name;
  shown_.by_margin = true;
  std::size_t links = 0;
  for (const CellPart& part : cell_parts(shown_, strip, pose)) {
    if (!part.margin_rad) continue;
    ++links;
    // "arm_R1_link_3" is moved by the third joint.
    const std::size_t joint = static_cast<std::size_t>(part.name.back() - '1');
    ASSERT_LT(joint, kArmJoints) << part.name;
    const std::string id = part.name.substr(4, 2);
    const ProgramArm& arm = program_.cell->arms[program_.cell->arms[0].id == id ? 0 : 1];
    const double q = (strip.arms->a.arm == id ? strip.joints[pose].a : strip.joints[pose].b)[joint];
    EXPECT_NEAR(*part.margin_rad, std::min(q - arm.joints[joint].min_rad, arm.joints[joint].max_rad - q),
                1e-12)
        << part.name;
  }
  EXPECT_EQ(links, 12u);
  const Rgb none = margin_color(0), beyond = margin_color(-1), good = margin_color(kGreenMargin_rad),
            better = margin_color(3);
  EXPECT_EQ(none, beyond);
  EXPECT_EQ(good, better);
  EXPECT_GT(none[0], none[1]);
  EXPECT_GT(good[1], good[0]);
  SceneOptions options;
  options.strip = "S001";
  options.at_s = strip.poses[pose].t;
  options.cell = &shown_;
  EXPECT_THAT(scene_of(program_, nullptr, options).caption.back(), HasSubstr("green 30 deg off"));
}

TEST_F(CellView, CardsSayHowTheArmsDo) {
  const ViewModel model = view_model(program_, nullptr, {});
  const auto lines = [&](const Selection& selection) {
    std::string all;
    for (const std::string& line : card_of(model, selection).lines) all += line + "\n";
    return all;
  };
  EXPECT_THAT(lines({Part::kStrip, 0, -1}), HasSubstr(" from its limit\nnearest "));
  EXPECT_THAT(lines({Part::kStrip, 0, -1}),
              ::testing::ContainsRegex("nearest (arm|tool) to [a-z]+ [0-9]+ mm"));
  EXPECT_THAT(lines({Part::kPose, 0, 5}), HasSubstr(" from its limit\n"));
}

TEST_F(CellView, StandsInScenesWithATimeUpAsInTheCell) {
  SceneOptions options;
  options.strip = "S001";
  options.at_s = program_.strips[0].poses[10].t;
  EXPECT_THAT(scene_of(program_, nullptr, options).cell, IsEmpty());
  options.cell = &shown_;
  const Scene scene = scene_of(program_, nullptr, options);
  EXPECT_THAT(scene.cell, Not(IsEmpty()));
  const Eigen::Vector3d up = program_.strips[0].design_to_cell.q * scene.view_axes.col(2);
  EXPECT_LE((up - Eigen::Vector3d::UnitZ()).norm(), 1e-12);
  EXPECT_THAT(scene.caption.back(), HasSubstr("from limits"));
  // A file has them where the picture has.
  Scene bare = scene;
  bare.cell.clear();
  const auto meshes = [](const std::string& gltf) {
    std::size_t count = 0;
    for (std::size_t at = gltf.find("\"mesh\""); at != std::string::npos; at = gltf.find("\"mesh\"", at + 1))
      ++count;
    return count;
  };
  EXPECT_EQ(meshes(gltf_of(scene)), meshes(gltf_of(bare)) + scene.cell.size());
  options.at_s.reset();
  EXPECT_THAT(view_model(program_, nullptr, options).scene.cell, Not(IsEmpty())) << "the window has a time";
}

}  // namespace
}  // namespace hotblade::pipeline::preview
