// The execution log: append-only JSON lines, the proof of what a controller executed
// (docs/controller-protocol.md).
//
//   {"ev":"exec","job":"<16 hex>","token":T,"seq":K,"t_plan":S,"t_exec":S,"raw":"<104
//   hex>","margins":{..},"chain":"<64 hex>"}
//   {"ev":"pose","job":"<16
//   hex>","seq":K,"t":S,"frame":{..},"a":{..},"b":{..},"blade":{..},"heat":B,"state":"RUNNING"}
//
// with poses every 10 ms of simulated time in the cell frame, mm and s, and lines for changes of state. It is
// the controller's journal too: read_controller_journal().
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "robot/controller/controller_journal.hpp"
#include "robot/controller/execution_sink.hpp"

namespace hotblade::robot {

// Writes the log of one controller.
class ExecutionLog final : public ExecutionSink {
 public:
  struct Options {
    bool durable = true;  // fsync on commit
    bool poses = true;
    // Told once that lines cannot be written and why, and again once they are; by the thread that writes.
    std::function<void(const std::string&)> tell = {};
  };
  // Appends to the file, which nobody else may be writing; a torn last line, left by a crash, is dropped.
  // Throws LogError.
  ExecutionLog(std::filesystem::path file, const Options& options);
  ~ExecutionLog() override;

  void executed(const ExecutedWaypoint& waypoint) override;
  void pose(const PoseSample& sample) override;
  void event(const JobEvent& event) override;
  // Lines that found no room are kept and tried again by the next commit; until then the file ends with the
  // last whole line before them. What could not be synced may be lost: nothing is written any more.
  bool commit() override;

  // Why lines are not written (errno); 0: all are. For the thread that writes, or after it.
  [[nodiscard]] int error() const { return error_; }

 private:
  void write_out();
  void keep_from(std::size_t written);
  void make_room();
  void tell();

  std::filesystem::path file_;
  int fd_ = -1;
  Options options_;
  std::string buffer_;  // capacity reserved once; begins with a line that the file does not have yet
  int error_ = 0, told_ = 0;
  bool dirty_ = false, unsynced_ = false;
};

// What a log says about one job in one run.
struct LoggedJob {
  std::vector<std::uint32_t> sequences;    // in the order of execution
  std::vector<protocol::RawWaypoint> raw;  // the same order
  Sha256 chain{};                          // of the last executed waypoint
  bool chain_follows = true;  // every line's chain is the hash of the line before and its own bytes
  double t_exec = 0;          // s, of the last executed waypoint
};

// Returns the jobs of a log by job id; where a job was run more than once its last run counts, restarts of
// the controller included. Throws LogError, with its number, for a line that is no line of a log.
[[nodiscard]] std::map<std::uint64_t, LoggedJob> read_execution_log(const std::filesystem::path& file);

// The proof of a run: every waypoint of the job executed once, in order, bytes equal, chain equal.
struct ExecutionProof {
  std::size_t planned = 0, executed = 0;
  bool in_order = false;  // sequence numbers 0 .. planned-1, once each
  bool bytes_equal = false, chain_equal = false;
  [[nodiscard]] bool holds() const { return in_order && bytes_equal && chain_equal; }
};
// Compares what was planned with what a log says was executed.
[[nodiscard]] ExecutionProof prove(const Job& job, const LoggedJob& logged);

}  // namespace hotblade::robot
