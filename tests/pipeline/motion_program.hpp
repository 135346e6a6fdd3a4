// A cut program whose strips a controller accepts: flat arcs that sink, turn, bend and come back. What the
// ribs say does not matter here.
#pragma once

#include <string>

#include "pipeline/program/program.hpp"
#include "robot/blade/blade_branch.hpp"
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
    strip.block.frame.origin.z() = 0;
    robot::BladeBranch blade(strip.blade_length_mm, {1, 0, 1, 0});
    for (const auto& w : robot::testing::sample_waypoints(poses, static_cast<std::uint32_t>(dt_s * 1e6))) {
      BladePose pose = pattern;
      pose.t = w.t_us * 1e-6;
      const bool has_been_hot = !strip.poses.empty() && strip.poses.back().phase != StripPhase::kForm;
      pose.phase = w.heat ? StripPhase::kLeadIn : has_been_hot ? StripPhase::kRetract : StripPhase::kForm;
      pose.foam.reset();
      pose.rib.reset();
      pose.blade.length = strip.blade_length_mm;
      pose.heat = w.heat;
      pose.a = w.a;
      pose.b = w.b;
      // The shape that these clamps hold, in the axes of the first.
      if (blade.move_to(pose.a, pose.b).held()) {
        pose.blade = blade.shape();
        pose.frame = {pose.a.p, pose.a.q() * Eigen::Vector3d::UnitX(), pose.a.q() * Eigen::Vector3d::UnitY()};
      }
      strip.poses.push_back(pose);
    }
  }
  return program;
}

}  // namespace hotblade::pipeline::testing
