// hotblade.curve: what `hotblade curve` does, on arrays. Tuples here become named ones in curve.py.
#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <cstdint>

#include "elastica/arcs/arcs.hpp"
#include "elastica/bezier/curve_distance.hpp"
#include "elastica/bezier/lambda_residual.hpp"
#include "elastica/bezier/residual_batch.hpp"
#include "elastica/blade/equilibria.hpp"
#include "elastica/curve/elastica.hpp"
#include "elastica/fit/even_points.hpp"
#include "elastica/fit/fit.hpp"
#include "elastica/fit/fit_bezier.hpp"
#include "elastica/fit/fit_clamped.hpp"
#include "elastica/projection/project.hpp"
#include "elastica/projection/project_zone.hpp"
#include "pipeline/settings/error.hpp"
#include "python/module.hpp"

namespace hotblade::python {
namespace {

using Eigen::Vector2d;
using elastica::Bezier;
using elastica::Elastica;
using pipeline::Error;
using pipeline::ErrorKind;

// As `hotblade curve` takes them: larger numbers lose the digits that a curve's shape needs.
constexpr double kLargest = 1e9;
constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

Numbers in_range(const py::handle& value, const char* name, std::initializer_list<py::ssize_t> shape) {
  Numbers array = numbers(value, name, shape);
  const double* data = array.data();
  for (py::ssize_t i = 0; i < array.size(); ++i) {
    if (!(std::abs(data[i]) <= kLargest))
      throw Error(ErrorKind::kBadSettings,
                  fmt::format("{}: out of range ({}, limit {})", name, data[i], kLargest));
  }
  return array;
}

double in_range(double value, const char* name, double least, double most) {
  if (!(value >= least && value <= most))
    throw Error(ErrorKind::kBadSettings,
                fmt::format("{}: out of range ({}, limits {} and {})", name, value, least, most));
  return value;
}

// The index of a word among those allowed.
std::size_t one_of(const py::handle& given, const char* name, std::initializer_list<const char*> words) {
  const std::string word = text(given, name);
  std::size_t index = 0;
  std::string all;
  for (const char* allowed : words) {
    if (word == allowed) return index;
    ++index;
    all += (all.empty() ? "" : ", ") + std::string(allowed);
  }
  throw Error(ErrorKind::kBadSettings, fmt::format("{} (\"{}\", must be one of {})", name, word, all));
}

Bezier bezier_of(const py::handle& value, const char* name) {
  const Numbers array = in_range(value, name, {4, 2});
  const auto p = array.unchecked<2>();
  return {Vector2d(p(0, 0), p(0, 1)), Vector2d(p(1, 0), p(1, 1)), Vector2d(p(2, 0), p(2, 1)),
          Vector2d(p(3, 0), p(3, 1))};
}

std::vector<Vector2d> points_of(const py::handle& value, const char* name) {
  const Numbers array = in_range(value, name, {kAny, 2});
  const auto p = array.unchecked<2>();
  std::vector<Vector2d> points;
  for (py::ssize_t i = 0; i < p.shape(0); ++i) points.emplace_back(p(i, 0), p(i, 1));
  return points;
}

Elastica elastica_of(const py::handle& value, const char* name) {
  const Numbers array = in_range(value, name, {7});
  const double* e = array.data();
  if (!(e[6] > 0))
    throw Error(ErrorKind::kBadSettings, fmt::format("{}: its length ({}) must be positive", name, e[6]));
  return {e[0], e[1], e[2], e[3], e[4], e[5], e[6]};
}

py::array array_of(const Elastica& e) {
  return Numbers({7}, &e.x);
}

py::array array_of(const Bezier& b) {
  return Numbers({4, 2}, b[0].data());
}

// A view of rows that it keeps.
template <typename T>
py::capsule kept(std::unique_ptr<std::vector<T>>& list) {
  const py::capsule owner(list.get(), [](void* data) { delete static_cast<std::vector<T>*>(data); });
  list.release();
  return owner;
}

// Runs without the interpreter's lock what needs no Python. What the curve cannot give is an error of the
// input, as it is of a line of `hotblade curve`.
template <typename Work>
auto answered(const char* name, const Work& work) {
  const Unlocked release;
  const auto fail = [name](const std::exception& error) {
    return Error(ErrorKind::kBadInput, fmt::format("{}: {}", name, error.what()));
  };
  try {
    return work();
  } catch (const std::logic_error& error) {
    throw fail(error);
  } catch (const std::runtime_error& error) {
    throw fail(error);
  }
}

py::tuple residual(const py::object& bezier) {
  const elastica::LambdaResidual r = elastica::lambda_residual(bezier_of(bezier, "bezier"));
  const bool known = has_value(r.status);
  const auto number = [&](double value) { return known ? value : kNoNumber; };
  return py::make_tuple(number(r.value), number(r.lambda1), number(r.lambda2), number(r.alpha),
                        number(r.bound), name(r.status));
}

py::tuple residuals(const py::object& beziers) {
  const Numbers array = numbers(beziers, "beziers", {kAny, 4, 2});
  const py::ssize_t count = array.shape(0);
  Numbers value({count}), bound({count});
  py::array_t<std::uint8_t> status({count});
  static_assert(sizeof(elastica::ResidualStatus) == 1);
  const double* from = array.data();
  double *e = value.mutable_data(), *b = bound.mutable_data();
  auto* s = reinterpret_cast<elastica::ResidualStatus*>(status.mutable_data());
  {
    const Unlocked release;
    // Splitting a batch among threads changes no bit.
    constexpr std::size_t kAtOnce = 4096;
    const auto all = static_cast<std::size_t>(count);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, all, kAtOnce), [&](const auto& range) {
      const std::size_t first = range.begin(), n = range.size();
      elastica::lambda_residuals(elastica::BezierRows{{from + 8 * first, 8 * n}},
                                 elastica::ResidualBatch{{e + first, n}, {s + first, n}, {b + first, n}});
    });
  }
  return py::make_tuple(value, bound, status);
}

