#include "robot/controller/server.hpp"

#define ASIO_STANDALONE
#define ASIO_NO_DEPRECATED
#include <asio.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <list>
#include <utility>

#include "robot/controller/register_map.hpp"

namespace hotblade::robot {
namespace {

using Tcp = asio::ip::tcp;
using Clock = std::chrono::steady_clock;

constexpr auto kTick = std::chrono::milliseconds(5);
constexpr auto kRetryAccept = std::chrono::milliseconds(100);
constexpr int kRequestsPerTurn = 64;
constexpr std::size_t kInBytes = 4096;
constexpr std::size_t kOutBytes = 32768;

}  // namespace

class ControllerServer::Impl {
 public:
  Impl(const ServerOptions& options, Controller& controller)
      : options_(options),
        controller_(controller),
        map_(controller),
        acceptor_(io_),
        timer_(io_),
        retry_(io_) {
    bind();
  }

  [[nodiscard]] std::uint16_t port() const { return acceptor_.local_endpoint().port(); }
  void run() {
    accept();
    tick();
    io_.run();
    controller_.commit();
  }
  void stop() { io_.stop(); }

 private:
  class Session;

  void bind();
  void accept();
  void welcome(Tcp::socket socket);
  [[nodiscard]] bool allowed(const asio::ip::address& peer) const;
  void make_room();
  void tick();
  void evict();
  [[nodiscard]] std::uint64_t now_us() const {
    return static_cast<std::uint64_t>(
        std::chrono::duration_cast<std::chrono::microseconds>(Clock::now() - boot_).count());
  }

  ServerOptions options_;
  Controller& controller_;
  RegisterMap map_;
  asio::io_context io_{1};
  Tcp::acceptor acceptor_;
  asio::steady_timer timer_, retry_;
  std::list<std::shared_ptr<Session>> sessions_;
  Controller::Connection next_connection_ = 1;
  Clock::time_point boot_ = Clock::now();
};

// One connection. Reads while its answers find room, so a client that never fetches them only stops itself.
class ControllerServer::Impl::Session : public std::enable_shared_from_this<Session> {
 public:
  Session(Impl& server, Tcp::socket socket, Controller::Connection number)
      : server_(server), socket_(std::move(socket)), number_(number), last_request_us_(server.now_us()) {
    out_.reserve(kOutBytes);
    sending_.reserve(kOutBytes);
    asio::error_code ignored;
    socket_.non_blocking(true, ignored);
  }

  void start() { read(); }
  [[nodiscard]] bool closed() const { return !socket_.is_open(); }
  [[nodiscard]] Controller::Connection number() const { return number_; }
  // What goes first when there is no room: who never asked anything, then who has been silent longest.
  [[nodiscard]] std::pair<bool, std::uint64_t> standing() const { return {asked_, last_request_us_}; }
  [[nodiscard]] bool overdue(std::uint64_t now_us, const ServerOptions& o) const {
    const bool stalled = !sending_.empty() && now_us - sending_since_us_ > std::uint64_t{o.stalled_ms} * 1000;
    return stalled || now_us - last_request_us_ > std::uint64_t{o.idle_ms} * 1000;
  }
  void close() {
    asio::error_code ignored;
    socket_.close(ignored);
  }

 private:
  void read() {
    if (reading_ || hung_up_ || closed() || in_size_ == in_.size()) return;
    reading_ = true;
    // Not async_wait: that sets the event up anew each time, which costs more than a read that finds nothing.
    socket_.async_read_some(asio::buffer(in_.data() + in_size_, in_.size() - in_size_),
                            [self = this->shared_from_this()](asio::error_code error, std::size_t n) {
                              self->reading_ = false;
                              if (self->closed()) return;
                              if (error) return self->hang_up();
                              self->in_size_ += n;
                              self->work();
                            });
  }

  // The client sends no more; what it asked before is still answered.
  void hang_up() {
    hung_up_ = true;
    if (sending_.empty() && out_.empty()) close();
  }

  // One turn: the requests at hand, up to a limit, then the others' turn.
  void work() {
    std::size_t used = 0;
    bool more = false;
    for (int handled = 0; !closed(); ++handled) {
      const auto rest = std::span<const std::uint8_t>(in_).subspan(used, in_size_ - used);
      const FrameHead head = frame_head(rest);
      if (head.kind == FrameHead::Kind::kIncomplete) break;
      if (head.kind == FrameHead::Kind::kBroken) return close();
      if (handled == kRequestsPerTurn || out_.size() + kMaxAduSize > kOutBytes) {
        more = true;
        break;
      }
      if (head.kind == FrameHead::Kind::kRequest) answer(rest.first(head.size));
      used += head.size;
    }
    std::copy(in_.begin() + static_cast<std::ptrdiff_t>(used),
              in_.begin() + static_cast<std::ptrdiff_t>(in_size_), in_.begin());
    in_size_ -= used;
    if (server_.controller_.commit_due()) server_.controller_.commit();
    send();
    if (!more) return read();
    // With no room for answers the end of the sending goes on; otherwise another turn, after the others'.
    if (out_.size() + kMaxAduSize <= kOutBytes) {
      asio::post(socket_.get_executor(), [self = this->shared_from_this()] { self->work(); });
    }
  }

