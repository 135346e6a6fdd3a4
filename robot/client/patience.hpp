// How long a client waits between attempts, for the stream and for single questions alike.
#pragma once

#include <chrono>
#include <cstdint>

namespace hotblade::robot {

// Between two attempts to be let in by a controller that is busy, or slow to clear.
inline constexpr auto kRetry = std::chrono::milliseconds(100);

// Between two attempts to connect: the first pause, and the one that doubling ends at.
inline constexpr auto kShortestPause = std::chrono::milliseconds(5);
inline constexpr auto kLongestPause = std::chrono::milliseconds(500);

// Returns how long the lease of a client that is gone may stand in the way: its time and two seconds for an
// answer.
inline std::chrono::milliseconds lease_patience(std::uint32_t lease_ms) {
  return std::chrono::milliseconds(lease_ms + 2000);
}

}  // namespace hotblade::robot
