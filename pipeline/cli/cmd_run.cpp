// hotblade run: streams a program to a controller, strip by strip.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "pipeline/cli/command.hpp"
#include "pipeline/cli/operator_answer.hpp"
#include "pipeline/cli/run_dialogue.hpp"
#include "pipeline/cli/shell_word.hpp"
#include "pipeline/program/strip_jobs.hpp"
#include "pipeline/run/run_journal.hpp"
#include "robot/client/client.hpp"
#include "robot/client/fault_text.hpp"

namespace hotblade::pipeline {
namespace {

using robot::Job;
using robot::StreamOutcome;
using robot::StreamProgress;
using robot::protocol::State;

struct RunArguments {
  std::string program, connect, strip, recover;
  bool resume = false, reset = false, yes = false, overridden = false, allow_remote = false;
};

// Which strips are streamed, and how the first of them begins.
struct Plan {
  std::size_t first = 0, end = 0;
  bool resume_first = false;
  bool agreed_first = false;  // the operator chose to restart it
  std::uint32_t run = 0;
  std::uint32_t agreed_boot = 0;  // the controller's boot id when the operator agreed
};

// Of an outcome that is not kDone.
ErrorKind kind_of(StreamOutcome outcome) {
  return outcome == StreamOutcome::kInterrupted ? ErrorKind::kInterrupted : ErrorKind::kController;
}

void require_attended(const RunArguments& arguments, const HostPort& where) {
  if (!where.loopback() && !arguments.allow_remote) {
    throw Error(ErrorKind::kBadSettings,
                "--connect: not this host (" + arguments.connect +
                    "): a machine may start to move; add --allow-remote if that is meant");
  }
  if (arguments.yes) return;
  if (::isatty(STDIN_FILENO) == 0) {
    throw Error(ErrorKind::kBadSettings,
                "stdin: no terminal to ask before a strip starts: add --yes to start without asking");
  }
  if (::isatty(STDERR_FILENO) == 0) {
    throw Error(
        ErrorKind::kBadSettings,
        "stderr: no terminal to show the questions on: --log-file keeps what is said, or add --yes to "
        "start without asking");
  }
}

std::size_t index_of(const std::vector<Job>& jobs, const std::string& strip) {
  std::string known;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    if (jobs[i].strip == strip) return i;
    known += (i > 0 ? ", " : "") + jobs[i].strip;
  }
  throw Error(ErrorKind::kBadSettings, "--strip: unknown strip (" + strip + "): the program has " + known);
}

// Whether the controller is still the one our own journal speaks of, and has the job as we left it.
void check_journal(const std::vector<Job>& jobs, const RunJournal& ours,
                   const robot::protocol::Status& status, const std::string& place) {
  const auto job = std::find_if(jobs.begin(), jobs.end(), [&](const Job& j) { return j.id == ours.job; });
  if (job == jobs.end()) return;  // of another version of the program
  if (status.job_id == ours.job && status.run == ours.run && status.token >= ours.token) return;
  throw Error(
      ErrorKind::kController,
      fmt::format("{}: strip {} was under way (run {}, token {}), but the controller knows run {} of job {} "
                  "with token {}: another controller, or one without its log; see to the block, then start "
                  "anew with --strip {}",
                  place, job->strip, ours.run, ours.token, status.run, robot::to_hex(status.job_id),
                  status.token, job->strip));
}

// Where a run that was left goes on, from what the controller remembers of its last job.
void find_resume_point(const std::vector<Job>& jobs, const robot::ControllerSnapshot& now,
                       const std::string& place, Plan& plan) {
  const auto& status = now.status;
  const auto found =
      std::find_if(jobs.begin(), jobs.end(), [&](const Job& job) { return job.id == status.job_id; });
  if (found == jobs.end()) {
    if (status.state == State::kIdle) return;  // nothing was begun
    throw Error(ErrorKind::kController, place + ": another job is open (" + robot::to_hex(status.job_id) +
                                            "): this program has nothing to resume there");
  }
  const auto index = static_cast<std::size_t>(found - jobs.begin());
  const bool whole = status.executed == found->size();
  plan.run = status.run;
  plan.resume_first = status.state != State::kIdle;
  plan.first = std::max(plan.first, plan.resume_first || !whole ? index : index + 1);
  if (status.state == State::kIdle && !whole && status.executed > 0) {
    throw Error(ErrorKind::kController,
                fmt::format("{}: strip {} was given up ({} of {} waypoints executed): see to the block, then "
                            "start it anew with --strip {}",
                            place, found->strip, status.executed, found->size(), found->strip));
  }
}

// Said before anything is asked: without --resume a strip that is under way is not started from its
// beginning.
void refuse_open_job(const std::vector<Job>& jobs, const robot::protocol::Status& status,
                     const std::string& place) {
  if (status.state == State::kIdle || status.state == State::kFault || status.state == State::kEstop) return;
  const auto open =
      std::find_if(jobs.begin(), jobs.end(), [&](const Job& job) { return job.id == status.job_id; });
  if (open == jobs.end()) return;
  const bool may_end = status.state == State::kHeld || status.state == State::kRunning;
  throw Error(
      ErrorKind::kController,
      fmt::format("{}: strip {} is under way ({}, {} of {} waypoints executed): --resume takes it over{}",
                  place, open->strip, robot::protocol::name(status.state), status.executed, open->size(),
                  may_end ? ", --recover withdraw or give-up ends it" : ""));
}

Plan make_plan(const RunArguments& arguments, const std::vector<Job>& jobs,
               const robot::ControllerSnapshot& now) {
  Plan plan;
  plan.end = jobs.size();
  plan.run = now.status.run + 1;
  if (arguments.resume) {
    find_resume_point(jobs, now, arguments.connect, plan);
  } else {
    refuse_open_job(jobs, now.status, arguments.connect);
  }
  if (arguments.strip.empty()) return plan;
  const std::size_t wanted = index_of(jobs, arguments.strip);
  if (plan.resume_first && plan.first != wanted) {
    throw Error(ErrorKind::kController, arguments.connect + ": strip " + jobs[plan.first].strip +
                                            " is open, not " + arguments.strip + ": resume that one first");
  }
  if (arguments.resume && plan.first > wanted) {
    plan.first = plan.end = wanted;  // it is done
    return plan;
  }
  plan.first = wanted;
  plan.end = wanted + 1;
  return plan;
}

// Said before anything is asked: a yes would move nothing.
void refuse_latched(const StripJobs& work, const robot::protocol::Status& status, const std::string& place) {
  if (status.state != State::kFault && status.state != State::kEstop) return;
  std::string at;
  for (std::size_t i = 0; i < work.jobs.size(); ++i) {
    if (work.jobs[i].id == status.job_id && status.executed > 0)
      at = place_of(work.program.strips[i], status.executed - 1);
  }
  const std::string log = robot::log_fault_text(status);
  throw Error(ErrorKind::kController,
              fmt::format("{}: the controller is in {}{}: {}, then reset with --reset", place,
                          robot::state_text(status), at, log.empty() ? "see to the cell" : log));
}

// The command that runs the program again there, for a shell.
std::string run_line(const RunArguments& arguments, const std::vector<std::string>& more) {
  std::vector<std::string> words{"hotblade", "run", arguments.program, "--connect", arguments.connect};
  words.insert(words.end(), more.begin(), more.end());
  if (arguments.overridden) words.emplace_back("--override");
  if (arguments.allow_remote) words.emplace_back("--allow-remote");
  return shell_line(words);
}

// Asks the operator before a strip; true only for a typed `yes` or the strip's own id. What was typed before
// the question is thrown away: it answered something else.
bool operator_agrees(const RunArguments& arguments, const Strip& strip, const Job& job,
                     const robot::ControllerSnapshot& controller, bool resumes, const Console& console) {
  if (arguments.yes) return true;
  console.end_progress();
  const auto& status = controller.status;
  if (resumes && status.state == State::kDone && status.executed == job.size()) {
    console.warn(fmt::format("strip {}: all {} waypoints were executed meanwhile; nothing moves", strip.id,
                             job.size()));
    return true;
  }
  const auto line = ask(start_question(strip, job, controller.status, resumes));
  if (line && agrees_to_start(*line, strip.id)) return true;
  std::vector<std::string> more{"--strip", strip.id};
  if (resumes) more.insert(more.begin(), "--resume");
  console.warn(fmt::format("strip {} not started; to go on: {}", strip.id, run_line(arguments, more)));
  return false;
}

class Runner {
 public:
  Runner(const RunArguments& arguments, const HostPort& where, const Console& console)
      : arguments_(arguments), console_(console), journal_(arguments.program, where) {
    link_.host = where.host;
    link_.port = where.port;
    link_.interrupted = [] { return interrupted(); };
  }

