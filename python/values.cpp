#include <fmt/format.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <span>
#include <utility>

#include "pipeline/settings/error.hpp"
#include "pipeline/settings/json_bytes.hpp"
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
  // Numbers of more bits than a double are rounded to it.
  using Rounded = py::array_t<double, py::array::c_style | py::array::forcecast>;
  const py::array given = checked(value, name, "fiu", "float64", shape);
  Numbers rows = Rounded::ensure(given);
  if (!rows) throw_not("an array of numbers", value, name);
  return rows;
}

namespace {

using Whole = py::array_t<int, py::array::c_style>;

// Through the widest of its sign: a number that is too large is told of instead of wrapped round.
template <typename Widest>
Whole narrowed(const py::array& given, const char* name) {
  using Wide = py::array_t<Widest, py::array::c_style | py::array::forcecast>;
  const Wide wide = Wide::ensure(given);
  if (!wide) throw_not("an array of whole numbers", given, name);
  Whole rows(std::vector<py::ssize_t>(wide.shape(), wide.shape() + wide.ndim()));
  const std::span<const Widest> from(wide.data(), static_cast<std::size_t>(wide.size()));
  int* const to = rows.mutable_data();
  unlocked([&] {
    for (std::size_t i = 0; i < from.size(); ++i) {
      if (!std::in_range<int>(from[i]))
        throw Error(ErrorKind::kBadSettings, fmt::format("{}: {} is no int32", name, from[i]));
      to[i] = static_cast<int>(from[i]);
    }
  });
  return rows;
}

}  // namespace

Whole whole_numbers(const py::handle& value, const char* name, std::initializer_list<py::ssize_t> shape) {
  const py::array given = checked(value, name, "iu", "int32", shape);
  if (given.dtype().is(py::dtype::of<int>())) return Whole::ensure(given);
  return given.dtype().kind() == 'u' ? narrowed<std::uint64_t>(given, name)
                                     : narrowed<std::int64_t>(given, name);
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

namespace {

constexpr double kBeyond = std::numeric_limits<double>::infinity();

}  // namespace

double number(const py::handle& value, const char* name) {
  const double number = PyFloat_AsDouble(value.ptr());
  if (PyErr_Occurred() == nullptr) return number;
  const bool too_large = PyErr_ExceptionMatches(PyExc_OverflowError) != 0;
  PyErr_Clear();
  if (!too_large) throw_not("a number", value, name);
  // What is beyond every double is beyond every limit too.
  return value < py::int_(0) ? -kBeyond : kBeyond;
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

bool truth(const py::handle& value, const char* name) {
  const std::string_view type = Py_TYPE(value.ptr())->tp_name;
  if (PyBool_Check(value.ptr()) == 0 && type != "numpy.bool_" && type != "numpy.bool")
    throw_not("True or False", value, name);
  return PyObject_IsTrue(value.ptr()) == 1;
}

std::string shown(const py::handle& text) {
  const auto ascii = py::reinterpret_steal<py::str>(PyObject_ASCII(text.ptr()));
  if (!ascii) throw py::error_already_set();
  constexpr std::size_t kLongest = 40;
  const auto whole = ascii.cast<std::string>();
  return whole.size() <= kLongest ? whole : whole.substr(0, kLongest) + "...";
}

namespace {

// The bytes of a text, as os.fsencode() has them: halves of characters that stand for bytes are these.
std::string bytes_of(const py::handle& text, const std::string& name) {
  const auto bytes = py::reinterpret_steal<py::object>(PyUnicode_EncodeFSDefault(text.ptr()));
  if (bytes) return bytes.cast<std::string>();
  PyErr_Clear();
  throw Error(ErrorKind::kBadSettings, fmt::format("{} ({}): no UTF-8", name, shown(text)));
}

}  // namespace

std::string text(const py::handle& value, const char* name) {
  if (!py::isinstance<py::str>(value)) throw_not("a text", value, name);
  return bytes_of(value, name);
}

std::string path_of(const py::handle& file, const std::string& name, const char* wanted) {
  const auto path = py::reinterpret_steal<py::object>(PyOS_FSPath(file.ptr()));
  if (!path) {
    if (PyErr_ExceptionMatches(PyExc_TypeError) == 0) throw py::error_already_set();
    PyErr_Clear();
    throw_not(wanted, file, name);
  }
  std::string bytes = py::isinstance<py::bytes>(path) ? path.cast<std::string>() : bytes_of(path, name);
  if (bytes.find('\0') != std::string::npos)
    throw Error(ErrorKind::kBadSettings, fmt::format("{} ({}): a NUL, which no path has", name, shown(path)));
  return bytes;
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
  return to_python(pipeline::whole_json<nlohmann::ordered_json>(json_text));
}

}  // namespace hotblade::python
