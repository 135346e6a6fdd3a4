#include "pipeline/plan/direction/body_axes.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "gpu/backend/stop.hpp"
#include "surface/read/blocks.hpp"

namespace hotblade::pipeline {

namespace {

const Eigen::Vector3d& at(const surface::TriangleMesh& mesh, int v) {
  return mesh.vertices()[static_cast<std::size_t>(v)];
}

// Calls f(area, centre) for every triangle.
template <class F>
void for_each_area(const surface::TriangleMesh& mesh, const F& f) {
  for (const auto& t : mesh.triangles()) {
    const Eigen::Vector3d &a = at(mesh, t[0]), &b = at(mesh, t[1]), &c = at(mesh, t[2]);
    f(0.5 * (b - a).cross(c - a).norm(), (a + b + c) / 3);
  }
}

// Of the area. About its centre: about the origin a design far from it would lose its digits.
Eigen::Matrix3d covariance_about(const surface::TriangleMesh& mesh, const Eigen::Vector3d& centre) {
  struct Moments {
    double area = 0;
    Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  };
  const std::size_t count = mesh.triangles().size();
  std::vector<Moments> of((count + surface::kBlock - 1) / surface::kBlock);
  surface::for_blocks(count, surface::kBlock, [&](std::size_t first, std::size_t last) {
    Moments& block = of[first / surface::kBlock];
    for (const auto& t : mesh.triangles().subspan(first, last - first)) {
      const Eigen::Vector3d &a = at(mesh, t[0]), &b = at(mesh, t[1]), &c = at(mesh, t[2]);
      const double area = 0.5 * (b - a).cross(c - a).norm();
      const Eigen::Vector3d d = (a + b + c) / 3 - centre;
      block.area += area;
      block.second += area * d * d.transpose();
    }
  });
  Moments all;
  for (const Moments& block : of) {
    all.area += block.area;
    all.second += block.second;
  }
  return all.second / all.area;
}

// Unit vector square to `axis` towards the vertex farthest from the line along it through the centre.
Eigen::Vector3d towards_farthest(const surface::TriangleMesh& mesh, const Eigen::Vector3d& centre,
                                 const Eigen::Vector3d& axis) {
  // Equally far vertices, as on a circle: only a clearly farther one counts, so that rounding does not
  // decide.
  constexpr double kClearly = 1 + 1e-9;
  Eigen::Vector3d best = axis.unitOrthogonal();
  double farthest = 0;
  for (const Eigen::Vector3d& p : mesh.vertices()) {
    const Eigen::Vector3d d = p - centre, out = d - d.dot(axis) * axis;
    if (!(out.squaredNorm() > kClearly * farthest)) continue;
    farthest = out.squaredNorm();
    best = out;
  }
  return best.normalized();
}

}  // namespace

BodyAxes body_axes(const surface::TriangleMesh& mesh) {
  BodyAxes body;
  body.centre = surface::area_centre(mesh);
  const Eigen::Matrix3d covariance = covariance_about(mesh, body.centre);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  const Eigen::Vector3d& v = solver.eigenvalues();  // ascending
  Eigen::Vector3d wide = solver.eigenvectors().col(2), narrow = solver.eigenvectors().col(0);
  constexpr double kEqual = 0.98;  // of the moments: extents within a percent
  if (v[1] > kEqual * v[2]) {
    wide = towards_farthest(mesh, body.centre, narrow);
  } else if (v[0] > kEqual * v[1]) {
    narrow = towards_farthest(mesh, body.centre, wide);
  }
  body.axes = {wide, narrow.cross(wide).normalized(), narrow};
  return body;
}

namespace {

// Finds the senses of directions by moments along n, square to it and upwards that a half turn about `up`
// changes the sign of.
class Senses {
 public:
  Senses(const surface::TriangleMesh& mesh, const Eigen::Vector3d& centre,
         std::span<const Eigen::Vector3d> directions)
      : mesh_(mesh), centre_(centre), negative_(directions.size()) {
    Eigen::Vector3d normals = Eigen::Vector3d::Zero();
    for (const auto& t : mesh.triangles())
      normals += (at(mesh, t[1]) - at(mesh, t[0])).cross(at(mesh, t[2]) - at(mesh, t[0]));
    for (const Eigen::Vector3d& n : directions) {
      const Eigen::Vector3d up = (normals - normals.dot(n) * n).normalized();  // zero where it is closed
      frames_.push_back({n, up.cross(n), up});
      open_.push_back(open_.size());
    }
  }

