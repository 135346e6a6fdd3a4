// What lies under a pixel of the window.
#pragma once

#include <Eigen/Core>

#include "pipeline/preview/view_model.hpp"

namespace hotblade::pipeline::preview {

// The way the design frame is seen: `to_view` takes points to x, y from -1 to 1 over the picture and z that
// grows away from the eye.
struct Sight {
  Eigen::Matrix4d to_view = Eigen::Matrix4d::Identity();
  PictureSize size;

  // A place as x and y in pixels from the lower left, with z as above.
  [[nodiscard]] Eigen::Vector3d pixel(const Eigen::Vector3d& place) const;
};

// The part under the pixel that is shown and not hidden behind the surface, the first of these: the blade or
// a ghost (a pose), a rib, the cut (its strip, and the pose that cut there).
[[nodiscard]] Picked pick(const ViewModel& model, const ViewState& state, const std::vector<Polyline>& ghosts,
                          const std::vector<std::array<int, 2>>& pose_of_ghost, const Sight& sight,
                          const Eigen::Vector2d& pixel);

// The plane's offset along its axis in mm, within the design or the cut.
[[nodiscard]] double clip_offset_mm(const ViewModel& model, const ClipPlane& clip);

// The number of the cut's triangles that the state shows, from the first on.
[[nodiscard]] std::size_t shown_triangles(const ViewModel& model, const ViewState& state);

}  // namespace hotblade::pipeline::preview
