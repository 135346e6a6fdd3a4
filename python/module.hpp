// What the units of the Python module share: arrays in and out, errors, and work that can be interrupted.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <concepts>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "pipeline/program/program.hpp"
#include "pipeline/settings/error.hpp"
#include "pipeline/settings/settings.hpp"
#include "robot/arm/cell.hpp"
#include "surface/read/design_surface.hpp"

namespace hotblade::python {

namespace py = pybind11;

// A design with the settings that it was read by.
struct Design {
  surface::DesignSurface surface;
  pipeline::DesignSettings settings;
  std::string obj;             // the OBJ that it was made of; empty: it was read from a file
  std::filesystem::path file;  // from the root, where it was read from one
};

// A program that never changes.
struct Program {
  std::shared_ptr<const pipeline::Program> data;
};

using Numbers = py::array_t<double, py::array::c_style>;
inline constexpr py::ssize_t kAny = -1;  // of a shape

// Returns an argument as numbers in rows, without a copy where it is such already. Throws
// Error (kBadSettings) with the argument's name for another shape or for what are no numbers.
[[nodiscard]] Numbers numbers(const py::handle& value, const char* name,
                              std::initializer_list<py::ssize_t> shape);
// Returns the same of whole numbers.
[[nodiscard]] py::array_t<int, py::array::c_style> whole_numbers(const py::handle& value, const char* name,
                                                                 std::initializer_list<py::ssize_t> shape);
// Return an argument as what it has to be. Throw Error (kBadSettings) with the argument's name for another.
[[nodiscard]] double number(const py::handle& value, const char* name);
[[nodiscard]] std::int64_t whole_number(const py::handle& value, const char* name);
[[nodiscard]] bool truth(const py::handle& value, const char* name);
[[nodiscard]] std::string text(const py::handle& value, const char* name);  // its bytes as of path_of()
// Throws the same: "name: str (wanted needed: hint)".
[[noreturn]] void throw_not(const char* wanted, const py::handle& value, const std::string& name,
                            const char* hint = "");
[[noreturn]] void throw_made_otherwise(const char* hint);
template <typename T>
[[nodiscard]] const T& instance(const py::handle& value, const char* name, const char* wanted,
                                const char* hint) {
  if (!py::isinstance<T>(value)) throw_not(wanted, value, name, hint);
  return value.cast<const T&>();
}
// Returns the constructor of a class that is made by its functions, which the hint names.
template <typename T>
[[nodiscard]] auto made_otherwise(const char* hint) {
  return py::init(
      [hint](const py::args&, const py::kwargs&) -> std::shared_ptr<T> { throw_made_otherwise(hint); });
}
// Returns the text of a shape: (n, 4, 2).
[[nodiscard]] std::string shape_text(const std::vector<py::ssize_t>& shape);

// Returns a read-only view of what `owner` keeps alive.
template <typename T>
[[nodiscard]] py::array view(std::vector<py::ssize_t> shape, std::vector<py::ssize_t> strides, const T* data,
                             const py::handle& owner) {
  py::array array(py::dtype::of<T>(), std::move(shape), std::move(strides), data, owner);
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}
// Returns a view of rows of `columns` numbers that follow each other.
template <typename T>
[[nodiscard]] py::array rows(std::size_t count, py::ssize_t columns, const T* data, const py::handle& owner) {
  const auto size = static_cast<py::ssize_t>(sizeof(T));
  return view<T>({static_cast<py::ssize_t>(count), columns}, {columns * size, size}, data, owner);
}

// Returns the bytes of a path, as os.fsencode() has them. Throws Error (kBadSettings) with the argument's
// name for what is no path, `wanted` in words.
[[nodiscard]] std::string path_of(const py::handle& file, const std::string& name,
                                  const char* wanted = "a path");
// Returns a text of Python as ascii() has it, cut short for a message.
[[nodiscard]] std::string shown(const py::handle& text);
// Returns a text that names a path, bytes that are no UTF-8 in it as os.fsdecode() has them.
[[nodiscard]] py::object path_text(const std::string& path);
[[nodiscard]] py::tuple texts(const std::vector<std::string>& list);

// Gives the interpreter's lock up for as long as it lives. Where Python ends, it ends a thread that waits for
// the lock by unwinding it, through what may not be unwound: such a thread stands still here instead.
class Unlocked {
 public:
  Unlocked() : state_(PyEval_SaveThread()) {}
  ~Unlocked();
  Unlocked(const Unlocked&) = delete;
  Unlocked& operator=(const Unlocked&) = delete;

