#include "elastica/fit/bezier_spline.hpp"

#include <cmath>
#include <stdexcept>

#include "elastica/bezier/curve_distance.hpp"

namespace hotblade::elastica {

namespace {

std::vector<Bezier> pieces_of(const ElasticaCurve& curve, int count) {
  const double length = curve.elastica().length / count;
  std::vector<Bezier> pieces;
  for (int i = 0; i < count; ++i) {
    const CurvePoint a = curve.at(i * length), b = curve.at((i + 1) * length);
    const Eigen::Vector2d at_a(std::cos(a.theta), std::sin(a.theta)),
        at_b(std::cos(b.theta), std::sin(b.theta));
    pieces.push_back(
        {a.position(), a.position() + length / 3 * at_a, b.position() - length / 3 * at_b, b.position()});
  }
  return pieces;
}

}  // namespace

std::vector<Bezier> bezier_spline(const Elastica& elastica, double distance) {
  if (!(distance > 0)) throw std::logic_error("a spline needs a distance above 0");
  constexpr double kBounds = 0.05;  // of the distance
  const ElasticaCurve curve(elastica);
  for (int count = 1;; count *= 2) {
    std::vector<Bezier> pieces = pieces_of(curve, count);
    const double length = elastica.length / count;
    bool near = true;
    for (int i = 0; near && i < count; ++i) {
      const Elastica part = segment(elastica, i * length, (i + 1) * length);
      near = hausdorff(pieces[static_cast<std::size_t>(i)], part, kBounds * distance).upper <= distance;
    }
    if (near || count >= kMostSplinePieces) return pieces;
  }
}

}  // namespace hotblade::elastica
