#include "pipeline/report/emit.hpp"

#include <tbb/parallel_pipeline.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <exception>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "elastica/kernels/simd_pin.hpp"
#include "pipeline/export/rib_files.hpp"
#include "pipeline/plan/motion/motion.hpp"
#include "pipeline/program/atomic_file.hpp"
#include "pipeline/program/freed_memory.hpp"
#include "pipeline/program/gzip.hpp"
#include "pipeline/program/program_text.hpp"
#include "pipeline/program/sha256.hpp"
#include "pipeline/report/json/report_json.hpp"
#include "pipeline/report/report_plots.hpp"
#include "pipeline/report/sheets.hpp"
#include "pipeline/settings/error.hpp"
#include "pipeline/settings/json_text.hpp"
#include "pipeline/stock/foam_to_buy.hpp"

namespace hotblade::pipeline {

namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

// Strips whose texts are held at once.
constexpr std::size_t kStripsAtOnce = 8;

// A piece of the program, whose hash goes by order, within `all`, and what is written of it where packed.
struct Piece {
  std::string all, gzip;
  std::size_t first = 0, size = 0;

  Piece(std::string in, std::size_t from, std::size_t count, bool pack)
      : all(std::move(in)), first(from), size(count) {
    if (pack) gzip = packed(text());
  }
  [[nodiscard]] std::string_view text() const { return std::string_view(all).substr(first, size); }
};

// Writes the program strip by strip: a job of hundreds of blocks, held as one text, takes more memory than
// all that was planned. What the reader would refuse must not be handed out, so each strip is read back
// first. With gzip each strip is a member of its own, packed beside others.
StagedFile staged_program(const Program& program, const fs::path& file, Sha256& sha256) {
  const ProgramFrame frame = program_frame(program);
  const bool gzip = is_gzip_name(file);
  const auto produce = [&](const WritePiece& write) {
    const auto put = [&](const Piece& piece) {
      sha256.add(piece.text());
      write(gzip ? piece.gzip : piece.text());
    };
    put({frame.before, 0, frame.before.size(), gzip});
    std::size_t next = 0;
    const auto take = [&](tbb::flow_control& control) {
      if (next == program.strips.size()) control.stop();
      return next++;
    };
    const auto make = [&](std::size_t i) {
      std::string text = to_json(program.strips[i], frame.before);
      const std::size_t first = frame.before.size(), size = text.size() - first;
      text += frame.after;
      (void)parse_program(text, "program.json");
      if (i == 0) return Piece{std::move(text), first, size, gzip};
      // What separates it from the strip before takes the place of the frame's last two bytes.
      constexpr std::string_view kBetween = ",\n";
      text.replace(first - kBetween.size(), kBetween.size(), kBetween);
      return Piece{std::move(text), first - kBetween.size(), size + kBetween.size(), gzip};
    };
    using Mode = tbb::filter_mode;
    tbb::parallel_pipeline(kStripsAtOnce, tbb::make_filter<void, std::size_t>(Mode::serial_in_order, take) &
                                              tbb::make_filter<std::size_t, Piece>(Mode::parallel, make) &
                                              tbb::make_filter<Piece, void>(Mode::serial_in_order, put));
    put({frame.after, 0, frame.after.size(), gzip});
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

  // Waits for the program's text. Returns its SHA-256.
  std::string sha256() {
    tasks_.wait();
    if (error_) std::rethrow_exception(error_);
    return sha256_.hex();
  }
  void place() { staged_->place(); }

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
  Json run = Json::object();
  // The text of a path that is no UTF-8 leads nowhere: its bytes do (pipeline/program/design_file.hpp).
  const auto put_path = [&run](const char* key, const std::string& path) {
    if (path.empty()) return;
    run[key] = path;
    if (!is_utf8(path))
      run[key + std::string("_bytes")] = std::vector<std::uint8_t>(path.begin(), path.end());
  };
  put_path("design_path", facts.design_path.string());
  put_path("cell", facts.cell.string());
  if (!facts.backend.empty()) run["backend"] = facts.backend;
  run["threads"] = facts.threads;
  run["simd"] = elastica::name(elastica::best_simd());
  run["total_s"] = facts.total_s;
  run["stage_s"] = times;
  run["stage_processor_s"] = processor;
  return json_text(run, 2) + "\n";
}

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

Emitted emit_draft(PlanResult& result, OutputSet& output, const RunFacts& facts, const EmitOptions& options,
                   const TakePictures& take_pictures) {
  Emitted emitted;
  give_back_freed_memory();
  const bool passed = result.program.verification.status == VerificationStatus::kPassed;
  if (!passed && options.override_refusal) {
    for (const Refusal& r : result.refusals) result.program.overrides.push_back(describe(r));
  }
  emitted.program_written = passed || (options.override_refusal && !result.program.strips.empty());
  const fs::path& draft = output.draft();
  std::optional<ProgramWriter> program;
  if (emitted.program_written) program.emplace(result.program, draft / program_name(options.gzip));
  // Pictures are drawn by one thread, this one: what of the rest needs none of them is written meanwhile.
  tbb::task_group sheets, files;  // what ends early waits for the files first: they start the sheets
  files.run([&] {
    if (!result.refusals.empty()) {
      write_file_atomically(draft / "refused.json",
                            to_json(RefusedPlan{refused_reasons(result, Words("en")), result.program}),
                            false);
    }
    if (!program) return;
    write_ribs(result.program, draft / "ribs");
    emitted.program_sha256 = program->sha256();
    sheets.run([&] {
      write_file_atomically(draft / "sheets.html", sheets_html(result, emitted.program_sha256), false);
    });
  });
  const ReportPictures pictures = take_pictures(result);
  files.wait();
  write_reports(result, draft, facts, pictures, emitted.program_sha256);
  sheets.wait();
  if (program) program->place();
  emitted.left_out = output.left_out();
  output.commit();
  return emitted;
}

// What sheets ask of a plan that a program can tell.
PlanResult told_by(Program program) {
  PlanResult result;
  result.program = std::move(program);
  result.foam = foam_to_buy(result.program);
  for (const Strip& strip : result.program.strips) {
    StripFacts& facts = result.strips.emplace_back();
    facts.id = strip.id;
    time_facts(strip.poses, facts.motion);
  }
  return result;
}

Emitted emit_placed_draft(const PlanResult& result, OutputSet& output, const RunFacts& facts, bool gzip) {
  const fs::path& draft = output.draft();
  ProgramWriter writer(result.program, draft / program_name(gzip));
  write_ribs(result.program, draft / "ribs");
  Emitted emitted{true, writer.sha256()};
  write_file_atomically(draft / "sheets.html", sheets_html(result, emitted.program_sha256), false);
  write_file_atomically(draft / "run.json", run_json(result, facts), false);
  writer.place();
  emitted.left_out = output.left_out();
  output.commit();
  return emitted;
}

// Writes a set; what is said of a file that cannot be written names its place in the directory.
Emitted written(OutputSet& output, const std::function<Emitted()>& write) {
  try {
    return write();
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

}  // namespace

Emitted emit(PlanResult& result, OutputSet& output, const RunFacts& facts, const EmitOptions& options,
             const TakePictures& take_pictures) {
  return written(output, [&] { return emit_draft(result, output, facts, options, take_pictures); });
}

Emitted emit_placed(Program program, OutputSet& output, const RunFacts& facts, bool gzip) {
  const PlanResult result = told_by(std::move(program));
  return written(output, [&] { return emit_placed_draft(result, output, facts, gzip); });
}

}  // namespace hotblade::pipeline
