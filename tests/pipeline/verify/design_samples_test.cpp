#include "pipeline/verify/design_samples.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <random>
#include <stdexcept>

namespace hotblade::pipeline {
namespace {

struct Faces {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<int, 3>> triangles;
  [[nodiscard]] MeshView view() const { return {vertices, triangles}; }
};

// Faces of all sizes, needles among them.
Faces random_faces(int count) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> log_size(-2, 2);
  Faces faces;
  for (int t = 0; t < count; ++t) {
    const double size = std::pow(10, log_size(random)), width = t % 3 == 0 ? 1e-3 : 1;
    for (int i = 0; i < 3; ++i) {
      faces.vertices.emplace_back(100.0 * t + size * normal(random), size * width * normal(random), 0);
    }
    faces.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  return faces;
}

DesignSamples all_of(const DesignSampler& sampler, std::size_t at_once) {
  DesignSamples all;
  sampler.each(at_once, [&](std::size_t first, const DesignSamples& some) {
    EXPECT_EQ(first, all.points.size());
    all.points.insert(all.points.end(), some.points.begin(), some.points.end());
    all.areas.insert(all.areas.end(), some.areas.begin(), some.areas.end());
  });
  return all;
}

TEST(DesignSampler, StandsForTheWholeArea) {
  const Faces faces = random_faces(1000);
  double area = 0, sampled = 0;
  for (int t = 0; t < 1000; ++t) area += facet(faces.view(), t).area();
  const DesignSampler sampler(faces.view(), 2);
  const DesignSamples samples = all_of(sampler, 100);
  EXPECT_EQ(samples.points.size(), sampler.count());
  for (const double share : samples.areas) sampled += share;
  EXPECT_NEAR(sampled, area, 1e-9 * area);
}

TEST(DesignSampler, MakesAllSamplesInABoxAtTheirPlaces) {
  const Faces faces = random_faces(3000);
  const DesignSampler sampler(faces.view(), 2);
  const DesignSamples all = all_of(sampler, 100);
  const Eigen::AlignedBox3d box(Eigen::Vector3d(100000, -1000, -1), Eigen::Vector3d(140000, 1000, 1));
  std::vector<char> made(all.points.size(), 0);
  sampler.each_in(box, 1000, [&](std::size_t first, const DesignSamples& some) {
    for (std::size_t i = 0; i < some.points.size(); ++i) {
      EXPECT_EQ(some.points[i], all.points[first + i]);
      EXPECT_EQ(some.areas[i], all.areas[first + i]);
      made[first + i] = 1;
    }
  });
  std::size_t inside = 0, left_out = 0;
  for (std::size_t i = 0; i < made.size(); ++i) {
    if (box.contains(all.points[i])) {
      ++inside;
      EXPECT_TRUE(made[i]);
    }
    left_out += made[i] ? 0 : 1;
  }
  EXPECT_GT(inside, 100U);
  EXPECT_GT(left_out, all.points.size() / 2);
}

TEST(DesignSampler, LeavesNoPlaceOfAFaceFartherThanTheSpacing) {
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> u(0, 1);
  const Faces faces = random_faces(60);
  const double sample_mm = 3;
  for (int t = 0; t < 60; ++t) {
    const std::span<const std::array<int, 3>> one(&faces.triangles[static_cast<std::size_t>(t)], 1);
    const DesignSamples samples = all_of(DesignSampler({faces.vertices, one}, sample_mm), 1000);
    const Facet f = facet(faces.view(), t);
    for (int i = 0; i < 50; ++i) {
      const double r = std::sqrt(u(random)), s = u(random);
      const Eigen::Vector3d p = f.a + r * (f.b - f.a + s * (f.c - f.b));
      double nearest = 1e300;
      for (const Eigen::Vector3d& q : samples.points) nearest = std::min(nearest, (p - q).norm());
      EXPECT_LE(nearest, sample_mm);
    }
  }
}

TEST(DesignSampler, IsTheSameHoweverManyComeAtOnceAndOnAnyNumberOfThreads) {
  const Faces faces = random_faces(2000);
  const DesignSampler sampler(faces.view(), 1);
  const DesignSamples whole = all_of(sampler, std::size_t{1} << 30);
  for (const std::size_t at_once : {std::size_t{0}, std::size_t{1}, std::size_t{5000}}) {
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1 + at_once % 2);
    const DesignSamples parts = all_of(sampler, at_once);
    EXPECT_EQ(parts.points, whole.points);
    EXPECT_EQ(parts.areas, whole.areas);
  }
}

TEST(DesignSampler, OfNoFacesHasNoSamples) {
  const DesignSampler sampler({}, 1);
  EXPECT_EQ(sampler.count(), 0u);
  sampler.each(10, [](std::size_t, const DesignSamples&) { ADD_FAILURE(); });
  EXPECT_THROW(DesignSampler({}, 0), std::logic_error);
}

}  // namespace
}  // namespace hotblade::pipeline
