// From a cut program to what the controller's room understands: jobs, limits, addresses.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/program/program.hpp"
#include "pipeline/settings/settings.hpp"
#include "robot/blade/blade_check.hpp"
#include "robot/pose/limits.hpp"
#include "robot/wire/job.hpp"

namespace hotblade::pipeline {

// A program with one job a strip, in the program's order.
struct StripJobs {
  Program program;
  std::vector<robot::Job> jobs;
};

// Returns a program with its strips encoded; `overridden` lets a program pass that was not verified. Throws
// Error: kFile when unreadable, kBadInput for no program or a waypoint no register holds, kNotCuttable when
// not passed.
[[nodiscard]] StripJobs read_strip_jobs(const std::filesystem::path& program_file, bool overridden);

// Returns the number by which controllers know a cell: the first 64 bits of its hash, given in hex.
[[nodiscard]] std::uint64_t cell_id(const std::string& sha256);

// Returns how long a strip takes, s.
[[nodiscard]] double duration_s(const robot::Job& job);

// Returns what [machine] and [motion] allow. The envelope is centred on the table in x and y and starts at z
// = 0.
[[nodiscard]] robot::MotionLimits motion_limits(const MotionSettings& motion, const MachineSettings& machine);
// Returns the limits of the machine that a program was planned for, as its settings say.
[[nodiscard]] robot::MotionLimits planned_limits(const Program& program);

// Returns the limits of the blade that a program was planned for.
[[nodiscard]] robot::BladeCheckOptions planned_blade(const Program& program);

// An address on the network; loopback() says whether it is this host's own.
struct HostPort {
  std::string host;
  std::uint16_t port = 0;
  [[nodiscard]] bool loopback() const;
};
// Returns the address that "127.0.0.1:1502", "cell.local:502" or "[::1]:1502" spell. Throws Error
// (kBadSettings), which names the option.
[[nodiscard]] HostPort parse_host_port(const std::string& text, const std::string& option);

// Returns seconds as "1:02:03" or "2:03".
[[nodiscard]] std::string clock_text(double seconds);

}  // namespace hotblade::pipeline
