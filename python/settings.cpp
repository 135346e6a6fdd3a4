// hotblade.Settings.
#include "pipeline/settings/settings.hpp"

#include <nlohmann/json.hpp>
#include <sstream>

#include "pipeline/settings/assignments.hpp"
#include "pipeline/settings/error.hpp"
#include "pipeline/settings/settings_fields.hpp"
#include "python/module.hpp"
#include "python/setting_values.hpp"

namespace hotblade::python {
namespace {

using pipeline::SaidSettings;
using pipeline::Settings;

struct ToPython {
  template <std::size_t N>
  py::object operator()(const std::optional<std::array<double, N>>* value) const {
    return *value ? numbers_of(**value) : py::none();
  }
  template <std::size_t N>
  py::object operator()(const std::array<double, N>* value) const {
    return numbers_of(*value);
  }
  py::object operator()(const std::vector<double>* value) const { return numbers_of(*value); }
  template <std::size_t N>
  py::object operator()(const std::vector<std::array<double, N>>* value) const {
    py::tuple all(value->size());
    for (std::size_t i = 0; i < value->size(); ++i) all[i] = numbers_of((*value)[i]);
    return all;
  }
  py::object operator()(const double* value) const { return py::float_(*value); }
  py::object operator()(const int* value) const { return py::int_(*value); }
  py::object operator()(const std::string* value) const { return py::str(*value); }
  template <typename Enum>
  requires std::is_enum_v<Enum> py::object operator()(const Enum* value) const {
    return py::str(std::string(name(*value)));
  }

