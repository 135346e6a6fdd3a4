// Modbus TCP by hand: frames byte for byte, on a socket that does nothing by itself.
#pragma once

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <span>
#include <vector>

#include "robot/wire/protocol.hpp"

namespace hotblade::robot::testing {

using Bytes = std::vector<std::uint8_t>;

inline void put16(Bytes& bytes, unsigned value) {
  bytes.push_back(static_cast<std::uint8_t>(value >> 8));
  bytes.push_back(static_cast<std::uint8_t>(value & 0xFF));
}

// A whole request: MBAP header and PDU.
inline Bytes request(unsigned transaction, const Bytes& pdu, unsigned unit = 1, unsigned protocol_id = 0) {
  Bytes bytes;
  put16(bytes, transaction);
  put16(bytes, protocol_id);
  put16(bytes, static_cast<unsigned>(pdu.size()) + 1);
  bytes.push_back(static_cast<std::uint8_t>(unit));
  bytes.insert(bytes.end(), pdu.begin(), pdu.end());
  return bytes;
}

inline Bytes pdu(unsigned function, const std::vector<unsigned>& words) {
  Bytes bytes{static_cast<std::uint8_t>(function)};
  for (const unsigned word : words) put16(bytes, word);
  return bytes;
}

inline Bytes write_pdu(unsigned address, std::span<const std::uint16_t> registers) {
  Bytes bytes = pdu(16, {address, static_cast<unsigned>(registers.size())});
  bytes.push_back(static_cast<std::uint8_t>(2 * registers.size()));
  for (const auto word : registers) put16(bytes, word);
  return bytes;
}

// Function 23 that reads STATUS.
inline Bytes write_read_pdu(unsigned address, std::span<const std::uint16_t> registers) {
  Bytes bytes = pdu(
      23, {protocol::kStatusBase, protocol::kStatusSize, address, static_cast<unsigned>(registers.size())});
  bytes.push_back(static_cast<std::uint8_t>(2 * registers.size()));
  for (const auto word : registers) put16(bytes, word);
  return bytes;
}

class RawClient {
 public:
  explicit RawClient(std::uint16_t port) : fd_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    connected_ = ::connect(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
    const int one = 1;
    ::setsockopt(fd_, IPPROTO_TCP, TCP_NODELAY, &one, sizeof one);
  }
  ~RawClient() { ::close(fd_); }
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;

  [[nodiscard]] bool connected() const { return connected_; }
  [[nodiscard]] int fd() const { return fd_; }
  void send(const Bytes& bytes) { ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL); }
  void hang_up() { ::shutdown(fd_, SHUT_WR); }

  // The next whole answer; empty when none comes in time or the connection is closed.
  Bytes receive(int timeout_ms = 2000) {
    Bytes bytes;
    const auto until = std::chrono::steady_clock::now() + std::chrono::milliseconds(timeout_ms);
    while (bytes.size() < 6 || bytes.size() < 6u + (bytes[4] << 8 | bytes[5])) {
      const auto left =
          std::chrono::duration_cast<std::chrono::milliseconds>(until - std::chrono::steady_clock::now())
              .count();
      pollfd wanted{fd_, POLLIN, 0};
      if (left <= 0 || ::poll(&wanted, 1, static_cast<int>(left)) <= 0) return {};
      std::uint8_t byte = 0;
      if (::recv(fd_, &byte, 1, 0) != 1) return {};
      bytes.push_back(byte);
    }
    return bytes;
  }
  Bytes ask(const Bytes& bytes) {
    send(bytes);
    return receive();
  }
  // Whether the server closes the connection in time.
  bool closed_within(int timeout_ms) {
    pollfd wanted{fd_, POLLIN, 0};
    std::uint8_t byte = 0;
    return ::poll(&wanted, 1, timeout_ms) > 0 && ::recv(fd_, &byte, 1, 0) <= 0;
  }

 private:
  int fd_;
  bool connected_ = false;
};

}  // namespace hotblade::robot::testing
