// The strips of a report: one list of columns says everything that stands about a strip, in the order it is
// read. A new figure is a new line in strip_columns().
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "pipeline/plan/plan.hpp"
#include "pipeline/report/words.hpp"

namespace hotblade::pipeline {

// The facts that one row is made from.
struct StripRow {
  const StripFacts& facts;
  const Strip& strip;
  const robot::Blade& blade;
  std::size_t over = 0;  // limits: refusals that name the strip, and the bound of its own deviation
};

// The table that a column stands in: what is cut, or what the blade and the clamps bear.
enum class StripTable { kCut, kBlade };

struct StripColumn {
  StripTable table;
  const char* name;
  const char* unit;  // empty: none
  std::string (*cell)(const StripRow&);
};

// All columns of both tables, in the order they are read.
[[nodiscard]] std::span<const StripColumn> strip_columns();

// Both tables as HTML; a strip that is over a limit stands out. The text is empty when there are no strips.
[[nodiscard]] std::string strips_section(const PlanResult& result, const Words& w);

// A duration in words: "1 min 35 s" for 95.
[[nodiscard]] std::string duration(double seconds);

}  // namespace hotblade::pipeline