  Exit run(const StripJobs& work);

 private:
  robot::ControllerSnapshot meet();
  void wait_for_rest(robot::ControllerSnapshot& now) const;
  Plan plan_with(const StripJobs& work, const robot::ControllerSnapshot& now);
  std::optional<Recovery> choose_recovery(const std::string& text);
  Plan recover(const StripJobs& work, const robot::ControllerSnapshot& now);
  void refuse_nothing_left(const robot::protocol::Status& status) const;
  Plan end_left_strip(Recovery recovery, const Strip& strip, const Job& job, std::uint32_t run);
  bool may_go_on(const Job& job, const robot::protocol::Status& status);
  Exit run_strip(const StripJobs& work, std::size_t index, const Plan& plan, std::size_t total,
                 std::size_t done);

  const RunArguments& arguments_;
  const Console& console_;
  RunJournalFile journal_;
  robot::StreamOptions link_;
  std::optional<Exit> stopped_;  // what was left half cut was dealt with, and nothing else is done
};

robot::ControllerSnapshot Runner::meet() {
  if (arguments_.reset) {
    const auto cleared = robot::reset(link_);
    if (cleared.outcome != StreamOutcome::kDone) throw Error(kind_of(cleared.outcome), cleared.message);
    journal_.remove();
  }
  auto now = robot::look(link_);
  if (!now.reached) throw Error(ErrorKind::kController, now.message);
  if (arguments_.resume || !arguments_.recover.empty()) wait_for_rest(now);
  const auto capabilities = now.ident.capabilities;
  if ((capabilities & robot::protocol::kCapSimulator) != 0)
    console_.note("controller: a simulator, nothing moves");
  if ((capabilities & robot::protocol::kCapEquilibrium) == 0) {
    console_.note("controller: does not check the blade's equilibrium");
  }
  return now;
}

// A machine that moves for a client that is gone is held by its watchdog: what is asked then is about one
// that stands.
void Runner::wait_for_rest(robot::ControllerSnapshot& now) const {
  if (now.status.state != State::kRunning) return;
  console_.warn(
      "the controller still moves for a client that is gone: waiting until its watchdog has held it");
  const auto patience = std::chrono::steady_clock::now() + std::chrono::milliseconds(now.ident.lease_ms);
  while (now.status.state == State::kRunning) {
    if (interrupted()) throw Error(ErrorKind::kInterrupted, "interrupted");
    if (std::chrono::steady_clock::now() > patience)
      throw Error(ErrorKind::kController,
                  arguments_.connect + ": the controller moves for another client: wait until that is done");
    constexpr auto kLook = std::chrono::milliseconds(50);
    std::this_thread::sleep_for(kLook);
    now = robot::look(link_);
    if (!now.reached) throw Error(ErrorKind::kController, now.message);
  }
}

Plan Runner::plan_with(const StripJobs& work, const robot::ControllerSnapshot& now) {
  const bool told = !arguments_.recover.empty();
  if (told) refuse_latched(work, now.status, arguments_.connect);
  if (now.status.left_in_cut || (told && now.status.state == State::kHeld)) return recover(work, now);
  if (told) refuse_nothing_left(now.status);
  if (const auto ours = journal_.read(); arguments_.resume && ours)
    check_journal(work.jobs, *ours, now.status, arguments_.connect);
  return make_plan(arguments_, work.jobs, now);
}

// Who wants a blade out of a block does not want one to be driven into it.
void Runner::refuse_nothing_left(const robot::protocol::Status& status) const {
  if (recovery_named(arguments_.recover) == Recovery::kRestart) return;
  throw Error(ErrorKind::kController,
              fmt::format("{}: --recover {}: no strip of this program is held or left half cut there (the "
                          "controller is {}); nothing was moved",
                          arguments_.connect, arguments_.recover, robot::protocol::name(status.state)));
}

// By --recover with a typed yes, or by a typed word; nothing chosen is nothing done.
std::optional<Recovery> Runner::choose_recovery(const std::string& text) {
  console_.warn(text);
  if (!arguments_.recover.empty()) {
    const auto wanted = recovery_named(arguments_.recover);
    if (arguments_.yes) return wanted;
    const auto line =
        ask(fmt::format("Cell clear? Type yes to {}, anything else stops: ", arguments_.recover));
    return line && agrees_to_start(*line, "yes") ? wanted : std::nullopt;
  }
  if (arguments_.yes) {
    throw Error(ErrorKind::kController,
                arguments_.connect + ": --yes does not choose: say --recover withdraw, restart or give-up");
  }
  const auto line = ask("Cell clear? Type withdraw, restart or give up, anything else stops: ");
  return line ? recovery_named(*line) : std::nullopt;
}

// A blade that stands in the foam of a job that was lost to RESET: nothing else starts before it is dealt
// with. Or a job that is held, which --recover ends or goes on with.
Plan Runner::recover(const StripJobs& work, const robot::ControllerSnapshot& now) {
  const auto found = std::find_if(work.jobs.begin(), work.jobs.end(),
                                  [&](const Job& job) { return job.id == now.status.job_id; });
  if (found == work.jobs.end()) {
    throw Error(ErrorKind::kController,
                fmt::format("{}: {} ({}, {} waypoints executed): run that program, {}", arguments_.connect,
                            now.status.left_in_cut ? "the blade stands in the cut of another program's job"
                                                   : "another program's job is held there",
                            robot::to_hex(now.status.job_id), now.status.executed,
                            now.status.left_in_cut ? "it says how to go on" : "with --resume or --recover"));
  }
  const auto index = static_cast<std::size_t>(found - work.jobs.begin());
  const Strip& strip = work.program.strips[index];
  if (!arguments_.recover.empty() && !arguments_.strip.empty() && arguments_.strip != found->strip) {
    throw Error(
        ErrorKind::kController,
        fmt::format("{}: strip {} is {}, not {}: recover that one first", arguments_.connect, found->strip,
                    now.status.left_in_cut ? "left half cut" : "held", arguments_.strip));
  }
  const bool goes_on = !now.status.left_in_cut && recovery_named(arguments_.recover) == Recovery::kRestart;
  if (const auto ours = journal_.read(); goes_on && ours)
    check_journal(work.jobs, *ours, now.status, arguments_.connect);
  const auto chosen = choose_recovery(recovery_text(strip, *found, now.status));
  if (!chosen) {
    console_.warn("nothing was moved");
    stopped_ = Exit::kInterrupted;
    return {};
  }
  if (*chosen != Recovery::kRestart) return end_left_strip(*chosen, strip, *found, now.status.run);
  Plan plan;
  plan.first = index;
  plan.end = arguments_.strip.empty() ? work.jobs.size() : index + 1;
  plan.resume_first = plan.agreed_first = true;
  plan.run = now.status.run;
  return plan;
}

Plan Runner::end_left_strip(Recovery recovery, const Strip& strip, const Job& job, std::uint32_t run) {
  stopped_ = Exit::kInterrupted;
  const std::string anew =
      fmt::format("strip {} is not cut: start it anew on a new block with --strip {}", strip.id, strip.id);
  if (recovery == Recovery::kGiveUp) {
    const auto given_up = robot::give_up(job.id, run, link_);
    if (given_up.outcome != StreamOutcome::kDone) throw Error(kind_of(given_up.outcome), given_up.message);
    journal_.remove();
    console_.warn("given up: free the blade and take the block out; " + anew);
    return {};
  }
  robot::StreamOptions options = link_;
  options.progress = [&](const StreamProgress& p) {
    console_.report_progress(job.strip + " withdrawing, cold: " + robot::protocol::name(p.state), 0);
  };
  const robot::StreamReport report = robot::withdraw(job, options);
  console_.end_progress();
  if (report.outcome != StreamOutcome::kDone)
    throw Error(kind_of(report.outcome), report.message + place_of(strip, report.at));
  journal_.remove();
  console_.warn("withdrawn: the blade stands where the strip began, cold; " + anew);
  return {};
}

// After the controller was restarted under way.
bool Runner::may_go_on(const Job& job, const robot::protocol::Status& status) {
  console_.end_progress();
  const std::string said =
      fmt::format("strip {}: the controller was restarted after {} of {} waypoints; it is {}, the blade cold",
                  job.strip, status.executed, job.size(), robot::protocol::name(status.state));
  console_.warn(said);
  if (arguments_.yes) return true;
  const auto line = ask(fmt::format(
      "Blade and block as they were, cell clear? Type yes or {} to go on, anything else stops: ", job.strip));
  return line && agrees_to_start(*line, job.strip);
}

Exit Runner::run(const StripJobs& work) {
  if (!arguments_.strip.empty()) index_of(work.jobs, arguments_.strip);
  const auto now = meet();
  Plan plan = plan_with(work, now);
  if (stopped_) return *stopped_;
  if (plan.first == plan.end) journal_.remove();
  std::size_t total = 0, done = 0;
  for (std::size_t i = plan.first; i < plan.end; ++i) total += work.jobs[i].size();
  if (total == 0) console_.note("nothing left to run");
  for (std::size_t i = plan.first; i < plan.end; ++i) {
    const bool first = i == plan.first;
    const auto asked = first ? now : robot::look(link_);
    if (!arguments_.yes) refuse_latched(work, asked.status, arguments_.connect);
    plan.agreed_boot = asked.ident.boot_id;
    if (!(first && plan.agreed_first) && !operator_agrees(arguments_, work.program.strips[i], work.jobs[i],
                                                          asked, first && plan.resume_first, console_))
      return Exit::kInterrupted;
    if (const Exit code = run_strip(work, i, plan, total, done); code != Exit::kOk) return code;
    done += work.jobs[i].size();
  }
  return Exit::kOk;
}

Exit Runner::run_strip(const StripJobs& work, std::size_t index, const Plan& plan, std::size_t total,
                       std::size_t done) {
  const Job& job = work.jobs[index];
  journal_.expect_writable();
  robot::StreamOptions options = link_;
  options.run = plan.run;
  options.agreed_boot = plan.agreed_boot;
  options.resume = plan.resume_first && index == plan.first;
  bool told_lost = false;
  options.progress = [&](const StreamProgress& p) {
    console_.report_progress(progress_text(job, p),
                             static_cast<double>(done + p.executed) / static_cast<double>(total));
    // Where there is no bar, and for the log.
    constexpr double kWorthALine_s = 1;
    const bool lost = p.link_lost_s > kWorthALine_s;
    if (lost && !told_lost) console_.warn(job.strip + " link lost, trying again");
    if (!lost && told_lost && p.link_lost_s == 0) console_.warn(job.strip + " link is back");
    told_lost = lost || (told_lost && p.link_lost_s > 0);
  };
  options.may_go_on = [&](const robot::protocol::Status& status) { return may_go_on(job, status); };
  options.opened = [&](std::uint32_t run, std::uint32_t token) { journal_.write({job.id, run, token}); };
  const robot::StreamReport report = robot::stream(job, options);
  console_.end_progress();
  const Exit code = report.outcome == StreamOutcome::kDone ? Exit::kOk : exit_of(kind_of(report.outcome));
  if (code == Exit::kOk || report.given_back) journal_.remove();
  if (code != Exit::kOk) console_.warn(report.message + place_of(work.program.strips[index], report.at));
  if (code == Exit::kInterrupted || report.outcome == StreamOutcome::kLinkLost)
    console_.warn("to go on: " + run_line(arguments_, {"--resume"}));
  if (code == Exit::kInterrupted) return code;
  std::cout << fmt::format("{} {} of {} waypoints executed, run {}, job {}, {} reconnects\n", job.strip,
                           report.executed, job.size(), report.run, robot::to_hex(job.id), report.reconnects)
            << std::flush;
  return code;
}

Exit run(const RunArguments& arguments, const Console& console) {
  const HostPort where = parse_host_port(arguments.connect, "--connect");
  const StripJobs work = read_strip_jobs(arguments.program, arguments.overridden);
  require_attended(arguments, where);
  if (arguments.overridden && work.program.verification.status != VerificationStatus::kPassed) {
    console.warn(std::string("--override: the program did not pass its verification (") +
                 name(work.program.verification.status) + ")");
  }
  if (const Verdict verdict = verdict_of(work.program); verdict.color == VerdictColor::kAmber)
    console.warn("warning: " + budget_text(verdict));
  return Runner(arguments, where, console).run(work);
}

}  // namespace

