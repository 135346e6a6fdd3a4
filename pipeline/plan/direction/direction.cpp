#include "pipeline/plan/direction/direction.hpp"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "pipeline/plan/direction/body_axes.hpp"
#include "pipeline/plan/direction/fan_axes.hpp"

namespace hotblade::pipeline {

namespace {

using Eigen::Vector3d;

// A direction nearly along a straight border is worse than the one along it: its first rib is a sliver.
constexpr double kSame = 0.99;    // within 8 degrees
constexpr double kBeside = 0.98;  // within 11 degrees, over half of the hemisphere's steps

bool nearly_along(const Vector3d& n, const std::vector<Vector3d>& borders, double cosine) {
  return std::any_of(borders.begin(), borders.end(),
                     [&](const Vector3d& m) { return std::abs(m.dot(n)) > cosine; });
}

// Directions whose planes hold a side of the border: exactly where that lies in a plane, else as seen along
// the body's narrowest axis.
std::vector<Vector3d> border_directions(const surface::TriangleMesh& mesh, const BodyAxes& body,
                                        const std::vector<BorderRun>& sides) {
  std::vector<Vector3d> directions;
  for (const BorderRun& side : sides) {
    const auto plane = is_straight(side) ? std::nullopt : plane_of(side);
    if (plane && !nearly_along(plane->n, directions, kSame)) directions.push_back(plane->n);
  }
  for (const Vector3d& n : along_borders(mesh, body)) {
    if (!nearly_along(n, directions, kBeside)) directions.push_back(n);
  }
  return directions;
}

std::vector<Vector3d> candidate_directions(const surface::DesignSurface& design, const BodyAxes& body,
                                           const std::vector<Vector3d>& borders) {
  std::vector<Vector3d> candidates = borders, free = hemisphere(body);
  if (const auto n = least_steep(design.mesh)) free.push_back(*n);
  for (const Vector3d& n : free) {
    if (!nearly_along(n, borders, kBeside)) candidates.push_back(n);
  }
  for (Vector3d& n : candidates) n = with_sense(design.mesh, body, n);
  return candidates;
}

// The trial of an axis that a fan can be cut about; nothing where planes hardly turn or the blade would be
// too slow near the axis.
std::optional<DirectionTrial> try_axis(const surface::DesignSurface& design, const surface::FanAxis& axis,
                                       const Settings& settings) {
  constexpr double kLeastTurnRad = 0.1;  // planes tilted by 3 degrees at both ends are as good as parallel
  try {
    const surface::PlaneFamily planes = fan_about(design.mesh, axis);
    double least = planes.radius_mm(), low = 0, high = 0;
    for (const Vector3d& p : design.mesh.vertices()) {
      const double angle = planes.angle(planes.offset(p));
      low = std::min(low, angle);
      high = std::max(high, angle);
      least = std::min(least, planes.distance_from_axis(p));
    }
    const bool too_slow =
        least * settings.motion.feed_mm_s < planes.radius_mm() * settings.motion.min_feed_mm_s;
    if (high - low < kLeastTurnRad || too_slow) return std::nullopt;
    return try_fan(design, axis, settings);
  } catch (const surface::FanError&) {
    return std::nullopt;  // it runs through the design
  }
}

// Trials on their way to a ranking.
class Search {
 public:
  Search(const surface::DesignSurface& design, const Settings& settings, DirectionSearch search,
         const WatchDirections& watch)
      : design_(design),
        settings_(settings),
        search_(search),
        watch_(watch),
        body_(body_axes(design.mesh)),
        sides_(long_sides(design.mesh)),
        borders_(border_directions(design.mesh, body_, sides_)) {}

  std::vector<DirectionScore> run() {
    const std::vector<Vector3d> directions = candidate_directions(design_, body_, borders_);
    const std::vector<surface::FanAxis> axes = fan_axes(design_.mesh, body_, sides_);
    plan(directions, axes);
    refine();
    const std::size_t first = best();
    std::rotate(planned_.begin(), planned_.begin() + static_cast<std::ptrdiff_t>(first),
                planned_.begin() + static_cast<std::ptrdiff_t>(first) + 1);
    std::stable_sort(planned_.begin() + 1, planned_.end(), by_score);
    std::stable_sort(estimated_.begin(), estimated_.end(), by_score);
    planned_.insert(planned_.end(), estimated_.begin(), estimated_.end());
    return std::move(planned_);
  }

 private:
  // Differences of a coarse plan's score that are less come from where its few sections lie, and from
  // rounding in a turned design: the candidate that was named first is taken then.
  static constexpr double kNoise = 0.05;

  static bool by_score(const DirectionScore& a, const DirectionScore& b) { return a.score < b.score; }

