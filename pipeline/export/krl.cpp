#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <numbers>
#include <span>

#include "pipeline/export/robot_jobs.hpp"
#include "pipeline/export/robot_programs.hpp"

namespace hotblade::pipeline {

namespace {

constexpr double kDegree = std::numbers::pi / 180;

std::string krl_frame(const Pose& pose) {
  const KukaAngles k = kuka_angles(pose.q);
  return fmt::format("{{X {:.4f},Y {:.4f},Z {:.4f},A {:.7f},B {:.7f},C {:.7f}}}", pose.p.x(), pose.p.y(),
                     pose.p.z(), k.a, k.b, k.c);
}

std::string krl_axes(const RobotTarget& to) {
  const auto& q = to.joints_deg;
  return fmt::format("{{A1 {:.7f},A2 {:.7f},A3 {:.7f},A4 {:.7f},A5 {:.7f},A6 {:.7f}}}", q[0], q[1], q[2],
                     q[3], q[4], q[5]);
}

// One arm's files.
class KrlWriter {
 public:
  KrlWriter(const Program& program, const RobotTask& task, RobotMoves moves)
      : program_(program),
        task_(task),
        names_(task.arm != nullptr ? task.arm->krl : robot::KrlNames{}),
        moves_(moves) {}

  void write(std::vector<ExportedFile>& files) const {
    std::string text = fmt::format("DEF hb_main_{0}()\n  ; {1}: {2}, arm {0}. Not tested on hardware.\n",
                                   task_.id, ascii(program_.created_by), ascii(program_.design.file));
    text += fmt::format("  ; Declare in $config.dat: SIGNAL {}, {}{}.\n", names_.ready_out, names_.ready_in,
                        task_.heats ? ", " + names_.heat : "");
    if (task_.arm != nullptr) {
      const Eigen::Isometry3d jaw = robot::jaw_in_flange(task_.arm->tool);
      const robot::ArmTool& t = task_.arm->tool;
      text += fmt::format(
          "  ; Tool {} is the jaw: {}, load {:g} kg at {:g}, {:g}, {:g} mm.\n"
          "  ; Base {} is the cell's frame; the robot's root stands in it at {}.\n",
          names_.tool, krl_frame({jaw.translation(), Eigen::Quaterniond(jaw.linear())}), t.mass_kg,
          t.cog_mm.x(), t.cog_mm.y(), t.cog_mm.z(), names_.base, krl_frame(task_.arm->base));
    } else {
      text += fmt::format("  ; Tool {} is the clamp, x along the blade from A to B; base {} the table.\n",
                          names_.tool, names_.base);
    }
    text += "  ; " + names_.ready_out + " of each arm is " + names_.ready_in + " of the other.\n";
    for (const RobotJob& job : task_.jobs) text += "  " + routine(job) + "()\n";
    files.push_back({"hb_main_" + task_.id + ".src", text + "END\n"});
    for (const RobotJob& job : task_.jobs) files.push_back({routine(job) + ".src", strip_text(job)});
  }

 private:
  [[nodiscard]] std::string routine(const RobotJob& job) const {
    return fmt::format("hb_{}_{}", job.strip, task_.id);
  }

  [[nodiscard]] std::string strip_text(const RobotJob& job) const {
    std::string text = fmt::format(
        "DEF {}()\n  ; strip {}, clamp {}{}, blade {:g} mm. Not tested on hardware.\n  BAS(#INITMOV,0)\n"
        "  BAS(#VEL_PTP,10)\n  $TOOL=TOOL_DATA[{}]\n  $BASE={}\n",
        routine(job), job.strip, job.clamp, job.flip ? ", the blade turned by 180 degrees in the jaw" : "",
        job.blade_length_mm, names_.tool,
        names_.base == 0 ? "$NULLFRAME" : fmt::format("BASE_DATA[{}]", names_.base));
    text += fmt::format("  {}=FALSE\n", names_.ready_out);
    if (task_.heats) text += fmt::format("  {}=FALSE\n", names_.heat);
    for (const std::string& line : job.texts) text += fmt::format("  MsgNotify(\"{}\",\"hotblade\")\n", line);
    halt(text, fmt::format("{}: block in place, blade OUT of both jaws?", job.strip));
    text += task_.arm != nullptr ? fmt::format("  PTP {}\n", krl_axes(job.load))
                                 : fmt::format("  SPTP {}\n", krl_frame(job.load.pose));
    halt(text,
         fmt::format("{}: blade of {:g} mm straight in both jaws, shut?", job.strip, job.blade_length_mm));
    bool said = false;  // what the ready signal is
    for (std::size_t i = 0; i < job.steps.size();) i = append(text, job, i, said);
    if (task_.heats) text += fmt::format("  {}=FALSE\n", names_.heat);
    if (said) meet(text, said);
    return text + "END\n";
  }

