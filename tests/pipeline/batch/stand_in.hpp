// A batch of small panels and a program that stands in for hotblade: what it does with a panel follows from
// the panel's height.
#pragma once

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "pipeline/batch/init.hpp"
#include "pipeline/batch/run.hpp"
#include "tests/pipeline/batch/square_panels.hpp"
#include "tests/pipeline/temporary_directory.hpp"

namespace hotblade::pipeline::batch::testing {

// Heights of panels that do not pass; all others do.
constexpr int kExits = 901, kBadInput = 903, kRefused = 904, kOver = 905, kCrosses = 906, kNoFile = 907,
              kAborts = 910, kSleeps = 911, kEats = 912, kPassesAmber = 921;

// Writes what plan would; every start is a line of `started` beside it.
inline constexpr const char* kStandIn = R"SH(#!/bin/sh
design=$2
while [ $# -gt 0 ]; do [ "$1" = -o ] && out=$2; [ "$1" = --gzip ] && packed=.gz; shift; done
read -r v x y z rest < "$design"
echo "$design" >> "$(dirname "$0")/started"
report() {
  mkdir -p "$out"
  echo "{\"verdict\": {\"color\": \"${color:-green}\"}, \"tolerance_mm\": 1.0, \"deviation_mm\": {\"max\": 0.25, \"p99\": 0.2}, \"uncut_share\": 0.0,
    \"refusals\": [$1], \"warnings\": [\"${warning:-a warning}\"], \"strips\": [{\"id\": \"S001\", \"ribs\": 4, \"poses\": 100,
    \"blade_length_mm\": 400.0, \"deviation_max_mm\": 0.25, \"duration_s\": $z, \"cut_s\": 60.0, \"stock_volume_mm3\": 2e8,
    \"foam_kept_share\": 0.5, \"stock_size_mm\": [1000.0, 500.0, 400.0], \"blade_radius_min_mm\": 700.0,
    \"margin_mm_min\": 2.5}], \"settings\": {\"blade\": {\"width_mm\": 8.0, \"thickness_mm\": 0.5}}}" > "$out/report.json"
  echo "<p>report</p>" > "$out/report.html"
}
case $z in
  901*) echo "internal error: broken" >&2; exit 1 ;;
  903*) echo "$design:5: no face has an area" >&2; exit 3 ;;
  904*) report '{"strip": "S001", "rib": "R01", "limit": "deviation", "value": 2.0, "bound": 1.0, "unit": "mm",
    "message": "S001: deviation 2 mm (limit 1)"}'; echo "{}" > "$out/refused.json"; exit 4 ;;
  905*) report; exit 5 ;;
  906*) warning="2 pairs of faces cross, the first those of lines 5 and 5 near (1, 2, 3)" ;;  # and passes
  907*) echo "disk full" >&2; exit 7 ;;
  910*) kill -ABRT $$ ;;
  911*) sleep 60 ;;
  921*) color=amber ;;  # and passes
  912*) x=$(head -c 100000000 /dev/zero | tr '\0' x) ;;  # and passes, where it may
esac
report
echo "{}" > "$out/program.json$packed"
mkdir "$out/ribs"
echo "ribs" > "$out/ribs/S001.dxf"
)SH";

// Returns what the function throws as text; "nothing" where it throws nothing.
template <typename Function>
std::string thrown(const Function& function) {
  try {
    function();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "nothing";
}

class StandInBatch {
 public:
  // `chunk_minutes` of plans that are thought to take 1.5 s.
  explicit StandInBatch(const std::vector<int>& heights, double chunk_minutes = 10,
                        const std::filesystem::path& place = {}, std::vector<std::string> settings = {})
      : directory_((place.empty() ? files_.path() : place) / "batch") {
    std::ofstream(program()) << kStandIn;
    ::chmod(program().c_str(), 0755);
    std::ofstream facade(files_ / "facade.obj");
    for (const int height : heights) facade << square_panel("p" + std::to_string(height), height + 0.5);
    facade.close();
    asked_.design = files_ / "facade.obj";
    asked_.split = "group";
    asked_.units = "mm";
    asked_.chunk_minutes = chunk_minutes;
    asked_.assignments = std::move(settings);
    chunks_ = init_batch(directory_, asked_, false, {}).batch.chunks;
  }

  [[nodiscard]] const BatchDirectory& directory() const { return directory_; }
  [[nodiscard]] const Asked& asked() const { return asked_; }
  [[nodiscard]] std::filesystem::path program() const { return files_ / "stand_in"; }

  [[nodiscard]] std::vector<int> chunks() const {
    std::vector<int> all;
    for (int i = 0; i < chunks_; ++i) all.push_back(i);
    return all;
  }

  [[nodiscard]] RunReport run(int jobs = 2, double limit_s = 30, int limit_mb = 4000) const {
    return run_chunks(directory_, chunks(), {jobs, limit_s, limit_mb, program()}, {});
  }

  // How often the stand-in has been started.
  [[nodiscard]] std::size_t starts() const {
    const std::string text = pipeline::testing::read_bytes(files_ / "started");
    return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
  }

  // Names of what lies beside the results that is no result.
  [[nodiscard]] std::vector<std::string> litter() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(directory_.results())) {
      if (const std::string name = entry.path().filename(); name.starts_with(".")) names.push_back(name);
    }
    return names;
  }

 private:
  pipeline::testing::TemporaryDirectory files_;
  BatchDirectory directory_;
  Asked asked_;
  int chunks_ = 0;
};

}  // namespace hotblade::pipeline::batch::testing
