#include "robot/wire/protocol.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "tests/paths.hpp"

namespace hotblade::robot::protocol {
namespace {

std::vector<std::uint16_t> golden(const std::string& wanted) {
  static const auto kBlocks = [] {
    std::map<std::string, std::vector<std::uint16_t>> blocks;
    std::ifstream file(hotblade::testing::source_dir() + "/tests/robot/wire/golden_registers.txt");
    for (std::string line; std::getline(file, line);) {
      std::istringstream fields(line);
      std::string key, word;
      fields >> key;
      while (fields >> word) blocks[key].push_back(static_cast<std::uint16_t>(std::stoul(word, nullptr, 16)));
    }
    return blocks;
  }();
  return kBlocks.at(wanted);
}

RawWaypoint golden_waypoint(const std::string& wanted) {
  const auto registers = golden(wanted);
  RawWaypoint raw{};
  for (std::size_t i = 0; i < registers.size(); ++i) {
    raw.at(2 * i) = static_cast<std::uint8_t>(registers[i] >> 8);
    raw.at(2 * i + 1) = static_cast<std::uint8_t>(registers[i]);
  }
  return raw;
}

template <typename Block>
std::vector<std::uint16_t> as_vector(const Block& block) {
  return {block.begin(), block.end()};
}

Waypoint plain() {
  return {0, false, {{0, 0, 0}, {1, 0, 0, 0}}, {{0.001, -0.001, 1}, {0, 1, 0, 0}}};
}
Waypoint hot() {
  return {
      1234567, true, {{-2000, 1999.999, 3000}, {0.5, 0.5, 0.5, 0.5}}, {{0.5, -0.5, 0.25}, {0.8, 0, -0.6, 0}}};
}
Waypoint far_out() {
  return {
      0xFFFFFFFF, true, {{2147483.647, -2147483.647, 0}, {-0.36, 0.48, 0.8, 0}}, {{0, 0, 0}, {1, 0, 0, 0}}};
}

double angle_between(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  const Eigen::Quaterniond d = a.conjugate() * b;
  return 2 * std::atan2(d.vec().norm(), std::abs(d.w()));
}

Eigen::Quaterniond random_rotation(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random)).normalized();
}

TEST(Crc32, HasTheCheckValueOfTheStandard) {
  const std::string text = "123456789";
  const std::vector<std::uint8_t> bytes(text.begin(), text.end());
  EXPECT_EQ(crc32(bytes), 0xCBF43926u);
  // Continued over two pieces it is the same.
  const std::span all(bytes);
  EXPECT_EQ(crc32(all.subspan(4), crc32(all.first(4))), 0xCBF43926u);
}

TEST(Crc32, TakesTheHighByteOfARegisterFirst) {
  EXPECT_EQ(crc32_registers(std::vector<std::uint16_t>{0x3132, 0x3334}),
            crc32(std::vector<std::uint8_t>{'1', '2', '3', '4'}));
}

TEST(Waypoint, MatchesGoldenBytes) {
  EXPECT_EQ(encode_waypoint(plain()), golden_waypoint("waypoint_plain"));
  EXPECT_EQ(encode_waypoint(hot()), golden_waypoint("waypoint_hot"));
  EXPECT_EQ(encode_waypoint(far_out()), golden_waypoint("waypoint_far"));
}

TEST(Waypoint, DecodesGoldenBytes) {
  const auto decoded = decode_waypoint(golden_waypoint("waypoint_hot"));
  EXPECT_EQ(decoded.error, Limit::kNone);
  EXPECT_EQ(decoded.waypoint.t_us, 1234567u);
  EXPECT_TRUE(decoded.waypoint.heat);
  EXPECT_LT((decoded.waypoint.a.p - hot().a.p).norm(), 1e-9);
  EXPECT_LT(angle_between(decoded.waypoint.b.q, hot().b.q), 1e-8);
}

