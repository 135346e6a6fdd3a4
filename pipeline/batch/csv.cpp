#include "pipeline/batch/csv.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "pipeline/batch/mapped_file.hpp"
#include "pipeline/settings/error.hpp"

namespace hotblade::pipeline::batch {
namespace {

[[noreturn]] void fail_line(const std::string& name, std::size_t line, const std::string& what) {
  throw Error(ErrorKind::kBadInput, fmt::format("{}:{}: {}", name, line, what));
}

class CsvReader {
 public:
  CsvReader(std::string_view text, const std::string& name) : text_(text), name_(name) {
    if (text_.starts_with("\xef\xbb\xbf")) text_.remove_prefix(3);
  }

  // The next row that is not an empty line; absent at the end.
  std::optional<CsvRow> next() {
    while (at_ < text_.size()) {
      CsvRow row{line_, {}};
      bool more = true;
      while (more) {
        row.cells.push_back(cell());
        more = at_ < text_.size() && text_[at_] == ',';
        if (more) ++at_;
      }
      end_line(row.line);
      if (row.cells.size() > 1 || !row.cells.front().empty()) return row;
    }
    return std::nullopt;
  }

 private:
  [[nodiscard]] bool at_line_end() const {
    return at_ == text_.size() || text_[at_] == '\n' || text_[at_] == '\r';
  }

  std::string cell() {
    if (at_ < text_.size() && text_[at_] == '"') return quoted();
    const std::size_t start = at_;
    while (!at_line_end() && text_[at_] != ',') {
      if (text_[at_] == '"')
        fail_line(name_, line_, "a quote inside a cell: quote the whole cell, and double the quotes in it");
      ++at_;
    }
    return std::string(text_.substr(start, at_ - start));
  }

  std::string quoted() {
    const std::size_t line = line_;
    std::string value;
    for (++at_; at_ < text_.size(); ++at_) {
      if (text_[at_] == '"') {
        ++at_;
        if (at_ == text_.size() || text_[at_] != '"') return value;
      }
      if (text_[at_] == '\n') ++line_;
      value += text_[at_];
    }
    fail_line(name_, line, "a quote that is not closed");
  }

  void end_line(std::size_t line) {
    if (!at_line_end()) fail_line(name_, line, "text after a closing quote: put a comma between cells");
    if (at_ < text_.size() && text_[at_] == '\r') ++at_;
    if (at_ < text_.size() && text_[at_] == '\n') ++at_;
    ++line_;
  }

  std::string_view text_;
  const std::string& name_;
  std::size_t at_ = 0, line_ = 1;
};

void check_columns(const CsvTable& table, const CsvRow& header, const std::string& name) {
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    if (table.columns[i].empty()) fail_line(name, header.line, fmt::format("column {} has no name", i + 1));
    if (table.column(table.columns[i]) < i)
      fail_line(name, header.line, fmt::format("column {} is there twice: leave one", table.columns[i]));
  }
}

}  // namespace

std::size_t CsvTable::column(std::string_view name) const {
  return static_cast<std::size_t>(std::find(columns.begin(), columns.end(), name) - columns.begin());
}

CsvTable parse_csv(std::string_view text, const std::string& name) {
  CsvReader reader(text, name);
  std::optional<CsvRow> row = reader.next();
  if (!row) fail_line(name, 1, "no columns: the first line names them");
  CsvTable table{row->cells, {}};
  check_columns(table, *row, name);
  while ((row = reader.next())) {
    if (row->cells.size() != table.columns.size()) {
      fail_line(
          name, row->line,
          fmt::format("{} cells (the first line names {} columns)", row->cells.size(), table.columns.size()));
    }
    table.rows.push_back(std::move(*row));
  }
  return table;
}

CsvTable read_csv(const std::filesystem::path& file) {
  const MappedFile mapped(file);
  return parse_csv(mapped.text(), file.string());
}

std::string csv_line(const std::vector<std::string>& cells) {
  std::string line;
  for (const std::string& cell : cells) {
    if (&cell != &cells.front()) line += ',';
    if (cell.find_first_of(",\"\r\n") == std::string::npos) {
      line += cell;
      continue;
    }
    line += '"';
    for (const char c : cell) line += c == '"' ? std::string("\"\"") : std::string(1, c);
    line += '"';
  }
  return line + '\n';
}

}  // namespace hotblade::pipeline::batch
