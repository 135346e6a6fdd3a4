#include "robot/controller/execution_log.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <iterator>

#include "tests/robot/wire/sample_job.hpp"

namespace hotblade::robot {
namespace {

using testing::sample_job;

class ExecutionLogTest : public ::testing::Test {
 protected:
  void SetUp() override {
    file_ =
        std::filesystem::temp_directory_path() / ("hotblade_log_" + std::to_string(::getpid()) + ".jsonl");
    std::filesystem::remove(file_);
  }
  void TearDown() override { std::filesystem::remove(file_); }

  // What a controller writes for these waypoints of the job.
  void write(const std::vector<std::uint32_t>& sequences, bool with_open = true) {
    ExecutionLog log(file_, {});
    if (with_open) log.event({"open", job_.id, 1, 1, 0, job_.size(), 0, protocol::Fault::kNone});
    Chain chain(job_.id);
    for (const auto k : sequences) {
      log.executed(
          {job_.id, 1, k, protocol::time_us(job_.raw[k]), k * 50000ull, job_.raw[k], chain.add(job_.raw[k])});
    }
    ASSERT_TRUE(log.commit());
  }
  [[nodiscard]] std::string text() const {
    std::ifstream in(file_, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  [[nodiscard]] ExecutionProof proof() const { return prove(job_, read_execution_log(file_).at(job_.id)); }
  [[nodiscard]] std::vector<std::uint32_t> all() const {
    std::vector<std::uint32_t> sequences(job_.size());
    for (std::uint32_t k = 0; k < job_.size(); ++k) sequences[k] = k;
    return sequences;
  }

  Job job_ = sample_job(20);
  std::filesystem::path file_;
};

TEST_F(ExecutionLogTest, ProvesACompleteRun) {
  write(all());
  EXPECT_TRUE(proof().holds());
}

TEST_F(ExecutionLogTest, NoticesAMissingARepeatedAndAMisplacedWaypoint) {
  auto sequences = all();
  sequences.pop_back();
  write(sequences);
  EXPECT_FALSE(proof().holds());
  TearDown();
  sequences = all();
  sequences.insert(sequences.begin() + 5, 5);
  write(sequences);
  EXPECT_FALSE(proof().in_order);
  EXPECT_FALSE(proof().chain_equal);
  TearDown();
  sequences = all();
  std::swap(sequences[7], sequences[8]);
  write(sequences);
  EXPECT_FALSE(proof().in_order);
  EXPECT_FALSE(proof().bytes_equal);
}

TEST_F(ExecutionLogTest, NoticesAChangedByte) {
  write(all());
  std::string changed = text();
  const auto at = changed.find("\"raw\":\"", changed.find("\"seq\":9,")) + 20;
  changed[at] = changed[at] == '0' ? '1' : '0';
  std::ofstream(file_, std::ios::binary) << changed;
  EXPECT_FALSE(proof().bytes_equal);
  EXPECT_FALSE(proof().chain_equal);
  EXPECT_TRUE(proof().in_order);
}

TEST_F(ExecutionLogTest, AnotherRunOfTheJobCountsByItself) {
  write({0, 1, 2});
  write(all());
  EXPECT_TRUE(proof().holds());
}

TEST_F(ExecutionLogTest, ATornLastLineIsDroppedAndTheLogGoesOn) {
  write({0, 1, 2, 3});
  const auto whole = text();
  std::ofstream(file_, std::ios::binary | std::ios::app) << "{\"ev\":\"exec\",\"job\":\"12";
  EXPECT_EQ(read_execution_log(file_).at(job_.id).raw.size(), 4u) << "a reader passes it over";
  { const ExecutionLog log(file_, {}); }
  EXPECT_EQ(text(), whole);
  write({}, false);
  EXPECT_EQ(text(), whole) << "nothing is written over";
}

// No file may grow over a size: as on a full disk.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) : before_(::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &room_);
    const rlimit limited{bytes, room_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limited);
  }
  ~FullDisk() {
    ::setrlimit(RLIMIT_FSIZE, &room_);
    ::signal(SIGXFSZ, before_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  rlimit room_{};
  void (*before_)(int);
};

TEST_F(ExecutionLogTest, OnAFullDiskItEndsWithAWholeLineAndGoesOnWhenThereIsRoom) {
  write(all());
  const std::string whole = text();
  for (const std::size_t room : {std::size_t{0}, std::size_t{1}, whole.find('\n'), whole.find('\n') + 1,
                                 whole.size() / 2, whole.size() - 1}) {
    std::filesystem::remove(file_);
    std::vector<std::string> told;
    ExecutionLog log(file_, {true, true, [&](const std::string& what) { told.push_back(what); }});
    log.event({"open", job_.id, 1, 1, 0, job_.size(), 0, protocol::Fault::kNone});
    Chain chain(job_.id);
    {
      const FullDisk full(room);
      for (std::uint32_t k = 0; k < job_.size(); ++k) {
        log.executed({job_.id, 1, k, protocol::time_us(job_.raw[k]), k * 50000ull, job_.raw[k],
                      chain.add(job_.raw[k])});
        if (k % 3 == 2) (void)log.commit();
      }
      EXPECT_FALSE(log.commit());
      EXPECT_FALSE(log.commit()) << "still";
      EXPECT_EQ(log.error(), EFBIG);
      const std::string there = text();
      EXPECT_LE(there.size(), room);
      EXPECT_TRUE(whole.starts_with(there));
      EXPECT_TRUE(there.empty() || there.ends_with('\n')) << room;
    }
    EXPECT_TRUE(log.commit());
    EXPECT_EQ(log.error(), 0);
    EXPECT_EQ(text(), whole) << "nothing is lost or written twice";
    ASSERT_EQ(told.size(), 2u) << "once each";
    EXPECT_EQ(told[0],
              file_.string() +
                  ": the log cannot be written (File too large): make room, then reset the controller");
    EXPECT_EQ(told[1], file_.string() + ": the log is written again");
  }
}

TEST_F(ExecutionLogTest, WhatIsNoLogIsRefusedWithItsLine) {
  std::ofstream(file_) << "{\"ev\":\"start\",\"job\":\"0000000000000001\"}\nhello\n";
  try {
    (void)read_execution_log(file_);
    FAIL() << "accepted";
  } catch (const LogError& error) {
    EXPECT_NE(std::string(error.what()).find(":2: "), std::string::npos) << error.what();
  }
  EXPECT_THROW((void)read_execution_log(file_ / "none"), LogError);
  EXPECT_THROW(ExecutionLog("/nonexistent/directory/log", {}), LogError);
}

TEST_F(ExecutionLogTest, ALineReadsAsDocumented) {
  {
    ExecutionLog log(file_, {});
    log.pose({0x0123456789ABCDEF,
              7,
              1230000,
              {{1, -2, 3.00006}, {1, 0, 0, 0}},
              {{4, 5, 6}, {0, 1, 0, 0}},
              true,
              protocol::State::kRunning,
              1.229,
              0.0012});
  }
  EXPECT_EQ(text(),
            "{\"ev\":\"pose\",\"job\":\"0123456789abcdef\",\"seq\":7,\"t\":1.230000,\"frame\":{\"origin\":"
            "[1.0000,-2.0000,3.0001],\"x\":[1.000000000,0.000000000,0.000000000],\"y\":"
            "[0.000000000,1.000000000,0.000000000]},\"a\":{\"p\":[1.0000,-2.0000,3.0001],\"q\":"
            "[1.000000000,0.000000000,0.000000000,0.000000000]},\"b\":{\"p\":[4.0000,5.0000,6.0000],\"q\":"
            "[0.000000000,1.000000000,0.000000000,0.000000000]},\"blade\":null,\"heat\":true,\"state\":"
            "\"RUNNING\",\"path\":1.229000,\"following_mm\":0.0012}\n");
}

TEST(Job, IdDependsOnProgramStripAndWaypoints) {
  const auto waypoints = testing::sample_waypoints(5);
  const auto blade = testing::sample_blade();
  const std::vector<std::uint8_t> other_program{1};
  const auto id = make_job(sha256({}), "S001", waypoints, blade).id;
  EXPECT_EQ(id, make_job(sha256({}), "S001", waypoints, blade).id);
  EXPECT_NE(id, make_job(sha256(other_program), "S001", waypoints, blade).id);
  EXPECT_NE(id, make_job(sha256({}), "S002", waypoints, blade).id);
  auto moved = waypoints;
  moved[3].a.p.x() += 0.001;
  EXPECT_NE(id, make_job(sha256({}), "S001", moved, blade).id);
  moved[3].a.p.x() = 1e9;
  EXPECT_THROW((void)make_job(sha256({}), "S001", moved, blade), JobError);
  EXPECT_THROW((void)make_job(sha256({}), "S001", {}, blade), JobError);
  EXPECT_THROW((void)make_job(sha256({}), "S001", waypoints, {blade, -1}), JobError);
}

TEST(Chain, MatchesTheHashOfItsDefinition) {
  // SHA-256(0102030405060708 || 52 zero bytes), then SHA-256(that || 52 zero bytes), by another
  // implementation: python3 -c "import hashlib as h; a=h.sha256(bytes(range(1,9))+bytes(52)).digest();
  //             print(a.hex(), h.sha256(a+bytes(52)).hexdigest())"
  Chain chain(0x0102030405060708);
  EXPECT_EQ(to_hex(chain.add({})), "f89f45f2cbf46c58079037ec395b32400b65e12743c3856833638788f4fdd4de");
  EXPECT_EQ(to_hex(chain.add({})), "7e5d725743ef61ce2d2f10b91c644969860d04b4eb6846213d3823334ccaec54");
}

}  // namespace
}  // namespace hotblade::robot
