#include "pipeline/report/emit.hpp"
#include "pipeline/report/arms_section.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "elastica/kernels/simd_pin.hpp"
#include "pipeline/export/rib_files.hpp"
#include "pipeline/program/atomic_file.hpp"
#include "pipeline/program/gzip.hpp"
#include "pipeline/program/program_text.hpp"
#include "pipeline/program/sha256.hpp"
#include "pipeline/report/advice.hpp"
#include "pipeline/report/report_plots.hpp"
#include "pipeline/report/sheets.hpp"
#include "pipeline/settings/error.hpp"
#include "pipeline/verify/budget.hpp"
#include "pipeline/verify/verdict.hpp"

namespace hotblade::pipeline {

namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

Json vector_json(const Eigen::Vector3d& v) {
  return Json::array({v.x(), v.y(), v.z()});
}

Json refusal_json(const Refusal& r) {
  return {{"strip", r.strip},       {"rib", r.rib},
          {"limit", limit_text(r)}, {"value", r.value},
          {"capped", r.capped},     {"bound", r.bound},
          {"unit", unit(r)},        {"hint", note(r)},
          {"place", r.place},       {"at", r.at ? vector_json(*r.at) : Json()},
          {"details", r.details},   {"message", describe(r)}};
}

// mm of shape change by each clamp coordinate; null where the blade is straight.
Json sensitivity_json(const std::array<double, 6>& mm) {
  Json json;
  for (std::size_t i = 0; i < mm.size(); ++i) {
    json[clamp_coordinate_name(i)] = std::isfinite(mm[i]) ? Json(mm[i]) : Json();
  }
  return json;
}

// The blade's length and its neighbours in the list; null where nothing is known of them.
Json blades_json(const std::optional<BladeTrials>& trials) {
  if (!trials) return {};
  const auto trial_json = [](const BladeTrial& trial) -> Json {
    const bool stopped = trial.refusal.limit != Limit::kNone;
    return {{"length_mm", trial.length_mm},
            {"stopped_by", stopped ? Json(describe_amount(trial.refusal)) : Json()},
            {"sag_mm", stopped || !std::isfinite(trial.sag_mm) ? Json() : Json(trial.sag_mm)}};
  };
  return {{"chosen", trial_json(trials->chosen)},
          {"shorter", trials->shorter ? trial_json(*trials->shorter) : Json()},
          {"longer", trials->longer ? trial_json(*trials->longer) : Json()}};
}

Json strip_json(const StripFacts& f, const Strip& strip) {
  Json ribs = Json::array();
  for (std::size_t i = 0; i < strip.ribs.size(); ++i) {
    const Rib& rib = strip.ribs[i];
    ribs.push_back({{"id", rib.id},
                    {"lambda_residual", rib.lambda_residual},
                    {"l2", rib.l2},
                    {"h1", rib.h1},
                    {"hausdorff_mm", rib.hausdorff_mm},
                    {"design_deviation_mm", rib.design_deviation_mm},
                    {"clamp_sensitivity_mm", sensitivity_json(f.motion.rib_sensitivity_mm.at(i))}});
  }
  Json json = {{"id", f.id},
               {"ribs", f.ribs},
               {"projected_ribs", f.projected_ribs},
               {"blade_length_mm", f.blade_length_mm},
               {"blade_trials", blades_json(f.blades)},
               {"deviation_max_mm", f.deviation_max_mm},
               {"rib_fit_max_mm", f.worst_fit_mm},
               {"bezier_fit_max_mm", f.worst_bezier_mm},
               {"seam_gap_max_mm", f.seam.gap_mm},
               {"seam_kink_max_deg", f.seam.kink_deg},
               {"lambda_residual_max", f.largest_lambda_residual},
               {"blade_radius_min_mm", f.smallest_radius_mm()},
               {"stability_margin_min", f.smallest_margin},
               {"clamp_clearance_min_mm", f.motion.smallest_clearance_mm},
               {"clamp_force_max_n", f.motion.largest_force_n},
               {"clamp_moment_max_n_mm", f.motion.largest_moment_n_mm},
               {"bending_stress_max_mpa", f.motion.largest_stress_mpa},
               {"droop_mm", f.motion.droop_mm},
               {"droop_error_mm", f.droop_error_mm},
               {"in_plane_sag_mm", f.motion.in_plane_sag_mm},
               {"clamp_error_mm", f.motion.clamp_error_mm},
               {"margin_mm_min", f.motion.smallest_margin_mm()},
               {"snap_margin_mm_min", f.motion.smallest_fold_mm},
               {"straight_margin_mm_min", f.motion.smallest_straight_mm},
               {"duration_s", f.motion.duration_s},
               {"cut_s", f.motion.cut_s},
               {"feed_slowest_mm_s", f.motion.slowest_feed_mm_s},
               {"band_min_mm", f.band_min_mm},
               {"band_max_mm", f.band_max_mm},
               {"plane_turn_rad", f.plane_turn_rad},
               {"off_plane_mm", f.motion.off_plane_mm},
               {"stock_volume_mm3", f.stock_volume_mm3},
               {"foam_kept_share", f.foam_kept_share},
               {"plinth_mm", f.plinth_mm},
               {"stock_size_mm", vector_json(strip.block.size_mm)},
               {"poses", strip.poses.size()},
               {"rib_facts", ribs}};
  if (f.motion.jerk_s > 0) json["jerk_s"] = f.motion.jerk_s;
  if (strip.arms) json["arms"] = arms_json(*strip.arms);
  return json;
}

Json ranking_json(const std::vector<PlanesTried>& ranking) {
  Json list = Json::array();
  for (const PlanesTried& d : ranking) {
    Json axis, fit;
    if (d.planes.turns())
      axis = {{"point", vector_json(d.planes.centre())}, {"direction", vector_json(d.planes.axis())}};
    if (d.fit_mm) fit = *d.fit_mm;
    list.push_back({{"normal", vector_json(d.planes.normal(0))},
                    {"fan_axis", axis},
                    {"parts_along_sweep", d.along_sweep},
                    {"parts_along_ribs", d.along_ribs},
                    {"missed_mm", std::isfinite(d.missed_mm) ? Json(d.missed_mm) : Json()},
                    {"fit_mm", fit}});
  }
  return list;
}

Json decisions_json(const std::vector<Decision>& decisions) {
  Json list = Json::array();
  for (const Decision& d : decisions) {
    Json fits = Json::array();
    for (const SweptFit& f : d.fits) {
      fits.push_back({{"coefficients", f.coefficients},
                      {"calm", f.calm},
                      {"blade_length_mm", f.blade_length_mm},
                      {"fit_mm", std::isfinite(f.fit_mm) ? Json(f.fit_mm) : Json()}});
    }
    list.push_back({{"way", name(d.way)},
                    {"normal", vector_json(d.normal)},
                    {"fan", d.fan},
                    {"fits", fits},
                    {"strips", d.strips},
                    {"ribs", d.ribs},
                    {"fit_mm", d.fit_mm},
                    {"deviation_mm", d.deviation_mm},
                    {"passed", d.passed},
                    {"taken", d.taken},
                    {"why", d.why}});
  }
  return list;
}

// Strips whose texts are held at once.
constexpr std::size_t kStripsAtOnce = 8;

// Writes the program strip by strip: a job of hundreds of blocks, held as one text, takes more memory than
// all that was planned. What the reader would refuse must not be handed out, so each strip is read back
// first.
StagedFile staged_program(const Program& program, const fs::path& file, Sha256& sha256) {
  const ProgramFrame frame = program_frame(program);
  const auto produce = [&](const WritePiece& write_piece) {
    std::optional<GzipWriter> gzip;
    if (is_gzip_name(file)) gzip.emplace(write_piece);
    const auto write = [&](std::string_view piece) {
      sha256.add(piece);
      gzip ? gzip->add(piece) : write_piece(piece);
    };
    write(frame.before);
    const std::size_t count = program.strips.size();
    for (std::size_t first = 0; first < count; first += kStripsAtOnce) {
      std::vector<std::string> texts(std::min(kStripsAtOnce, count - first));
      tbb::parallel_for(std::size_t{0}, texts.size(), [&](std::size_t i) {
        texts[i] = to_json(program.strips[first + i]);
        (void)parse_program(frame.before + texts[i] + frame.after, "program.json");
      });
      for (std::size_t i = 0; i < texts.size(); ++i) {
        write(first + i > 0 ? ",\n" : "");
        write(texts[i]);
      }
    }
    write(frame.after);
    if (gzip) gzip->finish();
  };
  return {file, produce, false};
}

// The program on its way to its place, written by other threads.
class ProgramWriter {
 public:
  ProgramWriter(const Program& program, const fs::path& file) {
    tasks_.run([this, &program, file] {
      try {
        staged_.emplace(staged_program(program, file, sha256_));
      } catch (...) {
        error_ = std::current_exception();  // told where the program's turn is
      }
    });
  }
  ~ProgramWriter() { tasks_.wait(); }
  ProgramWriter(const ProgramWriter&) = delete;
  ProgramWriter& operator=(const ProgramWriter&) = delete;

