#include "pipeline/batch/gather.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "pipeline/batch/csv.hpp"
#include "pipeline/batch/database.hpp"
#include "pipeline/batch/index_page.hpp"
#include "pipeline/batch/plan_facts.hpp"
#include "pipeline/batch/result.hpp"
#include "pipeline/batch/run.hpp"
#include "pipeline/program/atomic_file.hpp"
#include "pipeline/settings/error.hpp"
#include "pipeline/settings/settings.hpp"

namespace hotblade::pipeline::batch {
namespace {

namespace fs = std::filesystem;
using Columns = std::vector<std::string>;

// Settings as pairs of key and value: "design.tolerance_mm", 1.
std::vector<Cells> flat_settings(const fs::path& file) {
  std::vector<Cells> flat;
  const nlohmann::ordered_json all = to_json(resolve({{file}, {}, {}}));
  for (const auto& [section, keys] : all.items()) {
    if (!keys.is_object()) continue;
    for (const auto& [key, value] : keys.items()) {
      const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
      flat.push_back({{section + "." + key, false}, {text, value.is_number()}});
    }
  }
  return flat;
}

class Gatherer {
 public:
  Gatherer(const BatchDirectory& directory, bool partial, const GatherHooks& hooks)
      : directory_(directory),
        hooks_(hooks),
        batch_(read_batch(directory)),
        table_(read_jobs(directory, batch_)) {
    for (int chunk = 0; chunk < batch_.chunks; ++chunk) take_chunk(chunk);
    read_facts(partial);
  }

  GatherReport write() {
    write_csv();
    write_database();
    std::vector<IndexRow> rows;
    for (const Job& job : table_.jobs) rows.push_back({&job, &facts_.at(job.key)});
    const std::string name = fs::weakly_canonical(directory_.path()).filename().string();
    write_file_atomically(directory_.path() / "index.html", index_page(name, table_, rows), true);
    return {table_.jobs.size(), missing_};
  }

 private:
  void take_chunk(int chunk) {
    for (const PlannedKey& planned : read_chunk(directory_, chunk))
      settings_of_key_.emplace(planned.key, planned.settings_sha256);
    for (Failure& failure : read_failures(directory_, chunk)) {
      const std::string key = failure.key;
      failures_.insert_or_assign(key, std::move(failure));
    }
  }

  void read_facts(bool partial) {
    double read = 0;
    for (const Job& job : table_.jobs) {
      if (hooks_.stop && hooks_.stop())
        throw Error(ErrorKind::kInterrupted, "interrupted: nothing was written");
      if (hooks_.progress) hooks_.progress(++read / static_cast<double>(table_.jobs.size()));
      const bool there = has_result(directory_, job.key);
      missing_ += there ? 0U : 1U;
      if (facts_.contains(job.key)) continue;
      if (!there && !partial) fail_missing(job);
      const auto failure = failures_.find(job.key);
      facts_.emplace(job.key,
                     there ? facts_of(directory_, job.key)
                           : facts_of_failure(failure != failures_.end() ? &failure->second : nullptr));
    }
  }

  [[noreturn]] void fail_missing(const Job& job) const {
    throw Error(ErrorKind::kFile,
                fmt::format("{}: job {} (panel {}) has no result: run chunk {}, or gather with --partial",
                            directory_.path().string(), job.number, job.panel, job.chunk));
  }

  [[nodiscard]] Columns columns() const {
    Columns all{"job", "panel", "key"};
    all.insert(all.end(), table_.keys.begin(), table_.keys.end());
    all.insert(all.end(), plan_columns().begin(), plan_columns().end());
    return all;
  }

  static Cells with_job(const Job& job, const Cells& cells) {
    Cells all{{std::to_string(job.number), true}};
    all.insert(all.end(), cells.begin(), cells.end());
    return all;
  }

  [[nodiscard]] Cells cells_of(const Job& job) const {
    Cells all{{std::to_string(job.number), true}, {job.panel, false}, {job.key, false}};
    for (const std::string& value : job.values) all.push_back({value, false});
    const Cells& plan = facts_.at(job.key).cells;
    all.insert(all.end(), plan.begin(), plan.end());
    return all;
  }

  void write_csv() const {
    write_file_atomically(
        directory_.path() / "results.csv",
        [this](const WritePiece& write_piece) {
          write_piece(csv_line(columns()));
          for (const Job& job : table_.jobs) {
            std::vector<std::string> texts;
            for (const Cell& cell : cells_of(job)) texts.push_back(cell.text);
            write_piece(csv_line(texts));
          }
        },
        true);
  }

  void write_database() const {
    const DraftFile file(directory_.path() / "results.sqlite");
    Database database(file.path());
    {
      Database::Table jobs = database.table("jobs", columns());
      for (const Job& job : table_.jobs) jobs.add(cells_of(job));
    }
    write_rows(database, "strips", strip_columns(), &PlanFacts::strips);
    write_rows(database, "refusals", refusal_columns(), &PlanFacts::refusals);
    write_rows(database, "warnings", warning_columns(), &PlanFacts::warnings);
    write_settings(database);
    database.execute(
        "CREATE VIEW best AS SELECT *, MIN(machine_s) AS least_machine_s FROM jobs WHERE verdict = 'passed' "
        "GROUP BY panel");
    database.close();
    file.place();
  }

  void write_rows(Database& database, const std::string& name, const Columns& of_row,
                  std::vector<Cells> PlanFacts::*rows) const {
    Columns all{"job"};
    all.insert(all.end(), of_row.begin(), of_row.end());
    Database::Table table = database.table(name, all);
    for (const Job& job : table_.jobs) {
      for (const Cells& cells : facts_.at(job.key).*rows) table.add(with_job(job, cells));
    }
  }

  void write_settings(Database& database) const {
    std::map<std::string, std::vector<Cells>> flat;  // by the settings' hash
    Database::Table table = database.table("settings", {"job", "key", "value"});
    for (const Job& job : table_.jobs) {
      const std::string& sha256 = settings_of_key_.at(job.key);
      auto found = flat.find(sha256);
      if (found == flat.end()) found = flat.emplace(sha256, flat_settings(directory_.settings(sha256))).first;
      for (const Cells& cells : found->second) table.add(with_job(job, cells));
    }
  }

  const BatchDirectory& directory_;
  const GatherHooks& hooks_;
  const Batch batch_;
  const JobTable table_;
  std::map<std::string, std::string> settings_of_key_;
  std::map<std::string, Failure> failures_;  // by key
  std::map<std::string, PlanFacts> facts_;   // by key
  std::size_t missing_ = 0;
};

}  // namespace

GatherReport gather(const BatchDirectory& directory, bool partial, const GatherHooks& hooks) {
  return Gatherer(directory, partial, hooks).write();
}

}  // namespace hotblade::pipeline::batch
