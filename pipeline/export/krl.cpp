#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <numbers>

#include "pipeline/export/robot_languages.hpp"

namespace hotblade::pipeline {

namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kMicrosecond = 1e-6;

std::string point(const Pose& pose) {
  const KukaAngles k = kuka_angles(pose.q);
  return fmt::format("{{X {:.4f},Y {:.4f},Z {:.4f},A {:.7f},B {:.7f},C {:.7f}}}", pose.p.x(), pose.p.y(),
                     pose.p.z(), k.a, k.b, k.c);
}

const Pose& clamp(const robot::Waypoint& waypoint, char arm) {
  return arm == 'A' ? waypoint.a : waypoint.b;
}

// The arms say that they are ready and wait for each other; the spline's time block keeps them together.
void append_meeting(std::string& text) {
  text += "  hb_ready_out=TRUE\n  WAIT FOR hb_ready_in\n";
}

// Every segment is one part of the time block, so each waypoint is reached at its own time.
void append_strip(std::string& text, const RobotStrip& strip, char arm) {
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "DEF {}()\n  ; blade {:g} mm, {} waypoints\n  SPTP {}\n", strip.id,
                 strip.blade_length_mm, strip.path.size(), point(clamp(strip.path.front(), arm)));
  append_meeting(text);
  text += "  SPLINE\n    TIME_BLOCK START\n";
  bool heat = false;
  for (std::size_t i = 1; i < strip.path.size(); ++i) {
    const robot::Waypoint &from = strip.path[i - 1], &to = strip.path[i];
    if (from.heat != heat) {
      heat = from.heat;
      if (arm == 'A')
        fmt::format_to(out, "    TRIGGER WHEN PATH=0 DELAY=0 DO hb_heat={}\n", heat ? "TRUE" : "FALSE");
    }
    fmt::format_to(out, "    SLIN {}\n", point(clamp(to, arm)));
    const bool last = i + 1 == strip.path.size();
    if (!last) fmt::format_to(out, "    TIME_BLOCK PART={:.6f}\n", kMicrosecond * (to.t_us - from.t_us));
  }
  const std::size_t n = strip.path.size();
  fmt::format_to(out, "    TIME_BLOCK PART={:.6f}\n    TIME_BLOCK END={:.6f}\n  ENDSPLINE\n",
                 kMicrosecond * (strip.path[n - 1].t_us - strip.path[n - 2].t_us),
                 kMicrosecond * (strip.path[n - 1].t_us - strip.path[0].t_us));
  if (arm == 'A') text += "  hb_heat=FALSE\n";
  text += "  hb_ready_out=FALSE\nEND\n\n";
}

std::string program_text(const RobotJob& job, char arm) {
  const char* name = arm == 'A' ? "hb_arm_a" : "hb_arm_b";
  std::string text = fmt::format(
      "DEF {}()\n  ; {}: {}, arm {}. Not tested on hardware.\n"
      "  ; Declare in $config.dat: SIGNAL hb_heat, hb_ready_out, hb_ready_in; tool 1 is the clamp's jaw (x "
      "along\n"
      "  ; the blade), base 1 the table.\n  $TOOL=TOOL_DATA[1]\n  $BASE=BASE_DATA[1]\n",
      name, job.created_by, job.design, arm);
  for (const RobotStrip& strip : job.strips) text += fmt::format("  HALT\n  {}()\n", strip.id);
  text += "END\n\n";
  for (const RobotStrip& strip : job.strips) append_strip(text, strip, arm);
  return text;
}

}  // namespace

KukaAngles kuka_angles(const Eigen::Quaterniond& q) {
  const Eigen::Matrix3d r = q.toRotationMatrix();
  const double across = std::hypot(r(0, 0), r(1, 0));
  // Below this the first and the last axis agree to rounding.
  constexpr double kGimbal = 1e-9;
  if (across < kGimbal) {
    return {std::atan2(-r(0, 1), r(1, 1)) / kDegree, std::atan2(-r(2, 0), across) / kDegree, 0};
  }
  return {std::atan2(r(1, 0), r(0, 0)) / kDegree, std::atan2(-r(2, 0), across) / kDegree,
          std::atan2(r(2, 1), r(2, 2)) / kDegree};
}

std::vector<ExportedFile> KrlPostProcessor::files(const RobotJob& job) const {
  return {{"hb_arm_a.src", program_text(job, 'A')}, {"hb_arm_b.src", program_text(job, 'B')}};
}

}  // namespace hotblade::pipeline
