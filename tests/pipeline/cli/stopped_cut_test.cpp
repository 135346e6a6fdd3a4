// A cut that is stopped at a random waypoint, in the foam or out of it: by ESTOP, by a controller, a client,
// or both that are killed and started again. What the operator is told, that nothing moves before a typed
// yes, and that the log is whole in the end.
//
// HOTBLADE_STOPPED_CUTS=20: so many waypoints for each of them (minutes); otherwise four.
#include <gmock/gmock.h>

#include <array>
#include <cstdlib>
#include <fstream>
#include <mutex>
#include <random>
#include <thread>

#include "pipeline/program/strip_jobs.hpp"
#include "robot/controller/execution_log.hpp"
#include "tests/pipeline/cli/simulated_cell.hpp"
#include "tests/pipeline/cli/terminal.hpp"
#include "tests/pipeline/motion_program.hpp"

namespace hotblade::pipeline {
namespace {

using robot::protocol::State;
using testing::events;
using testing::Terminal;

enum class Stop { kEstop, kController, kClient, kBoth };
constexpr std::uint32_t kWaypoints = 400;  // 20 s of motion, the blade hot from 5 s to 15 s
constexpr const char* kAsked = "anything else stops: ";

// Thrown by a trial: what went wrong.
struct Wrong {
  std::string what;
};
void require(bool holds, const std::string& what) {
  if (!holds) throw Wrong{what};
}

// One strip, stopped once.
class Trial {
 public:
  Trial(Stop stop, std::uint32_t waypoint, unsigned choice)
      : stop_(stop), waypoint_(waypoint), choice_(choice) {
    std::ofstream(file_) << to_json(testing::motion_program(1, kWaypoints));
    // The watchdog's 2 s are of the clock on the wall: a client is missed while there is much left to cut.
    const char* time_scale = stop == Stop::kClient ? "2" : "5";
    cell_.start({"--time-scale", time_scale, "--log", log_.string()});
  }

  // Throws Wrong.
  void run() {
    Terminal first(words({}));
    asks(first, "the controller is IDLE");
    expect_rest(first);
    yes(first);
    require(cell_.until([&](const auto& now) { return now.status.executed >= waypoint_; }), "it stands");
    if (stop_ == Stop::kEstop) {
      after_estop(first);
    } else if (stop_ == Stop::kController) {
      after_restart(first);
    } else {
      after_client(first);
    }
    const auto work = read_strip_jobs(file_, false);
    const auto& job = work.jobs.front();
    require(robot::prove(job, robot::read_execution_log(log_).at(job.id)).holds(), "the log is not whole");
    require(events(log_, "open") == opened_, "opened " + std::to_string(events(log_, "open")) + " times");
    require(events(log_, "exec") == executed_ + static_cast<int>(kWaypoints), "waypoints executed again");
  }

  [[nodiscard]] bool in_foam() const { return in_foam_; }

 private:
  void after_estop(Terminal& first) {
    cell_.estop();
    ends(first, 6, "ESTOP is latched: clear the cell, then reset with --reset");
    stands();
    if (!in_foam_) return anew();
    const std::string half = "strip S001 was left half cut: " + std::to_string(stood_.executed) + " of 400";
    declined({"--reset"}, half, "nothing was moved");
    Terminal second(words({"--reset"}));
    asks(second, half);
    expect_rest(second);
    constexpr std::array kChoices{"withdraw", "restart", "give up"};
    const std::string chosen = kChoices.at(choice_ % kChoices.size());
    require(second.type(chosen + "\n"), "cannot type");
    if (chosen == "restart") return ends(second, 0, "S001 400 of 400 waypoints executed");
    ends(second, 130,
         chosen == "withdraw" ? "withdrawn: the blade stands where the strip began, cold" : "given up");
    require(cell_.now().status.executed == stood_.executed, "executed while withdrawing");
    require(events(log_, "withdrawn") == (chosen == "withdraw" ? 1 : 0), "moved without being told to");
    anew();
  }

