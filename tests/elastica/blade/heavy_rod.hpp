// A discrete heavy rod in space: rigid links with frames, quadratic springs between them, weight on the
// links. Independent of elastica/blade/gravity.cpp: nothing is linearised, and neither the elastica's forces
// nor its second variation are used; equilibrium is found by Newton's method on the energy itself.
#pragma once

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <stdexcept>
#include <vector>

#include "elastica/curve/elastica.hpp"

namespace hotblade::testing {

// Stiffnesses about the rod's tangent, its in-plane normal and the plane's normal.
struct RodStiffness {
  double torsion = 1, upright = 1, plane = 1;
};

class HeavyRod {
 public:
  // n links along the elastica, the frames of the first and the last held, both end points held.
  HeavyRod(const elastica::Elastica& e, int n, const RodStiffness& stiffness)
      : stiffness_(stiffness), step_(e.length / n) {
    const elastica::ElasticaCurve curve(e);
    for (int i = 0; i <= n; ++i) {
      // Frames stand at the nodes; the node at either end counts for half a link.
      const double theta = curve.at(step_ * i).theta;
      frames_.emplace_back(Eigen::AngleAxisd(theta, Eigen::Vector3d::UnitZ()));
    }
    end_ = Eigen::Vector3d(curve.at(e.length).x - e.x, curve.at(e.length).y - e.y, 0);
  }

  // Turns the held frames of the first and the last node by rotation vectors in their own axes.
  void turn_ends(const Eigen::Vector3d& first, const Eigen::Vector3d& last) {
    frames_.front() = turned(frames_.front(), first);
    frames_.back() = turned(frames_.back(), last);
  }

  // Relaxes under a weight per length and returns the nodes' positions relative to the first.
  std::vector<Eigen::Vector3d> relax(const Eigen::Vector3d& weight) {
    constexpr int kIterations = 40;
    const double size = step_ * static_cast<double>(frames_.size());
    for (int k = 0; k < kIterations; ++k) {
      const double moved = newton_step(weight);
      if (moved < 1e-11) return positions();
      if (!(moved < 1e3 * size)) break;
    }
    throw std::runtime_error("the discrete rod found no equilibrium");
  }

 private:
  using Vector6d = Eigen::Matrix<double, 6, 1>;
  using Matrix6d = Eigen::Matrix<double, 6, 6>;

  [[nodiscard]] static Eigen::Quaterniond turned(const Eigen::Quaterniond& q, const Eigen::Vector3d& by) {
    const double angle = by.norm();
    if (!(angle > 0)) return q;
    return q * Eigen::Quaterniond(Eigen::AngleAxisd(angle, by / angle));
  }

  // Energy of the spring between frames i and i + 1, both turned by small rotations in their own axes.
  [[nodiscard]] double spring(std::size_t i, const Vector6d& turn) const {
    const Eigen::Quaterniond d =
        turned(frames_[i], turn.head<3>()).conjugate() * turned(frames_[i + 1], turn.tail<3>());
    const Eigen::AngleAxisd a(d);
    const Eigen::Vector3d strain = a.angle() * a.axis() / step_;
    return 0.5 * step_ *
           (stiffness_.torsion * strain.x() * strain.x() + stiffness_.upright * strain.y() * strain.y() +
            stiffness_.plane * strain.z() * strain.z());
  }

  [[nodiscard]] double link(std::size_t i) const {
    return i == 0 || i + 1 == frames_.size() ? 0.5 * step_ : step_;
  }

  [[nodiscard]] std::vector<Eigen::Vector3d> positions() const {
    std::vector<Eigen::Vector3d> p{Eigen::Vector3d::Zero()};
    for (std::size_t i = 0; i + 1 < frames_.size(); ++i) {
      p.push_back(p.back() +
                  0.5 * step_ *
                      (frames_[i] * Eigen::Vector3d::UnitX() + frames_[i + 1] * Eigen::Vector3d::UnitX()));
    }
    return p;
  }

