#include "pipeline/batch/run.hpp"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <list>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

#include "elastica/kernels/simd_pin.hpp"
#include "pipeline/batch/child.hpp"
#include "pipeline/batch/commit.hpp"
#include "pipeline/batch/mapped_file.hpp"
#include "pipeline/batch/result.hpp"
#include "pipeline/batch/work.hpp"
#include "pipeline/program/atomic_file.hpp"
#include "pipeline/program/sha256.hpp"
#include "pipeline/program/version.hpp"
#include "pipeline/settings/error.hpp"
#include "pipeline/settings/json_bytes.hpp"
#include "pipeline/settings/json_text.hpp"

namespace hotblade::pipeline::batch {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// A crash that comes three times will come again.
constexpr int kTries = 3;
constexpr std::size_t kLinesShown = 10;
// What the plan of a panel takes with pictures.
constexpr int kPlanMegabytes = 340;
// How long the runner sleeps at most: `stop` is asked then, and limits of time looked at.
constexpr int kLongestSleepMs = 500;
// How often a key that another runner has is asked for.
constexpr int kSharedSleepMs = 200;

Json failure_json(const Failure& f) {
  return {{"job", f.job},           {"panel", f.panel}, {"key", f.key},
          {"attempts", f.attempts}, {"why", f.why},     {"stderr", f.last_lines}};
}

// Says whose job of which scheduler this is; empty: nobody's.
std::string engine_job() {
  const char* job = std::getenv("SLURM_JOB_ID");
  return job != nullptr ? std::string("slurm ") + job : "";
}

void expect_same_program(const BatchDirectory& directory, const Batch& batch) {
  if (batch.version != version() || batch.commit != commit()) {
    throw Error(
        ErrorKind::kBadInput,
        fmt::format("{}: was made by hotblade {} ({}), this is {} ({}): run `hotblade batch init` with "
                    "--update, and results of the other program stay as they are",
                    directory.batch().string(), batch.version, batch.commit, version(), commit()));
  }
  try {
    (void)elastica::simd_named(batch.simd);
  } catch (const std::runtime_error& error) {
    throw Error(ErrorKind::kBadSettings,
                directory.batch().string() + ": is pinned to " + batch.simd + ": " + error.what());
  }
}

struct Task {
  PlannedKey planned;
  int chunk = 0;
  int attempts = 0;
};

struct Running {
  Task task;
  std::string started;
  KeyLock lock;
  WorkPlace place;
  Child child;  // ends before its place goes
};

struct Ended {
  Running plan;
  ChildEnd end;
};

struct ChunkState {
  std::string list;      // of its jobs
  std::size_t left = 0;  // jobs without result or failure
  std::vector<Failure> failures;
};

class Runner {
 public:
  Runner(const BatchDirectory& directory, const RunOptions& options, const RunHooks& hooks)
      : directory_(directory), options_(options), hooks_(hooks), batch_(read_batch(directory)) {
    expect_same_program(directory, batch_);
    table_ = read_jobs(directory, batch_);
    for (const Job& job : table_.jobs) first_job_.emplace(job.key, job);
    clear_left_work(directory);
  }

  RunReport run(const std::vector<int>& chunks) {
    for (const int chunk : chunks) take_chunk(chunk);
    report_.plans = pending_.size();
    for (const int chunk : chunks) finish_if_done(chunk);  // one without jobs
    tell();
    while (!pending_.empty() || !shared_.empty() || !running_.empty()) {
      if (hooks_.stop && hooks_.stop()) stop();
      if (pending_.empty() && static_cast<int>(running_.size()) < options_.jobs) std::swap(pending_, shared_);
      fill();
      sleep();
      std::list<Ended> ended = take_ended();
      fill();  // the next are planned while results are hashed and synced
      for (Ended& one : ended) judge(one.plan, one.end);
    }
    return std::move(report_);
  }

 private:
  void take_chunk(int chunk) {
    ChunkState& state = chunks_[chunk];
    state.list = std::string(MappedFile(directory_.chunk(chunk)).text());
    for (PlannedKey& planned : read_chunk(directory_, chunk, table_)) {
      pending_.push_back({std::move(planned), chunk, 0});
      ++state.left;
    }
  }

  void fill() {
    while (!pending_.empty() && static_cast<int>(running_.size()) < options_.jobs) start_next();
  }

