// Where curves split into spirals: elastica, and splines through points.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "elastica/arcs/arcs.hpp"
#include "elastica/arcs/arcs_split.hpp"
#include "elastica/curve/taylor.hpp"

namespace hotblade::elastica {

namespace {

using Eigen::Vector2d;

template <typename F>
double sign_change(double a, double b, const F& f) {
  const bool rises = f(a) < 0;
  for (int i = 0; i < 60; ++i) {
    const double m = 0.5 * (a + b);
    (rises == (f(m) > 0) ? b : a) = m;
  }
  return 0.5 * (a + b);
}

// Breaks closer together than this part of the length are one: pieces that short are points.
std::vector<double> tidy(std::vector<double> breaks, double length) {
  constexpr double kSame = 1e-9;
  std::sort(breaks.begin(), breaks.end());
  std::vector<double> kept{0};
  for (const double s : breaks) {
    if (s > kept.back() + kSame * length && s < length * (1 - kSame)) kept.push_back(s);
  }
  kept.push_back(length);
  return kept;
}

// A cubic spline, its second derivatives continuous and constant over the first and last span, by chord
// length.
class PlaneSpline {
 public:
  explicit PlaneSpline(std::span<const Vector2d> points) : p_(points.begin(), points.end()) {
    const std::size_t n = p_.size();
    for (std::size_t i = 0; i + 1 < n; ++i) h_.push_back((p_[i + 1] - p_[i]).norm());
    solve_moments();
    double s = 0;
    double theta = std::atan2(derivative(0, 0).y(), derivative(0, 0).x());
    for (std::size_t i = 0; i + 1 < n; ++i) {
      start_.push_back(s);
      theta_.push_back(theta);
      s += arc_length(i, h_[i]);
      const Vector2d a = derivative(i, 0), b = derivative(i, h_[i]);
      theta += std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
    }
    start_.push_back(s);
  }
  [[nodiscard]] double length() const { return start_.back(); }
  [[nodiscard]] CurvePoint at(double s) const {
    const auto above = std::upper_bound(start_.begin(), start_.end() - 1, s);
    const std::size_t i = static_cast<std::size_t>(std::max<std::ptrdiff_t>(above - start_.begin() - 1, 0));
    const double want = std::clamp(s - start_[i], 0.0, start_[i + 1] - start_[i]);
    double t = want / (start_[i + 1] - start_[i]) * h_[i];
    for (int step = 0; step < 8; ++step) {  // Newton on a length that is nearly t
      const double excess = arc_length(i, t) - want;
      if (std::abs(excess) <= 1e-16 * length()) break;
      t = std::clamp(t - excess / derivative(i, t).norm(), 0.0, h_[i]);
    }
    return point(i, t);
  }
  // Arc lengths at which the sampled curvature turns round or changes sign.
  [[nodiscard]] std::vector<double> breaks() const {
    constexpr int kParts =
        6;  // over one span the curvature is nearly linear; its extrema are at knots or inside
    std::vector<double> s;
    for (std::size_t i = 0; i + 1 < p_.size(); ++i) {
      for (int k = 0; k < kParts; ++k) s.push_back(start_[i] + (start_[i + 1] - start_[i]) * k / kParts);
    }
    s.push_back(length());
    std::vector<double> kappa, found;
    for (const double x : s) kappa.push_back(at(x).kappa);
    for (std::size_t i = 0; i + 1 < s.size(); ++i) {
      if (kappa[i] * kappa[i + 1] < 0) {
        found.push_back(sign_change(s[i], s[i + 1], [this](double x) { return at(x).kappa; }));
      }
      if (i > 0 && (kappa[i] - kappa[i - 1]) * (kappa[i + 1] - kappa[i]) < 0) {
        found.push_back(extremum(s[i - 1], s[i + 1], kappa[i] > kappa[i - 1] ? 1 : -1));
      }
    }
    return tidy(found, length());
  }

