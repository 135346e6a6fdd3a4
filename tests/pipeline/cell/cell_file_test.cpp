// Cells of two arms as TOML: read, refused with the line, written back.
#include "pipeline/cell/cell_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "pipeline/settings/error.hpp"
#include "tests/paths.hpp"
#include "tests/pipeline/temporary_directory.hpp"

namespace hotblade::pipeline {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

std::string text_of(const std::string& name) {
  std::ifstream in(hotblade::testing::source_dir() + "/samples/cells/" + name + ".toml");
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

TEST(CellFile, TheProgramBringsTwoCells) {
  EXPECT_THAT(embedded_cells(), ElementsAre("two_irb4600", "two_kr50"));
  const robot::Cell abb = read_cell("two_irb4600"), kuka = read_cell("two_kr50");
  EXPECT_EQ(abb.name, "two IRB 4600");
  ASSERT_THAT(abb.arms, SizeIs(2));
  EXPECT_EQ(abb.arms[1].base.p, Eigen::Vector3d(2100, 0, 0));
  EXPECT_NEAR(abb.arms[1].base.q.z(), 1, 1e-15);
  EXPECT_EQ(kuka.arms[0].acceleration_rad_s2[1], 0.7726);
  EXPECT_DOUBLE_EQ(kuka.arms[0].jerk_rad_s3[1], 7.726);
  EXPECT_THAT(warnings(kuka), IsEmpty());
  EXPECT_THAT(warnings(abb), SizeIs(2)) << "accelerations are assumed";
}

TEST(CellFile, TheEmbeddedCellIsTheSample) {
  for (const std::string& name : embedded_cells()) {
    const robot::Cell cell = parse_cell(text_of(name), name, {});
    EXPECT_EQ(to_toml(cell), to_toml(read_cell(name)));
  }
}

TEST(CellFile, IsWrittenAsItIsReadBack) {
  const std::string fence = R"(
[[obstacle]]
id = "fence \"north\""
size_mm = [50, 4000, 2000]
at = { p = [-900, 1.5, 1000], yaw_deg = 33 }
)";
  for (const std::string& name : embedded_cells()) {
    std::string text = text_of(name) + fence;
    text.replace(text.find("yaw_deg = 180"), 13, "yaw_deg = 171.3");
    text.replace(text.find("y = [0, 1, 0]"), 13, "y = [0.6, 0.8, 0]");
    text.replace(text.find("speed_share"), 0, "max_deg = [90, 50, 60, 170, 100, 200]\n");
    const robot::Cell cell = parse_cell(text, name, {});
    const std::string written = to_toml(cell);
    EXPECT_EQ(to_toml(parse_cell(written, name, {})), written);
    EXPECT_EQ(parse_cell(written, name, {}).arms[1].base.q.coeffs(), cell.arms[1].base.q.coeffs());
    EXPECT_EQ(parse_cell(written, name, {}).arms[0].acceleration_assumed, cell.arms[0].acceleration_assumed);
    EXPECT_NEAR(cell.arms[0].model.arm.joints()[2].max_rad, 60 * robot::kDegree_rad, 1e-15);
  }
}

TEST(CellFile, ReadsTheArmBesideItFirst) {
  testing::TemporaryDirectory folder;
  std::filesystem::create_directories(folder / "arms/abb_irb4600_40_255");
  std::filesystem::copy(hotblade::testing::source_dir() + "/data/arms/kuka_kr50_r2500/arm.urdf",
                        folder / "arms/abb_irb4600_40_255/arm.urdf");
  std::ofstream(folder / "cell.toml") << text_of("two_irb4600");
  EXPECT_EQ(read_cell((folder / "cell.toml").string()).arms[0].model.arm.name(), "kuka_kr50_r2500");
}

struct Broken {
  std::string name, from, to, line_at, says;
};
class BrokenCell : public ::testing::TestWithParam<Broken> {};

TEST_P(BrokenCell, RefusesWithTheLine) {
  const Broken& broken = GetParam();
  std::string text = text_of("two_irb4600");
  const auto at = text.find(broken.from);
  ASSERT_NE(at, std::string::npos) << broken.from;
  text.replace(at, broken.from.size(), broken.to);
  const auto shown = text.find(broken.line_at);
  ASSERT_NE(shown, std::string::npos) << broken.line_at;
  const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(shown), '\n');
  try {
    (void)parse_cell(text, "two.toml", {});
    FAIL() << "it was taken";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind, ErrorKind::kBadSettings);
    EXPECT_TRUE(std::string(error.what()).starts_with("two.toml:" + std::to_string(line) + ": "))
        << error.what();
    EXPECT_THAT(error.what(), HasSubstr(broken.says));
  }
}

