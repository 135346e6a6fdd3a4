#include "robot/controller/execution_poses.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <string>
#include <string_view>

#include "robot/controller/execution_log.hpp"

namespace hotblade::robot {

namespace {

// One line, read by its keys: a log of half an hour has a hundred thousand of them.
class PoseLine {
 public:
  PoseLine(std::string_view text, const std::string& place) : text_(text), place_(place) {}

  [[nodiscard]] LoggedPose pose() const {
    LoggedPose pose;
    pose.sequence = integer<std::uint32_t>(after("\"seq\":"), 10);
    pose.t = number("\"t\":");
    pose.path_s = number("\"path\":");
    pose.a = clamp("\"a\":{\"p\":[");
    pose.b = clamp("\"b\":{\"p\":[");
    const std::size_t heat = after("\"heat\":");
    pose.heat = text_.substr(heat).starts_with("true");
    const std::size_t blade = after("\"blade\":");
    if (!text_.substr(blade).starts_with("null")) pose.blade = elastica(blade);
    return pose;
  }
  [[nodiscard]] std::uint64_t job() const { return integer<std::uint64_t>(after("\"job\":\""), 16); }

 private:
  [[nodiscard]] std::size_t after(std::string_view key, std::size_t from = 0) const {
    const std::size_t at = text_.find(key, from);
    if (at == std::string_view::npos) fail(key);
    return at + key.size();
  }
  template <typename Integer>
  [[nodiscard]] Integer integer(std::size_t at, int base) const {
    Integer value{};
    if (std::from_chars(text_.data() + at, text_.data() + text_.size(), value, base).ec != std::errc())
      fail("number");
    return value;
  }
  // A finite number, no larger than any length or rate of a cell; `at` moves behind it.
  [[nodiscard]] double number(std::size_t& at) const {
    constexpr double kLargest = 1e9;
    double value = 0;
    const auto parsed = std::from_chars(text_.data() + at, text_.data() + text_.size(), value);
    if (parsed.ec != std::errc() || !(std::abs(value) <= kLargest)) fail("number");
    at = static_cast<std::size_t>(parsed.ptr - text_.data());
    return value;
  }
  [[nodiscard]] double number(std::string_view key, std::size_t from = 0) const {
    std::size_t at = after(key, from);
    return number(at);
  }
  [[nodiscard]] Pose clamp(std::string_view key) const {
    std::size_t at = after(key);
    std::array<double, 7> v{};
    for (std::size_t i = 0; i < v.size(); ++i) {
      if (i == 3) at = after("\"q\":[", at);
      v[i] = number(at);
      ++at;  // the comma or bracket
    }
    const Eigen::Quaterniond q(v[3], v[4], v[5], v[6]);
    constexpr double kUnit = 1e-6;
    if (!(std::abs(q.norm() - 1) < kUnit)) fail("unit quaternion");
    return {{v[0], v[1], v[2]}, q.normalized()};
  }
  [[nodiscard]] elastica::Elastica elastica(std::size_t from) const {
    elastica::Elastica e{number("\"x\":", from),       number("\"y\":", from),
                         number("\"theta\":", from),   number("\"kappa\":", from),
                         number("\"lambda1\":", from), number("\"lambda2\":", from),
                         number("\"length\":", from)};
    if (!(e.length > 0)) fail("blade length");
    return e;
  }
  [[noreturn]] void fail(std::string_view what) const {
    throw LogError(place_ + ": no valid " + std::string(what) + ": not a line of an execution log");
  }

  std::string_view text_;
  const std::string& place_;
};

}  // namespace

std::map<std::uint64_t, std::vector<LoggedPose>> read_execution_poses(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) throw LogError(file.string() + ": cannot be read: check the path");
  std::map<std::uint64_t, std::vector<LoggedPose>> jobs;
  std::size_t number = 0;
  for (std::string text; std::getline(in, text);) {
    ++number;
    if (in.eof()) break;  // a line without its end was never committed
    const bool pose = text.starts_with("{\"ev\":\"pose\""), open = text.starts_with("{\"ev\":\"open\"");
    if (!pose && !open) continue;
    const std::string place = file.string() + ":" + std::to_string(number);
    const PoseLine line(text, place);
    if (open) jobs[line.job()].clear();  // another run of the same job
    if (pose) jobs[line.job()].push_back(line.pose());
  }
  return jobs;
}

}  // namespace hotblade::robot