void add_run(CLI::App& app, const Console& console, Action& action) {
  auto arguments = std::make_shared<RunArguments>();
  auto* command = app.add_subcommand("run", "Stream a program to a controller");
  command->add_option("program", arguments->program, "The program.json to stream")
      ->required()
      ->type_name("PROGRAM");
  command->add_option("--connect", arguments->connect, "The controller")->required()->type_name("HOST:PORT");
  command->add_option("--strip", arguments->strip, "This strip only")->type_name("ID");
  command->add_flag("--resume", arguments->resume, "Go on where an interrupted run left the controller");
  command->add_flag("--reset", arguments->reset, "Clear a FAULT or a latched ESTOP first");
  command
      ->add_option("--recover", arguments->recover,
                   "What becomes of a strip that is held, or left half cut in the foam (asked where it is "
                   "left out)")
      ->check(CLI::IsMember({"withdraw", "restart", "give-up"}))
      ->type_name("withdraw|restart|give-up");
  command->add_flag("--yes", arguments->yes, "Start every strip without asking");
  command->add_flag("--override", arguments->overridden, "Run a program that did not pass its verification");
  command->add_flag("--allow-remote", arguments->allow_remote, "Connect to another host than this");
  command->footer(
      "Ctrl-C slows down along the path and holds; --resume goes on. Exit code 6 when the controller "
      "refuses,\n"
      "faults, or the link is lost.\nExample: hotblade run vault_cut/program.json --connect 127.0.0.1:1502 "
      "--yes");
  command->callback([arguments, &console, &action] {
    action = [arguments, &console] { return run(*arguments, console); };
  });
}

}  // namespace hotblade::pipeline