  // Derivatives of the springs by central differences, those of the links' directions in closed form.
  double newton_step(const Eigen::Vector3d& weight) {
    const auto inner = static_cast<Eigen::Index>(frames_.size()) - 2, n = 3 * inner + 3;
    Eigen::MatrixXd k = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd g = Eigen::VectorXd::Zero(n);
    for (std::size_t i = 0; i + 1 < frames_.size(); ++i) add_spring(i, k, g);
    Eigen::Vector3d reached = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < frames_.size(); ++i)
      reached += link(i) * (frames_[i] * Eigen::Vector3d::UnitX());
    // The weight of everything past link i hangs on it; the end's reaction is a multiplier.
    const double last = static_cast<double>(frames_.size()) - 1;
    for (Eigen::Index i = 0; i < inner; ++i) {
      const auto node = static_cast<std::size_t>(i) + 1;
      const Eigen::Matrix3d r = frames_[node].toRotationMatrix();
      const Eigen::Vector3d load = force_ + weight * step_ * (last - static_cast<double>(node));
      const Eigen::Vector3d f = step_ * (r.transpose() * load), x = Eigen::Vector3d::UnitX();
      // -f . exp(a) x to second order in a.
      g.segment<3>(3 * i) += -x.cross(f);
      k.block<3, 3>(3 * i, 3 * i) +=
          f.x() * Eigen::Matrix3d::Identity() - 0.5 * (f * x.transpose() + x * f.transpose());
      Eigen::Matrix3d slope;  // of the link's end by a
      slope << Eigen::Vector3d::Zero(), -step_ * r.col(2), step_ * r.col(1);
      k.block<3, 3>(3 * inner, 3 * i) = slope;
      k.block<3, 3>(3 * i, 3 * inner) = slope.transpose();
    }
    g.tail<3>() = reached - end_;
    // Multipliers enter with the opposite sign of the load.
    k.block(0, 3 * inner, 3 * inner, 3) *= -1;
    const Eigen::VectorXd d = k.partialPivLu().solve(-g);
    for (Eigen::Index i = 0; i < inner; ++i) {
      auto& q = frames_[static_cast<std::size_t>(i) + 1];
      q = turned(q, d.segment<3>(3 * i)).normalized();
    }
    force_ += d.tail<3>();
    return d.head(3 * inner).cwiseAbs().maxCoeff();
  }

  void add_spring(std::size_t i, Eigen::MatrixXd& k, Eigen::VectorXd& g) const {
    constexpr double h = 1e-4;
    const auto e = [&](int a, double da, int b, double db) {
      Vector6d t = Vector6d::Zero();
      t[a] += da;
      t[b] += db;
      return spring(i, t);
    };
    for (int a = 0; a < 6; ++a) {
      const Eigen::Index ia = 3 * (static_cast<Eigen::Index>(i) - 1) + a;
      if (!inside(ia, g)) continue;
      g[ia] += (8 * (e(a, h, a, 0) - e(a, -h, a, 0)) - (e(a, 2 * h, a, 0) - e(a, -2 * h, a, 0))) / (12 * h);
      for (int b = 0; b < 6; ++b) {
        const Eigen::Index ib = 3 * (static_cast<Eigen::Index>(i) - 1) + b;
        if (inside(ib, g))
          k(ia, ib) += (e(a, h, b, h) - e(a, h, b, -h) - e(a, -h, b, h) + e(a, -h, b, -h)) / (4 * h * h);
      }
    }
  }

  [[nodiscard]] static bool inside(Eigen::Index i, const Eigen::VectorXd& g) {
    return i >= 0 && i < g.size() - 3;
  }

  RodStiffness stiffness_;
  double step_;
  std::vector<Eigen::Quaterniond> frames_;
  Eigen::Vector3d end_, force_{0, 0, 0};
};

}  // namespace hotblade::testing
