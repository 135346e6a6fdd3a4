// The controller's behaviour: commands, windows, acceptance, motion, ownership (docs/controller-protocol.md).
//
// A pure state machine. It is told the time (us since boot, never going back), knows no sockets, and reports
// what it executed to a sink. One thread at a time.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "robot/blade/blade_check.hpp"
#include "robot/controller/arm_check.hpp"
#include "robot/controller/controller_journal.hpp"
#include "robot/controller/execution_sink.hpp"
#include "robot/controller/simulated_faults.hpp"
#include "robot/pose/limits.hpp"
#include "robot/pose/motion.hpp"
#include "robot/wire/job.hpp"
#include "robot/wire/protocol.hpp"

namespace hotblade::robot {

// Speed of the motion clock that executes whatever has been accepted and then waits for more.
inline constexpr double kAsFastAsDataComes = std::numeric_limits<double>::infinity();

// What a controller is, allows and waits for; the simulator's defaults.
struct ControllerOptions {
  MotionLimits limits;
  std::uint32_t boot_id = 1;
  std::uint16_t capabilities = protocol::kCapWriteRead | protocol::kCapSimulator | protocol::kCapBlockCrc;
  std::uint16_t fifo_size = 1024;         // 51 s of waypoints 50 ms apart
  std::uint32_t max_waypoints = 1000000;  // 71 minutes at 5 ms are 859 thousand
  std::uint32_t watchdog_ms = 2000;       // silence of the owner until the motion is slowed down
  std::uint32_t lease_ms = 5000;          // silence of the owner until somebody else may take over
  std::uint32_t heat_dwell_ms = 2000;     // HELD with a hot blade until the heat goes off
  std::uint32_t reheat_ms = 2000;         // of the motion clock: a cold blade until it cuts again
  double following_mm = 2;                // clamps farther behind what is asked of them are a fault
  SimulatedFaults faults;
  double time_scale = 1;    // of the motion clock only; watchdog and lease stay in wall time
  BladeCheckOptions blade;  // IDENT's capabilities say whether the equilibrium is checked
  // The arms that hold the clamps, which jobs have to declare then; null: they are not known.
  std::shared_ptr<const ArmCell> arms = nullptr;
};

// Takes commands and windows, and executes what it accepted as time moves on.
class Controller {
 public:
  // The server's number of the connection that speaks.
  using Connection = std::uint64_t;
  static constexpr Connection kNobody = 0;

  // `sink` may be null and must outlive the controller.
  explicit Controller(const ControllerOptions& options, ExecutionSink* sink = nullptr);

  // Goes on where a journal ends, once, before anything else: an open job is HELD with a cold blade and
  // accepted = executed; DONE, FAULT and a latched ESTOP stay what they were. Throws LogError when the
  // journal's waypoints break these limits.
  void restore(const ControllerJournal& journal);

  // Return the blocks as they are now, without their CRC.
  [[nodiscard]] protocol::Ident ident() const;
  [[nodiscard]] protocol::Status status() const;
  [[nodiscard]] const ControllerOptions& options() const { return options_; }
  // Returns the connection that last showed the token.
  [[nodiscard]] Connection owner() const { return loaded_ ? owner_ : kNobody; }

  // Carry out a block that a connection wrote, and return what became of it.
  protocol::Result command(const protocol::DecodedCommand& decoded, Connection from, std::uint64_t now_us);
  protocol::Result window(const protocol::Window& window, Connection from, std::uint64_t now_us);
  protocol::Result arms(const protocol::DecodedArms& decoded, Connection from, std::uint64_t now_us);
  // Stops at once and latches; anybody may ask for it.
  void estop(std::uint64_t now_us);
  // Takes note of any frame of a connection: the owner's keep the lease and the watchdog fed.
  void heard(Connection from, std::uint64_t now_us);
  // Returns whether the controller restarts, as options().faults told it to: it does nothing any more, and a
  // new one should go on from the journal.
  [[nodiscard]] bool reboot_due() const { return reboot_due_; }
  // Moves time on.
  void tick(std::uint64_t now_us);
  // Makes the log durable and publishes `executed`; to be called after a turn of work.
  void commit();
  // Commits where the state has changed since the last time: to be called before anybody is answered, so that
  // a restart knows whatever was said. What the change stops stands by then, or brakes.
  void record_changes();
  // Returns whether so little room is left that a commit is worth its time at once: `free` counts what is
  // published.
  [[nodiscard]] bool commit_due() const {
    return job_.executed - published_executed_ > options_.fifo_size / 2u;
  }

 private:
  enum class StopReason { kNone, kHold, kWatchdog, kUnderrun, kFault };

  // The job that is open, as far as it got.
  struct Loaded {
    std::uint64_t id = 0;
    std::uint32_t run = 0, count = 0;
    ClampedBlade blade;
    std::vector<protocol::RawWaypoint> raw;  // everything accepted; room for `count` reserved
    std::uint32_t accepted_crc = 0;
    LimitChecker acceptance;  // of the stream as accepted; `execution` follows the motion
    std::uint32_t executed = 0, executed_crc = 0;
    LimitChecker execution;
    BladeCheck accepted_blade, moved_blade;  // along the accepted stream; along the motion itself
    std::optional<protocol::Arms> arms;      // as declared
    ArmCheck accepted_arms, moved_arms;
    [[nodiscard]] std::uint32_t accepted() const { return static_cast<std::uint32_t>(raw.size()); }
  };