TEST(Waypoint, RoundTripsWithinHalfARegisterUnit) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> place(-2e6, 2e6);
  for (int i = 0; i < 20000; ++i) {
    Waypoint w;
    w.t_us = static_cast<std::uint32_t>(random());
    w.heat = (random() & 1) != 0;
    for (Pose* pose : {&w.a, &w.b})
      *pose = {{place(random), place(random), place(random)}, random_rotation(random)};
    const auto raw = encode_waypoint(w);
    ASSERT_TRUE(raw.has_value());
    const auto back = decode_waypoint(*raw);
    ASSERT_EQ(back.error, Limit::kNone);
    EXPECT_EQ(back.waypoint.t_us, w.t_us);
    EXPECT_EQ(back.waypoint.heat, w.heat);
    // Half a micrometre, and the rounding of the decimal fraction.
    EXPECT_LE((back.waypoint.a.p - w.a.p).cwiseAbs().maxCoeff(), 0.5e-3 + 1e-9);
    // Three components off by 2^-30 and the fourth by three times that: 2 sqrt(12) 2^-30.
    EXPECT_LE(angle_between(back.waypoint.a.q, w.a.q), 2 * std::sqrt(12.0) / 1073741824.0 * 1.01);
    EXPECT_EQ(encode_waypoint(back.waypoint), raw) << "a decoded waypoint encodes to the same bytes";
  }
}

TEST(Waypoint, NearTiesOfTheLargestComponentStayDecodable) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> nudge(-4e-9, 4e-9);
  for (int i = 0; i < 5000; ++i) {
    Waypoint w = plain();
    w.a.q = Eigen::Quaterniond(0.5 + nudge(random), -0.5 + nudge(random), 0.5 + nudge(random),
                               -0.5 + nudge(random));
    const auto raw = encode_waypoint(w);
    ASSERT_TRUE(raw.has_value());
    const auto back = decode_waypoint(*raw);
    ASSERT_EQ(back.error, Limit::kNone);
    EXPECT_LT(angle_between(back.waypoint.a.q, w.a.q), 2e-8);
  }
}

TEST(Waypoint, OneOrientationHasOneEncoding) {
  std::mt19937_64 random(3);
  for (int i = 0; i < 1000; ++i) {
    Waypoint w = plain(), negated = plain();
    w.a.q = random_rotation(random);
    negated.a.q.coeffs() = -w.a.q.coeffs();
    EXPECT_EQ(encode_waypoint(w), encode_waypoint(negated));
  }
}

TEST(Waypoint, TiesTakeTheLowestIndex) {
  Waypoint w = plain();
  w.a.q = {-0.5, 0.5, 0.5, 0.5};
  const auto raw = encode_waypoint(w);
  ASSERT_TRUE(raw.has_value());
  EXPECT_EQ((*raw)[16] >> 6, 0) << "w is left out";
  EXPECT_GT(decode_waypoint(*raw).waypoint.a.q.w(), 0);
}

TEST(Waypoint, WhatNoRegisterHoldsIsNotEncoded) {
  Waypoint w = plain();
  w.b.p.y() = 2147483.648;
  EXPECT_FALSE(encode_waypoint(w));
  w.b.p.y() = std::nan("");
  EXPECT_FALSE(encode_waypoint(w));
  w = plain();
  w.a.q = {1.1, 0, 0, 0};
  EXPECT_FALSE(encode_waypoint(w));
  w.a.q = {std::nan(""), 0, 0, 0};
  EXPECT_FALSE(encode_waypoint(w));
}

TEST(Waypoint, RegistersThatHoldNoOrientationAreRefused) {
  const RawWaypoint good = *encode_waypoint(hot());
  const auto error_with = [&](std::size_t byte, std::uint8_t mask) {
    RawWaypoint raw = good;
    raw.at(byte) = static_cast<std::uint8_t>(raw.at(byte) ^ mask);
    return decode_waypoint(raw).error;
  };
  EXPECT_EQ(error_with(0, 0), Limit::kNone);
  EXPECT_EQ(error_with(20, 0x80), Limit::kQuaternion) << "top bit of the second component";
  EXPECT_EQ(error_with(24, 0x80), Limit::kQuaternion) << "top bits of the third component";
  EXPECT_EQ(error_with(24, 0x40), Limit::kQuaternion);
  EXPECT_EQ(error_with(20, 0x40), Limit::kHeat) << "heat in one clamp only";
  RawWaypoint longer = good;
  longer.at(16) = 0x1F;  // nearly 1, next to two components of 1/2
  EXPECT_EQ(decode_waypoint(longer).error, Limit::kQuaternion);
}

TEST(Window, MatchesGoldenRegisters) {
  const RawWaypoint one = golden_waypoint("waypoint_plain"), two = golden_waypoint("waypoint_hot"),
                    three = golden_waypoint("waypoint_far");
  EXPECT_EQ(as_vector(encode_window(7, 42, false, {}).span()), golden("window_empty"));
  EXPECT_EQ(as_vector(encode_window(0x01020304, 65536, true, {{two}}).span()), golden("window_one_last"));
  EXPECT_EQ(as_vector(encode_window(5, 0, false, {{one, two, three}}).span()), golden("window_three"));
}

