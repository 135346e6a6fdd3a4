// Function 23 of ModbusLink against a peer that answers what a test tells it to: which promises libmodbus
// keeps.
#include "robot/wire/modbus_link.hpp"

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <functional>
#include <optional>
#include <stdexcept>
#include <thread>

#include "tests/robot/controller/raw_client.hpp"

namespace hotblade::robot {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;
using testing::Bytes;

constexpr std::uint32_t kLinkResponse_ms = 200;
constexpr std::array<std::uint16_t, 3> kWritten{0x1234, 0xABCD, 7};
constexpr std::array<std::uint16_t, 2> kRead{0xCAFE, 0x0102};

// Takes one request on one connection, then does what the script says with the socket.
class ScriptedPeer {
 public:
  using Script = std::function<void(int fd, const Bytes& request)>;
  explicit ScriptedPeer(Script script) : listener_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    auto* const generic = reinterpret_cast<sockaddr*>(&address);
    if (::bind(listener_, generic, size) != 0 || ::listen(listener_, 1) != 0 ||
        ::getsockname(listener_, generic, &size) != 0)
      throw std::runtime_error("ScriptedPeer: no listening socket");
    port_ = ntohs(address.sin_port);
    thread_ = std::thread([this, script = std::move(script)] { serve(script); });
  }
  ~ScriptedPeer() {
    thread_.join();
    ::close(listener_);
  }
  ScriptedPeer(const ScriptedPeer&) = delete;
  ScriptedPeer& operator=(const ScriptedPeer&) = delete;
  [[nodiscard]] std::uint16_t port() const { return port_; }

 private:
  void serve(const Script& script) const {
    const int fd = ::accept(listener_, nullptr, nullptr);
    Bytes request(300);
    const ssize_t n = ::recv(fd, request.data(), request.size(), 0);
    request.resize(n > 0 ? static_cast<std::size_t>(n) : 0);
    script(fd, request);
    // Until the client has gone.
    std::array<char, 64> rest{};
    while (::recv(fd, rest.data(), rest.size(), 0) > 0) {
    }
    ::close(fd);
  }

  int listener_;
  std::uint16_t port_ = 0;
  std::thread thread_;
};

void send(int fd, std::span<const std::uint8_t> bytes) {
  ::send(fd, bytes.data(), bytes.size(), MSG_NOSIGNAL);
}

// Answers with a PDU under the transaction of the request.
Bytes answer_to(const Bytes& request, const Bytes& pdu, unsigned unit = 255) {
  return testing::request(static_cast<unsigned>(request[0] << 8 | request[1]), pdu, unit);
}

const Bytes kGoodPdu{23, 4, 0xCA, 0xFE, 0x01, 0x02};

struct Exchange {
  LinkOutcome outcome;
  std::array<std::uint16_t, 2> read;
  std::string error;
};

Exchange exchange(const ScriptedPeer& peer) {
  ModbusLink link("127.0.0.1", peer.port(), kLinkResponse_ms);
  Exchange result{LinkOutcome::kLost, {}, {}};
  if (!link.connect()) return result;
  result.outcome = link.write_read(0x200, kWritten, 0x40, result.read);
  result.error = link.error();
  return result;
}

LinkOutcome outcome_of(const std::function<Bytes(const Bytes& request)>& answer) {
  const ScriptedPeer peer([&](int fd, const Bytes& request) { send(fd, answer(request)); });
  return exchange(peer).outcome;
}

TEST(ModbusLink, Function23IsSentAsTheSpecificationHasIt) {
  Bytes sent;
  {
    const ScriptedPeer peer([&](int fd, const Bytes& request) {
      sent = request;
      send(fd, answer_to(request, kGoodPdu));
    });
    const Exchange got = exchange(peer);
    EXPECT_EQ(got.outcome, LinkOutcome::kOk);
    EXPECT_EQ(got.read, kRead);
  }
  const Bytes pdu{23, 0, 0x40, 0, 2, 2, 0, 0, 3, 6, 0x12, 0x34, 0xAB, 0xCD, 0, 7};
  EXPECT_EQ(sent, answer_to(sent, pdu));
}

TEST(ModbusLink, AnAnswerInPiecesIsPutTogether) {
  const ScriptedPeer peer([](int fd, const Bytes& request) {
    const Bytes answer = answer_to(request, kGoodPdu);
    for (std::size_t i = 0; i < answer.size(); i += 5) {
      send(fd, std::span(answer).subspan(i, std::min<std::size_t>(5, answer.size() - i)));
      std::this_thread::sleep_for(milliseconds(1));
    }
  });
  const Exchange got = exchange(peer);
  EXPECT_EQ(got.outcome, LinkOutcome::kOk);
  EXPECT_EQ(got.read, kRead);
}

TEST(ModbusLink, ARefusalIsAnExceptionAndTheConnectionStays) {
  const ScriptedPeer peer([](int fd, const Bytes& request) {
    send(fd, answer_to(request, {23 | 0x80, 2}));
    Bytes again(300);
    if (::recv(fd, again.data(), again.size(), 0) > 0) send(fd, answer_to(again, kGoodPdu));
  });
  ModbusLink link("127.0.0.1", peer.port(), kLinkResponse_ms);
  ASSERT_TRUE(link.connect());
  std::array<std::uint16_t, 2> read{};
  EXPECT_EQ(link.write_read(0x200, kWritten, 0x40, read), LinkOutcome::kException);
  EXPECT_EQ(link.error(), "Illegal data address");
  EXPECT_EQ(link.write_read(0x200, kWritten, 0x40, read), LinkOutcome::kOk);
  EXPECT_EQ(read, kRead);
}

