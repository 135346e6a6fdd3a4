// A design as its strips are compared with it: a strip forms one of its smooth faces
// (surface/slice/creases.hpp), and ends at that face's creases as at the design's border. Past a crease it
// cuts foam of its own block, beside which the next face stands in another. So do pieces of a face that lie
// apart, where strips form them one by one.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "gpu/mesh/mesh_distance.hpp"
#include "pipeline/program/program.hpp"
#include "pipeline/verify/design_border.hpp"
#include "surface/slice/creases.hpp"

namespace hotblade::pipeline {

// What counts as a crease of a design that is cut with this blade; shallow folds where they are parted.
[[nodiscard]] surface::CreaseLimits crease_limits(const Settings& settings, const robot::Blade& blade);

class DesignFaces {
 public:
  // A strip forms the face that most of its ribs' points are nearest to; of a face in several pieces those
  // that have a place which no other strip is nearer to. The mesh must have triangles.
  DesignFaces(const surface::TriangleMesh& design, const Program& program, gpu::Backend backend);

  // The nearest point of a face of the design.
  struct Foot {
    double distance = 0;                              // mm
    Eigen::Vector3d point{0, 0, 0}, normal{0, 0, 1};  // mm; unit, of its facet
    bool on_border = false;                           // of the face: of the design, or a crease
    gpu::Side side = gpu::Side::kNeither;             // where the point lies of the face, if that was asked
  };

  // Returns for each point its foot on the face of its strip; `strip_of(i)` is the strip of points[i].
  [[nodiscard]] std::vector<Foot> feet(std::span<const Eigen::Vector3d> points,
                                       const std::function<int(std::size_t)>& strip_of) const;

  // Returns the same with the side of the face that each point lies on.
  [[nodiscard]] std::vector<Foot> feet_and_sides(std::span<const Eigen::Vector3d> points,
                                                 const std::function<int(std::size_t)>& strip_of) const;

  [[nodiscard]] std::size_t count() const { return smooth_; }
  [[nodiscard]] std::size_t face_of(int strip) const {
    return face_of_strip_[static_cast<std::size_t>(strip)];
  }

  // Returns what answered the last query, and why.
  [[nodiscard]] gpu::BackendUse used() const { return faces_.front().to_face.used(); }

 private:
  struct Face {
    Face(const surface::TriangleMesh& of, gpu::Backend backend);
    surface::TriangleMesh mesh;
    DesignBorder border;
    gpu::MeshDistance to_face;
  };

  [[nodiscard]] static Foot foot(const Face& face, const gpu::Nearest& nearest);
  [[nodiscard]] std::vector<Foot> find(std::span<const Eigen::Vector3d> points,
                                       const std::function<int(std::size_t)>& strip_of, bool sides) const;
  void assign(const surface::TriangleMesh& design, const std::vector<int>& face_of_triangle,
              const Program& program);
  void part(std::size_t face, const Program& program, gpu::Backend backend);

  std::vector<Face> faces_;  // smooth ones, then pieces of these
  std::size_t smooth_ = 0;
  std::vector<std::size_t> face_of_strip_;
};

}  // namespace hotblade::pipeline
