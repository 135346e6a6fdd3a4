#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <numbers>

#include "pipeline/export/robot_programs.hpp"

namespace hotblade::pipeline {

namespace {

constexpr double kDegree = std::numbers::pi / 180;

std::string krl_point(const Pose& pose) {
  const KukaAngles k = kuka_angles(pose.q);
  return fmt::format("{{X {:.4f},Y {:.4f},Z {:.4f},A {:.7f},B {:.7f},C {:.7f}}}", pose.p.x(), pose.p.y(),
                     pose.p.z(), k.a, k.b, k.c);
}

// The arms say that they are ready and wait for each other; the spline's time block keeps them together.
void append_meeting(std::string& text) {
  text += "  hb_ready_out=TRUE\n  WAIT FOR hb_ready_in\n";
}

// Every segment is one part of the time block, so each waypoint is reached at its own time.
void append_krl_strip(std::string& text, const Strip& strip, char arm) {
  const std::vector<robot::Waypoint> path = waypoints(strip);
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "DEF {}()\n  ; blade {:g} mm, {} waypoints\n  SPTP {}\n", strip.id,
                 strip.blade_length_mm, path.size(), krl_point(clamp_of(path.front(), arm)));
  append_meeting(text);
  text += "  SPLINE\n    TIME_BLOCK START\n";
  bool heat = false;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const robot::Waypoint &from = path[i - 1], &to = path[i];
    if (from.heat != heat) {
      heat = from.heat;
      if (arm == 'A')
        fmt::format_to(out, "    TRIGGER WHEN PATH=0 DELAY=0 DO hb_heat={}\n", heat ? "TRUE" : "FALSE");
    }
    fmt::format_to(out, "    SLIN {}\n", krl_point(clamp_of(to, arm)));
    const bool last = i + 1 == path.size();
    if (!last) fmt::format_to(out, "    TIME_BLOCK PART={:.6f}\n", kMicrosecond * (to.t_us - from.t_us));
  }
  const std::size_t n = path.size();
  fmt::format_to(out, "    TIME_BLOCK PART={:.6f}\n    TIME_BLOCK END={:.6f}\n  ENDSPLINE\n",
                 kMicrosecond * (path[n - 1].t_us - path[n - 2].t_us),
                 kMicrosecond * (path[n - 1].t_us - path[0].t_us));
  if (arm == 'A') text += "  hb_heat=FALSE\n";
  text += "  hb_ready_out=FALSE\nEND\n\n";
}

std::string krl_text(const Program& program, char arm) {
  const char* name = arm == 'A' ? "hb_arm_a" : "hb_arm_b";
  std::string text = fmt::format(
      "DEF {}()\n  ; {}: {}, arm {}. Not tested on hardware.\n"
      "  ; Declare in $config.dat: SIGNAL hb_heat, hb_ready_out, hb_ready_in; tool 1 is the clamp's jaw (x "
      "along\n"
      "  ; the blade), base 1 the table.\n  $TOOL=TOOL_DATA[1]\n  $BASE=BASE_DATA[1]\n",
      name, program.created_by, program.design.file, arm);
  for (const Strip& strip : program.strips) text += fmt::format("  HALT\n  {}()\n", strip.id);
  text += "END\n\n";
  for (const Strip& strip : program.strips) append_krl_strip(text, strip, arm);
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

std::vector<ExportedFile> krl_programs(const Program& program) {
  return {{"hb_arm_a.src", krl_text(program, 'A')}, {"hb_arm_b.src", krl_text(program, 'B')}};
}

}  // namespace hotblade::pipeline
