// What a log proves about a job.
#include <fstream>

#include "robot/controller/execution_log.hpp"
#include "robot/controller/log_line.hpp"

namespace hotblade::robot {
namespace {

void take_executed(const Line& line, std::uint64_t id, LoggedJob& job) {
  const auto sequence = line.number<std::uint32_t>("seq", line.raw_value("seq"));
  protocol::RawWaypoint raw{};
  Sha256 chain{};
  line.bytes("raw", raw);
  line.bytes("chain", chain);
  Chain expected(id);
  if (!job.raw.empty()) expected.resume(job.chain);
  job.chain_follows = job.chain_follows && expected.add(raw) == chain;
  job.sequences.push_back(sequence);
  job.raw.push_back(raw);
  job.chain = chain;
  job.t_exec = line.number<double>("t_exec", line.raw_value("t_exec"));
}

}  // namespace

std::map<std::uint64_t, LoggedJob> read_execution_log(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) throw LogError(file.string() + ": cannot be read: check the path");
  std::map<std::uint64_t, LoggedJob> jobs;
  std::size_t number = 0;
  for (std::string text; std::getline(in, text);) {
    ++number;
    if (in.eof()) break;  // a line without its end was never committed
    if (text.starts_with("{\"ev\":\"pose\"")) continue;
    const std::string place = file.string() + ":" + std::to_string(number);
    const Line line(text, place);
    const auto ev = line.string("ev");
    const auto id = line.number<std::uint64_t>("job", line.string("job"), 16);
    if (ev == "open") jobs[id] = {};  // another run of the same job
    if (ev == "exec") take_executed(line, id, jobs[id]);
  }
  return jobs;
}

ExecutionProof prove(const Job& job, const LoggedJob& logged) {
  ExecutionProof proof;
  proof.planned = job.raw.size();
  proof.executed = logged.sequences.size();
  proof.in_order = proof.planned == proof.executed;
  for (std::size_t i = 0; i < logged.sequences.size(); ++i) {
    proof.in_order = proof.in_order && logged.sequences[i] == i;
  }
  proof.bytes_equal = logged.raw == job.raw;
  Chain chain(job.id);
  for (const auto& raw : job.raw) chain.add(raw);
  proof.chain_equal = logged.chain_follows && logged.chain == chain.value();
  return proof;
}

}  // namespace hotblade::robot
