// A design's waste side moved to where the blade's middle line passes that forms it (sweep_sections.hpp):
// what all sections of it have in common.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "pipeline/plan/sweep/sweep_sections.hpp"

namespace hotblade::pipeline {

struct MovedVertex {
  Eigen::Vector3d at{0, 0, 0};     // x, y in its plane, and its plane's offset
  Eigen::Vector3d world{0, 0, 0};  // the same point in space
  double along = 0;                // component of the normal along the sweep
};

// Of a slope by its sine.
[[nodiscard]] inline double cosine_of(double along) {
  const double sine = std::min(1.0, std::abs(along));
  return std::sqrt(1 - sine * sine);
}

// How far a point lies behind a seam, mm.
[[nodiscard]] inline double behind(const SweepSeam& seam, const Eigen::Vector3d& p) {
  return seam.at_mm - seam.normal.dot(p);
}

// For every vertex the seams that it lies behind, or before by no more than some distance: a bit each.
class BehindSeams {
 public:
  // Throws std::logic_error where there are more than 63 seams: each is of a split of its own, and no part is
  // split so often.
  BehindSeams() = default;
  template <typename At>
  BehindSeams(const std::vector<SweepSeam>& seams, std::size_t vertices, double reach_mm, const At& at)
      : all_(all_of(seams.size())), of_(vertices, 0) {
    for (std::size_t i = 0; i < vertices; ++i) {
      for (std::size_t k = 0; k < seams.size(); ++k)
        of_[i] |= static_cast<std::uint64_t>(behind(seams[k], at(i)) >= -reach_mm) << k;
    }
  }

  [[nodiscard]] bool all(int v) const { return of_[static_cast<std::size_t>(v)] == all_; }
  // Whether a part of a triangle may lie behind all of them.
  [[nodiscard]] bool in_reach(const std::array<int, 3>& t) const {
    return (of_[static_cast<std::size_t>(t[0])] | of_[static_cast<std::size_t>(t[1])] |
            of_[static_cast<std::size_t>(t[2])]) == all_;
  }

 private:
  [[nodiscard]] static std::uint64_t all_of(std::size_t seams);

  std::uint64_t all_ = 0;
  std::vector<std::uint64_t> of_;
};

// Refers to the surface. Several threads may take sections of it at once.
class MovedSurface {
 public:
  using Triangle = std::array<MovedVertex, 3>;

  // Moved by the kerf or bands, the width, the sag and behind the seams of these options.
  MovedSurface(const WasteSurface& surface, const RibAxes& axes, const SweepSectionOptions& options);

  [[nodiscard]] const WasteSurface& surface() const { return surface_; }
  [[nodiscard]] const RibAxes& axes() const { return extents_.axes; }
  [[nodiscard]] const std::vector<SweepSeam>& seams() const { return seams_; }
  // Everything of it but sections, border and gap.
  [[nodiscard]] const SweepData& extents() const { return extents_; }
  // Whether nothing lies behind the seams.
  [[nodiscard]] bool empty() const { return !(extents_.last_mm > extents_.first_mm); }
  [[nodiscard]] const MovedVertex& vertex(int v) const { return vertices_[static_cast<std::size_t>(v)]; }
  [[nodiscard]] const BehindSeams& behind() const { return behind_; }
  // The corners of a triangle; one that the planes are cut open at lies whole at their end.
  [[nodiscard]] Triangle triangle(std::size_t t) const;

 private:
  class Measure;

  const WasteSurface& surface_;
  std::vector<SweepSeam> seams_;
  std::vector<MovedVertex> vertices_;
  BehindSeams behind_;
  SweepData extents_;
};

}  // namespace hotblade::pipeline
