// A small barrel vault as a cut program, made without the planner: parallel circular ribs, so that every
// number in it is known in closed form.
#pragma once

#include <cmath>
#include <string>

#include "pipeline/program/program.hpp"

namespace hotblade::pipeline::testing {

struct VaultOptions {
  int strips = 1;  // side by side along y
  int poses = 40;  // a strip
  double half_band_mm = 0.5;
  double bulge_mm = 0;  // the blade cuts this much off the design halfway along the sweep
};

constexpr double kVaultRadius = 400, kVaultHalfAngle = 0.4, kVaultStripWidth = 250;
constexpr double kVaultBlade = 600;

// The arc of the vault's ribs, first end to last, in a rib frame with its origin at the first end.
inline elastica::Elastica vault_arc(double radius, double half_angle) {
  return {0, 0, half_angle, -1 / radius, 0, 0, 2 * radius * half_angle};
}

// Rib plane across the vault at y; origin at the first end of an arc of this radius about the vault's axis.
inline Frame vault_frame(double y, double radius) {
  const double drop = kVaultRadius * std::cos(kVaultHalfAngle);
  Frame frame;
  frame.origin = {-radius * std::sin(kVaultHalfAngle), y, radius * std::cos(kVaultHalfAngle) - drop};
  frame.x = Eigen::Vector3d::UnitX();
  frame.y = Eigen::Vector3d::UnitZ();
  return frame;
}

inline Pose vault_clamp(const Frame& frame, double radius, double angle) {
  const double theta = -angle;  // tangent turns from +half angle at clamp A to -half angle at B
  Eigen::Matrix3d axes;
  axes.col(0) = std::cos(theta) * frame.x + std::sin(theta) * frame.y;
  axes.col(1) = -std::sin(theta) * frame.x + std::cos(theta) * frame.y;
  axes.col(2) = frame.normal();
  const double foot_x = radius * std::sin(kVaultHalfAngle), foot_y = -radius * std::cos(kVaultHalfAngle);
  return {frame.point(foot_x + radius * std::sin(angle), foot_y + radius * std::cos(angle)),
          Eigen::Quaterniond(axes)};
}

inline BladePose vault_pose(const VaultOptions& options, int strip, int index) {
  const double share = double(index) / (options.poses - 1);
  const double overrun = 30;  // in air before and after the block
  const double along = -overrun + share * (kVaultStripWidth + 2 * overrun);
  const bool cutting = along >= 0 && along <= kVaultStripWidth;
  const double lift = options.bulge_mm * std::pow(std::sin(3.14159265358979 * share), 2);
  const double radius = kVaultRadius + options.half_band_mm - lift;
  const double half_blade = kVaultBlade / 2 / radius;
  BladePose pose;
  pose.t = 0.05 * index;
  pose.phase = cutting ? StripPhase::kCut : (share < 0.5 ? StripPhase::kLeadIn : StripPhase::kLeadOut);
  pose.heat = true;
  pose.frame = vault_frame(strip * kVaultStripWidth + along, radius);
  const double before =
      (half_blade - kVaultHalfAngle) * radius;  // arc from clamp A to the design's first end
  pose.blade = vault_arc(radius, half_blade);
  pose.blade.length = kVaultBlade;
  const Eigen::Vector2d foot(radius * std::sin(kVaultHalfAngle), -radius * std::cos(kVaultHalfAngle));
  pose.blade.x = foot.x() - radius * std::sin(half_blade);
  pose.blade.y = foot.y() + radius * std::cos(half_blade);
  if (cutting) pose.foam = std::array{before, kVaultBlade - before};
  pose.a = vault_clamp(pose.frame, radius, -half_blade);
  pose.b = vault_clamp(pose.frame, radius, half_blade);
  pose.margin = 39.5;
  if (index % 2 == 0) pose.margin_mm = 12.5;
  if (cutting) pose.rib = index < options.poses / 2 ? 0 : 1;
  return pose;
}

inline Rib vault_rib(const std::string& id, double y) {
  const double radius = kVaultRadius + 0.5;
  Rib rib;
  rib.id = id;
  rib.frame = vault_frame(y, radius);
  rib.elastica = vault_arc(radius, kVaultHalfAngle);
  for (int i = 0; i < 9; ++i) {
    const double angle = kVaultHalfAngle * (i / 4.0 - 1);
    rib.target.emplace_back(radius * (std::sin(kVaultHalfAngle) + std::sin(angle)),
                            radius * (std::cos(angle) - std::cos(kVaultHalfAngle)));
  }
  const Eigen::Vector2d first = rib.target.front(), last = rib.target.back();
  // A cubic with the arc's end tangents; handle length of the usual quarter-angle rule.
  const double handle = 4.0 / 3 * std::tan(kVaultHalfAngle / 2) * radius;
  const Eigen::Vector2d up(std::cos(kVaultHalfAngle), std::sin(kVaultHalfAngle)), down(up.x(), -up.y());
  rib.bezier = {first, first + handle * up, last - handle * down, last};
  rib.lambda_residual = 0.001;
  rib.l2 = 1e-5;
  rib.h1 = 2e-5;
  rib.hausdorff_mm = 0.01;
  rib.design_deviation_mm = 0.1 + 0.2;  // a number whose shortest text needs 17 digits
  return rib;
}

inline Strip vault_strip(const VaultOptions& options, int index) {
  Strip strip;
  strip.id = std::string("S00").append(std::to_string(index + 1));
  strip.blade_length_mm = kVaultBlade;
  strip.design_to_cell.p = {0, 0, 150};
  strip.block.frame.origin = {-180, index * kVaultStripWidth, -60};
  strip.block.size_mm = {360, kVaultStripWidth, 120};
  const double y0 = index * kVaultStripWidth;
  for (int rib = 0; rib < 6; ++rib) {
    strip.ribs.push_back(
        vault_rib(strip.id + "R00" + std::to_string(rib + 1), y0 + rib * kVaultStripWidth / 5));
  }
  for (int pose = 0; pose < options.poses; ++pose) strip.poses.push_back(vault_pose(options, index, pose));
  return strip;
}

inline Program vault_program(const VaultOptions& options = {}) {
  Program program;
  program.created_by = "hotblade 0.2.0";
  program.design.file = "vault.obj";
  program.design.sha256 = std::string(64, 'a');
  program.design.source_units = "mm";
  program.design.format = surface::FileFormat::kObj;
  program.design.keep = Keep::kBelow;
  program.design.vertices = 121;
  program.design.faces = 200;
  program.design.bbox_mm = {Eigen::Vector3d(-160, 0, 0), Eigen::Vector3d(160, 250.0 * options.strips, 32)};
  program.settings.design.units = "mm";
  program.blade = {{{8, 0.5, 190000, 1010}, 0.3, 1.5, 7900, 1.0}, {400, 600, 800}};
  for (int strip = 0; strip < options.strips; ++strip) program.strips.push_back(vault_strip(options, strip));
  program.verification.status = VerificationStatus::kPassed;
  program.verification.tolerance_mm = 1.0;
  program.verification.deviation_mm = {0.42, 0.31, 0.12, -0.02, {10, 20, 30}};
  program.verification.budget_mm = {{"mesh", 0.05}, {"between ribs", 0.125}};
  program.verification.samples = 12345;
  program.verification.not_checked = {"melt-back over time", "arm reach"};
  return program;
}

}  // namespace hotblade::pipeline::testing
