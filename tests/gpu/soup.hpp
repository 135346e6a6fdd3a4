// Triangle soups and points for the distance tests, from seeded generators.
#pragma once

#include <Eigen/Core>
#include <array>
#include <random>
#include <vector>

namespace hotblade::gpu::test {

struct Soup {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<int, 3>> triangles;
};

inline Eigen::Vector3d random_point(std::mt19937_64& rng, double half) {
  std::uniform_real_distribution<double> u(-half, half);
  const double x = u(rng), y = u(rng), z = u(rng);
  return {x, y, z};
}

inline std::vector<Eigen::Vector3d> random_points(std::mt19937_64& rng, int n, double half,
                                                  const Eigen::Vector3d& centre = {0, 0, 0}) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < n; ++i) points.emplace_back(centre + random_point(rng, half));
  return points;
}

// n triangles of the given size, spread over a cube of half width `half` about `centre`.
inline Soup random_soup(std::mt19937_64& rng, int n, double half, double size,
                        const Eigen::Vector3d& centre = {0, 0, 0}) {
  Soup soup;
  for (int i = 0; i < n; ++i) {
    const Eigen::Vector3d at = centre + random_point(rng, half);
    for (int k = 0; k < 3; ++k) soup.vertices.emplace_back(at + random_point(rng, size));
    soup.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return soup;
}

}  // namespace hotblade::gpu::test
