// Surfaces that a blade leaves when it moves straight on while it bends from one exact elastica to another:
// the plan has to find them again, up to what their mesh leaves open.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "elastica/curve/elastica.hpp"
#include "pipeline/plan/plan.hpp"
#include "tests/pipeline/plan_design.hpp"

namespace hotblade::pipeline {
namespace {

using Eigen::Vector3d;

constexpr double kSweep = 300;

// The elastica at a share of the sweep. None of the surfaces is level along the sweep anywhere: where its
// slope changes sign a cut has a crease, since the band that a blade melts is as wide both ways.
using Shape = elastica::Elastica (*)(double);

elastica::Elastica hill(double w) {
  return {0, 40 * w, 0.45 + 0.06 * w, -0.0024 - 0.0004 * w, 3e-6, 1.5e-6, 420};
}
elastica::Elastica with_inflection(double w) {
  return {0, 40 * w, -0.35 + 0.05 * w, 0.0006 + 0.0001 * w, 1.2e-5, -4e-6, 480};
}
elastica::Elastica sharp_bend(double w) {
  return {0, -30 * w, 0.5 - 0.05 * w, -0.004 - 0.0002 * w, 1e-6, 2e-6, 260};
}

Vector3d on_blade(Shape shape, double w, double share) {
  const elastica::Elastica e = shape(w);
  const elastica::CurvePoint q = elastica::point_at(e, share * e.length);
  return {kSweep * w, q.x, q.y};
}

template <class Surface>
Vector3d normal_of(const Surface& p, double u, double v) {
  constexpr double kStep = 1e-4;
  return (p(u + kStep, v) - p(u - kStep, v)).cross(p(u, v + kStep) - p(u, v - kStep)).normalized();
}

// What a blade through these elastica leaves: half a band below, of 1 mm and 8 mm of width.
struct Swept {
  Shape shape;
  Vector3d operator()(double w, double share) const {
    const auto blade = [this](double a, double b) { return on_blade(shape, a, b); };
    const Vector3d n = normal_of(blade, w, share);
    return on_blade(shape, w, share) - 0.5 * (1 + 8 * std::abs(n.x())) * n;
  }
};

// How far the faces of the grid's mesh lie from the surface itself: at their middles and those of their
// edges.
double mesh_error_mm(const Swept& p, int nu, int nv) {
  using Corner = std::array<double, 2>;
  double worst = 0;
  for (int i = 0; i < nu; ++i) {
    for (int j = 0; j < nv; ++j) {
      const double u0 = static_cast<double>(i) / nu, u1 = static_cast<double>(i + 1) / nu,
                   v0 = static_cast<double>(j) / nv, v1 = static_cast<double>(j + 1) / nv;
      for (const std::array<Corner, 3>& t :
           {std::array<Corner, 3>{{{u0, v0}, {u1, v0}, {u1, v1}}}, {{{u0, v0}, {u1, v1}, {u0, v1}}}}) {
        for (const Vector3d& share : {Vector3d(1, 1, 1), Vector3d(1.5, 1.5, 0), Vector3d(0, 1.5, 1.5)}) {
          Vector3d q = Vector3d::Zero();
          double u = 0, v = 0;
          for (std::size_t k = 0; k < 3; ++k) {
            const double weight = share[static_cast<Eigen::Index>(k)] / 3;
            q += weight * p(t[k][0], t[k][1]);
            u += weight * t[k][0];
            v += weight * t[k][1];
          }
          worst = std::max(worst, std::abs(normal_of(p, u, v).dot(q - p(u, v))));
        }
      }
    }
  }
  return worst;
}

enum class Direction { kGiven, kSearched };

// The plan of a surface turned in space; ribs may be as far off as the facets are high.
PlanResult plan_swept(const Swept& p, int nu, int nv, double mesh_error, const Eigen::Quaterniond& turn,
                      Direction direction = Direction::kGiven) {
  Settings settings;
  settings.design.units = "mm";
  settings.design.keep = Keep::kBack;
  settings.fit.deviation_share = mesh_error / settings.design.tolerance_mm;
  const Vector3d sweep = turn * Vector3d::UnitX();
  if (direction == Direction::kGiven) settings.slice.direction = {{sweep.x(), sweep.y(), sweep.z()}};
  const auto design = grid_design("swept", nu, nv, [&](double u, double v) -> Vector3d {
    return turn * p(u, v) + Vector3d(310, -140, 75);
  });
  return plan(design, settings, {});
}

const std::array<Eigen::Quaterniond, 3>& turns() {
  static const std::array<Eigen::Quaterniond, 3> all{Eigen::Quaterniond::Identity(),
                                                     Eigen::Quaterniond(0.6, -0.3, 0.5, 0.2).normalized(),
                                                     Eigen::Quaterniond(-0.2, 0.7, 0.1, 0.9).normalized()};
  return all;
}

class ElasticaSweep : public ::testing::TestWithParam<Shape> {};

TEST_P(ElasticaSweep, ComesBackInOneStripWithinTheErrorOfItsMeshAtEveryFineness) {
  const Swept p{GetParam()};
  std::vector<double> errors, deviations;
  for (const int fineness : {1, 2, 4}) {
    const int nu = 12 * fineness, nv = 24 * fineness;
    errors.push_back(mesh_error_mm(p, nu, nv));
    const PlanResult result =
        plan_swept(p, nu, nv, errors.back(), turns()[static_cast<std::size_t>(fineness / 2)]);
    for (const Refusal& r : result.refusals) ADD_FAILURE() << describe(r);
    ASSERT_EQ(result.strips.size(), 1u) << nu << " x " << nv;
    EXPECT_LE(result.strips[0].ribs, 6u);
    EXPECT_EQ(result.verification.uncut_mm2, 0);
    // Twice the mesh's own error, and a micrometre of the fit's steps along its curves.
    EXPECT_LE(result.verification.deviation.max, 2 * errors.back() + 1e-3);
    EXPECT_LE(result.verification.deviation.rms, 0.5 * errors.back() + 1e-3);
    deviations.push_back(result.verification.deviation.max);
  }
  // Half the cells' size, a quarter of the error, and of what comes back with it.
  for (std::size_t i = 1; i < errors.size(); ++i) {
    EXPECT_NEAR(errors[i - 1] / errors[i], 4, 0.2);
    EXPECT_GT(deviations[i - 1] / deviations[i], 2);
  }
}

TEST_P(ElasticaSweep, IsTheSameInEveryPositionInSpace) {
  const Swept p{GetParam()};
  const double error = mesh_error_mm(p, 24, 48);
  const PlanResult first = plan_swept(p, 24, 48, error, turns()[0]);
  for (const Eigen::Quaterniond& turn : turns()) {
    const PlanResult result = plan_swept(p, 24, 48, error, turn);
    ASSERT_EQ(result.strips.size(), first.strips.size());
    EXPECT_EQ(result.strips[0].ribs, first.strips[0].ribs);
    EXPECT_EQ(result.strips[0].blade_length_mm, first.strips[0].blade_length_mm);
    // Samples are thinned on other cells in every position.
    EXPECT_NEAR(result.verification.deviation.max, first.verification.deviation.max, 0.5 * error);
  }
}

TEST_P(ElasticaSweep, ComesBackAlongADirectionThatIsSearchedFor) {
  const Swept p{GetParam()};
  const double error = mesh_error_mm(p, 24, 48);
  for (const Eigen::Quaterniond& turn : turns()) {
    const PlanResult result = plan_swept(p, 24, 48, error, turn, Direction::kSearched);
    for (const Refusal& r : result.refusals) ADD_FAILURE() << describe(r);
    ASSERT_EQ(result.strips.size(), 1u);
    EXPECT_EQ(result.verification.uncut_mm2, 0);
    EXPECT_LE(result.verification.deviation.max, 2 * error);
    EXPECT_FALSE(result.decisions.back().fan);
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, ElasticaSweep, ::testing::Values(hill, with_inflection, sharp_bend),
                         [](const auto& shape) {
                           return shape.index == 0   ? "Hill"
                                  : shape.index == 1 ? "WithInflection"
                                                     : "SharpBend";
                         });

}  // namespace
}  // namespace hotblade::pipeline
