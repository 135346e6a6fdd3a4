// What --cell takes for the cell of a program.
#pragma once

#include <filesystem>
#include <string>

#include "pipeline/program/program.hpp"

namespace hotblade::pipeline {

// Returns a cell's file or name as it stands in run.json: one that is a file by its whole path.
[[nodiscard]] std::filesystem::path kept_cell(const std::string& file_or_name);

// Returns the words `--cell CELL` that name the cell of a program with joints, as a shell takes them: a cell
// that comes with hotblade by its name, another by the file that run.json beside the program says, where that
// is the same cell still. Where neither is found, says whose file it has to be.
[[nodiscard]] std::string cell_word(const std::filesystem::path& program_file, const Program& program);

}  // namespace hotblade::pipeline
