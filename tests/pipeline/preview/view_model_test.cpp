// What the window knows of a program: moments, cards, picking, and the pictures of a state.
#include "pipeline/preview/view_model.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <vtkImageData.h>
#include <vtkNew.h>

#include <Eigen/Geometry>

#include "pipeline/plan/plan.hpp"
#include "pipeline/preview/drawing/picking.hpp"
#include "pipeline/preview/drawing/stage.hpp"
#include "tests/pipeline/plan_design.hpp"
#include "tests/pipeline/vault_design.hpp"

namespace hotblade::pipeline::preview {
namespace {

using namespace pipeline::testing;
using ::testing::Contains;
using ::testing::HasSubstr;

constexpr PictureSize kLittle{320, 180};

TEST(MomentAt, IsTheLastPoseAtOrBeforeATime) {
  const ViewModel model = view_model(vault_program({.strips = 2, .poses = 40}), nullptr, {});
  for (int strip = 0; strip < 2; ++strip) {
    for (int pose = 0; pose < 39; ++pose) {
      const double t = time_of(model, {strip, pose});
      for (const double later : {0.0, 0.02}) {
        const Moment found = moment_at(model.facts, t + later);
        EXPECT_EQ(found.strip, strip);
        EXPECT_EQ(found.pose, pose) << t << " + " << later;
      }
    }
  }
  EXPECT_EQ(moment_at(model.facts, 0).pose, 0);
  EXPECT_EQ(moment_at(model.facts, model.facts.end_s()).pose, 39);
}

TEST(ViewModel, TheCutGrowsRowByRow) {
  const ViewModel model = view_model(vault_program({.strips = 2}), nullptr, {});
  EXPECT_TRUE(std::is_sorted(model.triangle_s.begin(), model.triangle_s.end()));
  ViewState state;
  EXPECT_EQ(shown_triangles(model, state), model.scene.cut.triangles.size());
  state.cut_so_far = true;
  EXPECT_EQ(shown_triangles(model, state), 0u);
  state.time_s = model.facts.strip_start_s[1];
  EXPECT_EQ(shown_triangles(model, state), model.scene.cut.triangles.size() / 2);
}

TEST(ViewModel, HasDeviationOnlyWithADesign) {
  const auto design = vault_design(1);
  EXPECT_TRUE(view_model(vault_program(), &design, {}).colorings.contains(Color::kDeviation));
  EXPECT_FALSE(view_model(vault_program(), nullptr, {}).colorings.contains(Color::kDeviation));
}

TEST(FirstState, OpensAtTheTimeAsked) {
  SceneOptions options;
  options.strip = "S002";
  options.at_s = 0.5;
  const ViewModel model = view_model(vault_program({.strips = 2}), nullptr, options);
  ASSERT_EQ(model.program.strips.size(), 1u);
  const ViewState state = first_state(model, options, View::kBest);
  EXPECT_DOUBLE_EQ(state.time_s, 0.5);
  EXPECT_TRUE(state.cut_so_far);
}

TEST(CardOf, SaysWhatTheVaultIs) {
  const auto design = vault_design(1);
  const ViewModel model = view_model(vault_program({.poses = 201, .bulge_mm = 1.4}), &design, {});
  const Card strip = card_of(model, {Part::kStrip, 0, -1});
  EXPECT_EQ(strip.title, "strip S001");
  EXPECT_THAT(strip.lines, Contains(HasSubstr("deviation -1.4")));
  EXPECT_THAT(strip.lines, Contains(HasSubstr("smallest radius 399 mm")));  // 400.5 less the bulge
  EXPECT_THAT(strip.lines, Contains(HasSubstr("margin 39.5, 12.50 mm")));
  EXPECT_THAT(strip.lines, Contains("10.0 s, 201 poses"));
  EXPECT_THAT(strip.lines, Contains("load not computed"));
  const Card rib = card_of(model, {Part::kRib, 0, 1});
  EXPECT_EQ(rib.title, "rib S001R002");
  EXPECT_THAT(rib.lines, Contains(HasSubstr("deviation 0.30 mm")));
  EXPECT_THAT(rib.lines, Contains("at 5.00 s"));
  const Card pose = card_of(model, {Part::kPose, 0, 100});
  EXPECT_EQ(pose.title, "S001 pose 101 of 201");
  EXPECT_THAT(pose.lines, Contains("at 5.00 s, cut"));
  EXPECT_THAT(pose.lines, Contains(HasSubstr("deviation -1.4")));
  EXPECT_EQ(card_of(model, {}).title, "");
}

TEST(CardOf, SaysOfAStripWhatItsPlanMeasured) {
  Settings settings = along_x();
  settings.motion.waypoint_s = 0.05;  // many poses, of which each counts
  const PlanResult planned = plan(cylinder_design(), settings, {});
  ASSERT_EQ(planned.program.strips.size(), 1u);
  ASSERT_GT(planned.program.strips[0].poses.size(), 1000u);
  const MotionFacts& facts = planned.strips[0].motion;
  const auto expect_as_planned = [&](const Program& program, double margin_mm) {
    const Card card = card_of(view_model(program, nullptr, {}), {Part::kStrip, 0, -1});
    EXPECT_THAT(
        card.lines,
        Contains(HasSubstr(fmt::format("margin {:.1f}, {:.2f} mm", facts.smallest_margin, margin_mm))));
    EXPECT_THAT(card.lines,
                Contains(HasSubstr(fmt::format("radius {:.0f} mm", 1 / facts.largest_curvature_per_mm))));
    EXPECT_THAT(card.lines, Contains(fmt::format("force {:.2f} N, stress {:.0f} MPa", facts.largest_force_n,
                                                 facts.largest_stress_mpa)));
  };
  expect_as_planned(planned.program, facts.smallest_margin_mm());
  for (std::size_t pose = 500; pose < 516; ++pose) {
    Program program = planned.program;
    program.strips[0].poses[pose].margin_mm = 0.25;
    expect_as_planned(program, 0.25);
  }
}

TEST(CardOf, GivesTheLoadsOfAPose) {
  Program program = vault_program();
  program.strips[0].poses[20].loads = PoseLoads{1.25, 30, -40, 99, 0.15F, 0};
  const ViewModel model = view_model(program, nullptr, {});
  const Card pose = card_of(model, {Part::kPose, 0, 20});
  EXPECT_THAT(pose.lines, Contains("force 1.25 N, stress 99 MPa"));
  EXPECT_THAT(pose.lines, Contains("moments 30, -40 N mm"));
  EXPECT_THAT(pose.lines, Contains("deviation not measured: no design"));
}

// Seen from above: x to the right, y up, 1 mm a pixel, (0, 125) in the middle.
Sight from_above() {
  Sight sight;
  sight.size = {1000, 1000};
  sight.to_view = Eigen::Matrix4d::Zero();
  sight.to_view(0, 0) = sight.to_view(1, 1) = 1 / 500.0;
  sight.to_view(1, 3) = -125 / 500.0;
  sight.to_view(2, 2) = -1 / 500.0;  // depth grows downwards
  sight.to_view(3, 3) = 1;
  return sight;
}

Eigen::Vector2d above(double x, double y) {
  return {x + 500, y - 125 + 500};
}

class Picking : public ::testing::Test {
 protected:
  Picked at(double x, double y) const { return pick(model_, state_, {}, {}, from_above(), above(x, y)); }

