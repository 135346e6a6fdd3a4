#include "pipeline/program/program.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <fstream>
#include <system_error>

#include "pipeline/program/gzip.hpp"
#include "pipeline/program/program_text.hpp"
#include "pipeline/settings/error.hpp"

namespace hotblade::pipeline {

const char* name(StripPhase phase) {
  constexpr std::array kNames{"form", "preheat",  "approach", "lead_in",
                              "cut",  "lead_out", "retract",  "travel"};
  static_assert(kNames.size() == kStripPhases.size());
  return kNames.at(static_cast<std::size_t>(phase));
}

Eigen::Vector3d middle_of(const BladePose& pose) {
  const double s = pose.foam ? 0.5 * ((*pose.foam)[0] + (*pose.foam)[1]) : 0.5 * pose.blade.length;
  const elastica::CurvePoint middle = elastica::point_at(pose.blade, s);
  return pose.frame.point(middle.x, middle.y);
}

const char* name(VerificationStatus status) {
  return status == VerificationStatus::kPassed ? "passed" : "refused";
}

namespace {

std::string bytes_of(const std::filesystem::path& file) {
  std::error_code error;
  if (std::filesystem::is_directory(file, error)) {
    throw Error(ErrorKind::kFile, file.string() + ": is a directory: give its program.json");
  }
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  std::string text;
  // Room at once: a text that grows by doubling is held twice. A device or pipe has no size and grows.
  if (const auto size = std::filesystem::file_size(file, error); !error) text.reserve(size);
  std::array<char, 1 << 16> block;
  while (stream.read(block.data(), block.size()) || stream.gcount() > 0) {
    const std::size_t before = text.size();
    text.append(block.data(), static_cast<std::size_t>(stream.gcount()));
    // No text has a zero byte: what has one is no program, and may be a device that has no end.
    if (!is_gzip_name(file) && text.find('\0', before) != std::string::npos) break;
  }
  if (!stream.is_open() || stream.bad()) {
    const std::string reason = errno ? " (" + std::generic_category().message(errno) + ")" : "";
    throw Error(ErrorKind::kFile, file.string() + ": cannot be read" + reason);
  }
  return text;
}

}  // namespace

std::string file_text(const std::filesystem::path& file) {
  std::string bytes = bytes_of(file);
  if (is_gzip_name(file)) return unpacked(bytes, file.string());
  if (bytes.starts_with("\x1f\x8b"))
    throw Error(ErrorKind::kBadInput, file.string() + ": is packed (gzip): give it a name that ends in .gz");
  return bytes;
}

Program read_program(const std::filesystem::path& file) {
  return parse_program(file_text(file), file.string());
}

std::vector<robot::Waypoint> waypoints(const Strip& strip) {
  constexpr double kMicrosecondsPerSecond = 1e6;
  const auto in_cell = [&](const Pose& pose) {
    Pose moved = robot::transformed(strip.design_to_cell, pose);
    moved.q = robot::canonical(moved.q);
    return moved;
  };
  std::vector<robot::Waypoint> out;
  out.reserve(strip.poses.size());
  for (const BladePose& pose : strip.poses) {
    const auto t_us = static_cast<std::uint32_t>(std::llround(pose.t * kMicrosecondsPerSecond));
    out.push_back({t_us, pose.heat, in_cell(pose.a), in_cell(pose.b)});
  }
  return out;
}

std::vector<std::array<Eigen::Vector2d, 4>> cubics(const Rib& rib) {
  std::vector<std::array<Eigen::Vector2d, 4>> all;
  for (std::size_t i = 0; i + 3 < rib.bezier.size(); i += 3)
    all.push_back({rib.bezier[i], rib.bezier[i + 1], rib.bezier[i + 2], rib.bezier[i + 3]});
  return all;
}

}  // namespace hotblade::pipeline