  // The strip from its first waypoint, on a new block.
  void anew() {
    declined({"--reset"}, "the controller is IDLE", "strip S001 not started");
    Terminal again(words({"--reset"}));
    asks(again, "the controller is IDLE");
    expect_rest(again);
    yes(again);
    ends(again, 0, "S001 400 of 400 waypoints executed");
    opened_ = 2;
    executed_ = static_cast<int>(stood_.executed);
  }

  void after_restart(Terminal& first) {
    cell_.kill();
    require(first.shows("S001 link lost, trying again"), "not told: " + first.shown());
    cell_.restart();
    asks(first, "strip S001: the controller was restarted after ", 2);
    stands();
    expect_rest(first);
    if (choice_ % 2 == 0) {
      yes(first, 2);
      return ends(first, 0, "S001 400 of 400 waypoints executed");
    }
    require(first.type("n\n"), "cannot type");
    ends(first, 130, "not set in motion again after the controller's restart");
    go_on();
  }

  void after_client(Terminal& first) {
    if (stop_ == Stop::kBoth && choice_ % 2 == 0) cell_.kill();
    first.kill();
    if (stop_ == Stop::kBoth) cell_.restart();
    if (choice_ % 2 == 1) {
      // At once, as the machine may still move: the question waits until it stands.
      Terminal refused(words({}));
      ends(refused, 6, "strip S001 is under way (");
    }
    go_on();
  }

  // With --resume, after a refusal.
  void go_on() {
    Terminal refused(words({"--resume"}));
    asks(refused, "the controller is HELD");
    stands();
    require(refused.shown().find("It is half cut: " + std::to_string(stood_.executed) + " of 400") !=
                std::string::npos,
            "not told: " + refused.shown());
    require(refused.type("no\n"), "cannot type");
    ends(refused, 130, "strip S001 not started");
    Terminal last(words({"--resume"}));
    asks(last, "It is half cut: ");
    expect_rest(last);
    yes(last);
    ends(last, 0, "S001 400 of 400 waypoints executed");
  }

  // Asks for what it should, is told no, and nothing moves.
  void declined(const std::vector<std::string>& options, const std::string& told, const std::string& answer) {
    Terminal terminal(words(options));
    asks(terminal, told);
    expect_rest(terminal);
    require(terminal.type("n\n"), "cannot type");
    ends(terminal, 130, answer);
    require(cell_.now().status.executed == stood_.executed, "moved after a no");
  }

  static void asks(Terminal& terminal, const std::string& told, int questions = 1) {
    require(terminal.shows(kAsked, questions), "not asked: " + terminal.shown());
    require(terminal.shown().find(told) != std::string::npos, "not told " + told + ": " + terminal.shown());
  }
  static void yes(Terminal& terminal, int questions = 1) {
    require(terminal.shows(kAsked, questions) && terminal.type("yes\n"), "not asked: " + terminal.shown());
  }
  static void ends(Terminal& terminal, int code, const std::string& told) {
    const int ended = terminal.wait();
    require(ended == code, "ended with " + std::to_string(ended) + ": " + terminal.shown());
    require(terminal.shown().find(told) != std::string::npos, "not told " + told + ": " + terminal.shown());
  }

  // Remembers how far it is, and whether the blade is in the foam.
  void stands() {
    stood_ = cell_.now().status;
    const auto& raw = read_strip_jobs(file_, false).jobs.front().raw;
    in_foam_ = robot::protocol::is_hot(raw.at(stood_.executed - 1));
  }

