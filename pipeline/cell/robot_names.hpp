// Names in robot programs: what RAPID and KRL take, what the exports make (pipeline/export), and what is
// neither's to give away. Controllers, and FAT file systems, count letters without their case.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace hotblade::pipeline {

enum class RobotLanguage { kRapid, kKrl };

// Of an arm, in bytes: KRL takes 24 letters of a routine, of which hb_S2000_ are nine.
inline constexpr std::size_t kLongestArmId = 15;

// Returns an arm's id as modules, routines and their files are named by it: letters, digits and _.
[[nodiscard]] std::string robot_name_of(const std::string& arm_id);

// Returns whether two names are one and the same to a controller.
[[nodiscard]] bool same_robot_name(std::string_view a, std::string_view b);

// Returns why a cell cannot call anything so, as it follows the name: "is no name in RAPID: letters, digits
// and _, 32 at most". Empty: it can.
[[nodiscard]] std::string robot_name_fault(RobotLanguage language, std::string_view name);

}  // namespace hotblade::pipeline
