#include "pipeline/run/dryrun.hpp"

#include <algorithm>
#include <memory>
#include <system_error>
#include <thread>

#include "pipeline/settings/error.hpp"
#include "robot/controller/controller.hpp"
#include "robot/controller/server.hpp"

namespace hotblade::pipeline {
namespace {

// A simulator on a free loopback port, for as long as the object lives.
class LocalSimulator {
 public:
  explicit LocalSimulator(const DryRunOptions& options)
      : log_(options.log_file, {false, true}),
        controller_(as_fast_as_data_comes(options), &log_),
        server_(any_port(), controller_),
        thread_([this] { server_.run(); }) {}
  ~LocalSimulator() { stop(); }
  LocalSimulator(const LocalSimulator&) = delete;
  LocalSimulator& operator=(const LocalSimulator&) = delete;
  [[nodiscard]] std::uint16_t port() const { return server_.port(); }

  // Ends the simulator and returns why its log could not be written; 0: it was.
  int stop() {
    if (!thread_.joinable()) return log_.error();
    server_.stop();
    thread_.join();
    (void)log_.commit();
    return log_.error();
  }

 private:
  static robot::ControllerOptions as_fast_as_data_comes(const DryRunOptions& dry) {
    robot::ControllerOptions options;
    options.limits = dry.limits;
    options.blade = dry.blade;
    options.arms = dry.arms;
    options.time_scale = robot::kAsFastAsDataComes;
    return options;
  }
  static robot::ServerOptions any_port() {
    robot::ServerOptions options;
    options.port = 0;
    return options;
  }

  robot::ExecutionLog log_;
  robot::Controller controller_;
  robot::ControllerServer server_;
  std::thread thread_;
};

void stream_all(const std::vector<robot::Job>& jobs, std::uint16_t port, const DryRunOptions& options,
                DryRunReport& report) {
  std::size_t total = 0, done = 0;
  for (const robot::Job& job : jobs) total += job.size();
  for (const robot::Job& job : jobs) {
    robot::StreamOptions stream_options;
    stream_options.port = port;
    stream_options.poll_ms = 1;
    stream_options.interrupted = options.interrupted;
    stream_options.progress = [&](const robot::StreamProgress& p) {
      if (options.progress)
        options.progress(job.strip, static_cast<double>(done + p.executed) / static_cast<double>(total));
    };
    report.strips.push_back({job.strip, duration_s(job), robot::stream(job, stream_options), {}});
    done += job.size();
    const auto outcome = report.strips.back().stream.outcome;
    report.interrupted = outcome == robot::StreamOutcome::kInterrupted;
    if (outcome != robot::StreamOutcome::kDone) return;
  }
}

}  // namespace

bool DryRunReport::holds() const {
  return strips.size() == planned_strips &&
         std::all_of(strips.begin(), strips.end(), [](const StripDryRun& strip) { return strip.holds(); });
}

DryRunReport dry_run(const std::vector<robot::Job>& jobs, const DryRunOptions& options) {
  DryRunReport report;
  report.planned_strips = jobs.size();
  try {
    {
      LocalSimulator simulator(options);
      stream_all(jobs, simulator.port(), options, report);
      if (const int error = simulator.stop(); error != 0) {
        throw Error(ErrorKind::kFile, options.log_file.string() + ": the log cannot be written (" +
                                          std::generic_category().message(error) +
                                          "): the dry run was stopped; make room, or choose another --log");
      }
    }
    const auto logged = robot::read_execution_log(options.log_file);
    for (std::size_t i = 0; i < report.strips.size(); ++i) {
      const auto found = logged.find(jobs[i].id);
      report.strips[i].proof =
          robot::prove(jobs[i], found == logged.end() ? robot::LoggedJob{} : found->second);
    }
  } catch (const robot::LogError& error) {
    throw Error(ErrorKind::kFile, error.what());
  } catch (const robot::ServerError& error) {
    throw Error(ErrorKind::kController, error.what());
  }
  return report;
}

}  // namespace hotblade::pipeline
