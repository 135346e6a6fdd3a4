#include "robot/wire/protocol.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace hotblade::robot::protocol {
namespace {

constexpr double kQuaternionScale = 536870912.0;  // 2^29
constexpr double kMicro = 1e6, kMilli = 1e3;
constexpr std::uint32_t kLow30 = 0x3FFFFFFF;
constexpr std::uint32_t kHeatBit = 1u << 30;

constexpr std::array<std::uint32_t, 256> make_crc_table() {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t i = 0; i < 256; ++i) {
    std::uint32_t c = i;
    for (int bit = 0; bit < 8; ++bit) c = (c & 1) ? 0xEDB88320u ^ (c >> 1) : c >> 1;
    table[i] = c;
  }
  return table;
}
constexpr auto kCrcTable = make_crc_table();

// kCrcTables[k][b]: what byte b does with k bytes of zero after it, so that eight bytes are taken in at once.
constexpr std::array<std::array<std::uint32_t, 256>, 8> make_crc_tables() {
  std::array<std::array<std::uint32_t, 256>, 8> tables{};
  tables[0] = kCrcTable;
  for (std::size_t k = 1; k < 8; ++k) {
    for (std::size_t i = 0; i < 256; ++i)
      tables[k][i] = (tables[k - 1][i] >> 8) ^ kCrcTable[tables[k - 1][i] & 0xFF];
  }
  return tables;
}
constexpr auto kCrcTables = make_crc_tables();

// Writes values one after the other, most significant word first.
class Writer {
 public:
  explicit Writer(std::span<std::uint16_t> out) : out_(out) {}
  void u16(std::uint32_t v) { out_[at_++] = static_cast<std::uint16_t>(v); }
  void u32(std::uint32_t v) {
    u16(v >> 16);
    u16(v & 0xFFFF);
  }
  void u64(std::uint64_t v) {
    u32(static_cast<std::uint32_t>(v >> 32));
    u32(static_cast<std::uint32_t>(v));
  }
  // value * scale, rounded; out of range is a mistake in the configuration, held at the border.
  void scaled(double value, double scale) {
    const double clamped = std::clamp(std::round(value * scale), -2147483648.0, 4294967295.0);
    u32(static_cast<std::uint32_t>(static_cast<std::int64_t>(clamped)));
  }
  [[nodiscard]] std::span<const std::uint16_t> written() const { return out_.first(at_); }

 private:
  std::span<std::uint16_t> out_;
  std::size_t at_ = 0;
};

class Reader {
 public:
  explicit Reader(std::span<const std::uint16_t> in) : in_(in) {}
  std::uint16_t u16() { return in_[at_++]; }
  std::uint32_t u32() {
    const std::uint32_t high = u16();
    return high << 16 | u16();
  }
  std::uint64_t u64() {
    const std::uint64_t high = u32();
    return high << 32 | u32();
  }
  double scaled(double scale) { return u32() / scale; }
  double scaled_signed(double scale) { return static_cast<std::int32_t>(u32()) / scale; }
  [[nodiscard]] std::span<const std::uint16_t> consumed() const { return in_.first(at_); }

 private:
  std::span<const std::uint16_t> in_;
  std::size_t at_ = 0;
};

void put_u32(std::uint8_t* out, std::uint32_t v) {
  for (int i = 0; i < 4; ++i) out[i] = static_cast<std::uint8_t>(v >> (24 - 8 * i));
}

std::uint32_t get_u32(const std::uint8_t* in) {
  return static_cast<std::uint32_t>(in[0]) << 24 | static_cast<std::uint32_t>(in[1]) << 16 |
         static_cast<std::uint32_t>(in[2]) << 8 | in[3];
}

std::array<double, 4> components(const Eigen::Quaterniond& q) {
  return {q.w(), q.x(), q.y(), q.z()};
}

