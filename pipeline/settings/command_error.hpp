// How a command ends: the exit codes outside users rely on, and the exception that carries one to main().
#pragma once

#include <stdexcept>
#include <string>

namespace hotblade::pipeline {

enum class Exit : int {
  kOk = 0,
  kInternal = 1,
  kUsage = 2,        // usage or configuration
  kBadInput = 3,     // mesh, program or curve line
  kNotCuttable = 4,  // plan over tolerance or over a limit
  kDeviation = 5,    // verify or as-cut found a deviation over the tolerance
  kController = 6,   // refused, faulted or link lost
  kFile = 7,         // missing, unreadable, unwritable or already there
  kInterrupted = 130,
};

// The error that ends a command; its what() reads `file:line: what (value, limit): hint`.
struct CommandError : std::runtime_error {
  CommandError(Exit exit_code, const std::string& message) : std::runtime_error(message), code(exit_code) {}
  Exit code;
};

}  // namespace hotblade::pipeline
