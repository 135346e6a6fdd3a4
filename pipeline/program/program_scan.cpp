#include "pipeline/program/program_scan.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "pipeline/program/program_limits.hpp"

namespace hotblade::pipeline {
namespace {

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

// Goes through text that is known but for its values. Once something is not as expected, nothing is any more.
class Scanner {
 public:
  explicit Scanner(std::string_view text) : at_(text.data()), end_(text.data() + text.size()) {}

  [[nodiscard]] bool good() const { return good_; }
  [[nodiscard]] std::string_view left() const { return {at_, static_cast<std::size_t>(end_ - at_)}; }
  void expect(bool holds) { good_ = good_ && holds; }

  [[nodiscard]] bool next_is(std::string_view word) {
    if (!good_ || !left().starts_with(word)) return false;
    at_ += word.size();
    return true;
  }
  void skip(std::string_view word) { expect(next_is(word)); }

  // A JSON number: from_chars takes more (inf, nan, leading zeros, a dot without digits), and tells an
  // integer's -0 from 0, which trees of JSON do not.
  double number(Range range) {
    double value = 0;
    if (!good_) return value;
    const char* digits = at_ + (at_ < end_ && *at_ == '-' ? 1 : 0);
    const auto [behind, error] = std::from_chars(at_, end_, value);
    const bool leading_zero = behind - digits > 1 && digits[0] == '0' && is_digit(digits[1]);
    const char* dot = std::find(digits, behind, '.');
    const bool bare_dot = dot != behind && (dot + 1 == behind || !is_digit(dot[1]));
    expect(error == std::errc{} && digits < behind && is_digit(*digits) && !leading_zero && !bare_dot &&
           !(value == 0 && digits != at_) && range.holds(value));
    at_ = behind;
    return value;
  }
  double field(std::string_view key, Range range = kAny) {
    skip(key);
    return number(range);
  }

  std::size_t index(std::size_t below) {
    std::size_t value = 0;
    if (!good_) return value;
    const auto [behind, error] = std::from_chars(at_, end_, value);
    expect(error == std::errc{} && (behind - at_ == 1 || *at_ != '0') && value < below);
    at_ = behind;
    return value;
  }

  template <int N>
  Eigen::Matrix<double, N, 1> vector(std::string_view key, Range range = kAny) {
    Eigen::Matrix<double, N, 1> v;
    skip(key);
    for (int i = 0; i < N; ++i) v[i] = field(i == 0 ? "[" : ",", range);
    skip("]");
    return v;
  }

 private:
  const char *at_, *end_;
  bool good_ = true;
};

StripPhase scan_phase(Scanner& in) {
  in.skip(",\"phase\":\"");
  const std::string_view left = in.left();
  const std::string_view word = left.substr(0, left.find('"'));
  in.skip(word);
  for (const StripPhase phase : kStripPhases)
    if (word == name(phase)) return phase;
  in.expect(false);
  return {};
}

// Frames of poses, nearly all of which have the axes of the one before.
class FrameScanner {
 public:
  SharedFrame next(Scanner& in) {
    frame_.origin = in.vector<3>("{\"origin\":");
    if (!axes_.empty() && in.next_is(axes_)) return frame_;
    const std::string_view before = in.left();
    const Eigen::Vector3d x = in.vector<3>(",\"x\":"), y = in.vector<3>(",\"y\":");
    in.skip("}");
    in.expect(is_unit(x.norm()) && is_unit(y.norm()) && is_square(x.dot(y)));
    frame_ = {frame_.origin, x, y};
    axes_ = before.substr(0, before.size() - in.left().size());
    return frame_;
  }

