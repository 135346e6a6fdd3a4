// sim, run and dryrun as a user calls them.
#include <gmock/gmock.h>
#include <sys/resource.h>

#include <chrono>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "pipeline/program/strip_jobs.hpp"
#include "robot/client/client.hpp"
#include "robot/controller/execution_log.hpp"
#include "tests/paths.hpp"
#include "tests/pipeline/cli/simulated_cell.hpp"
#include "tests/pipeline/motion_program.hpp"
#include "tests/pipeline/run_program.hpp"
#include "tests/pipeline/temporary_directory.hpp"
#include "tests/robot/controller/fault_proxy.hpp"

namespace hotblade::pipeline {
namespace {

using robot::protocol::State;
using testing::Ended;
using ::testing::HasSubstr;
using testing::hotblade;
using testing::Process;

class ControllerCommands : public ::testing::Test {
 protected:
  void write(const Program& program) { std::ofstream(file_) << to_json(program); }

  void start_sim(const std::string& time_scale, const std::vector<std::string>& more = {}) {
    std::vector<std::string> options{"--log", log_.string(), "--time-scale", time_scale};
    options.insert(options.end(), more.begin(), more.end());
    cell_.start(options);
  }
  // Where `run` connects to.
  [[nodiscard]] std::string place() const {
    return proxy_port_ != 0 ? "127.0.0.1:" + std::to_string(proxy_port_) : cell_.place();
  }
  template <typename Condition>
  void wait_until(Condition condition) {
    ASSERT_TRUE(cell_.until([&](const robot::ControllerSnapshot& now) { return condition(now.status); }));
  }
  [[nodiscard]] robot::protocol::Status status() const { return cell_.now().status; }
  [[nodiscard]] std::vector<std::string> run_arguments(std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments{"run",   file_.string(), "--connect", place(),
                                       "--yes", "--progress",   "json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  void expect_log_holds() {
    const auto work = read_strip_jobs(file_, false);
    const auto logged = robot::read_execution_log(log_);
    ASSERT_EQ(logged.size(), work.jobs.size());
    for (const auto& job : work.jobs) EXPECT_TRUE(robot::prove(job, logged.at(job.id)).holds()) << job.strip;
  }

  testing::TemporaryDirectory directory_;
  std::filesystem::path file_ = directory_ / "program.json", log_ = directory_ / "execution.jsonl";
  testing::SimulatedCell cell_;
  std::uint16_t proxy_port_ = 0;
};

TEST_F(ControllerCommands, DryrunProvesThatWhatWasExecutedIsWhatWasPlanned) {
  write(testing::motion_program(2, 400));
  const Ended ended = hotblade({"dryrun", file_.string(), "--log", log_.string()});
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("S001           400       400    equal    equal      0:20"));
  EXPECT_THAT(ended.out, HasSubstr("S002           400       400    equal    equal      0:20"));
  expect_log_holds();
  EXPECT_EQ(hotblade({"dryrun", file_.string(), "--log", log_.string()}).code, 7)
      << "the log is there already";
}

TEST_F(ControllerCommands, DryrunOfAMotionOverALimitNamesItAndExitsWithSix) {
  auto program = testing::motion_program(1, 400);
  program.strips[0].poses[200].a.p.x() += 30;
  write(program);
  const Ended ended = hotblade({"dryrun", file_.string()});
  EXPECT_EQ(ended.code, 6);
  EXPECT_THAT(ended.err, HasSubstr("waypoint 200: speed (limit 100 mm/s)"));
}

// One cell serves the program, and only that one starts it.
TEST_F(ControllerCommands, DryrunWithACellChecksTheArmsThatTheProgramWasPlannedFor) {
  write(testing::motion_program(1, 400));
  const std::string armed = (directory_ / "armed" / "program.json").string();
  const Ended placed =
      hotblade({"place", file_.string(), "--cell", "two_irb4600", "-o", (directory_ / "armed").string()});
  ASSERT_EQ(placed.code, 0) << placed.err;
  const Ended held = hotblade({"dryrun", armed, "--cell", "two_irb4600", "--log", log_.string()});
  EXPECT_EQ(held.code, 0) << held.err;
  std::ifstream log(log_);
  const std::string text{std::istreambuf_iterator<char>(log), {}};
  EXPECT_THAT(text, HasSubstr("{\"ev\":\"arms\""));
  EXPECT_THAT(text, HasSubstr("\"ja\":["));
  EXPECT_THAT(hotblade({"dryrun", armed}).out, HasSubstr("arms: not checked, give --cell"));
  EXPECT_THAT(hotblade({"dryrun", armed, "--json"}).out, HasSubstr("\"arms\""));
  const Ended other = hotblade({"dryrun", armed, "--cell", "two_kr50"});
  EXPECT_EQ(other.code, 6);
  EXPECT_THAT(other.err, HasSubstr("the program's arms are not those of this controller's cell"));
  const Ended none = hotblade({"dryrun", file_.string(), "--cell", "two_kr50"});
  EXPECT_EQ(none.code, 6);
  EXPECT_THAT(none.err, HasSubstr("this controller checks its arms, and the program has none"));
  EXPECT_EQ(hotblade({"dryrun", armed, "--cell", (directory_ / "none.toml").string()}).code, 7);
  // A controller of its own, that `run` declares them to.
  start_sim("max", {"--cell", "two_irb4600"});
  EXPECT_EQ(hotblade({"run", armed, "--connect", place(), "--yes"}).code, 0);
}

// Nothing was under way: the controller is free at once, and no journal is left.
TEST_F(ControllerCommands, ARunThatIsRefusedBeforeItMovesLeavesNothingOpen) {
  write(testing::motion_program(1, 400));
  const std::string armed = (directory_ / "armed" / "program.json").string();
  ASSERT_EQ(
      hotblade({"place", file_.string(), "--cell", "two_irb4600", "-o", (directory_ / "armed").string()})
          .code,
      0);
  start_sim("max", {"--cell", "two_irb4600"});
  const Ended refused = hotblade(run_arguments());
  EXPECT_EQ(refused.code, 6);
  EXPECT_THAT(refused.err, HasSubstr("STATE: this controller checks its arms, and the program has none"));
  EXPECT_EQ(status().state, State::kIdle);
  for (const auto& entry : std::filesystem::directory_iterator(directory_.path()))
    EXPECT_NE(entry.path().extension(), ".resume");
  const Ended at_once = hotblade({"run", armed, "--connect", place(), "--yes"});
  EXPECT_EQ(at_once.code, 0) << at_once.err;
}

TEST_F(ControllerCommands, AProgramThatDidNotPassNeedsAnOverride) {
  auto program = testing::motion_program(1, 400);
  program.verification.status = VerificationStatus::kRefused;
  write(program);
  const Ended refused = hotblade({"dryrun", file_.string()});
  EXPECT_EQ(refused.code, 4);
  EXPECT_THAT(refused.err, HasSubstr("--override"));
  EXPECT_EQ(hotblade({"dryrun", file_.string(), "--override"}).code, 0);
  EXPECT_EQ(hotblade({"run", file_.string(), "--connect", "127.0.0.1:1", "--yes"}).code, 4);
}

TEST_F(ControllerCommands, WrongUseExitsByTheTable) {
  write(testing::motion_program(1, 100));
  const std::string program = file_.string();
  EXPECT_EQ(hotblade({"dryrun", (directory_ / "none.json").string()}).code, 7);
  EXPECT_EQ(hotblade({"dryrun", program, "--design", program}).code, 3) << "another design";
  EXPECT_EQ(hotblade({"run", program, "--connect", "127.0.0.1"}).code, 2);
  EXPECT_EQ(hotblade({"run", program, "--connect", "127.0.0.1:99999"}).code, 2);
  EXPECT_EQ(hotblade({"run", program, "--connect", "127.example.invalid:502", "--yes"}).code, 2) << "a name";
  const Ended remote = hotblade({"run", program, "--connect", "192.0.2.1:502", "--yes"});
  EXPECT_EQ(remote.code, 2);
  EXPECT_THAT(remote.err, HasSubstr("--allow-remote"));
  const Ended unattended = hotblade({"run", program, "--connect", "127.0.0.1:1"});
  EXPECT_EQ(unattended.code, 2) << "no terminal and no --yes";
  EXPECT_THAT(unattended.err, HasSubstr("--yes"));
  const Ended strip = hotblade({"run", program, "--connect", "127.0.0.1:1", "--yes", "--strip", "S009"});
  EXPECT_EQ(strip.code, 2);
  EXPECT_THAT(strip.err, HasSubstr("S001"));
  EXPECT_EQ(hotblade({"run", program, "--connect", "127.0.0.1:1", "--yes"}).code, 6) << "nobody there";
  EXPECT_EQ(hotblade({"sim", "--time-scale", "fast"}).code, 2);
  EXPECT_EQ(hotblade({"sim", "--time-scale", "-1"}).code, 2);
  EXPECT_EQ(hotblade({"sim", "--listen", "0.0.0.0:0"}).code, 2) << "open to the network without --allow";
  EXPECT_EQ(hotblade({"sim", "--listen", "127.0.0.1:0", "--log", "/nonexistent/log"}).code, 7);
}

TEST_F(ControllerCommands, RunStreamsEveryStripAndEndsIdle) {
  write(testing::motion_program(3, 300));
  start_sim("max");
  const Ended ended = hotblade(run_arguments());
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("S003 300 of 300 waypoints executed"));
  EXPECT_THAT(ended.err, ::testing::Not(HasSubstr("equilibrium")));
  EXPECT_EQ(status().state, State::kIdle);
  const Ended sim = cell_.stop();
  EXPECT_EQ(sim.code, 0);
  EXPECT_THAT(sim.out, HasSubstr("listening on " + place()));
  EXPECT_THAT(sim.err, HasSubstr("the blade's equilibrium is solved at every pose"));
  expect_log_holds();
}

TEST_F(ControllerCommands, RunThroughTwentyCutsExecutesEverythingOnce) {
  using robot::testing::LinkFault;
  write(testing::motion_program(2, 1000));
  start_sim("max");
  {
    const robot::testing::FaultProxy proxy(cell_.port(),
                                           {LinkFault::kCutBefore, LinkFault::kCutWithinRequest,
                                            LinkFault::kCutAfter, LinkFault::kCutWithinAnswer},
                                           20, 10, 3);
    proxy_port_ = proxy.port();
    const Ended ended = hotblade(run_arguments());
    EXPECT_EQ(ended.code, 0) << ended.err;
    EXPECT_EQ(proxy.faults_done(), 20);
  }
  cell_.stop();
  expect_log_holds();
}

TEST_F(ControllerCommands, AKilledRunIsResumedInItsStrip) {
  write(testing::motion_program(2, 200));
  start_sim("8");
  {
    Process first(run_arguments());
    wait_until([](const auto& status) { return status.run == 1 && status.executed > 60; });
    ::kill(first.pid(), SIGKILL);
    EXPECT_EQ(first.wait().code, 128 + SIGKILL);
  }
  const Ended without = hotblade(run_arguments());
  EXPECT_EQ(without.code, 6);
  EXPECT_THAT(without.err, HasSubstr("--resume"));
  const Ended ended = hotblade(run_arguments({"--resume"}));
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("S001 200 of 200"));
  EXPECT_THAT(ended.out, HasSubstr("S002 200 of 200"));
  const Ended again = hotblade(run_arguments({"--resume"}));
  EXPECT_EQ(again.code, 0);
  EXPECT_THAT(again.err, HasSubstr("nothing left to run"));
  cell_.stop();
  expect_log_holds();
}

