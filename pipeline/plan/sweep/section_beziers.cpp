#include "pipeline/plan/sweep/section_beziers.hpp"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "elastica/bezier/bezier.hpp"
#include "elastica/fit/even_points.hpp"
#include "gpu/backend/stop.hpp"
#include "gpu/curve/lambda_residuals.hpp"
#include "pipeline/plan/ribs/rib_fit.hpp"
#include "surface/slice/slice.hpp"

namespace hotblade::pipeline {

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kEvenSections = 8;
constexpr int kPieceSamples = 33;  // of a piece
// Shorter pieces are followed by any blade.
constexpr double kLeastMm = 30;

// A piece of a section as a Bezier.
struct Piece {
  std::array<Vector2d, 4> bezier;
  double kappa_rms = 0, length_mm = 0, away_mm = 0;  // the latter of the Bezier from the section
};

std::vector<double> section_offsets(const surface::TriangleMesh& mesh, const surface::PlaneFamily& planes) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Vector3d& p : mesh.vertices()) {
    const double offset = planes.offset(p);
    low = std::min(low, offset);
    high = std::max(high, offset);
  }
  std::vector<double> offsets;
  for (int i = 0; i < kEvenSections && high > low; ++i)
    offsets.push_back(low + (high - low) * (i + 0.5) / kEvenSections);
  return offsets;
}

std::vector<Vector2d> in_plane(const surface::SectionPiece& piece, const Vector3d& normal) {
  const Vector3d x = normal.unitOrthogonal(), y = normal.cross(x), from = piece.points.front();
  std::vector<Vector2d> line;
  for (const Vector3d& p : piece.points) line.emplace_back((p - from).dot(x), (p - from).dot(y));
  return line;
}

double rms_curvature(const std::vector<Vector2d>& points, double length) {
  const double step = length / static_cast<double>(points.size() - 1);
  double sum = 0;
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    const Vector2d a = points[i] - points[i - 1], b = points[i + 1] - points[i];
    const double turn = std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
    sum += turn * turn / step;
  }
  return std::sqrt(sum / length);
}

// The pieces of all sections, each split into as many.
std::vector<Piece> pieces_of(const std::vector<surface::Section>& sections,
                             const surface::PlaneFamily& planes, std::size_t split) {
  std::vector<Piece> pieces;
  for (const surface::Section& section : sections) {
    for (const surface::SectionPiece& whole : section.pieces) {
      const double length = whole.length_mm / static_cast<double>(split);
      if (!(length >= kLeastMm)) continue;
      const int count = static_cast<int>(split) * (kPieceSamples - 1) + 1;
      const std::vector<Vector2d> points =
          elastica::evenly_spaced(in_plane(whole, planes.normal(section.offset_mm)), count);
      for (std::size_t i = 0; i < split; ++i) {
        const auto from = points.begin() + static_cast<std::ptrdiff_t>(i) * (kPieceSamples - 1);
        const std::vector<Vector2d> own(from, from + kPieceSamples);
        const elastica::BezierFit fit = elastica::fit_bezier(own);
        pieces.push_back({fit.bezier, rms_curvature(own, length), length, fit.max});
      }
    }
  }
  return pieces;
}

double missed_mm(const Piece& piece, double residual, gpu::ResidualStatus status) {
  constexpr double kWave = 1 / (9 * std::numbers::pi * std::numbers::pi);
  const bool known = status == gpu::ResidualStatus::kOk || status == gpu::ResidualStatus::kStraight;
  const double share = known ? residual : 1;
  return piece.away_mm + share * piece.kappa_rms * piece.length_mm * piece.length_mm * kWave;
}

}  // namespace

std::vector<double> elastica_misses_mm(const surface::TriangleMesh& mesh,
                                       std::span<const surface::PlaneFamily> planes,
                                       std::span<const SectionQuestion> questions) {
  std::vector<std::vector<surface::Section>> sections(planes.size());
  tbb::parallel_for(std::size_t{0}, planes.size(), [&](std::size_t i) {
    gpu::stop_point();
    const std::vector<double> offsets = section_offsets(mesh, planes[i]);
    if (!offsets.empty()) sections[i] = surface::slice(mesh, planes[i], offsets);
  });
  gpu::stop_point();
  std::vector<std::vector<Piece>> pieces(questions.size());
  for (const SectionQuestion& q : questions) {
    if (q.planes >= planes.size() || q.pieces == 0) throw std::logic_error("no such planes or pieces");
  }
  tbb::parallel_for(std::size_t{0}, questions.size(), [&](std::size_t i) {
    gpu::stop_point();
    pieces[i] = pieces_of(sections[questions[i].planes], planes[questions[i].planes], questions[i].pieces);
  });
  gpu::stop_point();
  std::vector<std::array<Vector2d, 4>> curves;
  for (const auto& own : pieces) {
    for (const Piece& piece : own) curves.push_back(piece.bezier);
  }
  std::vector<double> residuals(curves.size());
  std::vector<gpu::ResidualStatus> statuses(curves.size());
  gpu::LambdaResiduals().query(curves, residuals, statuses);
  std::vector<double> misses;
  std::size_t curve = 0;
  for (const auto& own : pieces) {
    std::vector<double> all;
    for (const Piece& piece : own) {
      all.push_back(missed_mm(piece, residuals[curve], statuses[curve]));
      ++curve;
    }
    const auto most = all.begin() + static_cast<std::ptrdiff_t>(3 * all.size() / 4);
    if (most != all.end()) std::nth_element(all.begin(), most, all.end());
    misses.push_back(most != all.end() ? *most : std::numeric_limits<double>::infinity());
  }
  return misses;
}

}  // namespace hotblade::pipeline
