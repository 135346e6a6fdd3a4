#include <fmt/format.h>

#include <array>
#include <iterator>

#include "pipeline/export/robot_jobs.hpp"
#include "pipeline/export/robot_programs.hpp"

namespace hotblade::pipeline {

namespace {

// What the cell, or nobody, calls them.
struct Names {
  std::string tool = "hb_clamp", wobj = "hb_cell", heat = "hb_heat";
  std::array<std::string, 2> tasks{"T_ROB1", "T_ROB2"};
};

std::string rapid_pose(const Pose& pose) {
  return fmt::format("[{:.4f},{:.4f},{:.4f}],[{:.9f},{:.9f},{:.9f},{:.9f}]", pose.p.x(), pose.p.y(),
                     pose.p.z(), pose.q.w(), pose.q.x(), pose.q.y(), pose.q.z());
}

std::string robtarget(const RobotTarget& to) {
  const auto& c = to.configuration;
  return fmt::format("[{},[{},{},{},{}],[9E+09,9E+09,9E+09,9E+09,9E+09,9E+09]]", rapid_pose(to.pose), c[0],
                     c[1], c[2], c[3]);
}

std::string jointtarget(const RobotTarget& to) {
  const auto& q = to.joints_deg;
  return fmt::format("[[{:.7f},{:.7f},{:.7f},{:.7f},{:.7f},{:.7f}],[9E+09,9E+09,9E+09,9E+09,9E+09,9E+09]]",
                     q[0], q[1], q[2], q[3], q[4], q[5]);
}

// One task's modules.
class RapidWriter {
 public:
  RapidWriter(const Program& program, const RobotTask& task, Names names, RobotMoves moves)
      : program_(program), task_(task), names_(std::move(names)), moves_(moves) {}

  void write(std::vector<ExportedFile>& files) const {
    std::string calls;
    std::vector<ExportedFile> strips;
    for (const RobotJob& job : task_.jobs) {
      const std::vector<ExportedFile> parts = strip_files(job);
      for (const ExportedFile& part : parts)
        calls += fmt::format("    Load \\Dynamic,\"HOME:/\"\\File:=\"{}\";\n", part.name);
      // Called by its name, which is not known before it is loaded.
      calls += fmt::format("    %\"hb_{}\"%;\n", job.strip);
      for (const ExportedFile& part : parts)
        calls += fmt::format("    UnLoad \"HOME:/\"\\File:=\"{}\";\n", part.name);
      strips.insert(strips.end(), parts.begin(), parts.end());
    }
    files.push_back({"hb_main_" + task_.id + ".mod", main_text(calls)});
    files.insert(files.end(), strips.begin(), strips.end());
  }

 private:
  [[nodiscard]] std::string main_text(const std::string& calls) const {
    std::string tool = "[TRUE,[[0,0,0],[1,0,0,0]],[1,[0,0,1],[1,0,0,0],0,0,0]]", where;
    if (task_.arm != nullptr) {
      const Eigen::Isometry3d jaw = robot::jaw_in_flange(task_.arm->tool);
      const robot::ArmTool& t = task_.arm->tool;
      const Pose pose{jaw.translation(), robot::canonical(Eigen::Quaterniond(jaw.linear()).normalized())};
      tool = fmt::format("[TRUE,[{}],[{:g},[{:g},{:g},{:g}],[1,0,0,0],0,0,0]]", rapid_pose(pose), t.mass_kg,
                         t.cog_mm.x(), t.cog_mm.y(), t.cog_mm.z());
      where = fmt::format(
          "  ! {} is the cell's frame when this arm's base frame is [{}] in the controller's world.\n",
          names_.wobj, rapid_pose(task_.arm->base));
    } else {
      where = fmt::format("  ! Set to the cell: {} (clamp, x along the blade from A to B), {} (table).\n",
                          names_.tool, names_.wobj);
    }
    return fmt::format(
        "MODULE hb_main_{0}\n"
        "  ! {1}: {2}, arm {0}, task {3}. Not tested on hardware.\n{4}"
        "  TASK PERS tasks hb_tasks{{2}}:=[[\"{5}\"],[\"{6}\"]];\n"
        "  VAR syncident hb_ready;\n  VAR syncident hb_there;\n  VAR syncident hb_held;\n"
        "  VAR syncident hb_on;\n  VAR syncident hb_off;\n  VAR num hb_key;\n"
        "  TASK PERS tooldata {7}:={8};\n"
        "  TASK PERS wobjdata {9}:=[FALSE,TRUE,\"\",[[0,0,0],[1,0,0,0]],[[0,0,0],[1,0,0,0]]];\n\n"
        "  PROC hb_main()\n{10}  ENDPROC\nENDMODULE\n",
        task_.id, ascii(program_.created_by), ascii(program_.design.file), own_task(), where, names_.tasks[0],
        names_.tasks[1], names_.tool, tool, names_.wobj, calls);
  }

