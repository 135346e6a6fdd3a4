#include "surface/read/stl.hpp"

#include <gmock/gmock.h>

#include <limits>

#include "tests/surface/read/mesh_files.hpp"

namespace hotblade::surface {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

const Eigen::Vector3f kA(0, 0, 0), kB(100, 0, 0), kC(100, 100, 0), kD(0, 100, 0);
const std::string kSquare = stl_facet(kA, kB, kC) + stl_facet(kA, kC, kD);

TEST(Stl, AMeshComesBackFromBinaryToTheBitOfItsSinglePrecision) {
  const TriangleSoup dome = hotblade::surface::dome(900, 300, 12);
  const DesignSurface read = read_bytes_as(to_binary_stl(dome), "dome.stl");
  ASSERT_THAT(read.mesh.vertices(), SizeIs(dome.vertices.size()));
  ASSERT_THAT(read.mesh.triangles(), SizeIs(dome.triangles.size()));
  for (std::size_t f = 0; f < dome.triangles.size(); ++f) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector3d& there =
          read.mesh.vertices()[static_cast<std::size_t>(read.mesh.triangles()[f][k])];
      const Eigen::Vector3d& given = dome.vertices[static_cast<std::size_t>(dome.triangles[f][k])];
      for (int axis = 0; axis < 3; ++axis)
        EXPECT_EQ(there[axis], static_cast<double>(static_cast<float>(given[axis])));
    }
  }
  EXPECT_EQ(read.format, FileFormat::kStl);
  EXPECT_THAT(read.health.warnings, IsEmpty());
}

TEST(Stl, AMeshComesBackFromTextAsItIsFromObj) {
  const TriangleSoup dome = hotblade::surface::dome(900, 300, 12);
  const DesignSurface from_stl = read_bytes_as(to_text_stl(dome), "dome.stl"),
                      from_obj = read_text(to_obj(dome));
  ASSERT_THAT(from_stl.mesh.triangles(), SizeIs(from_obj.mesh.triangles().size()));
  for (std::size_t f = 0; f < from_obj.mesh.triangles().size(); ++f) {
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(from_stl.mesh.vertices()[static_cast<std::size_t>(from_stl.mesh.triangles()[f][k])],
                from_obj.mesh.vertices()[static_cast<std::size_t>(from_obj.mesh.triangles()[f][k])]);
    }
  }
}

TEST(Stl, BinaryIsToldBySizeAndNotByItsFirstWord) {
  EXPECT_THAT(
      read_bytes_as(binary_stl(kSquare, 2, "solid panel\nfacet normal 0 0 1\n"), "a.stl").mesh.triangles(),
      SizeIs(2));
  EXPECT_THAT(read_bytes_as(binary_stl(kSquare, 2, "made by a scanner"), "a").mesh.triangles(), SizeIs(2));
}

TEST(Stl, ASolidIsAGroup) {
  const TriangleSoup one = grid(1, 1, [](double s, double t) { return Eigen::Vector3d(s, t, 0); });
  const TriangleSoup two = grid(2, 2, [](double s, double t) { return Eigen::Vector3d(9 + s, t, 0); });
  const std::string text = to_text_stl(one, "left panel") + "\n" + to_text_stl(two, "right");
  EXPECT_THAT(read_bytes_as(text, "a.stl").mesh.triangles(), SizeIs(10));
  ReadOptions options{"mm", 'z', "left panel"};
  EXPECT_THAT(read_bytes_as(text, "a.stl", options).mesh.triangles(), SizeIs(2));
  options.group = "middle";
  EXPECT_THAT(refusal_of(text, "a.stl", options), HasSubstr("choose one of left panel, right"));
}

TEST(Stl, NormalsAndAttributesAreToldAndNotUsed) {
  const std::string facets = stl_facet(kA, kB, kC, 0, -1) + stl_facet(kA, kC, kD, 31);
  EXPECT_THAT(read_bytes_as(binary_stl(facets, 2), "a.stl").health.warnings,
              ElementsAre(AllOf(HasSubstr("1 facet whose normal looks the other way"),
                                HasSubstr("the first in facet 1")),
                          AllOf(HasSubstr("1 facet has attribute bytes"), HasSubstr("facet 2"))));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(read_bytes_as(binary_stl(stl_facet(kA, kB, kC, 0, nan), 1), "a.stl").health.warnings,
              ElementsAre(HasSubstr("1 facet whose normal is no finite number")));
}

