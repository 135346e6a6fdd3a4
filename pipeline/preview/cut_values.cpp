#include "pipeline/preview/cut_values.hpp"
#include "elastica/blade/blade_batch.hpp"
#include "robot/blade/blade_section.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace hotblade::pipeline::preview {
namespace {

// A round number at or above x: 1, 1.5, 2, 3, 5 or 7.5 times a power of ten.
double round_up(double x) {
  constexpr double kRounding = 1e-9;  // so that 0.3, stored a little above, stays 0.3
  if (!(x > 0)) return 1;
  const double decade = std::pow(10, std::floor(std::log10(x)));
  for (const double step : {1.0, 1.5, 2.0, 3.0, 5.0, 7.5}) {
    if (step * decade >= x * (1 - kRounding)) return step * decade;
  }
  return 10 * decade;
}

ColorScale deviation_scale(const std::vector<double>& values, double tolerance_mm) {
  double most = 0;
  for (const double value : values) most = std::max(most, std::abs(value));
  // Wide enough for the worst place; what is nearly right keeps its own share of the key (overlay.cpp).
  const double range = round_up(std::max(most, 1.5 * tolerance_mm));
  return {"deviation, mm", -range, range, tolerance_mm, std::nullopt, range};
}

// Ends at multiples of the step between the key's marks.
ColorScale sequential_scale(const std::string& title, double low, double high) {
  constexpr double kLeastShare = 0.02;  // of the size: less is the same to the eye and to the job
  const double size = std::max({std::abs(low), std::abs(high), std::numeric_limits<double>::min()});
  const double step = round_up(std::max(high - low, kLeastShare * size) / 4);
  const double from = std::floor(low / step + 1e-9) * step;  // rounding of the quotient
  double to = std::ceil(high / step - 1e-9) * step;
  if (!(to > from)) to = from + step;
  return {title, from, to, std::nullopt, std::nullopt, step};
}

ColorScale scale_over(const std::string& title, const std::vector<double>& values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return sequential_scale(title, *low, *high);
}

// Curvature at which the blade's surface yields: what a plan allows times the safety it keeps.
Coloring curvature_coloring(const Program& program, const CutSurface& surface) {
  const double yield = robot::max_curvature_per_mm(program.blade, 1);
  Coloring out;
  for (const double curvature : surface.curvature_per_mm) out.values.push_back(100 * curvature / yield);
  const double most = *std::max_element(out.values.begin(), out.values.end());
  const double allowed = 100 / program.blade.safety;
  // A gentle blade has its own scale, and the key says what is allowed.
  out.scale =
      sequential_scale("curvature, % of yield", 0, most > allowed / 2 ? std::max(most, allowed) : most);
  out.scale->limit = allowed;
  return out;
}

std::vector<double> margins(const Program& program, const CutSurface& surface) {
  std::vector<double> values;
  for (std::size_t i = 0; i < surface.vertices.size(); ++i) {
    const Strip& strip = program.strips[static_cast<std::size_t>(surface.strip_of_vertex[i])];
    values.push_back(strip.poses[static_cast<std::size_t>(surface.pose_of_vertex[i])].margin);
  }
  return values;
}

// Vertices of one pose, [first, last).
struct Row {
  std::size_t first, last;
};

std::vector<Row> rows_of(const CutSurface& surface) {
  std::vector<Row> rows;
  for (std::size_t i = 0; i < surface.vertices.size(); ++i) {
    const bool same = !rows.empty() && surface.strip_of_vertex[i] == surface.strip_of_vertex[i - 1] &&
                      surface.pose_of_vertex[i] == surface.pose_of_vertex[i - 1];
    if (same) {
      rows.back().last = i + 1;
    } else {
      rows.push_back({i, i + 1});
    }
  }
  return rows;
}

// Speeds of the blade's own points over the step that ends at a row's pose; at the first pose in foam, over
// the step behind it. Where foam ends elsewhere along the blade the vertices of a row are other points than
// those of the row before: the same arc lengths are looked at in both poses.
std::vector<double> feeds(const Program& program, const CutSurface& surface) {
  std::vector<double> values(surface.vertices.size(), 0);
  for (const Row& row : rows_of(surface)) {
    const auto& poses = program.strips[static_cast<std::size_t>(surface.strip_of_vertex[row.first])].poses;
    const auto at = static_cast<std::size_t>(surface.pose_of_vertex[row.first]);
    const std::size_t to = at > 0 && poses[at - 1].foam ? at : at + 1;
    const BladePose &before = poses[to - 1], &then = poses[to];
    const auto& [first, last] = *poses[at].foam;
    const std::array<elastica::Elastica, 2> blades{before.blade, then.blade};
    const std::array<elastica::Part, 2> parts{{{first, last}, {first, last}}};
    const elastica::PartPlaces points = elastica::sample_places(blades, parts, row.last - row.first);
    for (std::size_t k = 0; k < row.last - row.first; ++k) {
      const Eigen::Vector2d p = points.at(0, k), q = points.at(1, k);
      const Eigen::Vector3d moved = then.frame.point(q.x(), q.y()) - before.frame.point(p.x(), p.y());
      values[row.first + k] = moved.norm() / (then.t - before.t);
    }
  }
  return values;
}

}  // namespace

Coloring coloring_of(Color color, const Program& program, const CutSurface& surface) {
  Coloring out;
  if (color == Color::kStrip || surface.vertices.empty()) return out;
  if (color == Color::kCurvature) return curvature_coloring(program, surface);
  if (color == Color::kDeviation) {
    out.values = surface.deviation_mm;
    out.scale = deviation_scale(out.values, program.verification.tolerance_mm);
  } else if (color == Color::kMargin) {
    out.values = margins(program, surface);
    out.scale = scale_over("stability margin", out.values);
  } else {
    out.values = feeds(program, surface);
    out.scale = scale_over("feed, mm/s", out.values);
  }
  return out;
}

}  // namespace hotblade::pipeline::preview
