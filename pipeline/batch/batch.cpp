#include "pipeline/batch/batch.hpp"

#include <fmt/format.h>

#include <charconv>
#include <nlohmann/json.hpp>
#include <set>

#include "pipeline/batch/csv.hpp"
#include "pipeline/batch/mapped_file.hpp"
#include "pipeline/program/sha256.hpp"
#include "pipeline/settings/error.hpp"
#include "pipeline/settings/json_bytes.hpp"
#include "pipeline/settings/json_text.hpp"

namespace hotblade::pipeline::batch {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// The first digits of a hash name a file well enough: two of a million designs are the same by one in ten
// million.
constexpr std::size_t kNameDigits = 16;
constexpr std::size_t kKeyDigits = 64;

[[noreturn]] void fail_batch(const fs::path& file, const std::string& what) {
  throw Error(ErrorKind::kBadInput,
              file.string() + ": " + what + ": run `hotblade batch init` with --update again");
}

bool is_hash(const std::string& text) {
  return text.size() == kKeyDigits && text.find_first_not_of("0123456789abcdef") == std::string::npos;
}

template <typename Number>
Number number_in(const std::string& text, const fs::path& file, std::size_t line) {
  Number value{};
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc() && rest == text.data() + text.size()) return value;
  fail_batch(file, fmt::format("line {}: not a number ('{}')", line, text));
}

Json batch_json(const Batch& b) {
  return {{"format", "hotblade-batch"},
          {"version", 1},
          {"created_by", b.version},
          {"commit", b.commit},
          {"simd", b.simd},
          {"asked", to_json(b.asked)},
          {"panels", b.panels},
          {"designs", b.designs},
          {"jobs", b.jobs},
          {"plans", b.plans},
          {"estimate_s", b.estimate_s},
          {"chunks", b.chunks},
          {"threads", b.threads},
          {"mem_mb", b.mem_mb},
          {"minutes", b.minutes},
          {"jobs_sha256", b.jobs_sha256}};
}

Batch batch_from(const Json& json) {
  Batch b;
  b.asked = asked_from(json.at("asked"));
  json.at("created_by").get_to(b.version);
  json.at("commit").get_to(b.commit);
  json.at("simd").get_to(b.simd);
  json.at("panels").get_to(b.panels);
  json.at("designs").get_to(b.designs);
  json.at("jobs").get_to(b.jobs);
  json.at("plans").get_to(b.plans);
  json.at("estimate_s").get_to(b.estimate_s);
  json.at("chunks").get_to(b.chunks);
  json.at("threads").get_to(b.threads);
  json.at("mem_mb").get_to(b.mem_mb);
  json.at("minutes").get_to(b.minutes);
  json.at("jobs_sha256").get_to(b.jobs_sha256);
  return b;
}

}  // namespace

fs::path BatchDirectory::design(const std::string& sha256) const {
  return directory_ / "designs" / (sha256.substr(0, kNameDigits) + ".obj");
}
fs::path BatchDirectory::settings(const std::string& sha256) const {
  return directory_ / "settings" / (sha256.substr(0, kNameDigits) + ".toml");
}
fs::path BatchDirectory::chunk(int number) const {
  return directory_ / "chunks" / fmt::format("{}.csv", number);
}
fs::path BatchDirectory::stamp(int number) const {
  return directory_ / "chunks" / fmt::format("{}.done", number);
}
fs::path BatchDirectory::failures(int number) const {
  return directory_ / "chunks" / fmt::format("{}.failed.jsonl", number);
}
fs::path BatchDirectory::result(const std::string& key) const {
  return results() / key.substr(0, 2) / key;
}

std::string batch_text(const Batch& batch) {
  Json json = batch_json(batch);
  json["sha256"] = sha256_hex(json_text(json));
  return json_text(json, 2) + "\n";
}

Batch read_batch(const BatchDirectory& directory) {
  const fs::path file = directory.batch();
  std::error_code ignored;
  if (!fs::exists(file, ignored)) {
    throw Error(ErrorKind::kFile,
                directory.path().string() +
                    ": no batch is here (batch.json is missing): make one with `hotblade batch init`");
  }
  const MappedFile mapped(file);
  Json json = whole_json_if_any<Json>(mapped.text());
  if (!json.is_object() || json.value("format", "") != "hotblade-batch" || json.value("version", 0) != 1)
    fail_batch(file, "is no batch of this program");
  const std::string sha256 = json.value("sha256", "");
  json.erase("sha256");
  if (sha256 != sha256_hex(json_text(json))) fail_batch(file, "was changed, its hash is another");
  try {
    return batch_from(json);
  } catch (const nlohmann::json::exception& error) {
    fail_batch(file, error.what());
  }
}

std::string jobs_text(const JobTable& table) {
  std::vector<std::string> columns{"job", "panel", "key", "chunk"};
  columns.insert(columns.end(), table.keys.begin(), table.keys.end());
  std::string text = csv_line(columns);
  for (const Job& job : table.jobs) {
    std::vector<std::string> cells{std::to_string(job.number), job.panel, job.key, std::to_string(job.chunk)};
    cells.insert(cells.end(), job.values.begin(), job.values.end());
    text += csv_line(cells);
  }
  return text;
}

JobTable read_jobs(const BatchDirectory& directory, const Batch& batch) {
  const fs::path file = directory.jobs();
  const MappedFile mapped(file);
  if (sha256_hex(mapped.text()) != batch.jobs_sha256)
    fail_batch(file, "is not that of batch.json, its hash is another");
  const CsvTable table = parse_csv(mapped.text(), file.string());
  constexpr std::ptrdiff_t kFixed = 4;  // job, panel, key, chunk
  JobTable jobs{{table.columns.begin() + kFixed, table.columns.end()}, {}};
  for (const CsvRow& row : table.rows) {
    jobs.jobs.push_back({number_in<std::size_t>(row.cells[0], file, row.line),
                         row.cells[1],
                         row.cells[2],
                         number_in<int>(row.cells[3], file, row.line),
                         {row.cells.begin() + kFixed, row.cells.end()}});
  }
  return jobs;
}

std::string chunk_text(const std::vector<PlannedKey>& keys) {
  std::string text = csv_line({"key", "design", "settings"});
  for (const PlannedKey& one : keys) text += csv_line({one.key, one.design_sha256, one.settings_sha256});
  return text;
}

std::vector<PlannedKey> read_chunk(const BatchDirectory& directory, int number) {
  const fs::path file = directory.chunk(number);
  const CsvTable table = read_csv(file);
  std::vector<PlannedKey> keys;
  for (const CsvRow& row : table.rows) {
    if (row.cells.size() != 3 || !std::all_of(row.cells.begin(), row.cells.end(), is_hash))
      fail_batch(file, fmt::format("line {}: not a key, a design and settings", row.line));
    keys.push_back({row.cells[0], row.cells[1], row.cells[2]});
  }
  return keys;
}

std::vector<PlannedKey> read_chunk(const BatchDirectory& directory, int number, const JobTable& table) {
  std::vector<PlannedKey> keys = read_chunk(directory, number);
  std::set<std::string> there;
  for (const PlannedKey& one : keys) there.insert(one.key);
  for (const Job& job : table.jobs) {
    if (job.chunk != number || there.contains(job.key)) continue;
    fail_batch(directory.chunk(number),
               fmt::format("is not as it was made: job {} (panel {}) is missing", job.number, job.panel));
  }
  return keys;
}

}  // namespace hotblade::pipeline::batch