TEST(Stl, CapitalsAndAnyLayoutOfLinesAreTaken) {
  const DesignSurface design = read_bytes_as(
      "solid\r\nFACET NORMAL 0 0 1.#IND\r\nOUTER LOOP VERTEX 0 0 0\r\nVERTEX +1e1 0 0 VERTEX 0 .5e1 0\r\n"
      "ENDLOOP ENDFACET ENDSOLID",
      "a.stl");
  ASSERT_THAT(design.mesh.vertices(), SizeIs(3));
  EXPECT_EQ(design.mesh.vertices()[2], Eigen::Vector3d(0, 5, 0));
}

TEST(Stl, CoarseSinglePrecisionIsWarnedOf) {
  const Eigen::Vector3f far(1e6F, 0, 0);  // 0.0625 mm between numbers
  ReadOptions options{"mm", 'z'};
  const std::string bytes = binary_stl(stl_facet(kA + far, kB + far, kC + far), 1);
  options.resolution_mm = 0.05;
  EXPECT_THAT(read_bytes_as(bytes, "a.stl", options).health.warnings,
              ElementsAre(HasSubstr("0.062 mm apart")));
  options.resolution_mm = 0.1;
  EXPECT_THAT(read_bytes_as(bytes, "a.stl", options).health.warnings, IsEmpty());
}

const std::string kFacet =
    "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";

TEST(Stl, WhatIsWrongInTextIsToldWithItsLine) {
  const auto wrong = [](const std::string& from, const std::string& to) {
    std::string text = "solid a\n" + kFacet + "endsolid a\n";
    text.replace(text.find(from), from.size(), to);
    return refusal_of(text, "a.stl");
  };
  EXPECT_THAT(wrong("vertex 1 0 0", "vertex 1 abc 0"), HasSubstr("a.stl:5: not a number ('abc')"));
  EXPECT_THAT(wrong("vertex 1 0 0", "vertex 1 0,5 0"), HasSubstr("decimal point, not a comma"));
  EXPECT_THAT(wrong("vertex 1 0 0", "vertex 1 nan 0"),
              HasSubstr("a.stl:5: coordinate is not a finite number"));
  EXPECT_THAT(wrong("vertex 1 0 0", "vertex 1e999 0 0"), HasSubstr("not a finite number"));
  EXPECT_THAT(wrong("vertex 1 0 0", "vertex 1e8 0 0"), HasSubstr("too large (1e8, limit 1e7 mm"));
  EXPECT_THAT(wrong("vertex 0 1 0\n", ""),
              HasSubstr("a.stl:6: not the word that is due ('endloop', vertex)"));
  EXPECT_THAT(wrong("vertex 0 1 0\n", "vertex 0 1 0\nvertex 2 2 0\n"), HasSubstr("a.stl:7: not the word"));
  EXPECT_THAT(wrong("endsolid a\n", ""), AllOf(HasSubstr("the text ends"), HasSubstr("(1 facet so far)")));
  EXPECT_THAT(wrong("endsolid a\n", "endsolid a\nmore\n"),
              HasSubstr("a.stl:10: not the word that is due ('more', solid)"));
  EXPECT_THAT(refusal_of("solid a\nendsolid a\n", "a.stl"), HasSubstr("a.stl:2: no facets"));
}

