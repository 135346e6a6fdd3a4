#include "pipeline/program/strip_jobs.hpp"

#include <arpa/inet.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <span>

#include "pipeline/program/forming_gap.hpp"
#include "pipeline/program/program_text.hpp"
#include "pipeline/settings/error.hpp"

namespace hotblade::pipeline {
namespace {

robot::Sha256 hash_of(const std::string& text) {
  return robot::sha256({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

void require_passed(const std::filesystem::path& file, const Program& program, bool overridden) {
  if (overridden || program.verification.status == VerificationStatus::kPassed) return;
  throw Error(ErrorKind::kNotCuttable, file.string() + ": verification.status: the program did not pass (" +
                                           name(program.verification.status) +
                                           ", passed): plan it again, or take the risk with --override");
}

// Cold, the blade would be forced through the foam.
void require_hot(const std::filesystem::path& file, const Program& program, bool overridden) {
  for (const Strip& strip : program.strips) {
    const auto gap = forming_gap(strip);
    if (!gap || overridden) continue;
    throw Error(ErrorKind::kNotCuttable, file.string() + ": " + describe(strip, *gap) +
                                             ": plan it again, or take the risk with --override");
  }
}

robot::JobArms arms_of(const ProgramCell& cell, const Strip& strip) {
  robot::JobArms arms;
  arms.declared.cell_id = cell_id(cell.sha256);
  arms.declared.joints_rad = {strip.joints.front().a, strip.joints.front().b};
  for (std::size_t i = 0; i < arms.names.size(); ++i) arms.names[i] = cell.arms[i].id;
  return arms;
}

}  // namespace

std::uint64_t cell_id(const std::string& sha256) {
  std::uint64_t value = 0;
  constexpr std::size_t kDigits = 16;
  std::from_chars(sha256.data(), sha256.data() + std::min(sha256.size(), kDigits), value, 16);
  return value;
}

StripJobs read_strip_jobs(const std::filesystem::path& program_file, bool overridden) {
  StripJobs result;
  robot::Sha256 hash;
  {
    const std::string text = file_text(program_file);
    hash = hash_of(text);
    result.program = parse_program(text, program_file.string());
  }
  require_passed(program_file, result.program, overridden);
  require_hot(program_file, result.program, overridden);
  for (const Strip& strip : result.program.strips) {
    try {
      const robot::ClampedBlade blade{result.program.blade, strip.blade_length_mm};
      result.jobs.push_back(robot::make_job(hash, strip.id, waypoints(strip), blade));
      if (result.program.cell && strip.arms) result.jobs.back().arms = arms_of(*result.program.cell, strip);
    } catch (const robot::JobError& error) {
      throw Error(ErrorKind::kBadInput, program_file.string() + ": " + error.what());
    }
  }
  return result;
}

double duration_s(const robot::Job& job) {
  return robot::protocol::time_us(job.raw.back()) * 1e-6;
}

robot::MotionLimits motion_limits(const MotionSettings& motion, const MachineSettings& machine) {
  robot::MotionLimits limits;
  limits.speed_mm_s = motion.travel_mm_s;
  limits.accel_mm_s2 = motion.accel_mm_s2;
  limits.angular_rad_s = motion.angular_rad_s;
  limits.angular_accel_rad_s2 = motion.angular_accel_rad_s2;
  const auto& size = machine.envelope_mm;
  limits.envelope_min_mm = {-size[0] / 2, -size[1] / 2, 0};
  limits.envelope_max_mm = {size[0] / 2, size[1] / 2, size[2]};
  limits.clamps = machine.clamps;
  return limits;
}

robot::MotionLimits planned_limits(const Program& program) {
  return motion_limits(program.settings.motion, program.settings.machine);
}

robot::BladeCheckOptions planned_blade(const Program& program) {
  robot::BladeCheckOptions options;
  options.safety = program.blade.safety;
  options.min_margin = program.settings.blade.min_margin;
  options.offsets = program.settings.machine.clamps;
  return options;
}

bool HostPort::loopback() const {
  in_addr v4{};
  constexpr std::uint32_t kLoopbackNet = 127;  // 127.0.0.0/8, as an address: "127.example.org" is a name
  const bool is_v4 = ::inet_pton(AF_INET, host.c_str(), &v4) == 1;
  return host == "localhost" || host == "::1" || (is_v4 && ntohl(v4.s_addr) >> 24 == kLoopbackNet);
}

HostPort parse_host_port(const std::string& text, const std::string& option) {
  const auto colon = text.rfind(':');
  HostPort result;
  bool ok = colon != std::string::npos && colon > 0;
  if (ok) {
    result.host = text.substr(0, colon);
    if (result.host.size() > 2 && result.host.front() == '[' && result.host.back() == ']') {
      result.host = result.host.substr(1, result.host.size() - 2);
    }
    const char* end = text.data() + text.size();
    const auto parsed = std::from_chars(text.data() + colon + 1, end, result.port);
    ok = parsed.ec == std::errc() && parsed.ptr == end;
  }
  if (!ok) throw Error(ErrorKind::kBadSettings, option + ": not an address (" + text + "): use HOST:PORT");
  return result;
}

std::string clock_text(double seconds) {
  const auto whole = static_cast<long>(std::lround(std::max(seconds, 0.0)));
  const auto two = [](long value) { return (value < 10 ? "0" : "") + std::to_string(value); };
  const long hours = whole / 3600, minutes = whole / 60 % 60;
  const std::string tail = two(whole % 60);
  if (hours > 0) return std::to_string(hours) + ":" + two(minutes) + ":" + tail;
  return std::to_string(minutes) + ":" + tail;
}

}  // namespace hotblade::pipeline
