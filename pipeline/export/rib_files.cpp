#include "pipeline/export/rib_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "elastica/arcs/arcs.hpp"
#include "pipeline/export/dxf.hpp"

namespace hotblade::pipeline {
namespace {

using Eigen::Vector2d;
using elastica::Arc;

// Between two ribs on a sheet, and the height of their names.
constexpr double kGap_mm = 20, kText_mm = 8;
// An arc this flat is written as a line: its radius would be beyond what readers of files take.
constexpr double kFlat_mm = 1e-5;

// A rib as pieces, each starting where the one before ends; lines have kappa 0.
struct Shape {
  std::string id;
  std::vector<Arc> pieces;
  double error_bound = 0, length = 0;  // of the pieces; of the rib itself
  Vector2d low{0, 0}, high{0, 0};

  [[nodiscard]] Vector2d start() const { return {pieces.front().x, pieces.front().y}; }
};

Vector2d end_of(const Arc& arc) {
  return elastica::point_at(arc, arc.length).position();
}

double sagitta(const Arc& arc) {
  return std::abs(arc.kappa) * arc.length * arc.length / 8;
}

// Chords no farther from the curve than the tolerance: sagitta kappa h^2 / 8.
void add_chords(Shape& shape, const elastica::Elastica& rib, double tolerance) {
  const elastica::ElasticaCurve curve(rib);
  const double kappa = curve.max_abs_curvature();
  const int n = std::max(1, static_cast<int>(std::ceil(rib.length * std::sqrt(kappa / (8 * tolerance)))));
  Vector2d from = curve.at(0).position();
  for (int i = 1; i <= n; ++i) {
    const Vector2d to = curve.at(rib.length * i / n).position(), way = to - from;
    shape.pieces.push_back({from.x(), from.y(), std::atan2(way.y(), way.x()), 0, way.norm()});
    from = to;
  }
  const double h = rib.length / n;
  shape.error_bound = kappa * h * h / 8;
}

Shape shape_of(const Rib& rib, const RibFileOptions& options) {
  Shape shape;
  shape.id = rib.id;
  shape.length = rib.elastica.length;
  if (options.arcs) {
    // Both ways from the curve, to its arcs and from them to lines, fit into the tolerance.
    const double flat = std::min(kFlat_mm, 0.5 * options.tolerance_mm);
    elastica::ArcFit fit =
        elastica::fit_arcs(rib.elastica, options.tolerance_mm - flat, elastica::ArcOrder::kBiarc);
    shape.pieces = std::move(fit.arcs);
    double flattened = 0;
    for (Arc& arc : shape.pieces) {
      if (sagitta(arc) >= flat) continue;
      flattened = std::max(flattened, sagitta(arc));
      const double bent = arc.kappa;
      arc.theta += 0.5 * bent * arc.length;  // the chord, whose ends are the arc's
      arc.kappa = 0;
    }
    shape.error_bound = fit.error_bound + flattened;
  } else {
    add_chords(shape, rib.elastica, options.tolerance_mm);
  }
  shape.low = shape.high = shape.start();
  for (const Arc& arc : shape.pieces) {
    for (const double part : {0.25, 0.5, 0.75, 1.0}) {
      const Vector2d p = elastica::point_at(arc, part * arc.length).position();
      shape.low = shape.low.cwiseMin(p);
      shape.high = shape.high.cwiseMax(p);
    }
  }
  return shape;
}

// Below the shape, in its own axes.
Vector2d label_place(const Shape& shape) {
  return shape.low - Vector2d(0, kText_mm + 2);
}

std::vector<Shape> shapes_of(const Strip& strip, const RibFileOptions& options) {
  std::vector<Shape> shapes;
  for (const Rib& rib : strip.ribs) shapes.push_back(shape_of(rib, options));
  return shapes;
}

std::string facts(const Shape& shape, const RibFileOptions& options) {
  return fmt::format("{} length {:.6f} mm, {} {}, within {:.6f} mm", shape.id, shape.length,
                     shape.pieces.size(), options.arcs ? "arcs" : "chords", shape.error_bound);
}

// Where each shape goes on a sheet: lowest first, from x = 0 and y = 0 up.
std::vector<Vector2d> stacked(const std::vector<Shape>& shapes) {
  std::vector<Vector2d> places;
  double y = 0;
  for (const Shape& shape : shapes) {
    y += kText_mm + kGap_mm;
    places.emplace_back(-shape.low.x(), y - shape.low.y());
    y += shape.high.y() - shape.low.y();
  }
  return places;
}

std::string dxf(const std::vector<Shape>& shapes, const RibFileOptions& options) {
  const std::vector<Vector2d> places = stacked(shapes);
  std::vector<DxfCurve> curves;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const Shape& shape = shapes[i];
    DxfCurve curve{shape.id, facts(shape, options), {}, label_place(shape) + places[i]};
    for (const Arc& arc : shape.pieces) {
      curve.vertices.push_back({Vector2d(arc.x, arc.y) + places[i], std::tan(0.25 * arc.kappa * arc.length)});
    }
    curve.vertices.push_back({end_of(shape.pieces.back()) + places[i], 0});
    curves.push_back(std::move(curve));
  }
  return dxf_document(curves, kText_mm);
}

std::string svg(const std::vector<Shape>& shapes, const RibFileOptions& options) {
  const std::vector<Vector2d> places = stacked(shapes);
  double width = 0, height = 0;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    width = std::max(width, shapes[i].high.x() + places[i].x());
    height = std::max(height, shapes[i].high.y() + places[i].y());
  }
  width += kGap_mm;
  height += kGap_mm;
  std::string text = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.3f}mm\" height=\"{1:.3f}mm\" "
      "viewBox=\"{2:.3f} 0 {0:.3f} {1:.3f}\">\n",
      width + kGap_mm, height, -kGap_mm);
  const auto out = std::back_inserter(text);
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const Shape& shape = shapes[i];
    const auto x = [&](const Vector2d& p) { return p.x() + places[i].x(); };
    const auto y = [&](const Vector2d& p) { return height - p.y() - places[i].y(); };  // down the page
    fmt::format_to(out,
                   "<path id=\"{}\" fill=\"none\" stroke=\"black\" stroke-width=\"0.25\" d=\"M{:.6f} {:.6f}",
                   shape.id, x(shape.start()), y(shape.start()));
    for (const Arc& arc : shape.pieces) {
      const Vector2d end = end_of(arc);
      if (arc.kappa == 0) {
        fmt::format_to(out, "L{:.6f} {:.6f}", x(end), y(end));
      } else {
        const double radius = 1 / std::abs(arc.kappa), turning = std::abs(arc.kappa) * arc.length;
        fmt::format_to(out, "A{0:.6f} {0:.6f} 0 {1} {2} {3:.6f} {4:.6f}", radius,
                       turning > std::numbers::pi ? 1 : 0, arc.kappa < 0 ? 1 : 0, x(end), y(end));
      }
    }
    fmt::format_to(out, "\"><title>{}</title></path>\n", facts(shape, options));
    const Vector2d label = label_place(shape);
    fmt::format_to(out, "<text x=\"{:.3f}\" y=\"{:.3f}\" font-size=\"{}\">{}</text>\n", x(label), y(label),
                   kText_mm, shape.id);
  }
  return text + "</svg>\n";
}

