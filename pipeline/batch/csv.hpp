// Tables as comma-separated values (RFC 4180): lists of designs and of cases come in, jobs and results go
// out.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace hotblade::pipeline::batch {

struct CsvRow {
  std::size_t line = 0;  // where it starts, from 1
  std::vector<std::string> cells;
};

// A table whose first line names the columns; every row has a cell for each of them.
struct CsvTable {
  std::vector<std::string> columns;
  std::vector<CsvRow> rows;

  // Returns the place of a column; columns.size() where there is none of this name.
  [[nodiscard]] std::size_t column(std::string_view name) const;
};

// Returns the table of a text; empty lines are none. `name` is the file's name in messages. Throws Error
// (kBadInput) with the line: a quote that is not closed or stands inside a cell, a row of more or fewer cells
// than columns, a column without a name or with one that is there.
[[nodiscard]] CsvTable parse_csv(std::string_view text, const std::string& name);

// As above, of a file; throws Error (kFile) when it cannot be read.
[[nodiscard]] CsvTable read_csv(const std::filesystem::path& file);

// Returns one line with its end; cells with commas, quotes or line ends are quoted.
[[nodiscard]] std::string csv_line(const std::vector<std::string>& cells);

}  // namespace hotblade::pipeline::batch
