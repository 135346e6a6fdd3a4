#include "robot/controller/modbus_frame.hpp"

namespace hotblade::robot {

namespace {

std::uint16_t get16(std::span<const std::uint8_t> bytes, std::size_t at) {
  return static_cast<std::uint16_t>(bytes[at] << 8 | bytes[at + 1]);
}

}  // namespace

FrameHead frame_head(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kLengthEnd = 6;
  if (bytes.size() < kLengthEnd) return {};
  const std::size_t length = get16(bytes, 4);  // of what follows it: unit and PDU
  const bool foreign = get16(bytes, 2) != 0;
  if (length < 2 || length > 1 + kMaxPduSize) return {FrameHead::Kind::kBroken, 0};
  if (bytes.size() < kLengthEnd + length) return {};
  return {foreign ? FrameHead::Kind::kForeign : FrameHead::Kind::kRequest, kLengthEnd + length};
}

}  // namespace hotblade::robot
