#include "surface/slice/ring.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace hotblade::surface {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

// Far above the rounding of angles, far below anything that matters: a nanometre at a metre.
constexpr double kAsideRad = 1e-9;
// Vertices this near to the cut lie on it.
constexpr double kOnRad = 4 * kAsideRad;

class Cut {
 public:
  Cut(const TriangleMesh& mesh, const PlaneFamily& fan) : mesh_(mesh), fan_(fan) {
    out_.vertices = mesh.vertices;
  }

  TriangleMesh run() {
    for (const Vector3d& p : mesh_.vertices) {
      const double past = std::remainder(fan_.angle(fan_.offset(p)) - pi, 2 * pi);
      past_.push_back(std::abs(past) < kOnRad ? 0 : past);
    }
    for (const auto& t : mesh_.triangles) add(t);
    return std::move(out_);
  }

 private:
  [[nodiscard]] double past(int v) const { return past_[static_cast<std::size_t>(v)]; }
  [[nodiscard]] const Vector3d& at(int v) const { return mesh_.vertices[static_cast<std::size_t>(v)]; }

  void add(const std::array<int, 3>& t) {
    const double low = std::min({past(t[0]), past(t[1]), past(t[2])}),
                 high = std::max({past(t[0]), past(t[1]), past(t[2])});
    const bool opposite = high - low > pi;  // around offset 0
    if (opposite || (low != 0 && high != 0 && low * high > 0)) {
      out_.triangles.push_back(t);
      return;
    }
    if (high <= 0 || low >= 0) {
      const bool behind = low >= 0 && high > 0;
      out_.triangles.push_back({side_of(t[0], behind), side_of(t[1], behind), side_of(t[2], behind)});
      return;
    }
    fan_out(part(t, false));
    fan_out(part(t, true));
  }

  // The face's corners on one side, with those on the cut, in its sense.
  std::vector<int> part(const std::array<int, 3>& t, bool behind) {
    std::vector<int> corners;
    for (std::size_t i = 0; i < 3; ++i) {
      const int a = t[i], b = t[(i + 1) % 3];
      if (past(a) == 0 || (past(a) > 0) == behind) corners.push_back(side_of(a, behind));
      if (past(a) * past(b) < 0) corners.push_back(crossing(a, b, behind));
    }
    return corners;
  }

  void fan_out(const std::vector<int>& corners) {
    for (std::size_t i = 2; i < corners.size(); ++i)
      out_.triangles.push_back({corners[0], corners[i - 1], corners[i]});
  }

  int side_of(int v, bool behind) {
    if (past(v) != 0) return v;
    return made({v, v}, behind, at(v));
  }

  int crossing(int a, int b, bool behind) {
    const int low = std::min(a, b), high = std::max(a, b);
    const Vector3d n = fan_.normal(0);
    const double from = n.dot(at(low) - fan_.centre()), to = n.dot(at(high) - fan_.centre());
    return made({low, high}, behind, at(low) + from / (from - to) * (at(high) - at(low)));
  }

  int made(const std::pair<int, int>& edge, bool behind, const Vector3d& p) {
    const auto [place, fresh] = made_.try_emplace({edge, behind}, static_cast<int>(out_.vertices.size()));
    if (fresh) {
      // On the axis' height and distance of p, just before or behind the half plane at half a turn.
      const Vector3d along = fan_.centre() + fan_.axis().dot(p - fan_.centre()) * fan_.axis();
      const Vector3d out = -fan_.axis().cross(fan_.normal(0));  // reference: normal = axis x reference
      const Eigen::AngleAxisd turn(behind ? kAsideRad - pi : pi - kAsideRad, fan_.axis());
      out_.vertices.push_back(along + fan_.distance_from_axis(p) * (turn * out));
    }
    return place->second;
  }

  const TriangleMesh& mesh_;
  const PlaneFamily& fan_;
  TriangleMesh out_;
  std::vector<double> past_;  // of each vertex, rad past the cut, within half a turn; 0: on it
  std::map<std::pair<std::pair<int, int>, bool>, int> made_;
};

}  // namespace

TriangleMesh cut_open(const TriangleMesh& mesh, const PlaneFamily& fan) {
  return Cut(mesh, fan).run();
}

}  // namespace hotblade::surface