  // Nothing where no moment is left: the half turn leaves the design as it is, and both senses are one.
  [[nodiscard]] std::vector<std::optional<bool>> negative() {
    // Nearly every direction is told by the first.
    decide([](double h, double, double) { return h * h * h; });
    decide([](double, double k, double) { return k * k * k; });
    decide([](double h, double k, double) { return h * k * k; });
    decide([](double h, double k, double) { return h * h * k; });
    decide([](double h, double, double z) { return h * z; });
    decide([](double, double k, double z) { return k * z; });
    decide([](double h, double, double z) { return h * h * h * z; });
    decide([](double, double k, double z) { return k * k * k * z; });
    return negative_;
  }

 private:
  struct AlongAcrossUp {
    Eigen::Vector3d n, across, up;
  };

  // Those that the moment is left of, side by side.
  template <class Moment>
  void decide(const Moment& moment) {
    constexpr std::size_t kTogether = 8;  // share what is found of each triangle
    surface::for_blocks(open_.size(), kTogether, [&](std::size_t first, std::size_t last) {
      gpu::stop_point();
      std::array<double, kTogether> sums{}, sizes{};
      for_each_area(mesh_, [&](double area, const Eigen::Vector3d& c) {
        const Eigen::Vector3d d = c - centre_;
        for (std::size_t i = first; i < last; ++i) {
          const AlongAcrossUp& frame = frames_[open_[i]];
          const double m = moment(frame.n.dot(d), frame.across.dot(d), frame.up.dot(d));
          sums[i - first] += area * m;
          sizes[i - first] += area * std::abs(m);
        }
      });
      // Less is the rounding of a symmetric design's coordinates in its file.
      constexpr double kSkewed = 1e-6;
      for (std::size_t i = first; i < last; ++i) {
        const double sum = sums[i - first];
        if (std::abs(sum) > kSkewed * sizes[i - first]) negative_[open_[i]] = sum < 0;
      }
    });
    std::erase_if(open_, [&](std::size_t i) { return negative_[i].has_value(); });
  }

  const surface::TriangleMesh& mesh_;
  Eigen::Vector3d centre_;
  std::vector<AlongAcrossUp> frames_;
  std::vector<std::optional<bool>> negative_;
  std::vector<std::size_t> open_;  // not known yet
};

bool points_back(const Eigen::Vector3d& n) {
  for (int i = 0; i < 3; ++i) {
    if (std::abs(n[i]) > 0.5 * n.cwiseAbs().maxCoeff()) return n[i] < 0;
  }
  return false;
}

}  // namespace

std::vector<Eigen::Vector3d> with_senses(const surface::TriangleMesh& mesh, const BodyAxes& body,
                                         std::span<const Eigen::Vector3d> directions) {
  const std::vector<std::optional<bool>> negative = Senses(mesh, body.centre, directions).negative();
  std::vector<Eigen::Vector3d> found(directions.begin(), directions.end());
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (negative[i].value_or(points_back(found[i]))) found[i] = -found[i];
  }
  return found;
}

Eigen::Vector3d with_sense(const surface::TriangleMesh& mesh, const BodyAxes& body,
                           const Eigen::Vector3d& n) {
  return with_senses(mesh, body, {&n, 1}).front();
}

