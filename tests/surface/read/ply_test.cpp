#include "surface/read/ply.hpp"

#include <gmock/gmock.h>

#include "surface/read/ply_header.hpp"
#include "tests/surface/read/mesh_files.hpp"

namespace hotblade::surface {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

const std::string kFaces = "0 3 0 1 2\n0 3 0 2 3\n", kEdge = "3 2 1 2\n";

TEST(Ply, TextAndBothByteOrdersSayTheSame) {
  for (const std::string& bytes : {text_ply(kPlySquare + kFaces + kEdge), binary_ply(std::endian::little),
                                   binary_ply(std::endian::big), binary_ply(std::endian::big, "\r\n")}) {
    const DesignSurface design = read_bytes_as(bytes, "square.ply");
    ASSERT_THAT(design.mesh.vertices(), SizeIs(4));
    EXPECT_EQ(design.mesh.vertices()[2], Eigen::Vector3d(100, 100, 0));
    EXPECT_THAT(design.mesh.triangles(), ElementsAre(std::array{0, 1, 2}, std::array{0, 2, 3}));
    EXPECT_EQ(design.format, FileFormat::kPly);
  }
}

TEST(Ply, EveryTypeOfNumberIsRead) {
  const std::string types[] = {"char", "uint8", "int16", "ushort", "int32", "uint"};
  for (const std::string& count : types) {
    for (const std::string& item : types) {
      std::string bytes =
          "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty float z\nproperty float x\n"
          "property float32 y\nelement face 1\nproperty list " +
          count + " " + item + " vertex_index\nend_header\n";
      for (const float value : {1.F, 0.F, 0.F, 1.F, 5.F, 0.F, 1.F, 0.F, 5.F})
        bytes += number_bytes(value, std::endian::big);
      const auto add = [&](const std::string& type, int value) {
        const std::size_t size = type.find("32") != std::string::npos || type == "uint"     ? 4
                                 : type.find("16") != std::string::npos || type == "ushort" ? 2
                                                                                            : 1;
        bytes += std::string(size - 1, '\0') + static_cast<char>(value);
      };
      add(count, 3);
      for (const int index : {0, 1, 2}) add(item, index);
      const DesignSurface design = read_bytes_as(bytes, "a.ply");
      ASSERT_THAT(design.mesh.vertices(), SizeIs(3)) << count << item;
      EXPECT_EQ(design.mesh.vertices()[1], Eigen::Vector3d(5, 0, 1));
    }
  }
}

TEST(Ply, PolygonsStayPolygonsAndFacesMayComeFirst) {
  const DesignSurface design = read_bytes_as(
      "ply\r\nformat ascii 1.0\r\nobj_info a scan\r\nelement face 1\r\nproperty list uchar uint "
      "vertex_indices\r\n"
      "element vertex 4\r\nproperty float x\r\nproperty float y\r\nproperty float z\r\nend_header\r\n"
      "4 0 1 2 3\r\n0 0 0\r\n10 0 0\r\n10 10 0\r\n0 10 0",
      "a.ply");
  EXPECT_EQ(design.health.file_faces, 1U);
  EXPECT_THAT(design.mesh.triangles(), SizeIs(2));
}

TEST(Ply, WhatIsWrongInTheHeaderIsToldWithItsLine) {
  const auto wrong = [](const std::string& from, const std::string& to) {
    std::string text = text_ply(kPlySquare + kFaces + kEdge);
    text.replace(text.find(from), from.size(), to);
    return refusal_of(text, "a.ply");
  };
  EXPECT_THAT(wrong("ascii", "ebcdic"), HasSubstr("a.ply:2: unknown format ('ebcdic')"));
  EXPECT_THAT(wrong("1.0", "2.0"), HasSubstr("unknown version ('2.0', 1.0 is read)"));
  EXPECT_THAT(wrong("double y", "quad y"), HasSubstr("a.ply:6: unknown type ('quad')"));
  EXPECT_THAT(wrong("double y", "int y"), HasSubstr("y of vertices is neither float nor double"));
  EXPECT_THAT(wrong("double y", "double w"), HasSubstr("vertices without y"));
  EXPECT_THAT(wrong("double y", "double x"), HasSubstr("property 'x' is there twice"));
  EXPECT_THAT(wrong("vertex_indices", "corners"), HasSubstr("faces without vertex_indices"));
  EXPECT_THAT(wrong("list uchar int vertex", "list float int vertex"), HasSubstr("the length of a list"));
  EXPECT_THAT(wrong("list uchar int vertex", "list uchar float vertex"),
              HasSubstr("no list of whole numbers"));
  EXPECT_THAT(wrong("element edge", "element face"), HasSubstr("element 'face' is there twice"));
  EXPECT_THAT(wrong("element edge", "elements edge"),
              HasSubstr("not a statement of a PLY's header ('elements')"));
  EXPECT_THAT(wrong("vertex 4", "vertex four"), HasSubstr("not a number of elements ('four')"));
  EXPECT_THAT(wrong("vertex 4", "vertex -4"), HasSubstr("not a number of elements ('-4')"));
  EXPECT_THAT(wrong("vertex 4", "vertex 4 5"), HasSubstr("more in the line than belongs there ('5')"));
  EXPECT_THAT(wrong("vertex 4", "vertex 4000000000"), HasSubstr("more elements than the file has room for"));
  EXPECT_THAT(wrong("vertex 4", "vertex 99999999999999999999"), HasSubstr("not a number of elements"));
  EXPECT_THAT(wrong("vertex 4", "vertex 0"), HasSubstr("no vertices"));
  EXPECT_THAT(wrong("face 2", "face 0"), HasSubstr("no faces in the file (4 vertices)"));
  EXPECT_THAT(wrong("element face", "element tristrips"), HasSubstr("triangle strips are not read"));
}

TEST(Ply, WhatIsWrongInTextIsToldWithItsLine) {
  const auto wrong = [](const std::string& from, const std::string& to) {
    std::string body = kPlySquare + kFaces + kEdge;
    body.replace(body.find(from), from.size(), to);
    return refusal_of(text_ply(body), "a.ply");
  };
  EXPECT_THAT(wrong("100 0 0", "100 abc 0"), HasSubstr("a.ply:17: not a number ('abc')"));
  EXPECT_THAT(wrong("100 0 0", "100 nan 0"),
              HasSubstr("a.ply:17: coordinate is not a finite number ('nan')"));
  EXPECT_THAT(wrong("100 0 0", "100 0,5 0"), HasSubstr("decimal point, not a comma"));
  EXPECT_THAT(wrong("100 0 0", "1e8 0 0"), HasSubstr("too large (1e8"));
  EXPECT_THAT(wrong("100 0 0 255", "100 0 0"), HasSubstr("a.ply:17: the line ends within vertex 2 of 4"));
  EXPECT_THAT(wrong("100 0 0 255", "100 0 0 255 1"),
              HasSubstr("a.ply:17: more values than the header says ('1')"));
  EXPECT_THAT(wrong("3 0 1 2", "3 0 1 9"),
              HasSubstr("a.ply:20: vertex index out of range (9, the file has 4"));
  EXPECT_THAT(wrong("3 0 1 2", "3 0 1 -1"), HasSubstr("vertex index out of range (-1"));
  EXPECT_THAT(wrong("3 0 1 2", "3 0 1 1.5"), HasSubstr("not a whole number ('1.5')"));
  EXPECT_THAT(wrong("3 0 1 2", "2 0 1"), HasSubstr("face with too few corners (2, at least 3)"));
  EXPECT_THAT(wrong("3 0 1 2", "-3 0 1 2"), HasSubstr("a list of a length that cannot be (-3)"));
  EXPECT_THAT(wrong("3 0 1 2", "4 0 1 2"), HasSubstr("the line ends within face 1 of 2"));
  EXPECT_THAT(wrong(kEdge, ""), HasSubstr("the text ends before edge 1 of 1"));
  EXPECT_THAT(wrong(kEdge, kEdge + "0 0 0\n"),
              HasSubstr("a.ply:23: more lines than the header's elements ('0')"));
}

TEST(Ply, WhatIsWrongInBinaryIsToldWithItsElementAndByte) {
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    const std::string good = binary_ply(order);
    const std::size_t body = good.find("end_header\n") + 11, faces = body + 4 * 25;
    const auto with = [&](std::size_t at, const std::string& bytes) {
      std::string changed = good;
      changed.replace(at, bytes.size(), bytes);
      return refusal_of(changed, "a.ply");
    };
    EXPECT_THAT(with(body + 25, number_bytes(std::numeric_limits<double>::quiet_NaN(), order)),
                AllOf(HasSubstr("a.ply: vertex 2 (byte " + std::to_string(body + 25) + "): "),
                      HasSubstr("not a finite number")));
    EXPECT_THAT(with(body + 25, number_bytes(-1e300, order)), HasSubstr("too large (-1"));
    EXPECT_THAT(with(faces + 2, number_bytes(std::int32_t{4}, order)),
                HasSubstr("vertex index out of range (4"));
    EXPECT_THAT(with(faces + 2, number_bytes(std::int32_t{-1}, order)),
                HasSubstr("vertex index out of range (-1"));
    EXPECT_THAT(with(faces + 1, "\xff"),
                HasSubstr("face 1 (byte " + std::to_string(faces) + "): a list of a length"));
    EXPECT_THAT(with(good.size() - 12, number_bytes(std::int32_t{-2}, order)), HasSubstr("edge 1"));
    EXPECT_THAT(refusal_of(good + "x", "a.ply"), HasSubstr("more bytes than the header's elements (1 left)"));
  }
}

TEST(Ply, CutAnywhereItIsRefused) {
  // Without the last line end and the end of the last number a text is whole.
  const std::string text = text_ply(kPlySquare + kFaces + kEdge), binary = binary_ply(std::endian::big);
  for (std::size_t n = 4; n + 2 < text.size(); ++n)
    EXPECT_THAT(refusal_of(text.substr(0, n), "a.ply"), HasSubstr("a.ply")) << n;
  for (std::size_t n = 4; n < binary.size(); ++n)
    EXPECT_THAT(refusal_of(binary.substr(0, n), "a.ply"), HasSubstr("a.ply")) << n;
}

}  // namespace
}  // namespace hotblade::surface
