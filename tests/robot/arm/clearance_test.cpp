// Distances of bodies against triangles one by one, and proofs against dense sampling.
#include "robot/arm/clearance.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "robot/arm/solid.hpp"
#include "tests/robot/arm/arms.hpp"

namespace hotblade::robot {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

double edge_to_edge(const Vector3d& p, const Vector3d& u, const Vector3d& q, const Vector3d& v) {
  // The least over both ends of each, and over the lines where both meet the perpendicular inside.
  const auto to_segment = [](const Vector3d& x, const Vector3d& a, const Vector3d& d) {
    return (a + std::clamp((x - a).dot(d) / d.squaredNorm(), 0.0, 1.0) * d - x).norm();
  };
  double least =
      std::min({to_segment(p, q, v), to_segment(p + u, q, v), to_segment(q, p, u), to_segment(q + v, p, u)});
  const Vector3d n = u.cross(v);
  if (n.squaredNorm() < 1e-18) return least;
  const double s = (q - p).cross(v).dot(n) / n.squaredNorm(), t = (q - p).cross(u).dot(n) / n.squaredNorm();
  if (s >= 0 && s <= 1 && t >= 0 && t <= 1) least = std::min(least, std::abs((q - p).dot(n)) / n.norm());
  return least;
}

double point_to_triangle(const Vector3d& p, const Triangle& t) {
  const Vector3d n = (t[1] - t[0]).cross(t[2] - t[0]).normalized();
  const double off = (p - t[0]).dot(n);
  const Vector3d foot = p - off * n;
  for (std::size_t i = 0; i < 3; ++i) {
    if ((t[(i + 1) % 3] - t[i]).cross(foot - t[i]).dot(n) < 0) return 1e9;  // an edge is nearer
  }
  return std::abs(off);
}

double brute_distance(const Solid& a, const Isometry3d& at_a, const Solid& b, const Isometry3d& at_b) {
  double least = 1e9;
  for (const Triangle& ta : a.triangles()) {
    const Triangle s{at_a * ta[0], at_a * ta[1], at_a * ta[2]};
    for (const Triangle& tb : b.triangles()) {
      const Triangle t{at_b * tb[0], at_b * tb[1], at_b * tb[2]};
      for (std::size_t i = 0; i < 3; ++i) {
        least = std::min({least, point_to_triangle(s[i], t), point_to_triangle(t[i], s)});
        for (std::size_t j = 0; j < 3; ++j)
          least = std::min(least, edge_to_edge(s[i], s[(i + 1) % 3] - s[i], t[j], t[(j + 1) % 3] - t[j]));
      }
    }
  }
  return least;
}

TEST(Clearance, IsThatOfTheTriangles) {
  std::mt19937_64 random(7);
  const ArmModel model = read_urdf(shipped_arm(kShippedArms[0]));
  std::vector<Solid> links;
  for (const Body& body : model.bodies) links.emplace_back(body.shapes);
  std::uniform_real_distribution<double> side(-1, 1);
  int apart = 0;
  for (int i = 0; i < 200; ++i) {
    const Solid &a = links[random() % links.size()], &b = links[random() % links.size()];
    Isometry3d at = Isometry3d::Identity();
    at.linear() = Eigen::Quaterniond(side(random), side(random), side(random), side(random))
                      .normalized()
                      .toRotationMatrix();
    const Vector3d way = Vector3d(side(random), side(random), side(random)).normalized();
    at.translation() = a.centre() + (a.radius_mm() + b.radius_mm()) * way - at.linear() * b.centre();
    const double mm = distance_mm(a, Isometry3d::Identity(), b, at, 1e6);
    EXPECT_NEAR(mm, brute_distance(a, Isometry3d::Identity(), b, at), 1e-9);
    EXPECT_GE(distance_mm(a, Isometry3d::Identity(), b, at, mm / 2), mm / 2 - 1e-9) << "capped";
    apart += mm > 1 ? 1 : 0;
  }
  EXPECT_GT(apart, 100);
}

TEST(Clearance, IsZeroWhereSurfacesCutAndKnowsWhatLiesInside) {
  const auto box = [](double size) {
    return Solid({Shape{Isometry3d::Identity(), Box{Vector3d::Constant(size)}}});
  };
  const Solid large = box(100), small = box(10);
  Isometry3d at = Isometry3d::Identity();
  at.translation().x() = 50;
  EXPECT_EQ(distance_mm(large, Isometry3d::Identity(), small, at, 500), 0);
  EXPECT_FALSE(
      one_inside_other(large, Isometry3d::Identity(), small, Isometry3d(Eigen::Translation3d(200, 0, 0))));
  at.translation().x() = 10;
  EXPECT_NEAR(distance_mm(large, Isometry3d::Identity(), small, at, 500), 35, 1e-9);
  EXPECT_TRUE(one_inside_other(large, Isometry3d::Identity(), small, at));
  EXPECT_TRUE(one_inside_other(small, at, large, Isometry3d::Identity()));
  for (const Shape& shape :
       {Shape{Isometry3d::Identity(), Cylinder{40, 80}}, Shape{Isometry3d::Identity(), Sphere{40}}}) {
    // Around the shape, and little larger.
    for (const Triangle& t : triangles_of(shape)) {
      const Vector3d normal = (t[1] - t[0]).cross(t[2] - t[0]).normalized();
      EXPECT_GE(normal.dot(t[0]), 40 - 1e-9) << "a face cuts the shape, or looks inwards";
    }
    EXPECT_TRUE(Solid({shape}).holds({0, 0, 0}));
    EXPECT_FALSE(Solid({shape}).holds({0, 0, 60}));
  }
}

// Two arms that face each other; the first swings about its axes.
struct Swing {
  Cell cell;
  CellPath path;
};

Swing swing(std::size_t poses, double turn_rad) {
  Swing s;
  for (const double x : {-2100.0, 2100.0}) {
    CellArm arm{x < 0 ? "R1" : "R2", "", "", read_urdf(shipped_arm(kShippedArms[0]))};
    arm.base.p.x() = x;
    if (x > 0) arm.base.q = Eigen::Quaterniond(0, 0, 0, 1);
    arm.tool.shapes = {{Isometry3d(Eigen::Translation3d(0, 0, 117.5)), Box{{40, 40, 235}}}};
    s.cell.arms.push_back(arm);
  }
  JointAngles home;
  home << 0.2, 0.1, 0.2, 0.1, 0.9, 0.3;
  for (std::size_t k = 0; k < poses; ++k) {
    const double share = static_cast<double>(k) / static_cast<double>(poses - 1);
    JointAngles q = home;
    q[0] += turn_rad * (share - 0.5);
    q[3] += 0.3 * std::sin(3 * share);
    s.path.t.push_back(0.05 * static_cast<double>(k));
    s.path.joints[0].push_back(q);
    s.path.joints[1].push_back(home);
  }
  return s;
}

TEST(ProvedClear, LeastDistancesAreThoseOfDenseSampling) {
  const Swing s = swing(401, 0.8);
  std::vector<Standing> standing{
      {Standing::What::kObstacle,
       "fence",
       {{Isometry3d(Eigen::Translation3d(-1200, 1800, 800)), Box{{40, 40, 1600}}}}}};
  const Clearance proved = prove_clear(s.cell, standing, s.path);
  const Clearance dense = sampled_clearance(s.cell, standing, s.path, 1);
  EXPECT_LT(proved.asked, dense.asked / 2) << "the proof skips what is proved";
  for (std::size_t i = 0; i < kPairKinds.size(); ++i) {
    ASSERT_EQ(proved.nearest[i].has_value(), dense.nearest[i].has_value()) << name(kPairKinds[i]);
    if (!dense.nearest[i]) continue;
    EXPECT_GE(proved.nearest[i]->mm, dense.nearest[i]->mm - 1e-9);
    EXPECT_LE(proved.nearest[i]->mm, dense.nearest[i]->mm + kNearestWithin_mm);
  }
  EXPECT_EQ(proved.worst.has_value(), dense.worst.has_value());
}

TEST(ProvedClear, MissesNothingThatIsCrossedBetweenTwoPoses) {
  // Needles that stand where the tool's end passes halfway between two poses far apart.
  const Swing s = swing(7, 0.9);
  const CellArm& arm = s.cell.arms[0];
  for (std::size_t k = 0; k + 1 < s.path.t.size(); ++k) {
    const JointAngles q = (s.path.joints[0][k] + s.path.joints[0][k + 1]) / 2;
    const Isometry3d flange = Isometry3d(Eigen::Translation3d(arm.base.p)) * forward(arm.model.arm, q);
    const Vector3d tip = flange * Vector3d(0, 0, 200);
    const std::vector<Standing> needle{
        {Standing::What::kObstacle, "needle", {{Isometry3d(Eigen::Translation3d(tip)), Box{{1, 1, 60}}}}}};
    const Clearance sampled = sampled_clearance(s.cell, needle, s.path, 1);
    const Clearance proved = prove_clear(s.cell, needle, s.path);
    ASSERT_TRUE(proved.worst) << "the needle after pose " << k << " is missed";
    EXPECT_EQ(proved.worst->second, "needle");
    EXPECT_FALSE(sampled.worst) << "poses alone would have found it: no test of what lies between";
  }
}

// A flat blade that sinks by 300 mm a step, past a needle halfway between two poses; arms stay where they
// are.
TEST(ProvedClear, FindsANeedleThatTheBladeAloneCrossesBetweenTwoPoses) {
  Swing s = swing(5, 0);
  for (std::size_t k = 0; k < s.path.t.size(); ++k) {
    const double z = 1500 - 300 * static_cast<double>(k);
    s.path.blade.corners.push_back(
        {{-100, -4, z}, {-100, 4, z}, {0, -4, z}, {0, 4, z}, {100, -4, z}, {100, 4, z}});
  }
  s.path.blade.free_to = 2;
  const auto at = [](Standing::What what, double z) {
    return std::vector<Standing>{
        {what, "it", {{Isometry3d(Eigen::Translation3d(30, 0, z)), Box{{1, 1, 60}}}}}};
  };
  EXPECT_FALSE(sampled_clearance(s.cell, at(Standing::What::kObstacle, 1050), s.path, 1).worst);
  const Clearance crossed = prove_clear(s.cell, at(Standing::What::kObstacle, 1050), s.path);
  ASSERT_TRUE(crossed.worst);
  EXPECT_EQ(crossed.worst->kind, PairKind::kBladeObstacle);
  EXPECT_EQ(crossed.worst->first, "the blade");
  EXPECT_EQ(crossed.worst->second, "it");
  EXPECT_EQ(prove_clear(s.cell, at(Standing::What::kTable, 1050), s.path).worst->kind, PairKind::kBladeTable);
  // What the blade cuts, and what it leaves the block towards.
  for (const Standing::What what : {Standing::What::kBlock, Standing::What::kPlinth})
    EXPECT_FALSE(prove_clear(s.cell, at(what, 1050), s.path).worst);
}

TEST(ProvedClear, KeepsBlockAndPlinthFromObstaclesAndBases) {
  Swing s = swing(3, 0);
  const auto box = [](Standing::What what, const std::string& name, const Vector3d& at, double size) {
    return Standing{what, name, {{Isometry3d(Eigen::Translation3d(at)), Box{Vector3d::Constant(size)}}}};
  };
  for (const Standing::What what : {Standing::What::kBlock, Standing::What::kPlinth}) {
    const Standing block = box(what, "block", {0, 0, 500}, 100);
    for (const double beside : {0.0, 65.0, 74.0}) {
      const Clearance near =
          prove_clear(s.cell, {block, box(Standing::What::kObstacle, "post", {beside, 0, 500}, 10)}, s.path);
      ASSERT_TRUE(near.worst) << beside;
      EXPECT_EQ(near.worst->kind, PairKind::kBlockObstacle);
      EXPECT_NEAR(near.worst->distance_mm, std::max(0.0, beside - 55), 1e-9);
    }
    EXPECT_FALSE(
        prove_clear(s.cell, {block, box(Standing::What::kObstacle, "post", {76, 0, 500}, 10)}, s.path).worst);
  }
  for (CellArm& arm : s.cell.arms)
    std::erase_if(arm.model.bodies, [](const Body& body) { return body.moved_by > 0; });
  const Clearance at_base =
      prove_clear(s.cell, {box(Standing::What::kBlock, "block", {-2100, 0, 50}, 100)}, s.path);
  ASSERT_TRUE(at_base.worst);
  EXPECT_EQ(at_base.worst->first, "arm R1 base_link");
}

// Needles and thin plates on a random surface point of a random body, where it is at a random moment between
// two poses of a random way.
TEST(ProvedClear, MissesNoneOfAThousandThatAreCrossed) {
  std::mt19937_64 random(29);
  const auto any = [&](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
  const Swing still = swing(3, 0);
  int hidden = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    Cell cell = still.cell;
    const Arm& arm = cell.arms[0].model.arm;
    // One body alone, so that what is found is what was planted. Links 1 to 6 keep from what stands.
    std::vector<Body> bodies = cell.arms[0].model.bodies;
    bodies.push_back({"tool", kJoints, {}, cell.arms[0].tool.shapes});
    for (Shape& shape : bodies.back().shapes) shape.place = arm.flange_at_zero() * shape.place;
    std::erase_if(bodies, [](const Body& body) { return body.moved_by == 0 || body.shapes.empty(); });
    const Body body = bodies[random() % bodies.size()];
    for (CellArm& one : cell.arms) {
      one.model.bodies.clear();
      one.tool.shapes.clear();
    }
    cell.arms[0].model.bodies = {body};
    CellPath path;
    JointAngles q = random_joints(arm, random), rate;
    for (int i = 0; i < q.size(); ++i) rate[i] = any(-0.4, 0.4);
    for (int k = 0; k < 6; ++k) {
      path.t.push_back(0.05 * k);
      path.joints[0].push_back(q);
      path.joints[1].push_back(still.path.joints[1][0]);
      for (int i = 0; i < q.size(); ++i) rate[i] += any(-0.02, 0.02);
      q += rate;
    }
    const std::size_t step = random() % 5;
    const double share = any(0.1, 0.9);
    const JointAngles between =
        path.joints[0][step] + share * (path.joints[0][step + 1] - path.joints[0][step]);
    const std::vector<Triangle> surface = Solid(body.shapes).triangles();
    const Triangle& t = surface[random() % surface.size()];
    const double u = any(0, 1), v = any(0, 1 - u);
    const Vector3d at = Isometry3d(Eigen::Translation3d(cell.arms[0].base.p)) *
                        link_motions(arm, between)[body.moved_by] *
                        (t[0] + u * (t[1] - t[0]) + v * (t[2] - t[0]));
    Isometry3d place = Isometry3d::Identity();
    place.linear() =
        Eigen::Quaterniond(any(-1, 1), any(-1, 1), any(-1, 1), any(-1, 1)).normalized().toRotationMatrix();
    place.translation() = at;
    const Vector3d size = trial % 2 == 0 ? Vector3d(1, 1, 60) : Vector3d(60, 60, 1);
    const std::vector<Standing> planted{{Standing::What::kObstacle, "planted", {{place, Box{size}}}}};
    const Clearance proved = prove_clear(cell, planted, path);
    ASSERT_TRUE(proved.worst) << trial << ": " << body.link << " crosses it after pose " << step;
    EXPECT_EQ(proved.worst->second, "planted");
    if (!sampled_clearance(cell, planted, path, 1).worst) ++hidden;
  }
  EXPECT_GT(hidden, 250) << "poses alone find the others";
}

}  // namespace
}  // namespace hotblade::robot
