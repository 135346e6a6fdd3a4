// A TCP proxy between client and controller that spoils requests, at moments drawn from a seed.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <random>
#include <thread>
#include <vector>

namespace hotblade::robot::testing {

enum class LinkFault {
  kCutBefore,         // the request never arrives, the connection is closed
  kCutWithinRequest,  // half of the request arrives
  kCutAfter,          // the request is carried out, its answer lost with the connection
  kCutWithinAnswer,   // half of the answer arrives
  kSwallowAnswer,     // the request is carried out, no answer comes, the connection stays
  kLateAnswer,        // the answer comes after the client has given up
  kRepeatAnswer,      // the answer comes twice
  kSwallowRequest,    // the request never arrives, the connection stays
  kLateRequest,       // the request arrives when the client has given up and connected anew
  kRepeatRequest,     // the request arrives twice
  kSpoilRequest,      // a byte of the request is another one
  kSpoilAnswer,       // a byte of the answer is another one
  kStall,             // nothing passes for a while, then everything
};
inline constexpr LinkFault kEveryFault[] = {LinkFault::kCutBefore,     LinkFault::kCutWithinRequest,
                                            LinkFault::kCutAfter,      LinkFault::kCutWithinAnswer,
                                            LinkFault::kSwallowAnswer, LinkFault::kLateAnswer,
                                            LinkFault::kRepeatAnswer,  LinkFault::kSwallowRequest,
                                            LinkFault::kLateRequest,   LinkFault::kRepeatRequest,
                                            LinkFault::kSpoilRequest,  LinkFault::kSpoilAnswer,
                                            LinkFault::kStall};

class FaultProxy {
 public:
  // After `gap` requests on average, up to 2 * gap, one of the faults, `count` times in all. Throws on socket
  // errors.
  FaultProxy(std::uint16_t server_port, std::vector<LinkFault> faults, int count, int gap, unsigned seed);
  // Every fault there is, on this share of the requests, for as long as the proxy lives. What is late comes
  // `late_ms` later.
  FaultProxy(std::uint16_t server_port, double share, int late_ms, unsigned seed);
  ~FaultProxy();
  FaultProxy(const FaultProxy&) = delete;
  FaultProxy& operator=(const FaultProxy&) = delete;

  [[nodiscard]] std::uint16_t port() const { return port_; }
  [[nodiscard]] int faults_done() const { return done_; }

 private:
  // A request that waits for its time on a connection of its own.
  struct Late {
    int server;
    std::vector<std::uint8_t> request;
    std::chrono::steady_clock::time_point due;
  };
  void listen();
  void run();
  [[nodiscard]] bool due();
  void deliver_late(bool all);
  void serve(int client);
  bool pass_request(int client, int server);
  bool spoil(LinkFault fault, int client, int server, std::vector<std::uint8_t>& request);

  std::uint16_t server_port_, port_ = 0;
  std::vector<LinkFault> faults_;
  int left_, gap_, until_next_ = 0, late_ms_ = 150;
  double share_ = 0;
  std::vector<Late> late_;
  std::mt19937 random_;
  int listener_ = -1;
  std::atomic<int> done_ = 0;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

}  // namespace hotblade::robot::testing
