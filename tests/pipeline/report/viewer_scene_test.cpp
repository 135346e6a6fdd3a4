#include "pipeline/report/viewer_scene.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "pipeline/preview/cut_values.hpp"
#include "pipeline/report/report_html.hpp"
#include "pipeline/report/viewer_html.hpp"
#include "tests/pipeline/vault_design.hpp"
#include "tests/pipeline/vault_program.hpp"

namespace hotblade::pipeline {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// A scene read back by the description in viewer_scene.hpp.
struct Decoded {
  nlohmann::json header;
  std::map<std::string, std::vector<std::uint32_t>> arrays;
};

std::string from_base64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  unsigned held = 0;
  int bits = 0;
  for (const char c : text) {
    if (c == '=') break;
    held = (held << 6) | static_cast<unsigned>(digits.find(c));
    bits += 6;
    if (bits >= 8) bytes += static_cast<char>((held >> (bits -= 8)) & 0xff);
  }
  return bytes;
}

std::string unpacked(const std::string& bytes) {
  z_stream stream{};
  EXPECT_EQ(inflateInit2(&stream, 15 + 16), Z_OK);
  std::string in = bytes, out(200 * bytes.size() + 1000000, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(in.data());
  stream.avail_in = static_cast<uInt>(in.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  EXPECT_EQ(inflate(&stream, Z_FINISH), Z_STREAM_END);
  out.resize(stream.total_out);
  inflateEnd(&stream);
  return out;
}

Decoded decoded(const std::string& text) {
  const std::string bytes = unpacked(from_base64(text));
  const auto byte = [&](std::size_t i) {
    return static_cast<std::uint32_t>(static_cast<unsigned char>(bytes.at(i)));
  };
  EXPECT_EQ(bytes.substr(0, 4), "HBV1");
  const std::size_t size = byte(4) | byte(5) << 8 | byte(6) << 16 | byte(7) << 24;
  Decoded scene;
  scene.header = nlohmann::json::parse(bytes.substr(8, size));
  std::size_t at = 8 + size;
  for (const auto& array : scene.header["arrays"]) {
    const std::size_t count = array["count"], width = array["bytes"];
    const int follows = array["follows"];
    const std::uint32_t mask = width == 4 ? ~0u : (1u << 8 * width) - 1;
    std::uint32_t last = 0, step = 0;
    std::vector<std::uint32_t>& out = scene.arrays[array["name"]];
    for (std::size_t i = 0; i < count; ++i) {
      std::uint32_t n = 0;
      for (std::size_t plane = 0; plane < width; ++plane) n |= byte(at + plane * count + i) << 8 * plane;
      if (follows != 0) {
        const std::uint32_t change = (n >> 1) ^ (0u - (n & 1));
        step = follows == 2 ? step + change : change;
        n = last = (last + step) & mask;
      }
      out.push_back(n);
    }
    at += count * width;
  }
  EXPECT_EQ(at, bytes.size());
  return scene;
}

struct Vault {
  Program program = testing::vault_program({.bulge_mm = 1.4});
  surface::DesignSurface design = testing::vault_design(1);
  preview::Scene scene = preview::scene_of(program, &design, {});
};

TEST(ViewerScene, HasEveryVertexWithinAStepOfItsPlaceAndItsDeviation) {
  const Vault vault;
  const preview::CutSurface& cut = vault.scene.cut;
  const Decoded scene = decoded(viewer_scene(vault.scene, vault.program, {}).text);
  ASSERT_EQ(scene.arrays.at("cut_x").size(), cut.vertices.size());
  ASSERT_EQ(scene.arrays.at("cut_corners").size(), 3 * cut.triangles.size());
  const auto box = scene.header["box"].get<std::vector<std::vector<double>>>();
  const auto coloring = preview::coloring_of(preview::Color::kDeviation, vault.program, cut);
  const double tolerance = *coloring.scale->tolerance, high = coloring.scale->high;
  // The key's half has 127.5 steps; what lies within the tolerance has its share of them.
  const double inside = std::max(0.3, tolerance / high);
  for (std::size_t i = 0; i < cut.vertices.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      const auto k = static_cast<std::size_t>(axis);
      const double step = box[1][k] / 65535;
      const double place = box[0][k] + step * scene.arrays.at(std::string("cut_") + "xyz"[k])[i];
      EXPECT_NEAR(place, cut.vertices[i][axis], 0.5001 * step);
    }
    const double place = std::abs(scene.arrays.at("deviation")[i] / 127.5 - 1);
    const double size = std::abs(cut.deviation_mm[i]);
    const double expected = size <= tolerance
                                ? inside * size / tolerance
                                : inside + (1 - inside) * (size - tolerance) / (high - tolerance);
    EXPECT_NEAR(place, expected, 0.5001 / 127.5) << i;
  }
}

TEST(ViewerScene, IsTheSameBytesEachTimeAndTellsNoTime) {
  const Vault vault;
  const std::string text = viewer_scene(vault.scene, vault.program, {}).text;
  EXPECT_EQ(text, viewer_scene(vault.scene, vault.program, {}).text);
  const std::string bytes = from_base64(text);
  for (const std::size_t i : {4u, 5u, 6u, 7u}) EXPECT_EQ(bytes[i], 0) << "the time in gzip's header";
}

TEST(ViewerScene, LeavesRowsOutEvenlyUntilItFits) {
  const Vault vault;
  const ViewerScene whole = viewer_scene(vault.scene, vault.program, {});
  for (const ViewerLimits& limits :
       {ViewerLimits{whole.triangles / 3, 1000000}, ViewerLimits{200000, 3 * whole.text.size() / 4}}) {
    const ViewerScene some = viewer_scene(vault.scene, vault.program, limits);
    EXPECT_LE(some.triangles, limits.triangles);
    EXPECT_LE(some.text.size(), limits.text_bytes);
    EXPECT_GT(some.row_step, 1u);
    EXPECT_GT(some.triangles, 100u);
    // The last row, where a strip ends, is there.
    const Decoded scene = decoded(some.text);
    EXPECT_EQ(scene.arrays.at("row_tenths").back(), decoded(whole.text).arrays.at("row_tenths").back());
    EXPECT_EQ(scene.arrays.at("row_done").back(), scene.arrays.at("cut_corners").size() / 3);
  }
}

TEST(ViewerScene, DrawsALargeDesignByFewerTriangles) {
  const surface::DesignSurface design = testing::vault_design(40);
  const preview::Scene scene = preview::scene_of(design);
  ASSERT_GT(scene.design.triangles().size(), 50000u);
  const ViewerScene view = viewer_scene(scene, Program{}, {});
  EXPECT_TRUE(view.coarse_design);
  EXPECT_LE(view.triangles, 50000u);
  EXPECT_GT(view.triangles, 20000u);
}

TEST(ViewerHtml, KeepsThePictureAndRunsNothingThatIsNotInThePage) {
  const Vault vault;
  const std::string html =
      viewer_html(viewer_scene(vault.scene, vault.program, {}), "<p>picture</p>", Words("en"));
  EXPECT_THAT(html, HasSubstr("<div class=\"still\"><p>picture</p></div>"));
  EXPECT_THAT(html, HasSubstr("data-state=\"still\""));
  EXPECT_THAT(html, Not(HasSubstr("src=")));
  EXPECT_THAT(html, Not(HasSubstr("http")));
}

TEST(Viewer, HasThreeNames) {
  EXPECT_EQ(viewer_named("full"), Viewer::kFull);
  EXPECT_EQ(viewer_named("light"), Viewer::kLight);
  EXPECT_EQ(viewer_named("none"), Viewer::kNone);
  EXPECT_FALSE(viewer_named("").has_value());
}

}  // namespace
}  // namespace hotblade::pipeline