 private:
  SharedFrame frame_;
  std::string_view axes_;  // their text
};

elastica::Elastica scan_elastica(Scanner& in) {
  elastica::Elastica e;
  e.x = in.field("{\"x\":");
  e.y = in.field(",\"y\":");
  e.theta = in.field(",\"theta\":");
  e.kappa = in.field(",\"kappa\":");
  e.lambda1 = in.field(",\"lambda1\":");
  e.lambda2 = in.field(",\"lambda2\":");
  e.length = in.field(",\"length\":", kPositive);
  in.skip("}");
  return e;
}

Pose scan_clamp(Scanner& in) {
  Pose pose;
  pose.p = in.vector<3>("{\"p\":");
  const Eigen::Vector4d q = in.vector<4>(",\"q\":");
  in.skip("}");
  in.expect(is_unit(q.norm()));
  pose.q = Eigen::Quaterniond(q[0], q[1], q[2], q[3]);
  return pose;
}

PoseLoads scan_loads(Scanner& in) {
  const auto load = [&](std::string_view key, Range range) {
    return static_cast<float>(in.field(key, range));
  };
  PoseLoads loads;
  loads.force_n = load("{\"force_n\":", kLoadSize);
  loads.moment_a_n_mm = load(",\"moment_a_n_mm\":", kLoad);
  loads.moment_b_n_mm = load(",\"moment_b_n_mm\":", kLoad);
  loads.stress_mpa = load(",\"stress_mpa\":", kLoadSize);
  loads.droop_mm = load(",\"droop_mm\":", kLoadSize);
  loads.in_plane_sag_mm = load(",\"in_plane_sag_mm\":", kLoadSize);
  in.skip("}");
  return loads;
}

void scan_foam(Scanner& in, double blade_length_mm, BladePose& pose) {
  in.skip(",\"foam\":");
  if (in.next_is("null")) return;
  const Eigen::Vector2d foam = in.vector<2>("", foam_range(blade_length_mm));
  in.expect(foam[0] < foam[1]);
  pose.foam = {{foam[0], foam[1]}};
}

ArmJoints scan_joints(Scanner& in, std::string_view key) {
  const Eigen::Matrix<double, kArmJoints, 1> values = in.vector<kArmJoints>(key);
  ArmJoints joints;
  std::copy(values.data(), values.data() + kArmJoints, joints.begin());
  return joints;
}

void scan_pose(Scanner& in, FrameScanner& frames, double blade_length_mm, double clamp_reach_mm,
               std::size_t ribs, ScannedPoses& into) {
  BladePose& pose = into.poses.emplace_back();
  pose.t = in.field("{\"t\":", kTime);
  pose.phase = scan_phase(in);
  in.skip("\",\"heat\":");
  pose.heat = in.next_is("true");
  if (!pose.heat) in.skip("false");
  in.skip(",\"frame\":");
  pose.frame = frames.next(in);
  in.skip(",\"blade\":");
  pose.blade = scan_elastica(in);
  in.expect(is_blade_length(pose.blade.length, blade_length_mm));
  scan_foam(in, blade_length_mm, pose);
  in.skip(",\"a\":");
  pose.a = scan_clamp(in);
  in.skip(",\"b\":");
  pose.b = scan_clamp(in);
  in.expect(within_reach((pose.a.p - pose.b.p).norm(), blade_length_mm + clamp_reach_mm));
  pose.margin = in.field(",\"margin\":");
  in.skip(",\"margin_mm\":");
  if (!in.next_is("null")) pose.margin_mm = in.number(kNotNegative);
  if (in.next_is(",\"loads\":")) pose.loads = scan_loads(in);
  in.skip(",\"rib\":");
  if (!in.next_is("null")) pose.rib = static_cast<int>(in.index(ribs));
  if (in.next_is(",\"joints\":")) {
    ClampJoints& joints = into.joints.emplace_back();
    joints.a = scan_joints(in, "{\"a\":");
    joints.b = scan_joints(in, ",\"b\":");
    in.skip("}");
  }
  in.skip("}");
}

}  // namespace

std::optional<ScannedPoses> scan_poses(std::string_view& text, double blade_length_mm, double clamp_reach_mm,
                                       std::size_t ribs) {
  Scanner in(text);
  FrameScanner frames;
  ScannedPoses scanned;
  const std::vector<BladePose>& poses = scanned.poses;
  in.skip("\n");
  do {
    scan_pose(in, frames, blade_length_mm, clamp_reach_mm, ribs, scanned);
    in.expect(poses.size() < 2 || microseconds(poses.back().t) > microseconds(poses[poses.size() - 2].t));
  } while (in.next_is(",\n"));
  in.skip("]");
  if (!in.good() || poses.size() < 2) return std::nullopt;
  if (!scanned.joints.empty() && scanned.joints.size() != poses.size()) return std::nullopt;
  text = in.left();
  return scanned;
}

}  // namespace hotblade::pipeline