py::tuple fit_result(const Elastica& e, double l2, double h1, double hausdorff, double error, int starts,
                     const char* status) {
  return py::make_tuple(array_of(e), l2, h1, hausdorff, error, starts, status);
}

py::tuple fit_bezier(const py::object& curve, bool clamped) {
  const Bezier b = bezier_of(curve, "curve");
  if (clamped) {
    const elastica::ClampedFit f = answered("curve", [&] { return elastica::fit_clamped(b); });
    if (f.starts_tried == 0)
      throw Error(ErrorKind::kBadInput, "curve: a Bezier with an end edge of length zero");
    const elastica::CurveDistance d = answered("curve", [&] { return distance(b, f.elastica); });
    return fit_result(f.elastica, d.l2, d.h1, d.hausdorff, d.hausdorff_error, f.starts_tried, name(f.status));
  }
  const elastica::BezierElasticaFit f = answered("curve", [&] { return elastica::fit_bezier_elastica(b); });
  if (f.status == elastica::FitStatus::kUnsupported)
    throw Error(ErrorKind::kBadInput,
                "curve: a Bezier with a cusp or an end edge of length zero, or that winds beyond any blade");
  const elastica::CurveDistance d = answered("curve", [&] { return distance(b, f.elastica); });
  return fit_result(f.elastica, d.l2, d.h1, d.hausdorff, d.hausdorff_error, f.starts_tried, name(f.status));
}