 private:
  template <typename List>
  static py::object numbers_of(const List& list) {
    py::tuple tuple(list.size());
    for (std::size_t i = 0; i < list.size(); ++i) tuple[i] = list[i];
    return tuple;
  }
};

py::object value_of(const SaidSettings& of, const py::object& key) {
  Settings settings = of.settings;
  for (const pipeline::SettingField& field : pipeline::setting_fields())
    if (key.equal(py::str(full_key(field)))) return std::visit(ToPython{}, field.place(settings));
  PyErr_SetObject(PyExc_KeyError, key.ptr());
  throw py::error_already_set();
}

py::list keys() {
  py::list list;
  for (const pipeline::SettingField& field : pipeline::setting_fields()) list.append(full_key(field));
  return list;
}

std::vector<std::filesystem::path> files_of(const py::object& files) {
  if (files.is_none()) return {};
  const auto is_one = py::isinstance<py::str>(files) || py::hasattr(files, "__fspath__");
  std::vector<std::filesystem::path> list;
  constexpr const char* kWanted = "a path or a list of paths";
  if (is_one || !py::hasattr(files, "__iter__")) {
    list.emplace_back(path_of(files, "files", kWanted));
  } else {
    for (const py::handle& file : files) list.emplace_back(path_of(file, "files", kWanted));
  }
  return list;
}

SaidSettings resolved(const pipeline::SettingsSources& sources) {
  const Unlocked release;
  return pipeline::resolve_said(sources);
}

// A text of Python may hold halves of characters, which no UTF-8 has.
std::string utf8_of(const py::handle& value, const std::string& where) {
  Py_ssize_t size = 0;
  if (const char* text = PyUnicode_AsUTF8AndSize(value.ptr(), &size))
    return {text, static_cast<std::size_t>(size)};
  PyErr_Clear();
  throw pipeline::Error(pipeline::ErrorKind::kBadSettings, where + " (" + shown(value) + "): no UTF-8");
}

std::string float_text(double number) {
  return py::repr(py::float_(number)).cast<std::string>();
}

constexpr int kMostDepth = 2;  // of the lists of a setting: a list of pairs

std::string text_of(const py::handle& value, const std::string& key, int depth) {
  if (py::isinstance<py::bool_>(value)) return value.cast<bool>() ? "true" : "false";
  if (py::isinstance<py::str>(value)) return pipeline::toml_string(utf8_of(value, key));
  const bool sequence = PySequence_Check(value.ptr()) != 0 && PySequence_Size(value.ptr()) >= 0;
  PyErr_Clear();  // an array of no dimension has no length, and is a number
  if (sequence) {
    // A list within itself has no end.
    if (depth == kMostDepth)
      throw pipeline::Error(pipeline::ErrorKind::kBadSettings,
                            key +
                                ": lists within lists within lists: give a number, a text, a list of numbers "
                                "or a list of such lists");
    std::string text;
    for (const py::handle& part : value) text += (text.empty() ? "" : ", ") + text_of(part, key, depth + 1);
    return "[" + text + "]";
  }
  if (PyIndex_Check(value.ptr()) != 0) {
    if (const auto whole = py::reinterpret_steal<py::object>(PyNumber_Index(value.ptr()))) {
      int beyond = 0;
      (void)PyLong_AsLongLongAndOverflow(whole.ptr(), &beyond);
      // Digits may be a text as well. Within a list they are a number, and TOML's are of 64 bits: a larger
      // one is beyond every limit by its size.
      if (beyond == 0 || depth == 0) {
        const auto digits = py::reinterpret_steal<py::object>(PyObject_Str(whole.ptr()));
        if (digits) return digits.cast<std::string>();
        PyErr_Clear();  // so many digits are no text to Python
      }
      return float_text(number(whole, key.c_str()));
    }
    PyErr_Clear();
  }
  if (py::hasattr(value, "__float__")) {
    const double number = PyFloat_AsDouble(value.ptr());
    if (PyErr_Occurred() != nullptr) throw py::error_already_set();
    return float_text(number);
  }
  if (py::isinstance<py::dict>(value)) {
    const std::string first =
        value.begin() == value.end() ? "..." : py::str(*value.begin()).cast<std::string>();
    throw pipeline::Error(
        pipeline::ErrorKind::kBadSettings,
        key + ": a mapping within the mapping: keys are whole here: \"" + key + "." + first + "\"");
  }
  throw pipeline::Error(pipeline::ErrorKind::kBadSettings,
                        key + " (" + py::repr(value).cast<std::string>() +
                            "): give a number, a text or a list of numbers, or leave it out");
}

// None, or the () that an absent list of pairs is read as.
bool says_absent(const py::handle& value) {
  return value.is_none() ||
         ((py::isinstance<py::tuple>(value) || py::isinstance<py::list>(value)) && py::len(value) == 0);
}

bool may_be_absent(const std::string& key) {
  Settings defaults;
  for (const pipeline::SettingField& field : pipeline::setting_fields())
    if (full_key(field) == key) return !toml_text(field.place(defaults));
  return false;
}

}  // namespace

std::string toml_value(const py::handle& value, const std::string& key) {
  if (says_absent(value) && may_be_absent(key)) return pipeline::kAbsent;
  return text_of(value, key, 0);
}

std::vector<pipeline::SettingsFlag> flags_of(const py::object& values, const std::string& where) {
  std::vector<pipeline::SettingsFlag> flags;
  if (values.is_none()) return flags;
  if (!py::hasattr(values, "items"))
    throw_not("hotblade.Settings or a mapping of their keys", values, where, "Settings.load() reads a file");
  for (const py::handle& pair : values.attr("items")()) {
    const std::string key = utf8_of(py::str(pair[py::int_(0)]), where + ": a key");
    flags.push_back({where, key, toml_value(pair[py::int_(1)], key)});
  }
  if (py::isinstance<SaidSettings>(values)) {
    const auto& said = values.cast<const SaidSettings&>().said;
    for (pipeline::SettingsFlag& flag : flags) flag.said = said.contains(flag.key);
  }
  return flags;
}

SaidSettings settings_of(const py::object& given) {
  if (py::isinstance<SaidSettings>(given)) return given.cast<const SaidSettings&>();
  return resolved({{}, {}, flags_of(given, "settings")});
}

SaidSettings all_said(const Settings& settings) {
  SaidSettings all{settings, {}};
  for (const pipeline::SettingField& field : pipeline::setting_fields()) all.said.insert(full_key(field));
  return all;
}

void add_settings(py::module_& module) {
  py::class_<SaidSettings, std::shared_ptr<SaidSettings>>(
      module, "Settings", "Every number a plan depends on, by key; it never changes.")
      .def(py::init([](const py::object& values) {
             return resolved({{}, {}, flags_of(values, "settings")});
           }),
           py::arg("values") = py::none())
      .def_static(
          "load",
          [](const py::object& files, const py::object& values) {
            return resolved({files_of(files), {}, flags_of(values, "settings")});
          },
          py::arg("files"), py::arg("values") = py::none(),
          "Settings of TOML files in their order, with values on top.")
      .def(
          "changed",
          [](const SaidSettings& settings, const py::object& values) {
            const std::vector<pipeline::SettingsFlag> flags = flags_of(values, "settings");
            const Unlocked release;
            return pipeline::with_flags(settings, flags);
          },
          py::arg("values"), "The same settings with other values.")
      .def("__getitem__", &value_of)
      .def("__len__", [](const SaidSettings&) { return pipeline::setting_fields().size(); })
      .def("__iter__", [](const SaidSettings&) { return py::iter(keys()); })
      .def(
          "to_toml",
          [](const SaidSettings& settings) { return unlocked([&] { return to_toml(settings.settings); }); },
          "A configuration file that reads back as these settings.")
      .def("__reduce__",
           [](const py::object& self) {
             py::dict values;  // what was said: the others are at their defaults
             for (const std::string& key : self.cast<const SaidSettings&>().said)
               values[py::str(key)] = self[py::str(key)];
             return py::make_tuple(py::type::of(self), py::make_tuple(values));
           })
      .def("__repr__", [](const SaidSettings& said) {
        return "<hotblade.Settings tolerance " + pipeline::number_text(said.settings.design.tolerance_mm) +
               " mm>";
      });
}

}  // namespace hotblade::python
