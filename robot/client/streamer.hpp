// One job on its way to a controller: client.hpp's stream() and withdraw(), in two files. client.cpp has the
// link and the job's opening, stream_motion.cpp what moves.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <random>
#include <span>
#include <string>

#include "robot/client/client.hpp"
#include "robot/client/fault_text.hpp"
#include "robot/wire/modbus_link.hpp"

namespace hotblade::robot {

inline constexpr int kMaxFruitless = 100;  // answers without progress, one after the other

// Steps return false when the outcome is settled.
class Streamer {
  using Clock = std::chrono::steady_clock;
  using Op = protocol::Op;

 public:
  Streamer(const Job& job, const StreamOptions& options)
      : job_(job),
        options_(options),
        link_(options.host, options.port, options.response_ms),
        nonce_(std::random_device{}()) {}

  StreamReport run() {
    const bool done = connect() && identify() && refresh() &&
                      (cut_to_the_end() || (choose_run() && open() && go() && finish()));
    if (!done) give_back();
    return report_of(done);
  }

  StreamReport withdraw() {
    return report_of(connect() && identify() && refresh() && choose_run() && open() && draw_back());
  }

 private:
  StreamReport report_of([[maybe_unused]] bool done) {
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
  void take(std::span<const std::uint16_t, protocol::kStatusSize> block);
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
  void give_back();
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

}  // namespace hotblade::robot
