// A TCP proxy between client and controller that spoils requests, at moments drawn from a seed.
#pragma once

#include <atomic>
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
};

class FaultProxy {
 public:
  // After `gap` requests on average, up to 2 * gap, one of the faults, `count` times in all. Throws on socket
  // errors.
  FaultProxy(std::uint16_t server_port, std::vector<LinkFault> faults, int count, int gap, unsigned seed);
  ~FaultProxy();
  FaultProxy(const FaultProxy&) = delete;
  FaultProxy& operator=(const FaultProxy&) = delete;

  [[nodiscard]] std::uint16_t port() const { return port_; }
  [[nodiscard]] int faults_done() const { return done_; }

 private:
  void run();
  void serve(int client);
  bool pass_request(int client, int server);
  bool spoil(LinkFault fault, int client, int server, std::vector<std::uint8_t>& request);

  std::uint16_t server_port_, port_ = 0;
  std::vector<LinkFault> faults_;
  int left_, gap_, until_next_ = 0;
  std::mt19937 random_;
  int listener_ = -1;
  std::atomic<int> done_ = 0;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

}  // namespace hotblade::robot::testing