py::tuple fit_points(const py::object& curve, bool clamped, const py::object& tangents) {
  const std::vector<Vector2d> given = points_of(curve, "curve");
  if (given.size() < elastica::kFewestFitPoints)
    throw Error(ErrorKind::kBadSettings,
                fmt::format("curve: {} points (at least {} needed; a cubic Bezier has 4)", given.size(),
                            elastica::kFewestFitPoints));
  const std::vector<Vector2d> q = elastica::even_points(given);
  if (q.empty()) throw Error(ErrorKind::kBadInput, "curve: its points are all the same");
  if (!clamped) {
    const elastica::ElasticaFit f = answered("curve", [&] {
      return elastica::fit_elastica(q, {}, {0, nullptr, 0});
    });
    return fit_result(f.elastica, f.rms / f.elastica.length, kNoNumber, f.max, kNoNumber, f.starts_tried,
                      f.converged ? "ok" : "not_converged");
  }
  if (tangents.is_none())
    throw Error(ErrorKind::kBadSettings,
                "tangents: the angles of both ends are needed for points with ends=\"clamped\"");
  const Numbers angles = in_range(tangents, "tangents", {2});
  const elastica::ClampedFit f = answered("curve", [&] {
    const double first = angles.data()[0];
    const elastica::PlanarPose end{q.back().x(), q.back().y(),
                                   first + elastica::true_turning(q, first, angles.data()[1])};
    return elastica::fit_clamped(q, {{q.front().x(), q.front().y(), first}, end}, {}, {0, nullptr, 0});
  });
  return fit_result(f.elastica, f.rms / f.elastica.length, kNoNumber, f.max, kNoNumber, f.starts_tried,
                    name(f.status));
}

py::tuple fit(const py::object& curve, const py::object& ends, const py::object& tangents) {
  const bool clamped = one_of(ends, "ends", {"free", "clamped"}) == 1;
  const py::array array = py::array::ensure(curve);
  const bool is_bezier = array && array.ndim() == 2 && array.shape(0) == 4;
  return is_bezier ? fit_bezier(curve, clamped) : fit_points(curve, clamped, tangents);
}

py::tuple project(const py::object& bezier, const py::object& method, const py::object& branch,
                  const py::object& most) {
  using elastica::WantedBranch;
  const Bezier b = bezier_of(bezier, "bezier");
  const std::size_t by = one_of(method, "method", {"feedback", "optimal", "zone"});
  const auto wanted = static_cast<WantedBranch>(one_of(branch, "branch", {"inflectional", "plain", "best"}));
  const double threshold = in_range(number(most, "threshold"), "threshold", 0, 1);
  const elastica::Projection p = answered("bezier", [&] {
    if (by == 2) return elastica::project_zone(b, threshold);
    if (by == 0) return elastica::project_feedback(b, threshold);
    return threshold > 0 ? elastica::project_smallest_move(b, wanted, threshold)
                         : elastica::project_optimal(b, wanted);
  });
  if (p.status == elastica::ProjectStatus::kUnsupported)
    throw Error(ErrorKind::kBadInput,
                "bezier: its ends coincide, an end edge is zero, or the branch has no curve");
  return py::make_tuple(array_of(p.bezier), p.lambda_residual, name(p.branch),
                        py::make_tuple(p.moved[0], p.moved[1]), p.angle_constraints_hold, name(p.status));
}

py::tuple sample(const py::object& curve, const py::object& count) {
  const Elastica e = elastica_of(curve, "elastica");
  const std::int64_t n = whole_number(count, "n");
  in_range(static_cast<double>(n), "n", 2, 1e6);
  using Points = std::vector<elastica::CurvePoint>;
  auto points = answered("elastica",
                         [&] { return std::make_unique<Points>(elastica::sample(e, static_cast<int>(n))); });
  const elastica::CurvePoint* first = points->data();
  const py::capsule owner = kept(points);
  constexpr py::ssize_t kRow = sizeof(elastica::CurvePoint), kNumber = sizeof(double);
  return py::make_tuple(view<double>({n, 2}, {kRow, kNumber}, &first->x, owner),
                        view<double>({n}, {kRow}, &first->theta, owner),
                        view<double>({n}, {kRow}, &first->kappa, owner));
}

elastica::PlanarPose clamp_of(const py::handle& value, const char* name) {
  const Numbers pose = in_range(value, name, {3});
  return {pose.data()[0], pose.data()[1], pose.data()[2]};
}

