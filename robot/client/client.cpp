#include "robot/client/client.hpp"

#include <algorithm>
#include <chrono>
#include <random>
#include <thread>

#include "robot/client/fault_text.hpp"
#include "robot/client/patience.hpp"
#include "robot/wire/modbus_link.hpp"

namespace hotblade::robot {

using protocol::Fault;
using protocol::Op;
using protocol::Result;
using protocol::State;

namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr auto kProgressEvery = milliseconds(100);
constexpr std::uint32_t kPrefill = 256;  // waypoints before START: seconds of motion, at any step
constexpr int kMaxFruitless = 100;       // answers without progress, one after the other
// One after the other: a request spoilt on the way earns one, a controller of another kind nothing else.
constexpr int kMaxExceptions = 10;
// A machine stands that told of no more waypoints for so long, and is waited for no longer than that.
constexpr auto kStands = milliseconds(300), kLongestStop = milliseconds(3000);

// One job on its way. Steps return false when the outcome is settled.
class Streamer {
 public:
  Streamer(const Job& job, const StreamOptions& options)
      : job_(job),
        options_(options),
        link_(options.host, options.port, options.response_ms),
        nonce_(std::random_device{}()) {}

  StreamReport run() {
    return report_of(connect() && identify() && refresh() &&
                     (cut_to_the_end() || (choose_run() && open() && go() && finish())));
  }

  StreamReport withdraw() {
    return report_of(connect() && identify() && refresh() && choose_run() && open() && draw_back());
  }

 private:
  StreamReport report_of([[maybe_unused]] bool done) {
    report_.executed = status_.job_id == job_.id ? status_.executed : 0;
    report_.run = run_;
    report_.token = token_;
    show(true);
    return report_;
  }

  bool settle(StreamOutcome outcome, const std::string& what) {
    report_.outcome = outcome;
    report_.message =
        options_.host + ":" + std::to_string(options_.port) + ": strip " + job_.strip + ": " + what;
    return false;
  }
  [[nodiscard]] bool interrupted() const { return options_.interrupted && options_.interrupted(); }

  // The limit that a status speaks of, of the arms with the part and the amount.
  [[nodiscard]] std::string told_limit(const protocol::Status& status, const MotionLimits& limits) const {
    const Limit limit = limit_of_code(status.fault_detail);
    const std::string part =
        protocol::describe(status.arms, limit, job_.arms ? job_.arms->names : std::array<std::string, 2>{});
    return limit_text(limit, limits) + (part.empty() ? "" : " (" + part + ")");
  }

  bool connect();
  bool reconnect();
  bool identify();
  bool known_kind();
  template <std::size_t N>
  bool read_block(std::uint16_t address, std::array<std::uint16_t, N>& block, const char* name);
  [[nodiscard]] bool intact(std::span<const std::uint16_t, protocol::kIdentSize> ident) const {
    return protocol::ident_intact(ident);
  }
  [[nodiscard]] bool intact(std::span<const std::uint16_t, protocol::kStatusSize> status) const {
    return (ident_.capabilities & protocol::kCapBlockCrc) == 0 || protocol::block_intact(status);
  }
  bool refused_again(const char* what);
  bool interrupted_without_link();
  bool refresh();
  bool transact(std::uint16_t address, std::span<const std::uint16_t> registers);
  bool command(Op op);
  bool cut_to_the_end();
  [[nodiscard]] bool complete() const {
    return status_.executed == job_.size() && prefix_crc(job_, job_.size()) == status_.executed_crc;
  }
  bool choose_run();
  bool open();
  bool refused_open();
  bool declare_arms();
  bool check_prefix();
  bool go();
  bool step();
  bool started();
  bool ready_to_move() const;
  bool send_window(bool wait);
  bool judge_window(std::uint32_t accepted_before);
  bool hold();
  void read_to_rest();
  bool stopped_by_fault();
  bool finish();
  bool draw_back();
  bool may_move();
  // Since motion was agreed to.
  [[nodiscard]] bool restarted() const { return agreed_boot_ != ident_.boot_id; }
  void note_lost();
  void show(bool force);

  const Job& job_;
  const StreamOptions& options_;
  ModbusLink link_;
  protocol::Ident ident_;
  protocol::Status status_;
  std::uint32_t nonce_, run_ = 0, token_ = 0;
  bool open_ = false, lost_ = false;
  int fruitless_ = 0, exceptions_ = 0;
  std::uint32_t agreed_boot_ = 0;  // motion was agreed to with the controller as it was started then
  std::optional<Clock::time_point> lost_since_;
  Clock::time_point shown_{};
  StreamReport report_;
};

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
  status_ = protocol::decode_status(block);
  lost_ = false;
  lost_since_.reset();
  return true;
}

