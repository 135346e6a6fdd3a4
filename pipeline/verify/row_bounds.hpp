// How far off a cut may be, place by place of its grid, so that what the registers' micrometres do to the
// blade is added where they do it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pipeline/verify/swept_surface.hpp"

namespace hotblade::pipeline {

// The parts of a blade's length, all alike, that are told apart.
inline constexpr std::size_t kBladeParts = 8;

// How far a strip's blade is off in each of its parts, mm: of eight poses at once the most.
class PartsOff {
 public:
  // Takes that of the next pose.
  void add(const std::array<float, kBladeParts>& off_mm);
  // Returns the most of some poses, the last included; 0 beyond the end.
  [[nodiscard]] float most(std::size_t first_pose, std::size_t last_pose, std::size_t part) const;

 private:
  std::vector<std::array<float, kBladeParts>> groups_;
  std::size_t poses_ = 0;
};

// The bounds of a cut's rows, strip by strip, in each part of the blade.
class RowBounds {
 public:
  RowBounds() = default;
  RowBounds(const SweptSurface& cut, const Program& program);

  // Takes the bound of what is nearest to these vertices of one strip, or lies between.
  void add(std::span<const std::size_t> vertices, double bound_mm);

  // Returns the largest of a strip, each with the most that its part is off at any pose whose width passes
  // over the row or its neighbours.
  [[nodiscard]] double with(const PartsOff& off, const Strip& strip, std::size_t index,
                            double width_mm) const;

 private:
  struct Row {
    std::size_t pose = 0;
    std::array<double, kBladeParts> bound_mm{};  // 0: nothing is there
  };
  struct Place {
    std::uint32_t strip = 0, row = 0, part = 0;
  };

  std::vector<std::vector<Row>> strips_;
  std::vector<Place> places_;  // of the vertices
};

}  // namespace hotblade::pipeline
