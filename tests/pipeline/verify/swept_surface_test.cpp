// The surface that a wide blade leaves on a path that bends, against all places of its width by themselves.
#include "pipeline/verify/swept_surface.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "tests/pipeline/vault_program.hpp"

namespace hotblade::pipeline {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kHalfTurn_rad = 0.7, kBlade_mm = 400;

// Where the blade passes in the plane of the sweep and the normals: an arc, hollow or a crest seen from the
// waste above it, its middle leaning. The width stands along x, or square to where an axis is seen that lies
// so far below.
struct Path {
  double radius_mm = 0;
  bool hollow = true;
  double lean_rad = 0;
  double axis_mm = 0;
  bool turns = false;  // from hollow to crest, or back, at its middle

  [[nodiscard]] Vector2d at(double angle) const {
    const double side = (hollow ? -1 : 1) * (turns && angle > 0 ? -1 : 1);
    const Vector2d p(radius_mm * std::sin(angle), side * radius_mm * (std::cos(angle) - 1));
    const double c = std::cos(lean_rad), s = std::sin(lean_rad);
    return {c * p.x() - s * p.y(), s * p.x() + c * p.y()};
  }
  [[nodiscard]] Vector2d width_at(double angle) const {
    if (axis_mm == 0) return Vector2d::UnitX();
    const Vector2d from_axis = (at(angle) + Vector2d(0, axis_mm)).normalized();
    return from_axis.y() > 0 ? Vector2d(from_axis.y(), -from_axis.x())
                             : Vector2d(-from_axis.y(), from_axis.x());
  }
};

// A straight weightless blade along y that sweeps along x and melts 1 mm.
Program swept(const Path& path) {
  Program program = testing::vault_program();
  program.blade.density_kg_m3 = 0;
  Strip& strip = program.strips.front();
  const BladePose pattern = strip.poses.front();
  strip.poses.clear();
  const auto poses = static_cast<int>(2 * kHalfTurn_rad * path.radius_mm / 0.2);
  for (int i = 0; i <= poses; ++i) {
    const double angle = kHalfTurn_rad * (2.0 * i / poses - 1);
    const Vector2d p = path.at(angle), width = path.width_at(angle);
    BladePose& pose = strip.poses.emplace_back(pattern);
    pose.t = 0.03 * i;
    pose.frame = SharedFrame(Frame{{p.x(), 0, p.y()}, Vector3d::UnitY(), Vector3d(-width.y(), 0, width.x())});
    pose.blade = {0, 0, 0, 0, 0, 0, kBlade_mm};
    pose.foam = {{100, 300}};
  }
  return program;
}

// Distance of a point from all that the width's middle surface passes through, in the plane of the sweep: the
// least of many places of the path, then of as many about it.
double distance_mm(const Path& path, double width_mm, const Vector3d& point) {
  constexpr int kPlaces = 400;
  const Vector2d p(point.x(), point.z());
  double nearest = 1e300, middle = 0, reach = kHalfTurn_rad;
  for (int look = 0; look < 3; ++look, reach *= 4.0 / kPlaces) {
    const double about = middle;
    for (int i = -kPlaces; i <= kPlaces; ++i) {
      const double angle = std::clamp(about + reach * i / kPlaces, -kHalfTurn_rad, kHalfTurn_rad);
      const Vector2d m = path.at(angle), width = path.width_at(angle);
      const double along = std::clamp((p - m).dot(width), -width_mm / 2, width_mm / 2);
      const double distance = (p - m - along * width).norm();
      if (distance < nearest) {
        nearest = distance;
        middle = angle;
      }
    }
  }
  return nearest;
}

// How far the surface lies off the edge of what is melted, away from the path's ends.
double off_mm(const Path& path) {
  const Program program = swept(path);
  const SweptSurface cut = swept_surface(program, 1);
  const auto [low, high] = std::minmax({path.at(-kHalfTurn_rad).x(), path.at(kHalfTurn_rad).x()});
  const double ends = 1.5 * program.blade.width_mm;
  double off = 0;
  int seen = 0;
  for (const Vector3d& p : cut.vertices) {
    if (p.y() != cut.vertices.front().y() || p.x() < low + ends || p.x() > high - ends) continue;
    ++seen;
    off = std::max(off, std::abs(distance_mm(path, program.blade.width_mm, p) - 0.5));
  }
  EXPECT_GT(seen, 15);
  return off;
}

TEST(SweptSurface, IsTheEdgeOfWhatTheWidthPasses) {
  constexpr double kWidth_mm = 8;
  for (const double radius_mm : {40.0, 142.0, 500.0}) {
    for (const bool hollow : {false, true}) {
      for (const double lean_rad : {0.0, 0.3, 0.6}) {
        // By the slope alone it is a width squared over eight radii off: 0.2, 0.056 and 0.016 mm.
        EXPECT_LT(off_mm({radius_mm, hollow, lean_rad}), 0.02 * kWidth_mm * kWidth_mm / (8 * radius_mm))
            << radius_mm << (hollow ? " hollow " : " crest ") << lean_rad;
        for (const double axis_mm : {-300.0, 600.0}) {
          EXPECT_LT(off_mm({radius_mm, hollow, lean_rad, axis_mm}),
                    0.02 * kWidth_mm * kWidth_mm / (8 * radius_mm) + 0.0005)
              << radius_mm << (hollow ? " hollow " : " crest ") << lean_rad << " about " << axis_mm;
        }
      }
    }
  }
}

// A border that crosses the rulings at a small angle: what is in foam begins by `slide_mm` farther along the
// blade with every pose, whose clamps are off by up to `jitter_mm`.
double off_at_an_oblique_border_mm(const Path& path, double slide_mm, double jitter_mm) {
  Program program = swept(path);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-jitter_mm, jitter_mm);
  double first = 20;
  for (BladePose& pose : program.strips.front().poses) {
    Frame frame{pose.frame.point(any(random), any(random)), pose.frame.x(), pose.frame.y()};
    pose.frame = SharedFrame(frame);
    first = first > 250 ? 20 : first + slide_mm;
    pose.foam = {{first, 300}};
  }
  const SweptSurface cut = swept_surface(program, 2.5);
  const auto [low, high] = std::minmax({path.at(-kHalfTurn_rad).x(), path.at(kHalfTurn_rad).x()});
  const double ends = 1.5 * program.blade.width_mm;
  double off = 0;
  int seen = 0;
  constexpr std::size_t kEvery = 37;  // of no number of columns
  for (std::size_t v = 0; v < cut.vertices.size(); v += kEvery) {
    const Vector3d& p = cut.vertices[v];
    if (p.x() < low + ends || p.x() > high - ends) continue;
    ++seen;
    off = std::max(off, std::abs(distance_mm(path, program.blade.width_mm, p) - 0.5));
  }
  EXPECT_GT(seen, 40);
  return off;
}

