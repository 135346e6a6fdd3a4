// A controller with its server on a free loopback port and a log in a temporary file, for as long as the test
// runs.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <memory>
#include <string>
#include <thread>

#include "robot/controller/controller.hpp"
#include "robot/controller/execution_log.hpp"
#include "robot/controller/server.hpp"

namespace hotblade::robot::testing {

class Simulator {
 public:
  explicit Simulator(const ControllerOptions& options, ServerOptions server_options = {}) {
    static int number = 0;
    file_ = std::filesystem::temp_directory_path() /
            ("hotblade_robot_" + std::to_string(::getpid()) + "_" + std::to_string(number++) + ".jsonl");
    log_ = std::make_unique<ExecutionLog>(file_, ExecutionLog::Options{false, true});
    controller_ = std::make_unique<Controller>(options, log_.get());
    server_options.port = 0;
    server_ = std::make_unique<ControllerServer>(server_options, *controller_);
    thread_ = std::thread([this] { server_->run(); });
  }
  ~Simulator() {
    stop();
    std::filesystem::remove(file_);
  }
  Simulator(const Simulator&) = delete;
  Simulator& operator=(const Simulator&) = delete;

  [[nodiscard]] std::uint16_t port() const { return server_->port(); }
  [[nodiscard]] const std::filesystem::path& log_file() const { return file_; }
  void stop() {
    if (!thread_.joinable()) return;
    server_->stop();
    thread_.join();
    log_.reset();
  }
  // Stops, and compares the log with the job.
  [[nodiscard]] ExecutionProof proof_of(const Job& job) {
    stop();
    const auto jobs = read_execution_log(file_);
    const auto found = jobs.find(job.id);
    return found == jobs.end() ? ExecutionProof{job.raw.size(), 0, false, false, false}
                               : prove(job, found->second);
  }

 private:
  std::filesystem::path file_;
  std::unique_ptr<ExecutionLog> log_;
  std::unique_ptr<Controller> controller_;
  std::unique_ptr<ControllerServer> server_;
  std::thread thread_;
};

}  // namespace hotblade::robot::testing
