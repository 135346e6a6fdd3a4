#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "surface/read/design_surface.hpp"
#include "tests/surface/meshes.hpp"

namespace hotblade::surface {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

const std::string kSquare = "v 0 0 0\nv 100 0 0\nv 100 100 0\nv 0 100 0\n";

struct Rejection {
  const char* name;
  std::string text;
  std::string place;  // after the file name
  std::string reason;
};

void PrintTo(const Rejection& r, std::ostream* out) {
  *out << r.name;
}

class ReadObjRejects : public ::testing::TestWithParam<Rejection> {};

TEST_P(ReadObjRejects, WithPlaceAndReason) {
  const ScratchFile file(GetParam().text);
  const std::string message = message_of<MeshError>([&] {
    static_cast<void>(read_obj(file.path(), {"mm", 'z'}));
  });
  EXPECT_THAT(message, AllOf(HasSubstr("in.obj" + GetParam().place), HasSubstr(GetParam().reason)));
}

INSTANTIATE_TEST_SUITE_P(
    Texts, ReadObjRejects,
    ::testing::Values(
        Rejection{"Empty", "", ":1: ", "empty"},
        Rejection{"NoVertices", "# only a comment\n", ":1: ", "no vertices"},
        Rejection{"NoFaces", kSquare, ":4: ", "no faces in the file (4 vertices"},
        Rejection{"Utf16LittleEndian", std::string("\xff\xfev\0 \0", 6), ":1: ", "iconv -f UTF-16"},
        Rejection{"Utf16BigEndian", std::string("\xfe\xff\0v\0 ", 6), ":1: ", "UTF-16"},
        Rejection{"Utf16WithoutMark", std::string("v\0 \0", 4), ":1: ", "UTF-16"},
        Rejection{"NulByte", kSquare + std::string("f 1 2\0 3\n", 9), ":5: ", "NUL byte"},
        Rejection{"NotANumberNan", "v 0 0 0\nv nan 0 0\n", ":2: ", "not a finite number ('nan')"},
        Rejection{"MinusNan", "v 0 -nan 0\n", ":1: ", "not a finite number"},
        Rejection{"Infinite", "v 0 0 inf\n", ":1: ", "not a finite number ('inf')"},
        Rejection{"Indefinite", "v 0 0 1.#IND\n", ":1: ", "not a finite number ('1.#IND')"},
        Rejection{"Overflow", "v 0 0 1e999\n", ":1: ", "not a finite number"},
        Rejection{"TwoCoordinates", "v 0 0 0\n\nv 1 2\n", ":3: ", "missing coordinate (2 of 3 given)"},
        Rejection{"Word", "v 0 zero 0\n", ":1: ", "not a number ('zero')"},
        Rejection{"DecimalComma", "v 0 1,5 0\n", ":1: ", "decimal point, not a comma"},
        Rejection{"TwoSigns", "v 0 +-5 0\n", ":1: ", "not a number ('+-5')"},
        Rejection{"TextAfterVertex", "v 0 0 0 red\n", ":1: ", "not a number ('red')"},
        Rejection{"IndexZero", kSquare + "f 0 1 2\n", ":5: ", "vertex index 0"},
        Rejection{"IndexTooLarge", kSquare + "\n\nf 1 2 5\nf 1 2 3\n",
                  ":7: ", "out of range (5, the file has 4 vertices)"},
        Rejection{"RelativeIndexTooSmall", kSquare + "f -1 -2 -5\n",
                  ":5: ", "out of range ('-5', 4 vertices so far)"},
        Rejection{"IndexBeyondAnyInteger", kSquare + "f 1 2 99999999999999999999\n", ":5: ", "out of range"},
        Rejection{"OneCorner", kSquare + "f 1\n", ":5: ", "too few corners (1, at least 3)"},
        Rejection{"TwoCorners", kSquare + "f 1/1/1 2/2/2\n", ":5: ", "too few corners (2, at least 3)"},
        Rejection{"FractionalIndex", kSquare + "f 1 2 3.5\n", ":5: ", "not a face corner ('3.5')"},
        Rejection{"TooManySlashes", kSquare + "f 1/1/1/1 2 3\n", ":5: ", "not a face corner ('1/1/1/1')"},
        Rejection{"WordAsIndex", kSquare + "f 1 2 three\n", ":5: ", "not a face corner ('three')"},
        Rejection{"CapitalStatement", "V 0 0 0\n", ":1: ", "not an OBJ statement ('V')"},
        Rejection{"Bytes", "\x89PNG\r\n\x1a\n", ":1: ", "not an OBJ statement"},
        Rejection{"Huge", "v 0 0 0\nv 10000001 0 0\n", ":2: ", "too large (10000001, limit 1e7 mm"},
        Rejection{"NoArea", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", ":4: ", "no face has an area"}),
    [](const auto& rejection) { return std::string(rejection.param.name); });

TEST(ReadObj, CountsLinesThroughEveryKindOfLineEnd) {
  const auto line_of = [](const std::string& end) {
    const ScratchFile file("v 0 0 0" + end + end + "v 1 \\" + end + "0 0" + end + "v bad 0 0" + end);
    return message_of<MeshError>([&] { static_cast<void>(read_obj(file.path(), {"mm", 'z'})); });
  };
  for (const char* end : {"\n", "\r\n", "\r"}) EXPECT_THAT(line_of(end), HasSubstr("in.obj:5: "));
}

// As a survey has it: 450 km from the origin, and 4 x 3 m itself.
TEST(ReadObj, SaysThatASmallDesignFarFromTheOriginIsToBeMovedThere) {
  const auto refusal = [](const std::string& text, const char* units) {
    const ScratchFile file(text);
    return message_of<MeshError>([&] { static_cast<void>(read_obj(file.path(), {units, 'z'})); });
  };
  const std::string far = "v 450122 5432099 512\nv 450126 5432099 512\nv 450126 5432102 513\nf 1 2 3\n";
  EXPECT_THAT(
      refusal(far, "m"),
      HasSubstr(":1: coordinate too large (450122, limit 1e7 mm after scaling): check --units, or move "
                "the design, itself 4000 x 3000 x 1000 mm, to the origin"));
  // As far as it is large: the number is damaged, or the unit wrong.
  EXPECT_THAT(refusal("v 0 0 0\nv 450126 0 0\nv 0 3 0\nf 1 2 3\n", "m"),
              ::testing::EndsWith("check --units"));
}

TEST(ReadObj, SaysWhyAFileCannotBeRead) {
  const ScratchFile file("");
  const auto read = [&](const std::filesystem::path& p) {
    return message_of<FileError>([&] { static_cast<void>(read_obj(p, {"mm", 'z'})); });
  };
  EXPECT_THAT(read(file.folder() / "none.obj"), AllOf(HasSubstr("none.obj"), HasSubstr("no such file")));
  EXPECT_THAT(read(file.folder()), HasSubstr("directory"));
}

TEST(ReadObj, RefusesUnknownUnitsAndAxes) {
  EXPECT_THROW(static_cast<void>(scale_to_mm("furlong")), std::logic_error);
  const ScratchFile file(kSquare + "f 1 2 3\n");
  EXPECT_THROW(static_cast<void>(read_obj(file.path(), {"", 'z'})), std::logic_error);
  EXPECT_THROW(static_cast<void>(read_obj(file.path(), {"mm", 'x'})), std::logic_error);
}

TEST(ReadObj, TakesEveryWayToWriteANumber) {
  const DesignSurface d = read_text("v .8e-1 2. +3.0\nv -0 1e+2 0\nv 1E2 -.5 1e-400\nf 1 2 3\n");
  ASSERT_THAT(d.mesh.vertices(), SizeIs(3));
  EXPECT_EQ(d.mesh.vertices()[0], Eigen::Vector3d(0.08, 2, 3));
  EXPECT_EQ(d.mesh.vertices()[1], Eigen::Vector3d(0, 100, 0));
  EXPECT_EQ(d.mesh.vertices()[2], Eigen::Vector3d(100, -0.5, 0));
}

TEST(ReadObj, TakesWeightsColoursTriplesAndStatementsWithoutFaces) {
  const DesignSurface d = read_text(
      "\xef\xbb\xbfmtllib a b.mtl\no thing\nv 0 0 0 1\nv 100 0 0 0.5 0.5 nan\nv 100 100 0 1 1 0 0\nvt 0 "
      "0\nvn 0 0 1\n"
      "vp 0.1\ng a b\ns off\nusemtl x\n# stray \x01\xff bytes \\\nf 1/1/1 2//1 3/1 # corner kinds\nl 1 2\np "
      "1");
  EXPECT_THAT(d.mesh.triangles(), SizeIs(1));
  EXPECT_THAT(d.health.warnings, IsEmpty());
  EXPECT_THAT(d.health.repairs, IsEmpty());
}

TEST(ReadObj, WarnsOfUnknownStatements) {
  const DesignSurface d = read_text(kSquare + "surf 0 1 0 1 1 2 3\nt crease 1\nf 1 2 3 4\n");
  EXPECT_THAT(d.health.warnings,
              ::testing::ElementsAre(HasSubstr("2 statements passed over, the first surf in line 5")));
}

TEST(ReadObj, CountsRelativeIndicesFromTheFacesPlaceInTheFile) {
  const DesignSurface d = read_text("v 9 9 9\nv 0 0 0\nv 50 0 0\nv 0 50 0\nf -3 -2 -1\nv 7 7 7\n");
  EXPECT_NEAR(d.health.area_mm2, 1250, 1e-9);
  EXPECT_EQ(d.health.unused_vertices, 2U);
  EXPECT_EQ(d.health.file_vertices, 5U);
  EXPECT_EQ(d.health.vertices, 3U);
}

TEST(ReadObj, JoinsContinuedLines) {
  EXPECT_THAT(read_text(kSquare + "f 1 2 \\\n3 \\\r\n 4\n").mesh.triangles(), SizeIs(2));
  EXPECT_THAT(read_text(kSquare + "f 1 2\\\n 3\n").mesh.triangles(), SizeIs(1));
}

TEST(ReadObj, TakesFacesBeforeTheirVertices) {
  EXPECT_NEAR(read_text("f 1 2 3 4\n" + kSquare).health.area_mm2, 1e4, 1e-6);
}

TEST(ReadObj, ScalesUnitsAndTurnsYUp) {
  const std::string text = "v 1 2 3\nv 2 2 3\nv 1 3 3\nf 1 2 3\n";
  const std::vector<std::pair<std::string, double>> scales = {
      {"mm", 1}, {"cm", 10}, {"m", 1000}, {"in", 25.4}, {"ft", 304.8}};
  for (const auto& [unit, scale] : scales) {
    const DesignSurface z = read_text(text, {unit, 'z'}), y = read_text(text, {unit, 'y'});
    EXPECT_EQ(z.scale_to_mm, scale);
    EXPECT_EQ(z.mesh.vertices()[0], Eigen::Vector3d(1 * scale, 2 * scale, 3 * scale)) << unit;
    EXPECT_EQ(y.mesh.vertices()[0], Eigen::Vector3d(1 * scale, -3 * scale, 2 * scale)) << unit;
    EXPECT_EQ(y.mesh.soup().triangles, z.mesh.soup().triangles);  // a turn, not a mirror image
  }
}

TEST(ReadObj, LimitsCoordinatesAfterScaling) {
  EXPECT_THROW(read_text("v 0 0 0\nv 20000 0 0\nv 0 1 0\nf 1 2 3\n", {"m", 'z'}), MeshError);
  EXPECT_NO_THROW(read_text("v 0 0 0\nv 20000 0 0\nv 0 1 0\nf 1 2 3\n", {"mm", 'z'}));
}

// Whether a size suits blade and blocks is no matter of reading (pipeline/plan/suggestions.hpp).
TEST(ReadObj, TakesEverySizeAsItIs) {
  for (const char* units : {"mm", "m"})
    EXPECT_THAT(read_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n", {units, 'z'}).health.warnings, IsEmpty());
}

TEST(ReadObj, GivesTheSha256OfTheBytes) {
  const ScratchFile file("v 0 0 0\nv 100 0 0\nv 0 100 0\nf 1 2 3\n", "named.obj");
  const DesignSurface d = read_obj(file.path(), {"mm", 'z'});
  EXPECT_EQ(d.file_name, "named.obj");
  // printf 'v 0 0 0\nv 100 0 0\nv 0 100 0\nf 1 2 3\n' | sha256sum
  EXPECT_EQ(d.sha256, "459ae2961569635d294df117a35763b80c6b0d63b56d600b3c1becaf6b5bbc90");
}

TEST(ReadObj, CutsPolygonsWithoutChangingTheirArea) {
  struct Polygon {
    const char* what;
    std::vector<Eigen::Vector2d> corners;
    double area;
  };
  const std::vector<Polygon> polygons = {
      {"quad", {{0, 0}, {100, 0}, {100, 50}, {0, 50}}, 5000},
      {"concave quad", {{0, 0}, {50, 20}, {100, 0}, {50, 100}}, 4000},
      {"L", {{0, 0}, {100, 0}, {100, 30}, {30, 30}, {30, 100}, {0, 100}}, 5100},
      {"corner on a side", {{0, 0}, {50, 0}, {100, 0}, {100, 100}, {0, 100}}, 10000},
      {"quad with a corner on a side", {{0, 0}, {50, 0}, {100, 0}, {40, 100}}, 5000},
      {"comb",
       {{0, 0},
        {100, 0},
        {100, 50},
        {80, 50},
        {80, 10},
        {60, 10},
        {60, 50},
        {40, 50},
        {40, 10},
        {20, 10},
        {20, 50},
        {0, 50}},
       3400}};
  const Eigen::Matrix3d tilt =
      Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  for (const Polygon& polygon : polygons) {
    const int n = static_cast<int>(polygon.corners.size());
    for (int start = 0; start < n; ++start) {
      TriangleSoup points;
      std::string face = "f";
      for (int i = 0; i < n; ++i) {
        const Eigen::Vector2d& c = polygon.corners[static_cast<std::size_t>((start + i) % n)];
        points.vertices.emplace_back(tilt * Eigen::Vector3d(c.x(), c.y(), 7));
        face += " " + std::to_string(i + 1);
      }
      const DesignSurface d = read_text(to_obj(points) + face + "\n");
      EXPECT_NEAR(d.health.area_mm2, polygon.area, 1e-8) << polygon.what << " from corner " << start;
      EXPECT_THAT(d.mesh.triangles(), SizeIs(static_cast<std::size_t>(n - 2))) << polygon.what;
      for (const auto& t : d.mesh.triangles()) {
        const auto v = d.mesh.vertices();
        const Eigen::Vector3d a = v[static_cast<std::size_t>(t[0])];
        EXPECT_GT((v[static_cast<std::size_t>(t[1])] - a)
                      .cross(v[static_cast<std::size_t>(t[2])] - a)
                      .dot(tilt.col(2)),
                  0);
      }
    }
  }
}

TEST(ReadObj, SaysWhichPolygonCrossesItself) {
  const DesignSurface d =
      read_text("v 0 0 0\nv 100 100 0\nv 100 0 0\nv 0 100 0\nv -9 50 0\nf 1 2 3 4 5\nf 1 5 4\n");
  EXPECT_THAT(d.health.warnings,
              ::testing::Contains(AllOf(HasSubstr("not a simple polygon"), HasSubstr("line 6"))));
}

TEST(ReadObj, MergesVerticesOfExactlyTheSameCoordinates) {
  const DesignSurface d =
      read_text("v 0 0 0\nv 100 0 0\nv 0 100 0\nv 100 0 -0\nv 100 100 0\nv 0 100 -0.0\nf 1 2 3\nf 4 5 6\n");
  EXPECT_EQ(d.health.vertices, 4U);
  EXPECT_EQ(d.health.components, 1U);
  EXPECT_EQ(d.health.border_loops, 1U);
  EXPECT_THAT(d.health.repairs, ::testing::ElementsAre(HasSubstr("merged 2 vertices")));
  EXPECT_EQ(
      read_text("v 0 0 0\nv 100 0 0\nv 0 100 0\nv 100 0 1e-9\nv 100 100 0\nv 0 100 0\nf 1 2 3\nf 4 5 6\n")
          .health.components,
      2U);
}

TEST(ReadObj, DropsFacesWithoutAreaAndDuplicates) {
  const DesignSurface d = read_text(kSquare + "f 1 2 3\nf 1 3 4\nf 1 1 2\nf 3 1 2\nf 4 3 1\nf 1 2 3 3\n");
  EXPECT_EQ(d.health.triangles, 2U);
  EXPECT_EQ(d.health.degenerate_faces, 1U);
  EXPECT_EQ(d.health.duplicate_faces, 3U);
  EXPECT_EQ(d.health.file_faces, 6U);
  EXPECT_THAT(d.health.repairs,
              ::testing::ElementsAre(HasSubstr("dropped 3 faces"), HasSubstr("1 face without area")));
  EXPECT_THAT(d.health.blockers, IsEmpty());
}

}  // namespace
}  // namespace hotblade::surface
