// One Modbus TCP connection of a client: libmodbus reduced to three outcomes.
//
// libmodbus frames requests, keeps the time and compares an answer's transaction, function and length with
// its request's. It does not look at the header's protocol, unit and length, nor at bytes after an answer,
// which the transaction of the next one shows. The CRC of IDENT and STATUS covers what such an answer
// carries.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace hotblade::robot {

// What became of an exchange.
enum class LinkOutcome {
  kOk,
  kException,  // the server refused the request; the connection is fine
  kLost,       // anything else: nothing is known about what the server did, the connection is closed
};

// Connects on request, and closes the connection on any loss.
class ModbusLink {
 public:
  // Does not connect yet. An answer that is not whole after response_ms is lost, however it trickles.
  ModbusLink(const std::string& host, std::uint16_t port, std::uint32_t response_ms);
  ~ModbusLink();
  ModbusLink(const ModbusLink&) = delete;
  ModbusLink& operator=(const ModbusLink&) = delete;

  // Closes the connection and makes a new one; returns false when that failed.
  bool connect();
  // Function 03: reads out.size() registers, at most 125.
  LinkOutcome read(std::uint16_t address, std::span<std::uint16_t> out);
  // Function 23: writes in.size() registers, at most 121, then reads out.size(), in one transaction.
  LinkOutcome write_read(std::uint16_t write_address, std::span<const std::uint16_t> in,
                         std::uint16_t read_address, std::span<std::uint16_t> out);
  // Returns why the last exchange or connect failed, in words.
  [[nodiscard]] const std::string& error() const { return error_; }

 private:
  LinkOutcome judge(int count, std::size_t wanted);
  void* context_;  // modbus_t
  bool connected_ = false;
  std::string error_;
};

}  // namespace hotblade::robot
