// A plane whose axes are kept once for all that have the same: of a program's million poses nearly all have
// those of the pose before.
#pragma once

#include <Eigen/Core>
#include <boost/smart_ptr/intrusive_ptr.hpp>
#include <boost/smart_ptr/intrusive_ref_counter.hpp>

#include "pipeline/program/frame.hpp"

namespace hotblade::pipeline {

// A Frame, which it turns into; its origin may be moved.
class SharedFrame {
 public:
  SharedFrame() = default;
  // With axes of its own.
  SharedFrame(const Eigen::Vector3d& at, const Eigen::Vector3d& x, const Eigen::Vector3d& y)
      : origin(at), axes_(new Axes(x, y)) {}
  SharedFrame(const Frame& frame) : SharedFrame(frame.origin, frame.x, frame.y) {}
  // With the axes of `like` where these are the same.
  SharedFrame(const Frame& frame, const SharedFrame& like) : SharedFrame(like) {
    if (frame.x == x() && frame.y == y()) {
      origin = frame.origin;
    } else {
      *this = frame;
    }
  }
  operator Frame() const { return {origin, x(), y()}; }

  [[nodiscard]] Eigen::Vector3d x() const { return axes_ ? axes_->x : Frame{}.x; }
  [[nodiscard]] Eigen::Vector3d y() const { return axes_ ? axes_->y : Frame{}.y; }
  [[nodiscard]] Eigen::Vector3d normal() const { return Frame(*this).normal(); }
  [[nodiscard]] Eigen::Vector3d point(double u, double v, double w = 0) const {
    return Frame(*this).point(u, v, w);
  }

  // Are its axes kept in the same place?
  [[nodiscard]] bool shares_axes(const SharedFrame& other) const { return axes_ == other.axes_; }

  Eigen::Vector3d origin{0, 0, 0};

 private:
  // Counted by all threads.
  struct Axes : boost::intrusive_ref_counter<Axes> {
    Axes(const Eigen::Vector3d& along_x, const Eigen::Vector3d& along_y) : x(along_x), y(along_y) {}
    Eigen::Vector3d x, y;
  };
  boost::intrusive_ptr<const Axes> axes_;  // none: those of a Frame
};

}  // namespace hotblade::pipeline
