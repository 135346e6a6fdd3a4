// hotblade.read and hotblade.Design.
#include <fmt/format.h>

#include <cmath>

#include "pipeline/program/atomic_file.hpp"
#include "pipeline/program/read_design.hpp"
#include "pipeline/settings/assignments.hpp"
#include "pipeline/settings/error.hpp"
#include "pipeline/settings/settings_fields.hpp"
#include "python/module.hpp"
#include "python/setting_values.hpp"

namespace hotblade::python {
namespace {

using pipeline::DesignSettings;
using pipeline::Error;
using pipeline::ErrorKind;
using pipeline::Settings;

// The settings a design is read by: those given, and on top what the call says.
Settings read_settings(const py::object& given, const py::dict& arguments) {
  std::vector<pipeline::SettingsFlag> flags;
  for (const auto& [argument, value] : arguments) {
    const auto name = argument.cast<std::string>();
    const std::string key = "design." + name;
    if (!value.is_none()) flags.push_back({name, key, toml_value(value, key)});
  }
  Settings settings = pipeline::with_flags(settings_of(given).settings, flags);
  pipeline::expect_facing(settings.design);
  return settings;
}

void expect_units(const Settings& settings, const std::string& file) {
  if (!settings.design.units.empty()) return;
  throw Error(ErrorKind::kBadSettings,
              file +
                  ": no unit given: the file carries none: say units=\"mm\", \"cm\", \"m\", \"in\" or "
                  "\"ft\"");
}

Design read_file(const py::object& file, const py::object& units, const py::object& up,
                 const py::object& group, const py::object& facing, const py::object& stitch_mm,
                 const py::object& format, const py::object& given) {
  using namespace py::literals;
  const std::string path = path_of(file, "file");
  Settings settings =
      read_settings(given, py::dict("units"_a = units, "up"_a = up, "group"_a = group, "facing"_a = facing,
                                    "stitch_mm"_a = stitch_mm, "format"_a = format));
  const bool turned = !up.is_none();
  return reading(path, [&]() -> Design {
    pipeline::take_format(path, turned, settings.design);
    expect_units(settings, path);
    return {pipeline::read_design(path, settings.design), settings.design, "",
            std::filesystem::absolute(path)};
  });
}

// The OBJ of points and triangles: the one text that any two tools write of them.
std::string obj_text(const Numbers& vertices, const py::array_t<int, py::array::c_style>& triangles) {
  std::string text;
  const auto points = vertices.unchecked<2>();
  for (py::ssize_t i = 0; i < points.shape(0); ++i) {
    text += "v";
    for (py::ssize_t k = 0; k < 3; ++k) {
      if (!std::isfinite(points(i, k)))
        throw Error(ErrorKind::kBadSettings, fmt::format("vertices[{}]: not finite", i));
      text += " " + pipeline::number_text(points(i, k));
    }
    text += "\n";
  }
  const auto faces = triangles.unchecked<2>();
  for (py::ssize_t i = 0; i < faces.shape(0); ++i) {
    text += "f";
    for (py::ssize_t k = 0; k < 3; ++k) {
      if (faces(i, k) < 0 || faces(i, k) >= points.shape(0))
        throw Error(ErrorKind::kBadSettings,
                    fmt::format("triangles[{}]: no such vertex ({}, limits 0 and {})", i, faces(i, k),
                                points.shape(0) - 1));
      text += fmt::format(" {}", faces(i, k) + 1);
    }
    text += "\n";
  }
  return text;
}

Design from_arrays(const py::object& vertices, const py::object& triangles, const py::object& units,
                   const py::object& name, const py::object& up, const py::object& given) {
  using namespace py::literals;
  (void)text(name, "name");
  std::string file = path_of(name, "name");
  if (!file.ends_with(".obj")) file += ".obj";
  const Settings settings = read_settings(given, py::dict("units"_a = units, "up"_a = up));
  expect_units(settings, file);
  if (settings.design.format != DesignSettings().format &&
      settings.design.format != surface::name(surface::FileFormat::kObj))
    throw Error(
        ErrorKind::kBadSettings,
        fmt::format("settings: design.format ({}, must be obj): a design of arrays is known by its OBJ",
                    settings.design.format));
  const Numbers points = numbers(vertices, "vertices", {kAny, 3});
  const auto faces = whole_numbers(triangles, "triangles", {kAny, 3});
  const Unlocked release;
  std::string obj = obj_text(points, faces);
  surface::DesignSurface surface = surface::surface_of(obj, file, pipeline::read_options(settings.design));
  return {std::move(surface), settings.design, std::move(obj), {}};
}

void save_design(const Design& design, const py::object& file, const py::object& forced) {
  const std::string path = path_of(file, "file");
  const bool force = truth(forced, "force");
  if (design.obj.empty())
    throw Error(ErrorKind::kBadSettings,
                design.surface.file_name + ": was read from a file: only a design of arrays is saved");
  const Unlocked release;
  pipeline::write_file_atomically(path, design.obj, force);
}

py::dict health(const surface::Health& h) {
  using namespace py::literals;
  const auto corner = [](const Eigen::Vector3d& p) { return py::make_tuple(p.x(), p.y(), p.z()); };
  const auto lines = [](const std::vector<std::string>& list) {
    py::list all;
    for (const std::string& line : list) all.append(line);
    return all;
  };
  return py::dict("vertices"_a = h.vertices, "triangles"_a = h.triangles, "components"_a = h.components,
                  "border_loops"_a = h.border_loops, "non_manifold_edges"_a = h.non_manifold_edges,
                  "non_manifold_vertices"_a = h.non_manifold_vertices,
                  "degenerate_faces"_a = h.degenerate_faces, "duplicate_faces"_a = h.duplicate_faces,
                  "unused_vertices"_a = h.unused_vertices, "file_vertices"_a = h.file_vertices,
                  "file_faces"_a = h.file_faces,
                  "bbox_mm"_a = py::make_tuple(corner(h.bbox_mm[0]), corner(h.bbox_mm[1])),
                  "border_length_mm"_a = h.border_length_mm, "area_mm2"_a = h.area_mm2,
                  "orientable"_a = h.orientable, "closed"_a = h.closed, "repairs"_a = lines(h.repairs),
                  "warnings"_a = lines(h.warnings), "blockers"_a = lines(h.blockers));
}

}  // namespace

void add_design(py::module_& module) {
  static_assert(sizeof(Eigen::Vector3d) == 3 * sizeof(double) &&
                sizeof(std::array<int, 3>) == 3 * sizeof(int));
  py::class_<Design, std::shared_ptr<Design>>(module, "Design", "A design surface, in mm with z up.")
      .def(made_otherwise<Design>("hotblade.Design: hotblade.read() makes one of a file, "
                                  "Design.from_arrays() of points and triangles"))
      .def("save", &save_design, py::arg("file"), py::arg("force") = false,
           "Writes the OBJ of a design of arrays, whose sha256 it has.")
      .def_property_readonly("vertices",
                             [](const py::object& self) {
                               const auto points = self.cast<const Design&>().surface.mesh.vertices();
                               return rows(points.size(), 3, points.empty() ? nullptr : points[0].data(),
                                           self);
                             })
      .def_property_readonly("triangles",
                             [](const py::object& self) {
                               const auto faces = self.cast<const Design&>().surface.mesh.triangles();
                               return rows(faces.size(), 3, faces.empty() ? nullptr : faces[0].data(), self);
                             })
      .def_property_readonly("health", [](const Design& design) { return health(design.surface.health); })
      .def_property_readonly("sha256", [](const Design& design) { return design.surface.sha256; })
      .def_property_readonly("name", [](const Design& design) { return path_text(design.surface.file_name); })
      .def_property_readonly("units", [](const Design& design) { return design.surface.units; })
      .def("__repr__", [](const Design& design) {
        return path_text(fmt::format("<hotblade.Design {}: {} triangles>", design.surface.file_name,
                                     design.surface.health.triangles));
      });
  module.def("read", &read_file);
  module.def("from_arrays", &from_arrays);
}

}  // namespace hotblade::python