TEST_F(ControllerCommands, CtrlCHoldsAndSaysHowToGoOn) {
  write(testing::motion_program(1, 200));
  start_sim("4");
  Process first(run_arguments());
  wait_until([](const auto& status) { return status.executed > 40; });
  ::kill(first.pid(), SIGINT);
  const Ended ended = first.wait();
  EXPECT_EQ(ended.code, 130);
  EXPECT_THAT(ended.err, HasSubstr("to go on: hotblade run " + file_.string() + " --connect " + place() +
                                   " --resume\n"));
  EXPECT_EQ(status().state, State::kHeld);
  EXPECT_EQ(hotblade(run_arguments({"--resume"})).code, 0);
  cell_.stop();
  expect_log_holds();
}

TEST_F(ControllerCommands, KillsOfClientAndControllerAreResumedFromTheirJournals) {
  write(testing::motion_program(2, 200));
  start_sim("8");
  const auto journal =
      std::filesystem::path(file_.string() + ".127.0.0.1-" + std::to_string(cell_.port()) + ".resume");
  {
    Process first(run_arguments());
    wait_until([](const auto& status) { return status.executed > 60; });
    EXPECT_TRUE(std::filesystem::exists(journal));
    ::kill(first.pid(), SIGKILL);
    first.wait();
    cell_.kill();
  }
  start_sim("8");
  EXPECT_EQ(status().state, State::kHeld);
  {
    Process second(run_arguments({"--resume"}));
    wait_until([](const auto& status) { return status.executed > 120; });
    cell_.kill();  // the client stays
    start_sim("8");
    const Ended ended = second.wait();
    EXPECT_EQ(ended.code, 0) << ended.err;
    EXPECT_THAT(ended.out, HasSubstr("S001 200 of 200"));
    EXPECT_THAT(ended.out, HasSubstr("S002 200 of 200"));
  }
  EXPECT_FALSE(std::filesystem::exists(journal)) << "only while a strip is unfinished";
  cell_.stop();
  expect_log_holds();
}