  void answer(std::span<const std::uint8_t> request) {
    last_request_us_ = server_.now_us();
    asked_ = true;
    const Reply reply = server_.map_.handle(request, number_, last_request_us_);
    out_.insert(out_.end(), reply.span().begin(), reply.span().end());
  }

  void send() {
    if (!sending_.empty() || out_.empty() || closed()) return;
    // Mostly there is room for everything at once.
    asio::error_code error;
    const std::size_t n = socket_.write_some(asio::buffer(out_), error);
    if (error && error != asio::error::would_block) return close();
    if (n == out_.size()) return out_.clear();
    out_.erase(out_.begin(), out_.begin() + static_cast<std::ptrdiff_t>(n));
    sending_.swap(out_);
    sending_since_us_ = server_.now_us();
    asio::async_write(socket_, asio::buffer(sending_),
                      [self = this->shared_from_this()](asio::error_code failed, std::size_t) {
                        if (failed) return self->close();
                        self->sending_.clear();
                        const bool was_full = self->out_.size() + kMaxAduSize > kOutBytes;
                        self->send();
                        if (self->hung_up_) return self->hang_up();
                        if (was_full) self->work();
                      });
  }

  Impl& server_;
  Tcp::socket socket_;
  Controller::Connection number_;
  std::uint64_t last_request_us_, sending_since_us_ = 0;
  std::array<std::uint8_t, kInBytes> in_{};
  std::size_t in_size_ = 0;
  bool reading_ = false, hung_up_ = false, asked_ = false;
  std::vector<std::uint8_t> out_, sending_;
};

void ControllerServer::Impl::bind() {
  const std::string place = options_.address + ":" + std::to_string(options_.port);
  asio::error_code error;
  const auto address = asio::ip::make_address(options_.address, error);
  if (error) throw ServerError(place + ": not an IP address: use one such as 127.0.0.1");
  if (!address.is_loopback() && options_.allow.empty()) {
    throw ServerError(place + ": would be open to the whole network: name the peers with --allow");
  }
  for (const std::string& peer : options_.allow) {
    asio::ip::make_address(peer, error);
    if (error) throw ServerError(peer + ": not an IP address: --allow takes addresses");
  }
  const Tcp::endpoint endpoint(address, options_.port);
  acceptor_.open(endpoint.protocol(), error);
  if (!error) acceptor_.set_option(Tcp::acceptor::reuse_address(true), error);
  if (!error) acceptor_.bind(endpoint, error);
  if (!error) acceptor_.listen(asio::socket_base::max_listen_connections, error);
  if (error)
    throw ServerError(place + ": cannot listen (" + error.message() + "): choose another address or port");
}

void ControllerServer::Impl::accept() {
  acceptor_.async_accept([this](asio::error_code error, Tcp::socket socket) {
    if (error) {  // out of descriptors, mostly: later there may be some
      retry_.expires_after(kRetryAccept);
      retry_.async_wait([this](asio::error_code) { accept(); });
      return;
    }
    welcome(std::move(socket));
    accept();
  });
}

void ControllerServer::Impl::welcome(Tcp::socket socket) {
  asio::error_code error;
  const auto peer = socket.remote_endpoint(error);
  if (error || !allowed(peer.address())) return;
  socket.set_option(Tcp::no_delay(true), error);
  make_room();
  sessions_.push_back(std::make_shared<Session>(*this, std::move(socket), next_connection_++));
  sessions_.back()->start();
}

bool ControllerServer::Impl::allowed(const asio::ip::address& peer) const {
  const bool mapped = peer.is_v6() && peer.to_v6().is_v4_mapped();
  const asio::ip::address plain =
      mapped ? asio::ip::make_address_v4(asio::ip::v4_mapped, peer.to_v6()) : peer;
  if (plain.is_loopback()) return true;
  return std::any_of(options_.allow.begin(), options_.allow.end(), [&](const std::string& allowed_peer) {
    return asio::ip::make_address(allowed_peer) == plain;
  });
}

void ControllerServer::Impl::make_room() {
  sessions_.remove_if([](const auto& session) { return session->closed(); });
  while (sessions_.size() >= options_.max_connections) {
    auto oldest = sessions_.end();
    for (auto it = sessions_.begin(); it != sessions_.end(); ++it) {
      if ((*it)->number() == controller_.owner()) continue;
      if (oldest == sessions_.end() || (*it)->standing() < (*oldest)->standing()) oldest = it;
    }
    if (oldest == sessions_.end()) return;
    (*oldest)->close();
    sessions_.erase(oldest);
  }
}

void ControllerServer::Impl::tick() {
  controller_.tick(now_us());
  controller_.commit();
  if (controller_.reboot_due()) return io_.stop();
  evict();
  timer_.expires_after(kTick);
  timer_.async_wait([this](asio::error_code error) {
    if (!error) tick();
  });
}

void ControllerServer::Impl::evict() {
  const std::uint64_t now = now_us();
  for (const auto& session : sessions_) {
    if (session->overdue(now, options_)) session->close();
  }
  sessions_.remove_if([](const auto& session) { return session->closed(); });
}

ControllerServer::ControllerServer(const ServerOptions& options, Controller& controller)
    : impl_(std::make_unique<Impl>(options, controller)) {}
ControllerServer::~ControllerServer() = default;
std::uint16_t ControllerServer::port() const {
  return impl_->port();
}
void ControllerServer::run() {
  impl_->run();
}
void ControllerServer::stop() {
  impl_->stop();
}

}  // namespace hotblade::robot
