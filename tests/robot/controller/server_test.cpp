#include "robot/controller/server.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>

#include <chrono>
#include <random>
#include <thread>
#include <vector>

#include "robot/controller/register_map.hpp"
#include "tests/robot/controller/raw_client.hpp"
#include "tests/robot/controller/simulator_fixture.hpp"
#include "tests/robot/wire/sample_job.hpp"

namespace hotblade::robot {
namespace {

using Clock = std::chrono::steady_clock;
using testing::Bytes;
using testing::pdu;
using testing::put16;
using testing::RawClient;
using testing::request;
using testing::Simulator;
using testing::write_pdu;
using testing::write_read_pdu;

class Server : public ::testing::Test {
 protected:
  Simulator simulator_{ControllerOptions{}};
  RawClient client_{simulator_.port()};

  // The exception code of an answer; 0 for a regular one.
  static int exception_of(const Bytes& answer) {
    if (answer.size() < 8) return -1;
    return (answer[7] & 0x80) != 0 ? answer[8] : 0;
  }
  int exception_for(const Bytes& request_pdu, unsigned unit = 1) {
    return exception_of(client_.ask(request(9, request_pdu, unit)));
  }
};

const Bytes kReadMagic = pdu(3, {0, 1});

TEST_F(Server, AnswersWithTheTransactionAndUnitOfTheRequest) {
  for (const unsigned unit : {1u, 255u}) {
    const Bytes answer = client_.ask(request(0xBEEF, kReadMagic, unit));
    EXPECT_EQ(answer, (Bytes{0xBE, 0xEF, 0, 0, 0, 5, static_cast<std::uint8_t>(unit), 3, 2, 0x48, 0x42}));
  }
  EXPECT_EQ(client_.ask(request(1, pdu(4, {0, 1}))), (Bytes{0, 1, 0, 0, 0, 5, 1, 4, 2, 0x48, 0x42}));
}

TEST_F(Server, TakesARequestByteByByte) {
  for (const auto byte : request(7, kReadMagic)) {
    client_.send({byte});
    std::this_thread::sleep_for(std::chrono::milliseconds(3));
  }
  EXPECT_EQ(client_.receive().size(), 11u);
}

TEST_F(Server, AnswersPipelinedRequestsInOrder) {
  Bytes all;
  constexpr unsigned kRequests = 500;
  for (unsigned i = 0; i < kRequests; ++i) {
    const Bytes one = request(i, pdu(3, {protocol::kStatusBase, 1 + i % 40}));
    all.insert(all.end(), one.begin(), one.end());
  }
  client_.send(all);
  for (unsigned i = 0; i < kRequests; ++i) {
    const Bytes answer = client_.receive();
    ASSERT_EQ(answer.size(), 9 + 2 * (1 + i % 40)) << i;
    EXPECT_EQ(answer[0] << 8 | answer[1], static_cast<int>(i));
  }
}

TEST_F(Server, AnswersAreStillSentToWhoSendsNoMore) {
  Bytes both = request(1, kReadMagic);
  const Bytes second = request(2, kReadMagic);
  both.insert(both.end(), second.begin(), second.end());
  client_.send(both);
  client_.hang_up();
  EXPECT_FALSE(client_.receive().empty());
  EXPECT_FALSE(client_.receive().empty());
  EXPECT_TRUE(client_.closed_within(1000));
}

TEST_F(Server, SkipsFramesOfAnotherProtocol) {
  client_.send(request(1, kReadMagic, 1, 5));
  const Bytes answer = client_.ask(request(2, kReadMagic));
  ASSERT_EQ(answer.size(), 11u);
  EXPECT_EQ(answer[1], 2) << "the foreign one is not answered";
}

TEST_F(Server, ClosesWhenALengthCannotBe) {
  for (const unsigned length : {0u, 1u, 255u, 0xFFFFu}) {
    RawClient client(simulator_.port());
    Bytes bytes;
    put16(bytes, 1);
    put16(bytes, 0);
    put16(bytes, length);
    bytes.push_back(1);
    client.send(bytes);
    EXPECT_TRUE(client.closed_within(1000)) << length;
  }
}

TEST_F(Server, RefusesByTheCodesOfTheStandard) {
  for (const unsigned function : {1u, 2u, 5u, 7u, 15u, 17u, 22u, 24u, 43u, 100u}) {
    EXPECT_EQ(exception_for(pdu(function, {0, 1})), RegisterMap::kIllegalFunction) << function;
  }
  EXPECT_EQ(exception_for(kReadMagic, 2), RegisterMap::kNoSuchUnit);
  EXPECT_EQ(exception_for(pdu(3, {0, 0})), RegisterMap::kIllegalValue);
  EXPECT_EQ(exception_for(pdu(3, {0, 126})), RegisterMap::kIllegalValue);
  EXPECT_EQ(exception_for(pdu(3, {0, 65})), RegisterMap::kIllegalAddress) << "across IDENT and STATUS";
  EXPECT_EQ(exception_for(pdu(3, {protocol::kStatusBase, 41})), RegisterMap::kIllegalAddress);
  EXPECT_EQ(exception_for(pdu(3, {protocol::kCommandBase, 1})), RegisterMap::kIllegalAddress) << "write only";
  EXPECT_EQ(exception_for(pdu(3, {0xFFFF, 2})), RegisterMap::kIllegalAddress);
  EXPECT_EQ(exception_for(pdu(3, {0})), RegisterMap::kIllegalValue) << "too short";
  EXPECT_EQ(exception_for(pdu(3, {0, 1, 2})), RegisterMap::kIllegalValue) << "too long";
  EXPECT_EQ(exception_for(pdu(6, {0, 1})), RegisterMap::kIllegalAddress) << "IDENT is read only";
  EXPECT_EQ(exception_for(pdu(6, {protocol::kCommandBase, 1})), RegisterMap::kIllegalValue);
  EXPECT_EQ(exception_for(pdu(6, {protocol::kWindowBase, 1})), RegisterMap::kIllegalValue);
  EXPECT_EQ(exception_for({3}), RegisterMap::kIllegalValue);
}

TEST_F(Server, ScratchKeepsWhatIsWritten) {
  const std::vector<std::uint16_t> words{1, 0xFFFF, 0x1234};
  EXPECT_EQ(client_.ask(request(1, write_pdu(protocol::kScratchBase + 13, words))),
            (Bytes{0, 1, 0, 0, 0, 6, 1, 16, 0x01, 0x8D, 0, 3}));
  EXPECT_EQ(client_.ask(request(2, pdu(6, {protocol::kScratchBase, 77}))),
            (Bytes{0, 2, 0, 0, 0, 6, 1, 6, 0x01, 0x80, 0, 77}));
  const Bytes all = client_.ask(request(3, pdu(3, {protocol::kScratchBase, 16})));
  ASSERT_EQ(all.size(), 9u + 32u);
  EXPECT_EQ(all[10], 77);
  EXPECT_EQ(Bytes(all.end() - 6, all.end()), (Bytes{0, 1, 0xFF, 0xFF, 0x12, 0x34}));
  EXPECT_EQ(exception_for(write_pdu(protocol::kScratchBase + 14, words)), RegisterMap::kIllegalAddress);
  auto short_count = write_pdu(protocol::kScratchBase, words);
  short_count[5] = 4;
  EXPECT_EQ(exception_for(short_count), RegisterMap::kIllegalValue);
}

TEST_F(Server, ACommandOrAWindowCountsWholeAtItsBaseOnly) {
  const Job job = testing::sample_job(100);
  const auto open = protocol::encode_command({1, protocol::Op::kOpen, job.id, 1, 0, 100, job.blade});
  const std::span<const std::uint16_t> block(open);
  EXPECT_EQ(exception_for(write_pdu(protocol::kCommandBase, block.first(24))), RegisterMap::kIllegalValue);
  EXPECT_EQ(exception_for(write_pdu(protocol::kCommandBase + 1, block)), RegisterMap::kIllegalAddress);
  const auto state = [this] { return client_.ask(request(1, pdu(3, {protocol::kStatusBase, 1}))).back(); };
  EXPECT_EQ(state(), 0) << "nothing happened";
  EXPECT_EQ(exception_for(write_pdu(protocol::kCommandBase, block)), 0);
  EXPECT_EQ(state(), 1) << "OPEN";
  const auto window = protocol::encode_window(1, 0, false, std::span(job.raw).first(4));
  EXPECT_EQ(exception_for(write_pdu(protocol::kWindowBase, window.span().first(window.size - 1))),
            RegisterMap::kIllegalValue);
  EXPECT_EQ(exception_for(write_pdu(protocol::kWindowBase + 1, window.span())), RegisterMap::kIllegalAddress);
  EXPECT_EQ(exception_for(write_pdu(protocol::kWindowBase, window.span())), 0);
}

TEST_F(Server, OneFunction23WritesAWindowAndReadsTheStatusAfterIt) {
  const Job job = testing::sample_job(100);
  const auto open = protocol::encode_command({1, protocol::Op::kOpen, job.id, 1, 0, 100, job.blade});
  const auto status_of = [](const Bytes& answer) {
    std::array<std::uint16_t, protocol::kStatusSize> words{};
    for (std::size_t i = 0; i < words.size(); ++i) {
      words[i] = static_cast<std::uint16_t>(answer.at(9 + 2 * i) << 8 | answer.at(10 + 2 * i));
    }
    return protocol::decode_status(words);
  };
  const auto opened = status_of(client_.ask(request(1, write_read_pdu(protocol::kCommandBase, open))));
  EXPECT_EQ(opened.last_result, protocol::Result::kOk);
  EXPECT_EQ(opened.last_nonce, 1u);
  const auto window = protocol::encode_window(opened.token, 0, false, std::span(job.raw).first(4));
  const auto status =
      status_of(client_.ask(request(2, write_read_pdu(protocol::kWindowBase, window.span()))));
  EXPECT_EQ(status.accepted, 4u);
  EXPECT_EQ(status.job_id, job.id);
  // Refused as a whole when the answer could not be given.
  auto bad_read = write_read_pdu(protocol::kScratchBase, std::vector<std::uint16_t>{5});
  bad_read[1] = 0x10;
  EXPECT_EQ(exception_for(bad_read), RegisterMap::kIllegalAddress);
  EXPECT_EQ(client_.ask(request(3, pdu(3, {protocol::kScratchBase, 1}))).back(), 0);
}

TEST_F(Server, EstopIsForAnybodyAndIgnoresZero) {
  EXPECT_EQ(exception_for(pdu(6, {protocol::kEstopBase, 0})), 0);
  EXPECT_EQ(client_.ask(request(1, pdu(3, {protocol::kStatusBase, 1}))).back(), 0);
  EXPECT_EQ(exception_for(pdu(6, {protocol::kEstopBase, 1})), 0);
  EXPECT_EQ(client_.ask(request(1, pdu(3, {protocol::kStatusBase, 1}))).back(), 6);
}

// The longest of many round trips while `nuisance` goes on, ms.
template <typename Nuisance>
double worst_round_trip_ms(RawClient& client, Nuisance nuisance) {
  double worst = 0;
  for (int i = 0; i < 200; ++i) {
    nuisance(i);
    const auto start = Clock::now();
    EXPECT_EQ(client.ask(request(1, kReadMagic)).size(), 11u);
    worst = std::max(worst, std::chrono::duration<double, std::milli>(Clock::now() - start).count());
  }
  return worst;
}

TEST_F(Server, ASlowClientDoesNotDelayAnother) {
  RawClient slow(simulator_.port());
  slow.send({0, 1, 0, 0, 0});
  EXPECT_LT(worst_round_trip_ms(client_, [](int) {}), 250);
}

TEST_F(Server, AClientThatNeverReadsDoesNotDelayAnother) {
  RawClient greedy(simulator_.port());
  const int small = 4096;
  ::setsockopt(greedy.fd(), SOL_SOCKET, SO_RCVBUF, &small, sizeof small);
  Bytes flood;
  for (unsigned i = 0; i < 200; ++i) {
    const Bytes one = request(i, pdu(3, {0, 64}));
    flood.insert(flood.end(), one.begin(), one.end());
  }
  const auto worst = worst_round_trip_ms(
      client_, [&](int) { ::send(greedy.fd(), flood.data(), flood.size(), MSG_NOSIGNAL | MSG_DONTWAIT); });
  EXPECT_LT(worst, 250);
}

TEST_F(Server, NoiseDoesNotDelayOrConfuseAnother) {
  std::mt19937 random(7);
  const auto worst = worst_round_trip_ms(client_, [&](int) {
    RawClient noisy(simulator_.port());
    Bytes noise(random() % 600 + 1);
    for (auto& byte : noise) byte = static_cast<std::uint8_t>(random());
    if (random() % 2 == 0) noise[2] = noise[3] = noise[4] = 0;  // plausible heads too
    noisy.send(noise);
  });
  EXPECT_LT(worst, 250);
}

TEST_F(Server, MutatedRequestsNeverEndTheServer) {
  std::mt19937 random(11);
  const Job job = testing::sample_job(100);
  const auto window = protocol::encode_window(1, 0, false, std::span(job.raw).first(2));
  const std::vector<Bytes> seeds{kReadMagic, write_read_pdu(protocol::kWindowBase, window.span()),
                                 write_pdu(protocol::kScratchBase, std::vector<std::uint16_t>{1, 2, 3})};
  for (int i = 0; i < 2000; ++i) {
    Bytes mutated = seeds[random() % seeds.size()];
    for (int change = 0; change < 3; ++change) {
      mutated[random() % mutated.size()] = static_cast<std::uint8_t>(random());
    }
    mutated.resize(std::max<std::size_t>(1, mutated.size() - random() % 3));
    if (mutated[0] == 6 || mutated[0] == 16 || mutated[0] == 23)
      mutated[1] = static_cast<std::uint8_t>(random() % 3);
    ASSERT_FALSE(client_.ask(request(1, mutated)).empty()) << "whole frames are always answered";
  }
  EXPECT_EQ(client_.ask(request(1, kReadMagic)).size(), 11u);
}

TEST(ServerLimits, SilentConnectionsMakeRoomButNeverTheOwners) {
  ServerOptions server_options;
  server_options.max_connections = 4;
  Simulator simulator(ControllerOptions{}, server_options);
  RawClient owner(simulator.port());
  const Job job = testing::sample_job(100);
  const auto open = protocol::encode_command({1, protocol::Op::kOpen, job.id, 1, 0, 100, job.blade});
  ASSERT_FALSE(owner.ask(request(1, write_pdu(protocol::kCommandBase, open))).empty());
  std::vector<std::unique_ptr<RawClient>> crowd;
  for (int i = 0; i < 10; ++i) {
    crowd.push_back(std::make_unique<RawClient>(simulator.port()));
    EXPECT_EQ(crowd.back()->ask(request(1, kReadMagic)).size(), 11u) << "a new one always gets in";
  }
  EXPECT_TRUE(crowd.front()->closed_within(1000));
  EXPECT_EQ(owner.ask(request(1, kReadMagic)).size(), 11u);
}

TEST(ServerLimits, IdleConnectionsAreClosed) {
  ServerOptions server_options;
  server_options.idle_ms = 100;
  Simulator simulator(ControllerOptions{}, server_options);
  RawClient idle(simulator.port());
  EXPECT_TRUE(idle.closed_within(1000));
}

TEST(ServerLimits, AnOpenNetworkNeedsAnAllowList) {
  Controller controller(ControllerOptions{});
  ServerOptions options;
  options.port = 0;
  options.address = "0.0.0.0";
  EXPECT_THROW(ControllerServer(options, controller), ServerError);
  options.allow = {"192.0.2.7"};
  EXPECT_NO_THROW(ControllerServer(options, controller));
  options.allow = {"neighbour"};
  EXPECT_THROW(ControllerServer(options, controller), ServerError);
  options.address = "localhost";
  EXPECT_THROW(ControllerServer(options, controller), ServerError) << "an address, not a name";
}

TEST(ServerLimits, ATakenPortIsSaid) {
  Simulator first{ControllerOptions{}};
  Controller controller(ControllerOptions{});
  ServerOptions options;
  options.port = first.port();
  try {
    const ControllerServer second(options, controller);
    FAIL() << "two servers on one port";
  } catch (const ServerError& error) {
    EXPECT_NE(std::string(error.what()).find("127.0.0.1:" + std::to_string(first.port())), std::string::npos);
  }
}

}  // namespace
}  // namespace hotblade::robot