TEST(SweptSurface, IsNoFartherOffWherePartsInFoamSlideAlongTheBlade) {
  for (const Path& path : {Path{60, true, 0.2, 0}, Path{60, false, 0.2, 0}, Path{60, false, 0, 500}}) {
    constexpr double kJitter_mm = 0.01;
    const double still = off_at_an_oblique_border_mm(path, 0, kJitter_mm);
    EXPECT_LT(still, 4 * kJitter_mm);
    for (const double slide_mm : {1.0, 5.0, 20.0})
      EXPECT_LT(off_at_an_oblique_border_mm(path, slide_mm, kJitter_mm), 4 * kJitter_mm)
          << slide_mm << " against " << still;
  }
}

// Every pose of the path hot, and off across the blade by up to `jitter_mm`.
Program executed(const Path& path, double jitter_mm) {
  Program program = swept(path);
  std::mt19937 random(11);
  std::uniform_real_distribution<double> any(-jitter_mm, jitter_mm);
  for (BladePose& pose : program.strips.front().poses) {
    pose.heat = true;
    pose.frame = SharedFrame(Frame{pose.frame.point(0, any(random)), pose.frame.x(), pose.frame.y()});
  }
  return program;
}

// The same surface without a width that passes: slopes and bends tell the edge.
SweptSurface told_by_slopes(const Program& program, SweptSurface cut) {
  for (std::size_t v = 0; v < cut.vertices.size(); ++v) {
    const double half_mm = half_band_mm(program.blade, cut.normals[v], cut.plane_normals[v],
                                        cut.speeds_mm_s[v], cut.width_bends_per_mm[v]);
    cut.vertices[v] += (cut.half_bands_mm[v] - half_mm) * cut.normals[v];
  }
  return cut;
}