  // While a question stands no waypoint is executed and no clamp moves: 1 s of the motion clock and more.
  void expect_rest(const Terminal& terminal) const {
    const auto moves = [&] { return std::pair(events(log_, "exec"), last_path()); };
    const auto before = moves();
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    require(moves() == before, "it moved before a yes: " + terminal.shown());
  }
  // The clamps as the log has them last.
  [[nodiscard]] std::string last_path() const {
    const std::string text = testing::read_bytes(log_);
    const auto at = text.rfind("\"a\":{\"p\":[");
    return at == std::string::npos ? "" : text.substr(at, text.find("\"blade\"", at) - at);
  }

  [[nodiscard]] std::vector<std::string> words(const std::vector<std::string>& more) const {
    std::vector<std::string> all{"run", file_.string(), "--connect", cell_.place(), "--progress", "none"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }

  Stop stop_;
  std::uint32_t waypoint_;
  unsigned choice_;
  testing::TemporaryDirectory directory_;
  std::filesystem::path file_ = directory_ / "program.json", log_ = directory_ / "execution.jsonl";
  testing::SimulatedCell cell_;
  robot::protocol::Status stood_;
  bool in_foam_ = false;
  int opened_ = 1, executed_ = 0;  // of lives of the strip before the last
};

class StoppedCut : public ::testing::TestWithParam<Stop> {};

TEST_P(StoppedCut, IsToldWaitsForAYesAndIsWholeInTheEnd) {
  const char* wanted = std::getenv("HOTBLADE_STOPPED_CUTS");
  const unsigned places = wanted != nullptr ? static_cast<unsigned>(std::atoi(wanted)) : 4;
  constexpr unsigned kAtOnce = 4;
  std::mt19937 random(19 + static_cast<unsigned>(GetParam()));
  const auto between = [&](std::uint32_t least, std::uint32_t most) {
    return std::uniform_int_distribution(least, most)(random);
  };
  // Every other one in the foam: waypoints 100 to 300. Without its client the machine goes on for 4 s, 80
  // waypoints.
  std::vector<std::uint32_t> waypoints;
  for (unsigned i = 0; i < places; ++i) {
    const std::uint32_t on = GetParam() == Stop::kClient ? 80 : 0;
    const std::uint32_t before = between(5, 95 - on), in = between(105, 290 - on),
                        after = between(305, on > 0 ? 310 : 360);
    waypoints.push_back(i % 2 == 0 ? in : i % 4 == 1 ? before : after);
  }
  std::mutex mutex;
  unsigned next = 0, in_foam = 0;
  std::vector<std::string> wrong;
  const auto work = [&] {
    for (;;) {
      unsigned place = 0;
      {
        const std::lock_guard lock(mutex);
        if (next == places) return;
        place = next++;
      }
      Trial trial(GetParam(), waypoints[place], place / 2);
      std::string what;
      try {
        trial.run();
      } catch (const Wrong& thrown) {
        what = thrown.what;
      }
      const std::lock_guard lock(mutex);
      in_foam += trial.in_foam() ? 1 : 0;
      if (!what.empty()) wrong.push_back("waypoint " + std::to_string(waypoints[place]) + ": " + what);
    }
  };
  std::vector<std::thread> workers;
  for (unsigned i = 0; i < kAtOnce; ++i) workers.emplace_back(work);
  for (std::thread& worker : workers) worker.join();
  EXPECT_THAT(wrong, ::testing::IsEmpty());
  EXPECT_GT(in_foam, places / 4);
  EXPECT_LT(in_foam, places);
  RecordProperty("places", static_cast<int>(places));
  RecordProperty("in_foam", static_cast<int>(in_foam));
}

std::string name_of(const ::testing::TestParamInfo<Stop>& stop) {
  constexpr std::array kNames{"Estop", "RestartOfTheController", "RestartOfTheClient", "RestartOfBoth"};
  return kNames.at(static_cast<std::size_t>(stop.param));
}
INSTANTIATE_TEST_SUITE_P(By, StoppedCut,
                         ::testing::Values(Stop::kEstop, Stop::kController, Stop::kClient, Stop::kBoth),
                         name_of);

}  // namespace
}  // namespace hotblade::pipeline