TEST(Stl, WhatIsWrongInBinaryIsToldWithItsFacetAndByte) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  const auto facets = [](float x) { return kSquare + stl_facet(kA, kB, Eigen::Vector3f(x, 1, 0)); };
  EXPECT_THAT(refusal_of(binary_stl(facets(nan), 3), "a.stl"),
              AllOf(HasSubstr("a.stl: facet 3 (byte 220): "), HasSubstr("not a finite number")));
  EXPECT_THAT(refusal_of(binary_stl(facets(inf), 3), "a.stl"), HasSubstr("not a finite number ('inf')"));
  EXPECT_THAT(refusal_of(binary_stl(facets(1e8F), 3), "a.stl"),
              HasSubstr("too large (100000000, limit 1e7 mm"));
  EXPECT_THAT(refusal_of(binary_stl(kSquare, 3, "scan"), "a.stl"),
              AllOf(HasSubstr("a.stl: byte 80: "), HasSubstr("(184 bytes, 3 facets make 234)")));
  EXPECT_THAT(refusal_of(binary_stl(kSquare, 0xffffffffU, "scan"), "a.stl"), HasSubstr("4294967295 facets"));
  EXPECT_THAT(refusal_of(binary_stl("", 0), "a.stl"), HasSubstr("no facets"));
  EXPECT_THAT(refusal_of("", "a.stl"), HasSubstr("0 bytes"));
}

// Facets are read side by side: the first that is wrong is told, and what is odd is counted over all of them.
TEST(Stl, OfManyFacetsTheFirstOneThatIsWrongIsTold) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  constexpr std::uint32_t kFacets = 200'000;
  const std::string sound = stl_facet(kA, kB, Eigen::Vector3f(0, 1, 0)),
                    wrong = stl_facet(kA, kB, Eigen::Vector3f(nan, 1, 0)), odd = [&] {
                      std::string bytes = sound;
                      bytes.back() = 1;
                      return bytes;
                    }();
  std::string facets;
  for (std::size_t f = 0; f < kFacets; ++f) facets += sound;
  const auto put = [&](std::size_t f, const std::string& facet) { facets.replace(50 * f, 50, facet); };
  put(70'000, odd);
  put(199'999, odd);
  EXPECT_THAT(read_bytes_as(binary_stl(facets, kFacets), "a.stl").health.warnings,
              ElementsAre(AllOf(HasSubstr("2 facets have attribute bytes"), HasSubstr("facet 70001"))));
  put(150'000, wrong);
  put(90'000, wrong);
  put(90'001, wrong);
  EXPECT_THAT(refusal_of(binary_stl(facets, kFacets), "a.stl"),
              HasSubstr("a.stl: facet 90001 (byte 4500120): "));
}

TEST(Stl, CornersOfManyFacetsAreJoinedNearAndFar) {
  // Squares side by side, every other column after all the rest: corners that are equal stand beside each
  // other in a square, a few columns on, and in another of the blocks that are looked through at once.
  constexpr int kColumns = 200, kRows = 100, kSquares = kColumns * kRows;
  std::string facets;
  for (const int first : {0, 1}) {
    for (int i = first; i < kColumns; i += 2) {
      for (int j = 0; j < kRows; ++j) {
        const Eigen::Vector3f at(static_cast<float>(100 * i), static_cast<float>(100 * j), 0);
        facets += stl_facet(kA + at, kB + at, kC + at) + stl_facet(kA + at, kC + at, kD + at);
      }
    }
  }
  const DesignSurface read = read_bytes_as(binary_stl(facets, 2 * kSquares), "a.stl");
  EXPECT_EQ(read.health.file_vertices, 6U * kSquares);
  EXPECT_THAT(read.mesh.vertices(), SizeIs((kColumns + 1U) * (kRows + 1)));
  EXPECT_THAT(read.mesh.triangles(), SizeIs(2U * kSquares));
  EXPECT_EQ(read.health.area_mm2, 1e4 * kSquares);
  EXPECT_THAT(read.health.repairs, ElementsAre(HasSubstr("merged 99699 vertices")));
}

TEST(Stl, CutAnywhereItIsRefused) {
  const std::string text = "solid a\n" + kFacet + "endsolid", binary = binary_stl(kSquare, 2, "scan");
  for (std::size_t n = 0; n < text.size(); ++n)
    EXPECT_THAT(refusal_of(text.substr(0, n), "a.stl"), HasSubstr("a.stl")) << n;
  for (std::size_t n = 0; n < binary.size(); ++n)
    EXPECT_THAT(refusal_of(binary.substr(0, n), "a.stl"), HasSubstr("bytes")) << n;
}

}  // namespace
}  // namespace hotblade::surface