std::string csv(const Strip& strip, const std::vector<Shape>& shapes, const RibFileOptions& options) {
  std::string text;
  for (const Shape& shape : shapes) text += "# " + facts(shape, options) + "\n";
  text += options.arcs ? "rib,index,x_mm,y_mm,theta_rad,kappa_per_mm,length_mm\n"
                       : "rib,index,x_mm,y_mm,design_x_mm,design_y_mm,design_z_mm\n";
  const auto out = std::back_inserter(text);
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const std::vector<Arc>& pieces = shapes[i].pieces;
    for (std::size_t k = 0; k < pieces.size() + (options.arcs ? 0 : 1); ++k) {
      if (options.arcs) {
        const Arc& a = pieces[k];
        fmt::format_to(out, "{},{},{:.9f},{:.9f},{:.12f},{:.12g},{:.9f}\n", shapes[i].id, k, a.x, a.y,
                       a.theta, a.kappa, a.length);
        continue;
      }
      const Vector2d p = k < pieces.size() ? Vector2d(pieces[k].x, pieces[k].y) : end_of(pieces.back());
      const Eigen::Vector3d q = strip.ribs[i].frame.point(p.x(), p.y());
      fmt::format_to(out, "{},{},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f}\n", shapes[i].id, k, p.x(), p.y(), q.x(),
                     q.y(), q.z());
    }
  }
  return text;
}

std::string gcode(const Shape& shape, const RibFileOptions& options) {
  std::string text = fmt::format("({})\nG17 G21 G90 G91.1\n", facts(shape, options));
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "G0 X{:.6f} Y{:.6f}\n", shape.start().x(), shape.start().y());
  for (const Arc& arc : shape.pieces) {
    const Vector2d end = end_of(arc);
    if (arc.kappa == 0) {
      fmt::format_to(out, "G1 X{:.6f} Y{:.6f}\n", end.x(), end.y());
    } else {
      const double i = -std::sin(arc.theta) / arc.kappa, j = std::cos(arc.theta) / arc.kappa;
      fmt::format_to(out, "{} X{:.6f} Y{:.6f} I{:.6f} J{:.6f}\n", arc.kappa > 0 ? "G3" : "G2", end.x(),
                     end.y(), i, j);
    }
  }
  return text + "M2\n";
}

}  // namespace

ExportedFile bezier_file(const Program& program) {
  std::string text = "rib,index,x_mm,y_mm,design_x_mm,design_y_mm,design_z_mm\n";
  const auto out = std::back_inserter(text);
  for (const Strip& strip : program.strips) {
    for (const Rib& rib : strip.ribs) {
      for (std::size_t k = 0; k < rib.bezier.size(); ++k) {
        const Vector2d& p = rib.bezier[k];
        const Eigen::Vector3d q = rib.frame.point(p.x(), p.y());
        fmt::format_to(out, "{},{},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f}\n", rib.id, k, p.x(), p.y(), q.x(),
                       q.y(), q.z());
      }
    }
  }
  return {"beziers.csv", text};
}

std::vector<ExportedFile> rib_files(const Program& program, const std::string& format,
                                    const RibFileOptions& options) {
  std::vector<ExportedFile> files;
  for (const Strip& strip : program.strips) {
    const std::vector<Shape> shapes = shapes_of(strip, options);
    if (shapes.empty()) continue;
    if (format == "dxf") {
      files.push_back({strip.id + ".dxf", dxf(shapes, options)});
    } else if (format == "svg") {
      files.push_back({strip.id + ".svg", svg(shapes, options)});
    } else if (format == "csv") {
      files.push_back({strip.id + ".csv", csv(strip, shapes, options)});
    } else if (format == "gcode") {
      for (const Shape& shape : shapes) files.push_back({shape.id + ".nc", gcode(shape, options)});
    } else {
      throw std::logic_error("rib_files: unknown format " + format);
    }
  }
  return files;
}

}  // namespace hotblade::pipeline
