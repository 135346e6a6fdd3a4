// Ends with 0 when the installed headers and library evaluate a curve.
#include <cmath>

#include "elastica/bezier/lambda_residual.hpp"
#include "elastica/curve/elastica.hpp"

int main() {
  using namespace hotblade::elastica;
  const Elastica quarter_circle{0, 0, 0, 1, 0, 0, std::acos(0.0)};
  const CurvePoint end = point_at(quarter_circle, quarter_circle.length);
  const Bezier arc{{{0, 0}, {0.5522847498, 0}, {1, 0.4477152502}, {1, 1}}};
  const bool right = std::hypot(end.x - 1, end.y - 1) < 1e-12 && lambda_residual(arc).value < 0.05;
  return right ? 0 : 1;
}
