// Waypoints a second over Modbus TCP on loopback: a bare libmodbus client and server that exchange the same
// blocks and do nothing with them, and a job streamed to the controller, in one run.
#include <benchmark/benchmark.h>
#include <modbus.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <thread>

#include "robot/client/client.hpp"
#include "robot/controller/controller.hpp"
#include "robot/controller/execution_log.hpp"
#include "robot/controller/server.hpp"
#include "tests/robot/wire/sample_job.hpp"

namespace hotblade::robot {
namespace {

constexpr std::uint32_t kWaypoints = 20000;

// libmodbus on both ends, as its manual shows a server.
class BareServer {
 public:
  BareServer() : context_(modbus_new_tcp("127.0.0.1", 0)), mapping_(modbus_mapping_new(0, 0, 1024, 0)) {
    listener_ = modbus_tcp_listen(context_, 1);
    sockaddr_in address{};
    socklen_t size = sizeof address;
    if (listener_ < 0 || ::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size) != 0)
      throw std::runtime_error("BareServer: no listening socket");
    port_ = ntohs(address.sin_port);
    thread_ = std::thread([this] {
      std::array<std::uint8_t, MODBUS_TCP_MAX_ADU_LENGTH> query{};
      modbus_tcp_accept(context_, &listener_);
      for (int n = 0; (n = modbus_receive(context_, query.data())) >= 0;) {
        modbus_reply(context_, query.data(), n, mapping_);
      }
    });
  }
  // Its client has to be gone.
  ~BareServer() {
    thread_.join();
    ::close(listener_);
    modbus_mapping_free(mapping_);
    modbus_free(context_);
  }
  BareServer(const BareServer&) = delete;
  BareServer& operator=(const BareServer&) = delete;
  [[nodiscard]] std::uint16_t port() const { return port_; }

 private:
  modbus_t* context_;
  modbus_mapping_t* mapping_;
  int listener_ = -1;
  std::uint16_t port_ = 0;
  std::thread thread_;
};

void count(benchmark::State& state, std::uint32_t waypoints) {
  state.counters["waypoints/s"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * waypoints, benchmark::Counter::kIsRate);
}

void StreamBareModbus(benchmark::State& state) {
  const BareServer server;
  const std::unique_ptr<modbus_t, void (*)(modbus_t*)> client(modbus_new_tcp("127.0.0.1", server.port()),
                                                              [](modbus_t* context) {
                                                                modbus_close(context);
                                                                modbus_free(context);
                                                              });
  if (!client || modbus_connect(client.get()) != 0) return state.SkipWithError("no connection");
  const Job job = testing::sample_job(4);
  const auto window = protocol::encode_window(1, 0, false, job.raw);
  const auto words = window.span();
  std::array<std::uint16_t, protocol::kStatusSize> status{};
  for (auto _ : state) {
    for (std::uint32_t k = 0; k < kWaypoints; k += 4) {
      const int read =
          modbus_write_and_read_registers(client.get(), protocol::kWindowBase, static_cast<int>(words.size()),
                                          words.data(), protocol::kStatusBase, status.size(), status.data());
      if (read != static_cast<int>(status.size())) return state.SkipWithError("no answer");
    }
  }
  count(state, kWaypoints);
}

enum class Blade { kUnchecked, kChecked };

void stream_job(benchmark::State& state, ExecutionSink* sink, Blade blade) {
  ControllerOptions options;
  options.blade.equilibrium = blade == Blade::kChecked;
  options.time_scale = kAsFastAsDataComes;
  Controller controller(options, sink);
  ServerOptions server_options;
  server_options.port = 0;
  ControllerServer server(server_options, controller);
  std::thread thread([&] { server.run(); });
  const Job job = testing::sample_job(kWaypoints);
  StreamOptions stream_options;
  stream_options.port = server.port();
  stream_options.poll_ms = 1;
  for (auto _ : state) {
    const auto report = stream(job, stream_options);
    if (report.outcome != StreamOutcome::kDone) state.SkipWithError(report.message.c_str());
  }
  server.stop();
  thread.join();
  count(state, kWaypoints);
}

void stream_logged_job(benchmark::State& state, Blade blade) {
  const auto file = std::filesystem::temp_directory_path() / ("hotblade_bench_" + std::to_string(::getpid()));
  {
    ExecutionLog log(file, {});
    stream_job(state, &log, blade);
  }
  std::filesystem::remove(file);
}

void StreamJob(benchmark::State& state) {
  stream_job(state, nullptr, Blade::kUnchecked);
}

// With the log, written and synced, and a pose every 10 ms of motion: five a waypoint.
void StreamJobLogged(benchmark::State& state) {
  stream_logged_job(state, Blade::kUnchecked);
}

// With every check, the blade's equilibrium among them.
void StreamJobWithBlade(benchmark::State& state) {
  stream_job(state, nullptr, Blade::kChecked);
}

void StreamJobWithBladeLogged(benchmark::State& state) {
  stream_logged_job(state, Blade::kChecked);
}

BENCHMARK(StreamBareModbus)->MeasureProcessCPUTime()->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK(StreamJob)->MeasureProcessCPUTime()->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK(StreamJobLogged)->MeasureProcessCPUTime()->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK(StreamJobWithBlade)->MeasureProcessCPUTime()->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK(StreamJobWithBladeLogged)->MeasureProcessCPUTime()->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace hotblade::robot