  // The blade waits before the block, at y = -30.
  ViewModel model_ = view_model(vault_program(), nullptr, {});
  ViewState state_;
};

TEST_F(Picking, FindsTheStripAndThePoseThatCutThere) {
  const Picked picked = at(30, 120);
  EXPECT_EQ(picked.selection, (Selection{Part::kStrip, 0, -1}));
  const auto& pose = pose_at(model_, {0, picked.pose});
  EXPECT_NEAR(pose.frame.origin.y(), 120, 10);  // the poses lie 8 mm apart
}

TEST_F(Picking, FindsRibsAndTheBladeOverTheStrip) {
  EXPECT_EQ(at(30, 101).selection, (Selection{Part::kRib, 0, 2}));  // ribs lie 50 mm apart
  EXPECT_EQ(at(30, -28).selection, (Selection{Part::kPose, 0, 0}));
  state_.hidden.set(static_cast<std::size_t>(Layer::kRibs));
  EXPECT_EQ(at(30, 101).selection.part, Part::kStrip);
}

TEST_F(Picking, FindsNothingBesideOrWhereTheCutIsHidden) {
  EXPECT_EQ(at(400, 120).selection, Selection{});
  state_.hidden.set(static_cast<std::size_t>(Layer::kCut));
  EXPECT_EQ(at(30, 120).selection, Selection{});
}

TEST_F(Picking, GoesThroughWhatTheClipPlaneHides) {
  state_.clip = {1, 0.25, true};  // y up to 62.5 is kept
  EXPECT_EQ(at(30, 120).selection, Selection{});
  EXPECT_EQ(at(30, 40).selection.part, Part::kStrip);
  state_.clip.keeps_low = false;
  EXPECT_EQ(at(30, 120).selection.part, Part::kStrip);
}

TEST_F(Picking, FindsOnlyWhatIsCutSoFar) {
  state_.cut_so_far = true;
  EXPECT_EQ(at(30, 120).selection, Selection{});
  state_.time_s = model_.facts.end_s();
  EXPECT_EQ(at(30, 120).selection.part, Part::kStrip);
}

std::vector<unsigned char> painted(Painter& painter) {
  vtkNew<vtkImageData> image;
  painter.paint(*image);
  const auto* bytes = static_cast<const unsigned char*>(image->GetScalarPointer());
  return {bytes, bytes + 3L * kLittle.width * kLittle.height};
}

TEST(Stage, EveryKeyThatChangesTheViewChangesThePictureAndGoingBackRestoresIt) {
  const auto design = vault_design(1);
  const ViewModel model = view_model(vault_program({.bulge_mm = 1.4}), &design, {});
  const ViewState first = first_state(model, {}, View::kBest);
  Painter painter(kLittle);
  Stage stage(model, painter.renderer(), kLittle, Painter::kZoom);
  stage.show(first);
  const auto before = painted(painter);
  for (const char* key : {"c", "r", "b", "k", "g", "p", "l", "2", "3", "x", "u", "Tab", "h", "Next"}) {
    stage.show(after_key(first, model.facts, key));
    EXPECT_TRUE(painted(painter) != before) << key;
    stage.show(first);
    const auto again = painted(painter);
    long apart = 0;
    for (std::size_t i = 0; i < again.size(); ++i) apart += again[i] != before[i];
    EXPECT_EQ(apart, 0) << key << " and back";
  }
}

TEST(StagePng, ShowsADesignAlone) {
  const ViewModel model = view_model(vault_design(1));
  const ViewState first = first_state(model, {}, View::kBest);
  EXPECT_NE(png_of(model, after_key(first, model.facts, "t"), kLittle), png_of(model, first, kLittle));
}

}  // namespace
}  // namespace hotblade::pipeline::preview
