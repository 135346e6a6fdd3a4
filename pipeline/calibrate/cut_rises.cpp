#include "pipeline/calibrate/cut_rises.hpp"

#include <tbb/parallel_for.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace hotblade::pipeline {

namespace {

// A blend of numbers is compared over this much of what it is expected within, or more: equilibria of 1e-9
// tell that well.
constexpr double kShortestBlend = 0.05;

// Foot points of a scan's points on a cut: what the scan touches there.
std::vector<Eigen::Vector3d> touched_points(const CutMesh& cut, const StripScan& scan,
                                            const Eigen::Isometry3d& place) {
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector3d& p : scan.points) points.push_back(place * p);
  std::vector<Eigen::Vector3d> touched;
  for (const Foot& foot : cut.feet(points)) touched.push_back(foot.point);
  return touched;
}

}  // namespace

ErrorVector within_ends(ErrorVector errors, const Program& program) {
  const auto end_at = [&](std::size_t error, double least) {
    auto& value = errors[static_cast<Eigen::Index>(error)];
    value = std::max(value, least);
  };
  end_at(kSlowingIndex, 0);
  end_at(static_cast<std::size_t>(CellError::kBand), program.blade.thickness_mm);
  return errors;
}

std::vector<Eigen::Index> asked_of(const ErrorVector& expected) {
  std::vector<Eigen::Index> asked;
  for (Eigen::Index i = 0; i < expected.size(); ++i)
    if (expected[i] > 0) asked.push_back(i);
  return asked;
}

std::vector<ErrorVector> doubted_blends(const ErrorMatrix& told, const ErrorVector& expected) {
  const std::vector<Eigen::Index> asked = asked_of(expected);
  const ErrorMatrix by_expected = expected.asDiagonal() * told * expected.asDiagonal();
  const Eigen::MatrixXd scaled = by_expected(asked, asked);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scaled);
  std::vector<ErrorVector> blends;
  for (Eigen::Index k = 0; k < scaled.rows(); ++k) {
    const double sd = 1 / std::sqrt(1 + std::max(0.0, solver.eigenvalues()[k]));
    ErrorVector blend = ErrorVector::Zero();
    blend(asked) = std::max(kShortestBlend, sd) * solver.eigenvectors().col(k);
    blends.push_back(expected.cwiseProduct(blend));
  }
  return blends;
}

Rises::Rises(const StripScan& scan, const Eigen::Isometry3d& placed, const ErrorVector& errors,
             const std::vector<ErrorVector>& blends, const ErrorVector& expected)
    : at(errors), place(placed), of_point(scan.points.size(), Unknowns::Zero()) {
  const auto cut = [&](const ErrorVector& of) { return CutMesh(cut_with(scan.program, of, scan.sample_mm)); };
  const CutMesh here = cut(errors);
  const std::vector<Eigen::Vector3d> points = touched_points(here, scan, placed);
  const std::vector<Foot> feet = here.feet(points);
  const std::vector<Eigen::Index> asked = asked_of(expected);
  const auto count = static_cast<Eigen::Index>(blends.size());
  const ErrorVector unit = expected.cwiseMax(1e-300).cwiseInverse();
  const auto many = static_cast<Eigen::Index>(points.size());
  Eigen::MatrixXd steps(count, count), middles(count, count), risen(many, count), alike(many, count);
  tbb::parallel_for(Eigen::Index{0}, count, [&](Eigen::Index k) {
    const ErrorVector& blend = blends[static_cast<std::size_t>(k)];
    // A number at its end steps to one side.
    const ErrorVector more = within_ends(errors + blend, scan.program),
                      less = within_ends(errors - blend, scan.program);
    steps.row(k) = (more - less).cwiseProduct(unit)(asked).transpose();
    middles.row(k) = (0.5 * (more + less) - errors).cwiseProduct(unit)(asked).transpose();
    const std::vector<Foot> up = cut(more).feet(points), down = cut(less).feet(points);
    for (std::size_t p = 0; p < points.size(); ++p) {
      const auto row = static_cast<Eigen::Index>(p);
      risen(row, k) = down[p].height_mm - up[p].height_mm;
      alike(row, k) = feet[p].height_mm - 0.5 * (down[p].height_mm + up[p].height_mm);
    }
  });
  const Eigen::MatrixXd by_number = steps.fullPivLu().solve(risen.transpose());
  alike -= (middles * by_number).transpose();
  for (Eigen::Index p = 0; p < many; ++p) {
    Unknowns& rise = of_point[static_cast<std::size_t>(p)];
    rise(asked) = by_number.col(p).cwiseProduct(unit(asked));
    rise.segment(kCellErrors, count) = alike.row(p).transpose();
  }
}

void Rises::leave_out(std::size_t error) {
  for (Unknowns& rise : of_point) rise[static_cast<Eigen::Index>(error)] = 0;
}

}  // namespace hotblade::pipeline
