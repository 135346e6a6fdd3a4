#include "surface/read/file_format.hpp"

#include <gmock/gmock.h>

#include "tests/surface/read/mesh_files.hpp"

namespace hotblade::surface {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;

const std::string kObj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

FileFormat told(const std::string& bytes, const std::string& name) {
  return format_of(bytes, bytes.size(), name);
}

TEST(FileFormat, IsToldByBytesAndThenByName) {
  const TriangleSoup dome = hotblade::surface::dome(900, 300, 2);
  EXPECT_EQ(told(to_binary_stl(dome), "a"), FileFormat::kStl);
  EXPECT_EQ(told(to_text_stl(dome), "a.dat"), FileFormat::kStl);
  EXPECT_EQ(told(binary_ply(std::endian::big), "a"), FileFormat::kPly);
  EXPECT_EQ(told("glTF\x02", "a"), FileFormat::kGltf);
  EXPECT_EQ(told("\n {\"asset\"", "a"), FileFormat::kGltf);
  EXPECT_EQ(told(kObj, "a"), FileFormat::kObj);
  EXPECT_EQ(told(kObj, "a.STL"), FileFormat::kStl);  // which its reader refuses
  EXPECT_EQ(told("solid ground\nv 0 0 0\n", "a"), FileFormat::kObj);
  EXPECT_EQ(told("", "a.glb"), FileFormat::kGltf);
}

TEST(FileFormat, ANameThatContradictsTheBytesIsRefused) {
  EXPECT_THAT(
      refusal_of(binary_ply(std::endian::big), "a.obj"),
      HasSubstr("a.obj: the name says obj, the bytes say ply: rename the file, or say which with --format "
                "or design.format"));
  ReadOptions options{"mm", 'z'};
  options.format = FileFormat::kPly;
  EXPECT_THAT(read_bytes_as(binary_ply(std::endian::big), "a.obj", options).mesh.triangles(), SizeIs(2));
}

TEST(FileFormat, ThoseOfOtherProgramsAreRefusedWithTheLineThatConvertsThem) {
  const auto refusal = [](const std::string& bytes, const std::string& name) -> std::string {
    try {
      (void)told(bytes, name);
    } catch (const MeshError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal("ISO-10303-21;\nHEADER;\n", "d/part.STP"),
            "d/part.STP: of format STEP by its name, which is not read: convert it, as by `gmsh part.STP -2 "
            "-clmax 20 -clcurv "
            "200 -format stl -o out.stl`, or say with --format what it is");
  EXPECT_THAT(refusal("ISO-10303-21;\n", "part"), HasSubstr("of format STEP by its first bytes"));
  EXPECT_THAT(refusal("# vtk DataFile Version 3.0\n", "a.txt"), HasSubstr("`meshio convert a.txt out.obj`"));
  EXPECT_THAT(refusal("# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\n", "a.vtk"),
              HasSubstr("r = vtk.vtkPolyDataReader(); r.SetFileName('a.vtk'); w = vtk.vtkPLYWriter();"));
  EXPECT_THAT(refusal("", "a.vtk"), HasSubstr("`meshio convert a.vtk out.obj`"));
  EXPECT_THAT(
      refusal("", "a.vtp"),
      HasSubstr("of format VTP by its name, which is not read: convert it, as by `python3 -c \"import vtk; "
                "r = vtk.vtkXMLPolyDataReader(); r.SetFileName('a.vtp')"));
  EXPECT_THAT(refusal("$MeshFormat\n", "a"), HasSubstr("`meshio convert a out.obj`"));
  EXPECT_THAT(refusal("", "a.vtu"), HasSubstr("`meshio convert a.vtu out.obj`"));
  EXPECT_THAT(refusal("PK", "a.3mf"), HasSubstr("`assimp export a.3mf out.obj`"));
  EXPECT_THAT(refusal("", "a.igs"), HasSubstr("of format IGES by its name"));
  EXPECT_THAT(refusal("", "a.3dm"), HasSubstr("export it from Rhino as OBJ"));
  EXPECT_THAT(refusal("", "a.dwg"), HasSubstr("export it from AutoCAD as OBJ"));
  EXPECT_THAT(refusal("0\nSECTION\n", "a.DXF"),
              HasSubstr("`assimp export a.DXF out.obj` and read that with --up y"));
  EXPECT_EQ(refusal(kObj, "a.txt"), "");
  // What bytes or a format's own name say holds.
  EXPECT_EQ(refusal(binary_ply(std::endian::big), "a.off"), "");
}

TEST(FileFormat, AFileOnTheDiskIsToldByItsHead) {
  const ScratchFile file(to_binary_stl(dome(900, 300, 12)), "a");
  EXPECT_EQ(format_of_file(file.path()), FileFormat::kStl);
  EXPECT_EQ(format_of_file(file.folder() / "none"), std::nullopt);
}

TEST(FileFormat, WordsAndFormatsGoTogether) {
  for (const FileFormat format : {FileFormat::kObj, FileFormat::kStl, FileFormat::kPly, FileFormat::kGltf})
    EXPECT_EQ(format_named(name(format)), format);
  EXPECT_EQ(format_named("auto"), std::nullopt);
}

}  // namespace
}  // namespace hotblade::surface
