// A controller on the network: Modbus TCP with its own framing, one thread, nothing that blocks.
//
// A slow, silent, hostile or never-reading client delays the others by no more than one turn of work: a turn
// is at most 64 requests of one client, answers wait in a bounded buffer, and who does not fetch them is not
// read from.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "robot/controller/controller.hpp"

namespace hotblade::robot {

// A server that cannot be had, as `address:port: what: hint`.
struct ServerError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Where a server listens, to whom, and how patient it is.
struct ServerOptions {
  std::string address = "127.0.0.1";
  std::uint16_t port = 1502;         // 0: any free one
  std::vector<std::string> allow;    // peers that may connect besides this host's own
  std::size_t max_connections = 32;  // above it who never asked, or was silent longest, goes; never the owner
  std::uint32_t idle_ms = 60000;     // without a whole request
  std::uint32_t stalled_ms = 5000;   // with answers that are not fetched
};

// Serves one controller to many clients.
class ControllerServer {
 public:
  // Binds and listens. Throws ServerError. The controller must outlive the server and is its alone while it
  // runs.
  ControllerServer(const ServerOptions& options, Controller& controller);
  ~ControllerServer();
  ControllerServer(const ControllerServer&) = delete;
  ControllerServer& operator=(const ControllerServer&) = delete;

  // Returns the port that it listens on, the chosen one where 0 was asked for.
  [[nodiscard]] std::uint16_t port() const;
  // Serves until stop(), or until the controller is to start again (Controller::reboot_due).
  void run();
  // Makes run() return; may be called from any thread.
  void stop();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hotblade::robot
