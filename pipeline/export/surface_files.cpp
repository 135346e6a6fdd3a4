#include "pipeline/export/surface_files.hpp"

#include <fmt/format.h>

#include <iterator>

#include "pipeline/verify/swept_surface.hpp"

namespace hotblade::pipeline {

namespace {

int strip_of(const SweptSurface& surface, const std::array<int, 3>& triangle) {
  return surface.strip_of_vertex[static_cast<std::size_t>(triangle[0])];
}

}  // namespace

ExportedFile as_cut_obj(const Program& program, double sample_mm) {
  const SweptSurface surface = swept_surface(program, sample_mm);
  std::string text = fmt::format("# {}: {} as cut, mm, +z up\n", program.created_by, program.design.file);
  const auto out = std::back_inserter(text);
  for (const Eigen::Vector3d& p : surface.vertices)
    fmt::format_to(out, "v {:.6f} {:.6f} {:.6f}\n", p.x(), p.y(), p.z());
  for (const Eigen::Vector3d& n : surface.normals)
    fmt::format_to(out, "vn {:.6f} {:.6f} {:.6f}\n", n.x(), n.y(), n.z());
  int strip = -1;
  for (const auto& t : surface.triangles) {
    if (strip_of(surface, t) != strip) {
      strip = strip_of(surface, t);
      fmt::format_to(out, "g {}\n", program.strips[static_cast<std::size_t>(strip)].id);
    }
    fmt::format_to(out, "f {0}//{0} {1}//{1} {2}//{2}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  }
  return {"as_cut.obj", text};
}

ExportedFile as_cut_ply(const Program& program, double sample_mm) {
  const SweptSurface surface = swept_surface(program, sample_mm);
  std::string text = fmt::format(
      "ply\nformat ascii 1.0\ncomment {}: {} as cut, mm, +z up\nelement vertex {}\nproperty double x\n"
      "property double y\nproperty double z\nproperty float nx\nproperty float ny\nproperty float nz\n"
      "property int strip\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
      program.created_by, program.design.file, surface.vertices.size(), surface.triangles.size());
  const auto out = std::back_inserter(text);
  for (std::size_t i = 0; i < surface.vertices.size(); ++i) {
    const Eigen::Vector3d &p = surface.vertices[i], &n = surface.normals[i];
    fmt::format_to(out, "{:.6f} {:.6f} {:.6f} {:.6f} {:.6f} {:.6f} {}\n", p.x(), p.y(), p.z(), n.x(), n.y(),
                   n.z(), surface.strip_of_vertex[i]);
  }
  for (const auto& t : surface.triangles) fmt::format_to(out, "3 {} {} {}\n", t[0], t[1], t[2]);
  return {"as_cut.ply", text};
}

}  // namespace hotblade::pipeline