 private:
  void solve_moments() {
    const std::size_t n = p_.size();
    std::vector<double> diagonal(n, 1.0), upper(n, 0.0);
    m_.assign(n, Vector2d::Zero());
    // End moments equal to their neighbours': a circle's spline keeps its curvature to the ends.
    std::vector<double> lower(n, 0.0);
    upper[0] = lower[n - 1] = -1;
    for (std::size_t i = 1; i + 1 < n; ++i) {
      lower[i] = h_[i - 1];
      diagonal[i] = 2 * (h_[i - 1] + h_[i]);
      upper[i] = h_[i];
      m_[i] = 6 * ((p_[i + 1] - p_[i]) / h_[i] - (p_[i] - p_[i - 1]) / h_[i - 1]);
    }
    for (std::size_t i = 1; i < n; ++i) {
      const double w = lower[i] / diagonal[i - 1];
      diagonal[i] -= w * upper[i - 1];
      m_[i] -= w * m_[i - 1];
    }
    m_[n - 1] /= diagonal[n - 1];
    for (std::size_t i = n - 1; i-- > 0;) m_[i] = (m_[i] - upper[i] * m_[i + 1]) / diagonal[i];
  }
  [[nodiscard]] Vector2d second(std::size_t i, double t) const {
    return m_[i] + (t / h_[i]) * (m_[i + 1] - m_[i]);
  }
  [[nodiscard]] Vector2d derivative(std::size_t i, double t) const {
    const Vector2d slope = (p_[i + 1] - p_[i]) / h_[i] - h_[i] / 6 * (2 * m_[i] + m_[i + 1]);
    return slope + t * (m_[i] + t / (2 * h_[i]) * (m_[i + 1] - m_[i]));
  }
  [[nodiscard]] CurvePoint point(std::size_t i, double t) const {
    const Vector2d slope = derivative(i, 0), bend = (m_[i + 1] - m_[i]) / (6 * h_[i]);
    const Vector2d at = p_[i] + t * (slope + t * (0.5 * m_[i] + t * bend));
    const Vector2d d = derivative(i, t), dd = second(i, t);
    const double turned = std::atan2(slope.x() * d.y() - slope.y() * d.x(), slope.dot(d));
    return {at.x(), at.y(), theta_[i] + turned, (d.x() * dd.y() - d.y() * dd.x()) / std::pow(d.norm(), 3)};
  }
  // Ten Gauss nodes: a span turns little and its speed is nearly 1.
  [[nodiscard]] double arc_length(std::size_t i, double t) const {
    constexpr double x[] = {0.1488743389816312, 0.4333953941292472, 0.6794095682990244, 0.8650633666889845,
                            0.9739065285171717};
    constexpr double w[] = {0.2955242247147529, 0.2692667193099964, 0.2190863625159820, 0.1494513491505806,
                            0.0666713443086881};
    double sum = 0;
    for (int k = 0; k < 5; ++k) {
      sum += w[k] * (derivative(i, 0.5 * t * (1 - x[k])).norm() + derivative(i, 0.5 * t * (1 + x[k])).norm());
    }
    return 0.5 * t * sum;
  }
  // By golden section: across a knot the curvature has a kink.
  [[nodiscard]] double extremum(double a, double b, double sign) const {
    const double golden = 0.5 * (std::sqrt(5.0) - 1);
    for (int i = 0; i < 60; ++i) {
      const double c = b - golden * (b - a), d = a + golden * (b - a);
      (sign * at(c).kappa > sign * at(d).kappa ? b : a) = sign * at(c).kappa > sign * at(d).kappa ? d : c;
    }
    return 0.5 * (a + b);
  }

  std::vector<Vector2d> p_, m_;  // points, second derivatives
  std::vector<double> h_;        // spans in the parameter
  std::vector<double> start_, theta_;
};

}  // namespace

std::vector<double> spiral_breaks(const Elastica& e) {
  const ElasticaCurve curve(e);
  // Steps over which the tangent turns by at most 0.15 rad hold one vertex or inflection at most.
  const double rate = taylor_rate(e.theta, e.kappa, e.lambda1, e.lambda2);
  const int steps = std::max(1, static_cast<int>(std::ceil(e.length * rate / 0.15)));
  const auto kappa = [&](double s) { return curve.at(s).kappa; };
  const auto slope = [&](double s) {
    const double theta = curve.at(s).theta;
    return e.lambda2 * std::cos(theta) - e.lambda1 * std::sin(theta);
  };
  std::vector<double> breaks;
  for (int i = 0; i < steps; ++i) {
    const double a = e.length * i / steps, b = e.length * (i + 1) / steps;
    if (kappa(a) * kappa(b) < 0) breaks.push_back(sign_change(a, b, kappa));
    if (slope(a) * slope(b) < 0) breaks.push_back(sign_change(a, b, slope));
  }
  return tidy(breaks, e.length);
}

ArcFit fit_arcs(std::span<const Vector2d> points, double tolerance, ArcOrder order) {
  if (!(tolerance > 0) || points.size() < kFewestArcPoints) {
    throw std::logic_error("fit_arcs needs a positive tolerance and at least 4 points");
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points[i].allFinite() || (i > 0 && !(points[i] != points[i - 1]))) {
      throw std::logic_error("fit_arcs needs finite points, neighbours distinct");
    }
  }
  const PlaneSpline spline(points);
  return fit_arcs_between([&](double s) { return spline.at(s); }, spline.breaks(), tolerance, order);
}

}  // namespace hotblade::elastica
