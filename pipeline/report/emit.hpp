// The emit stage: program.json, report.json, report.html, preview.png, scene.gltf, run.json and ribs/ in one
// directory, each file whole or not there.
#pragma once

#include <filesystem>
#include <functional>

#include "pipeline/plan/plan.hpp"
#include "pipeline/report/pictures.hpp"

namespace hotblade::pipeline {

// The facts that may differ between two runs of the same plan; they go to run.json only.
struct RunFacts {
  std::filesystem::path design_path;
  std::string backend;
  int threads = 0;
  double total_s = 0;
};

struct EmitOptions {
  bool force = false;             // overwrite
  bool override_refusal = false;  // write the program of a refused plan all the same, saying so in it
};

struct Emitted {
  bool program_written = false;
};

// Makes the directory and refuses (kFile) what could not be written later: an output that is there
// without force, or a directory that cannot be written to. It is called before the work starts.
void prepare_output(const std::filesystem::path& directory, bool force);

// Writes the files; preview.png (the first picture) and scene.gltf are absent where there are none. A refused
// plan's program is written only with override_refusal, its refusals recorded in program.overrides; an older
// program.json in the way is then removed, so that no directory holds a program beside a report that refuses
// it. The ribs (a DXF file a strip and beziers.csv, as export/rib_files.hpp makes them) come and go with the
// program; files of other names in ribs/ are left alone. `take_pictures` is called once, on this thread,
// while others write the program beside its place; it goes there last. Throws Error (kFile), and what
// `take_pictures` throws.
using TakePictures = std::function<ReportPictures(const PlanResult&)>;
Emitted emit(PlanResult& result, const std::filesystem::path& directory, const RunFacts& facts,
             const EmitOptions& options, const TakePictures& take_pictures);

// The text of report.json: verdict, strips, ribs, ranking, refusals, warnings, budget, what was not checked.
[[nodiscard]] std::string report_json(const PlanResult& result);

}  // namespace hotblade::pipeline