bool encode_position(const Eigen::Vector3d& p_mm, std::uint8_t* out) {
  for (int i = 0; i < 3; ++i) {
    const double um = std::round(p_mm[i] * kMilli);
    if (!(std::abs(um) <= std::numeric_limits<std::int32_t>::max())) return false;
    put_u32(out + 4 * i, static_cast<std::uint32_t>(static_cast<std::int32_t>(um)));
  }
  return true;
}

bool encode_quaternion(const Eigen::Quaterniond& q, bool heat, std::uint8_t* out) {
  constexpr double kUnitSlack = 1e-6;  // said in the header
  if (!(std::abs(q.norm() - 1) <= kUnitSlack)) return false;
  const auto c = components(canonical(q.normalized()));
  const auto largest = static_cast<std::uint32_t>(
      std::max_element(c.begin(), c.end(), [](double a, double b) { return std::abs(a) < std::abs(b); }) -
      c.begin());
  int field = 0;
  for (std::uint32_t i = 0; i < 4; ++i) {
    if (i == largest) continue;
    const auto fixed = static_cast<std::int32_t>(std::round(c[i] * kQuaternionScale));
    std::uint32_t word = static_cast<std::uint32_t>(fixed) & kLow30;
    if (field == 0) word |= largest << 30;
    if (field == 1 && heat) word |= kHeatBit;
    put_u32(out + 4 * field++, word);
  }
  return true;
}

Eigen::Vector3d decode_position(const std::uint8_t* in) {
  Eigen::Vector3d p;
  for (int i = 0; i < 3; ++i) p[i] = static_cast<std::int32_t>(get_u32(in + 4 * i)) / kMilli;
  return p;
}

struct DecodedQuaternion {
  Eigen::Quaterniond q{1, 0, 0, 0};
  bool heat = false, ok = false;
};

DecodedQuaternion decode_quaternion(const std::uint8_t* in) {
  DecodedQuaternion result;
  std::array<double, 4> c{};
  const std::uint32_t largest = get_u32(in) >> 30;
  double sum = 0, widest = 0;
  int field = 0;
  for (std::uint32_t i = 0; i < 4; ++i) {
    if (i == largest) continue;
    const std::uint32_t word = get_u32(in + 4 * field);
    const std::uint32_t top = word >> 30;
    if ((field == 1 && top > 1) || (field == 2 && top != 0)) return result;
    if (field == 1) result.heat = top == 1;
    // Sign extension of 30 bits.
    const auto fixed = static_cast<std::int32_t>((word & kLow30) << 2) >> 2;
    c[i] = fixed * (1 / kQuaternionScale);  // a power of two: exact
    sum += c[i] * c[i];
    widest = std::max(widest, std::abs(c[i]));
    ++field;
  }
  if (sum > 1) return result;
  c[largest] = std::sqrt(1 - sum);
  // The left-out component is the largest but for the rounding of the three others, 2^-30 each, which it
  // takes up three times at most where all four are alike; 2^-27 is above that sum.
  constexpr double kRounding = 1.0 / 134217728.0;
  result.ok = c[largest] >= widest - kRounding;
  result.q = Eigen::Quaterniond(c[0], c[1], c[2], c[3]);
  return result;
}

}  // namespace

const char* name(Op op) {
  constexpr std::array kNames{"OPEN",  "START", "HOLD",     "RESUME", "ABORT",
                              "RESET", "CLOSE", "WITHDRAW", "RELEASE"};
  const auto i = static_cast<std::size_t>(op);
  return i >= 1 && i <= kNames.size() ? kNames[i - 1] : "unknown";
}

const char* name(State state) {
  constexpr std::array kNames{"IDLE", "OPEN", "RUNNING", "HELD", "DONE", "FAULT", "ESTOP"};
  const auto i = static_cast<std::size_t>(state);
  return i < kNames.size() ? kNames[i] : "unknown";
}

