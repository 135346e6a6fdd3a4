// How a command ends: the exit codes that outside users rely on (docs/commands.md).
#pragma once

#include "pipeline/settings/error.hpp"

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

// Returns the exit code of a command that an error of this kind ends.
[[nodiscard]] constexpr Exit exit_of(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::kBadSettings:
      return Exit::kUsage;
    case ErrorKind::kBadInput:
      return Exit::kBadInput;
    case ErrorKind::kNotCuttable:
      return Exit::kNotCuttable;
    case ErrorKind::kDeviation:
      return Exit::kDeviation;
    case ErrorKind::kController:
      return Exit::kController;
    case ErrorKind::kFile:
      return Exit::kFile;
    case ErrorKind::kInterrupted:
      return Exit::kInterrupted;
    case ErrorKind::kDrawing:
      break;
  }
  return Exit::kInternal;
}

}  // namespace hotblade::pipeline
