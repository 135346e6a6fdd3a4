#include "pipeline/cli/run_dialogue.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <array>
#include <cerrno>
#include <cmath>
#include <iostream>

#include "pipeline/cli/command.hpp"
#include "pipeline/verify/branch.hpp"

namespace hotblade::pipeline {

namespace {

// The direction of the design that points up on the table: `the design's +z`.
std::string up_text(const Strip& strip) {
  const Eigen::Vector3d up = strip.design_to_cell.q.conjugate() * Eigen::Vector3d::UnitZ();
  constexpr std::array kAxes{"x", "y", "z"};
  constexpr double kAligned = 0.9998;  // within one degree
  for (int i = 0; i < 3; ++i) {
    if (std::abs(up[i]) > kAligned)
      return fmt::format("the design's {}{}", up[i] > 0 ? "+" : "-", kAxes[static_cast<std::size_t>(i)]);
  }
  return fmt::format("({:.2f}, {:.2f}, {:.2f}) of the design", up.x(), up.y(), up.z());
}

}  // namespace

// Read past every buffer of our own: what is typed after a line stays with the terminal, which the next
// question empties.
std::optional<std::string> ask(const std::string& question) {
  ::tcflush(STDIN_FILENO, TCIFLUSH);
  std::cerr << question << std::flush;
  std::string line;
  constexpr int kLook_ms = 100;  // for Ctrl-C that came between two reads
  pollfd terminal{STDIN_FILENO, POLLIN, 0};
  while (!line.ends_with('\n')) {
    char c = 0;
    const int ready = interrupted() ? -1 : ::poll(&terminal, 1, kLook_ms);
    if (ready == 0 || (ready < 0 && errno == EINTR && !interrupted())) continue;
    if (ready < 0 || ::read(STDIN_FILENO, &c, 1) != 1) {
      std::cerr << '\n';  // the question's line is still open
      return std::nullopt;
    }
    line += c;
  }
  line.pop_back();
  if (line.ends_with('\r')) line.pop_back();  // of a terminal that ends lines with both
  return line;
}

std::string start_question(const Strip& strip, const robot::Job& job,
                           const robot::protocol::Status& controller, bool resumes) {
  const auto& size = strip.block.size_mm;
  std::string text = fmt::format(
      "strip {}: blade {:g} mm, block {:.0f} x {:.0f} x {:.0f} mm with {} up, standing {:.0f} mm above the "
      "table, {}; the controller is {}\n",
      strip.id, strip.blade_length_mm, size.x(), size.y(), size.z(), up_text(strip),
      strip.block.height_above_table_mm(strip.design_to_cell), clock_text(duration_s(job)),
      robot::protocol::name(controller.state));
  if (resumes && controller.job_id == job.id && controller.executed > 0) {
    text += fmt::format(
        "It is half cut: {} of {} waypoints executed{}. The same block goes on: a blade that is cold in the "
        "foam goes back along its kerf, is heated, and comes forward again.\n",
        controller.executed, job.size(), place_of(strip, controller.executed - 1));
  }
  return text + fmt::format(
                    "This blade and this block in place, cell clear? Type yes or {} to start, anything else "
                    "stops: ",
                    strip.id);
}

std::string place_of(const Strip& strip, std::optional<std::uint32_t> waypoint) {
  if (!waypoint || *waypoint >= strip.poses.size()) return "";
  const BladePose& pose = strip.poses[*waypoint];
  std::string rib = pose.rib ? strip.ribs[static_cast<std::size_t>(*pose.rib)].id : rib_at(strip, *waypoint);
  if (rib.empty()) rib = "no rib";
  return fmt::format(" [{}, {}, {}, {:.3f} s]", strip.id, rib, name(pose.phase), pose.t);
}

std::optional<Recovery> recovery_named(std::string_view word) {
  if (word == "withdraw") return Recovery::kWithdraw;
  if (word == "restart") return Recovery::kRestart;
  if (word == "give up" || word == "give-up") return Recovery::kGiveUp;
  return std::nullopt;
}

std::string recovery_text(const Strip& strip, const robot::Job& job,
                          const robot::protocol::Status& controller) {
  const std::string stands = controller.left_in_cut ? "was left half cut" : "is held under way";
  return fmt::format(
      "strip {} {}: {} of {} waypoints executed{}{}; nothing moves\n"
      "  withdraw  draws the blade back along the path it has cut, cold, to where the strip began; the strip "
      "is over\n"
      "  restart   goes on with the same block: {}\n"
      "  give up   moves nothing: you free the blade and take the block out by hand; the strip is over\n",
      strip.id, stands, controller.executed, job.size(), place_of(strip, controller.executed - 1),
      controller.left_in_cut ? ", the blade cold in the foam" : "",
      controller.left_in_cut
          ? "back along the kerf, heated, forward again and on from there"
          : "on from there, where the blade is cold in the foam back along the kerf first, heated, and "
            "forward again");
}

std::string progress_text(const robot::Job& job, const robot::StreamProgress& p) {
  if (p.link_lost_s > 0)
    return fmt::format("{} link lost, trying again, {:.0f} s", job.strip, std::floor(p.link_lost_s));
  std::string text = fmt::format("{} {} {}/{} {} left", job.strip, robot::protocol::name(p.state), p.executed,
                                 p.total, clock_text(p.left_s));
  if (p.fault != robot::protocol::Fault::kNone) text += fmt::format(" ({})", robot::protocol::name(p.fault));
  if (p.reconnects > 0) text += fmt::format(", {} reconnects", p.reconnects);
  return text;
}

}  // namespace hotblade::pipeline
