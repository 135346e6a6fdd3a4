// hotblade sim: the controller simulator.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <chrono>
#include <cmath>
#include <iostream>
#include <memory>
#include <random>
#include <thread>

#include "pipeline/cli/command.hpp"
#include "pipeline/cli/controller_cell.hpp"
#include "pipeline/program/strip_jobs.hpp"
#include "robot/controller/controller.hpp"
#include "robot/controller/execution_log.hpp"
#include "robot/controller/server.hpp"

namespace hotblade::pipeline {
namespace {

struct SimArguments {
  std::string listen = "127.0.0.1:1502", log, machine, cell, time_scale = "1";
  std::vector<std::string> allow, faults;
  bool no_equilibrium = false;
};

double parse_time_scale(const std::string& text) {
  if (text == "max") return robot::kAsFastAsDataComes;
  std::size_t used = 0;
  double value = 0;
  try {
    value = std::stod(text, &used);
  } catch (const std::exception&) {
    used = 0;
  }
  // Above this a tick of 5 ms would be minutes of motion.
  constexpr double kLargest = 10000;
  if (used != text.size() || !(value > 0) || value > kLargest) {
    throw Error(ErrorKind::kBadSettings,
                "--time-scale: out of range (" + text + ", above 0 to 10000): use a number or max");
  }
  return value;
}

robot::ControllerOptions controller_options(const SimArguments& arguments) {
  robot::ControllerOptions options;
  options.time_scale = parse_time_scale(arguments.time_scale);
  SettingsSources sources;
  if (!arguments.machine.empty()) sources.files.emplace_back(arguments.machine);
  const Settings settings = resolve(sources);
  options.limits = motion_limits(settings.motion, settings.machine);
  options.blade.equilibrium = !arguments.no_equilibrium;
  options.blade.min_margin = settings.blade.min_margin;
  options.arms = controller_cell(arguments.cell, settings.motion, nullptr);
  options.blade.offsets = settings.machine.clamps;
  options.boot_id = std::random_device{}() | 1u;
  if (!arguments.log.empty()) options.capabilities |= robot::protocol::kCapJournal;
  return options;
}

// The log is the journal: a job that was open when the last simulator ended is open again.
void take_up_journal(const SimArguments& arguments, robot::Controller& controller, const Console& console) {
  if (arguments.log.empty()) return;
  const auto journal = robot::read_controller_journal(arguments.log);
  try {
    controller.restore(journal);
  } catch (const robot::LogError& error) {
    throw robot::LogError(arguments.log + ": " + error.what());
  }
  const auto status = controller.status();
  if (journal.loaded) {
    console.note(fmt::format("{}: job {} goes on, {} after {} of {} waypoints", arguments.log,
                             robot::to_hex(status.job_id), robot::protocol::name(status.state),
                             status.executed, journal.count));
  } else if (status.state == robot::protocol::State::kEstop) {
    console.note(arguments.log + ": ESTOP is latched");
  }
}

// Ends the server when the program is told to stop; a signal handler may not.
class StopWatch {
 public:
  explicit StopWatch(robot::ControllerServer& server)
      : thread_([this, &server] {
          constexpr auto kLook = std::chrono::milliseconds(20);
          while (!interrupted() && !done_) std::this_thread::sleep_for(kLook);
          server.stop();
        }) {}
  ~StopWatch() {
    done_ = true;
    thread_.join();
  }
  StopWatch(const StopWatch&) = delete;
  StopWatch& operator=(const StopWatch&) = delete;

