// One Modbus TCP connection of a client: what libmodbus offers, reduced to three outcomes, and function 23 in
// as few calls of the system as it takes.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace hotblade::robot {

enum class LinkOutcome {
  kOk,
  kException,  // the server refused the request; the connection is fine
  kLost,       // anything else: nothing is known about what the server did, the connection is closed
};

class ModbusLink {
 public:
  ModbusLink(const std::string& host, std::uint16_t port, std::uint32_t response_ms);
  ~ModbusLink();
  ModbusLink(const ModbusLink&) = delete;
  ModbusLink& operator=(const ModbusLink&) = delete;

  // Closes and connects again; false when that failed.
  bool connect();
  LinkOutcome read(std::uint16_t address, std::span<std::uint16_t> out);
  // Function 23: writes, then reads, in one transaction. The whole answer has response_ms to come; one of
  // another transaction, shape or length, or with bytes after it, is kLost.
  LinkOutcome write_read(std::uint16_t write_address, std::span<const std::uint16_t> in,
                         std::uint16_t read_address, std::span<std::uint16_t> out);
  // Of the last failure.
  [[nodiscard]] const std::string& error() const { return error_; }

 private:
  LinkOutcome judge(int count, std::size_t wanted);
  LinkOutcome receive(std::span<std::uint16_t> out);
  LinkOutcome judge(std::span<const std::uint8_t> answer, std::span<std::uint16_t> out);
  LinkOutcome lost(int code);
  void* context_;  // modbus_t
  std::uint32_t response_ms_;
  std::uint16_t transaction_ = 0;  // of the last request of function 23
  bool connected_ = false;
  std::string error_;
};

}  // namespace hotblade::robot
