// A controller that writes its log, can be started again from it, and is driven by hand.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "robot/controller/controller.hpp"
#include "robot/controller/execution_log.hpp"
#include "tests/robot/wire/sample_job.hpp"

namespace hotblade::robot::testing {

using protocol::Op;
using protocol::Result;
using protocol::State;

// Heat of the sample's 200 waypoints, 50 ms apart: the first and the last hot one.
inline constexpr double kHeatOn_s = 2.5, kHeatOff_s = 7.5;

// Writes the log and keeps what it is told.
class Witness final : public ExecutionSink {
 public:
  explicit Witness(const std::filesystem::path& file) : log_(file, {false, true}) {}
  void executed(const ExecutedWaypoint& w) override { log_.executed(w); }
  void pose(const PoseSample& sample) override {
    log_.pose(sample);
    poses.push_back(sample);
  }
  void event(const JobEvent& event) override {
    log_.event(event);
    events.emplace_back(event.what);
  }
  bool commit() override { return log_.commit(); }

  std::vector<PoseSample> poses;
  std::vector<std::string> events;

 private:
  ExecutionLog log_;
};

// A controller with a log, a client, and a clock in ms.
class RestartFixture : public ::testing::Test {
 protected:
  void SetUp() override {
    static int number = 0;
    file_ = std::filesystem::temp_directory_path() /
            ("hotblade_restart_" + std::to_string(::getpid()) + "_" + std::to_string(number++) + ".jsonl");
    std::filesystem::remove(file_);
    boot();
  }
  void TearDown() override {
    log_.reset();
    std::filesystem::remove(file_);
  }

  void boot() {
    controller_.reset();
    log_.reset();
    const auto journal = read_controller_journal(file_);
    log_ = std::make_unique<Witness>(file_);
    controller_ = std::make_unique<Controller>(options_, log_.get());
    controller_->restore(journal);
    controller_->commit();
    now_ms_ = 0;
  }
  [[nodiscard]] protocol::Status status() const { return controller_->status(); }
  Result send(Op op, std::uint32_t token, Controller::Connection from = 1) {
    const auto result = controller_->command(
        {{++nonce_, op, job_.id, run_, token, job_.size(), job_.blade}, true}, from, now_ms_ * 1000);
    controller_->commit();
    return result;
  }
  Result send(Op op) { return send(op, status().token); }
  Result push(std::uint32_t first, std::uint32_t n) {
    protocol::Window w{status().token,           first, static_cast<std::uint16_t>(n),
                       first + n == job_.size(), true,  {}};
    for (std::uint32_t i = 0; i < n; ++i) w.raw.at(i) = job_.raw.at(first + i);
    const auto result = controller_->window(w, 1, now_ms_ * 1000);
    controller_->commit();
    return result;
  }
  void fill() {
    while (status().accepted < job_.size()) {
      const auto at = status().accepted;
      ASSERT_EQ(push(at, std::min(4u, job_.size() - at)), Result::kOk) << at;
    }
  }
  void wait(std::uint64_t ms) {
    for (const auto end = now_ms_ + ms; now_ms_ < end;) {
      now_ms_ += 5;
      controller_->heard(1, now_ms_ * 1000);
      controller_->tick(now_ms_ * 1000);
      controller_->commit();
    }
  }
  void start() {
    ASSERT_EQ(send(Op::kOpen, 0), Result::kOk);
    fill();
    ASSERT_EQ(send(Op::kStart), Result::kOk);
  }
  void resume() {
    ASSERT_EQ(status().state, State::kHeld);
    fill();
    ASSERT_EQ(send(Op::kResume), Result::kOk);
  }
  void hold_until_cold() {
    ASSERT_EQ(send(Op::kHold), Result::kOk);
    wait(3000);
    ASSERT_EQ(status().state, State::kHeld);
    ASSERT_EQ(log_->events.back(), "cold");
  }
  void expect_proof() {
    EXPECT_EQ(status().state, State::kDone);
    EXPECT_EQ(status().executed_crc, status().accepted_crc);
    EXPECT_TRUE(prove(job_, read_execution_log(file_).at(job_.id)).holds());
  }
  // From one pose to the next the path goes on by no more than the time that has passed.
  void expect_unbroken_path(const std::vector<PoseSample>& poses) {
    for (std::size_t i = 1; i < poses.size(); ++i) {
      const double dt = static_cast<double>(poses[i].t_us - poses[i - 1].t_us) * 1e-6;
      ASSERT_LE(std::abs(poses[i].path_s - poses[i - 1].path_s), dt + 2e-6) << "at " << poses[i].t_us;
      const auto speed = [&](const Pose& a, const Pose& b) {
        return (b.p - a.p).norm() / std::max(dt, 1e-2);
      };
      ASSERT_LE(speed(poses[i - 1].a, poses[i].a), 60);
      ASSERT_LE(speed(poses[i - 1].b, poses[i].b), 60);
    }
  }
  [[nodiscard]] std::string text() const {
    std::ifstream in(file_, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  void rewrite(const std::string& text) { std::ofstream(file_, std::ios::binary) << text; }

  Job job_ = sample_job(200);
  ControllerOptions options_;
  std::filesystem::path file_;
  std::unique_ptr<Witness> log_;
  std::unique_ptr<Controller> controller_;
  std::uint64_t now_ms_ = 0;
  std::uint32_t nonce_ = 100, run_ = 1;
};

}  // namespace hotblade::robot::testing
