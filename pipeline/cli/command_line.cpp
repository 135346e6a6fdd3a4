#include <fcntl.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <iostream>
#include <new>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "elastica/kernels/simd.hpp"
#include "pipeline/cli/batch_commands.hpp"
#include "pipeline/cli/command.hpp"
#include "pipeline/cli/help.hpp"
#include "pipeline/program/version.hpp"
#include "surface/read/design_surface.hpp"

namespace hotblade::pipeline {
namespace {

using Registrar = void (*)(CLI::App&, const Console&, Action&);
constexpr Registrar kCommands[] = {
    add_check,  add_plan,   add_place,      add_verify,  add_calibrate, add_cell,
    add_config, add_curve,  add_study,      add_preview, add_sim,       add_run,
    add_dryrun, add_export, add_completion, add_ribs,    add_batch,     add_stock,
};

std::atomic<bool> g_interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may only touch lock-free atomics");

void on_signal(int) {
  g_interrupted = true;
}

void install_signal_handlers() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

void add_global_options(CLI::App& app, Console& console) {
  app.add_flag("-q,--quiet", console.quiet, "Only warnings and errors on stderr");
  app.add_flag("-v,--verbose", console.verbose, "More on stderr");
  app.add_option("--log-file", console.log_file, "Append what goes to stderr to this file")
      ->type_name("FILE");
  app.add_option("--progress", console.progress, "auto: a bar on a terminal; json: one JSON object a line")
      ->check(CLI::IsMember({"auto", "bar", "json", "none"}))
      ->type_name("auto|bar|json|none");
  app.set_version_flag("--version", "hotblade " + version(), "Print the version and exit");
}

// The log is opened once up front, and room asked for: a wrong path or a full disk shows before any work is
// done, or a machine moves. A device or a file system that cannot tell is taken at its word.
void check_log_file(const Console& console) {
  if (console.log_file.empty()) return;
  constexpr off_t kRoom = 4096;
  const int fd = ::open(console.log_file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  int error = fd < 0 ? errno : 0;
  if (fd >= 0) {
    const off_t end = ::lseek(fd, 0, SEEK_END);
    const bool full = ::fallocate(fd, FALLOC_FL_KEEP_SIZE, std::max<off_t>(end, 0), kRoom) != 0;
    if (full && (errno == ENOSPC || errno == EDQUOT || errno == EFBIG)) error = errno;
    ::close(fd);
  }
  if (error == 0) return;
  throw Error(ErrorKind::kFile, console.log_file + ": cannot write the log (" +
                                    std::generic_category().message(error) + "): choose a writable place");
}

// A pin that this machine cannot keep shows before any work is done.
void check_simd() {
  try {
    (void)elastica::best_simd();
  } catch (const std::runtime_error& error) {
    throw Error(ErrorKind::kBadSettings, error.what());
  }
}

void expect_printed() {
  std::cout.flush();
  if (!std::cout) throw Error(ErrorKind::kFile, "stdout: cannot write the result: is the disk full?");
}

Exit run_action(const Action& action, const Console& console) {
  try {
    check_log_file(console);
    check_simd();
    const Exit code = action();
    console.end_progress();
    expect_printed();
    return code;
  } catch (const Error& error) {
    console.warn(error.what());
    return exit_of(error.kind);
  } catch (const surface::MeshError& error) {
    console.warn(error.what());
    return Exit::kBadInput;
  } catch (const surface::FileError& error) {
    console.warn(error.what());
    return Exit::kFile;
  } catch (const std::bad_alloc&) {
    console.warn("internal error: out of memory");
  } catch (const std::exception& error) {
    console.warn(std::string("internal error: ") + error.what());
  }
  return Exit::kInternal;
}

// The parser has codes of its own (105 and up) for what is one thing to the caller: wrong usage.
Exit report_usage(const CLI::App& app, const CLI::Error& error, const Console& console) {
  if (error.get_exit_code() != 0) {
    std::cerr << usage_message(app, error);
    return Exit::kUsage;
  }
  const bool told = app.exit(error) == 0;  // --help, --version
  try {
    expect_printed();
  } catch (const Error& unprinted) {
    console.warn(unprinted.what());
    return exit_of(unprinted.kind);
  }
  return told ? Exit::kOk : Exit::kUsage;
}

}  // namespace

bool interrupted() {
  return g_interrupted;
}

int run_command_line(int argc, char** argv) {
  install_signal_handlers();
  Console console;
  Action action;
  CLI::App app("hotblade: from a design surface to a program for a hot-blade cutting cell", "hotblade");
  set_help_format(app);
  app.fallthrough();
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 ok, 1 internal, 2 usage or configuration, 3 bad input, 4 not cuttable as asked,\n"
      "5 deviation over the tolerance, 6 controller, 7 file, 130 interrupted.\n"
      "Example: hotblade check vault.obj --units mm");
  add_global_options(app, console);
  for (const Registrar add : kCommands) add(app, console, action);
  try {
    // `hotblade help plan` is `hotblade plan --help`.
    if (argc > 1 && std::string_view(argv[1]) == "help") {
      std::vector<std::string> words(argv + 2, argv + argc);
      if (const std::string wrong = unknown_topic(app, words); !wrong.empty()) {
        std::cerr << wrong;
        return static_cast<int>(Exit::kUsage);
      }
      words.emplace_back("--help");
      std::reverse(words.begin(), words.end());
      app.parse(std::move(words));
    } else {
      app.parse(argc, argv);
    }
  } catch (const CLI::Error& error) {
    return static_cast<int>(report_usage(app, error, console));
  }
  return static_cast<int>(run_action(action, console));
}

}  // namespace hotblade::pipeline
