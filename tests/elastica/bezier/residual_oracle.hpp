// The lambda-residual by adaptive quadrature in long double: Gauss-Kronrod pairs, halved until they agree,
// from pieces that end where the speed is least. It shares neither nodes nor formulas with the routines.
#pragma once

#include <algorithm>
#include <array>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>
#include <vector>

#include "elastica/bezier/bezier.hpp"

namespace hotblade::elastica {

class ResidualOracle {
 public:
  using Real = long double;

  explicit ResidualOracle(const Bezier& b) {
    for (int d = 0; d < 2; ++d) {
      const Real p1 = Real(b[1][d]) - b[0][d], p2 = Real(b[2][d]) - b[0][d], p3 = Real(b[3][d]) - b[0][d];
      power_[d] = {3 * p1, 3 * (p2 - 2 * p1), p3 - 3 * p2 + 3 * p1};
    }
    pieces_ = pieces();
  }

  // Length and Int kappa^2 ds bound what an error may be; 1e-16 of both is below any digit compared.
  [[nodiscard]] double value() const {
    const auto moments = [this](Real t) {
      const At a = at(t);
      return Moments{a.speed,
                     a.x * a.speed,
                     a.y * a.speed,
                     a.x * a.x * a.speed,
                     a.x * a.y * a.speed,
                     a.y * a.y * a.speed,
                     a.kappa * a.speed,
                     a.kappa * a.x * a.speed,
                     a.kappa * a.y * a.speed,
                     a.kappa * a.kappa * a.speed};
    };
    const Moments rough = integral(moments, Moments{}, 0);
    const Real length = rough[0], bend = rough[9];
    Moments limits;
    limits.fill(kLimit * length);
    for (const std::size_t k : {6U, 7U, 8U}) limits[k] = kLimit * std::sqrt(bend * length);
    limits[9] = kLimit * bend;
    const Moments m = integral(moments, limits, kDepth);
    const auto [one, x, y] = fit(m);
    // With the others beside it, the misfit is cut where they are.
    const auto misfit = [&, one = one, x = x, y = y](Real t) {
      const At a = at(t);
      const Real r = a.kappa - one - x * a.x - y * a.y;
      return std::array<Real, 4>{r * r * a.speed, a.speed, a.kappa * a.speed, a.kappa * a.kappa * a.speed};
    };
    const auto sums =
        integral(misfit, std::array<Real, 4>{limits[9], limits[0], limits[6], limits[9]}, kDepth);
    return static_cast<double>(std::sqrt(std::min(Real(1), sums[0] / sums[3])));
  }

 private:
  static constexpr Real kLimit = 1e-16L, kOfPiece = 1e-11L;
  // What disagrees after so many halvings does by rounding: a smooth piece takes some sixty.
  static constexpr int kDepth = 48, kMostHalvings = 2000;
  using Moments = std::array<Real, 10>;
  struct At {
    Real x, y, speed, kappa;
  };

  [[nodiscard]] At at(Real t) const {
    const auto& [a, b] = power_;
    const Real dx = (3 * a[2] * t + 2 * a[1]) * t + a[0], dy = (3 * b[2] * t + 2 * b[1]) * t + b[0];
    const Real speed = std::sqrt(dx * dx + dy * dy);
    const Real turn = dx * (6 * b[2] * t + 2 * b[1]) - dy * (6 * a[2] * t + 2 * a[1]);
    return {((a[2] * t + a[1]) * t + a[0]) * t, ((b[2] * t + b[1]) * t + b[0]) * t, speed,
            turn / (speed * speed * speed)};
  }

  // 0, the places where the speed is least, 1.
  [[nodiscard]] std::vector<Real> pieces() const {
    constexpr int kGrid = 400, kSteps = 80;
    constexpr Real kGolden = 0.38196601125010515L;
    std::vector<Real> speeds, ends{0};
    for (int i = 0; i <= kGrid; ++i) speeds.push_back(at(Real(i) / kGrid).speed);
    for (std::size_t i = 1; i < kGrid; ++i) {
      if (speeds[i] > speeds[i - 1] || speeds[i] > speeds[i + 1]) continue;
      Real from = Real(i - 1) / kGrid, to = Real(i + 1) / kGrid;
      for (int step = 0; step < kSteps; ++step) {
        const Real p = from + kGolden * (to - from), q = to - kGolden * (to - from);
        (at(p).speed < at(q).speed ? to : from) = at(p).speed < at(q).speed ? q : p;
      }
      if (from > ends.back()) ends.push_back(from);
    }
    ends.push_back(1);
    return ends;
  }

  template <typename F, std::size_t N>
  [[nodiscard]] std::array<Real, N> integral(const F& f, const std::array<Real, N>& limits, int depth) const {
    std::array<Real, N> sum{};
    for (std::size_t i = 0; i + 1 < pieces_.size(); ++i) {
      int left = kMostHalvings;
      add_piece(f, pieces_[i], pieces_[i + 1], limits, depth, left, sum);
    }
    return sum;
  }

  template <typename F, std::size_t N>
  static void add_piece(const F& f, Real from, Real to, const std::array<Real, N>& limits, int depth,
                        int& left, std::array<Real, N>& sum) {
    using boost::math::quadrature::gauss, boost::math::quadrature::gauss_kronrod;
    const auto& nodes = gauss_kronrod<Real, 31>::abscissa();
    const auto& kronrod = gauss_kronrod<Real, 31>::weights();
    const auto& plain = gauss<Real, 15>::weights();
    const Real middle = (from + to) / 2, half = (to - from) / 2;
    std::array<Real, N> fine{}, coarse{};
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      std::array<Real, N> value = f(middle + half * nodes[i]);
      const std::array<Real, N> other = i == 0 ? std::array<Real, N>{} : f(middle - half * nodes[i]);
      for (std::size_t k = 0; k < N; ++k) {
        value[k] += other[k];
        fine[k] += half * kronrod[i] * value[k];
        if (i % 2 == 0) coarse[k] += half * plain[i / 2] * value[k];
      }
    }
    bool agree = true;
    for (std::size_t k = 0; k < N; ++k)
      agree = agree && std::abs(fine[k] - coarse[k]) <= limits[k] + kOfPiece * std::abs(fine[k]);
    if (agree || depth == 0 || left == 0) {
      for (std::size_t k = 0; k < N; ++k) sum[k] += fine[k];
      return;
    }
    --left;
    add_piece(f, from, middle, limits, depth - 1, left, sum);
    add_piece(f, middle, to, limits, depth - 1, left, sum);
  }

  // kappa ~ one + x x + y y by its normal equations.
  static std::array<Real, 3> fit(const Moments& m) {
    Real a[3][4] = {{m[0], m[1], m[2], m[6]}, {m[1], m[3], m[4], m[7]}, {m[2], m[4], m[5], m[8]}};
    for (int i = 0; i < 3; ++i) {
      for (int r = i + 1; r < 3; ++r) {
        const Real share = a[r][i] / a[i][i];
        for (int c = i; c < 4; ++c) a[r][c] -= share * a[i][c];
      }
    }
    std::array<Real, 3> fit{};
    for (std::size_t i = 3; i-- > 0;) {
      Real rest = a[i][3];
      for (std::size_t j = i + 1; j < 3; ++j) rest -= a[i][j] * fit[j];
      fit[i] = rest / a[i][i];
    }
    return fit;
  }

  std::array<std::array<Real, 3>, 2> power_{};
  std::vector<Real> pieces_;
};

}  // namespace hotblade::elastica
