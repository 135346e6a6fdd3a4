#include "pipeline/plan/ribs/complete.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "pipeline/plan/ribs/direction_plate.hpp"

namespace hotblade::pipeline {

namespace {

using Eigen::Vector2d;

// Points that stand for a section when sections are aligned, and how many of them are looked for in the next.
constexpr int kCourse = 65, kStations = 17;

// Arc length, along a rib by even points and straight on beyond its ends, of the place nearest to q.
struct Foot {
  double s = 0;
  bool inside = true;
};

Foot foot_of(const std::vector<Vector2d>& course, double length, const Vector2d& q) {
  const std::size_t last = course.size() - 2;
  const double step = length / static_cast<double>(course.size() - 1);
  double nearest = std::numeric_limits<double>::infinity();
  Foot foot;
  for (std::size_t i = 0; i <= last; ++i) {
    const Vector2d edge = course[i + 1] - course[i];
    const double square = edge.squaredNorm();
    if (!(square > 0)) continue;
    const double t = (q - course[i]).dot(edge) / square;
    const double inside = std::clamp(t, i == 0 ? t : 0.0, i == last ? t : 1.0);
    const double away = (q - course[i] - inside * edge).squaredNorm();
    if (!(away < nearest)) continue;
    nearest = away;
    foot = {step * (static_cast<double>(i) + inside), inside >= 0 && inside <= 1};
  }
  return foot;
}

// A section by even points.
struct Course {
  std::vector<Vector2d> points;
  double length = 0;

  explicit Course(const RibTarget& rib) : points(resample(rib, 0, 1, kCourse)), length(rib.s.back()) {}
};

// Where b begins on a's arc length: of the points of the shorter one that lie beside the other, the mean.
double start_on(const Course& a, const Course& b) {
  const bool b_shorter = b.length <= a.length;
  const Course &shorter = b_shorter ? b : a, &longer = b_shorter ? a : b;
  constexpr int kStride = (kCourse - 1) / (kStations - 1);
  double sum = 0, beside = 0, count = 0;
  for (int i = 0; i < kCourse; i += kStride) {
    const Foot foot = foot_of(longer.points, longer.length, shorter.points[static_cast<std::size_t>(i)]);
    const double shift = foot.s - shorter.length * i / (kCourse - 1);
    sum += shift;
    if (!foot.inside) continue;
    beside += shift;
    count += 1;
  }
  const double mean = count > 0 ? beside / count : sum / kStations;
  return b_shorter ? mean : -mean;
}

struct Window {
  double low = 0, high = 0;
  [[nodiscard]] double width() const { return high - low; }
};

Window window_of(std::span<const RibTarget> sections, const std::vector<double>& starts) {
  Window window{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (std::size_t k = 0; k < sections.size(); ++k) {
    window.low = std::min(window.low, starts[k]);
    window.high = std::max(window.high, starts[k] + sections[k].s.back());
  }
  return window;
}

// Turns a difference of directions into one that nears a radian: what bends more strongly at the border would
// curl up in the waste. A third of a radian is cut by a three-hundredth of it.
double limited(double turn) {
  const double square = turn * turn;
  return turn / std::sqrt(std::sqrt(1 + square * square));
}

// Points of the way on from the end of a rib, without that end: to the coordinate `to` from `from`, which
// lies on either side.
std::vector<Vector2d> way_on(const DirectionPlate& plate, double offset_mm, Vector2d p, double from,
                             double to, double width) {
  constexpr double kSteps = 128;  // over the window
  const int steps = static_cast<int>(std::ceil(kSteps * std::abs(to - from) / width));
  const double own = plate.at(from, offset_mm), step = (to - from) / steps;
  std::vector<Vector2d> points;
  for (int i = 0; i < steps; ++i) {
    const double theta = own + limited(plate.at(from + (i + 0.5) * step, offset_mm) - own);
    p += step * Vector2d(std::cos(theta), std::sin(theta));
    points.push_back(p);
  }
  return points;
}

RibTarget completed(const RibTarget& own, double start, const Window& window, const DirectionPlate& plate) {
  // Shorter ways are rounding.
  constexpr double kNoWay = 1e-9;
  const double least = kNoWay * window.width(), end = start + own.s.back();
  RibTarget rib = own;
  rib.own = DesignPart{0, own.s.back()};
  if (start - window.low > least) {
    std::vector<Vector2d> before =
        way_on(plate, own.offset_mm, own.points.front(), start, window.low, window.width());
    std::reverse(before.begin(), before.end());
    const double step = (start - window.low) / static_cast<double>(before.size());
    rib.own = DesignPart{start - window.low, start - window.low + own.s.back()};
    for (double& s : rib.s) s += start - window.low;
    rib.points.insert(rib.points.begin(), before.begin(), before.end());
    std::vector<double> s;
    for (std::size_t i = 0; i < before.size(); ++i) s.push_back(step * static_cast<double>(i));
    rib.s.insert(rib.s.begin(), s.begin(), s.end());
  }
  if (window.high - end > least) {
    const std::vector<Vector2d> behind =
        way_on(plate, own.offset_mm, own.points.back(), end, window.high, window.width());
    const double step = (window.high - end) / static_cast<double>(behind.size()), last = rib.s.back();
    for (std::size_t i = 0; i < behind.size(); ++i) {
      rib.points.push_back(behind[i]);
      rib.s.push_back(last + step * static_cast<double>(i + 1));
    }
  }
  return rib;
}

}  // namespace

std::vector<double> aligned_starts(std::span<const RibTarget> sections) {
  std::vector<Course> courses;
  for (const RibTarget& rib : sections) courses.emplace_back(rib);
  const auto longest = static_cast<std::size_t>(
      std::max_element(courses.begin(), courses.end(),
                       [](const Course& a, const Course& b) { return a.length < b.length; }) -
      courses.begin());
  std::vector<double> starts(sections.size(), 0);
  for (std::size_t k = longest + 1; k < sections.size(); ++k)
    starts[k] = starts[k - 1] + start_on(courses[k - 1], courses[k]);
  for (std::size_t k = longest; k-- > 0;) starts[k] = starts[k + 1] + start_on(courses[k + 1], courses[k]);
  return starts;
}

std::optional<std::vector<RibTarget>> complete_ribs(std::span<const RibTarget> sections) {
  const std::vector<double> starts = aligned_starts(sections);
  const Window window = window_of(sections, starts);
  double shortest = window.width();
  for (const RibTarget& rib : sections) shortest = std::min(shortest, rib.s.back());
  // As wide as this, a rib says enough about its blade; and half rings, which end where a loop was cut open
  // and not at a border, are left to themselves.
  constexpr double kLeastShare = 0.7;
  if (shortest >= kLeastShare * window.width()) return std::nullopt;
  const DirectionPlate plate(sections, starts, {window.low, window.high});
  std::vector<RibTarget> whole;
  for (std::size_t k = 0; k < sections.size(); ++k)
    whole.push_back(completed(sections[k], starts[k], window, plate));
  return whole;
}

}  // namespace hotblade::pipeline