TEST(Window, DecodesToWhatWasEncoded) {
  const auto window = decode_window(golden("window_three"));
  ASSERT_TRUE(window.has_value());
  EXPECT_TRUE(window->crc_ok);
  EXPECT_EQ(window->token, 5u);
  EXPECT_EQ(window->first_sequence, 0u);
  EXPECT_EQ(window->count, 3);
  EXPECT_FALSE(window->last);
  EXPECT_EQ(window->raw[2], golden_waypoint("waypoint_far"));
  EXPECT_TRUE(decode_window(golden("window_one_last"))->last);
}

TEST(Window, EverySingleBitErrorIsNoticed) {
  const auto good = golden("window_one_last");
  for (std::size_t word = 0; word < good.size(); ++word) {
    for (int bit = 0; bit < 16; ++bit) {
      auto bad = good;
      bad[word] = static_cast<std::uint16_t>(bad[word] ^ (1 << bit));
      const auto window = decode_window(bad);
      EXPECT_TRUE(!window || !window->crc_ok) << "word " << word << " bit " << bit;
    }
  }
}

TEST(Window, OnlyItsOwnLengthIsAWindow) {
  auto registers = golden("window_three");
  registers.pop_back();
  EXPECT_FALSE(decode_window(registers));
  registers.resize(registers.size() + 2);
  EXPECT_FALSE(decode_window(registers));
  EXPECT_FALSE(decode_window({}));
  EXPECT_FALSE(decode_window(std::vector<std::uint16_t>{0, 1, 0, 0, 0xFFFF, 0, 0, 0}));
}

TEST(Window, MoreThanFourWaypointsAreTheCallersMistake) {
  const std::vector<RawWaypoint> five(5, golden_waypoint("waypoint_plain"));
  EXPECT_THROW((void)encode_window(1, 0, false, five), std::logic_error);
}

TEST(Command, MatchesGoldenRegistersBothWays) {
  const Command open{0xDEADBEEF, Op::kOpen, 0x0123456789ABCDEF, 3, 0, 12345, {{8, 0.5, 190000, 1010}, 800}};
  EXPECT_EQ(as_vector(encode_command(open)), golden("command_open"));
  EXPECT_EQ(as_vector(encode_command({1, Op::kStart, 0x0123456789ABCDEF, 3, 9, 0, {}})),
            golden("command_start"));
  const auto block = golden("command_open");
  const auto back = decode_command(std::span<const std::uint16_t, kCommandSize>(block));
  EXPECT_TRUE(back.crc_ok);
  EXPECT_EQ(back.command.nonce, open.nonce);
  EXPECT_EQ(back.command.op, Op::kOpen);
  EXPECT_EQ(back.command.job_id, open.job_id);
  EXPECT_EQ(back.command.run, 3u);
  EXPECT_EQ(back.command.token, 0u);
  EXPECT_EQ(back.command.waypoint_count, 12345u);
  EXPECT_EQ(back.command.blade, open.blade);
}

TEST(BladeWords, AreWholeMicrometresAndMegapascalsBothWays) {
  const ClampedBlade blade{{8, 0.5, 190000, 1010}, 800};
  EXPECT_EQ(encode_blade(blade), (BladeWords{800000, 8000, 500, 190000, 1010}));
  EXPECT_EQ(decode_blade({800000, 8000, 500, 190000, 1010}), blade);
  // Every word comes back from the mm and MPa it stands for; every blade within half a unit.
  std::mt19937 random(1);
  std::uniform_int_distribution<std::uint32_t> any;
  for (int round = 0; round < 10000; ++round) {
    BladeWords words{};
    for (auto& word : words) word = any(random) >> (any(random) % 32);
    EXPECT_EQ(encode_blade(decode_blade(words)), words);
  }
  std::uniform_real_distribution<double> size(0, 5000);
  for (int round = 0; round < 10000; ++round) {
    const ClampedBlade sent{{size(random), size(random), size(random), size(random)}, size(random)};
    const ClampedBlade got = decode_blade(encode_blade(sent).value());
    EXPECT_NEAR(got.length_mm, sent.length_mm, 0.5001e-3);
    EXPECT_NEAR(got.width_mm, sent.width_mm, 0.5001e-3);
    EXPECT_NEAR(got.thickness_mm, sent.thickness_mm, 0.5001e-3);
    EXPECT_NEAR(got.youngs_modulus_mpa, sent.youngs_modulus_mpa, 0.5);
    EXPECT_NEAR(got.yield_strength_mpa, sent.yield_strength_mpa, 0.5);
  }
}

