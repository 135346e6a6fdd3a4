#include "tests/robot/controller/fault_proxy.hpp"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <stdexcept>

namespace hotblade::robot::testing {
namespace {

sockaddr_in loopback(std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return address;
}

int connect_to(std::uint16_t port) {
  const int fd = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const auto address = loopback(port);
  if (::connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    ::close(fd);
    return -1;
  }
  const int one = 1;
  ::setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &one, sizeof one);
  return fd;
}

// Bytes that are there now or within the time; empty at the end of the connection.
std::vector<std::uint8_t> receive(int fd, int timeout_ms) {
  pollfd wanted{fd, POLLIN, 0};
  if (::poll(&wanted, 1, timeout_ms) <= 0) return {};
  std::vector<std::uint8_t> bytes(4096);
  const auto n = ::recv(fd, bytes.data(), bytes.size(), 0);
  bytes.resize(n > 0 ? static_cast<std::size_t>(n) : 0);
  return bytes;
}

void send_all(int fd, const std::vector<std::uint8_t>& bytes, std::size_t size) {
  ::send(fd, bytes.data(), size, MSG_NOSIGNAL);
}

constexpr int kAnswerTimeout_ms = 2000;

}  // namespace

FaultProxy::FaultProxy(std::uint16_t server_port, std::vector<LinkFault> faults, int count, int gap,
                       unsigned seed)
    : server_port_(server_port), faults_(std::move(faults)), left_(count), gap_(gap), random_(seed) {
  until_next_ = std::uniform_int_distribution(1, 2 * gap_)(random_);
  listen();
}

FaultProxy::FaultProxy(std::uint16_t server_port, double share, int late_ms, unsigned seed)
    : server_port_(server_port),
      faults_(std::begin(kEveryFault), std::end(kEveryFault)),
      left_(0),
      gap_(0),
      late_ms_(late_ms),
      share_(share),
      random_(seed) {
  listen();
}

void FaultProxy::listen() {
  listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  auto address = loopback(0);
  socklen_t size = sizeof address;
  if (listener_ < 0 || ::bind(listener_, reinterpret_cast<const sockaddr*>(&address), size) != 0 ||
      ::listen(listener_, 16) != 0 ||
      ::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size) != 0) {
    throw std::runtime_error("FaultProxy: no listening socket");
  }
  port_ = ntohs(address.sin_port);
  thread_ = std::thread([this] { run(); });
}

FaultProxy::~FaultProxy() {
  stop_ = true;
  thread_.join();
  deliver_late(true);
  ::close(listener_);
}

// Whether this request is to be spoilt.
bool FaultProxy::due() {
  if (share_ > 0) return std::uniform_real_distribution(0.0, 1.0)(random_) < share_;
  if (left_ <= 0 || --until_next_ > 0) return false;
  --left_;
  until_next_ = std::uniform_int_distribution(1, 2 * gap_)(random_);
  return true;
}

void FaultProxy::deliver_late(bool all) {
  const auto now = std::chrono::steady_clock::now();
  std::erase_if(late_, [&](const Late& late) {
    if (!all && now < late.due) return false;
    send_all(late.server, late.request, late.request.size());
    if (!all) receive(late.server, 20);
    ::close(late.server);
    return true;
  });
}

void FaultProxy::run() {
  while (!stop_) {
    deliver_late(false);
    pollfd wanted{listener_, POLLIN, 0};
    if (::poll(&wanted, 1, 20) <= 0) continue;
    const int client = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
    if (client >= 0) serve(client);
  }
}

void FaultProxy::serve(int client) {
  const int one = 1;
  ::setsockopt(client, IPPROTO_TCP, TCP_NODELAY, &one, sizeof one);
  const int server = connect_to(server_port_);
  while (server >= 0 && !stop_ && pass_request(client, server)) {
  }
  const bool lent = !late_.empty() && late_.back().server == server;
  if (server >= 0 && !lent) ::close(server);
  ::close(client);
}

// One request of a client that waits for every answer. False at the end of the connection.
bool FaultProxy::pass_request(int client, int server) {
  deliver_late(false);
  pollfd wanted{client, POLLIN, 0};
  if (::poll(&wanted, 1, 20) <= 0) return true;
  auto request = receive(client, 0);
  if (request.empty()) return false;
  if (due()) {
    const auto pick = std::uniform_int_distribution<std::size_t>(0, faults_.size() - 1)(random_);
    ++done_;
    return spoil(faults_[pick], client, server, request);
  }
  send_all(server, request, request.size());
  const auto answer = receive(server, kAnswerTimeout_ms);
  send_all(client, answer, answer.size());
  return !answer.empty();
}

bool FaultProxy::spoil(LinkFault fault, int client, int server, std::vector<std::uint8_t>& request) {
  if (fault == LinkFault::kCutBefore) return false;
  if (fault == LinkFault::kCutWithinRequest) {
    send_all(server, request, request.size() / 2);
    return false;
  }
  if (fault == LinkFault::kSwallowRequest) return true;
  const auto late = std::chrono::milliseconds(late_ms_);
  if (fault == LinkFault::kLateRequest) {
    late_.push_back({server, request, std::chrono::steady_clock::now() + late});
    return false;
  }
  const auto spoil_a_byte = [&](std::vector<std::uint8_t>& bytes) {
    if (bytes.empty()) return;
    const auto at = std::uniform_int_distribution<std::size_t>(0, bytes.size() - 1)(random_);
    bytes[at] = static_cast<std::uint8_t>(bytes[at] + std::uniform_int_distribution(1, 255)(random_));
  };
  if (fault == LinkFault::kSpoilRequest) spoil_a_byte(request);
  if (fault == LinkFault::kStall) std::this_thread::sleep_for(2 * late);
  send_all(server, request, request.size());
  if (fault == LinkFault::kRepeatRequest) send_all(server, request, request.size());
  // Half a request that looks whole is waited for by both sides.
  auto answer = receive(server, fault == LinkFault::kSpoilRequest ? late_ms_ : kAnswerTimeout_ms);
  switch (fault) {
    case LinkFault::kCutWithinAnswer:
      send_all(client, answer, answer.size() / 2);
      return false;
    case LinkFault::kSwallowAnswer:
      return true;
    case LinkFault::kLateAnswer:
      std::this_thread::sleep_for(late);
      send_all(client, answer, answer.size());
      return true;
    case LinkFault::kRepeatAnswer:
      send_all(client, answer, answer.size());
      send_all(client, answer, answer.size());
      return true;
    case LinkFault::kSpoilAnswer:
      spoil_a_byte(answer);
      send_all(client, answer, answer.size());
      return true;
    case LinkFault::kSpoilRequest:
    case LinkFault::kRepeatRequest:
    case LinkFault::kStall:
      send_all(client, answer, answer.size());
      return !answer.empty();
    default:
      return false;
  }
}

}  // namespace hotblade::robot::testing
