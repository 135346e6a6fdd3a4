#include "pipeline/preview/cut_grid.hpp"

#include <algorithm>
#include <cmath>

namespace hotblade::pipeline::preview {
namespace {

// A column about every 4 mm shows a 70 mm radius (the tightest a blade takes) without corners that could be
// seen.
constexpr double kColumnMm = 4;
// Rows nearer than this cannot be told apart in a picture of a part half a metre long.
constexpr double kRowMm = 1.5;

struct Row {
  std::size_t pose = 0;
  bool starts = false;  // first row of a piece
  std::vector<elastica::CurvePoint> points;
  std::vector<Eigen::Vector3d> places;
};

Row row_of(const Strip& strip, std::size_t index, int columns) {
  const BladePose& pose = strip.poses[index];
  const auto [s0, s1] = *pose.foam;
  Row row{index, false, elastica::sample(elastica::segment(pose.blade, s0, s1), columns), {}};
  row.places.reserve(row.points.size());
  for (const auto& point : row.points) row.places.push_back(pose.frame.point(point.x, point.y));
  return row;
}

double largest_move(const Row& a, const Row& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.places.size(); ++i) most = std::max(most, (a.places[i] - b.places[i]).norm());
  return most;
}

int columns_of(const Strip& strip) {
  double longest = 0;
  for (const BladePose& pose : strip.poses) {
    if (pose.foam) longest = std::max(longest, (*pose.foam)[1] - (*pose.foam)[0]);
  }
  return std::clamp(static_cast<int>(std::ceil(longest / kColumnMm)), 16, 400) + 1;
}

class GridBuilder {
 public:
  void add_strip(const Strip& strip, int index) {
    strip_ = index;
    columns_ = columns_of(strip);
    Row previous;
    bool joined = false;  // the pose before was in the foam as well
    for (std::size_t i = 0; i < strip.poses.size(); ++i) {
      if (!strip.poses[i].foam) {
        joined = false;
        continue;
      }
      Row row = row_of(strip, i, columns_);
      const bool ends = i + 1 == strip.poses.size() || !strip.poses[i + 1].foam;
      if (joined && !ends && largest_move(previous, row) < kRowMm) continue;
      add_row(strip, row, joined ? &previous : nullptr);
      row.starts = !joined;
      previous = std::move(row);
      joined = true;
    }
  }

  [[nodiscard]] CutGrid take() { return std::move(grid_); }

 private:
  void add_row(const Strip& strip, const Row& row, const Row* previous) {
    const int first = static_cast<int>(grid_.surface.vertices.size());
    const BladePose& pose = strip.poses[row.pose];
    for (std::size_t i = 0; i < row.places.size(); ++i) {
      grid_.surface.vertices.push_back(row.places[i]);
      grid_.surface.strip_of_vertex.push_back(strip_);
      grid_.curvature_per_mm.push_back(std::abs(row.points[i].kappa));
      grid_.margin.push_back(pose.margin);
      grid_.feed_mm_s.push_back(previous ? feed(strip, row, *previous, i) : 0);
    }
    if (!previous) return;
    if (previous->starts) copy_feed_to_row_before(first);
    for (int i = first; i + 1 < first + columns_; ++i) {
      const int below = i - columns_;
      grid_.surface.triangles.push_back({below, below + 1, i + 1});
      grid_.surface.triangles.push_back({below, i + 1, i});
    }
  }

  // Feed is measured between rows; the first row takes the second one's.
  void copy_feed_to_row_before(int first) {
    const auto row = grid_.feed_mm_s.begin() + first;
    std::copy(row, row + columns_, row - columns_);
  }

  static double feed(const Strip& strip, const Row& row, const Row& previous, std::size_t i) {
    return (row.places[i] - previous.places[i]).norm() /
           (strip.poses[row.pose].t - strip.poses[previous.pose].t);
  }

  CutGrid grid_;
  int strip_ = 0, columns_ = 0;
};

}  // namespace

CutGrid cut_grid(const Program& program) {
  GridBuilder builder;
  for (std::size_t i = 0; i < program.strips.size(); ++i) {
    builder.add_strip(program.strips[i], static_cast<int>(i));
  }
  return builder.take();
}

}  // namespace hotblade::pipeline::preview