TEST(BladeWords, WhatNoRegisterHoldsIsNoBlade) {
  constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();
  constexpr double kLargest_mm = 4294967.295;
  EXPECT_TRUE(encode_blade({{8, 0.5, 190000, 1010}, kLargest_mm}));
  for (const double length :
       {-1.0, kLargest_mm + 0.001, kNotANumber, std::numeric_limits<double>::infinity()})
    EXPECT_FALSE(encode_blade({{8, 0.5, 190000, 1010}, length})) << length;
  EXPECT_FALSE(encode_blade({{8, 0.5, -1, 1010}, 800}));
  EXPECT_FALSE(encode_blade({{8, 0.5, 190000, 5e9}, 800}));
  Command open;
  open.blade.width_mm = kNotANumber;
  EXPECT_THROW((void)encode_command(open), std::logic_error);
}

TEST(Status, MatchesGoldenRegistersBothWays) {
  const auto block = golden("status");
  const Status s = decode_status(std::span<const std::uint16_t, kStatusSize>(block));
  EXPECT_EQ(s.state, State::kRunning);
  EXPECT_EQ(s.fault, Fault::kUnderrun);
  EXPECT_EQ(s.fault_detail, 9);
  EXPECT_EQ(s.fault_sequence, 0x00010002u);
  EXPECT_EQ(s.job_id, 0x0123456789ABCDEFu);
  EXPECT_EQ(s.run, 3u);
  EXPECT_EQ(s.token, 9u);
  EXPECT_EQ(s.accepted, 65544u);
  EXPECT_EQ(s.executed, 65536u);
  EXPECT_EQ(s.free, 1016);
  EXPECT_EQ(s.last_result, Result::kLimit);
  EXPECT_EQ(s.last_nonce, 77u);
  EXPECT_EQ(s.accepted_crc, 0xCBF43926u);
  EXPECT_EQ(s.executed_crc, 0x11223344u);
  EXPECT_EQ(s.watchdog_ms, 1999);
  EXPECT_EQ(s.time_us, 0x0000000100000002u);
  EXPECT_EQ(as_vector(encode_status(s)), block);
}

TEST(Status, SaysWhichPartOfAnArmBreaksALimit) {
  const auto block = golden("status_arms");
  const Status s = decode_status(std::span<const std::uint16_t, kStatusSize>(block));
  EXPECT_EQ(s.arms, (ArmsDetail{2, 7, ArmsOther::kPlinth, 0, 7600}));
  EXPECT_EQ(as_vector(encode_status(s)), block);
  EXPECT_EQ(describe(s.arms, Limit::kArmClearance, {"R1", "R2"}),
            "arm R2 tool and the plinth, 7.6 mm too near");
  EXPECT_EQ(describe(s.arms, Limit::kArmClearance, {}), "arm 2 tool and the plinth, 7.6 mm too near");
  EXPECT_EQ(describe({1, 5, {}, 0, 17453}, Limit::kJointAngle, {}), "arm 1 joint 5, 1 degrees over");
  EXPECT_EQ(describe({1, 1, {}, 0, 2500}, Limit::kNearSingular, {}),
            "arm 1 shoulder, 2.5 mm too near to axis 1");
  EXPECT_EQ(describe({1, 4, ArmsOther::kOtherArm, 6, 1000}, Limit::kArmClearance, {"R1", "R2"}),
            "arm R1 link 4 and arm R2 link 6, 1 mm too near");
  EXPECT_EQ(describe({0, 3, ArmsOther::kObstacle, 0, 20400}, Limit::kArmClearance, {"R1", "R2"}),
            "the blade and an obstacle, 20.4 mm too near");
  EXPECT_EQ(describe(s.arms, Limit::kSpeed, {}), "");
  EXPECT_FALSE(describe({15, 15, static_cast<ArmsOther>(15), 15, -1}, Limit::kArmClearance, {}).empty())
      << "registers may hold anything";
}

