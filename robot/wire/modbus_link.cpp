#include "robot/wire/modbus_link.hpp"

#include <modbus.h>

#include <cerrno>
#include <new>

namespace hotblade::robot {
namespace {

modbus_t* context_of(void* context) {
  return static_cast<modbus_t*>(context);
}

}  // namespace

ModbusLink::ModbusLink(const std::string& host, std::uint16_t port, std::uint32_t response_ms)
    : context_(modbus_new_tcp_pi(host.c_str(), std::to_string(port).c_str())) {
  if (context_ == nullptr) throw std::bad_alloc();
  modbus_t* context = context_of(context_);
  modbus_set_response_timeout(context, response_ms / 1000, response_ms % 1000 * 1000);
  // Without a time between two bytes the response timeout holds for the whole answer, however it trickles.
  modbus_set_byte_timeout(context, 0, 0);
  // Recovery by libmodbus would send requests again by itself: it stays off, we close and look at `accepted`.
  modbus_set_error_recovery(context, MODBUS_ERROR_RECOVERY_NONE);
}

ModbusLink::~ModbusLink() {
  modbus_close(context_of(context_));
  modbus_free(context_of(context_));
}

bool ModbusLink::connect() {
  modbus_close(context_of(context_));
  connected_ = modbus_connect(context_of(context_)) == 0;
  if (!connected_) error_ = modbus_strerror(errno);
  return connected_;
}

LinkOutcome ModbusLink::read(std::uint16_t address, std::span<std::uint16_t> out) {
  if (!connected_) return LinkOutcome::kLost;
  return judge(modbus_read_registers(context_of(context_), address, static_cast<int>(out.size()), out.data()),
               out.size());
}

LinkOutcome ModbusLink::write_read(std::uint16_t write_address, std::span<const std::uint16_t> in,
                                   std::uint16_t read_address, std::span<std::uint16_t> out) {
  if (!connected_) return LinkOutcome::kLost;
  const int count =
      modbus_write_and_read_registers(context_of(context_), write_address, static_cast<int>(in.size()),
                                      in.data(), read_address, static_cast<int>(out.size()), out.data());
  return judge(count, out.size());
}

LinkOutcome ModbusLink::judge(int count, std::size_t wanted) {
  if (count >= 0 && static_cast<std::size_t>(count) == wanted) return LinkOutcome::kOk;
  const int code = count >= 0 ? EMBBADDATA : errno;
  error_ = modbus_strerror(code);
  if (code >= EMBXILFUN && code <= EMBXGTAR) return LinkOutcome::kException;
  modbus_close(context_of(context_));
  connected_ = false;
  return LinkOutcome::kLost;
}

}  // namespace hotblade::robot