  [[nodiscard]] double best_score() const {
    return std::min_element(planned_.begin(), planned_.end(), by_score)->score;
  }

  // The first candidate as good as the best of the planned ones.
  [[nodiscard]] std::size_t best() const {
    const double most = best_score() + kNoise;
    std::size_t first = planned_.size();
    for (std::size_t i = 0; i < planned_.size(); ++i) {
      if (planned_[i].score <= most && (first == planned_.size() || order_[i] < order_[first])) first = i;
    }
    return first;
  }

  // Plans trials in the order of their bounds, as long as they may be as good as the best plan; plans are
  // given up where they take too many strips for that.
  void plan(const std::vector<Vector3d>& directions, const std::vector<surface::FanAxis>& axes) {
    std::vector<std::optional<DirectionTrial>> trials(directions.size() + axes.size());
    tbb::parallel_for(std::size_t{0}, trials.size(), [&](std::size_t i) {
      watch_();
      trials[i] = i < directions.size() ? try_direction(design_, directions[i], settings_)
                                        : try_axis(design_, axes[i - directions.size()], settings_);
    });
    std::vector<std::size_t> queue;
    for (std::size_t i = 0; i < trials.size(); ++i) {
      if (trials[i]) queue.push_back(i);
    }
    std::stable_sort(queue.begin(), queue.end(), [&](std::size_t a, std::size_t b) {
      return by_score(trials[a]->score, trials[b]->score);
    });
    const bool all = search_ == DirectionSearch::kAll;
    for (const std::size_t i : queue) {
      watch_();
      const double most =
          all || planned_.empty() ? std::numeric_limits<double>::infinity() : best_score() + kNoise;
      const DirectionScore score = plan_coarsely(*trials[i], settings_, most);
      (score.estimated ? estimated_ : planned_).push_back(score);
      if (!score.estimated) order_.push_back(named_ + i);
    }
    named_ += trials.size();
  }

  // Planes tilted along the sweep are parallel planes of another direction: small tilts of the best one are
  // tried to both sides about the body's axes, smaller and smaller ones.
  void refine() {
    for (const double degrees : {8.0, 4.0, 2.0}) {
      const DirectionScore from = planned_[best()];
      if (from.fan) return;
      Vector3d across = body_.axes[0];
      for (const Vector3d& axis : body_.axes) {
        if (std::abs(axis.dot(from.normal)) < std::abs(across.dot(from.normal))) across = axis;
      }
      const Vector3d u = from.normal.cross(across).normalized(), v = from.normal.cross(u);
      std::vector<Vector3d> tilted;
      for (const Vector3d& axis : {u, v}) {
        for (const double side : {-1.0, 1.0}) {
          const double angle = side * degrees * std::numbers::pi / 180;
          const Vector3d n = Eigen::AngleAxisd(angle, axis) * from.normal;
          if (!nearly_along(n, borders_, kBeside)) tilted.push_back(n);
        }
      }
      plan(tilted, {});
    }
  }

  const surface::DesignSurface& design_;
  const Settings& settings_;
  DirectionSearch search_;
  const WatchDirections& watch_;
  BodyAxes body_;
  std::vector<BorderRun> sides_;
  std::vector<Vector3d> borders_;  // directions along its sides
  std::vector<DirectionScore> planned_, estimated_;
  std::vector<std::size_t> order_;  // in which the planned ones were named
  std::size_t named_ = 0;
};

}  // namespace

std::vector<DirectionScore> rank_directions(const surface::DesignSurface& design, const Settings& settings,
                                            DirectionSearch search, const WatchDirections& watch) {
  if (settings.slice.fan_axis) {
    const auto& a = *settings.slice.fan_axis;
    return {try_fan(design, {{a[0], a[1], a[2]}, {a[3], a[4], a[5]}}, settings).score};
  }
  if (settings.slice.direction) {
    const auto& d = *settings.slice.direction;
    return {try_direction(design, Vector3d(d[0], d[1], d[2]).normalized(), settings).score};
  }
  return Search(design, settings, search, watch).run();
}

std::optional<std::size_t> next_direction(const std::vector<DirectionScore>& ranking) {
  for (std::size_t i = 0; i < ranking.size(); ++i) {
    const bool known = std::any_of(ranking.begin(), ranking.end(), [&](const DirectionScore& other) {
      if (other.refused.empty()) return false;
      const bool same_kind = ranking[i].fan.has_value() == other.fan.has_value();
      return same_kind && nearly_along(ranking[i].normal, {other.normal}, kSame);
    });
    if (!known && !ranking[i].estimated) return i;
  }
  return std::nullopt;
}

}  // namespace hotblade::pipeline
