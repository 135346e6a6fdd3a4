// cell.toml: the cell of two arms that a plan is held against (docs/cell.md).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "robot/arm/cell.hpp"

namespace hotblade::pipeline {

// Returns the cell of a text. Files that it names are looked for beside `folder`, and arms then among those
// that the program brings. Throws Error: kBadSettings with `name:line: key: what` where the text is wrong,
// kBadInput where an arm's description or a mesh is, kFile where one is not there.
[[nodiscard]] robot::Cell parse_cell(const std::string& text, const std::string& name,
                                     const std::filesystem::path& folder);

// Returns the cell of a file, or of a name of `embedded_cells()` where there is no such file. Throws as
// above, and kFile where there is neither.
[[nodiscard]] robot::Cell read_cell(const std::string& file_or_name);

// Returns the cell as TOML that reads back to the same cell, every value written out.
[[nodiscard]] std::string to_toml(const robot::Cell& cell);

// Returns what a person should know of the cell: accelerations that are assumed, a table that is missing.
[[nodiscard]] std::vector<std::string> warnings(const robot::Cell& cell);

// Returns the names of the cells that the program brings, the default first.
[[nodiscard]] std::vector<std::string> embedded_cells();

}  // namespace hotblade::pipeline
