// How long, and how far, the machine moves on after an ESTOP and after the loss of its owner: from the
// execution log, whose motion clock runs with wall time from START on.
//
// HOTBLADE_LATENCY=full: with the watchdog's real 2 s instead of 0.2 s.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <thread>

#include "robot/wire/modbus_link.hpp"
#include "tests/robot/controller/simulator_fixture.hpp"
#include "tests/robot/wire/sample_job.hpp"

namespace hotblade::robot {
namespace {

using Clock = std::chrono::steady_clock;
using protocol::Op;
using testing::Simulator;

struct LoggedPose {
  double t = 0;  // s from START
  Eigen::Vector3d a{0, 0, 0};
};

std::vector<LoggedPose> poses_of(const std::filesystem::path& log) {
  std::vector<LoggedPose> poses;
  std::ifstream in(log);
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with("{\"ev\":\"pose\"")) continue;
    LoggedPose pose;
    const auto value = [&](const char* key) { return line.c_str() + line.find(key) + std::strlen(key); };
    pose.t = std::strtod(value("\"t\":"), nullptr);
    EXPECT_EQ(std::sscanf(value("\"a\":{\"p\":["), "%lf,%lf,%lf", &pose.a.x(), &pose.a.y(), &pose.a.z()), 3);
    poses.push_back(pose);
  }
  return poses;
}

struct Stop {
  double time_s = 0, distance_mm = 0, speed_mm_s = 0;  // from the event to standstill; speed at the event
};

// Streams the whole job, lets it run for `run_s`, does what `event` does, and looks at the log `wait_s`
// later.
template <typename Event>
Stop measure(const ControllerOptions& options, double run_s, double wait_s, Event event) {
  Simulator simulator(options);
  const Job job = testing::sample_job(200);
  ModbusLink link("127.0.0.1", simulator.port(), 1000);
  EXPECT_TRUE(link.connect());
  std::array<std::uint16_t, protocol::kStatusSize> block{};
  const auto write = [&](std::uint16_t address, std::span<const std::uint16_t> registers) {
    EXPECT_EQ(link.write_read(address, registers, protocol::kStatusBase, block), LinkOutcome::kOk);
    return protocol::decode_status(block);
  };
  std::uint32_t nonce = 0;
  const auto command = [&](Op op, std::uint32_t token) {
    return write(protocol::kCommandBase,
                 protocol::encode_command({++nonce, op, job.id, 1, token, job.size(), job.blade}));
  };
  const auto token = command(Op::kOpen, 0).token;
  for (std::uint32_t k = 0; k < job.size(); k += 4) {
    write(protocol::kWindowBase,
          protocol::encode_window(token, k, k + 4 == job.size(), std::span(job.raw).subspan(k, 4)).span());
  }
  const auto start = Clock::now();
  EXPECT_EQ(command(Op::kStart, token).last_result, protocol::Result::kOk);
  for (double t = 0; t < run_s; t += 0.05) {
    write(protocol::kWindowBase, protocol::encode_window(token, job.size(), false, {}).span());
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  const double event_s = std::chrono::duration<double>(Clock::now() - start).count();
  event(link);
  std::this_thread::sleep_for(std::chrono::duration<double>(wait_s));
  simulator.stop();
  const auto poses = poses_of(simulator.log_file());
  Stop stop;
  stop.time_s = poses.back().t - event_s;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const double step = (poses[i].a - poses[i - 1].a).norm();
    const double dt = poses[i].t - poses[i - 1].t;
    if (poses[i].t <= event_s) {
      stop.speed_mm_s = dt > 0 ? step / dt : 0;
    } else {
      stop.distance_mm +=
          step * std::min(1.0, (poses[i].t - event_s) / dt);  // of the step under way its rest
    }
  }
  std::printf("%.1f mm/s: standstill after %.1f ms and %.3f mm\n", stop.speed_mm_s, 1000 * stop.time_s,
              stop.distance_mm);
  return stop;
}

TEST(Latency, AnEstopEndsTheMotionWithinTwoTicksOfTheServer) {
  const Stop stop = measure(ControllerOptions{}, 1.5, 0.1, [](ModbusLink& link) {
    const std::array<std::uint16_t, 1> one{1};
    std::array<std::uint16_t, 1> ignored{};
    EXPECT_EQ(link.write_read(protocol::kEstopBase, one, protocol::kScratchBase, ignored), LinkOutcome::kOk);
  });
  EXPECT_GT(stop.speed_mm_s, 5) << "it was moving";
  // On an idle machine the write takes 0.1 ms; a busy one may keep the server waiting.
  EXPECT_LT(stop.time_s, 0.25);
  EXPECT_LE(stop.distance_mm, 60 * std::max(stop.time_s, 0.0) + 0.1);
}

TEST(Latency, ALostLinkEndsTheMotionAfterWatchdogAndRamp) {
  ControllerOptions options;
  const char* wanted = std::getenv("HOTBLADE_LATENCY");
  const bool full = wanted != nullptr && std::strcmp(wanted, "full") == 0;
  if (!full) options.watchdog_ms = 200;
  const double watchdog_s = options.watchdog_ms * 1e-3, ramp_s = 1 / PathClock::kRampPerS;
  const Stop stop = measure(options, 1.0, watchdog_s + ramp_s + 0.5, [](ModbusLink& link) {
    (void)link;  // nothing more is sent
  });
  // The last sign of life was up to 50 ms before, plus a turn of the server.
  EXPECT_GT(stop.time_s, watchdog_s + ramp_s - 0.1);
  EXPECT_LT(stop.time_s, watchdog_s + ramp_s + 0.25);
  EXPECT_LT(stop.distance_mm, 60 * (watchdog_s + ramp_s / 2 + 0.25));
}

}  // namespace
}  // namespace hotblade::robot
