// Modbus TCP on the server's side, without sockets: what a request does to the registers.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "robot/controller/controller.hpp"
#include "robot/controller/modbus_frame.hpp"

namespace hotblade::robot {

// A whole answer: the first `size` bytes.
struct Reply {
  std::array<std::uint8_t, kMaxAduSize> bytes{};
  std::size_t size = 0;
  [[nodiscard]] std::span<const std::uint8_t> span() const { return {bytes.data(), size}; }
};

// Maps requests to a controller and to 16 registers of scratch.
class RegisterMap {
 public:
  explicit RegisterMap(Controller& controller) : controller_(controller) {}

  // Carries out one whole request (as frame_head delimits it) and builds its answer: an echo of the
  // transaction, or an exception. Never throws for anything a client can send.
  [[nodiscard]] Reply handle(std::span<const std::uint8_t> request, Controller::Connection from,
                             std::uint64_t now_us);

  static constexpr std::uint8_t kIllegalFunction = 1, kIllegalAddress = 2, kIllegalValue = 3,
                                kNoSuchUnit = 11;

 private:
  struct Pdu;
  [[nodiscard]] std::uint8_t read(Pdu& pdu);
  [[nodiscard]] std::uint8_t write_single(Pdu& pdu);
  [[nodiscard]] std::uint8_t write_multiple(Pdu& pdu);
  [[nodiscard]] std::uint8_t read_write(Pdu& pdu);
  [[nodiscard]] std::uint8_t check_read(std::uint16_t address, std::uint16_t count) const;
  [[nodiscard]] std::uint8_t fill(Pdu& pdu, std::uint16_t address, std::uint16_t count);
  [[nodiscard]] std::uint8_t write(Pdu& pdu, std::uint16_t address, std::span<const std::uint8_t> data);
  [[nodiscard]] std::uint8_t write_command(Pdu& pdu, std::span<const std::uint16_t> registers);
  [[nodiscard]] std::uint8_t write_arms(Pdu& pdu, std::span<const std::uint16_t> registers);
  [[nodiscard]] std::uint8_t write_window(Pdu& pdu, std::span<const std::uint16_t> registers);

  Controller& controller_;
  std::array<std::uint16_t, protocol::kScratchSize> scratch_{};
};

}  // namespace hotblade::robot
