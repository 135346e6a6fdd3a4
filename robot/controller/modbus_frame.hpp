// Modbus TCP frames: their sizes, and where one ends in a stream of bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace hotblade::robot {

inline constexpr std::size_t kMbapSize =
    7;  // transaction, protocol and length of two bytes each, unit of one
inline constexpr std::size_t kMaxPduSize = 253;
inline constexpr std::size_t kMaxAduSize = kMbapSize + kMaxPduSize;

// What stands at the head of a byte stream.
struct FrameHead {
  enum class Kind {
    kIncomplete,  // wait for more bytes
    kRequest,     // `size` bytes are one request
    kForeign,     // `size` bytes of another protocol: to be skipped without an answer
    kBroken,      // the length cannot be: nothing after it can be trusted, close the connection
  };
  Kind kind = Kind::kIncomplete;
  std::size_t size = 0;
};
// Returns what stands at the head of these bytes.
[[nodiscard]] FrameHead frame_head(std::span<const std::uint8_t> bytes);

}  // namespace hotblade::robot