TEST_F(ControllerCommands, AnotherControllerThanTheOneLeftIsNotResumed) {
  write(testing::motion_program(1, 200));
  start_sim("4");
  {
    Process first(run_arguments());
    wait_until([](const auto& status) { return status.executed > 40; });
    ::kill(first.pid(), SIGKILL);
    first.wait();
    cell_.kill();
  }
  std::filesystem::remove(log_);
  start_sim("max");
  const Ended ended = hotblade(run_arguments({"--resume"}));
  EXPECT_EQ(ended.code, 6);
  EXPECT_THAT(ended.err, ::testing::AllOf(HasSubstr("S001"), HasSubstr("run 1"), HasSubstr("--strip S001")));
  EXPECT_EQ(status().executed, 0u) << "nothing moved";
  EXPECT_EQ(hotblade(run_arguments({"--strip", "S001"})).code, 0) << "anew";
}

TEST_F(ControllerCommands, ARebootOfTheControllerChangesNothing) {
  write(testing::motion_program(2, 300));
  start_sim("max", {"--fault", "reboot@100"});
  const Ended ended = hotblade(run_arguments());
  EXPECT_EQ(ended.code, 0) << ended.err;
  const Ended sim = cell_.stop();
  EXPECT_THAT(sim.err, HasSubstr("starts again from"));
  expect_log_holds();
}