TEST(ArmsBlock, MatchesGoldenRegistersBothWays) {
  const auto block = golden("arms");
  const DecodedArms decoded = decode_arms(std::span<const std::uint16_t, kArmsSize>(block));
  EXPECT_TRUE(decoded.crc_ok);
  EXPECT_EQ(decoded.arms.token, 9u);
  EXPECT_EQ(decoded.arms.cell_id, 0x0123456789ABCDEFu);
  EXPECT_DOUBLE_EQ(decoded.arms.joints_rad[0][4], -1.570796);
  EXPECT_DOUBLE_EQ(decoded.arms.joints_rad[1][5], -0.092060);
  EXPECT_EQ(as_vector(encode_arms(decoded.arms)), block);
  auto spoilt = block;
  spoilt[7] ^= 1;
  EXPECT_FALSE(decode_arms(std::span<const std::uint16_t, kArmsSize>(spoilt)).crc_ok);
  Arms wide = decoded.arms;
  wide.joints_rad[0][0] = 3000;
  EXPECT_THROW((void)encode_arms(wide), std::logic_error);
}

TEST(Ident, MatchesGoldenRegistersBothWays) {
  const auto block = golden("ident");
  const Ident ident = decode_ident(std::span<const std::uint16_t, kIdentSize>(block));
  EXPECT_EQ(ident.magic, kMagic);
  EXPECT_EQ(ident.capabilities, kCapWriteRead | kCapSimulator);
  EXPECT_EQ(ident.fifo_size, 1024);
  EXPECT_EQ(ident.boot_id, 0xCAFED00Du);
  EXPECT_DOUBLE_EQ(ident.limits.speed_mm_s, 100);
  EXPECT_DOUBLE_EQ(ident.limits.accel_mm_s2, 500);
  EXPECT_DOUBLE_EQ(ident.limits.angular_rad_s, 1);
  EXPECT_DOUBLE_EQ(ident.limits.angular_accel_rad_s2, 2);
  EXPECT_EQ(ident.limits.envelope_min_mm, Eigen::Vector3d(-2000, -2000, 0));
  EXPECT_EQ(ident.limits.envelope_max_mm, Eigen::Vector3d(2000, 2000, 3000));
  EXPECT_EQ(ident.limits.min_dt_us, 5000u);
  EXPECT_DOUBLE_EQ(ident.limits.chord_slack, 5e-4);
  EXPECT_EQ(ident.watchdog_ms, 2000u);
  EXPECT_EQ(ident.lease_ms, 5000u);
  EXPECT_EQ(ident.max_waypoints, 1000000u);
  EXPECT_EQ(ident.blade_length_mm, 800);
  EXPECT_EQ(as_vector(encode_ident(ident)), block);
}

TEST(BlockCrc, NoticesEveryBitAndABlockThatIsAnother) {
  auto status = encode_status(decode_status(std::span<const std::uint16_t, kStatusSize>(golden("status"))));
  EXPECT_FALSE(block_intact(status)) << "not sealed";
  seal_block(status);
  EXPECT_TRUE(block_intact(status));
  for (std::size_t i = 0; i < 16 * status.size(); ++i) {
    auto spoilt = status;
    spoilt[i / 16] = static_cast<std::uint16_t>(spoilt[i / 16] ^ (1u << (i % 16)));
    EXPECT_FALSE(block_intact(spoilt)) << i;
  }
  auto ident = encode_ident(decode_ident(std::span<const std::uint16_t, kIdentSize>(golden("ident"))));
  EXPECT_TRUE(ident_intact(ident)) << "without a CRC, as its capabilities say";
  ident[2] |= kCapBlockCrc;
  EXPECT_FALSE(ident_intact(ident));
  seal_block(ident);
  EXPECT_TRUE(ident_intact(ident));
  // A request whose address was spoilt is answered with other registers.
  EXPECT_FALSE(block_intact(std::span<const std::uint16_t>(ident).subspan(16, kStatusSize)));
}

TEST(Names, NumbersOutsideTheTablesAreUnknown) {
  EXPECT_STREQ(name(Op::kClose), "CLOSE");
  EXPECT_STREQ(name(State::kEstop), "ESTOP");
  EXPECT_STREQ(name(Result::kBusy), "BUSY");
  EXPECT_STREQ(name(Fault::kWatchdog), "WATCHDOG");
  EXPECT_STREQ(name(static_cast<Op>(0)), "unknown");
  EXPECT_STREQ(name(static_cast<State>(7)), "unknown");
  EXPECT_STREQ(name(static_cast<Result>(10)), "unknown");
  EXPECT_STREQ(name(static_cast<Fault>(99)), "unknown");
}

}  // namespace
}  // namespace hotblade::robot::protocol
