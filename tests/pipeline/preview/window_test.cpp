// The program's window on an X server of the test's own, driven by keys and clicks, and looked at. What is
// compared is where colours are, with room for edges that other rasterisers draw otherwise.
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGReader.h>

#include <set>

#include "pipeline/program/atomic_file.hpp"
#include "tests/paths.hpp"
#include "tests/pipeline/preview/x_server.hpp"
#include "tests/pipeline/temporary_directory.hpp"
#include "tests/pipeline/vault_design.hpp"

namespace hotblade::pipeline::testing {
namespace {

constexpr int kWidth = 640, kHeight = 360;
// Left of it are caption, key and card, below it is the time bar; as overlay_margins() for this size.
constexpr int kGeometryLeft = 145, kGeometryRight = 540, kGeometryBottom = 320;

using Rgb = std::array<int, 3>;
constexpr Rgb kBladeRed{217, 26, 26}, kSelectedPink{242, 26, 140};

struct Count {
  int pixels = 0;
  double x = 0, y = 0;  // their middle
};

Count count(const Screenshot& shot, const Rgb& color, int x0, int x1, int y1) {
  constexpr int kNear = 30;  // of 255 a channel
  Count found;
  for (int y = 0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) {
      const Rgb here = shot.at(x, y);
      bool near = true;
      for (std::size_t c = 0; c < 3; ++c) near = near && std::abs(here[c] - color[c]) <= kNear;
      if (!near) continue;
      ++found.pixels;
      found.x += x;
      found.y += y;
    }
  }
  found.x /= std::max(1, found.pixels);
  found.y /= std::max(1, found.pixels);
  return found;
}

Count blade(const Screenshot& shot) {
  return count(shot, kBladeRed, kGeometryLeft, kGeometryRight, kGeometryBottom);
}

bool has_card(const Screenshot& shot) {
  return count(shot, kSelectedPink, 0, 14, kHeight).pixels > 20;
}

Screenshot picture_in(const std::string& file) {
  vtkNew<vtkPNGReader> reader;
  reader->SetFileName(file.c_str());
  reader->Update();
  vtkImageData* image = reader->GetOutput();
  Screenshot shot{image->GetDimensions()[0], image->GetDimensions()[1], {}};
  const auto* bytes = static_cast<const unsigned char*>(image->GetScalarPointer());
  for (int y = shot.height - 1; y >= 0; --y)
    shot.rgb.insert(shot.rgb.end(), bytes + 3L * y * shot.width, bytes + 3L * (y + 1) * shot.width);
  return shot;
}

// Mean over blocks of 8 x 8 pixels of the channels' largest difference, and the share of blocks that differ
// by much: thin lines are smoothed in one picture and stepped in the other, so single pixels say little.
struct Difference {
  double mean = 0, blocks_far = 0;
};

Difference difference(const Screenshot& a, const Screenshot& b) {
  constexpr int kBlock = 8, kFar = 40;
  Difference out;
  int blocks = 0;
  for (int y = 0; y + kBlock <= a.height; y += kBlock) {
    for (int x = 0; x + kBlock <= a.width; x += kBlock) {
      double most = 0;
      for (std::size_t c = 0; c < 3; ++c) {
        double sum = 0;
        for (int i = 0; i < kBlock * kBlock; ++i)
          sum += a.at(x + i % kBlock, y + i / kBlock)[c] - b.at(x + i % kBlock, y + i / kBlock)[c];
        most = std::max(most, std::abs(sum) / (kBlock * kBlock));
      }
      out.mean += most;
      out.blocks_far += most > kFar;
      ++blocks;
    }
  }
  out.mean /= blocks;
  out.blocks_far /= blocks;
  return out;
}

class PreviewWindow : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!server_.started()) GTEST_SKIP() << "no Xvfb (Debian package xvfb)";
    const auto design = vault_design(2);
    std::string obj;
    for (const auto& v : design.mesh.vertices())
      obj += "v " + std::to_string(v.x()) + " " + std::to_string(v.y()) + " " + std::to_string(v.z()) + "\n";
    for (const auto& [a, b, c] : design.mesh.triangles())
      obj += "f " + std::to_string(a + 1) + " " + std::to_string(b + 1) + " " + std::to_string(c + 1) + "\n";
    write_file_atomically(directory_ / "vault.obj", obj, false);
    Program program = vault_program({.strips = 2, .bulge_mm = 0.7});
    program.design.sha256 = surface::read_obj(directory_ / "vault.obj", {"mm", 'z'}).sha256;
    write_file_atomically(directory_ / "program.json", to_json(program), false);
  }

  void TearDown() override {
    if (process_ <= 0) return;
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
  }

  // Starts `hotblade preview FILE arguments...` on the test's display.
  void start(const std::string& file, const std::vector<std::string>& arguments = {}) {
    start_on(server_, file, arguments);
  }

  void start_on(const XServer& server, const std::string& file, const std::vector<std::string>& arguments) {
    std::vector<std::string> words{hotblade::testing::binary_dir() + "/hotblade", "preview",
                                   (directory_ / file).string(), "--size",
                                   std::to_string(kWidth) + "x" + std::to_string(kHeight)};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    process_ = ::fork();
    if (process_ != 0) return;
    ::setenv("DISPLAY", server.display().c_str(), 1);
    ::execv(argv[0], argv.data());
    ::_exit(127);
  }

  int exit_code() {
    int status = 0;
    ::waitpid(process_, &status, 0);
    process_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  TemporaryDirectory directory_;
  XServer server_;
  pid_t process_ = -1;
};

