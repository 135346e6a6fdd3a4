// What a controller's execution log says about where it stood: all it needs to go on after a restart.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <vector>

#include "robot/pose/pose.hpp"
#include "robot/wire/job.hpp"
#include "robot/wire/protocol.hpp"

namespace hotblade::robot {

// A log that cannot be used, as `file: what: hint`.
struct LogError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Where a controller stood when its log ends.
struct ControllerJournal {
  std::uint32_t token = 0;  // the largest that was given
  // IDLE without an open job (or ESTOP, latched); HELD for any that had begun to move and was not over.
  protocol::State state = protocol::State::kIdle;
  protocol::Fault fault = protocol::Fault::kNone;
  std::uint16_t fault_detail = 0;
  std::uint32_t fault_sequence = 0;
  protocol::ArmsDetail fault_arms;  // empty in logs that do not say it

  bool loaded = false;  // the job is open; otherwise it is the last one, for whoever asks
  bool left = false;    // lost to RESET before its end, and neither taken up again nor released
  std::uint64_t job = 0;
  std::uint32_t run = 0, count = 0;
  ClampedBlade blade;
  std::optional<protocol::Arms> arms;  // as declared
  std::vector<protocol::RawWaypoint> executed;
  Sha256 chain{};                  // over them
  std::uint64_t motion_us = 0;     // the motion clock
  double path_s = 0;               // the place on the path, s of the strip's own time
  std::optional<ClampPoses> held;  // where the clamps were last, cell frame
};

// Returns where a log ends; an empty journal when there is no such file. A torn last line does not count.
// Throws LogError, with the line, for anything else that is no log, whose chain does not follow, or whose
// sequence numbers do not.
[[nodiscard]] ControllerJournal read_controller_journal(const std::filesystem::path& log);

}  // namespace hotblade::robot
