// Streams a job to a controller over Modbus TCP (docs/controller-protocol.md), so that every waypoint is
// executed once, in order, whatever the link does.
//
// It goes on from the controller's `accepted` alone, never from the success of a write. On any error but a
// Modbus exception it closes the connection, connects again, compares the accepted prefix with its own and
// goes on; so it does when the controller was restarted and went on from its journal.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "robot/wire/job.hpp"
#include "robot/wire/protocol.hpp"

namespace hotblade::robot {

// How far a job is, for whoever watches.
struct StreamProgress {
  protocol::State state = protocol::State::kIdle;
  protocol::Fault fault = protocol::Fault::kNone;
  std::uint32_t accepted = 0, executed = 0, total = 0;
  double left_s = 0;  // of the plan's own time
  int reconnects = 0;
  double link_lost_s = 0;  // since the last answer, while there is none; 0: the link is up
};

// Whom to stream to, and how patiently.
struct StreamOptions {
  std::string host = "127.0.0.1";
  std::uint16_t port = 1502;
  // The run of the job. 0: the controller's last run number plus one; with `resume` the controller's present
  // one.
  std::uint32_t run = 0;
  // Take over this job where an earlier client left it, waiting for its lease to run out if need be. One that
  // the controller has executed to its end and closed is kDone, and is not opened again.
  bool resume = false;
  // Called with the run and the token as soon as the job is open, before anything moves: to be kept until the
  // job is done.
  std::function<void(std::uint32_t run, std::uint32_t token)> opened;
  // The boot id of the controller that motion was agreed to with; 0: of whichever opens the job.
  std::uint32_t agreed_boot = 0;
  // Asked before a machine whose controller was restarted meanwhile is set in motion again; false: it stays
  // HELD. Without it, it goes on.
  std::function<bool(const protocol::Status&)> may_go_on;
  std::uint32_t response_ms = 500;     // an answer later than that is lost
  std::uint32_t link_down_ms = 30000;  // so long without any answer: give up
  std::uint32_t poll_ms = 20;          // between looks at the status while there is nothing to send
  std::function<void(const StreamProgress&)> progress;  // about ten times a second
  std::function<bool()> interrupted;                    // true: HOLD and return
};

// How a stream ended.
enum class StreamOutcome {
  kDone,         // every waypoint executed, proved by count and CRC, job closed
  kRefused,      // the controller said no
  kFault,        // FAULT or ESTOP
  kLinkLost,     // not reached, or not for too long
  kInterrupted,  // held as asked; `resume` goes on
};

// What became of a job.
struct StreamReport {
  StreamOutcome outcome = StreamOutcome::kDone;
  std::string message;  // why it is not done: what (value, limit): hint
  std::uint32_t run = 0, token = 0;
  std::uint32_t executed = 0;  // as the controller last said of the job
  int reconnects = 0;
  int restarts = 0;                 // of the controller, seen by its boot id
  std::uint64_t windows = 0;        // sent, repeated ones included
  bool given_back = false;          // refused before anything moved, and closed on the controller
  std::optional<std::uint32_t> at;  // the waypoint a refusal or a fault speaks of
};

// Streams a job to its end, or to where it is stopped. It throws nothing for what a controller or a link can
// do.
[[nodiscard]] StreamReport stream(const Job& job, const StreamOptions& options);

// Draws the blade of a job that was left half cut back along the path it has cut, cold, to its first
// waypoint, whether the job is HELD or was lost to RESET. kDone: it is there, and the job is over.
[[nodiscard]] StreamReport withdraw(const Job& job, const StreamOptions& options);

// What a controller says of itself.
struct ControllerSnapshot {
  bool reached = false;
  std::string message;  // why not
  protocol::Ident ident;
  protocol::Status status;
};
// Takes one look at a controller, with a few attempts.
[[nodiscard]] ControllerSnapshot look(const StreamOptions& options);

// Takes a controller out of FAULT or ESTOP to IDLE, once the lease of the job's owner has run out. The job is
// lost. The message is empty when the controller is IDLE or has nothing to clear.
struct ResetReport {
  StreamOutcome outcome = StreamOutcome::kDone;
  std::string message;
};
[[nodiscard]] ResetReport reset(const StreamOptions& options);

// Gives a job up that is HELD, or was lost to RESET with the blade in the cut: ABORT and RESET, once the
// lease of the job's owner has run out, and RELEASE, as the blade is freed by hand. Nothing moves. The
// message is empty when the controller is IDLE and nothing is left in the cut.
[[nodiscard]] ResetReport give_up(std::uint64_t job, std::uint32_t run, const StreamOptions& options);

}  // namespace hotblade::robot
