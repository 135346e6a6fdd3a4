#include "pipeline/batch/result.hpp"

#include <algorithm>
#include <ctime>
#include <nlohmann/json.hpp>

#include "pipeline/batch/mapped_file.hpp"
#include "pipeline/settings/error.hpp"
#include "pipeline/settings/json_bytes.hpp"
#include "pipeline/settings/json_text.hpp"

namespace hotblade::pipeline::batch {
namespace {

using Json = nlohmann::ordered_json;

}  // namespace

std::optional<std::string> verdict_of_exit(int exit_code) {
  switch (exit_code) {
    case 0:
      return kPassed;
    case 3:
      return "bad input";
    case 4:
      return "refused";
    case 5:
      return "over tolerance";
    default:
      return std::nullopt;
  }
}

std::string result_text(const Result& r) {
  Json files = Json::array();
  for (const ResultFile& file : r.files)
    files.push_back({{"name", file.name}, {"bytes", file.bytes}, {"sha256", file.sha256}});
  const Json json{{"format", "hotblade-batch-result"},
                  {"version", 1},
                  {"job", r.job},
                  {"panel", r.panel},
                  {"key", r.key},
                  {"exit", r.exit},
                  {"verdict", r.verdict},
                  {"message", r.message},
                  {"attempts", r.attempts},
                  {"seconds", r.seconds},
                  {"cpu_s", r.cpu_s},
                  {"peak_mb", r.peak_mb},
                  {"node", r.node},
                  {"engine_job", r.engine_job},
                  {"created_by", r.version},
                  {"simd", r.simd},
                  {"started", r.started},
                  {"finished", r.finished},
                  {"files", files},
                  {"color", r.color}};
  return json_text(json, 2) + "\n";
}

Result read_result(const std::filesystem::path& directory) {
  const std::filesystem::path file = directory / "result.json";
  const MappedFile mapped(file);
  try {
    const Json json = whole_json<Json>(mapped.text());
    if (json.at("format") != "hotblade-batch-result" || json.at("version") != 1)
      throw Error(ErrorKind::kBadInput, file.string() + ": is no result of this program");
    Result r;
    json.at("job").get_to(r.job);
    json.at("panel").get_to(r.panel);
    json.at("key").get_to(r.key);
    json.at("exit").get_to(r.exit);
    json.at("verdict").get_to(r.verdict);
    json.at("message").get_to(r.message);
    json.at("attempts").get_to(r.attempts);
    json.at("seconds").get_to(r.seconds);
    json.at("cpu_s").get_to(r.cpu_s);
    json.at("peak_mb").get_to(r.peak_mb);
    json.at("node").get_to(r.node);
    json.at("engine_job").get_to(r.engine_job);
    json.at("created_by").get_to(r.version);
    json.at("simd").get_to(r.simd);
    json.at("started").get_to(r.started);
    json.at("finished").get_to(r.finished);
    r.color = json.value("color", "");
    for (const Json& one : json.at("files"))
      r.files.push_back({one.at("name").get<std::string>(), one.at("bytes").get<std::uintmax_t>(),
                         one.at("sha256").get<std::string>()});
    return r;
  } catch (const nlohmann::json::exception& error) {
    throw Error(ErrorKind::kBadInput, file.string() + ": is no result (" + error.what() +
                                          "): remove its directory, and plan it again");
  }
}

bool has_result(const BatchDirectory& directory, const std::string& key) {
  const std::filesystem::path place = directory.result(key);
  std::error_code error;
  if (!std::filesystem::exists(place / "result.json", error)) return false;
  try {
    const Result result = read_result(place);
    return std::all_of(result.files.begin(), result.files.end(), [&](const ResultFile& file) {
      const std::uintmax_t bytes = std::filesystem::file_size(place / file.name, error);
      // Who needs the room may take the others away.
      return error ? file.name != kReportFile : bytes == file.bytes;
    });
  } catch (const Error&) {
    return false;
  }
}

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  ::gmtime_r(&now, &parts);
  std::string text(20, '\0');
  text.resize(std::strftime(text.data(), text.size() + 1, "%Y-%m-%dT%H:%M:%SZ", &parts));
  return text;
}

}  // namespace hotblade::pipeline::batch