TEST_F(ControllerCommands, AFaultIsToldWithItsStripRibAndPhase) {
  auto program = testing::motion_program(1, 200);
  const auto& pose = program.strips[0].poses[60];
  const std::string rib =
      pose.rib ? program.strips[0].ribs.at(static_cast<std::size_t>(*pose.rib)).id : "no rib";
  write(program);
  start_sim("max", {"--fault", "fault@60"});
  const Ended ended = hotblade(run_arguments());
  EXPECT_EQ(ended.code, 6);
  EXPECT_THAT(ended.err, HasSubstr("FAULT DRIVE at waypoint 60"));
  EXPECT_THAT(ended.err, HasSubstr("[S001, " + rib + ", " + name(pose.phase)));
  // The fault is told of before what was passed up to rest is on record.
  EXPECT_GT(status().executed, 60u);
  EXPECT_THAT(ended.out, HasSubstr("S001 " + std::to_string(status().executed) + " of 200"));
  // It stopped in the cut, and --yes does not choose what becomes of it.
  const Ended unsaid = hotblade(run_arguments({"--reset"}));
  EXPECT_EQ(unsaid.code, 6);
  EXPECT_THAT(unsaid.err, HasSubstr("--recover withdraw, restart or give-up"));
  const Ended again = hotblade(run_arguments({"--recover", "restart"}));
  EXPECT_EQ(again.code, 0) << "it happens once: " << again.err;
}

