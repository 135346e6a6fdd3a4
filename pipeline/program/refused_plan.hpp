// What a refused plan found, kept to be looked at. It is no program: read_program() refuses it, and with it
// everything that runs, measures or exports one.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/program/program.hpp"

namespace hotblade::pipeline {

// A limit that did not hold, in words, and where: in the design frame, where it is at a place.
struct RefusedReason {
  std::string message;
  std::optional<Eigen::Vector3d> at;
};

struct RefusedPlan {
  std::vector<RefusedReason> reasons;  // the first is the one that stands in the way
  Program found;                       // with the strips that could be planned, maybe none
};

// Returns the text of refused.json. Strips that read_refused_plan() could not take back are left out.
[[nodiscard]] std::string to_json(const RefusedPlan& plan);

// Returns whether a file says of itself that it is a refused plan. False where it cannot be read.
[[nodiscard]] bool is_refused_plan(const std::filesystem::path& file);

// Returns the refused plan of a file. Throws Error: kFile when it cannot be read, kBadInput when it is none.
[[nodiscard]] RefusedPlan read_refused_plan(const std::filesystem::path& file);

}  // namespace hotblade::pipeline