INSTANTIATE_TEST_SUITE_P(
    CellFile, BrokenCell,
    ::testing::Values(
        Broken{"no_toml", "[cell]", "[cell", "[cell", "two.toml:2"},
        Broken{"no_name", "name = \"two IRB 4600\"", "", "[cell]", "cell: needs a name"},
        Broken{"unknown_key", "raise_mm", "rise_mm", "rise_mm",
               "cell.rise_mm: unknown key: did you mean raise_mm?"},
        Broken{"unknown_section", "[table]", "[tabel]", "[tabel]", "tabel: unknown key: did you mean table?"},
        Broken{"unknown_place", "\"raise\"", "\"lift\"", "\"lift\"", "must be fixed, raise or search"},
        Broken{"range_turned", "[0, 400]", "[400, 0]", "[400, 0]", "larger than the second"},
        Broken{"two_numbers", "p = [-2100, 0, 0]", "p = [-2100, 0]", "p = [-2100, 0]",
               "arm[0].base.p: must be 3 numbers"},
        Broken{"text_for_number", "p = [-2100, 0, 0]", "p = [-2100, 0, \"0\"]", "p = [-2100",
               "arm[0].base.p"},
        Broken{"yaw_and_q", "yaw_deg = 180 }", "yaw_deg = 180, q = [1, 0, 0, 0] }", "q = [1",
               "must stand alone"},
        Broken{"q_of_two", "yaw_deg = 180 }", "q = [1, 1, 0, 0] }", "q = [1, 1", "must be 1: [w, x, y, z]"},
        Broken{"same_id", "\"R2\"", "\"R1\" #", "\"R1\" #", "both arms have the id"},
        Broken{"id_by_case", "\"R2\"", "\"r1\"", "\"r1\"", "named R1 and r1, the same to a controller"},
        Broken{"id_long", "\"R2\"", "\"aaaaaaaaaaaaaaaa\"", "aaaa",
               "arm[1].id: 16 bytes (limit 15): robot programs are named by it"},
        Broken{"same_task", "\"T_ROB2\"", "\"t_rob1\"", "[arm.rapid]\ntask = \"t_rob1\"",
               "both arms have the task \"T_ROB1\""},
        Broken{"tool_is_wobj", "tool = \"hb_clamp\"", "tool = \"HB_cell\"", "wobj",
               "arm[0].rapid.wobj: \"hb_cell\" is the name of tool as well"},
        Broken{"tool_is_heat", "tool = \"hb_clamp\"", "tool = \"hb_heat\"", "hb_heat",
               "arm[0].rapid.tool: \"hb_heat\" is the name of heat as well"},
        Broken{"tool_is_a_routine", "tool = \"hb_clamp\"", "tool = \"Hb_Main\"", "Hb_Main",
               "what exported programs call something of their own"},
        Broken{"tool_is_a_strip", "tool = \"hb_clamp\"", "tool = \"hb_S001\"", "hb_S001",
               "what exported programs call something of their own"},
        Broken{"tool_is_a_word", "tool = \"hb_clamp\"", "tool = \"IF\"", "IF", "is a word of RAPID"},
        Broken{"tool_is_brought", "tool = \"hb_clamp\"", "tool = \"tool0\"", "tool0",
               "what a controller calls something of its own"},
        Broken{"heat_is_ready", "tool = \"hb_clamp\"",
               "tool = \"hb_clamp\"\n[arm.krl]\nheat = \"hb_ready_out\"", "hb_ready_out",
               "arm[0].krl.heat: \"hb_ready_out\" is the name of ready_out as well"},
        Broken{"ready_in_is_out", "tool = \"hb_clamp\"",
               "tool = \"hb_clamp\"\n[arm.krl]\nready_in = \"HB_READY_OUT\"", "HB_READY_OUT",
               "arm[0].krl.ready_in: \"HB_READY_OUT\" is the name of ready_out as well"},
        Broken{"heat_is_a_word", "tool = \"hb_clamp\"", "tool = \"hb_clamp\"\n[arm.krl]\nheat = \"FALSE\"",
               "FALSE", "is a word of KRL"},
        Broken{"share_over_one", "speed_share = 0.8", "speed_share = 80", "= 80",
               "arm[0].speed_share: 80, must be 0.01 to 1"},
        Broken{"wider_than_the_model", "speed_share = 0.8", "max_deg = [180, 150, 90, 400, 120, 400]",
               "max_deg", "max_deg: 90 of joint_3: the model has 75"},
        Broken{"empty_limits", "speed_share = 0.8", "min_deg = [-180, -90, -180, -400, 120, -400]", "min_deg",
               "joint_5: least not below largest"},
        Broken{"five_accelerations", "speed_share = 0.8", "acceleration_rad_s2 = [1, 1, 1, 1, 1]",
               "acceleration_rad_s2", "must be 6 numbers"},
        Broken{"long_x", "x = [0, 0, 1]", "x = [0, 1, 1]", "x = [0, 1, 1]",
               "arm[0].tool.jaw.x: must have length 1"},
        Broken{"y_along_x", "y = [0, 1, 0]", "y = [0, 0, 1]", "y = [0, 0, 1]", "must be square to x"},
        Broken{"box_without_size", "{ size_mm = [40, 40, 235], centre", "{ centre", "{ centre",
               "needs size_mm or mesh"},
        Broken{"flag", "flip = true", "flip = 1", "flip = 1", "must be true or false"},
        Broken{"flat_table", "[1800, 1800, 50]", "[1800, 1800, 0]", "[1800, 1800, 0]",
               "table.size_mm: 0, must be"},
        Broken{"krl_name", "tool = \"hb_clamp\"", "tool = \"hb_clamp\"\n[arm.krl]\nready_in = \"1x\"", "1x",
               "is no name in KRL"},
        Broken{"rapid_name", "tool = \"hb_clamp\"", "tool = \"hb clamp\"", "hb clamp", "is no name in RAPID"},
        Broken{"obstacle_nowhere", "[plinth]", "[[obstacle]]\nid = \"a\"\nsize_mm = [1, 1, 1]\n[plinth]",
               "[[obstacle]]", "obstacle[0]: needs at"}),
    [](const auto& instance) { return instance.param.name; });