  [[nodiscard]] bool lease_alive() const;
  [[nodiscard]] bool owns(std::uint32_t token) const { return loaded_ && token == token_; }
  void feed(Connection from);
  void latch_estop();
  void move_to(std::uint64_t now_us);

  protocol::Result dispatch(const protocol::Command& c, Connection from);
  protocol::Result open(const protocol::Command& c, Connection from);
  protocol::Result open_new(const protocol::Command& c);
  void load(std::uint64_t job, std::uint32_t run, std::uint32_t count, const ClampedBlade& blade);
  void give_token(const char* why);
  protocol::Result act(const protocol::Command& c);
  protocol::Result start();
  protocol::Result hold();
  protocol::Result resume();
  protocol::Result abort();
  protocol::Result reset();
  protocol::Result close();
  protocol::Result withdraw();
  protocol::Result release();
  protocol::Result take_up_again();
  [[nodiscard]] bool in_cut() const;
  void end_withdrawal();

  protocol::Result judge(const protocol::Window& window, Connection from);
  protocol::Result append(const protocol::Window& window, std::uint32_t already);
  protocol::Result limit(const Breach& breach, std::uint32_t sequence);
  void clear_fault();

  // The arms that a job declares (controller_arms.cpp).
  protocol::Result judge_arms(const protocol::DecodedArms& decoded, Connection from);
  protocol::Result take_arms(const protocol::Arms& declared);
  [[nodiscard]] bool arms_unknown();

  void run_motion(double motion_s);
  void run_dry();
  [[nodiscard]] double step_length(double budget_s) const;
  [[nodiscard]] bool moving() const;
  [[nodiscard]] double data_end_s() const;
  [[nodiscard]] bool data_ends_at(double braking_s) const;
  void settle();
  void execute_due();
  void execute_next();
  void sample_due_poses();
  Breach write_pose();
  [[nodiscard]] double to_next_waypoint_s() const;
  [[nodiscard]] static ClampPoses pose_on(const Waypoint& from, const Waypoint& to, double path_s);
  [[nodiscard]] double to_next_pose_s() const;
  void come_to_rest();
  void fail(protocol::Fault fault, const Breach& breach, std::uint32_t sequence);
  void stop(StopReason reason);
  void cool_when_due();

  // What a simulated machine does wrong (simulated_faults.cpp).
  void fail_as_told(std::uint32_t executed);
  void estop_as_told();
  [[nodiscard]] bool stalled() const;
  void ask_in_vain(double& budget_s);
  void fall_behind(double motion_s, double path_s);
  [[nodiscard]] double following_mm() const;

  // Out of the kerf and back (controller_reentry.cpp).
  void go_on_from_held();
  void begin_retract();
  void brake_for_boundary();
  void step_back();
  void begin_reheat();
  void spend_reheating(double& budget_s);
  [[nodiscard]] double to_boundary_s() const;
  void load_step(std::uint32_t index);
  void replay(const ControllerJournal& journal);
  [[nodiscard]] bool agrees_with_held_pose(const Waypoint& from, const Waypoint& to) const;
  void report(const char* what);
  bool on_record(const char* what);
  bool record();
  [[nodiscard]] std::uint64_t motion_us() const;

  ControllerOptions options_;
  ExecutionSink* sink_;
  std::uint64_t now_us_ = 0;

  protocol::State state_ = protocol::State::kIdle;
  protocol::Fault fault_ = protocol::Fault::kNone;
  std::uint16_t fault_detail_ = 0;
  std::uint32_t fault_sequence_ = 0;
  protocol::ArmsDetail fault_arms_;

  bool loaded_ = false;
  Loaded job_;
  ArmCheck trial_arms_;  // of a window; kept, so that a copy finds its room
  Chain chain_{0};
  std::uint32_t published_executed_ = 0, published_crc_ = 0;
  bool uncommitted_ = false, changed_ = false;  // lines of the log; among them changes of state

  std::uint32_t token_ = 0;
  Connection owner_ = kNobody, newest_ = kNobody;  // of those that showed the token: the last, the youngest
  std::uint64_t lease_until_us_ = 0, watchdog_at_us_ = 0;

  protocol::Result last_result_ = protocol::Result::kOk;
  bool any_command_ = false;
  protocol::Command last_command_;
  protocol::Result last_command_result_ = protocol::Result::kOk;

  PathClock path_;
  StopReason stop_reason_ = StopReason::kNone;
  double motion_s_ = 0;              // the motion clock, s from START
  std::uint64_t poses_written_ = 0;  // every 10 ms of it
  std::uint32_t step_ = 0;           // the step under way begins at this waypoint
  Waypoint from_, to_;               // and goes from here to there; both the same while its end is unknown
  protocol::Phase phase_ = protocol::Phase::kProgram;
  std::uint32_t boundary_ = 0;      // where the heat came on: the end of a retraction
  double reheated_at_s_ = 0;        // of the motion clock
  std::optional<ClampPoses> held_;  // after a restart, until the path is known to lead through it
  double lag_s_ = 0;                // how far the place asked for is ahead of the clamps, of the path's time
  bool heat_off_ = false, reboot_due_ = false;
  bool left_in_cut_ = false;  // by a job that was lost to RESET; it is still in job_
  bool withdrawing_ = false;  // RUNNING backwards to the first waypoint, where the job ends
  std::uint64_t held_since_us_ = 0;
};

}  // namespace hotblade::robot
