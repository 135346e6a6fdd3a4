#include "pipeline/batch/database.hpp"

#include <sqlite3.h>

#include <cstdlib>
#include <utility>

#include "pipeline/settings/error.hpp"

namespace hotblade::pipeline::batch {

struct Database::Handle {
  sqlite3* database = nullptr;
  std::string file;

  ~Handle() { ::sqlite3_close_v2(database); }
  [[noreturn]] void fail() const {
    throw Error(ErrorKind::kFile, file + ": cannot be written (" + ::sqlite3_errmsg(database) + ")");
  }
  void expect(int result) const {
    if (result != SQLITE_OK && result != SQLITE_DONE && result != SQLITE_ROW) fail();
  }
};

struct Database::Table::Statement {
  const Handle* handle = nullptr;
  sqlite3_stmt* insert = nullptr;
  ~Statement() { ::sqlite3_finalize(insert); }
};

Database::Database(const std::filesystem::path& file) : handle_(std::make_unique<Handle>()) {
  std::error_code ignored;
  std::filesystem::remove(file, ignored);
  handle_->file = file.string();
  handle_->expect(::sqlite3_open(file.c_str(), &handle_->database));
  // The file is put in its place when it is whole: no journal is needed.
  execute("PRAGMA journal_mode = OFF");
  execute("PRAGMA synchronous = OFF");
  execute("BEGIN");
}

Database::~Database() = default;

void Database::execute(const std::string& statement) {
  handle_->expect(::sqlite3_exec(handle_->database, statement.c_str(), nullptr, nullptr, nullptr));
}

Database::Table Database::table(const std::string& name, const std::vector<std::string>& columns) {
  std::string names, marks;
  for (const std::string& column : columns) {
    names += (names.empty() ? "" : ", ") + quoted_name(column);
    marks += marks.empty() ? "?" : ", ?";
  }
  execute("CREATE TABLE " + quoted_name(name) + " (" + names + ")");
  auto statement = std::make_unique<Table::Statement>();
  statement->handle = handle_.get();
  const std::string insert = "INSERT INTO " + quoted_name(name) + " VALUES (" + marks + ")";
  handle_->expect(::sqlite3_prepare_v2(handle_->database, insert.c_str(), -1, &statement->insert, nullptr));
  return Table(std::move(statement));
}

void Database::close() {
  execute("COMMIT");
  handle_->expect(::sqlite3_close(handle_->database));
  handle_->database = nullptr;
}

Database::Table::Table(std::unique_ptr<Statement> statement) : statement_(std::move(statement)) {}
Database::Table::Table(Table&&) noexcept = default;
Database::Table::~Table() = default;

void Database::Table::add(const Cells& cells) {
  sqlite3_stmt* insert = statement_->insert;
  int place = 0;
  for (const Cell& cell : cells) {
    ++place;
    if (cell.number && cell.text.find_first_not_of("-0123456789") == std::string::npos) {
      ::sqlite3_bind_int64(insert, place, std::strtoll(cell.text.c_str(), nullptr, 10));
    } else if (cell.number) {
      ::sqlite3_bind_double(insert, place, std::strtod(cell.text.c_str(), nullptr));
    } else if (cell.text.empty()) {
      ::sqlite3_bind_null(insert, place);
    } else {
      ::sqlite3_bind_text(insert, place, cell.text.data(), static_cast<int>(cell.text.size()),
                          SQLITE_TRANSIENT);
    }
  }
  statement_->handle->expect(::sqlite3_step(insert));
  statement_->handle->expect(::sqlite3_reset(insert));
}

std::string quoted_name(const std::string& name) {
  std::string text = "\"";
  for (const char c : name) text += c == '"' ? std::string("\"\"") : std::string(1, c);
  return text + '"';
}

}  // namespace hotblade::pipeline::batch