bool is_drawn(const Screenshot& shot) {
  std::set<Rgb> colors;
  for (int y = 0; y < shot.height; y += 2) {
    for (int x = 0; x < shot.width; x += 2) colors.insert(shot.at(x, y));
  }
  return colors.size() > 100;
}

TEST_F(PreviewWindow, PlaysHidesLayersPicksSeeksAndCloses) {
  start("program.json", {"--color", "strip"});
  const XWindow window(server_.display());
  Screenshot before, now;
  ASSERT_TRUE(window.wait([](const auto& s) { return is_drawn(s) && blade(s).pixels > 100; }, before));

  window.press("space");
  const auto moved = [&](const Screenshot& s) {
    const Count here = blade(s), there = blade(before);
    return std::hypot(here.x - there.x, here.y - there.y) > 15;
  };
  EXPECT_TRUE(window.wait(moved, now)) << "play moves the blade";

  window.press("Home");
  window.press("k");
  EXPECT_TRUE(window.wait([](const auto& s) { return blade(s).pixels == 0; }, now)) << "k hides the blade";
  window.press("k");
  EXPECT_TRUE(window.wait([](const auto& s) { return blade(s).pixels > 100; }, now)) << "and shows it";

  EXPECT_FALSE(has_card(now));
  window.click((kGeometryLeft + kGeometryRight) / 2, kGeometryBottom / 2 + 10);
  EXPECT_TRUE(window.wait(has_card, now)) << "a click on the cut shows a card";
  window.press("Escape");
  EXPECT_TRUE(window.wait([](const auto& s) { return !has_card(s); }, now)) << "escape takes it away";

  window.drag(kWidth / 4, kHeight - 12, kWidth - 20, kHeight - 40);
  EXPECT_TRUE(window.wait(moved, now)) << "the time bar moves the blade, and the picture stays";

  window.press("q");
  EXPECT_EQ(exit_code(), 0);
}

TEST_F(PreviewWindow, ShowsWhatAShotOfTheSameKeysShows) {
  for (const std::string keys : {"i", "3,t,g,Tab"}) {
    start("program.json", {"--keys", keys});
    Screenshot drawn;
    {
      const XWindow window(server_.display());
      ASSERT_TRUE(window.wait(is_drawn, drawn)) << keys;
      // Settled: the same twice.
      Screenshot last;
      ASSERT_TRUE(window.wait(
          [&](const Screenshot& s) {
            const bool same = s.rgb == last.rgb;
            last = s;
            return same;
          },
          drawn));
      window.press("q");
      EXPECT_EQ(exit_code(), 0);
    }
    const std::string shot = (directory_ / "shot.png").string();
    start("program.json", {"--keys", keys, "--shot", shot, "--force"});
    ASSERT_EQ(exit_code(), 0);
    const Screenshot headless = picture_in(shot);
    ASSERT_EQ(headless.rgb.size(), drawn.rgb.size());
    const Difference apart = difference(headless, drawn);
    EXPECT_LT(apart.mean, 3) << keys;
    EXPECT_LT(apart.blocks_far, 0.002) << keys;
  }
}

TEST_F(PreviewWindow, ShowsADesignAlone) {
  start("vault.obj", {"--units", "mm"});
  const XWindow window(server_.display());
  Screenshot now;
  EXPECT_TRUE(window.wait(is_drawn, now));
  window.press("q");
  EXPECT_EQ(exit_code(), 0);
}

TEST_F(PreviewWindow, EndsWithAMessageWhereTheDisplayHasNoOpenGl) {
  const XServer plain({"-extension", "GLX"});
  ASSERT_TRUE(plain.started());
  start_on(plain, "program.json", {});
  EXPECT_EQ(exit_code(), 2);
}

}  // namespace
}  // namespace hotblade::pipeline::testing