  // Returns the SHA-256 of the program's text.
  std::string place() {
    tasks_.wait();
    if (error_) std::rethrow_exception(error_);
    staged_->place();
    return sha256_.hex();
  }

 private:
  Sha256 sha256_;
  std::optional<StagedFile> staged_;
  std::exception_ptr error_;
  tbb::task_group tasks_;
};

std::string run_json(const PlanResult& result, const RunFacts& facts) {
  Json times = Json::object(), processor = Json::object();
  for (const StageTime& t : result.times) {
    times[t.stage] = t.seconds;
    processor[t.stage] = t.processor_s;
  }
  const Json run{{"design_path", facts.design_path.string()},
                 {"backend", facts.backend},
                 {"threads", facts.threads},
                 {"simd", elastica::name(elastica::best_simd())},
                 {"total_s", facts.total_s},
                 {"stage_s", times},
                 {"stage_processor_s", processor}};
  return run.dump(2) + "\n";
}

}  // namespace

std::string report_json(const PlanResult& result, const std::string& program_sha256) {
  const Verification& v = result.program.verification;
  Json report;
  report["format"] = "hotblade-report";
  report["version"] = 1;
  report["created_by"] = result.program.created_by;
  report["status"] = name(v.status);
  report["verdict"] = to_json(verdict_of(result.program));
  report["design"] = {{"file", result.program.design.file},
                      {"sha256", result.program.design.sha256},
                      {"area_mm2", result.verification.area_mm2}};
  report["program_sha256"] = program_sha256.empty() ? Json() : Json(program_sha256);
  report["tolerance_mm"] = v.tolerance_mm;
  const Deviation& d = v.deviation_mm;
  report["deviation_mm"] = {{"max", d.max},
                            {"p99", d.p99},
                            {"rms", d.rms},
                            {"mean", d.mean},
                            {"at", vector_json(d.at)},
                            {"capped", result.verification.capped}};
  report["percentiles_mm"] = Json::array();
  for (const auto& [percent, mm] : result.verification.percentiles_mm) {
    report["percentiles_mm"].push_back({{"percent", percent}, {"mm", mm}});
  }
  const DeviationHistogram& histogram = result.verification.histogram;
  report["histogram"] = {
      {"bin_mm", histogram.bin_mm}, {"counts", histogram.counts}, {"beyond", histogram.beyond}};
  report["uncut_mm2"] = v.uncut_mm2;
  report["uncut_share"] = result.verification.uncut_share();
  report["samples"] = {{"cut", result.verification.cut_samples},
                       {"beyond_design", result.verification.beyond_samples},
                       {"design", result.verification.design_samples}};
  report["budget_mm"] = Json::object();
  for (const auto& [name, mm] : v.budget_mm) report["budget_mm"][name] = mm;
  report["budget_sum_mm"] = budget_sum_mm(v.budget_mm);
  report["rib_spacing_mm"] = result.spacing_mm;
  report["strips_lower_bound"] = result.strips_lower_bound;
  report["decisions"] = decisions_json(result.decisions);
  report["refusals"] = Json::array();
  for (const Refusal& r : result.refusals) report["refusals"].push_back(refusal_json(r));
  report["remedies"] = to_json(result.remedies);
  report["overrides"] = result.program.overrides;
  report["warnings"] = result.warnings;
  report["not_checked"] = v.not_checked;
  report["directions"] = ranking_json(result.ranking);
  if (result.program.cell)
    report["cell"] = {{"name", result.program.cell->name}, {"sha256", result.program.cell->sha256}};
  report["strips"] = Json::array();
  for (std::size_t i = 0; i < result.strips.size(); ++i) {
    report["strips"].push_back(strip_json(result.strips[i], result.program.strips[i]));
  }
  report["settings"] = to_json(result.program.settings);
  return report.dump(2) + "\n";
}

