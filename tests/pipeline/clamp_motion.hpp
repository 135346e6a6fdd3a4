// How fast clamps move, from a program's text alone.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <nlohmann/json.hpp>

#include "pipeline/plan/plan.hpp"
#include "pipeline/program/program.hpp"

namespace hotblade::pipeline::testing {

// What the clamps do at most, by differences of the waypoints that stand in a program's text alone.
struct Most {
  double speed = 0, accel = 0, turn = 0, turn_accel = 0;
};

inline Eigen::Vector3d vector(const nlohmann::json& p) {
  return {p[0].get<double>(), p[1].get<double>(), p[2].get<double>()};
}

// Angle times axis of the turn between orientations (w, x, y, z), from the matrices: another way than the
// plan's.
inline Eigen::Vector3d turn_between(const nlohmann::json& p, const nlohmann::json& q) {
  const auto matrix = [](const nlohmann::json& o) -> Eigen::Matrix3d {
    return Eigen::Quaterniond(o[0], o[1], o[2], o[3]).normalized().toRotationMatrix();
  };
  const Eigen::Matrix3d m = matrix(q) * matrix(p).transpose();
  const Eigen::Vector3d twice_sine(m(2, 1) - m(1, 2), m(0, 2) - m(2, 0), m(1, 0) - m(0, 1));
  return 0.5 * twice_sine;  // steps turn by less than 0.05 rad: the sine is the angle to 4e-4 of it
}

inline Most measured(const nlohmann::json& poses, const char* clamp) {
  Most most;
  Eigen::Vector3d v = Eigen::Vector3d::Zero(), w = Eigen::Vector3d::Zero();
  double dt0 = 0;
  for (std::size_t i = 1; i <= poses.size(); ++i) {
    const bool rests = i == poses.size();
    const nlohmann::json &p = poses[i - 1], &q = poses[rests ? i - 1 : i];
    const double dt = rests ? dt0 : q["t"].get<double>() - p["t"].get<double>();
    const Eigen::Vector3d v1 = (vector(q[clamp]["p"]) - vector(p[clamp]["p"])) / dt,
                          w1 = turn_between(p[clamp]["q"], q[clamp]["q"]) / dt;
    const double mean = 0.5 * ((i == 1 ? dt : dt0) + dt);
    most.speed = std::max(most.speed, v1.norm());
    most.turn = std::max(most.turn, w1.norm());
    most.accel = std::max(most.accel, (v1 - v).norm() / mean);
    most.turn_accel = std::max(most.turn_accel, (w1 - w).norm() / mean);
    v = v1;
    w = w1;
    dt0 = dt;
  }
  return most;
}

inline Most measured(const PlanResult& result) {
  Most most;
  const nlohmann::json program = nlohmann::json::parse(to_json(result.program));
  for (const nlohmann::json& strip : program["strips"]) {
    for (const char* clamp : {"a", "b"}) {
      const Most m = measured(strip["poses"], clamp);
      most = {std::max(most.speed, m.speed), std::max(most.accel, m.accel), std::max(most.turn, m.turn),
              std::max(most.turn_accel, m.turn_accel)};
    }
  }
  return most;
}

}  // namespace hotblade::pipeline::testing
