#include "pipeline/cli/cell_word.hpp"

#include <vector>

#include "pipeline/cell/cell_file.hpp"
#include "pipeline/cli/shell_word.hpp"
#include "pipeline/plan/arms/arms.hpp"
#include "pipeline/program/design_file.hpp"
#include "pipeline/settings/error.hpp"

namespace hotblade::pipeline {

namespace fs = std::filesystem;

namespace {

bool is_cell(const std::string& file_or_name, const std::string& sha256) {
  try {
    return cell_sha256(read_cell(file_or_name)) == sha256;
  } catch (const Error&) {
    return false;  // changed or gone since
  }
}

}  // namespace

fs::path kept_cell(const std::string& file_or_name) {
  std::error_code ignored;
  return fs::exists(file_or_name, ignored) ? fs::absolute(file_or_name) : fs::path(file_or_name);
}

std::string cell_word(const fs::path& program_file, const Program& program) {
  std::vector<std::string> known = embedded_cells();
  if (const auto given = cell_given(program_file)) known.push_back(given->string());
  for (const std::string& one : known)
    if (is_cell(one, program.cell->sha256)) return "--cell " + shell_word(one);
  return "--cell with the file of the cell \"" + program.cell->name + "\"";
}

}  // namespace hotblade::pipeline