TEST(CellFile, WarnsOfWhatIsNotThere) {
  std::string text = text_of("two_kr50");
  text.replace(text.find("[table]"), std::string("[table]\nsize_mm = [1800, 1800, 50]").size(), "");
  const std::vector<std::string> lines = warnings(parse_cell(text, "two.toml", {}));
  ASSERT_THAT(lines, SizeIs(1));
  EXPECT_THAT(lines[0], HasSubstr("no table"));
}

TEST(CellFile, SaysWhatIsMissing) {
  const auto kind_of = [](const std::string& text) {
    try {
      (void)parse_cell(text, "two.toml", {});
    } catch (const Error& error) {
      return std::pair(error.kind, std::string(error.what()));
    }
    return std::pair(ErrorKind::kInterrupted, std::string("it was taken"));
  };
  std::string text = text_of("two_irb4600");
  text.replace(text.find("arms/abb_irb4600_40_255"), 23, "arms/not_there");
  EXPECT_EQ(kind_of(text).first, ErrorKind::kFile);
  EXPECT_THAT(kind_of(text).second, HasSubstr("two.toml:9: arm[0].model: \"arms/not_there/arm.urdf\""));
  testing::TemporaryDirectory folder;
  std::ofstream(folder / "arm.urdf") << "<robot name='x'>\n<link/></robot>";
  text = text_of("two_irb4600");
  text.replace(text.find("arms/abb_irb4600_40_255/arm.urdf"), 32, (folder / "arm.urdf").string());
  EXPECT_EQ(kind_of(text).first, ErrorKind::kBadInput);
  EXPECT_THAT(kind_of(text).second, HasSubstr("arm.urdf:2: <link> needs the attribute name"));
  EXPECT_THROW((void)read_cell("two_irb460"), Error);
}

// "R 1" and "R_1" are one to whoever names files and modules by them.
TEST(CellFile, TakesNoIdsThatRobotProgramsCannotTellApart) {
  std::string text = text_of("two_irb4600");
  text.replace(text.find("\"R1\""), 4, "\"R 1\"");
  text.replace(text.find("\"R2\""), 4, "\"R_1\"");
  try {
    (void)parse_cell(text, "two.toml", {});
    FAIL() << "they were taken";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind, ErrorKind::kBadSettings);
    EXPECT_THAT(error.what(), HasSubstr("arm[1].id: \"R_1\" beside \"R 1\""));
  }
}

// A device has no end.
TEST(CellFile, IsReadToALimit) {
  const auto refusal = [](const std::string& file) {
    try {
      (void)read_cell(file);
    } catch (const Error& error) {
      return std::pair(error.kind, std::string(error.what()));
    }
    return std::pair(ErrorKind::kInterrupted, std::string("it was taken"));
  };
  EXPECT_EQ(refusal("/dev/zero").first, ErrorKind::kBadSettings);
  EXPECT_THAT(refusal("/dev/zero").second, HasSubstr("/dev/zero: longer than 4000000 bytes"));
  testing::TemporaryDirectory folder;
  std::string text = text_of("two_irb4600");
  text.replace(text.find("arms/abb_irb4600_40_255/arm.urdf"), 32, "/dev/zero");
  std::ofstream(folder / "cell.toml") << text;
  EXPECT_EQ(refusal((folder / "cell.toml").string()).first, ErrorKind::kBadInput);
  EXPECT_THAT(refusal((folder / "cell.toml").string()).second, HasSubstr("longer than 4000000 bytes"));
  text = text_of("two_irb4600");
  text.replace(text.find("size_mm = [40"), std::string("size_mm = [40, 40, 235]").size(),
               "mesh = \"/dev/zero\"");
  std::ofstream(folder / "cell.toml") << text;
  EXPECT_EQ(refusal((folder / "cell.toml").string()).first, ErrorKind::kBadInput);
  EXPECT_THAT(refusal((folder / "cell.toml").string()).second, HasSubstr("longer than 50000084 bytes"));
}

}  // namespace
}  // namespace hotblade::pipeline