// A limit on the size of the simulator's files stands for its full disk.
TEST_F(ControllerCommands, ALogWithoutRoomIsSaidAndGoesOnWhenThereIsRoom) {
  write(testing::motion_program(2, 400));
  const auto before = ::signal(SIGXFSZ, SIG_IGN);  // handed on to the simulator
  start_sim("max");
  ::signal(SIGXFSZ, before);
  const auto room = [&](rlim_t bytes) {
    const rlimit limited{bytes, RLIM_INFINITY};
    ASSERT_EQ(::prlimit(cell_.pid(), RLIMIT_FSIZE, &limited, nullptr), 0);
  };
  const auto cause = "the controller cannot write its execution log: see to its disk";
  room(400000);
  const Ended stopped = hotblade(run_arguments());
  EXPECT_EQ(stopped.code, 6);
  EXPECT_THAT(stopped.err, ::testing::ContainsRegex("FAULT LOG at waypoint [0-9]+: " + std::string(cause)));
  EXPECT_TRUE(cell_.said("execution.jsonl: the log cannot be written (File too large): make room"));
  const Ended refused = hotblade(run_arguments({"--reset"}));
  EXPECT_EQ(refused.code, 6);
  EXPECT_THAT(refused.err, HasSubstr("RESET refused (STATE): " + std::string(cause)));
  EXPECT_EQ(status().state, State::kFault);
  EXPECT_THAT(hotblade(run_arguments({"--recover", "give-up"})).err,
              HasSubstr("the controller is in FAULT LOG"));
  // Whole lines, and more of them than anybody was told of.
  EXPECT_GT(robot::read_controller_journal(log_).executed.size(), status().executed);
  room(RLIM_INFINITY);
  const Ended ended = hotblade(run_arguments({"--reset", "--recover", "restart"}));
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_TRUE(cell_.said("the log is written again"));
  cell_.stop();
  EXPECT_EQ(testing::events(log_, "exec"), 800) << "each waypoint once";
  expect_log_holds();
}

// Nothing of it was executed, and the next RESET goes on.
TEST_F(ControllerCommands, AJobThatFindsNoRoomInTheLogIsNotOpened) {
  write(testing::motion_program(1, 100));
  const auto before = ::signal(SIGXFSZ, SIG_IGN);
  start_sim("max");
  ::signal(SIGXFSZ, before);
  rlimit limited{10, RLIM_INFINITY};
  ASSERT_EQ(::prlimit(cell_.pid(), RLIMIT_FSIZE, &limited, nullptr), 0);
  const Ended refused = hotblade(run_arguments());
  EXPECT_EQ(refused.code, 6);
  EXPECT_THAT(refused.err, HasSubstr("FAULT LOG at waypoint 0: the controller cannot write"));
  EXPECT_EQ(std::filesystem::file_size(log_), 0u);
  limited.rlim_cur = RLIM_INFINITY;
  ASSERT_EQ(::prlimit(cell_.pid(), RLIMIT_FSIZE, &limited, nullptr), 0);
  EXPECT_EQ(hotblade(run_arguments({"--reset"})).code, 0);
  cell_.stop();
  expect_log_holds();
}

TEST_F(ControllerCommands, FaultsAreCheckedBeforeAnythingIsServed) {
  const Ended unknown = hotblade({"sim", "--listen", "127.0.0.1:0", "--fault", "melt"});
  EXPECT_EQ(unknown.code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("slow=FACTOR"));
  EXPECT_EQ(hotblade({"sim", "--listen", "127.0.0.1:0", "--fault", "slow=3"}).code, 2);
  const Ended reboot = hotblade({"sim", "--listen", "127.0.0.1:0", "--fault", "reboot@3"});
  EXPECT_EQ(reboot.code, 2);
  EXPECT_THAT(reboot.err, HasSubstr("--log"));
}

// Every sample as planned, streamed by the program over links that fail.
class StreamSample : public ControllerCommands, public ::testing::WithParamInterface<const char*> {
 protected:
  void SetUp() override {
    const std::string sample = hotblade::testing::source_dir() + "/samples/" + GetParam();
    const std::string out = (directory_ / "out").string();
    const Ended planned = hotblade({"plan", sample + ".obj", "--config", sample + ".toml", "-o", out});
    ASSERT_EQ(planned.code, 0) << planned.err;
    design_ = sample + ".obj";
    file_ = directory_ / "out" / "program.json";
  }
  void run_through(std::vector<robot::testing::LinkFault> faults, unsigned seed) {
    std::filesystem::remove(log_);
    start_sim("max");
    {
      const robot::testing::FaultProxy proxy(cell_.port(), std::move(faults), 20, 15, seed);
      proxy_port_ = proxy.port();
      const Ended ended = hotblade(run_arguments());
      EXPECT_EQ(ended.code, 0) << ended.err;
      EXPECT_EQ(proxy.faults_done(), 20);
    }
    cell_.stop();
    expect_log_holds();
  }
  std::string design_;
};

