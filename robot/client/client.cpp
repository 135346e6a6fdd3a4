#include "robot/client/client.hpp"

#include <algorithm>
#include <chrono>
#include <thread>

#include "robot/client/fault_text.hpp"
#include "robot/client/patience.hpp"
#include "robot/client/streamer.hpp"

namespace hotblade::robot {

using protocol::Op;
using protocol::Result;
using protocol::State;

using std::chrono::milliseconds;

namespace {

// One after the other: a request spoilt on the way earns one, a controller of another kind nothing else.
constexpr int kMaxExceptions = 10;

}  // namespace

bool Streamer::connect() {
  const auto give_up = Clock::now() + milliseconds(options_.link_down_ms);
  auto pause = kShortestPause;
  while (!link_.connect()) {
    note_lost();
    if (interrupted()) return interrupted_without_link();
    if (Clock::now() >= give_up) {
      return settle(StreamOutcome::kLinkLost,
                    "no connection (" + link_.error() + ", waited " + std::to_string(options_.link_down_ms) +
                        " ms): check that the controller runs; --resume goes on later");
    }
    std::this_thread::sleep_for(pause);
    pause = std::min<milliseconds>(2 * pause, kLongestPause);
  }
  return true;
}

// After a lost answer: nothing is known but what the controller says now.
bool Streamer::reconnect() {
  ++report_.reconnects;
  lost_ = true;
  note_lost();
  return connect();
}

// Shows at once that there is no answer, and how long.
void Streamer::note_lost() {
  const bool first = !lost_since_;
  if (first) lost_since_ = Clock::now();
  show(first);
}

// True while another attempt makes sense.
bool Streamer::refused_again(const char* what) {
  if (++exceptions_ < kMaxExceptions) return true;
  return settle(StreamOutcome::kRefused,
                std::string(what) + " (" + link_.error() +
                    ", again and again): client and controller disagree on the protocol; check the address");
}

// A whole block, however many attempts that takes.
template <std::size_t N>
bool Streamer::read_block(std::uint16_t address, std::array<std::uint16_t, N>& block, const char* name) {
  const auto give_up = Clock::now() + milliseconds(options_.link_down_ms);
  for (;;) {
    const LinkOutcome outcome = link_.read(address, block);
    if (outcome == LinkOutcome::kOk && intact(block)) break;
    if (outcome == LinkOutcome::kException) {
      if (!refused_again((std::string(name) + " cannot be read").c_str())) return false;
      continue;
    }
    if (interrupted()) return interrupted_without_link();
    if (Clock::now() >= give_up) {
      return settle(StreamOutcome::kLinkLost, "no answers (waited " + std::to_string(options_.link_down_ms) +
                                                  " ms): check the link; --resume goes on later");
    }
    if (!reconnect()) return false;
  }
  exceptions_ = 0;
  return true;
}

bool Streamer::interrupted_without_link() {
  return settle(
      StreamOutcome::kInterrupted,
      "interrupted while the link is down: a machine that moves is held by the controller's watchdog");
}

bool Streamer::identify() {
  std::array<std::uint16_t, protocol::kIdentSize> block{};
  if (!read_block(protocol::kIdentBase, block, "IDENT")) return false;
  const std::uint32_t boot = ident_.boot_id;
  ident_ = protocol::decode_ident(block);
  if (boot != 0 && boot != ident_.boot_id) ++report_.restarts;
  return known_kind();
}

bool Streamer::known_kind() {
  if (ident_.magic == protocol::kMagic && ident_.version == protocol::kVersion &&
      ident_.registers_per_waypoint == protocol::kRegistersPerWaypoint &&
      ident_.unit_codes == protocol::kUnitCodes &&
      ident_.max_waypoints_per_write >= protocol::kMaxWaypointsPerWindow) {
    return true;
  }
  return settle(StreamOutcome::kRefused, "no hot-blade controller of protocol version 1 (magic " +
                                             std::to_string(ident_.magic) + ", version " +
                                             std::to_string(ident_.version) + "): check the address");
}

// A connection that was lost may have been to a controller that was restarted since: a new one begins with
// IDENT.
bool Streamer::refresh() {
  std::array<std::uint16_t, protocol::kStatusSize> block{};
  for (;;) {
    const int reconnects = report_.reconnects;
    if (!read_block(protocol::kStatusBase, block, "STATUS")) return false;
    if (report_.reconnects == reconnects) break;
    if (!identify()) return false;
  }
  take(block);
  lost_ = false;
  return true;
}

// What was executed of the job is the last that a controller said of it: one that came back without its log
// knows nothing of the job, but the block is cut.
void Streamer::take(std::span<const std::uint16_t, protocol::kStatusSize> block) {
  status_ = protocol::decode_status(block);
  lost_since_.reset();
  if (status_.job_id == job_.id) report_.executed = status_.executed;
}

// Writes a block and reads STATUS in one transaction. After a lost answer IDENT and STATUS are read afresh,
// and lost_ stays set: whether the write was carried out shows in `accepted` or in the last nonce.
bool Streamer::transact(std::uint16_t address, std::span<const std::uint16_t> registers) {
  std::array<std::uint16_t, protocol::kStatusSize> block{};
  const LinkOutcome outcome = link_.write_read(address, registers, protocol::kStatusBase, block);
  lost_ = false;
  if (outcome == LinkOutcome::kOk && intact(block)) {
    exceptions_ = 0;
    take(block);
    return true;
  }
  if (outcome == LinkOutcome::kException) {
    if (!refused_again("the controller refused a write")) return false;
  } else if (!reconnect() || !identify()) {
    return false;
  }
  const int exceptions = exceptions_;
  if (!refresh()) return false;
  if (outcome == LinkOutcome::kException) exceptions_ = exceptions;
  lost_ = true;
  return true;
}

// Until it is answered; the same nonce makes the controller carry it out once.
bool Streamer::command(Op op) {
  protocol::Command c{++nonce_, op, job_.id, run_, token_, 0, {}};
  if (op == Op::kOpen) {
    c.waypoint_count = job_.size();
    c.blade = job_.blade;
  }
  const auto block = protocol::encode_command(c);
  for (int attempt = 0; attempt < kMaxFruitless; ++attempt) {
    if (!transact(protocol::kCommandBase, block)) return false;
    if (!lost_ && status_.last_result != Result::kBadCrc) return true;
    // What sets the machine in motion was agreed to with another life of the controller.
    const bool moves = op == Op::kStart || op == Op::kResume || op == Op::kWithdraw;
    if (moves && restarted()) return true;
  }
  return settle(StreamOutcome::kLinkLost,
                std::string(protocol::name(op)) + " is never answered: check the link");
}

// Of a client that died before it heard so: opened again, the job would go through a block that is cut.
bool Streamer::cut_to_the_end() {
  const bool ours = status_.job_id == job_.id && (options_.run == 0 || options_.run == status_.run);
  if (!options_.resume || !ours || status_.state != State::kIdle || status_.left_in_cut) return false;
  if (complete()) run_ = status_.run;
  return complete();
}

bool Streamer::choose_run() {
  if (status_.left_in_cut && (status_.job_id != job_.id || !options_.resume)) {
    return settle(StreamOutcome::kRefused,
                  "the blade stands in the cut of job " + to_hex(status_.job_id) + ", " +
                      std::to_string(status_.executed) +
                      " waypoints executed: withdraw it, go on with that job, or give the block up first");
  }
  const bool there = status_.job_id == job_.id && (status_.state != State::kIdle || status_.left_in_cut);
  if (there && !options_.resume && status_.state != State::kFault && status_.state != State::kEstop) {
    return settle(StreamOutcome::kRefused,
                  "already open on the controller (" + std::to_string(status_.executed) + " of " +
                      std::to_string(job_.size()) +
                      " waypoints executed): --resume takes it over, --recover withdraw or give-up ends it");
  }
  run_ = options_.run;
  if (run_ == 0) run_ = there && options_.resume ? status_.run : status_.run + 1;
  return true;
}

bool Streamer::open() {
  if (status_.state == State::kFault || status_.state == State::kEstop) return stopped_by_fault();
  // Our own lease may stand in the way: of the client we go on for, or of an OPEN whose answer was lost.
  const auto patience = Clock::now() + lease_patience(ident_.lease_ms);
  for (;;) {
    const int reconnects = report_.reconnects;
    if (!command(Op::kOpen)) return false;
    const bool ours = status_.job_id == job_.id && status_.run == run_;
    const bool may_wait = ours && (options_.resume || report_.reconnects > reconnects);
    if (status_.last_result != Result::kBusy || !may_wait || Clock::now() > patience) break;
    if (interrupted()) return settle(StreamOutcome::kInterrupted, "interrupted while waiting for the lease");
    show(false);
    std::this_thread::sleep_for(kRetry);
  }
  if (status_.last_result != Result::kOk) return refused_open();
  token_ = status_.token;
  open_ = true;
  agreed_boot_ = options_.agreed_boot != 0 ? options_.agreed_boot : ident_.boot_id;
  if (!check_prefix() || !declare_arms()) return false;
  if (options_.opened) options_.opened(run_, token_);
  return true;
}

// Only where the controller knows the block. A program without arms is refused by START there.
bool Streamer::declare_arms() {
  if ((ident_.capabilities & protocol::kCapArms) == 0 || !job_.arms) return true;
  protocol::Arms arms = job_.arms->declared;
  arms.token = token_;
  const auto block = protocol::encode_arms(arms);
  for (int attempt = 0; attempt < kMaxFruitless; ++attempt) {
    if (!transact(protocol::kArmsBase, block)) return false;
    if (lost_ || status_.last_result == Result::kBadCrc) continue;
    if (status_.last_result == Result::kOk) return true;
    const std::string at =
        status_.last_result == Result::kLimit ? ": " + told_limit(status_, ident_.limits) : std::string();
    return settle(StreamOutcome::kRefused, std::string(protocol::name(status_.last_result)) +
                                               ": the program's arms are refused in state " +
                                               protocol::name(status_.state) + at);
  }
  return settle(StreamOutcome::kLinkLost, "ARMS is never answered: check the link");
}

bool Streamer::refused_open() {
  switch (status_.last_result) {
    case Result::kBusy:
      return settle(StreamOutcome::kRefused,
                    "BUSY: another client owns the controller (job " + to_hex(status_.job_id) + ", lease " +
                        std::to_string(ident_.lease_ms) + " ms): wait until it is done");
    case Result::kLimit:
      return settle(StreamOutcome::kRefused,
                    std::string("LIMIT: ") + info(limit_of_code(status_.fault_detail)).fault + " (" +
                        std::to_string(job_.size()) + " waypoints, at most " +
                        std::to_string(ident_.max_waypoints) + "): check the program's blade");
    default:
      if (status_.state == State::kFault || status_.state == State::kEstop) return stopped_by_fault();
      return settle(StreamOutcome::kRefused,
                    std::string(protocol::name(status_.last_result)) + ": OPEN refused in state " +
                        protocol::name(status_.state) + " (job " + to_hex(status_.job_id) + " is open, " +
                        std::to_string(status_.executed) +
                        " waypoints executed): run that job's program with --resume to go on, or with "
                        "--recover withdraw or give-up");
  }
}

bool Streamer::check_prefix() {
  const bool equal = status_.job_id == job_.id && status_.run == run_ && status_.accepted <= job_.size() &&
                     prefix_crc(job_, status_.accepted) == status_.accepted_crc;
  if (equal) return true;
  return settle(StreamOutcome::kRefused, "the controller holds other waypoints (job " +
                                             to_hex(status_.job_id) + ", " +
                                             std::to_string(status_.accepted) +
                                             " accepted): it was restarted or taken over; look at its log");
}

// A job that was refused before anything moved is closed again: nothing is under way, and others may come.
// One whose last answer was lost stays as it is.
void Streamer::give_back() {
  const bool ours = open_ && status_.job_id == job_.id && status_.run == run_;
  const bool unmoved =
      ours && status_.state == State::kOpen && status_.executed == 0 && !lost_ && !restarted();
  if (report_.outcome != StreamOutcome::kRefused || !unmoved) return;
  const StreamReport refused = report_;
  const protocol::Status then = status_;
  const bool closed =
      command(Op::kClose) && status_.last_result == Result::kOk && status_.state == State::kIdle;
  report_ = refused;
  report_.given_back = closed;
  status_ = then;
}

StreamReport stream(const Job& job, const StreamOptions& options) {
  return Streamer(job, options).run();
}

StreamReport withdraw(const Job& job, const StreamOptions& options) {
  StreamOptions resumed = options;
  resumed.resume = true;
  return Streamer(job, resumed).withdraw();
}

}  // namespace hotblade::robot
