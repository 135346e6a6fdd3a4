// A panel's text has what the OBJ says of it, and nothing of the others.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <random>

#include "pipeline/batch/split.hpp"
#include "pipeline/program/sha256.hpp"
#include "surface/read/design_surface.hpp"
#include "surface/read/obj_text.hpp"

namespace hotblade::pipeline::batch {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<PanelText> split(const std::string& text, SplitBy by, int group_index = 0,
                             const std::string& only = "") {
  std::vector<PanelText> panels;
  SplitOptions options{by, group_index, only};
  options.largest_coordinate = 1e7;
  options.whole_name = "whole";
  split_obj(text, "facade.obj", options, [&](PanelText&& panel) { panels.push_back(std::move(panel)); });
  return panels;
}

std::string refusal(const std::string& text, SplitBy by, int group_index = 0, const std::string& only = "") {
  try {
    (void)split(text, by, group_index, only);
  } catch (const surface::MeshError& error) {
    return error.what();
  }
  return "split";
}

std::vector<std::string> names(const std::vector<PanelText>& panels) {
  std::vector<std::string> list;
  for (const PanelText& panel : panels) list.push_back(panel.name);
  return list;
}

// Corners of all faces of an OBJ, as points.
using Corners = std::vector<std::array<double, 3>>;
std::vector<Corners> faces_of(const std::string& text) {
  const surface::Polygons obj = surface::parse_obj(text, "text", 1e7);
  std::vector<Corners> faces;
  for (std::size_t f = 0; f < obj.faces(); ++f) {
    Corners corners;
    for (const int c : obj.face(f)) {
      const Eigen::Vector3d& p = obj.positions[static_cast<std::size_t>(c)];
      corners.push_back({p.x(), p.y(), p.z()});
    }
    faces.push_back(corners);
  }
  return faces;
}

// A facade of strips of quadrilaterals, each panel's vertices before its faces, in absolute or relative
// numbers.
struct Facade {
  std::vector<double> rise;  // of each panel
  bool relative = false, first_all_vertices = false;