const char* name(Result result) {
  constexpr std::array kNames{"OK",       "GAP",    "DUP",   "CONFLICT", "FULL",
                              "BADTOKEN", "BADCRC", "LIMIT", "STATE",    "BUSY"};
  const auto i = static_cast<std::size_t>(result);
  return i < kNames.size() ? kNames[i] : "unknown";
}

const char* name(Fault fault) {
  constexpr std::array kNames{"none", "UNDERRUN", "CONFLICT", "EXECUTION_LIMIT", "ABORTED",
                              "LOG",  "WATCHDOG", "RESTART",  "FOLLOWING",       "DRIVE"};
  const auto i = static_cast<std::size_t>(fault);
  return i < kNames.size() ? kNames[i] : "unknown";
}

const char* name(Phase phase) {
  constexpr std::array kNames{"program", "retract", "reheat", "reenter"};
  const auto i = static_cast<std::size_t>(phase);
  return i < kNames.size() ? kNames[i] : "unknown";
}

std::uint32_t crc32(std::span<const std::uint8_t> bytes, std::uint32_t crc) {
  crc = ~crc;
  while (bytes.size() >= 8) {
    const std::uint32_t low =
        crc ^ (static_cast<std::uint32_t>(bytes[3]) << 24 | static_cast<std::uint32_t>(bytes[2]) << 16 |
               static_cast<std::uint32_t>(bytes[1]) << 8 | bytes[0]);
    crc = kCrcTables[7][low & 0xFF] ^ kCrcTables[6][low >> 8 & 0xFF] ^ kCrcTables[5][low >> 16 & 0xFF] ^
          kCrcTables[4][low >> 24] ^ kCrcTables[3][bytes[4]] ^ kCrcTables[2][bytes[5]] ^
          kCrcTables[1][bytes[6]] ^ kCrcTables[0][bytes[7]];
    bytes = bytes.subspan(8);
  }
  for (const std::uint8_t byte : bytes) crc = kCrcTable[(crc ^ byte) & 0xFF] ^ (crc >> 8);
  return ~crc;
}

std::uint32_t crc32_registers(std::span<const std::uint16_t> registers) {
  constexpr std::size_t kAtOnce = 128;  // a block is no longer
  std::array<std::uint8_t, 2 * kAtOnce> bytes{};
  std::uint32_t crc = 0;
  while (!registers.empty()) {
    const std::size_t n = std::min(registers.size(), kAtOnce);
    for (std::size_t i = 0; i < n; ++i) {
      bytes[2 * i] = static_cast<std::uint8_t>(registers[i] >> 8);
      bytes[2 * i + 1] = static_cast<std::uint8_t>(registers[i]);
    }
    crc = crc32(std::span<const std::uint8_t>(bytes).first(2 * n), crc);
    registers = registers.subspan(n);
  }
  return crc;
}

std::optional<RawWaypoint> encode_waypoint(const Waypoint& waypoint) {
  RawWaypoint raw{};
  put_u32(raw.data(), waypoint.t_us);
  if (!encode_position(waypoint.a.p, raw.data() + 4) ||
      !encode_quaternion(waypoint.a.q, waypoint.heat, raw.data() + 16) ||
      !encode_position(waypoint.b.p, raw.data() + 28) ||
      !encode_quaternion(waypoint.b.q, waypoint.heat, raw.data() + 40)) {
    return std::nullopt;
  }
  return raw;
}

DecodedWaypoint decode_waypoint(std::span<const std::uint8_t, kWaypointBytes> raw) {
  DecodedWaypoint result;
  const auto a = decode_quaternion(raw.data() + 16);
  const auto b = decode_quaternion(raw.data() + 40);
  if (!a.ok || !b.ok) {
    result.error = Limit::kQuaternion;
  } else if (a.heat != b.heat) {
    result.error = Limit::kHeat;
  }
  result.waypoint = {get_u32(raw.data()),
                     a.heat,
                     {decode_position(raw.data() + 4), a.q},
                     {decode_position(raw.data() + 28), b.q}};
  return result;
}