// How far a surface lies off the edge of what a smooth motion along the path melts, on the kept side of it
// and on the waste's.
struct Off {
  double kept_mm = 0, waste_mm = 0;
};

Off off_smooth_mm(const Path& path, const SweptSurface& cut, double width_mm, double ends_mm) {
  const auto [low, high] = std::minmax({path.at(-kHalfTurn_rad).x(), path.at(kHalfTurn_rad).x()});
  Off off;
  int seen = 0;
  for (const Vector3d& p : cut.vertices) {
    if (p.x() < low + ends_mm || p.x() > high - ends_mm) continue;
    ++seen;
    const double deeper = distance_mm(path, width_mm, p) - 0.5;
    off.kept_mm = std::max(off.kept_mm, deeper);
    off.waste_mm = std::max(off.waste_mm, -deeper);
  }
  EXPECT_GT(seen, 100);
  return off;
}

Off off_smooth_mm(const Path& path, const Program& program, bool by_every_pose, double ends_mm) {
  GridSteps steps;
  steps.by_every_pose = by_every_pose;
  return off_smooth_mm(path, swept_surface(program, steps), program.blade.width_mm, ends_mm);
}

Off off_by_slopes_mm(const Path& path, const Program& program, double ends_mm) {
  const SweptSurface cut = told_by_slopes(program, swept_surface(program, GridSteps{}));
  return off_smooth_mm(path, cut, program.blade.width_mm, ends_mm);
}

TEST(SweptSurface, ByEveryPoseIsTheSameOfASmoothMotion) {
  for (const Path& path : {Path{40, true, 0.3, 0}, Path{40, false, 0.3, 0}, Path{90, true, 0.2, 600}}) {
    const Program program = executed(path, 0);
    const double ends_mm = 1.5 * program.blade.width_mm;
    const Off one = off_smooth_mm(path, program, true, ends_mm),
              by_bend = off_smooth_mm(path, program, false, ends_mm);
    EXPECT_LT(one.kept_mm, 0.004);
    EXPECT_LT(one.waste_mm, 0.004);
    EXPECT_LT(by_bend.kept_mm, 0.004);
    EXPECT_LT(by_bend.waste_mm, 0.004);
  }
}

// Beside a border a motion goes another way, and rows as far apart as the border's width tell no slope there.
TEST(SweptSurface, IsTheEdgeWhereAMotionTurnsWithinAWidth) {
  for (const Path& path :
       {Path{30, true, 0.3, 0, true}, Path{30, false, 0.3, 0, true}, Path{60, true, 0.5, 0, true}}) {
    const Program program = executed(path, 0);
    const double ends_mm = 1.5 * program.blade.width_mm;
    const Off planned = off_smooth_mm(path, program, false, ends_mm);
    EXPECT_LT(planned.kept_mm, 0.005);
    EXPECT_LT(planned.waste_mm, 0.005);
    const Off by_slope = off_by_slopes_mm(path, program, ends_mm);
    EXPECT_GT(std::max(by_slope.kept_mm, by_slope.waste_mm), 0.01);
  }
}

TEST(SweptSurface, ByEveryPoseIsOffByNoMoreThanPosesAre) {
  constexpr double kJitter_mm = 0.1;
  for (const Path& path : {Path{142, false, 0.2, 0}, Path{60, true, 0.1, 0}}) {
    const Program program = executed(path, kJitter_mm);
    const double ends_mm = 1.5 * program.blade.width_mm;
    const Off one = off_smooth_mm(path, program, true, ends_mm);
    EXPECT_LT(one.kept_mm, kJitter_mm + 0.005);
    EXPECT_GT(one.kept_mm, 0.7 * kJitter_mm);
    // The slopes between poses are none that the width has.
    EXPECT_GT(off_by_slopes_mm(path, program, ends_mm).kept_mm, 1.2 * kJitter_mm);
  }
}

