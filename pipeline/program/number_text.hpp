// The texts of a program's numbers. Nearly all of them are rounded to 8 or 12 decimals
// (pipeline/plan/motion/round_poses.hpp), and a job has tens of millions.
#pragma once

namespace hotblade::pipeline {

// Room enough for the text of any finite number.
inline constexpr int kNumberText = 32;

// Writes what std::to_chars(to, to + kNumberText, value) does, the shortest text that reads back as the same
// number, and returns its end. `value` is finite.
char* write_number(char* to, double value);
// The same of a single-precision number.
char* write_number(char* to, float value);

}  // namespace hotblade::pipeline