 private:
  PyThreadState* state_;
};

// Runs without the interpreter's lock what needs no Python and takes more than some microseconds.
template <typename Work>
auto unlocked(const Work& work) {
  const Unlocked release;
  return work();
}

// An error of the input whose place is known: hotblade.InputError has file and line of it.
struct PlacedError : std::runtime_error {
  PlacedError(const std::string& what, std::string in_file, int at_line)
      : std::runtime_error(what), file(std::move(in_file)), line(at_line) {}
  std::string file;  // empty: none
  int line;          // 0: none
};

// Throws an error of the input that `name` or `name:line` stands before as PlacedError, in `file` (empty:
// what is read is no file).
[[noreturn]] void throw_placed(const std::string& what, const std::string& name, const std::string& file);
// The same where one of the files of a directory stands before it.
[[noreturn]] void throw_placed_below(const std::string& what, const std::string& directory);

// Runs what reads an input; an error of it is told by `thrown`, that of its words.
template <typename Work>
auto placed(const Work& work, const std::invocable<const std::string&> auto& thrown) {
  try {
    return work();
  } catch (const pipeline::Error& error) {
    if (error.kind != pipeline::ErrorKind::kBadInput) throw;
    thrown(error.what());
    throw;
  } catch (const surface::MeshError& error) {
    thrown(error.what());
    throw;
  }
}
// The same of a file, without the interpreter's lock.
template <typename Work>
auto reading(const std::string& file, const Work& work) {
  const Unlocked release;
  return placed(work, [&](const std::string& what) { throw_placed(what, file, file); });
}

// Returns JSON as lists, dictionaries and plain values.
[[nodiscard]] py::object to_python(const nlohmann::ordered_json& json);
[[nodiscard]] py::object parsed(const std::string& json_text);

// Returns the settings of an argument: Settings, a mapping of their keys, or those that nothing is said of.
[[nodiscard]] pipeline::SaidSettings settings_of(const py::object& given);
// Returns settings of which every key was said.
[[nodiscard]] pipeline::SaidSettings all_said(const pipeline::Settings& settings);

// Returns the cell of an argument: a Cell, a file, a name of a cell that hotblade brings, or none.
[[nodiscard]] std::shared_ptr<robot::Cell> cell_of(const py::object& given);

// Tells a stage and the share that is done; throws where the work is to end.
using Tell = std::function<void(const std::string& stage, double share)>;

// Runs work on a thread of its own with so many threads (1 to 1024, 0: all cores), the interpreter's lock
// given up. Meanwhile this thread wakes every 50 ms, calls `progress` (or None) and looks for signals; an
// exception of either ends the work, and is thrown when it has ended. What the work throws is thrown here.
// Where Python ends meanwhile, as it does beside a daemon thread, the work ends first, and SystemExit is
// thrown.
void run_watched(const py::object& threads, const py::object& progress,
                 const std::function<void(const Tell&)>& work);

void add_batch(py::module_& module);
void add_cell(py::module_& module);
void add_curve(py::module_& module);
void add_errors(py::module_& module);
void add_settings(py::module_& module);
void add_design(py::module_& module);
void add_program(py::module_& module);
void add_watched(py::module_& module);
void add_plan(py::module_& module);

}  // namespace hotblade::python
