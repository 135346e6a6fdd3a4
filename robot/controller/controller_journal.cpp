#include "robot/controller/controller_journal.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <utility>

#include "robot/controller/log_line.hpp"

namespace hotblade::robot {
namespace {

using protocol::Fault;
using protocol::State;

Fault fault_named(const Line& line) {
  const auto wanted = line.string("fault");
  for (std::uint16_t code = 0; code <= static_cast<std::uint16_t>(Fault::kDrive); ++code) {
    if (wanted == protocol::name(static_cast<Fault>(code))) return static_cast<Fault>(code);
  }
  line.fail("fault");
}

// [x,y,...] behind the key, within `text`.
template <std::size_t N>
std::array<double, N> numbers(const Line& line, std::string_view text, std::string_view key) {
  auto at = text.find(std::string("\"") + std::string(key) + "\":[");
  if (at == std::string_view::npos) line.fail(key);
  at = text.find('[', at) + 1;
  std::array<double, N> values{};
  for (std::size_t i = 0; i < N; ++i) {
    const auto end = text.find_first_of(",]", at);
    if (end == std::string_view::npos || (text[end] == ']') != (i + 1 == N)) line.fail(key);
    values[i] = line.number<double>(key, text.substr(at, end - at));
    at = end + 1;
  }
  return values;
}

Pose pose_of(const Line& line, std::string_view text, std::string_view clamp) {
  const auto at = text.find(std::string("\"") + std::string(clamp) + "\":{\"p\"");
  if (at == std::string_view::npos) line.fail(clamp);
  const auto p = numbers<3>(line, text.substr(at), "p");
  const auto q = numbers<4>(line, text.substr(at), "q");
  return {{p[0], p[1], p[2]}, Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized()};
}

// Follows a log line by line. Poses are many and only the last one counts, so their lines are kept as they
// are.
class JournalReader {
 public:
  void take(std::string& text, const std::string& place) {
    if (text.starts_with("{\"ev\":\"pose\"")) {
      last_pose_.swap(text);
      pose_place_ = place;
      return;
    }
    const Line line(text, place);
    const auto ev = line.string("ev");
    const auto id = line.number<std::uint64_t>("job", line.string("job"), 16);
    if (ev == "exec") return take_executed(line, id);
    if (ev == "arms") take_arms(line, text);
    if (ev == "fault" || ev == "estop") take_arms_detail(line, text);
    journal_.token = std::max(journal_.token, line.number<std::uint32_t>("token", line.raw_value("token")));
    if (ev == "open") open(line, id);
    if (id != journal_.job) line.fail("job");
    take_event(line, ev);
  }

  ControllerJournal finish() {
    take_last_pose();
    const bool open = journal_.state == State::kOpen || journal_.state == State::kHeld;
    if (open) journal_.state = journal_.executed.empty() ? State::kOpen : State::kHeld;
    // Executed to the end, without the line that says so.
    if (open && journal_.executed.size() == journal_.count) journal_.state = State::kDone;
    return std::move(journal_);
  }

 private:
  void open(const Line& line, std::uint64_t id) {
    const std::uint32_t token = journal_.token;
    journal_ = {};
    journal_.token = token;
    last_pose_.clear();
    journal_.job = id;
    journal_.loaded = true;
    journal_.state = State::kOpen;
    const auto word = [&](std::string_view key) {
      return line.number<std::uint32_t>(key, line.raw_value(key));
    };
    journal_.run = word("run");
    journal_.count = word("planned");
    protocol::BladeWords blade;
    for (std::size_t i = 0; i < blade.size(); ++i) blade[i] = word(protocol::kBladeWordNames[i]);
    journal_.blade = protocol::decode_blade(blade);
  }

  void take_executed(const Line& line, std::uint64_t id) {
    const auto sequence = line.number<std::uint32_t>("seq", line.raw_value("seq"));
    if (!journal_.loaded || id != journal_.job || sequence != journal_.executed.size()) line.fail("seq");
    protocol::RawWaypoint raw{};
    Sha256 written{};
    line.bytes("raw", raw);
    line.bytes("chain", written);
    if (journal_.executed.empty()) chain_.restart(id);
    if (chain_.add(raw) != written) line.fail("chain");
    journal_.executed.push_back(raw);
    journal_.chain = written;
    if (journal_.state == State::kOpen) journal_.state = State::kHeld;  // a faulted one brakes along the path
    journal_.path_s = protocol::time_us(raw) * 1e-6;
    note_time(line, "t_exec");
    last_pose_.clear();
  }