  void start_next() {
    Task task = std::move(pending_.front());
    pending_.pop_front();
    if (has_result(directory_, task.planned.key)) return end_task(task, false);
    std::optional<KeyLock> lock = KeyLock::take(directory_, task.planned.key);
    if (!lock) {
      shared_.push_back(std::move(task));
      return;
    }
    if (has_result(directory_, task.planned.key)) return end_task(task, false);  // another was faster
    if (const std::string wrong = wrong_input(task.planned); !wrong.empty()) {
      task.attempts = kTries;
      return fail_task(task, wrong, {});
    }
    ++task.attempts;
    WorkPlace place(directory_, task.planned.key);
    Child child(words(task.planned, place), {{"HOTBLADE_SIMD", batch_.simd}, {"OMP_NUM_THREADS", "1"}},
                place.stderr_file(), {options_.limit_s, options_.limit_mb});
    running_.push_back({std::move(task), utc_now(), std::move(*lock), std::move(place), std::move(child)});
  }

  // What the key was made of has to be what is planned; empty: it is.
  std::string wrong_input(const PlannedKey& planned) {
    for (const auto& [file, sha256] :
         {std::pair{directory_.design(planned.design_sha256), planned.design_sha256},
          {directory_.settings(planned.settings_sha256), planned.settings_sha256}}) {
      if (checked_.contains(file)) continue;
      try {
        if (sha256_hex(MappedFile(file).text()) != sha256)
          return file.string() + ": was changed: run init again";
      } catch (const Error& error) {
        return error.what();
      }
      if (file.extension() == ".toml") checked_.insert(file);
    }
    return "";
  }

  [[nodiscard]] std::vector<std::string> words(const PlannedKey& planned, const WorkPlace& place) const {
    std::vector<std::string> words{options_.program.string(),
                                   "plan",
                                   directory_.design(planned.design_sha256).string(),
                                   "--config",
                                   directory_.settings(planned.settings_sha256).string(),
                                   "-o",
                                   place.output().string(),
                                   "--jobs",
                                   "1",
                                   "--backend",
                                   "cpu",
                                   "--pictures",
                                   batch_.asked.pictures,
                                   "--viewer",
                                   "none",
                                   "--progress",
                                   "none"};
    if (batch_.asked.gzip) words.emplace_back("--gzip");
    return words;
  }

  void sleep() const {
    std::vector<pollfd> ends;
    bool blind = !shared_.empty();
    for (const Running& one : running_) {
      ends.push_back({one.child.descriptor(), POLLIN, 0});
      blind = blind || one.child.descriptor() < 0;
    }
    if (!ends.empty() || blind) ::poll(ends.data(), ends.size(), blind ? kSharedSleepMs : kLongestSleepMs);
  }

  std::list<Ended> take_ended() {
    std::list<Ended> ended;
    for (auto one = running_.begin(); one != running_.end();) {
      const std::optional<ChildEnd> end = one->child.poll();
      if (!end) {
        ++one;
        continue;
      }
      ended.push_back({std::move(*one), *end});
      one = running_.erase(one);
    }
    return ended;
  }

  void judge(Running& ended, const ChildEnd& end) {
    const Task& task = ended.task;
    const std::optional<std::string> verdict = verdict_of_exit(end.exit_code);
    const Json report = report_of(ended);
    // What passes says what it cut; a wrapper that started nothing ends with 0 as well.
    const bool tells = verdict != kPassed || report.is_object();
    if (verdict && tells && !end.out_of_time) {
      const Job& job = first_job_.at(task.planned.key);
      Result result{job.number, job.panel, task.planned.key, end.exit_code, *verdict, ""};
      result.message = message(ended, end, report);
      if (report.is_object()) result.color = report.value(Json::json_pointer("/verdict/color"), "");
      result.attempts = task.attempts;
      result.seconds = end.seconds;
      result.cpu_s = end.cpu_s;
      result.peak_mb = end.peak_mb;
      result.node = node_name();
      result.engine_job = engine_job();
      result.version = batch_.version;
      result.simd = batch_.simd;
      result.started = ended.started;
      result.finished = utc_now();
      ended.place.publish(directory_, std::move(result), batch_.asked.keep);
      return end_task(task, true);
    }
    std::string why = fmt::format("exit code {}", end.exit_code);
    if (!tells) why += fmt::format(" without {}", kReportFile);
    if (end.signal != 0) why = fmt::format("signal {} ({})", end.signal, ::strsignal(end.signal));
    if (may_want_memory(end))
      why += fmt::format(", its memory limited to {} MB (--limit-mb)", options_.limit_mb);
    if (end.out_of_time) why = fmt::format("over its {:g} s", options_.limit_s);
    fail_task(task, why, last_lines(ended.place.stderr_file(), kLinesShown));
  }