  [[nodiscard]] const std::string& own_task() const { return names_.tasks[task_.heats ? 0 : 1]; }

  [[nodiscard]] std::string with_tool() const { return names_.tool + "\\WObj:=" + names_.wobj; }

  // The operator answers at the first task; the other waits for it.
  void ask(std::string& text, const std::string& question) const {
    if (task_.heats)
      text += fmt::format("    TPReadFK hb_key,\"{}\",stEmpty,stEmpty,stEmpty,stEmpty,\"Yes\";\n", question);
  }

  [[nodiscard]] std::string begin_text(const RobotJob& job) const {
    std::string text = fmt::format(
        "  ! strip {}, clamp {}{}, blade {:g} mm\n  PROC hb_{}()\n    ConfL\\Off;\n", job.strip, job.clamp,
        job.flip ? ", the blade turned by 180 degrees in the jaw" : "", job.blade_length_mm, job.strip);
    if (task_.heats) {
      text += fmt::format("    SetDO {},0;\n    TPErase;\n", names_.heat);
      for (const std::string& line : job.texts) text += fmt::format("    TPWrite \"{}\";\n", line);
    }
    ask(text, fmt::format("{}: block in place, blade OUT of both jaws?", job.strip));
    text += "    WaitSyncTask hb_ready,hb_tasks;\n";
    text +=
        task_.arm != nullptr
            ? fmt::format("    MoveAbsJ {}\\NoEOffs,v100,fine,{};\n", jointtarget(job.load), with_tool())
            : fmt::format("    ConfJ\\Off;\n    MoveJ {},v100,fine,{};\n", robtarget(job.load), with_tool());
    text += "    WaitSyncTask hb_there,hb_tasks;\n";
    ask(text,
        fmt::format("{}: blade of {:g} mm straight in both jaws, shut?", job.strip, job.blade_length_mm));
    return text + "    WaitSyncTask hb_held,hb_tasks;\n    SyncMoveOn hb_on,hb_tasks;\n";
  }

  void append(std::string& text, const RobotStep& step) const {
    const auto out = std::back_inserter(text);
    switch (step.kind) {
      case RobotStep::Kind::kWait:
        fmt::format_to(out, "    WaitTime {:.6f};\n", step.seconds);
        return;
      case RobotStep::Kind::kHeat:
        if (task_.heats) fmt::format_to(out, "    SetDO {},{};\n", names_.heat, step.on ? 1 : 0);
        return;
      case RobotStep::Kind::kMove:
        break;
    }
    const char* zone = step.stops ? "fine" : "z0";
    if (moves_ == RobotMoves::kJoint) {
      fmt::format_to(out, "    MoveAbsJ {}\\ID:={}\\NoEOffs,v1000\\T:={:.6f},{},{};\n", jointtarget(step.to),
                     step.id, step.seconds, zone, with_tool());
    } else {
      fmt::format_to(out, "    MoveL {}\\ID:={},v1000\\T:={:.6f},{},{};\n", robtarget(step.to), step.id,
                     step.seconds, zone, with_tool());
    }
  }

  [[nodiscard]] std::vector<ExportedFile> strip_files(const RobotJob& job) const {
    std::vector<std::string> parts(1);
    std::size_t moves = 0;
    for (const RobotStep& step : job.steps) {
      if (moves == kMostMoves) {
        parts.emplace_back();
        moves = 0;
      }
      append(parts.back(), step);
      if (step.kind == RobotStep::Kind::kMove) ++moves;
    }
    std::vector<ExportedFile> files;
    std::string calls;
    for (std::size_t i = 0; i < parts.size(); ++i) calls += fmt::format("    hb_{}_{};\n", job.strip, i + 1);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const std::string module = i == 0 ? fmt::format("hb_{}_{}", job.strip, task_.id)
                                        : fmt::format("hb_{}_{}_{}", job.strip, i + 1, task_.id);
      std::string text = "MODULE " + module + "\n";
      if (i == 0) text += begin_text(job) + calls + "    SyncMoveOff hb_off;\n  ENDPROC\n\n";
      text += fmt::format("  PROC hb_{}_{}()\n{}  ENDPROC\nENDMODULE\n", job.strip, i + 1, parts[i]);
      files.push_back({module + ".mod", std::move(text)});
    }
    return files;
  }

  const Program& program_;
  const RobotTask& task_;
  Names names_;
  RobotMoves moves_;
};

}  // namespace

std::vector<ExportedFile> rapid_programs(const Program& program, const robot::Cell* cell, RobotMoves moves) {
  std::vector<ExportedFile> files;
  for (const RobotTask& task : robot_tasks(program, cell)) {
    Names names;
    if (task.arm != nullptr) {
      const robot::RapidNames& own = task.arm->rapid;
      names = {own.tool, own.wobj, own.heat, {cell->arms[0].rapid.task, cell->arms[1].rapid.task}};
    }
    RapidWriter(program, task, names, moves).write(files);
  }
  return files;
}

}  // namespace hotblade::pipeline
