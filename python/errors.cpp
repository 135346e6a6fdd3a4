// Exceptions of the library as those of hotblade.errors.
#include <charconv>
#include <optional>
#include <string_view>

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

void raise(const char* name, const std::string& what, const std::string& file = "", int line = 0) {
  const py::object error =
      py::module_::import("hotblade.errors")
          .attr("raised")(name, path_text(what), file.empty() ? py::none() : path_text(file),
                          line == 0 ? py::object(py::none()) : py::int_(line));
  PyErr_SetObject(py::type::of(error).ptr(), error.ptr());
}

// The line that stands between a name and the words: ":12: ", or none: ": ". Nothing of what is neither.
std::optional<int> line_of(std::string_view behind) {
  if (behind.starts_with(": ")) return 0;
  int line = 0;
  if (!behind.starts_with(':')) return std::nullopt;
  const auto [end, error] = std::from_chars(behind.data() + 1, behind.data() + behind.size(), line);
  behind.remove_prefix(static_cast<std::size_t>(end - behind.data()));
  return error == std::errc() && behind.starts_with(": ") ? std::optional(line) : std::nullopt;
}

}  // namespace

void throw_placed(const std::string& what, const std::string& name, const std::string& file) {
  if (what.starts_with(name)) {
    if (const auto line = line_of(std::string_view(what).substr(name.size())))
      throw PlacedError(what, file, *line);
  }
  throw PlacedError(what, "", 0);
}

void throw_placed_below(const std::string& what, const std::string& directory) {
  std::error_code ignored;
  for (std::size_t end = directory.size(); what.starts_with(directory) && end != std::string::npos;
       end = what.find(':', end + 1)) {
    const auto line = line_of(std::string_view(what).substr(end));
    const std::string name = what.substr(0, end);
    if (line && std::filesystem::is_regular_file(name, ignored)) throw PlacedError(what, name, *line);
  }
  throw PlacedError(what, "", 0);
}

void add_errors(py::module_&) {
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const PlacedError& error) {
      raise("InputError", error.what(), error.file, error.line);
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
