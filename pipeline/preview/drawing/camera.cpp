#include <vtkCamera.h>
#include <vtkRenderer.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "pipeline/preview/drawing/overlay.hpp"

namespace hotblade::pipeline::preview {
namespace {

// Direction to the eye; azimuth 0 is the front (-y).
Eigen::Vector3d eye_direction(double azimuth_deg, double elevation_deg) {
  const double az = azimuth_deg * std::numbers::pi / 180, el = elevation_deg * std::numbers::pi / 180;
  return {std::sin(az) * std::cos(el), -std::cos(az) * std::cos(el), std::sin(el)};
}

// From above and the front, unless the cut side looks elsewhere: an oblique view of it (about 45 degrees)
// shows both its colours and its shape.
Eigen::Vector3d best_eye(const Eigen::Vector3d& waste) {
  const Eigen::Vector3d usual = eye_direction(-32, 36);
  if (waste.norm() == 0) return usual;
  Eigen::Vector3d best = usual;
  double best_score = -10;
  for (int azimuth = -152; azimuth <= 148; azimuth += 60) {
    for (const double elevation : {36.0, 20.0, -20.0, -36.0}) {
      const Eigen::Vector3d eye = eye_direction(azimuth, elevation);
      const double score = -std::abs(eye.dot(waste) - 0.65) + 0.25 * eye.dot(usual);
      if (score > best_score) {
        best_score = score;
        best = eye;
      }
    }
  }
  return best;
}

// Where to look from, and what is up in the picture.
struct Stance {
  Eigen::Vector3d eye, up;
};

Stance stance_of(View view, const Eigen::Vector3d& waste) {
  if (view == View::kTop) return {Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitY()};
  if (view == View::kFront) return {-Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ()};
  if (view == View::kRight) return {Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitZ()};
  return {best_eye(waste), Eigen::Vector3d::UnitZ()};
}

// What the picture has to hold, seen along two axes of the picture.
class Extent {
 public:
  Extent(Eigen::Vector3d right, Eigen::Vector3d up) : right_(std::move(right)), up_(std::move(up)) {}
  void add(const Eigen::Vector3d& point) { box_.extend(Eigen::Vector2d(point.dot(right_), point.dot(up_))); }
  void add_all(std::span<const Eigen::Vector3d> points) {
    for (const Eigen::Vector3d& point : points) add(point);
  }
  void add_scene(const Scene& scene) {
    add_all(scene.design.vertices());
    add_all(scene.cut.vertices);
    for (const Polyline& blade : scene.blades) add_all(blade.points);
    if (scene.blade_now) add_all(scene.blade_now->points);
    for (const std::vector<Pose>* clamps : {&scene.clamps_a, &scene.clamps_b}) {
      for (const Pose& clamp : *clamps) {
        add(clamp.p + Eigen::Vector3d::Constant(scene.clamp_size_mm));
        add(clamp.p - Eigen::Vector3d::Constant(scene.clamp_size_mm));
      }
    }
    for (const CellPart& part : scene.cell) {
      for (const Eigen::Vector3d& vertex : part.vertices) add(part.place * vertex);
    }
    for (const Block& block : scene.blocks) {
      for (const Eigen::Vector3d& corner : block.corners()) add(corner);
    }
  }
  [[nodiscard]] const Eigen::AlignedBox2d& box() const { return box_; }

 private:
  Eigen::Vector3d right_, up_;
  Eigen::AlignedBox2d box_;
};

}  // namespace

void aim_camera(const Scene& scene, vtkRenderer& renderer, PictureSize size, View view, bool with_time_bar) {
  const Stance stance = stance_of(view, scene.view_axes.transpose() * scene.waste_direction);
  const Eigen::Vector3d eye = scene.view_axes * stance.eye;
  const Eigen::Vector3d right = (scene.view_axes * stance.up).cross(eye).normalized();
  const Eigen::Vector3d up = eye.cross(right);
  Extent extent(right, up);
  extent.add_scene(scene);
  const Margins margins = overlay_margins(size, with_time_bar);
  const double width = size.width - margins.left - margins.right;
  const double height = size.height - margins.top - margins.bottom;
  const Eigen::Vector2d span = extent.box().sizes().cwiseMax(1e-3);
  const double pixels_per_mm = std::min(width / span.x(), height / span.y());
  // The middle of the free part of the picture, seen from the middle of the whole.
  const Eigen::Vector2d shift((margins.left - margins.right) / 2, (margins.bottom - margins.top) / 2);
  const Eigen::Vector2d middle = extent.box().center() - shift / pixels_per_mm;
  double bounds[6];
  renderer.ComputeVisiblePropBounds(bounds);
  const Eigen::Vector3d centre((bounds[0] + bounds[1]) / 2, (bounds[2] + bounds[3]) / 2,
                               (bounds[4] + bounds[5]) / 2);
  const Eigen::Vector3d focus = middle.x() * right + middle.y() * up + centre.dot(eye) * eye;
  const double far =
      Eigen::Vector3d(bounds[1] - bounds[0], bounds[3] - bounds[2], bounds[5] - bounds[4]).norm() + 1;
  const Eigen::Vector3d position = focus + 2 * far * eye;
  vtkCamera& camera = *renderer.GetActiveCamera();
  camera.ParallelProjectionOn();
  camera.SetParallelScale(size.height / (2 * pixels_per_mm));
  camera.SetFocalPoint(focus.data());
  camera.SetPosition(position.data());
  camera.SetViewUp(up.data());
  renderer.ResetCameraClippingRange();
}

}  // namespace hotblade::pipeline::preview
