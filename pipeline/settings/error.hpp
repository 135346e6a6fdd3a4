// What goes wrong outside the program: the one exception that the pipeline throws for it, with its kind. The
// command line makes an exit code of the kind (pipeline/cli/exit.hpp).
#pragma once

#include <stdexcept>
#include <string>

namespace hotblade::pipeline {

enum class ErrorKind {
  kBadSettings,  // a setting, an option or an address
  kBadInput,     // a mesh, a program, a log or a curve line
  kNotCuttable,  // the plan would be over its tolerance or over a limit
  kDeviation,    // a cut was measured to be over the tolerance
  kController,   // the controller refused or faulted, or the link was lost
  kFile,         // a file is missing, unreadable, unwritable or already there
  kDrawing,      // this machine draws no picture
  kInterrupted,  // the caller asked for an end
};

// what() reads `file:line: what (value, limit): hint`.
struct Error : std::runtime_error {
  Error(ErrorKind what_kind, const std::string& message) : std::runtime_error(message), kind(what_kind) {}
  ErrorKind kind;
};

}  // namespace hotblade::pipeline
