// Exceptions of the library as those of hotblade.errors.
#include "pipeline/settings/error.hpp"
#include "python/module.hpp"
#include "surface/read/design_surface.hpp"
#include "surface/slice/plane_family.hpp"

namespace hotblade::python {
namespace {

using pipeline::ErrorKind;

const char* class_of(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::kBadSettings:
      return "UsageError";
    case ErrorKind::kBadInput:
      return "InputError";
    case ErrorKind::kNotCuttable:
      return "NotCuttable";
    case ErrorKind::kDeviation:
      return "OverTolerance";
    case ErrorKind::kController:
      return "ControllerError";
    case ErrorKind::kFile:
      return "FileError";
    case ErrorKind::kDrawing:
    case ErrorKind::kInterrupted:
      break;
  }
  return "Error";
}

void raise(const char* name, const std::string& what) {
  const py::object type = py::module_::import("hotblade.errors").attr(name);
  PyErr_SetObject(type.ptr(), type(path_text(what)).ptr());
}

}  // namespace

void add_errors(py::module_&) {
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const pipeline::Error& error) {
      raise(class_of(error.kind), error.what());
    } catch (const surface::MeshError& error) {
      raise("InputError", error.what());
    } catch (const surface::FileError& error) {
      raise("FileError", error.what());
    } catch (const surface::FanError& error) {
      raise("NotCuttable", error.what());
    } catch (const std::logic_error& error) {  // whatever was asked for: a mistake of the library
      raise("Error", std::string("internal error: ") + error.what());
    }
  });
}

}  // namespace hotblade::python
