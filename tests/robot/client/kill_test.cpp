// Streams through a link that spoils every fourth request, while client and controller are killed and started
// again: every waypoint is executed once, in order, as planned.
//
// HOTBLADE_STREAM_FAULTS=full: 50 runs of 5,000 waypoints (minutes); otherwise a few short ones.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <new>
#include <stdexcept>
#include <thread>

#include "robot/client/client.hpp"
#include "robot/controller/controller.hpp"
#include "robot/controller/execution_log.hpp"
#include "robot/controller/server.hpp"
#include "tests/robot/controller/fault_proxy.hpp"
#include "tests/robot/wire/sample_job.hpp"

namespace hotblade::robot {
namespace {

using protocol::State;
using testing::FaultProxy;
using testing::sample_job;

constexpr int kLate_ms = 60;  // longer than the client waits
constexpr std::uint32_t kResponse_ms = 40;

struct Scale {
  unsigned runs = 3, parallel = 3;
  std::size_t waypoints = 200;
};
Scale scale() {
  const char* wanted = std::getenv("HOTBLADE_STREAM_FAULTS");
  if (wanted == nullptr || std::strcmp(wanted, "full") != 0) return {};
  return {50, 10, 5000};
}

// A process that runs `work` and nothing of what it inherits.
template <typename Work>
pid_t start_process(Work work) {
  const pid_t child = ::fork();
  if (child != 0) return child;
  ::close_range(3, ~0U, 0);
  ::_exit(work());
}
int end_of(pid_t child) {
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

// One job, a controller and a client as processes, and a bad link between them.
class Ordeal {
 public:
  Ordeal(unsigned seed, std::size_t waypoints)
      : seed_(seed), random_(seed), job_(sample_job(waypoints, "S001", 20000)), port_(free_port()) {
    log_ = std::filesystem::temp_directory_path() /
           ("hotblade_kill_" + std::to_string(::getpid()) + "_" + std::to_string(seed) + ".jsonl");
    std::filesystem::remove(log_);
  }
  ~Ordeal() { std::filesystem::remove(log_); }

  // What went wrong; empty when nothing did.
  std::string run() {
    boot();
    FaultProxy proxy(port_, 0.25, kLate_ms, seed_);
    proxy_port_ = proxy.port();
    start_client(false);
    // In a random order, up to the very end, when the job may be closed before a kill arrives.
    std::vector<std::pair<std::uint32_t, bool>> kills;
    for (const bool of_controller : {true, true, false}) {
      kills.emplace_back(std::uniform_int_distribution(1u, job_.size())(random_), of_controller);
    }
    std::sort(kills.begin(), kills.end());
    for (const auto& [after, of_controller] : kills) {
      if (!wait_for(after)) return "stuck before waypoint " + std::to_string(after);
      of_controller ? restart_controller() : restart_client();
    }
    const int code = end_of(client_);
    faults = proxy.faults_done();
    ::kill(controller_, SIGKILL);
    end_of(controller_);
    if (code != 0) return "the client ended with " + std::to_string(code);
    return judge();
  }
  int faults = 0;

 private:
  // One that stays free while the controller is dead: below those that are given to connections.
  static std::uint16_t free_port() {
    static std::atomic<unsigned> tried = 0;
    constexpr unsigned kFirst = 12000, kPorts = 20000, kApart = 131;
    for (;;) {
      const unsigned place = static_cast<unsigned>(::getpid()) * kApart + tried++;
      Controller controller{ControllerOptions{}};
      ServerOptions options;
      options.port = static_cast<std::uint16_t>(kFirst + place % kPorts);
      try {
        return ControllerServer(options, controller).port();
      } catch (const ServerError&) {
      }
    }
  }
  void boot() {
    controller_ = start_process([this] {
      ControllerOptions options;
      options.time_scale = 20;  // so that kills find the clamps between waypoints
      options.boot_id = std::random_device{}() | 1u;
      options.watchdog_ms = 300;
      options.lease_ms = 600;
      options.heat_dwell_ms = 50;  // kerfs are left and re-entered on the way
      ServerOptions server_options;
      server_options.port = port_;
      ExecutionLog log(log_, {});
      Controller controller(options, &log);
      controller.restore(read_controller_journal(log_));
      ControllerServer(server_options, controller).run();
      return 0;
    });
  }
  void start_client(bool resume) {
    client_ = start_process([this, resume] {
      StreamOptions options;
      options.port = proxy_port_;
      options.response_ms = kResponse_ms;
      options.poll_ms = 2;
      options.resume = resume;
      const auto report = stream(job_, options);
      if (report.outcome != StreamOutcome::kDone) std::fprintf(stderr, "%s\n", report.message.c_str());
      return report.outcome == StreamOutcome::kDone ? 0 : 1;
    });
  }
  void restart_controller() {
    ::kill(controller_, SIGKILL);
    end_of(controller_);
    boot();
  }
  void restart_client() {
    ::kill(client_, SIGKILL);
    end_of(client_);
    start_client(true);
  }
  bool wait_for(std::uint32_t executed) {
    StreamOptions options;
    options.port = port_;
    const auto patience = std::chrono::steady_clock::now() + std::chrono::minutes(5);
    while (std::chrono::steady_clock::now() < patience) {
      const auto now = look(options);
      if (now.reached && now.status.job_id == job_.id && now.status.executed >= executed) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  }
  [[nodiscard]] int opened() const {
    int count = 0;
    std::ifstream in(log_);
    for (std::string line; std::getline(in, line);) count += line.starts_with("{\"ev\":\"open\"") ? 1 : 0;
    return count;
  }
  std::string judge() {
    const auto logged = read_execution_log(log_);
    const auto found = logged.find(job_.id);
    if (found == logged.end()) return "nothing was executed";
    const auto proof = prove(job_, found->second);
    if (opened() != 1) return "opened " + std::to_string(opened()) + " times";
    if (proof.holds()) return "";
    return std::to_string(proof.executed) + " of " + std::to_string(proof.planned) + " executed" +
           (proof.in_order ? "" : ", out of order") + (proof.bytes_equal ? "" : ", other bytes") +
           (proof.chain_equal ? "" : ", another chain");
  }

  unsigned seed_;
  std::mt19937 random_;
  Job job_;
  std::uint16_t port_, proxy_port_ = 0;
  std::filesystem::path log_;
  pid_t controller_ = 0, client_ = 0;
};

// What the workers, processes of their own, tell the test.
struct Tally {
  std::atomic<int> runs, wrong, faults;
};
Tally& shared_tally() {
  void* memory = ::mmap(nullptr, sizeof(Tally), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) throw std::runtime_error("no shared memory");
  return *new (memory) Tally{};
}

TEST(Kill, EveryFourthRequestSpoiltClientAndControllerKilledExecutedIsPlanned) {
  const Scale wanted = scale();
  Tally& tally = shared_tally();
  std::vector<pid_t> workers;
  // Processes, not threads: a process that is forked while another thread looks up an address can do so no
  // more.
  for (unsigned worker = 0; worker < wanted.parallel; ++worker) {
    workers.push_back(start_process([&] {
      for (unsigned seed = 1 + worker; seed <= wanted.runs; seed += wanted.parallel) {
        Ordeal ordeal(seed, wanted.waypoints);
        const std::string wrong = ordeal.run();
        if (!wrong.empty()) std::fprintf(stderr, "seed %u: %s\n", seed, wrong.c_str());
        ++tally.runs;
        tally.wrong += wrong.empty() ? 0 : 1;
        tally.faults += ordeal.faults;
      }
      return 0;
    }));
  }
  for (const pid_t worker : workers) EXPECT_EQ(end_of(worker), 0);
  EXPECT_EQ(tally.runs, static_cast<int>(wanted.runs));
  EXPECT_EQ(tally.wrong, 0);
  EXPECT_GT(tally.faults, static_cast<int>(wanted.runs * wanted.waypoints / 4 / 5))
      << "of at least a window each";
  RecordProperty("faults", tally.faults);
}

}  // namespace
}  // namespace hotblade::robot