std::optional<ClampPoses> as_read(const ClampPoses& told) {
  const auto raw = encode_waypoint({0, false, told.a, told.b});
  if (!raw) return std::nullopt;
  const Waypoint read = decode_waypoint(*raw).waypoint;
  return ClampPoses{read.a, read.b};
}

std::array<std::uint16_t, kIdentSize> encode_ident(const Ident& ident) {
  std::array<std::uint16_t, kIdentSize> registers{};
  Writer w(registers);
  for (const std::uint16_t v : {ident.magic, ident.version, ident.capabilities, ident.registers_per_waypoint,
                                ident.fifo_size, ident.max_waypoints_per_write, ident.unit_codes}) {
    w.u16(v);
  }
  w.u32(ident.boot_id);
  const MotionLimits& l = ident.limits;
  w.scaled(l.speed_mm_s, kMilli);
  w.scaled(l.accel_mm_s2, kMilli);
  w.scaled(l.angular_rad_s, kMicro);
  w.scaled(l.angular_accel_rad_s2, kMicro);
  for (int i = 0; i < 3; ++i) w.scaled(l.envelope_min_mm[i], kMilli);
  for (int i = 0; i < 3; ++i) w.scaled(l.envelope_max_mm[i], kMilli);
  w.u32(l.min_dt_us);
  w.scaled(l.chord_slack, kMicro);
  w.u32(ident.watchdog_ms);
  w.u32(ident.lease_ms);
  w.u32(ident.max_waypoints);
  w.scaled(ident.blade_length_mm, kMilli);
  return registers;
}

Ident decode_ident(std::span<const std::uint16_t, kIdentSize> registers) {
  Reader r(registers);
  Ident ident;
  ident.magic = r.u16();
  ident.version = r.u16();
  ident.capabilities = r.u16();
  ident.registers_per_waypoint = r.u16();
  ident.fifo_size = r.u16();
  ident.max_waypoints_per_write = r.u16();
  ident.unit_codes = r.u16();
  ident.boot_id = r.u32();
  MotionLimits& l = ident.limits;
  l.speed_mm_s = r.scaled(kMilli);
  l.accel_mm_s2 = r.scaled(kMilli);
  l.angular_rad_s = r.scaled(kMicro);
  l.angular_accel_rad_s2 = r.scaled(kMicro);
  for (int i = 0; i < 3; ++i) l.envelope_min_mm[i] = r.scaled_signed(kMilli);
  for (int i = 0; i < 3; ++i) l.envelope_max_mm[i] = r.scaled_signed(kMilli);
  l.min_dt_us = r.u32();
  l.chord_slack = r.scaled(kMicro);
  ident.watchdog_ms = r.u32();
  ident.lease_ms = r.u32();
  ident.max_waypoints = r.u32();
  ident.blade_length_mm = r.scaled(kMilli);
  return ident;
}

std::array<std::uint16_t, kStatusSize> encode_status(const Status& s) {
  std::array<std::uint16_t, kStatusSize> registers{};
  Writer w(registers);
  w.u16(static_cast<std::uint16_t>(s.state));
  w.u16(static_cast<std::uint16_t>(s.fault));
  w.u16(s.fault_detail);
  w.u16(s.fault_sequence & 0xFFFF);
  w.u64(s.job_id);
  w.u32(s.run);
  w.u32(s.token);
  w.u32(s.accepted);
  w.u32(s.executed);
  w.u16(s.free);
  w.u16(static_cast<std::uint16_t>(s.last_result));
  w.u32(s.last_nonce);
  w.u32(s.accepted_crc);
  w.u32(s.executed_crc);
  w.u16(s.watchdog_ms);
  w.u64(s.time_us);
  w.u32(s.fault_sequence);
  w.u16(static_cast<std::uint16_t>(s.phase));
  w.u32(s.following_um);
  w.u16(s.left_in_cut ? 1 : 0);
  w.u16(static_cast<std::uint32_t>(s.arms.arm) << 12 | static_cast<std::uint32_t>(s.arms.part) << 8 |
        static_cast<std::uint32_t>(s.arms.other) << 4 | s.arms.other_part);
  w.u32(static_cast<std::uint32_t>(s.arms.amount));
  return registers;
}

