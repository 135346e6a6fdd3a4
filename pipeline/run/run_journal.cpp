#include "pipeline/run/run_journal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "pipeline/program/atomic_file.hpp"
#include "pipeline/settings/error.hpp"
#include "pipeline/settings/json_bytes.hpp"
#include "robot/wire/job.hpp"

namespace hotblade::pipeline {

namespace {

std::string text_of(const RunJournal& journal) {
  return fmt::format(R"({{"format":"hotblade-resume","version":1,"job":"{}","run":{},"token":{}}})"
                     "\n",
                     robot::to_hex(journal.job), journal.run, journal.token);
}

}  // namespace

RunJournalFile::RunJournalFile(const std::filesystem::path& program, const HostPort& controller)
    : path_(program) {
  std::string host = controller.host;
  std::replace(host.begin(), host.end(), ':', '_');  // of an IPv6 address
  path_ += fmt::format(".{}-{}.resume", host, controller.port);
}

std::optional<RunJournal> RunJournalFile::read() const {
  std::ifstream in(path_, std::ios::binary);
  if (!in) return std::nullopt;
  const std::string text((std::istreambuf_iterator<char>(in)), {});
  const auto bad = [&](const std::string& what) {
    return Error(ErrorKind::kBadInput, path_.string() + ": no journal of a run (" + what +
                                           "): remove it, and look at the controller before anything starts");
  };
  const auto json = whole_json_if_any<nlohmann::json>(text);
  if (!json.is_object()) throw bad("another format");
  const auto word = [&](const char* key) {
    const auto& value = json.at(key);
    if (!value.is_number_unsigned() || value.get<std::uint64_t>() > 0xFFFFFFFF) throw bad(key);
    return value.get<std::uint32_t>();
  };
  try {
    if (json.at("format").get<std::string>() != "hotblade-resume") throw bad("another format");
    RunJournal journal;
    const auto id = json.at("job").get<std::string>();
    const auto parsed = std::from_chars(id.data(), id.data() + id.size(), journal.job, 16);
    if (parsed.ec != std::errc() || parsed.ptr != id.data() + id.size()) throw bad("job " + id);
    journal.run = word("run");
    journal.token = word("token");
    return journal;
  } catch (const nlohmann::json::exception& error) {
    throw bad(error.what());
  }
}

void RunJournalFile::write(const RunJournal& journal) const {
  write_file_atomically(path_, text_of(journal), true);
}

void RunJournalFile::expect_writable() const {
  std::filesystem::path trial = path_;
  trial += ".trial";
  write_file_atomically(trial, text_of({~std::uint64_t{0}, ~std::uint32_t{0}, ~std::uint32_t{0}}), true);
  std::error_code ignored;
  std::filesystem::remove(trial, ignored);
}

void RunJournalFile::remove() const {
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
}

}  // namespace hotblade::pipeline
