// What the tables say of one plan, from its result.json and report.json.
#pragma once

#include <string>
#include <vector>

#include "pipeline/batch/batch.hpp"
#include "pipeline/batch/run.hpp"

namespace hotblade::pipeline::batch {

inline constexpr double kMm3PerM3 = 1e9;

// A value of a table: a number as it is written, text, or nothing.
struct Cell {
  std::string text;
  bool number = false;
};
using Cells = std::vector<Cell>;

// Rows that belong to a plan are without its job.
struct PlanFacts {
  Cells cells;                                    // of plan_columns()
  std::vector<Cells> strips, refusals, warnings;  // of their columns
  std::string picture, page;                      // from the batch's directory; empty: none
};

// The columns of a plan in results.csv, after job, panel, key and the settings that change, and those of its
// rows.
[[nodiscard]] const std::vector<std::string>& plan_columns();
[[nodiscard]] const std::vector<std::string>& strip_columns();
[[nodiscard]] const std::vector<std::string>& refusal_columns();
[[nodiscard]] const std::vector<std::string>& warning_columns();

// Return the place of a column among plan_columns() and strip_columns(); throw std::logic_error where there
// is none.
[[nodiscard]] std::size_t plan_column(const std::string& name);
[[nodiscard]] std::size_t strip_column(const std::string& name);

// Returns the facts of a key that has a result. Throws Error as read_result() does.
[[nodiscard]] PlanFacts facts_of(const BatchDirectory& directory, const std::string& key);

// Returns those of a key without a result: `failed` with how it failed last, or `missing`.
[[nodiscard]] PlanFacts facts_of_failure(const Failure* failure);

}  // namespace hotblade::pipeline::batch
