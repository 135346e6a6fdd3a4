// OBJ text read in parts gives what is read of it in one: polygons, groups, warnings and errors.
#include "surface/read/obj_parts.hpp"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "surface/read/design_surface.hpp"
#include "surface/read/first_of_equals.hpp"
#include "surface/read/half_edges.hpp"
#include "surface/read/mates.hpp"
#include "surface/read/obj_text.hpp"
#include "surface/read/triangle_mesh.hpp"
#include "surface/read/words.hpp"
#include "tests/surface/meshes.hpp"

namespace hotblade::surface {
namespace {

// All that a reader makes of a text, an error's words among it.
std::string told(std::string_view text, std::size_t part_bytes) {
  try {
    const Polygons obj = parse_obj(text, "in.obj", 1e7, part_bytes);
    std::string all;
    for (const Eigen::Vector3d& p : obj.positions)
      for (const double x : p) all += std::to_string(x) + " ";
    for (std::size_t f = 0; f < obj.faces(); ++f) {
      all += "\nface " + std::to_string(obj.face_place[f]) + ":";
      for (const int c : obj.face(f)) all += " " + std::to_string(c);
      const Polygons::Group& group = obj.groups.at(obj.face_group[f]);
      all += " of " + group.object;
      for (const std::string& name : group.names) all += "," + name;
    }
    for (const std::string& warning : obj.warnings) all += "\n" + warning;
    return all;
  } catch (const MeshError& error) {
    return error.what();
  }
}

constexpr std::size_t kWhole = 1 << 20;

// A blank before each line changes nothing but how it is read: token by token in place of at once.
std::string with_blanks(const std::string& text) {
  std::string out = " ";
  for (std::size_t i = 0; i < text.size(); ++i) {
    out += text[i];
    if (text[i] == '\n' && i + 1 < text.size()) out += ' ';  // behind the last it would be a line of its own
  }
  return out;
}

TEST(ObjParts, PlainLinesAreReadAsTokensAre) {
  const std::string letters = "0123456789.-+ev/f#\\\t\r\n 1";
  std::mt19937 random(21);
  int refused = 0, taken = 0;
  for (int round = 0; round < 20'000; ++round) {
    std::string text =
        "v 0 0.5 -10.250\nv 12345.678901 0 0\nv 0 1000 00.0\nf 1 2 3\nf 3  2 1 2 \r\nv 1 2 3\n";
    for (int change = 0; change < round % 4; ++change)
      text[random() % text.size()] = letters[random() % letters.size()];
    if (round % 5 == 4) text.resize(1 + random() % text.size());
    const std::string said = told(text, kWhole);
    ASSERT_EQ(said, told(with_blanks(text), kWhole)) << text;
    (said.starts_with("in.obj:") ? refused : taken) += 1;
  }
  EXPECT_GT(refused, 2'000);
  EXPECT_GT(taken, 2'000);
}

TEST(ObjParts, NumbersAreTakenToTheLastBit) {
  std::mt19937_64 random(22);
  std::uniform_real_distribution<double> any(-1, 1), power(-12, 9);
  const std::array<const char*, 7> formats{"%.3f", "%.6f", "%.9f", "%.14g", "%.15g", "%.17g", "%.6e"};
  for (int round = 0; round < 200'000; ++round) {
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), formats[static_cast<std::size_t>(round) % formats.size()],
                  any(random) * std::pow(10, power(random)));
    const std::optional<double> read = number_in(text.data());
    ASSERT_TRUE(read) << text.data();
    ASSERT_EQ(std::bit_cast<std::uint64_t>(*read),
              std::bit_cast<std::uint64_t>(std::strtod(text.data(), nullptr)))
        << text.data();
  }
  for (const char* text :
       {"-0", "0.", ".5", "-.5", "999999999999999", "9999999999999999", "0.000000000000001"})
    EXPECT_EQ(std::bit_cast<std::uint64_t>(number_in(text).value_or(7)),
              std::bit_cast<std::uint64_t>(std::strtod(text, nullptr)))
        << text;
  for (const char* text : {"", "-", ".", "-.", "1.2.3", "1-", "--1", "+-1"})
    EXPECT_FALSE(number_in(text)) << text;
}

TEST(ObjParts, AreReadAsTheWholeTextIs) {
  const std::vector<std::string> lines = {"v 1 2 3",
                                          "  v 4.5 -6 7e-1 # c",
                                          "f 1 2 3",
                                          "f 1/2/3 2//1 -1 # f 1 2",
                                          "fo 1 2 3 4",
                                          "g one two",
                                          "o thing",
                                          "# v 1 2 3",
                                          "",
                                          "\tusemtl x",
                                          "curious 1 2",
                                          "v 1 2",
                                          "f 1 2",
                                          "f 1 x 3",
                                          "f 9 1 2",
                                          "vt 0 0",
                                          "v 1 2 3 0.5",
                                          "f -9 1 2",
                                          "g",
                                          "v 8 9 10\r",
                                          "f 3 \\\n 2 1",
                                          "lone\rcarriage",
                                          "V 1 2 3",
                                          "f 1 2 3#4"};
  std::mt19937 random(7);
  for (int round = 0; round < 4000; ++round) {
    std::string text = round % 2 == 0 ? "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\n" : "";
    // Lines that are wrong in one text of some.
    const std::size_t most = round % 5 == 0 ? lines.size() : 11;
    for (int line = 0; line < 1 + round % 23; ++line) text += lines[random() % most] + "\n";
    if (round % 3 == 0) text.pop_back();
    const std::string whole = told(text, kWhole);
    for (const std::size_t bytes : {std::size_t{1}, std::size_t{9}, std::size_t{40}})
      ASSERT_EQ(told(text, bytes), whole) << text;
  }
}

TEST(ObjParts, CountWhatStandsBeforeThem) {
  const auto parts = obj_parts("v 1 2 3\nv 1 2 4\ng a\nf 1 2 -1 # 4\nf 1 2 3 4", 1);
  ASSERT_TRUE(parts);
  ASSERT_EQ(parts->size(), 5U);
  const ObjPart& last = parts->back();
  EXPECT_EQ(last.before.lines, 4U);
  EXPECT_EQ(last.before.vertices, 2U);
  EXPECT_EQ(last.faces_before, 1U);
  EXPECT_EQ(last.corners_before, 3U);
  EXPECT_EQ(last.corners, 4U);
  EXPECT_EQ((*parts)[2].names, std::vector<std::size_t>{16});
}

TEST(ObjParts, AreNoneOfTextWhoseLinesGoOnOrEndInAnotherWay) {
  EXPECT_FALSE(obj_parts("v 1 2 \\\n3\n", 4));
  EXPECT_FALSE(obj_parts("v 1 2 3\rv 1 2 4\r", 4));
  EXPECT_TRUE(obj_parts("v 1 2 3\r\nv 1 2 4\r\n", 4));
}

TEST(FirstOfEquals, IsTheLowestNumberInListsOfManyParts) {
  std::mt19937 random(11);
  for (const std::size_t count : {std::size_t{10}, std::size_t{200'000}}) {
    std::vector<std::uint32_t> items(count);
    for (std::uint32_t& item : items) item = static_cast<std::uint32_t>(random() % (count / 2));
    std::vector<int> lowest(count, -1), expected(count);
    for (std::size_t i = 0; i < count; ++i) {
      int& first = lowest[items[i]];
      if (first < 0) first = static_cast<int>(i);
      expected[i] = first;
    }
    for (const Equals where : {Equals::kRare, Equals::kNear})
      EXPECT_EQ(first_of_equals(
                    count, [&](std::size_t i) { return stir(0, items[i]); },
                    [&](std::size_t i, std::size_t j) { return items[i] == items[j]; }, where),
                expected);
  }
}

TEST(PlainMates, AreThoseOfSurfacesOnly) {
  const std::vector<std::array<int, 3>> two = {{0, 1, 2}, {2, 1, 3}};
  const auto mates = plain_mates(4, two);
  ASSERT_TRUE(mates);
  EXPECT_EQ(mates->of_corner, (std::vector<int>{-1, 3, -1, 1, -1, -1}));
  EXPECT_EQ(mates->lowest, (std::vector<int>{0, 1, 2, 5}));
  // Three at an edge, two that run the same way, two that meet in a vertex only.
  EXPECT_FALSE(plain_mates(5, std::vector<std::array<int, 3>>{{0, 1, 2}, {2, 1, 3}, {2, 1, 4}}));
  EXPECT_FALSE(plain_mates(4, std::vector<std::array<int, 3>>{{0, 1, 2}, {1, 2, 3}}));
  EXPECT_FALSE(plain_mates(5, std::vector<std::array<int, 3>>{{0, 1, 2}, {0, 3, 4}}));
  // Two closed fans at a vertex: tetrahedra that touch there.
  std::vector<std::array<int, 3>> touching = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  EXPECT_TRUE(plain_mates(4, touching));
  for (const std::array<int, 3> t : std::vector<std::array<int, 3>>(touching)) {
    const auto moved = [](int v) { return v == 3 ? 3 : v + 4; };
    touching.push_back({moved(t[0]), moved(t[1]), moved(t[2])});
  }
  EXPECT_FALSE(plain_mates(7, touching));
}

TEST(PlainMates, AreFoundAtVerticesOfManyTriangles) {
  constexpr int kRim = 5'000;
  std::vector<std::array<int, 3>> wheel;
  for (int i = 0; i < kRim; ++i) wheel.push_back({0, 1 + i, 1 + (i + 1) % kRim});
  std::shuffle(wheel.begin(), wheel.end(), std::mt19937(5));
  const auto mates = plain_mates(kRim + 1, wheel);
  ASSERT_TRUE(mates);
  for (int c = 0; c < 3 * kRim; ++c) {
    const int mate = mates->of_corner[static_cast<std::size_t>(c)];
    if (c % 3 == 1) {
      EXPECT_EQ(mate, -1);
    } else {
      EXPECT_EQ(mates->of_corner[static_cast<std::size_t>(mate)], c);
    }
  }
  wheel.pop_back();
  EXPECT_TRUE(plain_mates(kRim + 1, wheel));
  wheel.erase(wheel.begin() + kRim / 2);
  EXPECT_FALSE(plain_mates(kRim + 1, wheel));
}

// Long lists are taken in blocks: what is counted and found in them adds up to the whole.
TEST(PlainMates, LayOutLargeSurfacesInParts) {
  TriangleSoup soup = grid(300, 200, [](double s, double t) { return Eigen::Vector3d(s, t, s * t); });
  const auto count = static_cast<int>(soup.vertices.size());
  TriangleSoup two = soup;
  for (const Eigen::Vector3d& p : soup.vertices) two.vertices.push_back(p + Eigen::Vector3d(0, 0, 5));
  for (const auto& t : soup.triangles) two.triangles.push_back({t[0] + count, t[1] + count, t[2] + count});
  std::string text;
  for (const Eigen::Vector3d& p : two.vertices)
    text += "v " + std::to_string(p.x()) + " " + std::to_string(p.y()) + " " + std::to_string(p.z()) + "\n";
  for (const auto& t : two.triangles)
    text += "f " + std::to_string(t[0] + 1) + " " + std::to_string(t[1] + 1) + " " +
            std::to_string(t[2] + 1) + "\n";
  const ScratchFile file(text);
  ReadOptions options;
  options.units = "m";
  const DesignSurface design = read_obj(file.path(), options);
  EXPECT_EQ(design.health.triangles, two.triangles.size());
  EXPECT_EQ(design.health.components, 2U);
  EXPECT_EQ(design.health.border_loops, 2U);
  EXPECT_EQ(design.face_place.back(), two.vertices.size() + two.triangles.size());
  EXPECT_TRUE(design.mesh.half_edges().plain());
  EXPECT_EQ(design.mesh.border().size(), 2U * 2U * (300U + 200U));
}

}  // namespace
}  // namespace hotblade::surface
