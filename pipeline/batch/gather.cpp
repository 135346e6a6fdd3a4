#include "pipeline/batch/gather.hpp"

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "pipeline/batch/csv.hpp"
#include "pipeline/batch/cut_page.hpp"
#include "pipeline/batch/database.hpp"
#include "pipeline/batch/given_lines.hpp"
#include "pipeline/batch/index_page.hpp"
#include "pipeline/batch/plan_facts.hpp"
#include "pipeline/program/atomic_file.hpp"
#include "pipeline/settings/error.hpp"
#include "pipeline/settings/json_text.hpp"
#include "pipeline/settings/settings.hpp"

namespace hotblade::pipeline::batch {
namespace {

namespace fs = std::filesystem;
using Columns = std::vector<std::string>;

// Sizes of blocks unless another step is asked for.
constexpr double kWholeMm = 1;

// Settings as pairs of key and value: "design.tolerance_mm", 1.
std::vector<Cells> flat_settings(const fs::path& file) {
  std::vector<Cells> flat;
  const nlohmann::ordered_json all = to_json(resolve({{file}, {}, {}}));
  for (const auto& [section, keys] : all.items()) {
    if (!keys.is_object()) continue;
    for (const auto& [key, value] : keys.items()) {
      const std::string text = value.is_string() ? value.get<std::string>() : json_text(value);
      flat.push_back({{section + "." + key, false}, {text, value.is_number()}});
    }
  }
  return flat;
}

std::string name_of(const BatchDirectory& directory) {
  return fs::weakly_canonical(directory.path()).filename().string();
}

void write_cut_list(const BatchDirectory& directory, const CutList& list) {
  write_file_atomically(directory.path() / "cut_list.csv", cut_list_table(list), true);
  write_file_atomically(directory.path() / "cut_list.html", cut_page(name_of(directory), list), true);
}

// The foam of a cut list, by the settings of its jobs' plans.
FoamList foam_of(const BatchDirectory& directory, const BatchFacts& all, const CutList& list,
                 const GatherHooks& hooks) {
  std::map<std::size_t, const Job*> jobs;  // by number
  for (const Job& job : all.table.jobs) jobs.emplace(job.number, &job);
  std::map<std::string, SoldFoam> sold;  // by the settings' hash
  const auto sold_for = [&](std::size_t number) {
    const std::string& sha256 = all.planned.at(jobs.at(number)->key).settings_sha256;
    auto found = sold.find(sha256);
    if (found == sold.end()) {
      const StockSettings stock = resolve({{directory.settings(sha256)}, {}, {}}).stock;
      found = sold.emplace(sha256, SoldFoam{stock.sizes_mm, stock.saw_mm}).first;
    }
    return found->second;
  };
  return foam_list(list, sold_for, [&hooks] {
    if (hooks.stop && hooks.stop()) throw Error(ErrorKind::kInterrupted, "interrupted: no foam was listed");
  });
}

void write_foam(const BatchDirectory& directory, const FoamList& foam, const CutList& list) {
  const fs::path table = directory.path() / "foam.csv", page = directory.path() / "foam.html";
  if (foam.empty()) {
    // What an earlier gathering said holds no more.
    std::error_code none_there;
    fs::remove(table, none_there);
    fs::remove(page, none_there);
    return;
  }
  write_file_atomically(table, foam_table(foam, list), true);
  write_file_atomically(page, foam_page(name_of(directory), foam, list), true);
}

class Gatherer {
 public:
  Gatherer(const BatchDirectory& directory, bool partial, const GatherHooks& hooks)
      : directory_(directory), hooks_(hooks), all_(read_facts(directory, partial, hooks)) {
    name_given_lines(directory, all_);
  }

  GatherReport write() {
    write_csv();
    write_database();
    const std::vector<JobFacts> rows = all_.rows();
    write_file_atomically(directory_.path() / "index.html", index_page(name_of(directory_), all_.table, rows),
                          true);
    const CutList list = cut_list(rows, kWholeMm);
    write_cut_list(directory_, list);
    write_foam(directory_, foam_of(directory_, all_, list, hooks_), list);
    return {all_.table.jobs.size(), all_.missing};
  }

 private:
  [[nodiscard]] Columns columns() const {
    Columns all{"job", "panel", "key"};
    all.insert(all.end(), all_.table.keys.begin(), all_.table.keys.end());
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
    const Cells& plan = all_.of_key.at(job.key).cells;
    all.insert(all.end(), plan.begin(), plan.end());
    return all;
  }

  void write_csv() const {
    write_file_atomically(
        directory_.path() / "results.csv",
        [this](const WritePiece& write_piece) {
          write_piece(csv_line(columns()));
          for (const Job& job : all_.table.jobs) {
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
      for (const Job& job : all_.table.jobs) jobs.add(cells_of(job));
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
    for (const Job& job : all_.table.jobs) {
      for (const Cells& cells : all_.of_key.at(job.key).*rows) table.add(with_job(job, cells));
    }
  }

  void write_settings(Database& database) const {
    std::map<std::string, std::vector<Cells>> flat;  // by the settings' hash
    Database::Table table = database.table("settings", {"job", "key", "value"});
    for (const Job& job : all_.table.jobs) {
      const std::string& sha256 = all_.planned.at(job.key).settings_sha256;
      auto found = flat.find(sha256);
      if (found == flat.end()) found = flat.emplace(sha256, flat_settings(directory_.settings(sha256))).first;
      for (const Cells& cells : found->second) table.add(with_job(job, cells));
    }
  }

  const BatchDirectory& directory_;
  const GatherHooks& hooks_;
  BatchFacts all_;
};

}  // namespace

GatherReport gather(const BatchDirectory& directory, bool partial, const GatherHooks& hooks) {
  return Gatherer(directory, partial, hooks).write();
}

StockReport list_stock(const BatchDirectory& directory, bool partial, double step_mm,
                       const GatherHooks& hooks) {
  const BatchFacts all = read_facts(directory, partial, hooks);
  StockReport report{cut_list(all.rows(), step_mm), {}, all.missing};
  report.foam = foam_of(directory, all, report.list, hooks);
  write_cut_list(directory, report.list);
  write_foam(directory, report.foam, report.list);
  return report;
}

}  // namespace hotblade::pipeline::batch
