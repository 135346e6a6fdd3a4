// hotblade.Cell: two arms that a plan is held against.
#include "pipeline/cell/cell_file.hpp"

#include <fmt/format.h>

#include "pipeline/plan/arms/arms.hpp"
#include "python/module.hpp"

namespace hotblade::python {
namespace {

py::tuple arm_ids(const robot::Cell& cell) {
  std::vector<std::string> ids;
  for (const robot::CellArm& arm : cell.arms) ids.push_back(arm.id);
  return texts(ids);
}

std::shared_ptr<robot::Cell> load_cell(const py::object& file, const char* name, const char* wanted) {
  const std::string path = path_of(file, name, wanted);
  return reading(path, [&] { return std::make_shared<robot::Cell>(pipeline::read_cell(path)); });
}

}  // namespace

std::shared_ptr<robot::Cell> cell_of(const py::object& given) {
  if (given.is_none()) return nullptr;
  if (py::isinstance<robot::Cell>(given)) return given.cast<std::shared_ptr<robot::Cell>>();
  return load_cell(given, "cell", "hotblade.Cell, a path or a name of Cell.names()");
}

void add_cell(py::module_& module) {
  py::class_<robot::Cell, std::shared_ptr<robot::Cell>>(module, "Cell",
                                                        "Two arms and what stands around them.")
      .def(made_otherwise<robot::Cell>(
          "hotblade.Cell: Cell.load() reads a file or takes a name of Cell.names()"))
      .def_static(
          "load",
          [](const py::object& file) { return load_cell(file, "file", "a path or a name of Cell.names()"); },
          py::arg("file"), "Reads cell.toml, or a cell of names() by its name.")
      .def_static(
          "names", [] { return texts(pipeline::embedded_cells()); },
          "The cells that hotblade brings, the default first.")
      .def_property_readonly("name", [](const robot::Cell& cell) { return cell.name; })
      .def_property_readonly(
          "sha256",
          [](const robot::Cell& cell) { return unlocked([&] { return pipeline::cell_sha256(cell); }); })
      .def_property_readonly("arms", &arm_ids)
      .def_property_readonly("warnings",
                             [](const robot::Cell& cell) { return texts(pipeline::warnings(cell)); })
      .def(
          "to_toml",
          [](const robot::Cell& cell) { return unlocked([&] { return pipeline::to_toml(cell); }); },
          "A file that reads back as this cell, every value written out.")
      .def("__repr__", [](const robot::Cell& cell) {
        return fmt::format("<hotblade.Cell {}: {}>", cell.name,
                           py::str(", ").attr("join")(arm_ids(cell)).cast<std::string>());
      });
}

}  // namespace hotblade::python
