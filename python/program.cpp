// hotblade.Program, with its strips, ribs and poses as arrays.
#include "pipeline/program/program.hpp"

#include <fmt/format.h>

#include <cstddef>
#include <cstring>
#include <nlohmann/json.hpp>

#include "pipeline/program/atomic_file.hpp"
#include "pipeline/program/gzip.hpp"
#include "pipeline/report/json/report_json.hpp"
#include "pipeline/settings/error.hpp"
#include "python/module.hpp"

namespace hotblade::python {
namespace {

using elastica::Elastica;
using pipeline::BladePose;
using pipeline::StripPhase;

struct Strip {
  std::shared_ptr<Program> program;
  std::size_t index = 0;
  [[nodiscard]] const pipeline::Strip& get() const { return program->data->strips[index]; }
};

struct Rib {
  std::shared_ptr<Program> program;
  std::size_t strip = 0, index = 0;
  [[nodiscard]] const pipeline::Rib& get() const { return program->data->strips[strip].ribs[index]; }
};

static_assert(sizeof(Elastica) == 7 * sizeof(double) && offsetof(Elastica, length) == 6 * sizeof(double));
static_assert(sizeof(pipeline::PoseRow) == 7 * sizeof(double) && offsetof(pipeline::PoseRow, p) == 0 &&
              offsetof(pipeline::PoseRow, w) == 3 * sizeof(double));
static_assert(sizeof(StripPhase) == sizeof(std::uint8_t) && sizeof(Eigen::Vector2d) == 2 * sizeof(double));

// One member of every pose, where the poses are.
template <typename T>
py::array of_poses(const py::object& self, const T BladePose::*member) {
  const auto& poses = self.cast<const Strip&>().get().poses;
  return view<T>({static_cast<py::ssize_t>(poses.size())}, {sizeof(BladePose)},
                 poses.empty() ? nullptr : &(poses[0].*member), self);
}

py::array blades(const py::object& self) {
  const auto& poses = self.cast<const Strip&>().get().poses;
  return view<double>({static_cast<py::ssize_t>(poses.size()), 7}, {sizeof(BladePose), sizeof(double)},
                      poses.empty() ? nullptr : &poses[0].blade.x, self);
}

py::array phases(const py::object& self) {
  const auto& poses = self.cast<const Strip&>().get().poses;
  return view<std::uint8_t>({static_cast<py::ssize_t>(poses.size())}, {sizeof(BladePose)},
                            poses.empty() ? nullptr : reinterpret_cast<const std::uint8_t*>(&poses[0].phase),
                            self);
}

py::array clamps(const py::object& self, const pipeline::PoseRow BladePose::*member) {
  const auto& poses = self.cast<const Strip&>().get().poses;
  return view<double>({static_cast<py::ssize_t>(poses.size()), 7}, {sizeof(BladePose), sizeof(double)},
                      poses.empty() ? nullptr : (poses[0].*member).p.data(), self);
}

// The joints of the arm that holds a clamp; None without arms.
py::object arm_joints(const py::object& self, const pipeline::ArmJoints pipeline::ClampJoints::*member) {
  const auto& joints = self.cast<const Strip&>().get().joints;
  if (joints.empty()) return py::none();
  constexpr auto kJoints = static_cast<py::ssize_t>(pipeline::kArmJoints);
  return view<double>({static_cast<py::ssize_t>(joints.size()), kJoints},
                      {sizeof(pipeline::ClampJoints), sizeof(double)}, (joints[0].*member).data(), self);
}

py::array planar(const std::vector<Eigen::Vector2d>& points, const py::object& self) {
  return rows(points.size(), 2, points.empty() ? nullptr : points[0].data(), self);
}

std::shared_ptr<Program> handed_out(pipeline::Program&& program) {
  return std::make_shared<Program>(Program{std::make_shared<pipeline::Program>(std::move(program))});
}

std::shared_ptr<Program> load_program(const py::object& file) {
  const std::string path = path_of(file, "file");
  return reading(path, [&] { return handed_out(pipeline::read_program(path)); });
}

void save_program(const Program& program, const py::object& file, const py::object& forced) {
  const std::string path = path_of(file, "file");
  const bool force = truth(forced, "force");
  const Unlocked release;
  const pipeline::Program& data = *program.data;
  if (data.verification.status != pipeline::VerificationStatus::kPassed && data.overrides.empty())
    throw pipeline::Error(pipeline::ErrorKind::kNotCuttable,
                          path +
                              ": the plan was refused: it is no program to run (`hotblade plan "
                              "--override` writes one all the same)");
  const std::string text = to_json(data);
  // What the reader would refuse is not handed out.
  (void)pipeline::parse_program(text, path);
  const bool gzip = pipeline::is_gzip_name(path);
  pipeline::write_file_atomically(path, gzip ? pipeline::packed(text) : text, force);
}

py::dict deviation(const pipeline::Deviation& d) {
  using namespace py::literals;
  return py::dict("max"_a = d.max, "p99"_a = d.p99, "rms"_a = d.rms, "mean"_a = d.mean,
                  "at"_a = py::make_tuple(d.at.x(), d.at.y(), d.at.z()));
}

void add_rib(py::module_& module) {
  const auto number = [](double pipeline::Rib::*member) {
    return [member](const Rib& rib) { return rib.get().*member; };
  };
  const auto vector = [](Eigen::Vector3d pipeline::Frame::*member) {
    return [member](const py::object& self) {
      return view<double>({3}, {sizeof(double)}, (self.cast<const Rib&>().get().frame.*member).data(), self);
    };
  };
  py::class_<Rib>(module, "Rib", "A rib of a strip: what the blade forms in one plane.")
      .def_property_readonly("id", [](const Rib& rib) { return rib.get().id; })
      .def_property_readonly("origin", vector(&pipeline::Frame::origin))
      .def_property_readonly("x", vector(&pipeline::Frame::x))
      .def_property_readonly("y", vector(&pipeline::Frame::y))
      .def_property_readonly(
          "target", [](const py::object& self) { return planar(self.cast<const Rib&>().get().target, self); })
      .def_property_readonly(
          "bezier", [](const py::object& self) { return planar(self.cast<const Rib&>().get().bezier, self); })
      .def_property_readonly("elastica",
                             [](const py::object& self) {
                               return view<double>({7}, {sizeof(double)},
                                                   &self.cast<const Rib&>().get().elastica.x, self);
                             })
      .def_property_readonly("lambda_residual", number(&pipeline::Rib::lambda_residual))
      .def_property_readonly("l2", number(&pipeline::Rib::l2))
      .def_property_readonly("h1", number(&pipeline::Rib::h1))
      .def_property_readonly("hausdorff_mm", number(&pipeline::Rib::hausdorff_mm))
      .def_property_readonly("design_deviation_mm", number(&pipeline::Rib::design_deviation_mm))
      .def("__repr__", [](const Rib& rib) { return "<hotblade.Rib " + rib.get().id + ">"; });
}

void add_strip(py::module_& module) {
  py::tuple names(pipeline::kStripPhases.size());
  for (std::size_t i = 0; i < pipeline::kStripPhases.size(); ++i) names[i] = name(pipeline::kStripPhases[i]);
  module.attr("PHASES") = names;
  py::class_<Strip>(module, "Strip", "One block and the motion that cuts it, a row a waypoint.")
      .def_property_readonly("id", [](const Strip& strip) { return strip.get().id; })
      .def_property_readonly("blade_length_mm",
                             [](const Strip& strip) { return strip.get().blade_length_mm; })
      .def_property_readonly("ribs",
                             [](const Strip& strip) {
                               const std::size_t count = strip.get().ribs.size();
                               py::tuple ribs(count);
                               for (std::size_t i = 0; i < count; ++i)
                                 ribs[i] = Rib{strip.program, strip.index, i};
                               return ribs;
                             })
      .def_property_readonly("t", [](const py::object& self) { return of_poses(self, &BladePose::t); })
      .def_property_readonly("heat", [](const py::object& self) { return of_poses(self, &BladePose::heat); })
      .def_property_readonly("margin",
                             [](const py::object& self) { return of_poses(self, &BladePose::margin); })
      .def_property_readonly("phase", &phases)
      .def_property_readonly("blade", &blades)
      .def_property_readonly("a", [](const py::object& self) { return clamps(self, &BladePose::a); })
      .def_property_readonly("b", [](const py::object& self) { return clamps(self, &BladePose::b); })
      .def_property_readonly(
          "joints_a", [](const py::object& self) { return arm_joints(self, &pipeline::ClampJoints::a); })
      .def_property_readonly(
          "joints_b", [](const py::object& self) { return arm_joints(self, &pipeline::ClampJoints::b); })
      .def_property_readonly("arms",
                             [](const Strip& strip) -> py::object {
                               const auto& arms = strip.get().arms;
                               return arms ? to_python(pipeline::arms_json(*arms)) : py::none();
                             })
      .def_property_readonly("block_mm",
                             [](const py::object& self) {
                               return view<double>({3}, {sizeof(double)},
                                                   self.cast<const Strip&>().get().block.size_mm.data(),
                                                   self);
                             })
      .def("__len__", [](const Strip& strip) { return strip.get().poses.size(); })
      .def("__repr__", [](const Strip& strip) {
        return fmt::format("<hotblade.Strip {}: {} ribs, {} waypoints>", strip.get().id,
                           strip.get().ribs.size(), strip.get().poses.size());
      });
}

}  // namespace

void add_program(py::module_& module) {
  add_rib(module);
  add_strip(module);
  py::class_<Program, std::shared_ptr<Program>>(module, "Program", "A cut program; it never changes.")
      .def(made_otherwise<Program>("hotblade.Program: Program.load() reads a file, Program.from_json() a "
                                   "text; a plan has its .program"))
      .def_static("load", &load_program, py::arg("file"), "Reads program.json or program.json.gz.")
      .def_static(
          "from_json",
          [](const py::object& given) {
            const std::string json =
                py::isinstance<py::bytes>(given) ? given.cast<std::string>() : text(given, "text");
            const Unlocked release;
            const std::string name = "program.json";
            return placed([&] { return handed_out(pipeline::parse_program(json, name)); },
                          [&](const std::string& what) { throw_placed(what, name, ""); });
          },
          py::arg("text"), "Reads the text of a program.")
      .def("save", &save_program, py::arg("file"), py::arg("force") = false,
           "Writes the program, packed where the name ends in .gz.")
      .def(
          "to_json",
          [](const Program& program) {
            std::string text;
            {
              const Unlocked release;
              text = to_json(*program.data);
            }
            return text;
          },
          "The text of program.json.")
      .def_property_readonly("strips",
                             [](const std::shared_ptr<Program>& program) {
                               const std::size_t count = program->data->strips.size();
                               py::tuple strips(count);
                               for (std::size_t i = 0; i < count; ++i) strips[i] = Strip{program, i};
                               return strips;
                             })
      .def_property_readonly("cell",
                             [](const Program& program) -> py::object {
                               if (!program.data->cell) return py::none();
                               using namespace py::literals;
                               return py::dict("name"_a = program.data->cell->name,
                                               "sha256"_a = program.data->cell->sha256);
                             })
      .def_property_readonly("settings",
                             [](const Program& program) { return all_said(program.data->settings); })
      .def_property_readonly("design_file",
                             [](const Program& program) { return path_text(program.data->design.file); })
      .def_property_readonly("design_sha256",
                             [](const Program& program) { return program.data->design.sha256; })
      .def_property_readonly("status",
                             [](const Program& program) { return name(program.data->verification.status); })
      .def_property_readonly("tolerance_mm",
                             [](const Program& program) { return program.data->verification.tolerance_mm; })
      .def_property_readonly(
          "deviation_mm",
          [](const Program& program) { return deviation(program.data->verification.deviation_mm); })
      .def_property_readonly("budget_mm",
                             [](const Program& program) {
                               py::dict budget;
                               for (const auto& [name, mm] : program.data->verification.budget_mm)
                                 budget[py::str(name)] = mm;
                               return budget;
                             })
      .def("__repr__", [](const Program& program) {
        return fmt::format("<hotblade.Program of {}: {}, {} strips>", program.data->design.file,
                           name(program.data->verification.status), program.data->strips.size());
      });
}

}  // namespace hotblade::python
