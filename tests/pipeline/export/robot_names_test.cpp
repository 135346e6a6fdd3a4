// What exported programs name is nothing that a cell may call its own things: read from the programs' text.
#include <gtest/gtest.h>

#include <regex>
#include <set>

#include "pipeline/cell/robot_names.hpp"
#include "pipeline/export/robot_programs.hpp"
#include "tests/pipeline/vault_program.hpp"

namespace hotblade::pipeline {
namespace {

// Every name of the programs, without what is said to people, options of instructions, components of
// structures and a controller's variables, whose names begin with $; and without those that are the cell's.
std::set<std::string> names_in(const std::vector<ExportedFile>& files, const std::set<std::string>& of_cell) {
  static const std::regex other(R"("[^"\n]*"|[!;][^\n]*|\{[^}\n]*\}|\\[A-Za-z]+|\$[A-Z]+)");
  static const std::regex word(R"([A-Za-z0-9_.]+)");
  std::set<std::string> names;
  for (const ExportedFile& file : files) {
    const std::string text = std::regex_replace(file.text, other, " ");
    for (std::sregex_iterator i(text.begin(), text.end(), word), end; i != end; ++i) {
      const std::string found = i->str();
      const bool number = std::string("0123456789.").find(found.front()) != std::string::npos;
      if (!number && !of_cell.contains(found)) names.insert(found);
    }
  }
  return names;
}

TEST(RobotNames, OfExportedProgramsAreNoneForACell) {
  const Program program = testing::vault_program({.strips = 2});
  const auto rapid =
      names_in(rapid_programs(program, nullptr, RobotMoves::kCartesian), {"hb_clamp", "hb_cell", "hb_heat"});
  EXPECT_TRUE(rapid.contains("hb_main_a"));
  EXPECT_TRUE(rapid.contains("hb_S002_1"));
  for (const std::string& name : rapid) EXPECT_NE(robot_name_fault(RobotLanguage::kRapid, name), "") << name;
  const auto krl = names_in(krl_programs(program, nullptr, RobotMoves::kCartesian),
                            {"hb_heat", "hb_ready_out", "hb_ready_in"});
  EXPECT_TRUE(krl.contains("hb_S002_b"));
  for (const std::string& name : krl) EXPECT_NE(robot_name_fault(RobotLanguage::kKrl, name), "") << name;
}

TEST(RobotNames, ThatACellHasOfItselfAreNames) {
  for (const char* name : {"T_ROB1", "T_ROB2", "hb_clamp", "hb_cell", "hb_heat"})
    EXPECT_EQ(robot_name_fault(RobotLanguage::kRapid, name), "") << name;
  for (const char* name : {"hb_heat", "hb_ready_out", "hb_ready_in", "hb_ready"})
    EXPECT_EQ(robot_name_fault(RobotLanguage::kKrl, name), "") << name;
}

// Whatever an arm may be called: the longest routine of the last strip of a job.
TEST(RobotNames, OfTheLongestIdAreNames) {
  const std::string id = robot_name_of(std::string(kLongestArmId, '-'));
  EXPECT_EQ(id, std::string(kLongestArmId, '_'));
  EXPECT_LE(("hb_S2000_" + id).size(), 24U);
  EXPECT_LE(("hb_main_" + id).size(), 24U);
  EXPECT_LE(("hb_S2000_999_" + id).size(), 32U);
}

}  // namespace
}  // namespace hotblade::pipeline