// Poses beyond the ends form no design, but their width passes over its border.
TEST(SweptSurface, HasAtItsEndsWhatPosesBeyondThemMelt) {
  for (const Path& path : {Path{60, true, 0.3, 0}, Path{60, false, 0.3, 0}}) {
    Program program = executed(path, 0);
    std::vector<BladePose>& poses = program.strips.front().poses;
    const std::size_t beyond = poses.size() / 4;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      if (i < beyond || i + beyond >= poses.size()) poses[i].foam.reset();
    }
    // They go down by 0.2 mm there.
    const auto lower = [&](BladePose& pose) {
      pose.frame =
          SharedFrame(Frame{pose.frame.point(0, 0) - Vector3d(0, 0, 0.2), pose.frame.x(), pose.frame.y()});
    };
    const Off as_planned = off_smooth_mm(path, program, false, 0);
    EXPECT_LT(as_planned.kept_mm, 0.004);
    for (std::size_t i = 0; i < beyond; ++i) lower(poses[i]);
    const Off lowered = off_smooth_mm(path, program, false, 0);
    EXPECT_GT(lowered.kept_mm, 0.1);
    EXPECT_LT(lowered.kept_mm, 0.21);
  }
}

TEST(SweptSurface, GoesBySlopesWhereNoHotPosesReachAcross) {
  const Path path{142, false, 0.2, 0};
  Program program = executed(path, 0.05);
  // Less than half the width of motion.
  program.strips.front().poses.resize(15);
  GridSteps every;
  every.finest_mm = every.widest_mm = 0.5;
  every.by_every_pose = true;
  const SweptSurface cut = swept_surface(program, every), by_slope = told_by_slopes(program, cut);
  ASSERT_GT(cut.vertices.size(), 100u);
  for (std::size_t v = 0; v < cut.vertices.size(); ++v)
    EXPECT_LT((by_slope.vertices[v] - cut.vertices[v]).norm(), 1e-12);
}

// A blade that is cold, or forms nothing, for a part of its way leaves that part of the design uncut.
TEST(SweptSurface, HasAGapWhereTheBladeIsColdOrFormsNothing) {
  const Path path{500, true, 0, 0};
  for (const bool is_cold : {true, false}) {
    Program program = swept(path);
    std::vector<BladePose>& poses = program.strips.front().poses;
    const std::size_t first = poses.size() / 2, count = 200;
    for (std::size_t i = first; i < first + count; ++i) {
      if (is_cold) poses[i].heat = false;
      if (!is_cold) poses[i].foam.reset();
    }
    const auto x_of = [&](std::size_t pose) { return poses[pose].frame.origin.x(); };
    ASSERT_GT(x_of(first + count) - x_of(first - 1), 30);
    const SweptSurface cut = swept_surface(program, 2.5);
    int at_gap = 0;
    for (std::size_t v = 0; v < cut.vertices.size(); ++v) {
      const auto pose = static_cast<std::size_t>(cut.pose_of_vertex[v]);
      EXPECT_TRUE(pose < first || pose >= first + count);
      if (pose + 1 != first && pose != first + count) continue;
      ++at_gap;
      EXPECT_NE(cut.sides_of_vertex[v] & 3, 0) << "not an edge beside the gap";
    }
    EXPECT_GT(at_gap, 100);
    for (const auto& t : cut.triangles) {
      const auto [low, high] = std::minmax({cut.pose_of_vertex[static_cast<std::size_t>(t[0])],
                                            cut.pose_of_vertex[static_cast<std::size_t>(t[1])],
                                            cut.pose_of_vertex[static_cast<std::size_t>(t[2])]});
      EXPECT_EQ(static_cast<std::size_t>(low) < first, static_cast<std::size_t>(high) < first)
          << "a facet over the gap";
    }
  }
}

// However many stretches there are, each has its least grid, and steps do not grow for ever.
TEST(SweptSurface, OfMoreStretchesThanItHasRoomForHasTheLeastOfEach) {
  Program program = swept({500, true, 0, 0});
  std::vector<BladePose>& poses = program.strips.front().poses;
  for (std::size_t i = 0; i < poses.size(); i += 3) poses[i].heat = false;
  GridSteps steps;
  steps.most_vertices = 100;
  const SweptSurface cut = swept_surface(program, steps);
  EXPECT_EQ(cut.vertices.size(), 6 * (poses.size() / 3));
}

}  // namespace
}  // namespace hotblade::pipeline
