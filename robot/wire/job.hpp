// One strip as the controller knows it: encoded waypoints and the identity that binds them to a program.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "robot/pose/waypoint.hpp"
#include "robot/wire/protocol.hpp"

namespace hotblade::robot {

using Sha256 = std::array<std::uint8_t, 32>;

// Returns the hash of the bytes.
[[nodiscard]] Sha256 sha256(std::span<const std::uint8_t> bytes);
// Returns two digits a byte, in small letters.
[[nodiscard]] std::string to_hex(std::span<const std::uint8_t> bytes);
// Returns 16 digits, as job ids stand in logs and messages.
[[nodiscard]] std::string to_hex(std::uint64_t value);

// A chain of hashes over executed waypoints: chain_k = SHA-256(chain_(k-1) || raw_k), where chain_(-1) is the
// job id's 8 bytes. Two logs with one last chain hold the same waypoints in the same order.
class Chain {
 public:
  explicit Chain(std::uint64_t job_id);
  Chain(const Chain&) = delete;
  Chain& operator=(const Chain&) = delete;
  ~Chain();

  // Starts again; the chain allocates nothing after construction.
  void restart(std::uint64_t job_id);
  // Goes on from a value that a log gave.
  void resume(const Sha256& value);
  // Adds one executed waypoint and returns the new value.
  const Sha256& add(const protocol::RawWaypoint& raw);
  [[nodiscard]] const Sha256& value() const { return value_; }

 private:
  void* context_;  // EVP_MD_CTX
  Sha256 value_{};
  bool first_ = true;
};

// A waypoint or a blade that no register can hold: `strip S001: waypoint 17: ...`.
struct JobError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// The arms that a strip was planned for.
struct JobArms {
  protocol::Arms declared;           // without a token
  std::array<std::string, 2> names;  // of the arms, in the cell's order
};

// A strip's waypoints as they are sent, and the blade they are for.
struct Job {
  std::uint64_t id = 0;
  std::string strip;
  std::vector<protocol::RawWaypoint> raw;
  ClampedBlade blade;
  std::optional<JobArms> arms;  // absent: planned without a cell

  [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(raw.size()); }
};

// Encodes a strip. Its id is the first 64 bits of SHA-256 over program_sha256 (32 bytes), the strip's id
// (UTF-8) and the waypoint bytes. Throws JobError for a waypoint or a blade that cannot be encoded and for an
// empty strip.
[[nodiscard]] Job make_job(const Sha256& program_sha256, const std::string& strip,
                           std::span<const Waypoint> waypoints, const ClampedBlade& blade);

// Returns the CRC-32 of the first `count` waypoints' bytes, as STATUS has it.
[[nodiscard]] std::uint32_t prefix_crc(const Job& job, std::uint32_t count);

}  // namespace hotblade::robot
