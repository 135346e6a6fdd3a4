// What a simulated machine can be told to do wrong (hotblade sim --fault).
#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>

namespace hotblade::robot {

// A fault that cannot be told, as `SPEC: what (value, range): hint`.
struct FaultSpecError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// The faults to come. Each but the first happens once; drives that stand keep standing.
struct SimulatedFaults {
  double slow = 1;                         // the drives reach this share of the speed asked for, (0, 1]
  std::optional<std::uint32_t> drive_at;   // a drive's fault, at this waypoint
  std::optional<std::uint32_t> stall_at;   // from this waypoint on the clamps stand
  std::optional<std::uint32_t> reboot_at;  // the controller starts again from its journal
  std::optional<double> estop_at_s;        // somebody stops the machine, s of the motion clock

  // Adds a fault by its word: "slow=0.5", "fault@120", "stall" (from the first waypoint), "stall@120",
  // "reboot@120", "estop@3.5". Throws FaultSpecError.
  void add(const std::string& spec);
};

}  // namespace hotblade::robot
