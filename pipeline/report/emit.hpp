// The emit stage: program.json, report.json, report.html, sheets.html, preview.png, scene.gltf, run.json,
// ribs/ and, of a refused plan, refused.json (pipeline/program/refused_plan.hpp) in one directory, all of one
// plan (output_set.hpp).
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "pipeline/plan/plan.hpp"
#include "pipeline/report/output_set.hpp"
#include "pipeline/report/pictures.hpp"

namespace hotblade::pipeline {

// The facts that may differ between two runs of the same plan; they go to run.json only.
struct RunFacts {
  std::filesystem::path design_path;  // empty: not known
  std::filesystem::path cell;         // a file or a name as read_cell takes it; empty: none was given
  std::string backend;                // empty: nothing was measured
  int threads = 0;
  double total_s = 0;
};

struct EmitOptions {
  bool override_refusal = false;  // writes the program of a refused plan, its refusals in program.overrides
  bool gzip = false;              // writes program.json.gz
};

struct Emitted {
  bool program_written = false;
  std::string program_sha256{};         // of its text, packed or not; empty where none was written
  std::vector<std::string> left_out{};  // files of an older set that went without another in their place
};

// Writes the set and puts it in its place whole; preview.png (the first picture) and scene.gltf are absent
// where there are none. The ribs (a DXF file a strip and beziers.csv, as export/rib_files.hpp makes
// them) and sheets.html come and go with the program. `take_pictures` is called once, on this thread, while
// others write the program. Throws Error (kFile), and what `take_pictures` throws; the older set then stays.
using TakePictures = std::function<ReportPictures(const PlanResult&)>;
Emitted emit(PlanResult& result, OutputSet& output, const RunFacts& facts, const EmitOptions& options,
             const TakePictures& take_pictures);

// Writes what can be told of a program without its plan, as a set in the same way: the program, its ribs, its
// sheets and run.json. Reports and pictures of an older program go.
Emitted emit_placed(Program program, OutputSet& output, const RunFacts& facts, bool gzip);

}  // namespace hotblade::pipeline
