// The picture and the command that makes it. What is drawn is checked in numbers where it can be: size,
// colours, sides.
#include <gmock/gmock.h>
#include <sys/wait.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGReader.h>

#include <cstdlib>
#include <fstream>
#include <set>

#include "pipeline/cli/command.hpp"
#include "pipeline/preview/drawing/draw.hpp"
#include "pipeline/program/atomic_file.hpp"
#include "pipeline/settings/error.hpp"
#include "tests/paths.hpp"
#include "tests/pipeline/temporary_directory.hpp"
#include "tests/pipeline/vault_design.hpp"
#include "tests/pipeline/vault_program.hpp"

namespace hotblade::pipeline::preview {
namespace {

using pipeline::testing::read_bytes;
using pipeline::testing::TemporaryDirectory;
using pipeline::testing::vault_design;
using pipeline::testing::vault_program;
using ::testing::Each;

struct Picture {
  int width = 0, height = 0;
  std::set<std::array<int, 3>> colors;
};

Picture decoded(const std::string& png) {
  vtkNew<vtkPNGReader> reader;
  reader->SetMemoryBuffer(png.data());
  reader->SetMemoryBufferLength(static_cast<vtkIdType>(png.size()));
  reader->Update();
  vtkImageData* image = reader->GetOutput();
  Picture picture{image->GetDimensions()[0], image->GetDimensions()[1], {}};
  const auto* byte = static_cast<const unsigned char*>(image->GetScalarPointer());
  for (long i = 0; i < 3L * picture.width * picture.height; i += 3) {
    picture.colors.insert({byte[i], byte[i + 1], byte[i + 2]});
  }
  return picture;
}

// A picture too small to read, big enough to draw everything, and quick.
constexpr PictureSize kSmall{320, 180};

TEST(PngOf, HasTheSizeAskedForAndManyColours) {
  const auto design = vault_design(1);
  const auto picture = decoded(png_of(scene_of(vault_program({.bulge_mm = 1.4}), &design, {}), kSmall));
  EXPECT_EQ(picture.width, kSmall.width);
  EXPECT_EQ(picture.height, kSmall.height);
  EXPECT_GT(picture.colors.size(), 500u);
}

TEST(PngOf, NeedsNoDisplay) {
  ::unsetenv("DISPLAY");
  EXPECT_GT(decoded(png_of(scene_of(vault_program(), nullptr, {}), kSmall)).colors.size(), 100u);
}

// The share of a picture's middle row and middle column that is unlike what lies on both sides of it.
double seam_share(const std::string& png) {
  vtkNew<vtkPNGReader> reader;
  reader->SetMemoryBuffer(png.data());
  reader->SetMemoryBufferLength(static_cast<vtkIdType>(png.size()));
  reader->Update();
  vtkImageData& image = *reader->GetOutput();
  const int width = image.GetDimensions()[0], height = image.GetDimensions()[1];
  const auto unlike = [&](int x, int y, int dx, int dy) {
    const auto* is = static_cast<const unsigned char*>(image.GetScalarPointer(x, y, 0));
    const auto* before = static_cast<const unsigned char*>(image.GetScalarPointer(x - dx, y - dy, 0));
    const auto* behind = static_cast<const unsigned char*>(image.GetScalarPointer(x + dx, y + dy, 0));
    constexpr int kSeen = 12;
    return std::abs(is[1] - before[1]) > kSeen && std::abs(is[1] - behind[1]) > kSeen;
  };
  int count = 0;
  for (int x = 1; x + 1 < width; ++x) count += unlike(x, height / 2, 0, 1) ? 1 : 0;
  for (int y = 1; y + 1 < height; ++y) count += unlike(width / 2, y, 1, 0) ? 1 : 0;
  return static_cast<double>(count) / (width + height);
}

TEST(PngOf, ShowsNoSeamWhereItsTilesMeet) {
  const auto design = vault_design(1);
  const Scene scene = scene_of(vault_program({.bulge_mm = 1.4}), &design, {});
  for (const PictureSize size : {PictureSize{320, 180}, {321, 181}, {322, 183}})
    EXPECT_LT(seam_share(png_of(scene, size)), 0.2) << size.width;  // a tenth by the lines there are
}

TEST(PngOf, GivesTheSameBytesForTheSameScene) {
  const Scene scene = scene_of(vault_program(), nullptr, {});
  EXPECT_EQ(png_of(scene, kSmall), png_of(scene, kSmall));
}

TEST(PngsOf, NamesStripsWhereThereAreSeveralAndColoursByThemWhereAsked) {
  const auto design = vault_design(2);
  Scene two = scene_of(vault_program({.strips = 2}), &design, {});
  ASSERT_EQ(two.strip_ids.size(), 2u);
  EXPECT_EQ(two.strip_ids[1].words, "S002");
  // Above the middle of its strip's ribs.
  EXPECT_NEAR(two.strip_ids[1].at.x(), 0, 1);
  EXPECT_NEAR(two.strip_ids[1].at.y(), 1.5 * testing::kVaultStripWidth, 0.05 * testing::kVaultStripWidth);
  EXPECT_TRUE(scene_of(vault_program(), nullptr, {}).strip_ids.empty());
  constexpr PictureSize kNamed{960, 540};
  const auto pngs = pngs_of(two, kNamed, std::array{Shot{}, Shot{View::kBest, true, true}, Shot{}});
  EXPECT_NE(pngs[0], pngs[1]);
  EXPECT_EQ(pngs[0], pngs[2]) << "the colours of one shot are not the next one's";
  const std::string named = pngs[0], named_small = png_of(two, kSmall);
  two.strip_ids.clear();
  EXPECT_NE(png_of(two, kNamed), named);
  EXPECT_EQ(png_of(two, kSmall), named_small) << "names would be too small to be read";
}

// Share of the picture that is as blue as only foam cut too deep is.
double share_beyond(const Scene& scene) {
  vtkNew<vtkPNGReader> reader;
  const std::string png = png_of(scene, kSmall);
  reader->SetMemoryBuffer(png.data());
  reader->SetMemoryBufferLength(static_cast<vtkIdType>(png.size()));
  reader->Update();
  const auto* byte = static_cast<const unsigned char*>(reader->GetOutput()->GetScalarPointer());
  const long bytes = 3L * kSmall.width * kSmall.height;
  long count = 0;
  for (long i = 0; i < bytes; i += 3)
    count += byte[i + 2] > 50 && byte[i + 2] > 2 * byte[i] && byte[i + 2] > 2 * byte[i + 1];
  return 3.0 * static_cast<double>(count) / static_cast<double>(bytes);
}

TEST(PngOf, TurnsDarkWhereTheToleranceIsPassed) {
  const auto design = vault_design(1);
  const Program good = vault_program({.bulge_mm = 0.4});
  const Program bad = vault_program({.bulge_mm = 2});
  EXPECT_LT(share_beyond(scene_of(good, &design, {})), 0.01);  // the key's lower end alone
  EXPECT_GT(share_beyond(scene_of(bad, &design, {})), 0.03);   // the middle of the surface
}

TEST(SceneOf, ColoursByDeviationOnlyWithADesignAndSaysSo) {
  const auto design = vault_design(1);
  const Scene with = scene_of(vault_program(), &design, {});
  ASSERT_TRUE(with.scale);
  EXPECT_EQ(with.scale->title, "deviation, mm");
  EXPECT_EQ(with.scale->low, -with.scale->high);
  const Scene without = scene_of(vault_program(), nullptr, {});
  EXPECT_FALSE(without.scale);
  EXPECT_THAT(without.caption, ::testing::Contains(::testing::HasSubstr("no design at hand")));
}

TEST(SceneOf, MeasuresTheBulgeOfTheCut) {
  const auto design = vault_design(1);
  const Program program = vault_program({.poses = 201, .bulge_mm = 1.4});
  const Scene scene = scene_of(program, &design, {});
  const auto [low, high] = std::minmax_element(scene.cut.values.begin(), scene.cut.values.end());
  const double facets = 0.06;  // sagitta of the design's facets, R (1 - cos(half angle / 24))
  EXPECT_NEAR(*low, -1.4, facets);
  EXPECT_LT(*high, facets);
}

TEST(SceneOf, ShowsWhatIsCutUpToATime) {
  const Program program = vault_program({.strips = 2, .poses = 101});
  SceneOptions options;
  options.strip = "S002";
  options.at_s = program.strips[1].poses[50].t + 1e-3;
  const Scene scene = scene_of(program, nullptr, options);
  double furthest = 0;
  for (const auto& vertex : scene.cut.vertices) furthest = std::max(furthest, vertex.y());
  EXPECT_NEAR(furthest, program.strips[1].poses[50].frame.origin.y(), 1e-3);
  ASSERT_TRUE(scene.blade_now);
  EXPECT_LT((scene.blade_now->points.front() - program.strips[1].poses[50].a.p).norm(), 1e-6);
  EXPECT_LT((scene.blade_now->points.back() - program.strips[1].poses[50].b.p).norm(), 1e-6);
  EXPECT_EQ(scene.blocks.size(), 1u);
}

TEST(SceneOf, GhostsRunFromTheClampsToTheFoam) {
  const Program program = vault_program();
  const Scene scene = scene_of(program, nullptr, {});
  ASSERT_EQ(scene.blades.size(), 2 * scene.clamps_a.size());
  for (std::size_t i = 0; i < scene.clamps_a.size(); ++i) {
    EXPECT_LT((scene.blades[2 * i].points.front() - scene.clamps_a[i].p).norm(), 1e-6);
    EXPECT_LT((scene.blades[2 * i + 1].points.back() - scene.clamps_b[i].p).norm(), 1e-6);
  }
}

TEST(SceneOf, LeavesOutBladeEndsOverAnotherStrip) {
  Program program = vault_program();
  const Scene alone = scene_of(program, nullptr, {});
  // The same strip again, beside the first along the blade: clamps B of the first lie over the second.
  Strip beside = program.strips[0];
  beside.id = "S002";
  const Eigen::Vector3d step(312, 0, 0);  // as wide as the vault
  for (BladePose& pose : beside.poses) {
    for (Eigen::Vector3d* point : {&pose.frame.origin, &pose.a.p, &pose.b.p}) *point += step;
  }
  program.strips.push_back(beside);
  const Scene both = scene_of(program, nullptr, {});
  EXPECT_EQ(both.clamps_a.size(), alone.clamps_a.size());
  EXPECT_EQ(both.clamps_b.size(), alone.clamps_b.size());
  for (const Pose& clamp : both.clamps_a) EXPECT_LT(clamp.p.x(), 0);
  for (const Pose& clamp : both.clamps_b) EXPECT_GT(clamp.p.x(), step.x());
  EXPECT_THAT(both.caption, ::testing::Contains(::testing::HasSubstr("left out")));
}

TEST(SceneOf, MeasuresFeedAndCurvature) {
  const Program program = vault_program({.half_band_mm = 0});
  SceneOptions options;
  options.color = Color::kFeed;
  const double step_mm = (pipeline::testing::kVaultStripWidth + 60) / 39;  // 40 poses, 0.05 s apart
  EXPECT_THAT(scene_of(program, nullptr, options).cut.values,
              Each(::testing::DoubleNear(step_mm / 0.05, 1e-6)));
  // The foam's ends run along the blade, towards A and back: its points go no faster for it.
  Program other = program;
  double sign = 1;
  for (BladePose& pose : other.strips[0].poses) {
    if (!pose.foam) continue;
    (*pose.foam)[0] += 4 * sign;
    (*pose.foam)[1] -= 15 * (1 + sign);
    sign = -sign;
  }
  EXPECT_THAT(scene_of(other, nullptr, options).cut.values,
              Each(::testing::DoubleNear(step_mm / 0.05, 1e-6)));
  options.color = Color::kCurvature;
  constexpr double kYieldsAt_per_mm = 2 * 1010 / (190000 * 0.5);  // of the fixture's spring steel
  EXPECT_THAT(scene_of(program, nullptr, options).cut.values,
              Each(::testing::DoubleNear(100 / pipeline::testing::kVaultRadius / kYieldsAt_per_mm, 1e-6)));
}

// Of points of the first strip of a program, of which so much is kept.
std::vector<double> deviations_mm(const surface::TriangleMesh& design, Keep keep,
                                  const std::vector<Eigen::Vector3d>& points) {
  Program program = vault_program();
  program.design.keep = keep;
  return signed_deviation_mm(design, program, points, std::vector<int>(points.size(), 0), 3);
}

TEST(SignedDeviation, IsPositiveOnTheWasteSide) {
  const auto design = vault_design(1);
  surface::TriangleSoup soup = design.mesh.soup();
  for (auto& triangle : soup.triangles) std::swap(triangle[1], triangle[2]);
  const surface::TriangleMesh turned(std::move(soup));
  const double top = pipeline::testing::kVaultRadius * (1 - std::cos(pipeline::testing::kVaultHalfAngle));
  const std::vector<Eigen::Vector3d> above{{0, 100, top + 2}};
  EXPECT_NEAR(deviations_mm(design.mesh, Keep::kBelow, above)[0], 2, 1e-9);
  EXPECT_NEAR(deviations_mm(turned, Keep::kBelow, above)[0], 2, 1e-9);
  EXPECT_NEAR(deviations_mm(design.mesh, Keep::kAbove, above)[0], -2, 1e-9);
  EXPECT_NEAR(deviations_mm(design.mesh, Keep::kBack, above)[0], 2, 1e-9);
  EXPECT_NEAR(deviations_mm(turned, Keep::kBack, above)[0], -2, 1e-9);
  EXPECT_NEAR(deviations_mm(design.mesh, Keep::kFront, above)[0], -2, 1e-9);
}

TEST(SignedDeviation, PastTheBorderIsAcrossTheDesignsPlaneAndThenNothing) {
  const surface::TriangleMesh square(
      {{{0, 0, 0}, {100, 0, 0}, {100, 100, 0}, {0, 100, 0}}, {{0, 1, 2}, {0, 2, 3}}});
  const std::vector<Eigen::Vector3d> points{
      {50, 40, 0.5}, {102, 40, 0.5}, {103.5, 40, 0.5}, {102, 101, -0.25}};
  const std::vector<double> mm = deviations_mm(square, Keep::kBelow, points);
  EXPECT_NEAR(mm[0], 0.5, 1e-12);
  EXPECT_NEAR(mm[1], 0.5, 1e-12);
  EXPECT_TRUE(std::isnan(mm[2]));
  EXPECT_NEAR(mm[3], -0.25, 1e-12);
}

// Two plates that fall to both sides of a ridge at x = 0, in cells of 10 mm.
surface::TriangleMesh ridge(double slope) {
  surface::TriangleSoup soup;
  constexpr int kAcross = 40, kAlong = 10;
  for (int j = 0; j <= kAlong; ++j) {
    for (int i = 0; i <= kAcross; ++i) {
      const double x = 10.0 * (i - kAcross / 2);
      soup.vertices.emplace_back(x, 10.0 * j, -slope * std::abs(x));
    }
  }
  for (int j = 0; j < kAlong; ++j) {
    for (int i = 0; i < kAcross; ++i) {
      const int a = j * (kAcross + 1) + i, b = a + kAcross + 1;
      soup.triangles.push_back({a, a + 1, b + 1});
      soup.triangles.push_back({a, b + 1, b});
    }
  }
  return surface::TriangleMesh(std::move(soup));
}

// A straight rib across the plate on this side of the ridge.
Rib plate_rib(double slope, double side) {
  Rib rib;
  rib.frame.origin = {side * 10, 50, -slope * 10};
  rib.frame.x = Eigen::Vector3d(side, 0, -slope).normalized();
  rib.frame.y = Eigen::Vector3d(side * slope, 0, 1).normalized();
  rib.elastica.length = 180;
  return rib;
}

TEST(SignedDeviation, PastACreaseIsAcrossTheFaceThatTheStripForms) {
  constexpr double kSlope = 0.5;
  const double slant = std::sqrt(1 + kSlope * kSlope);
  Program program = vault_program({.strips = 2});
  program.design.keep = Keep::kBelow;
  program.strips[0].ribs = {plate_rib(kSlope, -1)};
  program.strips[1].ribs = {plate_rib(kSlope, 1)};
  // Both on the first plate's plane, 2 mm and 10 mm beyond the ridge, above the second plate.
  const std::vector<Eigen::Vector3d> points{{2 / slant, 50, kSlope * 2 / slant},
                                            {10 / slant, 50, kSlope * 10 / slant}};
  const auto of_strip = [&](int strip) {
    return signed_deviation_mm(ridge(kSlope), program, points, {strip, strip}, 3);
  };
  EXPECT_NEAR(of_strip(0)[0], 0, 1e-9);
  EXPECT_TRUE(std::isnan(of_strip(0)[1])) << "there the blade is in foam of its own block";
  // The angle between the plates' planes has the sine of twice the slope's.
  const double sine = 2 * kSlope / (slant * slant);
  EXPECT_NEAR(of_strip(1)[0], 2 * sine, 1e-9);
  EXPECT_NEAR(of_strip(1)[1], 10 * sine, 1e-9);
}

// The command, run in a directory with a program and the design it was made from.
class PreviewCommand : public ::testing::Test {
 protected:
  PreviewCommand() {
    const auto design = vault_design(1);
    std::string obj;
    for (const auto& v : design.mesh.vertices())
      obj += "v " + std::to_string(v.x()) + " " + std::to_string(v.y()) + " " + std::to_string(v.z()) + "\n";
    for (const auto& [a, b, c] : design.mesh.triangles())
      obj += "f " + std::to_string(a + 1) + " " + std::to_string(b + 1) + " " + std::to_string(c + 1) + "\n";
    write_file_atomically(file("vault.obj"), obj, false);
    write_file_atomically(file("other.obj"), obj + "# edited\n", false);
    Program program = vault_program();
    program.design.sha256 = surface::read_obj(file("vault.obj"), {"mm", 'z'}).sha256;
    ensure_directory(directory_ / "job");
    write_file_atomically(file("job/program.json"), to_json(program), false);
    ::unsetenv("DISPLAY");
  }