py::tuple equilibria(const py::object& a, const py::object& b, const py::object& free_length,
                     const py::object& max_inflections, const py::object& max_energy) {
  const elastica::ClampPair clamps{clamp_of(a, "a"), clamp_of(b, "b")};
  const double length =
      in_range(number(free_length, "length"), "length", std::numeric_limits<double>::min(), kLargest);
  // Turns beyond this wind tighter than any blade, and the far clamp's turning is the true one.
  constexpr double kMostTurning = 100;
  in_range(clamps.b.theta - clamps.a.theta, "b: turning against a", -kMostTurning, kMostTurning);
  elastica::EquilibriaOptions options;
  if (!max_energy.is_none()) {
    options.max_energy = in_range(number(max_energy, "max_energy"), "max_energy", 0, kLargest);
    options.max_inflections = elastica::kMaxInflections;
  }
  if (!max_inflections.is_none())
    options.max_inflections =
        static_cast<int>(in_range(static_cast<double>(whole_number(max_inflections, "max_inflections")),
                                  "max_inflections", 0, elastica::kMaxInflections));
  const elastica::EquilibriaReport report =
      answered("length", [&] { return find_equilibria(clamps, length, options); });
  py::list shapes;
  for (const elastica::Equilibrium& q : report.equilibria)
    shapes.append(py::make_tuple(array_of(q.elastica), q.energy, q.stable, q.margin, q.inflections));
  return py::make_tuple(shapes, report.unresolved, report.taut);
}

py::tuple arcs(const py::object& curve, const py::object& within, const py::object& order) {
  const double tolerance = in_range(number(within, "tolerance"), "tolerance", 1e-9, 1e9);
  const auto wanted = one_of(order, "order", {"biarc", "triarc"}) == 1 ? elastica::ArcOrder::kTriarc
                                                                       : elastica::ArcOrder::kBiarc;
  const py::array array = py::array::ensure(curve);
  const bool from_points = array && array.ndim() == 2;
  const std::vector<Vector2d> points = from_points ? points_of(curve, "curve") : std::vector<Vector2d>();
  if (from_points && points.size() < elastica::kFewestArcPoints)
    throw Error(ErrorKind::kBadSettings, fmt::format("curve: {} points (at least {} needed)", points.size(),
                                                     elastica::kFewestArcPoints));
  const Elastica e = from_points ? Elastica{} : elastica_of(curve, "curve");
  elastica::ArcFit fit = answered("curve", [&] {
    return from_points ? elastica::fit_arcs(points, tolerance, wanted)
                       : elastica::fit_arcs(e, tolerance, wanted);
  });
  static_assert(sizeof(elastica::Arc) == 5 * sizeof(double));
  auto list = std::make_unique<std::vector<elastica::Arc>>(std::move(fit.arcs));
  const std::size_t count = list->size();
  const double* first = count > 0 ? &list->front().x : nullptr;
  const py::capsule owner = kept(list);
  return py::make_tuple(rows(count, 5, first, owner), fit.error_bound, fit.length);
}

}  // namespace

void add_curve(py::module_& module) {
  py::module_ curve =
      module.def_submodule("curve", "Curve tools on arrays; use them through `hotblade.curve`");
  curve.def("residual", &residual, py::arg("bezier"));
  curve.def("residuals", &residuals, py::arg("beziers"));
  curve.def("fit", &fit, py::arg("curve"), py::arg("ends"), py::arg("tangents"));
  curve.def("project", &project, py::arg("bezier"), py::arg("method"), py::arg("branch"),
            py::arg("threshold"));
  curve.def("sample", &sample, py::arg("elastica"), py::arg("n"));
  curve.def("equilibria", &equilibria, py::arg("a"), py::arg("b"), py::arg("length"),
            py::arg("max_inflections"), py::arg("max_energy"));
  curve.def("arcs", &arcs, py::arg("curve"), py::arg("tolerance"), py::arg("order"));
}

}  // namespace hotblade::python