// Writes a block and reads STATUS in one transaction. After a lost answer IDENT and STATUS are read afresh,
// and lost_ stays set: whether the write was carried out shows in `accepted` or in the last nonce.
bool Streamer::transact(std::uint16_t address, std::span<const std::uint16_t> registers) {
  std::array<std::uint16_t, protocol::kStatusSize> block{};
  const LinkOutcome outcome = link_.write_read(address, registers, protocol::kStatusBase, block);
  lost_ = false;
  if (outcome == LinkOutcome::kOk && intact(block)) {
    exceptions_ = 0;
    lost_since_.reset();
    status_ = protocol::decode_status(block);
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

bool Streamer::go() {
  while (status_.state != State::kDone) {
    if (interrupted()) return hold();
    show(false);
    if (!step()) return false;
    if (lost_ && !check_prefix()) return false;
  }
  return true;
}

// What the state asks for: start, go on, send, or wait.
bool Streamer::step() {
  switch (status_.state) {
    case State::kOpen:
    case State::kHeld:
      if (!ready_to_move()) return send_window(false);
      if (restarted()) return may_move();
      return command(status_.state == State::kOpen ? Op::kStart : Op::kResume) && started();
    case State::kRunning:
      return send_window(true);
    case State::kFault:
    case State::kEstop:
      return stopped_by_fault();
    default:
      return settle(StreamOutcome::kRefused,
                    "the job is no longer open on the controller (restarted?): run it anew");
  }
}

// A controller that was restarted stands; people may have gone to the machine meanwhile.
bool Streamer::may_move() {
  if (options_.may_go_on && !options_.may_go_on(status_)) {
    return settle(StreamOutcome::kInterrupted, "not set in motion again after the controller's restart, " +
                                                   std::to_string(status_.executed) + " of " +
                                                   std::to_string(job_.size()) + " waypoints executed");
  }
  agreed_boot_ = ident_.boot_id;
  lost_ = true;  // the answer may have taken minutes
  return refresh() && check_prefix();
}

bool Streamer::started() {
  if (restarted()) return true;  // and the operator is asked
  fruitless_ = status_.last_result == Result::kOk ? 0 : fruitless_ + 1;
  if (status_.last_result == Result::kState && limit_of_code(status_.fault_detail) == Limit::kCell) {
    return settle(StreamOutcome::kRefused,
                  job_.arms
                      ? "STATE: the program's arms are not those of this controller's cell: plan or place "
                        "it with the cell that the controller has"
                      : "STATE: this controller checks its arms, and the program has none: plan or place "
                        "it with --cell");
  }
  const bool may_change = status_.last_result == Result::kOk || status_.last_result == Result::kState;
  if (may_change && fruitless_ < kMaxFruitless) return true;
  return settle(StreamOutcome::kRefused, std::string(protocol::name(status_.last_result)) +
                                             ": the motion may not start in state " +
                                             protocol::name(status_.state));
}

bool Streamer::ready_to_move() const {
  const std::uint32_t ahead = status_.accepted - status_.executed;
  return status_.accepted == job_.size() || ahead >= std::min<std::uint32_t>(kPrefill, ident_.fifo_size) ||
         status_.free == 0;
}

// The next waypoints as far as there is room, or a sign of life.
bool Streamer::send_window(bool wait) {
  const std::uint32_t accepted = status_.accepted;
  const std::uint32_t room = std::min<std::uint32_t>(status_.free, protocol::kMaxWaypointsPerWindow);
  const std::uint32_t n = std::min(room, job_.size() - accepted);
  const auto raw = std::span(job_.raw).subspan(accepted, n);
  const auto window = protocol::encode_window(token_, accepted, n > 0 && accepted + n == job_.size(), raw);
  if (!transact(protocol::kWindowBase, window.span())) return false;
  ++report_.windows;
  if (lost_) return true;
  if (n == 0 && wait) std::this_thread::sleep_for(milliseconds(options_.poll_ms));
  if (n == 0) return status_.last_result != Result::kBadToken || judge_window(accepted);
  return judge_window(accepted);
}

bool Streamer::judge_window(std::uint32_t accepted_before) {
  fruitless_ = status_.accepted > accepted_before ? 0 : fruitless_ + 1;
  const std::string at = "waypoint " + std::to_string(status_.fault_sequence);
  switch (status_.last_result) {
    case Result::kLimit:
      report_.at = status_.fault_sequence;
      return settle(StreamOutcome::kRefused, "LIMIT: " + at + ": " + told_limit(status_, ident_.limits) +
                                                 ": the program does not fit this machine");
    case Result::kBadToken:
      return settle(StreamOutcome::kRefused, "BADTOKEN: another client has taken over (token " +
                                                 std::to_string(status_.token) + ", ours " +
                                                 std::to_string(token_) + ")");
    case Result::kConflict:
      report_.at = status_.fault_sequence;
      return settle(StreamOutcome::kFault, "CONFLICT: " + at + " was accepted with other contents");
    default:
      break;
  }
  if (fruitless_ < kMaxFruitless) return true;
  return settle(StreamOutcome::kRefused, std::string(protocol::name(status_.last_result)) +
                                             ": no waypoint accepted in " + std::to_string(kMaxFruitless) +
                                             " windows");
}

// Ctrl-C: slow down along the path and wait for rest.
bool Streamer::hold() {
  if (status_.state == State::kRunning) {
    if (!command(Op::kHold)) return false;
    const auto patience = Clock::now() + milliseconds(5000);
    while (status_.state == State::kRunning && Clock::now() < patience) {
      std::this_thread::sleep_for(milliseconds(options_.poll_ms));
      if (!refresh()) return false;
    }
  }
  return settle(StreamOutcome::kInterrupted,
                std::string("interrupted, controller is ") + protocol::name(status_.state) + " after " +
                    std::to_string(status_.executed) + " of " + std::to_string(job_.size()) + " waypoints");
}

// A fault is told of at once, what is executed on the way to rest when it is on record.
void Streamer::read_to_rest() {
  const protocol::Status told = status_;
  const auto give_up = Clock::now() + kLongestStop;
  auto rest = Clock::now() + kStands;
  while (Clock::now() < std::min(rest, give_up)) {
    const std::uint32_t executed = status_.executed;
    std::this_thread::sleep_for(milliseconds(options_.poll_ms));
    if (!refresh()) break;
    if (status_.executed != executed) rest = Clock::now() + kStands;
  }
  if (status_.state != told.state || status_.job_id != told.job_id) status_ = told;
}

bool Streamer::stopped_by_fault() {
  if (open_) read_to_rest();
  if (status_.state == State::kEstop) {
    if (status_.job_id == job_.id && status_.executed > 0) report_.at = status_.executed - 1;
    return settle(StreamOutcome::kFault, "ESTOP is latched: clear the cell, then reset with --reset");
  }
  std::string what = state_text(status_);
  report_.at = status_.fault_sequence;
  if (status_.fault == Fault::kExecutionLimit) what += ": " + told_limit(status_, ident_.limits);
  const std::string log = log_fault_text(status_);
  return settle(StreamOutcome::kFault, what + " at waypoint " + std::to_string(status_.fault_sequence) +
                                           (log.empty() ? ": " : ": " + log + ", then ") +
                                           "reset with --reset");
}

// Backwards to the first waypoint. The next waypoint is sent first: a controller that was restarted knows
// from it where its path leads.
bool Streamer::draw_back() {
  while (status_.accepted == status_.executed && status_.executed < job_.size()) {
    if (!send_window(false)) return false;
  }
  if (!command(Op::kWithdraw)) return false;
  if (restarted())
    return settle(StreamOutcome::kInterrupted, "the controller was restarted, nothing moves: run it again");
  if (status_.last_result != Result::kOk) {
    return settle(StreamOutcome::kRefused, std::string(protocol::name(status_.last_result)) +
                                               ": WITHDRAW refused in state " +
                                               protocol::name(status_.state));
  }
  while (status_.state == State::kRunning) {
    if (interrupted()) return hold();
    show(false);
    std::this_thread::sleep_for(milliseconds(options_.poll_ms));
    if (!send_window(false)) return false;
  }
  if (status_.state == State::kFault || status_.state == State::kEstop) return stopped_by_fault();
  if (status_.state == State::kIdle && !status_.left_in_cut) return true;
  return settle(
      StreamOutcome::kInterrupted,
      std::string("the blade stopped on its way out, the controller is ") + protocol::name(status_.state));
}

bool Streamer::finish() {
  if (!complete()) {
    return settle(StreamOutcome::kFault, "DONE with other waypoints than planned (" +
                                             std::to_string(status_.executed) + " of " +
                                             std::to_string(job_.size()) + ")");
  }
  const protocol::Status done = status_;
  if (!command(Op::kClose)) return false;
  // A controller restarted after it had closed the job does not remember the command, but the job.
  const bool closed = status_.state == State::kIdle && status_.job_id == job_.id && status_.run == run_ &&
                      status_.executed == job_.size();
  if (status_.last_result != Result::kOk && !closed) {
    settle(StreamOutcome::kRefused, std::string(protocol::name(status_.last_result)) + ": CLOSE refused");
  }
  status_ = done;
  return true;
}

void Streamer::show(bool force) {
  if (!options_.progress) return;
  const auto now = Clock::now();
  if (!force && now - shown_ < kProgressEvery) return;
  shown_ = now;
  const std::uint32_t executed = open_ ? std::min(status_.executed, job_.size()) : 0;
  const double end = protocol::time_us(job_.raw.back());
  const double at = executed > 0 ? protocol::time_us(job_.raw[executed - 1]) : 0.0;
  options_.progress(
      {status_.state, status_.fault, status_.accepted, executed, job_.size(), (end - at) * 1e-6,
       report_.reconnects,
       lost_since_ ? std::max(std::chrono::duration<double>(now - *lost_since_).count(), 1e-3) : 0});
}

}  // namespace

StreamReport stream(const Job& job, const StreamOptions& options) {
  return Streamer(job, options).run();
}

StreamReport withdraw(const Job& job, const StreamOptions& options) {
  StreamOptions resumed = options;
  resumed.resume = true;
  return Streamer(job, resumed).withdraw();
}

}  // namespace hotblade::robot
