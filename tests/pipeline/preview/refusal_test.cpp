// What a picture of a refused job says and marks.
#include <gmock/gmock.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGReader.h>

#include <array>
#include <cmath>

#include "pipeline/preview/drawing/draw.hpp"
#include "pipeline/preview/drawing/draw_parts.hpp"
#include "pipeline/preview/drawing/stage.hpp"
#include "pipeline/preview/view_model.hpp"
#include "tests/pipeline/vault_design.hpp"
#include "tests/pipeline/vault_program.hpp"

namespace hotblade::pipeline::preview {
namespace {

using pipeline::testing::vault_design;
using pipeline::testing::vault_program;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr PictureSize kSize{640, 360};

// Pixels of the geometry's part of a picture that are nearly of the mark's colour.
long marked_pixels(const std::string& png) {
  vtkNew<vtkPNGReader> reader;
  reader->SetMemoryBuffer(png.data());
  reader->SetMemoryBufferLength(static_cast<vtkIdType>(png.size()));
  reader->Update();
  const auto* byte = static_cast<const unsigned char*>(reader->GetOutput()->GetScalarPointer());
  long count = 0;
  for (long i = 0; i < long{kSize.width} * kSize.height; ++i) {
    const bool key = i % kSize.width < kSize.width / 4;
    double off = 0;
    for (std::size_t c = 0; c < 3; ++c)
      off = std::max(off, std::abs(byte[3 * i + static_cast<long>(c)] - 255 * kWorstColor[c]));
    count += !key && off < 40 ? 1 : 0;
  }
  return count;
}

Program refused_program(double bulge_mm) {
  Program program = vault_program({.bulge_mm = bulge_mm});
  program.verification.status = VerificationStatus::kRefused;
  program.verification.deviation_mm.max = bulge_mm;
  program.verification.deviation_mm.at = {0, 60, 20};
  return program;
}

TEST(Refusal, MarksTheWorstPlaceInEveryPicture) {
  const auto design = vault_design(1);
  const Scene passed = scene_of(vault_program(), &design, {});
  EXPECT_FALSE(passed.worst);
  Scene refused = scene_of(refused_program(9), &design, {});
  ASSERT_TRUE(refused.worst);
  EXPECT_EQ(refused.worst->at, Eigen::Vector3d(0, 60, 20));
  for (const View view : {View::kBest, View::kTop, View::kFront, View::kRight}) {
    EXPECT_GT(marked_pixels(png_of(refused, kSize, view)), 40) << static_cast<int>(view);
    EXPECT_LT(marked_pixels(png_of(passed, kSize, view)), 10) << static_cast<int>(view);
  }
  // Behind all there is, it is still seen.
  refused.worst->at.z() = -100;
  EXPECT_GT(marked_pixels(png_of(refused, kSize, View::kTop)), 40);
  mark_refusal(refused, {{"S001: clearance", std::nullopt}, {"S001: radius", Eigen::Vector3d(1, 2, 3)}});
  EXPECT_EQ(refused.worst->at, Eigen::Vector3d(1, 2, 3)) << "of the first reason that has a place";
  EXPECT_THAT(refused.caption, Contains(HasSubstr("refused: S001: clearance (and 1 more)")));
  EXPECT_THAT(refused.caption, Contains("ringed: S001: radius"));
}

TEST(Refusal, TheScaleHoldsTheWorstPlace) {
  const auto design = vault_design(1);
  for (const double bulge_mm : {0.3, 4.0, 9.0, 30.0}) {
    const Scene scene = scene_of(refused_program(bulge_mm), &design, {});
    double most = 0;
    for (const double value : scene.cut.values) most = std::max(most, std::abs(value));
    EXPECT_GE(scene.scale->high, most);
    EXPECT_LE(scene.scale->high, std::max(1.67 * most, 1.5 * scene.scale->tolerance.value())) << "no wider";
    EXPECT_EQ(scene.scale->low, -scene.scale->high);
  }
}

TEST(Refusal, OfADesignThatIsNotCutNothingElseIsSaid) {
  Scene scene = scene_of(vault_design(1));
  EXPECT_THAT(scene.caption, Contains("can be sliced"));
  mark_refusal(scene, {{"chain at (1.0, 2.0, 3.0): lean", Eigen::Vector3d(0, 50, 10)}});
  EXPECT_THAT(scene.caption, Not(Contains("can be sliced")));
  EXPECT_EQ(scene.verdict, "nothing is cut");
  EXPECT_THAT(scene.caption, Contains(HasSubstr("refused: chain at")));
  EXPECT_GT(marked_pixels(png_of(scene, kSize, View::kTop)), 40);
}

TEST(Refusal, IsMarkedInTheWindowToo) {
  const auto design = vault_design(1);
  const SceneOptions options;
  ViewModel model = view_model(refused_program(9), &design, options);
  const ViewState state = first_state(model, options, View::kBest);
  EXPECT_GT(marked_pixels(png_of(model, state, kSize)), 40);
  model.scene.worst.reset();
  EXPECT_LT(marked_pixels(png_of(model, state, kSize)), 10);
}

}  // namespace
}  // namespace hotblade::pipeline::preview