TEST(ModbusLink, AnAnswerToSomethingElseIsALostLink) {
  EXPECT_EQ(outcome_of([](const Bytes& request) {
              Bytes other = answer_to(request, kGoodPdu);
              ++other[1];  // another transaction
              return other;
            }),
            LinkOutcome::kLost);
  for (const Bytes& pdu : {Bytes{3, 4, 0xCA, 0xFE, 1, 2}, Bytes{23, 2, 0xCA, 0xFE}, Bytes{23, 4, 0xCA, 0xFE},
                           Bytes{23, 2, 0xCA, 0xFE, 1, 2}, Bytes{23}, Bytes{23 | 0x80}, Bytes{23 | 0x80, 0},
                           Bytes{23 | 0x80, 77}, Bytes{16 | 0x80, 2}}) {
    EXPECT_EQ(outcome_of([&](const Bytes& request) { return answer_to(request, pdu); }), LinkOutcome::kLost)
        << "function " << int{pdu[0]} << ", " << pdu.size() << " bytes";
  }
}

TEST(ModbusLink, BytesAfterAnAnswerAreNeverTakenForTheNext) {
  const ScriptedPeer peer([](int fd, const Bytes& request) {
    Bytes twice = answer_to(request, kGoodPdu);
    const Bytes once = twice;
    twice.insert(twice.end(), once.begin(), once.end());
    send(fd, twice);
    Bytes next(300);
    if (::recv(fd, next.data(), next.size(), 0) > 0) send(fd, answer_to(next, kGoodPdu));
  });
  ModbusLink link("127.0.0.1", peer.port(), kLinkResponse_ms);
  ASSERT_TRUE(link.connect());
  std::array<std::uint16_t, 2> read{};
  EXPECT_EQ(link.write_read(0x200, kWritten, 0x40, read), LinkOutcome::kOk);
  EXPECT_EQ(read, kRead);
  EXPECT_EQ(link.write_read(0x200, kWritten, 0x40, read), LinkOutcome::kLost);
}

// libmodbus looks neither at the header's protocol, unit and length nor at contents. What it takes is
// believed only when the block's own CRC holds.
TEST(ModbusLink, NoSpoiltBitOfAnAnswerGoesUnseen) {
  std::array<std::uint16_t, protocol::kStatusSize> sent{};
  for (std::size_t i = 0; i < sent.size(); ++i) sent[i] = static_cast<std::uint16_t>(257 * i);
  protocol::seal_block(sent);
  Bytes pdu{23, 2 * protocol::kStatusSize};
  for (const auto word : sent) testing::put16(pdu, word);
  // Returns what was read, when it is believed, after `spoil` has had the answer.
  const auto believed = [&](const std::function<void(Bytes&)>& spoil) {
    const ScriptedPeer peer([&](int fd, const Bytes& request) {
      Bytes answer = answer_to(request, pdu);
      spoil(answer);
      send(fd, answer);
    });
    ModbusLink link("127.0.0.1", peer.port(), kLinkResponse_ms);
    std::array<std::uint16_t, protocol::kStatusSize> got{};
    const bool taken = link.connect() && link.write_read(0x200, kWritten, 0x40, got) == LinkOutcome::kOk;
    return taken && protocol::block_intact(got) ? std::optional(got) : std::nullopt;
  };
  EXPECT_EQ(believed([](Bytes&) {}), std::optional(sent));
  const std::size_t bits = 8 * testing::request(0, pdu).size();
  for (std::size_t bit = 0; bit < bits; ++bit) {
    const auto got = believed([bit](Bytes& answer) {
      answer[bit / 8] = static_cast<std::uint8_t>(answer[bit / 8] ^ 1U << bit % 8);
    });
    EXPECT_TRUE(!got || *got == sent) << "bit " << bit % 8 << " of byte " << bit / 8;
  }
}

TEST(ModbusLink, AClosedConnectionIsALostLink) {
  const ScriptedPeer peer([](int fd, const Bytes& request) {
    const Bytes answer = answer_to(request, kGoodPdu);
    send(fd, std::span(answer).first(9));
    ::shutdown(fd, SHUT_RDWR);
  });
  EXPECT_EQ(exchange(peer).outcome, LinkOutcome::kLost);
}

TEST(ModbusLink, SilenceAndATrickleAreGivenUpInTime) {
  for (const std::size_t pieces : {std::size_t{0}, std::size_t{1000}}) {
    const auto begin = steady_clock::now();
    const ScriptedPeer peer([&](int fd, const Bytes& request) {
      const Bytes answer = answer_to(request, kGoodPdu);
      // All of it, in the end: a timer that every byte starts anew would take it.
      for (std::size_t i = 0; i < std::min(pieces, answer.size()); ++i) {
        send(fd, std::span(answer).subspan(i, 1));
        std::this_thread::sleep_for(milliseconds(50));
      }
    });
    const Exchange got = exchange(peer);
    EXPECT_EQ(got.outcome, LinkOutcome::kLost) << pieces;
    EXPECT_EQ(got.error, "Connection timed out") << pieces;
    // The system counts such times in ticks of some ms.
    EXPECT_GE(steady_clock::now() - begin, milliseconds(kLinkResponse_ms / 2)) << pieces;
  }
}

TEST(ModbusLink, MoreRegistersThanFunction23HoldsAreRefused) {
  const ScriptedPeer peer([](int, const Bytes&) {});
  ModbusLink link("127.0.0.1", peer.port(), kLinkResponse_ms);
  ASSERT_TRUE(link.connect());
  const std::vector<std::uint16_t> many(122);
  std::array<std::uint16_t, 2> read{};
  EXPECT_EQ(link.write_read(0x200, many, 0x40, read), LinkOutcome::kLost);
}

}  // namespace
}  // namespace hotblade::robot
