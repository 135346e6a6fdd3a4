#include <fmt/format.h>

#include <iterator>

#include "pipeline/export/robot_programs.hpp"

namespace hotblade::pipeline {

namespace {

// External axes unused, configuration left to ConfL\Off.
std::string robtarget(const Pose& pose) {
  return fmt::format(
      "[[{:.4f},{:.4f},{:.4f}],[{:.9f},{:.9f},{:.9f},{:.9f}],[0,0,0,0],[9E+09,9E+09,9E+09,9E+09,9E+09,9E+09]"
      "]",
      pose.p.x(), pose.p.y(), pose.p.z(), pose.q.w(), pose.q.x(), pose.q.y(), pose.q.z());
}

// To the first waypoint one arm after the other decides: by hand or by the cell's own moves. From there on
// the arms move together.
void append_rapid_strip(std::string& text, const Strip& strip, char arm) {
  const std::vector<robot::Waypoint> path = waypoints(strip);
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "  ! strip {}, blade {:g} mm, {} waypoints\n  PROC {}()\n", strip.id,
                 strip.blade_length_mm, path.size(), strip.id);
  fmt::format_to(out, "    ConfL\\Off;\n    ConfJ\\Off;\n    MoveJ {},v100,fine,hb_clamp\\WObj:=hb_cell;\n",
                 robtarget(clamp_of(path.front(), arm)));
  text += "    SyncMoveOn hb_on,hb_tasks;\n";
  bool heat = false;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const robot::Waypoint &from = path[i - 1], &to = path[i];
    if (from.heat != heat) {
      heat = from.heat;
      // The output belongs to one arm; both wait for the same point.
      if (arm == 'A') fmt::format_to(out, "    SetDO hb_heat,{};\n", heat ? 1 : 0);
    }
    const bool last = i + 1 == path.size();
    fmt::format_to(out, "    MoveL {}\\ID:={},v1000\\T:={:.6f},{},hb_clamp\\WObj:=hb_cell;\n",
                   robtarget(clamp_of(to, arm)), 10 * i, kMicrosecond * (to.t_us - from.t_us),
                   last ? "fine" : "z0");
  }
  if (arm == 'A') text += "    SetDO hb_heat,0;\n";
  text += "    SyncMoveOff hb_off;\n  ENDPROC\n\n";
}

std::string rapid_text(const Program& program, char arm) {
  std::string text = fmt::format(
      "MODULE hb_arm_{0}\n  ! {1}: {2}, arm {3}. Not tested on hardware.\n"
      "  ! Set to the cell: hb_clamp (jaw, x along the blade), hb_cell (table), hb_heat, hb_tasks.\n"
      "  PERS tasks hb_tasks{{2}}:=[[\"T_ROB1\"],[\"T_ROB2\"]];\n  VAR syncident hb_on;\n  VAR syncident "
      "hb_off;\n"
      "  PERS tooldata hb_clamp:=[TRUE,[[0,0,0],[1,0,0,0]],[1,[0,0,1],[1,0,0,0],0,0,0]];\n"
      "  PERS wobjdata hb_cell:=[FALSE,TRUE,\"\",[[0,0,0],[1,0,0,0]],[[0,0,0],[1,0,0,0]]];\n\n",
      arm == 'A' ? 'a' : 'b', program.created_by, program.design.file, arm);
  for (const Strip& strip : program.strips) append_rapid_strip(text, strip, arm);
  text += "  PROC hb_main()\n";
  for (const Strip& strip : program.strips) {
    // A halt before each block: it has to be put on the table.
    text += fmt::format("    Stop;\n    {};\n", strip.id);
  }
  return text + "  ENDPROC\nENDMODULE\n";
}

}  // namespace

std::vector<ExportedFile> rapid_programs(const Program& program) {
  return {{"hb_arm_a.mod", rapid_text(program, 'A')}, {"hb_arm_b.mod", rapid_text(program, 'B')}};
}

}  // namespace hotblade::pipeline
