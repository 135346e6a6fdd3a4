// The Python module: what `import hotblade` loads (docs/python.md).
#include "python/module.hpp"

#include "pipeline/program/version.hpp"

PYBIND11_MODULE(_hotblade, module) {
  using namespace hotblade;
  module.doc() = "Planning of hot-blade cuts; use it through `hotblade`";
  module.attr("__version__") = pipeline::version();
  python::add_errors(module);
  python::add_settings(module);
  python::add_design(module);
  python::add_program(module);
  python::add_cell(module);
  python::add_plan(module);
  python::add_curve(module);
  python::add_batch(module);
  python::add_watched(module);
}
