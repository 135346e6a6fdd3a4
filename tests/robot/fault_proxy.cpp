#include "tests/robot/fault_proxy.hpp"

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
  listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  auto address = loopback(0);
  socklen_t size = sizeof address;
  if (listener_ < 0 || ::bind(listener_, reinterpret_cast<const sockaddr*>(&address), size) != 0 ||
      ::listen(listener_, 16) != 0 ||
      ::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size) != 0) {
    throw std::runtime_error("FaultProxy: no listening socket");
  }
  port_ = ntohs(address.sin_port);
  until_next_ = std::uniform_int_distribution(1, 2 * gap_)(random_);
  thread_ = std::thread([this] { run(); });
}

FaultProxy::~FaultProxy() {
  stop_ = true;
  thread_.join();
  ::close(listener_);
}

void FaultProxy::run() {
  while (!stop_) {
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
  if (server >= 0) ::close(server);
  ::close(client);
}

// One request of a client that waits for every answer. False at the end of the connection.
bool FaultProxy::pass_request(int client, int server) {
  pollfd wanted{client, POLLIN, 0};
  if (::poll(&wanted, 1, 20) <= 0) return true;
  auto request = receive(client, 0);
  if (request.empty()) return false;
  if (left_ > 0 && --until_next_ <= 0) {
    --left_;
    until_next_ = std::uniform_int_distribution(1, 2 * gap_)(random_);
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
  send_all(server, request, request.size());
  const auto answer = receive(server, kAnswerTimeout_ms);
  switch (fault) {
    case LinkFault::kCutWithinAnswer:
      send_all(client, answer, answer.size() / 2);
      return false;
    case LinkFault::kSwallowAnswer:
      return true;
    case LinkFault::kLateAnswer:
      std::this_thread::sleep_for(std::chrono::milliseconds(150));
      send_all(client, answer, answer.size());
      return true;
    case LinkFault::kRepeatAnswer:
      send_all(client, answer, answer.size());
      send_all(client, answer, answer.size());
      return true;
    default:
      return false;
  }
}

}  // namespace hotblade::robot::testing
