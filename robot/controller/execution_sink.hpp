// Where a controller reports what it did. The execution log is one; tests have others.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "robot/arm/arm.hpp"
#include "robot/blade/blade_check.hpp"
#include "robot/wire/job.hpp"
#include "robot/wire/protocol.hpp"

namespace hotblade::robot {

// A waypoint that was executed. Times are of the motion clock, us from START, which runs on while the path is
// slowed down and stands in HELD.
struct ExecutedWaypoint {
  std::uint64_t job = 0;
  std::uint32_t token = 0, sequence = 0;
  std::uint32_t t_plan_us = 0;
  std::uint64_t t_exec_us = 0;
  const protocol::RawWaypoint& raw;
  const Sha256& chain;  // over everything executed up to here
  std::optional<BladeMargins> margins = {};
};

// Where the clamps are, between waypoint `sequence` and the next.
struct PoseSample {
  std::uint64_t job = 0;
  std::uint32_t sequence = 0;
  std::uint64_t t_us = 0;
  Pose a, b;  // cell frame, mm
  bool heat = false;
  protocol::State state = protocol::State::kIdle;
  double path_s = 0;                             // of the strip's own time: the place on the path
  double following_mm = 0;                       // how far the worse clamp is behind what is asked of it
  std::optional<elastica::Elastica> blade = {};  // clamp A to clamp B, in clamp A's axes; absent: not known
  std::optional<std::array<JointAngles, 2>> joints = {};  // that hold clamp A and clamp B; absent: not known
};

// A change of state: what = "open", "takeover", "arms", "start", "hold", "held", "cold" (heat off after the
// dwell), "resume", "retract", "reheat", "reenter", "restart" (of the controller, from its journal), "done",
// "fault", "estop", "reset", "close".
struct JobEvent {
  const char* what = "";
  std::uint64_t job = 0;
  std::uint32_t run = 0, token = 0, sequence = 0;
  std::uint32_t waypoint_count = 0;
  std::uint64_t t_us = 0;
  protocol::Fault fault = protocol::Fault::kNone;
  std::uint16_t fault_detail = 0;
  std::uint32_t fault_sequence = 0;
  ClampedBlade blade = {};
  std::optional<protocol::Arms> arms = {};  // as declared
  protocol::ArmsDetail fault_arms = {};     // of fault_detail, where that is a limit of the arms
};

// Takes what a controller reports, in the order it happens.
class ExecutionSink {
 public:
  ExecutionSink() = default;
  ExecutionSink(const ExecutionSink&) = delete;
  ExecutionSink& operator=(const ExecutionSink&) = delete;
  virtual ~ExecutionSink() = default;

  // None of these may throw, and the first two may not allocate while commits succeed.
  virtual void executed(const ExecutedWaypoint& waypoint) = 0;
  virtual void pose(const PoseSample& sample) = 0;
  virtual void event(const JobEvent& event) = 0;
  // Makes everything reported so far durable, what an earlier commit could not included; returns false when
  // it could not be.
  virtual bool commit() = 0;
};

}  // namespace hotblade::robot