 private:
  std::atomic<bool> done_ = false;
  std::thread thread_;
};

robot::SimulatedFaults simulated_faults(const SimArguments& arguments) {
  robot::SimulatedFaults faults;
  for (const std::string& spec : arguments.faults) {
    try {
      faults.add(spec);
    } catch (const robot::FaultSpecError& error) {
      throw Error(ErrorKind::kBadSettings, std::string("--fault: ") + error.what());
    }
  }
  if (faults.reboot_at && arguments.log.empty())
    throw Error(ErrorKind::kBadSettings,
                "--fault: reboot@WAYPOINT: goes on from the journal: add --log FILE");
  return faults;
}

// One life of the controller; true when it is to start again.
bool serve(const SimArguments& arguments, robot::ControllerOptions& options,
           robot::ServerOptions& server_options, const Console& console, bool first) {
  std::unique_ptr<robot::ExecutionLog> log;
  if (!arguments.log.empty()) {
    robot::ExecutionLog::Options of_log;
    of_log.tell = [&](const std::string& what) { console.warn(what); };
    log = std::make_unique<robot::ExecutionLog>(arguments.log, of_log);
  }
  robot::Controller controller(options, log.get());
  take_up_journal(arguments, controller, console);
  robot::ControllerServer server(server_options, controller);
  if (first)
    std::cout << fmt::format("listening on {}:{}\n", server_options.address, server.port()) << std::flush;
  {
    const StopWatch watch(server);
    server.run();
  }
  server_options.port = server.port();
  options.faults = controller.options().faults;  // what has happened does not happen again
  return controller.reboot_due() && !interrupted();
}

Exit sim(const SimArguments& arguments, const Console& console) {
  robot::ControllerOptions options = controller_options(arguments);
  options.faults = simulated_faults(arguments);
  const HostPort listen = parse_host_port(arguments.listen, "--listen");
  robot::ServerOptions server_options;
  server_options.address = listen.host;
  server_options.port = listen.port;
  server_options.allow = arguments.allow;
  console.note(arguments.no_equilibrium
                   ? "simulator: nothing moves, and the blade's equilibrium is not checked (--no-equilibrium)"
                   : "simulator: nothing moves; the blade's equilibrium is solved at every pose");
  if (!listen.loopback() && !arguments.allow.empty())
    console.warn(fmt::format("--listen: open to the network ({}) for {}", arguments.listen,
                             fmt::join(arguments.allow, ", ")));
  try {
    for (bool first = true; serve(arguments, options, server_options, console, first); first = false) {
      console.note("simulator: --fault reboot: starts again from " + arguments.log);
      options.boot_id = std::random_device{}() | 1u;
    }
  } catch (const robot::LogError& error) {
    throw Error(ErrorKind::kFile, error.what());
  } catch (const robot::ServerError& error) {
    throw Error(ErrorKind::kBadSettings, error.what());
  }
  return Exit::kOk;
}

}  // namespace

void add_sim(CLI::App& app, const Console& console, Action& action) {
  auto arguments = std::make_shared<SimArguments>();
  auto* command = app.add_subcommand("sim", "Simulate the cell's controller on Modbus TCP");
  command->add_option("--listen", arguments->listen, "Where to listen; port 0 takes a free one")
      ->type_name("HOST:PORT")
      ->capture_default_str();
  command
      ->add_option("--log", arguments->log,
                   "Append what is executed to this file, and go on from it after a restart")
      ->type_name("FILE");
  command->add_option("--machine", arguments->machine, "Limits from the [machine] and [motion] of this file")
      ->type_name("TOML");
  command
      ->add_option("--cell", arguments->cell,
                   "Check the arms of this cell too: a TOML file, two_irb4600 or two_kr50")
      ->type_name("CELL");
  command
      ->add_option("--time-scale", arguments->time_scale,
                   "Speed of the motion clock, or max: as fast as data comes")
      ->type_name("X|max")
      ->capture_default_str();
  command->add_option("--allow", arguments->allow, "A peer that may connect, besides this host")
      ->type_name("ADDR");
  command
      ->add_option(
          "--fault", arguments->faults,
          "What goes wrong: slow=FACTOR, fault@WAYPOINT, estop@SECONDS, reboot@WAYPOINT, stall[@WAYPOINT]")
      ->type_name("SPEC");
  command->add_flag("--no-equilibrium", arguments->no_equilibrium,
                    "Leave out the check of the blade's equilibrium; no shapes in the log");
  command->footer(
      "Ends on Ctrl-C.\nExample: hotblade sim --listen 127.0.0.1:1502 --log execution.jsonl --time-scale "
      "max");
  command->callback([arguments, &console, &action] {
    action = [arguments, &console] { return sim(*arguments, console); };
  });
}

}  // namespace hotblade::pipeline