TEST_P(StreamSample, DryrunExecutesWhatWasPlanned) {
  const Ended ended =
      hotblade({"dryrun", file_.string(), "--design", design_, "--json", "--log", log_.string()});
  EXPECT_EQ(ended.code, 0) << ended.err;
  const auto json = nlohmann::json::parse(ended.out);
  EXPECT_TRUE(json["holds"].get<bool>());
  const auto& cut = json["as_cut"];
  EXPECT_TRUE(cut["within_tolerance"].get<bool>());
  EXPECT_LE(cut["deviation_mm"]["max"].get<double>(), 0.65);
  EXPECT_GE(cut["budget_sum_mm"].get<double>(), cut["deviation_mm"]["max"].get<double>());
  EXPECT_LE(cut["shape_mismatch_mm"].get<double>(), 1e-3 + cut["budget_mm"]["quantisation"].get<double>());
  const Ended again =
      hotblade({"verify", file_.string(), "--design", design_, "--as-cut", log_.string(), "--json"});
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(nlohmann::json::parse(again.out), cut) << "the log alone says the same";
}

TEST_P(StreamSample, TwentyCutsAndTwentyLostAnswersChangeNothing) {
  using robot::testing::LinkFault;
  run_through({LinkFault::kCutBefore, LinkFault::kCutWithinRequest, LinkFault::kCutAfter,
               LinkFault::kCutWithinAnswer},
              11);
  run_through({LinkFault::kCutAfter, LinkFault::kSwallowAnswer}, 12);
}

TEST_P(StreamSample, AKilledRunIsResumed) {
  start_sim("100");
  {
    Process first(run_arguments());
    wait_until([](const auto& status) { return status.executed > 500; });
    ::kill(first.pid(), SIGKILL);
    EXPECT_EQ(first.wait().code, 128 + SIGKILL);
  }
  const Ended ended = hotblade(run_arguments({"--resume"}));
  EXPECT_EQ(ended.code, 0) << ended.err;
  cell_.stop();
  expect_log_holds();
}

INSTANTIATE_TEST_SUITE_P(All, StreamSample, ::testing::Values("barrel_vault", "bump", "hypar", "s_wall"),
                         [](const auto& sample) { return std::string(sample.param); });

// What a program of another maker prints and how it ends.
Ended shell(const std::string& command) {
  Ended ended;
  FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
  char text[512];
  while (std::fgets(text, sizeof text, pipe) != nullptr) ended.out += text;
  ended.code = WEXITSTATUS(::pclose(pipe));
  return ended;
}

TEST_F(ControllerCommands, MbpollReadsIdentAndStatusAndWritesScratch) {
  if (shell("command -v mbpoll").code != 0) GTEST_SKIP() << "mbpoll is not installed";
  start_sim("1");
  const std::string mbpoll = "mbpoll -m tcp -a 1 -0 -1 -q -p " + std::to_string(cell_.port()) + " ";
  const Ended ident = shell(mbpoll + "-r 0 -c 7 -t 4:hex 127.0.0.1");
  EXPECT_EQ(ident.code, 0) << ident.out;
  EXPECT_THAT(ident.out, ::testing::AllOf(HasSubstr("0x4842"), HasSubstr("0x001A")));
  const Ended status = shell(mbpoll + "-r 64 -c 40 -t 3 127.0.0.1");
  EXPECT_EQ(status.code, 0) << status.out;
  EXPECT_EQ(
      shell("mbpoll -m tcp -a 1 -0 -q -p " + std::to_string(cell_.port()) + " -r 384 -t 4 127.0.0.1 11 22 33")
          .code,
      0);
  const Ended scratch = shell(mbpoll + "-r 384 -c 3 -t 4 127.0.0.1");
  EXPECT_THAT(scratch.out, ::testing::AllOf(HasSubstr("11"), HasSubstr("22"), HasSubstr("33")));
  EXPECT_NE(shell(mbpoll + "-r 1000 -c 1 -t 4 127.0.0.1").code, 0) << "no such register";
}

TEST_F(ControllerCommands, ALatchedEstopIsClearedByReset) {
  write(testing::motion_program(1, 100));
  start_sim("max");
  ASSERT_EQ(
      shell("mbpoll -m tcp -a 255 -0 -q -p " + std::to_string(cell_.port()) + " -r 320 -t 4 127.0.0.1 1")
          .code,
      0);
  const Ended latched = hotblade(run_arguments());
  EXPECT_EQ(latched.code, 6);
  EXPECT_THAT(latched.err, HasSubstr("ESTOP"));
  EXPECT_EQ(hotblade(run_arguments({"--reset"})).code, 0);
}

}  // namespace
}  // namespace hotblade::pipeline