  [[nodiscard]] std::string text() const {
    constexpr int kSide = 5;
    std::string vertices, faces, mixed = "# a facade\nmtllib facade.mtl\n";
    int count = 0;
    for (std::size_t panel = 0; panel < rise.size(); ++panel) {
      const int first = count + 1;
      std::string v, f = "g panel" + std::to_string(panel) + "\nusemtl foam\n";
      for (int i = 0; i < kSide; ++i) {
        for (int j = 0; j < kSide; ++j, ++count) {
          v += "v " + std::to_string(1000 * panel + 200U * static_cast<unsigned>(i)) + " " +
               std::to_string(200 * j) + ".50 " + std::to_string(rise[panel] * i * j) + "\n";
        }
      }
      const int base = relative ? first - count - 1 : first;
      for (int i = 0; i + 1 < kSide; ++i) {
        for (int j = 0; j + 1 < kSide; ++j) {
          const int a = base + kSide * i + j;
          f += "f " + std::to_string(a) + "//1 " + std::to_string(a + kSide) + "//1 " +
               std::to_string(a + kSide + 1) + "//1 " + std::to_string(a + 1) + "//1\n";
        }
      }
      vertices += v;
      faces += f;
      mixed += v + "vn 0 0 1\n" + f;
    }
    return first_all_vertices ? vertices + "vn 0 0 1\n" + faces : mixed;
  }
};

TEST(Batch, SplitKeepsBytes) {
  for (const bool relative : {false, true}) {
    const Facade facade{{1, 2, 3, 4}, relative, false};
    const std::vector<PanelText> panels = split(facade.text(), SplitBy::kGroup);
    ASSERT_THAT(names(panels), ElementsAre("panel0", "panel1", "panel2", "panel3"));
    std::vector<Corners> again;
    for (const PanelText& panel : panels) {
      for (Corners& face : faces_of(panel.text)) again.push_back(std::move(face));
      EXPECT_EQ(panel.triangles, 32U);
      EXPECT_THAT(panel.text, HasSubstr(".50 "));  // as it is written
    }
    EXPECT_EQ(again, faces_of(facade.text()));
  }
}

TEST(Batch, EveryWalkOverTheTextIsTold) {
  constexpr double kStep = 1 << 26;  // what may be left untold at the end
  const std::string text = Facade{std::vector<double>(30000, 1), false, false}.text();
  const double whole = static_cast<double>(text.size());
  ASSERT_GT(whole, kStep / 2);
  for (const auto& [by, walks] : {std::pair{SplitBy::kGroup, 3}, std::pair{SplitBy::kComponent, 5}}) {
    SplitOptions options{by, 0, ""};
    options.largest_coordinate = 1e8;  // panels stand beside each other for 30 km
    double told = 0;
    split_obj(
        text, "facade.obj", options, [](PanelText&&) {},
        [&](std::size_t bytes) { told += static_cast<double>(bytes); });
    EXPECT_LE(told, walks * whole);
    EXPECT_GT(told, (walks - 1) * whole - kStep);  // the last one passes over vertices
  }
}

TEST(Batch, OnePanelMovedLeavesTheOthersHashes) {
  for (const SplitBy by : {SplitBy::kGroup, SplitBy::kComponent}) {
    const std::vector<PanelText> before = split(Facade{{1, 2, 3, 4}}.text(), by);
    const std::vector<PanelText> after = split(Facade{{1, 2.5, 3, 4}}.text(), by);
    ASSERT_EQ(before.size(), 4U);
    ASSERT_EQ(after.size(), 4U);
    for (std::size_t i = 0; i < 4; ++i)
      EXPECT_EQ(sha256_hex(before[i].text) == sha256_hex(after[i].text), i != 1) << i;
  }
}

TEST(Batch, SplitDoesNotDependOnHowVerticesAreNumbered) {
  const std::vector<PanelText> mixed = split(Facade{{1, 2, 3}}.text(), SplitBy::kGroup);
  for (const Facade& other : {Facade{{1, 2, 3}, true}, Facade{{1, 2, 3}, false, true}}) {
    const std::vector<PanelText> panels = split(other.text(), SplitBy::kGroup);
    ASSERT_EQ(panels.size(), mixed.size());
    for (std::size_t i = 0; i < panels.size(); ++i) EXPECT_EQ(panels[i].text, mixed[i].text);
  }
}

TEST(Batch, APanelsAreaAndTrianglesAreCounted) {
  const std::vector<PanelText> panels = split(Facade{{0}}.text(), SplitBy::kNone);
  ASSERT_THAT(names(panels), ElementsAre("whole"));
  EXPECT_NEAR(panels[0].area, 800.0 * 800.0, 1e-6);
  EXPECT_EQ(panels[0].triangles, 32U);
}

const std::string kCorners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 5 0 0\nv 6 0 0\nv 5 1 0\n";

TEST(Batch, ANameTwiceIsOnePanelAndFacesWithoutOneAreUnnamed) {
  const std::string text =
      kCorners + "f 1 2 3\ng wall\nf 2 4 3\ng\nf 5 6 7\ng roof\nf 5 6 7\ng wall\nf 1 2 4\n";
  const std::vector<PanelText> panels = split(text, SplitBy::kGroup);
  ASSERT_THAT(names(panels), ElementsAre("unnamed", "wall", "roof"));
  EXPECT_EQ(panels[0].text, "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 0 0\nv 6 0 0\nv 5 1 0\nf 1 2 3\nf 4 5 6\n");
  EXPECT_EQ(panels[1].text, "v 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 0\nf 1 2 3\nf 4 1 2\n");
}

TEST(Batch, ObjectsAndComponentsAreParted) {
  const std::string text = kCorners + "o left one\nf 1 2 3\ng x\nf 2 4 3\no right\nf 5 6 7\nf 1 2 3\n";
  EXPECT_THAT(names(split(text, SplitBy::kObject)), ElementsAre("left one", "right"));
  const std::vector<PanelText> parts = split(text, SplitBy::kComponent);
  ASSERT_THAT(names(parts), ElementsAre("component 1", "component 2"));
  EXPECT_EQ(parts[0].triangles, 3U);
  EXPECT_EQ(parts[1].text, "v 5 0 0\nv 6 0 0\nv 5 1 0\nf 1 2 3\n");
}

TEST(Batch, OneGroupOfAFileCanBeTakenAlone) {
  const std::string text = kCorners + "g a\nf 1 2 3\ng b c\nf 2 4 3\no d\nf 5 6 7\n";
  EXPECT_EQ(split(text, SplitBy::kNone, 0, "c").front().triangles, 2U);
  EXPECT_EQ(split(text, SplitBy::kNone, 0, "d").front().triangles, 1U);
  EXPECT_EQ(refusal(text, SplitBy::kNone, 0, "e"), "facade.obj:13: no faces in group 'e'");
}

TEST(Batch, SeveralGroupsAtOnceAskWhichCounts) {
  const std::string text = kCorners + "g wall north\nf 1 2 3\ng roof\nf 5 6 7\n";
  EXPECT_EQ(refusal(text, SplitBy::kGroup),
            "facade.obj:8: 2 groups at once (wall north): say with --group-index which of the names is the "
            "panel's");
  EXPECT_EQ(refusal(text, SplitBy::kGroup, 3),
            "facade.obj:8: 2 groups at once (wall north, --group-index 3): there is no such name");
  EXPECT_THAT(names(split(text, SplitBy::kGroup, 2)), ElementsAre("north", "roof"));
}

TEST(Batch, WhatTheReaderRefusesIsRefusedWithTheLineOfTheWholeFile) {
  for (const auto& [line, message] : std::map<std::string, std::string>{
           {"v 0 nan 0", "facade.obj:9: coordinate is not a finite number ('nan')"},
           {"f 1 2 99", "facade.obj:9: vertex index out of range (99, the file has 7 vertices)"},
           {"f 1 2 -99", "facade.obj:9: vertex index out of range ('-99', 7 vertices so far)"},
           {"f 1 2", "facade.obj:9: face with too few corners (2, at least 3)"},
           {"wobble 3 !", "split"},
           {"<html>", "facade.obj:9: not an OBJ statement ('<html>')"}}) {
    const std::string text = kCorners + "g wall\n" + line + "\nf 1 2 3\n";
    for (const SplitBy by : {SplitBy::kGroup, SplitBy::kComponent, SplitBy::kNone})
      EXPECT_THAT(refusal(text, by), HasSubstr(message)) << line;
  }
  EXPECT_THAT(refusal("", SplitBy::kGroup), HasSubstr("the file is empty"));
  EXPECT_THAT(refusal("v 0 0 0\n", SplitBy::kGroup), HasSubstr("no faces in the file (1 vertices"));
}

TEST(Batch, ContinuedLinesCommentsAndCarriageReturnsAreNoPartOfAPanel) {
  const std::string text =
      "v 0 0 0 # origin\r\nv 1 0 \\\r\n0\r\nv 0 1 0\r\ng p # the panel\r\nf 1 2 3 # one\r\n";
  const std::vector<PanelText> panels = split(text, SplitBy::kGroup);
  ASSERT_THAT(names(panels), ElementsAre("p"));
  EXPECT_EQ(faces_of(panels[0].text), faces_of(text));
  EXPECT_THAT(panels[0].text, ::testing::StartsWith("v 0 0 0\nv 1 0 \\\r\n0\nv 0 1 0\nf 1 2 3\n"));
}

TEST(Batch, AFaceOfAPanelHasItsLineInTheFile) {
  const std::string text =
      "v 0 0 0\nv 1 0 \\\n0\nv 0 1 0\n# a comment\ng p\nf 1 2 3\ng q\nf 3 2 1\ng p\n\nf 1 3 2\n";
  SplitOptions options{SplitBy::kGroup};
  options.largest_coordinate = 1e7;
  options.with_lines = true;
  options.wanted = [](const std::string& name) { return name == "p"; };
  std::vector<PanelText> panels;
  split_obj(text, "facade.obj", options, [&](PanelText&& panel) { panels.push_back(std::move(panel)); });
  ASSERT_THAT(names(panels), ElementsAre("p"));
  // Four lines of three vertices, one of them continued; then the faces of lines 7 and 12.
  EXPECT_EQ(panels[0].file_line(4), std::nullopt);
  EXPECT_EQ(panels[0].file_line(5), 7U);
  EXPECT_EQ(panels[0].file_line(6), 12U);
  EXPECT_EQ(panels[0].file_line(7), std::nullopt);
}

}  // namespace
}  // namespace hotblade::pipeline::batch