  // What ends for want of memory says so in many ways, if at all.
  [[nodiscard]] bool may_want_memory(const ChildEnd& end) const {
    constexpr double kNearly = 0.9;
    const bool broke = end.signal != 0 || end.exit_code == 1;
    return broke && !end.out_of_time && options_.limit_mb > 0 &&
           (options_.limit_mb < kPlanMegabytes || end.peak_mb > kNearly * options_.limit_mb);
  }

  // What a plan reported; null where it did not.
  static Json report_of(const Running& ended) {
    std::error_code ignored;
    const fs::path report = ended.place.output() / "report.json";
    return fs::exists(report, ignored) ? whole_json_if_any<Json>(MappedFile(report).text()) : Json();
  }

  // Why a plan did not pass: its first refusal, or what it said last.
  static std::string message(const Running& ended, const ChildEnd& end, const Json& report) {
    if (end.exit_code == 0) return "";
    if (report.is_object() && report.contains("refusals") && !report["refusals"].empty())
      return report["refusals"][0].value("message", "");
    const std::vector<std::string> said = last_lines(ended.place.stderr_file(), 1);
    return said.empty() ? "" : said.front();
  }

  void end_task(const Task& task, bool now) {
    ++(now ? report_.planned : report_.there);
    --chunks_.at(task.chunk).left;
    finish_if_done(task.chunk);
    tell();
  }

  void fail_task(const Task& task, const std::string& why, std::vector<std::string> lines) {
    if (task.attempts < kTries) {
      pending_.push_back(task);
      return;
    }
    const Job& job = first_job_.at(task.planned.key);
    Failure failure{job.number, job.panel, task.planned.key, task.attempts, why, std::move(lines)};
    if (hooks_.failed) hooks_.failed(failure);
    ChunkState& state = chunks_.at(task.chunk);
    state.failures.push_back(failure);
    report_.failures.push_back(std::move(failure));
    --state.left;
    finish_if_done(task.chunk);
    tell();
  }

  void finish_if_done(int chunk) const {
    const ChunkState& state = chunks_.at(chunk);
    if (state.left > 0) return;
    std::error_code ignored;
    if (!state.failures.empty()) {
      std::string text;
      for (const Failure& failure : state.failures) text += json_text(failure_json(failure)) + "\n";
      write_file_atomically(directory_.failures(chunk), text, true);
      return;
    }
    fs::remove(directory_.failures(chunk), ignored);
    // An update may have given the chunk other jobs meanwhile: these are not done.
    const MappedFile list(directory_.chunk(chunk));
    if (list.text() == state.list)
      write_file_atomically(directory_.stamp(chunk), sha256_hex(state.list) + "\n", true);
  }

  void tell() const {
    if (hooks_.progress)
      hooks_.progress(report_.there + report_.planned + report_.failures.size(), report_.plans);
  }

  [[noreturn]] void stop() {
    running_.clear();
    throw Error(
        ErrorKind::kInterrupted,
        fmt::format("interrupted: {} of {} plans have a result, the same command goes on with the rest",
                    report_.there + report_.planned, report_.plans));
  }

  const BatchDirectory& directory_;
  const RunOptions& options_;
  const RunHooks& hooks_;
  const Batch batch_;
  JobTable table_;
  std::map<std::string, Job> first_job_;  // by key
  std::map<int, ChunkState> chunks_;
  std::deque<Task> pending_, shared_;  // shared: those that other runners have
  std::list<Running> running_;
  std::set<fs::path> checked_;  // settings whose hash was found right
  RunReport report_;
};

}  // namespace

RunReport run_chunks(const BatchDirectory& directory, const std::vector<int>& chunks,
                     const RunOptions& options, const RunHooks& hooks) {
  return Runner(directory, options, hooks).run(chunks);
}

std::vector<Failure> read_failures(const BatchDirectory& directory, int chunk) {
  std::vector<Failure> failures;
  std::error_code ignored;
  const fs::path file = directory.failures(chunk);
  if (!fs::exists(file, ignored)) return failures;
  const MappedFile mapped(file);
  for (std::string_view rest = mapped.text(); !rest.empty();) {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(rest.size(), line.size() + 1));
    const Json json = whole_json_if_any<Json>(line);
    if (!json.is_object()) throw Error(ErrorKind::kBadInput, file.string() + ": is no list of failures");
    failures.push_back({json.value("job", std::size_t{0}), json.value("panel", ""), json.value("key", ""),
                        json.value("attempts", 0), json.value("why", ""),
                        json.value("stderr", std::vector<std::string>())});
  }
  return failures;
}

}  // namespace hotblade::pipeline::batch
