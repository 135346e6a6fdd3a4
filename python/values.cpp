#include <fmt/format.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <span>

#include "pipeline/settings/error.hpp"
#include "python/module.hpp"

namespace hotblade::python {

using pipeline::Error;
using pipeline::ErrorKind;

std::string shape_text(const std::vector<py::ssize_t>& shape) {
  std::string text;
  char letter = 'n';
  for (const py::ssize_t size : shape)
    text += (text.empty() ? "" : ", ") + (size == kAny ? std::string(1, letter++) : std::to_string(size));
  return "(" + text + (shape.size() == 1 ? ",)" : ")");
}

namespace {

py::array checked(const py::handle& value, const char* name, const char* kinds, const char* wanted,
                  const std::vector<py::ssize_t>& shape) {
  const py::array array = py::array::ensure(value);
  const auto fail = [&](const std::string& what) {
    throw Error(ErrorKind::kBadSettings, fmt::format("{}: {} ({} needed)", name, what, shape_text(shape)));
  };
  if (!array || value.is_none()) throw_not(("an array " + shape_text(shape)).c_str(), value, name);
  if (std::string_view(kinds).find(array.dtype().kind()) == std::string_view::npos && array.size() > 0)
    throw Error(ErrorKind::kBadSettings, fmt::format("{}: dtype {} ({} needed)", name,
                                                     py::str(array.dtype()).cast<std::string>(), wanted));
  const std::vector<py::ssize_t> given(array.shape(), array.shape() + array.ndim());
  bool same = given.size() == shape.size();
  for (std::size_t i = 0; same && i < shape.size(); ++i) same = shape[i] == kAny || shape[i] == given[i];
  if (!same) fail("shape " + shape_text(given));
  return array;
}

}  // namespace

Numbers numbers(const py::handle& value, const char* name, std::initializer_list<py::ssize_t> shape) {
  const Numbers rows = Numbers::ensure(checked(value, name, "fiu", "float64", shape));
  if (!rows) throw py::error_already_set();
  return rows;
}

py::array_t<int, py::array::c_style> whole_numbers(const py::handle& value, const char* name,
                                                   std::initializer_list<py::ssize_t> shape) {
  using Whole = py::array_t<int, py::array::c_style>;
  // Through int64: a number that is too large is told of instead of wrapped round.
  using Wide = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>;
  const py::array given = checked(value, name, "iu", "int32", shape);
  if (given.dtype().is(py::dtype::of<int>())) return Whole::ensure(given);
  const Wide wide = Wide::ensure(given);
  if (!wide) throw py::error_already_set();
  Whole rows(std::vector<py::ssize_t>(wide.shape(), wide.shape() + wide.ndim()));
  const std::span<const std::int64_t> from(wide.data(), static_cast<std::size_t>(wide.size()));
  int* const to = rows.mutable_data();
  unlocked([&] {
    for (std::size_t i = 0; i < from.size(); ++i) {
      to[i] = static_cast<int>(from[i]);
      if (to[i] != from[i])
        throw Error(ErrorKind::kBadSettings, fmt::format("{}: {} is no int32", name, from[i]));
    }
  });
  return rows;
}

void throw_not(const char* wanted, const py::handle& value, const std::string& name, const char* hint) {
  const std::string_view told = hint;
  throw Error(ErrorKind::kBadSettings,
              fmt::format("{}: {} ({} needed{}{})", name,
                          py::type::of(value).attr("__qualname__").cast<std::string>(), wanted,
                          told.empty() ? "" : ": ", told));
}

void throw_made_otherwise(const char* hint) {
  throw Error(ErrorKind::kBadSettings, hint);
}

double number(const py::handle& value, const char* name) {
  const double number = PyFloat_AsDouble(value.ptr());
  if (PyErr_Occurred() == nullptr) return number;
  PyErr_Clear();
  throw_not("a number", value, name);
}

std::int64_t whole_number(const py::handle& value, const char* name) {
  int overflow = 0;
  const long long number =
      PyIndex_Check(value.ptr()) != 0 ? PyLong_AsLongLongAndOverflow(value.ptr(), &overflow) : 0;
  if (PyIndex_Check(value.ptr()) == 0 || PyErr_Occurred() != nullptr) {
    PyErr_Clear();
    throw_not("a whole number", value, name);
  }
  // What is beyond 64 bits is beyond every limit too.
  if (overflow != 0)
    return overflow > 0 ? std::numeric_limits<std::int64_t>::max() : std::numeric_limits<std::int64_t>::min();
  return number;
}

std::string text(const py::handle& value, const char* name) {
  if (!py::isinstance<py::str>(value)) throw_not("a text", value, name);
  return path_of(py::reinterpret_borrow<py::object>(value));
}

std::string path_of(const py::object& file) {
  return py::module_::import("os").attr("fsencode")(file).cast<std::string>();
}

py::object path_text(const std::string& path) {
  return py::module_::import("os").attr("fsdecode")(py::bytes(path));
}

py::tuple texts(const std::vector<std::string>& list) {
  py::tuple all(list.size());
  for (std::size_t i = 0; i < list.size(); ++i) all[i] = path_text(list[i]);
  return all;
}

py::object to_python(const nlohmann::ordered_json& json) {
  switch (json.type()) {
    case nlohmann::ordered_json::value_t::object: {
      py::dict dict;
      for (const auto& [key, value] : json.items()) dict[py::str(key)] = to_python(value);
      return dict;
    }
    case nlohmann::ordered_json::value_t::array: {
      py::list list;
      for (const auto& value : json) list.append(to_python(value));
      return list;
    }
    case nlohmann::ordered_json::value_t::string:
      return py::str(json.get_ref<const std::string&>());
    case nlohmann::ordered_json::value_t::boolean:
      return py::bool_(json.get<bool>());
    case nlohmann::ordered_json::value_t::number_integer:
      return py::int_(json.get<std::int64_t>());
    case nlohmann::ordered_json::value_t::number_unsigned:
      return py::int_(json.get<std::uint64_t>());
    case nlohmann::ordered_json::value_t::number_float:
      return py::float_(json.get<double>());
    default:
      return py::none();
  }
}

py::object parsed(const std::string& json_text) {
  return to_python(nlohmann::ordered_json::parse(json_text));
}

}  // namespace hotblade::python