Status decode_status(std::span<const std::uint16_t, kStatusSize> registers) {
  Reader r(registers);
  Status s;
  s.state = static_cast<State>(r.u16());
  s.fault = static_cast<Fault>(r.u16());
  s.fault_detail = r.u16();
  r.u16();  // low half of the fault's sequence number, whole at the end
  s.job_id = r.u64();
  s.run = r.u32();
  s.token = r.u32();
  s.accepted = r.u32();
  s.executed = r.u32();
  s.free = r.u16();
  s.last_result = static_cast<Result>(r.u16());
  s.last_nonce = r.u32();
  s.accepted_crc = r.u32();
  s.executed_crc = r.u32();
  s.watchdog_ms = r.u16();
  s.time_us = r.u64();
  s.fault_sequence = r.u32();
  s.phase = static_cast<Phase>(r.u16());
  s.following_um = r.u32();
  s.left_in_cut = r.u16() != 0;
  const std::uint16_t who = r.u16();
  const auto nibble = [who](int shift) { return static_cast<std::uint8_t>(who >> shift & 15); };
  s.arms = {nibble(12), nibble(8), static_cast<ArmsOther>(nibble(4)), nibble(0),
            static_cast<std::int32_t>(r.u32())};
  return s;
}

void seal_block(std::span<std::uint16_t> block) {
  const std::size_t body = block.size() - 2;
  Writer(block.subspan(body)).u32(crc32_registers(block.first(body)));
}

bool block_intact(std::span<const std::uint16_t> block) {
  const std::size_t body = block.size() - 2;
  const std::uint32_t crc = Reader(block.subspan(body)).u32();
  return crc == crc32_registers(block.first(body));
}

bool ident_intact(std::span<const std::uint16_t, kIdentSize> block) {
  const bool without = (decode_ident(block).capabilities & kCapBlockCrc) == 0;
  const bool blank = block[kIdentSize - 2] == 0 && block[kIdentSize - 1] == 0;
  return block_intact(block) || (without && blank);
}

namespace {

// The fields of BladeWords, in their order, and what a word counts: so many to the mm or MPa.
struct BladeField {
  double ClampedBlade::*place;
  double scale;
};
constexpr std::array<BladeField, kBladeWordNames.size()> kBladeFields{
    {{&ClampedBlade::length_mm, kMilli},
     {&ClampedBlade::width_mm, kMilli},
     {&ClampedBlade::thickness_mm, kMilli},
     {&ClampedBlade::youngs_modulus_mpa, 1},
     {&ClampedBlade::yield_strength_mpa, 1}}};

}  // namespace

std::optional<BladeWords> encode_blade(const ClampedBlade& blade) {
  BladeWords words{};
  for (std::size_t i = 0; i < words.size(); ++i) {
    const double value = std::round(blade.*kBladeFields[i].place * kBladeFields[i].scale);
    // A NaN fails both comparisons.
    if (!(value >= 0 && value <= std::numeric_limits<std::uint32_t>::max())) return std::nullopt;
    words[i] = static_cast<std::uint32_t>(value);
  }
  return words;
}

ClampedBlade decode_blade(const BladeWords& words) {
  ClampedBlade blade;
  for (std::size_t i = 0; i < words.size(); ++i)
    blade.*kBladeFields[i].place = words[i] / kBladeFields[i].scale;
  return blade;
}