  [[nodiscard]] std::string file(const std::string& name) const { return (directory_ / name).string(); }

  // Runs `hotblade preview FILE arguments... --size 320x180`, gives the exit code.
  int preview(const std::string& input, std::vector<std::string> arguments) {
    std::vector<std::string> words{"hotblade", "preview", file(input)};
    words.insert(words.end(), arguments.begin(), arguments.end());
    if (std::find(words.begin(), words.end(), "--size") == words.end())
      words.insert(words.end(), {"--size", "320x180"});
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    ::testing::internal::CaptureStdout();
    ::testing::internal::CaptureStderr();
    const int code = run_command_line(static_cast<int>(argv.size()), argv.data());
    ::testing::internal::GetCapturedStdout();
    message_ = ::testing::internal::GetCapturedStderr();
    return code;
  }

  TemporaryDirectory directory_;
  std::string message_;
};

TEST_F(PreviewCommand, WritesAPictureOfAProgram) {
  EXPECT_EQ(preview("job/program.json", {"--shot", file("a.png"), "--size", "400x300"}), 0) << message_;
  const Picture picture = decoded(read_bytes(file("a.png")));
  EXPECT_EQ(picture.width, 400);
  EXPECT_EQ(picture.height, 300);
  EXPECT_EQ(message_, "");
}

TEST_F(PreviewCommand, WritesAPictureOfADesign) {
  EXPECT_EQ(preview("vault.obj", {"--units", "mm", "--shot", file("a.png")}), 0) << message_;
  EXPECT_GT(decoded(read_bytes(file("a.png"))).colors.size(), 100u);
  EXPECT_EQ(preview("vault.obj", {"--shot", file("b.png")}), 2);
}

TEST_F(PreviewCommand, KeepsAnExistingPictureWithoutForce) {
  write_file_atomically(file("a.png"), "mine", false);
  EXPECT_EQ(preview("job/program.json", {"--shot", file("a.png")}), 7);
  EXPECT_EQ(read_bytes(file("a.png")), "mine");
  EXPECT_EQ(preview("job/program.json", {"--shot", file("a.png"), "--force"}), 0) << message_;
  EXPECT_NE(read_bytes(file("a.png")), "mine");
}

TEST_F(PreviewCommand, RefusesAnotherDesign) {
  EXPECT_EQ(preview("job/program.json", {"--design", file("other.obj"), "--shot", file("a.png")}), 3);
  EXPECT_THAT(message_, ::testing::HasSubstr("other.obj: not the design of this program"));
  EXPECT_FALSE(std::filesystem::exists(file("a.png")));
}

TEST_F(PreviewCommand, RefusesAnotherDesignThatLiesBeside) {
  std::filesystem::copy_file(file("other.obj"), file("job/vault.obj"));
  EXPECT_EQ(preview("job/program.json", {"--shot", file("a.png")}), 3);
}

TEST_F(PreviewCommand, FindsTheDesignBesideTheProgram) {
  EXPECT_EQ(preview("job/program.json", {"--shot", file("strip.png")}), 0) << message_;
  std::filesystem::copy_file(file("vault.obj"), file("job/vault.obj"));
  EXPECT_EQ(preview("job/program.json", {"--shot", file("beside.png")}), 0) << message_;
  EXPECT_EQ(preview("job/program.json", {"--design", file("vault.obj"), "--shot", file("given.png")}), 0)
      << message_;
  EXPECT_EQ(read_bytes(file("beside.png")), read_bytes(file("given.png")));
  EXPECT_NE(read_bytes(file("beside.png")), read_bytes(file("strip.png")));
}

TEST_F(PreviewCommand, RefusesWhatItCannotShow) {
  const std::vector<std::vector<std::string>> usages{
      {"--color", "deviation"}, {"--color", "plaid"},  {"--strip", "S009"},    {"--at", "1000"},
      {"--size", "12"},         {"--size", "1x1"},     {"--size", "640x480x"}, {"--size", "99999x99999"},
      {"--movie", "a.avi"},     {"--export", "a.stl"}, {"--frames", "0"},      {"--view", "askew"},
      {"--ghosts", "0"}};
  for (const auto& usage : usages) {
    std::vector<std::string> arguments = usage;
    arguments.insert(arguments.end(), {"--shot", file("a.png")});
    EXPECT_EQ(preview("job/program.json", arguments), 2) << usage[0] << " " << usage[1];
  }
  EXPECT_EQ(preview("missing.json", {"--shot", file("a.png")}), 7);
  EXPECT_EQ(preview("job/program.json", {"--shot", file("no/a.png")}), 7);
}

TEST_F(PreviewCommand, AsksForAShotWithoutADisplay) {
  EXPECT_EQ(preview("job/program.json", {}), 2);
  EXPECT_THAT(message_, ::testing::HasSubstr("no display: use --shot FILE.png"));
}

TEST_F(PreviewCommand, AsksForAShotWhenTheDisplayCannotBeReached) {
  ::setenv("DISPLAY", ":987", 1);
  EXPECT_EQ(preview("job/program.json", {}), 2);
  ::unsetenv("DISPLAY");
  EXPECT_THAT(message_, ::testing::HasSubstr("use --shot FILE.png"));
}

TEST_F(PreviewCommand, EndsWithAMessageWithoutEgl) {
  // A process of its own: EGL's dispatcher reads where drivers are once. An empty directory has none.
  const std::string command = "__EGL_VENDOR_LIBRARY_DIRS=" + file("job") + " " +
                              hotblade::testing::binary_dir() + "/hotblade preview " +
                              file("job/program.json") + " --shot " + file("a.png") + " 2> " + file("stderr");
  const int status = std::system(command.c_str());
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 1);
  EXPECT_THAT(read_bytes(file("stderr")), ::testing::HasSubstr("EGL"));
  EXPECT_FALSE(std::filesystem::exists(file("a.png")));
}

}  // namespace
}  // namespace hotblade::pipeline::preview