namespace {

void write_ribs(const Program& program, const fs::path& ribs) {
  ensure_directory(ribs);
  for (const ExportedFile& file : rib_files(program, "dxf", {}))
    write_file_atomically(ribs / file.name, file.text, false);
  const ExportedFile beziers = bezier_file(program);
  write_file_atomically(ribs / beziers.name, beziers.text, false);
}

void write_reports(const PlanResult& result, const fs::path& directory, const RunFacts& facts,
                   const ReportPictures& pictures, const std::string& program_sha256) {
  write_file_atomically(directory / "report.json", report_json(result, program_sha256), false);
  write_file_atomically(directory / "report.html",
                        report_html(result, pictures.pictures, pictures.note, program_sha256, pictures.view),
                        false);
  const std::string png = pictures.pictures.empty() ? "" : pictures.pictures.front().png;
  for (const auto& [name, bytes] :
       {std::pair{"preview.png", &png}, std::pair{"scene.gltf", &pictures.scene_gltf}}) {
    if (!bytes->empty()) write_file_atomically(directory / name, *bytes, false);
  }
  write_file_atomically(directory / "run.json", run_json(result, facts), false);
}

}  // namespace

namespace {

Emitted emit_draft(PlanResult& result, OutputSet& output, const RunFacts& facts, const EmitOptions& options,
                   const TakePictures& take_pictures) {
  Emitted emitted;
  const bool passed = result.program.verification.status == VerificationStatus::kPassed;
  if (!passed && options.override_refusal) {
    for (const Refusal& r : result.refusals) result.program.overrides.push_back(describe(r));
  }
  emitted.program_written = passed || (options.override_refusal && !result.program.strips.empty());
  const fs::path& draft = output.draft();
  std::optional<ProgramWriter> program;
  if (emitted.program_written) program.emplace(result.program, draft / program_name(options.gzip));
  const ReportPictures pictures = take_pictures(result);
  if (program) {
    write_ribs(result.program, draft / "ribs");
    emitted.program_sha256 = program->place();
    write_file_atomically(draft / "sheets.html", sheets_html(result, emitted.program_sha256), false);
  }
  if (!result.refusals.empty()) {
    write_file_atomically(draft / "refused.json",
                          to_json(RefusedPlan{refused_reasons(result), result.program}), false);
  }
  write_reports(result, draft, facts, pictures, emitted.program_sha256);
  output.commit();
  return emitted;
}

}  // namespace

Emitted emit(PlanResult& result, OutputSet& output, const RunFacts& facts, const EmitOptions& options,
             const TakePictures& take_pictures) {
  try {
    return emit_draft(result, output, facts, options, take_pictures);
  } catch (const Error& error) {
    if (error.kind != ErrorKind::kFile) throw;
    // The draft is gone when this is read: the place that it was for is what a user knows.
    std::string what = error.what();
    const std::string draft = output.draft().string();
    if (const auto at = what.find(draft); at != std::string::npos)
      what.replace(at, draft.size(), output.directory().string());
    throw Error(ErrorKind::kFile, what + ": what was there is as it was");
  }
}

}  // namespace hotblade::pipeline
