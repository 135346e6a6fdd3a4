// The controller protocol's encoding, version 1 (docs/controller-protocol.md): the only place that knows how
// registers are laid out. Pure functions on register values; big-endian words are the transport's business.
//
// Most significant word first, zero-based addresses, one map for functions 03 and 04. Positions in um, times
// in us, quaternion components times 2^29, all converted here and nowhere else.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "robot/blade/blade.hpp"
#include "robot/pose/limits.hpp"
#include "robot/pose/waypoint.hpp"

namespace hotblade::robot::protocol {

inline constexpr std::uint16_t kIdentBase = 0x0000, kIdentSize = 64;
inline constexpr std::uint16_t kStatusBase = 0x0040, kStatusSize = 40;
inline constexpr std::uint16_t kCommandBase = 0x0100, kCommandSize = 25;
inline constexpr std::uint16_t kEstopBase = 0x0140;
inline constexpr std::uint16_t kScratchBase = 0x0180, kScratchSize = 16;
inline constexpr std::uint16_t kWindowBase = 0x0200;
inline constexpr std::uint16_t kArmsBase = 0x0300, kArmsSize = 32;

inline constexpr std::uint16_t kMagic = 0x4842;  // "HB"
inline constexpr std::uint16_t kVersion = 1;
inline constexpr std::uint16_t kUnitCodes = 1;  // um, us, urad, quaternion components times 2^29
inline constexpr std::size_t kRegistersPerWaypoint = 26;
inline constexpr std::size_t kWaypointBytes = 2 * kRegistersPerWaypoint;
inline constexpr std::size_t kMaxWaypointsPerWindow = 4;
inline constexpr std::size_t kWindowHeader = 6, kWindowTrailer = 2;
inline constexpr std::size_t kMaxWindowSize =
    kWindowHeader + kMaxWaypointsPerWindow * kRegistersPerWaypoint + kWindowTrailer;
static_assert(kMaxWindowSize <= 121, "a window has to fit the write part of function 23");

// The bits of IDENT's capabilities say what a controller does.
inline constexpr std::uint16_t kCapWriteRead = 1;    // function 23 on WINDOW and COMMAND
inline constexpr std::uint16_t kCapJournal = 2;      // executed survives a restart of the controller
inline constexpr std::uint16_t kCapEquilibrium = 4;  // the blade's equilibrium is checked
inline constexpr std::uint16_t kCapSimulator = 8;    // nothing moves
inline constexpr std::uint16_t kCapBlockCrc = 16;    // IDENT and STATUS end with a CRC-32
inline constexpr std::uint16_t kCapArms = 32;        // ARMS, and the arms of both clamps are checked

// What a command asks for.
enum class Op : std::uint16_t {
  kOpen = 1,
  kStart,
  kHold,
  kResume,
  kAbort,
  kReset,
  kClose,
  kWithdraw,  // back along the path already cut, cold, to its first waypoint; the job ends there
  kRelease,   // the operator has freed the blade of a lost job by hand
};
// What the controller is doing.
enum class State : std::uint16_t { kIdle, kOpen, kRunning, kHeld, kDone, kFault, kEstop };
// What became of the last command or window.
enum class Result : std::uint16_t {
  kOk,
  kGap,
  kDup,
  kConflict,
  kFull,
  kBadToken,
  kBadCrc,
  kLimit,
  kState,
  kBusy
};
// Why the controller stopped by itself, with the state it stopped in.
enum class Fault : std::uint16_t {
  kNone = 0,
  kUnderrun = 1,        // HELD: the buffer ran out before the last waypoint
  kConflict = 2,        // FAULT: an accepted waypoint was sent again with other contents
  kExecutionLimit = 3,  // FAULT: a waypoint broke a limit when it was about to be executed
  kAborted = 4,         // FAULT: ABORT
  kLog = 5,             // FAULT: the execution log could not be written
  kWatchdog = 6,        // HELD: the owner fell silent
  kRestart = 7,         // HELD: the controller was restarted and went on from its journal
  kFollowing = 8,       // FAULT: the clamps do not follow
  kDrive = 9,           // FAULT: a drive reports a fault
};
// What the clamps do while RUNNING.
enum class Phase : std::uint16_t {
  kProgram,  // along the program
  kRetract,  // backwards out of the kerf, cold
  kReheat,   // standing where the program heats the blade
  kReenter,  // forwards again to where it was held
};

// Return the documented name, such as "RUNNING" or "CONFLICT"; "unknown" for a number outside the table.
[[nodiscard]] const char* name(Op op);
[[nodiscard]] const char* name(State state);
[[nodiscard]] const char* name(Result result);
[[nodiscard]] const char* name(Fault fault);
[[nodiscard]] const char* name(Phase phase);

// Returns the CRC-32 of IEEE 802.3, continued from `crc`; it is 0xCBF43926 for "123456789".
[[nodiscard]] std::uint32_t crc32(std::span<const std::uint8_t> bytes, std::uint32_t crc = 0);
// Returns the CRC-32 of registers, high byte first.
[[nodiscard]] std::uint32_t crc32_registers(std::span<const std::uint16_t> registers);

// A waypoint as it stands in a window and in the execution log: 26 registers, high byte first.
using RawWaypoint = std::array<std::uint8_t, kWaypointBytes>;

// Returns when the waypoint is due, us from the strip's start.
[[nodiscard]] inline std::uint32_t time_us(const RawWaypoint& raw) {
  return static_cast<std::uint32_t>(raw[0]) << 24 | static_cast<std::uint32_t>(raw[1]) << 16 |
         static_cast<std::uint32_t>(raw[2]) << 8 | raw[3];
}

// Returns whether the blade is heated from this waypoint to the next.
[[nodiscard]] inline bool is_hot(const RawWaypoint& raw) {
  constexpr std::size_t kHeatByte = 20;  // the second word of clamp A's quaternion
  return (raw[kHeatByte] & 0x40) != 0;
}

// Returns nullopt for a waypoint that cannot be expressed: a position beyond +-2^31 um, a number that is not
// finite, a quaternion whose length is off 1 by more than 1e-6 (rounding of a unit quaternion in a text file
// stays far below that).
[[nodiscard]] std::optional<RawWaypoint> encode_waypoint(const Waypoint& waypoint);

// Returns the clamps as a controller reads them that is told these: in whole micrometres and the quaternion's
// counts. Returns nullopt for clamps that cannot be expressed.
[[nodiscard]] std::optional<ClampPoses> as_read(const ClampPoses& told);

// What 26 registers hold.
struct DecodedWaypoint {
  Waypoint waypoint;
  Limit error = Limit::kNone;  // kQuaternion or kHeat: the registers hold no waypoint
};
[[nodiscard]] DecodedWaypoint decode_waypoint(std::span<const std::uint8_t, kWaypointBytes> raw);

// The IDENT block: what a controller is and what it allows.
struct Ident {
  std::uint16_t magic = kMagic, version = kVersion, capabilities = 0;
  std::uint16_t registers_per_waypoint = kRegistersPerWaypoint, fifo_size = 0;
  std::uint16_t max_waypoints_per_write = kMaxWaypointsPerWindow, unit_codes = kUnitCodes;
  std::uint32_t boot_id = 0;
  MotionLimits limits;
  std::uint32_t watchdog_ms = 0, lease_ms = 0, max_waypoints = 0;
  double blade_length_mm = 0;  // of the open job; 0 without one
};
[[nodiscard]] std::array<std::uint16_t, kIdentSize> encode_ident(const Ident& ident);
[[nodiscard]] Ident decode_ident(std::span<const std::uint16_t, kIdentSize> registers);

// What a limit of the arms speaks of, besides its code: `arm` 1 or 2, in the cell's order, `part` its joint,
// or its link of which 7 is the tool. Near singular the part is 5, 3 or 1: wrist, elbow or shoulder. Without
// an arm the part is clamp 1 or 2, or an ArmsOther: blade, block or plinth. `other` is what it comes too near
// to, `other_part` that one's link; of a clamp's jerk `other` says 1 where it is that of its turn.
enum class ArmsOther : std::uint8_t {
  kNothing,
  kOtherArm,
  kItself,
  kBlade,
  kTable,
  kObstacle,
  kBlock,
  kPlinth
};
struct ArmsDetail {
  std::uint8_t arm = 0, part = 0;
  ArmsOther other = ArmsOther::kNothing;
  std::uint8_t other_part = 0;
  // By how much the limit is broken, in millionths of rad, rad/s, rad/s^2 or rad/s^3, and thousandths of mm
  // or mm/s^3; at most what the register holds.
  std::int32_t amount = 0;
  bool operator==(const ArmsDetail&) const = default;
};
// Returns the part of an arm, by what a refusal of the code says of it: "arm 1 joint 5", "arm 2 tool and the
// table". Arms have the names given, where there are names. Nothing is said of a detail that is empty.
[[nodiscard]] std::string describe(const ArmsDetail& detail, Limit limit,
                                   const std::array<std::string, 2>& arm_names);

// The STATUS block: one consistent look at the controller.
struct Status {
  State state = State::kIdle;
  Fault fault = Fault::kNone;
  std::uint16_t fault_detail = 0;    // the code of a Limit, of the fault, or of the last LIMIT result
  std::uint32_t fault_sequence = 0;  // the waypoint it speaks of
  std::uint64_t job_id = 0;
  std::uint32_t run = 0, token = 0, accepted = 0, executed = 0;
  std::uint16_t free = 0;
  Result last_result = Result::kOk;
  std::uint32_t last_nonce = 0;
  std::uint32_t accepted_crc = 0, executed_crc = 0;
  std::uint16_t watchdog_ms = 0;  // left until the watchdog expires
  std::uint64_t time_us = 0;      // controller time since boot
  Phase phase = Phase::kProgram;
  std::uint32_t following_um = 0;  // how far the clamps are behind what is asked of them, the worse of both
  bool left_in_cut = false;        // the blade stands where a job that was lost to RESET has it hot
  ArmsDetail arms;                 // of fault_detail, where that is a limit of the arms
};
[[nodiscard]] std::array<std::uint16_t, kStatusSize> encode_status(const Status& status);
[[nodiscard]] Status decode_status(std::span<const std::uint16_t, kStatusSize> registers);

// On the wire IDENT and STATUS end with a CRC-32 of the registers before it: TCP's own sum of 16 bits lets
// some errors through.
void seal_block(std::span<std::uint16_t> block);
[[nodiscard]] bool block_intact(std::span<const std::uint16_t> block);
// Returns whether an IDENT may be believed: its CRC holds, or it says that it has none, and both registers
// are 0.
[[nodiscard]] bool ident_intact(std::span<const std::uint16_t, kIdentSize> block);

// The blade of OPEN in whole um and MPa, in the order of its registers; logs write each under its name.
inline constexpr std::array kBladeWordNames{"length_um", "width_um", "thickness_um", "youngs_modulus_mpa",
                                            "yield_strength_mpa"};
using BladeWords = std::array<std::uint32_t, kBladeWordNames.size()>;
// Returns nullopt for a number that is negative, not finite or above 2^32 - 1 um or MPa.
[[nodiscard]] std::optional<BladeWords> encode_blade(const ClampedBlade& blade);
[[nodiscard]] ClampedBlade decode_blade(const BladeWords& words);

// The COMMAND block.
struct Command {
  std::uint32_t nonce = 0;
  Op op = Op::kHold;
  std::uint64_t job_id = 0;
  std::uint32_t run = 0, token = 0;
  std::uint32_t waypoint_count = 0;  // OPEN only, as blade
  ClampedBlade blade;
};
// Throws std::logic_error for a blade that encode_blade does not take.
[[nodiscard]] std::array<std::uint16_t, kCommandSize> encode_command(const Command& command);

// A command, and whether its CRC holds.
struct DecodedCommand {
  Command command;
  bool crc_ok = false;
};
[[nodiscard]] DecodedCommand decode_command(std::span<const std::uint16_t, kCommandSize> registers);

// The ARMS block: which cell a job was planned for, and the joints that hold clamp A and clamp B at waypoint
// 0.
inline constexpr std::size_t kArmJoints = 6;
struct Arms {
  std::uint32_t token = 0;
  std::uint64_t cell_id = 0;  // the first 64 bits of the cell's SHA-256
  std::array<std::array<double, kArmJoints>, 2> joints_rad{};
};
// Throws std::logic_error for a joint beyond +-2^31 urad.
[[nodiscard]] std::array<std::uint16_t, kArmsSize> encode_arms(const Arms& arms);
struct DecodedArms {
  Arms arms;
  bool crc_ok = false;
};
[[nodiscard]] DecodedArms decode_arms(std::span<const std::uint16_t, kArmsSize> registers);

inline constexpr std::uint16_t kFlagLast = 1;  // the window ends with the strip's last waypoint

// A WINDOW block as it is written: the first `size` registers.
struct WindowRegisters {
  std::array<std::uint16_t, kMaxWindowSize> registers{};
  std::size_t size = 0;
  [[nodiscard]] std::span<const std::uint16_t> span() const { return {registers.data(), size}; }
};
// Returns a window of raw.size() <= 4 waypoints; none at all is the owner's sign of life. Throws
// std::logic_error above 4.
[[nodiscard]] WindowRegisters encode_window(std::uint32_t token, std::uint32_t first_sequence, bool last,
                                            std::span<const RawWaypoint> raw);

// A WINDOW block as it is read.
struct Window {
  std::uint32_t token = 0, first_sequence = 0;
  std::uint16_t count = 0;
  bool last = false;
  bool crc_ok = false;
  std::array<RawWaypoint, kMaxWaypointsPerWindow> raw{};
  bool known_flags = true;  // no other flag is set than those that are defined
};
// Returns nullopt when the number of registers is not the one the window's own count asks for.
[[nodiscard]] std::optional<Window> decode_window(std::span<const std::uint16_t> registers);

}  // namespace hotblade::robot::protocol