  void take_arms(const Line& line, std::string_view text) {
    protocol::Arms arms;
    arms.cell_id = line.number<std::uint64_t>("cell", line.string("cell"), 16);
    for (std::size_t clamp = 0; clamp < arms.joints_rad.size(); ++clamp) {
      arms.joints_rad[clamp] = numbers<protocol::kArmJoints>(line, text, clamp == 0 ? "ja_urad" : "jb_urad");
      for (double& q : arms.joints_rad[clamp]) q /= 1e6;
    }
    journal_.arms = arms;
  }

  void take_arms_detail(const Line& line, std::string_view text) {
    journal_.fault_arms = {};
    if (text.find("\"arm_fault\":[") == std::string_view::npos) return;
    const auto values = numbers<5>(line, text, "arm_fault");
    constexpr std::array kLeast{0.0, 0.0, 0.0, 0.0, -2147483647.0};
    constexpr std::array kMost{2.0, 7.0, 7.0, 7.0, 2147483647.0};
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!(values[i] >= kLeast[i] && values[i] <= kMost[i])) line.fail("arm_fault");
    }
    const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(values[i]); };
    journal_.fault_arms = {byte(0), byte(1), static_cast<protocol::ArmsOther>(byte(2)), byte(3),
                           static_cast<std::int32_t>(values[4])};
  }

  void take_event(const Line& line, std::string_view ev) {
    note_time(line, "t");
    if (ev == "done") journal_.state = State::kDone;
    if (ev == "fault" || ev == "estop") {
      journal_.state = ev == "fault" ? State::kFault : State::kEstop;
      journal_.fault = fault_named(line);
      journal_.fault_detail = line.number<std::uint16_t>("detail", line.raw_value("detail"));
      journal_.fault_sequence = line.number<std::uint32_t>("at", line.raw_value("at"));
    }
    // Taken up again after a RESET.
    if (ev == "takeover" && journal_.left) {
      journal_.loaded = true;
      journal_.left = false;
      journal_.state = State::kHeld;
    }
    if (ev == "release") journal_.left = false;
    if (ev == "close" || ev == "reset" || ev == "withdrawn") {
      journal_.left = ev == "reset" && (journal_.loaded || journal_.left);
      journal_.state = State::kIdle;
      journal_.fault = Fault::kNone;
      journal_.fault_detail = 0;
      journal_.fault_sequence = 0;
      journal_.fault_arms = {};
      journal_.loaded = false;
    }
  }

  void take_last_pose() {
    if (last_pose_.empty() || !(journal_.loaded || journal_.left)) return;
    const Line line(last_pose_, pose_place_);
    if (line.number<std::uint64_t>("job", line.string("job"), 16) != journal_.job) return;
    journal_.path_s = line.number<double>("path", line.raw_value("path"));
    journal_.held = ClampPoses{pose_of(line, last_pose_, "a"), pose_of(line, last_pose_, "b")};
    note_time(line, "t");
  }

  void note_time(const Line& line, std::string_view key) {
    const auto us = line.number<double>(key, line.raw_value(key)) * 1e6;
    journal_.motion_us = std::max(journal_.motion_us, static_cast<std::uint64_t>(us + 0.5));
  }

  ControllerJournal journal_;
  Chain chain_{0};
  std::string last_pose_, pose_place_;
};

}  // namespace

ControllerJournal read_controller_journal(const std::filesystem::path& log) {
  JournalReader reader;
  std::ifstream in(log);
  if (!in) return {};
  std::size_t number = 0;
  for (std::string text; std::getline(in, text) && !in.eof();) {
    reader.take(text, log.string() + ":" + std::to_string(++number));
  }
  return reader.finish();
}

}  // namespace hotblade::robot