std::array<std::uint16_t, kCommandSize> encode_command(const Command& c) {
  const auto blade = encode_blade(c.blade);
  if (!blade) throw std::logic_error("encode_command: the blade does not fit the registers");
  std::array<std::uint16_t, kCommandSize> registers{};
  Writer w(registers);
  w.u32(c.nonce);
  w.u16(static_cast<std::uint16_t>(c.op));
  w.u64(c.job_id);
  w.u32(c.run);
  w.u32(c.token);
  w.u32(c.waypoint_count);
  for (const std::uint32_t word : *blade) w.u32(word);
  w.u32(crc32_registers(w.written()));
  return registers;
}

DecodedCommand decode_command(std::span<const std::uint16_t, kCommandSize> registers) {
  Reader r(registers);
  DecodedCommand result;
  Command& c = result.command;
  c.nonce = r.u32();
  c.op = static_cast<Op>(r.u16());
  c.job_id = r.u64();
  c.run = r.u32();
  c.token = r.u32();
  c.waypoint_count = r.u32();
  BladeWords blade;
  for (std::uint32_t& word : blade) word = r.u32();
  c.blade = decode_blade(blade);
  const std::uint32_t crc = crc32_registers(r.consumed());
  result.crc_ok = r.u32() == crc;
  return result;
}

std::array<std::uint16_t, kArmsSize> encode_arms(const Arms& arms) {
  std::array<std::uint16_t, kArmsSize> registers{};
  Writer w(registers);
  w.u32(arms.token);
  w.u64(arms.cell_id);
  for (const auto& joints : arms.joints_rad) {
    for (const double q : joints) {
      if (!(std::abs(std::round(q * kMicro)) <= std::numeric_limits<std::int32_t>::max()))
        throw std::logic_error("encode_arms: a joint does not fit the registers");
      w.scaled(q, kMicro);
    }
  }
  w.u32(crc32_registers(w.written()));
  return registers;
}

DecodedArms decode_arms(std::span<const std::uint16_t, kArmsSize> registers) {
  Reader r(registers);
  DecodedArms result;
  result.arms.token = r.u32();
  result.arms.cell_id = r.u64();
  for (auto& joints : result.arms.joints_rad) {
    for (double& q : joints) q = r.scaled_signed(kMicro);
  }
  const std::uint32_t crc = crc32_registers(r.consumed());
  result.crc_ok = r.u32() == crc;
  return result;
}

WindowRegisters encode_window(std::uint32_t token, std::uint32_t first_sequence, bool last,
                              std::span<const RawWaypoint> raw) {
  if (raw.size() > kMaxWaypointsPerWindow) throw std::logic_error("encode_window: more than 4 waypoints");
  WindowRegisters window;
  Writer w(window.registers);
  w.u32(token);
  w.u32(first_sequence);
  w.u16(static_cast<std::uint32_t>(raw.size()));
  w.u16(last ? kFlagLast : 0);
  for (const RawWaypoint& waypoint : raw) {
    for (std::size_t i = 0; i < kWaypointBytes; i += 4) w.u32(get_u32(waypoint.data() + i));
  }
  w.u32(crc32_registers(w.written()));
  window.size = w.written().size();
  return window;
}

std::optional<Window> decode_window(std::span<const std::uint16_t> registers) {
  if (registers.size() < kWindowHeader + kWindowTrailer) return std::nullopt;
  Reader r(registers);
  Window window;
  window.token = r.u32();
  window.first_sequence = r.u32();
  window.count = r.u16();
  const std::uint16_t flags = r.u16();
  window.last = (flags & kFlagLast) != 0;
  window.known_flags = (flags & ~kFlagLast) == 0;
  if (window.count > kMaxWaypointsPerWindow ||
      registers.size() != kWindowHeader + window.count * kRegistersPerWaypoint + kWindowTrailer) {
    return std::nullopt;
  }
  for (std::size_t k = 0; k < window.count; ++k) {
    for (std::size_t i = 0; i < kWaypointBytes; i += 4) put_u32(window.raw[k].data() + i, r.u32());
  }
  const std::uint32_t crc = crc32_registers(r.consumed());
  window.crc_ok = r.u32() == crc;
  return window;
}

}  // namespace hotblade::robot::protocol
