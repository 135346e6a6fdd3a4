// A controller of a test: `hotblade sim` on a port of its own, with its log.
#pragma once

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "robot/client/client.hpp"
#include "robot/wire/modbus_link.hpp"
#include "tests/pipeline/run_program.hpp"
#include "tests/pipeline/temporary_directory.hpp"

namespace hotblade::pipeline::testing {

// A port that stays free while the controller is dead: below those that are given to connections.
inline std::uint16_t free_port() {
  static std::atomic<unsigned> tried = 0;
  constexpr unsigned kFirst = 12000, kPorts = 20000, kApart = 131;
  for (;;) {
    const unsigned place = static_cast<unsigned>(::getpid()) * kApart + tried++;
    const auto port = static_cast<std::uint16_t>(kFirst + place % kPorts);
    const int fd = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(port);
    const bool free = ::bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
    ::close(fd);
    if (free) return port;
  }
}

class SimulatedCell {
 public:
  // Starts the controller, or kills it and starts it again, with options of `hotblade sim`. Throws
  // std::runtime_error when it does not answer.
  void start(const std::vector<std::string>& options) {
    options_ = options;
    restart();
  }
  void restart() {
    kill();
    std::vector<std::string> words{"sim", "--listen", place()};
    words.insert(words.end(), options_.begin(), options_.end());
    process_ = std::make_unique<Process>(words);
    if (!until([](const robot::ControllerSnapshot& now) { return now.reached; }))
      throw std::runtime_error("the simulator does not answer: " + process_->stop().err);
  }
  void kill() { process_.reset(); }
  // Ended as by an operator: SIGTERM.
  Ended stop() { return process_->stop(); }

  [[nodiscard]] pid_t pid() const { return process_->pid(); }
  // Whether the text is on its stderr by now.
  [[nodiscard]] bool said(const std::string& text) const { return process_->printed_to_stderr(text); }
  [[nodiscard]] std::uint16_t port() const { return port_; }
  [[nodiscard]] std::string place() const { return "127.0.0.1:" + std::to_string(port_); }
  [[nodiscard]] robot::ControllerSnapshot now() const {
    robot::StreamOptions options;
    options.port = port_;
    return robot::look(options);
  }

  // Waits for a condition on now(); false when it does not come in 20 s.
  template <typename Condition>
  bool until(Condition condition) const {
    const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (!condition(now())) {
      if (std::chrono::steady_clock::now() > patience) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return true;
  }

  // As a hand on the emergency stop.
  void estop() const {
    robot::ModbusLink link("127.0.0.1", port_, 500);
    const std::vector<std::uint16_t> pressed{1};
    std::array<std::uint16_t, robot::protocol::kStatusSize> status{};
    const bool done =
        link.connect() && link.write_read(robot::protocol::kEstopBase, pressed, robot::protocol::kStatusBase,
                                          status) == robot::LinkOutcome::kOk;
    if (!done) throw std::runtime_error("ESTOP is not answered: " + link.error());
  }

 private:
  std::uint16_t port_ = free_port();
  std::vector<std::string> options_;
  std::unique_ptr<Process> process_;
};

// Returns how many lines of an event a log has.
inline int events(const std::filesystem::path& log, const std::string& event) {
  const std::string text = read_bytes(log);
  const std::string wanted = "{\"ev\":\"" + event + "\"";
  int found = 0;
  for (auto at = text.find(wanted); at != std::string::npos; at = text.find(wanted, at + 1)) ++found;
  return found;
}

}  // namespace hotblade::pipeline::testing
