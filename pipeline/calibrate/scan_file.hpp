// Reads the points of a measured cut.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hotblade::pipeline {

// Fewer say nothing, more are no scan of a block.
inline constexpr std::size_t kLeastScanPoints = 200, kMostFilePoints = 20'000'000;

// Returns the points of a scan in mm: the vertices of a PLY, with or without faces, or the rows of a CSV:
// three numbers each, after one line x,y,z or without it; lines that begin with # and empty ones are passed
// over. `units` is mm, cm, m, in or ft. Throws Error, with the line or vertex: kFile where it cannot be read,
// kBadInput for anything else that stands there, for too few points, and for points that all lie in one place
// or on one line.
[[nodiscard]] std::vector<Eigen::Vector3d> read_scan(const std::filesystem::path& file,
                                                     const std::string& units);
[[nodiscard]] std::vector<Eigen::Vector3d> parse_scan_csv(std::string_view text, const std::string& name);

// Returns the points as such a CSV, in mm with four decimals.
[[nodiscard]] std::string scan_csv(std::span<const Eigen::Vector3d> points);

}  // namespace hotblade::pipeline
