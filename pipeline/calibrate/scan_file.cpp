#include "pipeline/calibrate/scan_file.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "pipeline/program/program_text.hpp"
#include "pipeline/settings/error.hpp"
#include "surface/read/design_surface.hpp"
#include "surface/read/ply.hpp"
#include "surface/read/polygons.hpp"
#include "surface/read/words.hpp"

namespace hotblade::pipeline {

namespace {

[[noreturn]] void fail_scan(const std::string& place, const std::string& what) {
  throw Error(ErrorKind::kBadInput, place + ": " + what);
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (surface::is_blank(text.front()))) text.remove_prefix(1);
  while (!text.empty() && (surface::is_blank(text.back()) || text.back() == '\r')) text.remove_suffix(1);
  return text;
}

// The line without its end, which is taken off the text.
std::string_view take_line(std::string_view& text) {
  const std::size_t end = text.find('\n');
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  return trimmed(line);
}

std::vector<std::string_view> cells_of(std::string_view line) {
  std::vector<std::string_view> cells;
  for (;;) {
    const std::size_t comma = line.find(',');
    cells.push_back(trimmed(line.substr(0, comma)));
    if (comma == std::string_view::npos) return cells;
    line.remove_prefix(comma + 1);
  }
}

bool names_axes(const std::vector<std::string_view>& cells) {
  constexpr std::array<std::string_view, 3> kAxes{"x", "y", "z"};
  const auto lower = [](std::string_view word) {
    std::string text(word);
    for (char& c : text) c = static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
    return text;
  };
  return cells.size() == kAxes.size() &&
         std::equal(cells.begin(), cells.end(), kAxes.begin(),
                    [&](auto cell, auto axis) { return lower(cell) == axis; });
}

Eigen::Vector3d point_of(const std::vector<std::string_view>& cells, const std::string& place) {
  constexpr std::size_t kNumbers = 3;
  if (cells.size() != kNumbers)
    fail_scan(place,
              fmt::format("wrong number of columns ({}, must be 3): a scan has x, y and z, parted by commas",
                          cells.size()));
  Eigen::Vector3d point;
  for (std::size_t k = 0; k < kNumbers; ++k) {
    const std::optional<double> value = surface::number_in(cells[k]);
    const std::string shown = surface::shown_token(cells[k]);
    if (!value)
      fail_scan(place, "is not a number (\"" + shown + "\"): a scan has x, y and z, parted by commas");
    if (!std::isfinite(*value) || std::abs(*value) > surface::kLargestCoordinateMm)
      fail_scan(place, fmt::format("out of range ({}, at most {:g}): remove what the scanner did not see",
                                   shown, surface::kLargestCoordinateMm));
    point[static_cast<Eigen::Index>(k)] = *value;
  }
  return point;
}

void expect_points(const std::vector<Eigen::Vector3d>& points, const std::string& name) {
  if (points.size() < kLeastScanPoints)
    fail_scan(name, fmt::format("too few points ({}, at least {}): scan the cut more densely", points.size(),
                                kLeastScanPoints));
  if (points.size() > kMostFilePoints)
    fail_scan(name, fmt::format("too many points ({}, at most {}): thin the scan out", points.size(),
                                kMostFilePoints));
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) middle += p / static_cast<double>(points.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& p : points) spread += (p - middle) * (p - middle).transpose();
  const Eigen::Vector3d sizes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvalues();
  constexpr double kLine = 1e-8;  // of the length's square
  if (!(sizes[1] > kLine * sizes[2]))
    fail_scan(name, "all points lie in one place or on one line: a scan is of a surface");
}

}  // namespace

std::vector<Eigen::Vector3d> parse_scan_csv(std::string_view text, const std::string& name) {
  std::vector<Eigen::Vector3d> points;
  bool first = true;
  for (std::size_t line = 1; !text.empty(); ++line) {
    const std::string_view content = take_line(text);
    if (content.empty() || content.front() == '#') continue;
    const std::vector<std::string_view> cells = cells_of(content);
    if (!std::exchange(first, false) || !names_axes(cells))
      points.push_back(point_of(cells, fmt::format("{}:{}", name, line)));
  }
  return points;
}

std::vector<Eigen::Vector3d> read_scan(const std::filesystem::path& file, const std::string& units) {
  std::error_code error;
  if (std::filesystem::is_directory(file, error))
    throw Error(ErrorKind::kFile, file.string() + ": is a directory: give the scan's PLY or CSV");
  const std::string text = file_text(file), name = file.string();
  std::vector<Eigen::Vector3d> points;
  try {
    points = text.starts_with("ply") ? surface::parse_ply_points(text, name, surface::kLargestCoordinateMm)
                                     : parse_scan_csv(text, name);
  } catch (const surface::MeshError& bad) {
    throw Error(ErrorKind::kBadInput, bad.what());
  }
  const double scale = surface::scale_to_mm(units);
  for (Eigen::Vector3d& p : points) p *= scale;
  expect_points(points, name);
  return points;
}

std::string scan_csv(std::span<const Eigen::Vector3d> points) {
  std::string text = "x,y,z\n";
  for (const Eigen::Vector3d& p : points) text += fmt::format("{:.4f},{:.4f},{:.4f}\n", p.x(), p.y(), p.z());
  return text;
}

}  // namespace hotblade::pipeline
