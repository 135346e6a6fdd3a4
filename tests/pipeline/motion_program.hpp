// A cut program whose strips a controller accepts: flat arcs that sink, turn, bend and come back. What the
// ribs say does not matter here.
#pragma once

#include <string>

#include "pipeline/program/program.hpp"
#include "tests/pipeline/vault_program.hpp"
#include "tests/robot/wire/sample_job.hpp"

namespace hotblade::pipeline::testing {

inline Program motion_program(int strips, std::size_t poses, double dt_s = 0.05) {
  VaultOptions options;
  options.strips = strips;
  Program program = vault_program(options);
  for (Strip& strip : program.strips) {
    const BladePose pattern = strip.poses.front();
    strip.poses.clear();
    strip.blade_length_mm = robot::testing::kBladeLength_mm;
    strip.design_to_cell = {};
    for (const auto& w : robot::testing::sample_waypoints(poses, static_cast<std::uint32_t>(dt_s * 1e6))) {
      BladePose pose = pattern;
      pose.t = w.t_us * 1e-6;
      pose.phase = StripPhase::kForm;
      pose.foam.reset();
      pose.rib.reset();
      pose.blade.length = strip.blade_length_mm;
      pose.heat = w.heat;
      pose.a = w.a;
      pose.b = w.b;
      strip.poses.push_back(pose);
    }
  }
  return program;
}

}  // namespace hotblade::pipeline::testing