  static void halt(std::string& text, const std::string& question) {
    text += fmt::format("  MsgNotify(\"{}\",\"hotblade\")\n  HALT\n", question);
  }

  // The arms wait for each other: each says so by changing its signal, and hears the same of the other.
  void meet(std::string& text, bool& said) const {
    said = !said;
    text += fmt::format("  {}={}\n  WAIT FOR {}{}\n", names_.ready_out, said ? "TRUE" : "FALSE",
                        said ? "" : "NOT ", names_.ready_in);
  }

  // Appends what stands at a step, moves up to the next rest together; returns the step behind.
  std::size_t append(std::string& text, const RobotJob& job, std::size_t i, bool& said) const {
    const RobotStep& step = job.steps[i];
    const auto out = std::back_inserter(text);
    if (step.kind == RobotStep::Kind::kWait) {
      fmt::format_to(out, "  WAIT SEC {:.6f}\n", step.seconds);
      return i + 1;
    }
    if (step.kind == RobotStep::Kind::kHeat) {
      // WAIT SEC 0 holds the interpreter until the motion is there.
      if (task_.heats)
        fmt::format_to(out, "  WAIT SEC 0\n  {}={}\n", names_.heat, step.on ? "TRUE" : "FALSE");
      return i + 1;
    }
    std::size_t end = i;
    while (!job.steps[end].stops) ++end;
    spline(text, std::span(job.steps).subspan(i, end + 1 - i), said);
    return end + 1;
  }

  // Each segment is its part of the block's time, in millionths of a percent, all of them together 100.
  void spline(std::string& text, std::span<const RobotStep> steps, bool& said) const {
    const bool joint = moves_ == RobotMoves::kJoint;
    double whole = 0;
    for (const RobotStep& step : steps) whole += step.seconds;
    meet(text, said);
    const auto out = std::back_inserter(text);
    fmt::format_to(out, "  {}\n    TIME_BLOCK START\n", joint ? "PTP_SPLINE" : "SPLINE");
    constexpr long long kParts = 100'000'000;
    double time = 0;
    long long before = 0;
    for (const RobotStep& step : steps) {
      if (joint) {
        fmt::format_to(out, "    SPTP {}\n", krl_axes(step.to));
      } else {
        fmt::format_to(out, "    SPL {}\n", krl_frame(step.to.pose));
      }
      time += step.seconds;
      const long long now = &step == &steps.back() ? kParts : std::llround(kParts * time / whole);
      fmt::format_to(out, "    TIME_BLOCK PART={}.{:06}\n", (now - before) / 1'000'000,
                     (now - before) % 1'000'000);
      before = now;
    }
    fmt::format_to(out, "    TIME_BLOCK END={:.6f}\n  ENDSPLINE\n", whole);
  }

  const Program& program_;
  const RobotTask& task_;
  robot::KrlNames names_;
  RobotMoves moves_;
};

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

std::vector<ExportedFile> krl_programs(const Program& program, const robot::Cell* cell, RobotMoves moves) {
  std::vector<ExportedFile> files;
  for (const RobotTask& task : robot_tasks(program, cell)) KrlWriter(program, task, moves).write(files);
  return files;
}

}  // namespace hotblade::pipeline
