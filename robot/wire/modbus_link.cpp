#include "robot/wire/modbus_link.hpp"

#include <fcntl.h>
#include <modbus.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/time.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <new>

#include "robot/wire/modbus_frame.hpp"

namespace hotblade::robot {
namespace {

modbus_t* context_of(void* context) {
  return static_cast<modbus_t*>(context);
}

constexpr std::uint8_t kReadWrite = 23, kException = 0x80;
constexpr std::size_t kMaxRead = 125, kMaxWrite = 121;  // registers, of function 23

void put16(std::uint8_t* out, std::size_t value) {
  out[0] = static_cast<std::uint8_t>(value >> 8);
  out[1] = static_cast<std::uint8_t>(value & 0xFF);
}
std::uint16_t get16(const std::uint8_t* in) {
  return static_cast<std::uint16_t>(in[0] << 8 | in[1]);
}

// libmodbus leaves its sockets non-blocking, which takes a select before each receive. One that blocks, for
// the time an answer may take, needs none.
bool make_blocking(int fd, std::uint32_t response_ms) {
  timeval timeout{};
  timeout.tv_sec = response_ms / 1000;
  timeout.tv_usec = response_ms % 1000 * 1000;
  const int flags = ::fcntl(fd, F_GETFL);
  return flags >= 0 && ::fcntl(fd, F_SETFL, flags & ~O_NONBLOCK) == 0 &&
         ::setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &timeout, sizeof timeout) == 0 &&
         ::setsockopt(fd, SOL_SOCKET, SO_SNDTIMEO, &timeout, sizeof timeout) == 0;
}

}  // namespace

ModbusLink::ModbusLink(const std::string& host, std::uint16_t port, std::uint32_t response_ms)
    : context_(modbus_new_tcp_pi(host.c_str(), std::to_string(port).c_str())), response_ms_(response_ms) {
  if (context_ == nullptr) throw std::bad_alloc();
  modbus_t* context = context_of(context_);
  modbus_set_response_timeout(context, response_ms / 1000, response_ms % 1000 * 1000);
  // Recovery by libmodbus would send requests again by itself: it stays off, we close and look at `accepted`.
  modbus_set_error_recovery(context, MODBUS_ERROR_RECOVERY_NONE);
}

ModbusLink::~ModbusLink() {
  modbus_close(context_of(context_));
  modbus_free(context_of(context_));
}

bool ModbusLink::connect() {
  modbus_close(context_of(context_));
  connected_ = modbus_connect(context_of(context_)) == 0 &&
               make_blocking(modbus_get_socket(context_of(context_)), response_ms_);
  if (!connected_) error_ = modbus_strerror(errno);
  return connected_;
}

LinkOutcome ModbusLink::read(std::uint16_t address, std::span<std::uint16_t> out) {
  if (!connected_) return LinkOutcome::kLost;
  return judge(modbus_read_registers(context_of(context_), address, static_cast<int>(out.size()), out.data()),
               out.size());
}

// One send and, mostly, one receive, where libmodbus takes three selects and three receives for an answer.
LinkOutcome ModbusLink::write_read(std::uint16_t write_address, std::span<const std::uint16_t> in,
                                   std::uint16_t read_address, std::span<std::uint16_t> out) {
  if (!connected_) return LinkOutcome::kLost;
  if (in.empty() || in.size() > kMaxWrite || out.empty() || out.size() > kMaxRead) return lost(EMBMDATA);
  constexpr std::size_t kHead = 10;  // function, two addresses and counts, number of bytes
  std::array<std::uint8_t, kMaxAduSize> request;
  put16(&request[0], ++transaction_);
  put16(&request[2], 0);
  put16(&request[4], 1 + kHead + 2 * in.size());
  request[6] = MODBUS_TCP_SLAVE;
  std::uint8_t* const pdu = request.data() + kMbapSize;
  pdu[0] = kReadWrite;
  put16(pdu + 1, read_address);
  put16(pdu + 3, out.size());
  put16(pdu + 5, write_address);
  put16(pdu + 7, in.size());
  pdu[9] = static_cast<std::uint8_t>(2 * in.size());
  for (std::size_t i = 0; i < in.size(); ++i) put16(pdu + kHead + 2 * i, in[i]);
  const std::size_t size = kMbapSize + kHead + 2 * in.size();
  const ssize_t sent = ::send(modbus_get_socket(context_of(context_)), request.data(), size, MSG_NOSIGNAL);
  if (sent != static_cast<ssize_t>(size)) return lost(sent < 0 ? errno : ETIMEDOUT);
  return receive(out);
}

LinkOutcome ModbusLink::receive(std::span<std::uint16_t> out) {
  using Clock = std::chrono::steady_clock;
  const int fd = modbus_get_socket(context_of(context_));
  const auto give_up = Clock::now() + std::chrono::milliseconds(response_ms_);
  std::array<std::uint8_t, kMaxAduSize> answer;
  for (std::size_t have = 0; have < answer.size();) {
    const ssize_t n = ::recv(fd, answer.data() + have, answer.size() - have, 0);
    if (n == 0) return lost(ECONNRESET);
    if (n < 0 && errno != EINTR) return lost(errno == EAGAIN ? ETIMEDOUT : errno);
    if (n > 0) have += static_cast<std::size_t>(n);
    const auto bytes = std::span<const std::uint8_t>(answer).first(have);
    const FrameHead head = frame_head(bytes);
    if (head.kind == FrameHead::Kind::kRequest && head.size == have) return judge(bytes, out);
    // Bytes nobody asked for are as bad as a length that cannot be.
    if (head.kind != FrameHead::Kind::kIncomplete) break;
    // Only a piece so far: the rest has what is left of the time.
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(give_up - Clock::now()).count();
    pollfd readable{fd, POLLIN, 0};
    if (left <= 0 || ::poll(&readable, 1, static_cast<int>(left)) == 0) return lost(ETIMEDOUT);
  }
  return lost(EMBBADDATA);
}

// A whole answer to the request of function 23.
LinkOutcome ModbusLink::judge(std::span<const std::uint8_t> answer, std::span<std::uint16_t> out) {
  const auto pdu = answer.subspan(kMbapSize);
  if (get16(answer.data()) != transaction_ || answer[kMbapSize - 1] != MODBUS_TCP_SLAVE)
    return lost(EMBBADDATA);
  if (pdu.size() == 2 && pdu[0] == (kReadWrite | kException) && pdu[1] > 0 && pdu[1] < MODBUS_EXCEPTION_MAX) {
    error_ = modbus_strerror(MODBUS_ENOBASE + pdu[1]);
    return LinkOutcome::kException;
  }
  const bool whole = pdu.size() == 2 + 2 * out.size() && pdu[0] == kReadWrite && pdu[1] == 2 * out.size();
  if (!whole) return lost(EMBBADDATA);
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = get16(&pdu[2 + 2 * i]);
  return LinkOutcome::kOk;
}

LinkOutcome ModbusLink::lost(int code) {
  error_ = modbus_strerror(code);
  modbus_close(context_of(context_));
  connected_ = false;
  return LinkOutcome::kLost;
}

LinkOutcome ModbusLink::judge(int count, std::size_t wanted) {
  if (count >= 0 && static_cast<std::size_t>(count) == wanted) return LinkOutcome::kOk;
  const int code = errno;
  if (count >= 0 || code < EMBXILFUN || code > EMBXGTAR) return lost(code);
  error_ = modbus_strerror(code);
  return LinkOutcome::kException;
}

}  // namespace hotblade::robot
