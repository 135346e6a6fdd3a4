#include "pipeline/batch/measured.hpp"

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <system_error>

#include "pipeline/batch/result.hpp"
#include "pipeline/settings/error.hpp"

namespace hotblade::pipeline::batch {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostMeasured = 1000;

std::vector<fs::path> entries_in_order(const fs::path& directory) {
  std::vector<fs::path> entries;
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(directory, ignored)) {
    if (!entry.path().filename().string().starts_with(".")) entries.push_back(entry.path());
  }
  std::sort(entries.begin(), entries.end());
  return entries;
}

}  // namespace

double median_of(std::vector<double> values) {
  if (values.empty()) throw std::logic_error("median_of: no values");
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::optional<double> measured_plan_s(const BatchDirectory& directory) {
  std::vector<double> seconds;
  for (const fs::path& shelf : entries_in_order(directory.results())) {
    for (const fs::path& result : entries_in_order(shelf)) {
      if (seconds.size() == kMostMeasured) return median_of(std::move(seconds));
      try {
        seconds.push_back(read_result(result).seconds);
      } catch (const Error&) {
        continue;  // `gather` says which, where it is asked for
      }
    }
  }
  if (seconds.empty()) return std::nullopt;
  return median_of(std::move(seconds));
}

}  // namespace hotblade::pipeline::batch
