// A new SQLite file that tables are written to.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "pipeline/batch/plan_facts.hpp"

namespace hotblade::pipeline::batch {

class Database {
 public:
  // Makes a new file; one that is there is replaced. Throws, as all below, Error (kFile).
  explicit Database(const std::filesystem::path& file);
  ~Database();
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  void execute(const std::string& statement);

  // Makes a table, and what inserts its rows.
  class Table;
  [[nodiscard]] Table table(const std::string& name, const std::vector<std::string>& columns);

  // Ends the writing: the file is whole afterwards.
  void close();

 private:
  struct Handle;
  std::unique_ptr<Handle> handle_;
};

class Database::Table {
 public:
  ~Table();
  Table(Table&&) noexcept;
  Table& operator=(Table&&) = delete;
  void add(const Cells& cells);

 private:
  friend class Database;
  struct Statement;
  explicit Table(std::unique_ptr<Statement> statement);
  std::unique_ptr<Statement> statement_;
};

// Returns a name in quotes, as SQL takes it.
[[nodiscard]] std::string quoted_name(const std::string& name);

}  // namespace hotblade::pipeline::batch