std::vector<Eigen::Vector3d> hemisphere(const BodyAxes& body) {
  const auto turned = [&](int degrees) -> Eigen::Vector3d {
    const double a = degrees * std::numbers::pi / 180;
    return std::cos(a) * body.axes[0] + std::sin(a) * body.axes[1];
  };
  std::vector<Eigen::Vector3d> all;
  for (int degrees = 0; degrees < 180; degrees += 15) all.push_back(turned(degrees));
  all.push_back(body.axes[2]);
  for (int degrees = 0; degrees < 360; degrees += 45) {
    all.push_back((turned(degrees) + body.axes[2]).normalized());
  }
  return all;
}

std::vector<Eigen::Vector3d> along_borders(const surface::TriangleMesh& mesh, const BodyAxes& body) {
  // Headings modulo 180 degrees in bins of a quarter degree; a border bent up or down at most spreads over a
  // degree to either side.
  constexpr int kBins = 720, kNear = 4;
  constexpr double kLeastShare = 0.1;
  std::vector<Eigen::Vector2d> bins(kBins, Eigen::Vector2d::Zero());
  const auto bin_at = [&](int i) -> Eigen::Vector2d& {
    return bins[static_cast<std::size_t>((i + kBins) % kBins)];
  };
  double total = 0;
  for (const int c : mesh.border()) {
    const Eigen::Vector3d e =
        at(mesh, surface::vertex_at(mesh, surface::next_corner(c))) - at(mesh, surface::vertex_at(mesh, c));
    Eigen::Vector2d flat(e.dot(body.axes[0]), e.dot(body.axes[1]));
    const double heading = std::atan2(flat.y(), flat.x()) + 2 * std::numbers::pi;
    const int bin = static_cast<int>(std::lround(heading * kBins / std::numbers::pi)) % kBins;
    // Summed with one sense: that of the bin's middle.
    const double middle = bin * std::numbers::pi / kBins;
    if (flat.dot(Eigen::Vector2d(std::cos(middle), std::sin(middle))) < 0) flat = -flat;
    bin_at(bin) += flat;
    total += flat.norm();
  }
  std::vector<Eigen::Vector3d> directions;
  for (int k = 0; k < 2; ++k) {
    Eigen::Vector2d best = Eigen::Vector2d::Zero();
    int middle = 0;
    for (int i = 0; i < kBins; ++i) {
      Eigen::Vector2d sum = Eigen::Vector2d::Zero();
      for (int n = -kNear; n <= kNear; ++n) {
        const Eigen::Vector2d& d = bin_at(i + n);
        sum += d.dot(bin_at(i)) < 0 ? Eigen::Vector2d(-d) : d;
      }
      if (sum.norm() > best.norm()) {
        best = sum;
        middle = i;
      }
    }
    if (!(best.norm() > kLeastShare * total)) break;
    best.normalize();
    directions.push_back(best.x() * body.axes[1] - best.y() * body.axes[0]);
    for (int n = -2 * kNear; n <= 2 * kNear; ++n) bin_at(middle + n).setZero();
  }
  return directions;
}

std::optional<Eigen::Vector3d> least_steep(const surface::TriangleMesh& mesh) {
  Eigen::Matrix3d normals = Eigen::Matrix3d::Zero();
  double total = 0;
  for (const auto& t : mesh.triangles()) {
    const Eigen::Vector3d cross = (at(mesh, t[1]) - at(mesh, t[0])).cross(at(mesh, t[2]) - at(mesh, t[0]));
    const double area = cross.norm();
    if (!(area > 0)) continue;
    normals += cross * cross.transpose() / area;
    total += area;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(normals / total);
  constexpr double kTold = 1e-3;  // slopes that differ by 2 degrees in the mean
  if (solver.eigenvalues()[1] - solver.eigenvalues()[0] < kTold) return std::nullopt;
  return solver.eigenvectors().col(0);
}

}  // namespace hotblade::pipeline
