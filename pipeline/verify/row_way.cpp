#include "pipeline/verify/row_way.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "elastica/blade/blade_batch.hpp"

namespace hotblade::pipeline {

namespace {

using Eigen::Vector3d;

// Places of a blade in space with its tangents there.
struct BladePlaces {
  std::vector<Vector3d> points, tangents;
};

// Of the blade of one pose the places of the part of another one that is in foam.
BladePlaces places_of(const BladePose& pose, const elastica::Part& part, std::size_t columns) {
  const elastica::PartPoints on = elastica::sample_parts({&pose.blade, 1}, {&part, 1}, columns);
  BladePlaces places;
  for (std::size_t j = 0; j < columns; ++j) {
    places.points.push_back(pose.frame.point(on.x[j], on.y[j]));
    places.tangents.push_back(on.cos[j] * pose.frame.x() + on.sin[j] * pose.frame.y());
  }
  return places;
}

// The poses on one side of a row, asked one after the other how far their blades are across that of the row.
class Search {
 public:
  Search(std::span<const BladePose* const> poses, std::size_t row)
      : poses_(poses), row_(row), part_{(*poses[row]->foam)[0], (*poses[row]->foam)[1]} {
    own_ = places_of(*poses[row], part_, kMarks);
  }

  [[nodiscard]] const elastica::Part& part() const { return part_; }

  // The first pose after the row, or before it, that is so far away; none where the strip ends before.
  [[nodiscard]] std::optional<std::size_t> find(bool after, double apart_mm) const {
    // Doubled steps to one that is far enough, then halves: blades move on one way.
    std::size_t near = 0, far = 1;
    const std::size_t most = after ? poses_.size() - 1 - row_ : row_;
    while (far < most && away_mm(at(after, far)) < apart_mm) {
      near = far;
      far *= 2;
    }
    far = std::min(far, most);
    if (far == 0 || away_mm(at(after, far)) < apart_mm) return std::nullopt;
    while (far - near > 1) {
      const std::size_t middle = near + (far - near) / 2;
      (away_mm(at(after, middle)) < apart_mm ? near : far) = middle;
    }
    return at(after, far);
  }

 private:
  static constexpr std::size_t kMarks = 3;

  [[nodiscard]] std::size_t at(bool after, std::size_t steps) const {
    return after ? row_ + steps : row_ - steps;
  }
  [[nodiscard]] double away_mm(std::size_t pose) const {
    const elastica::PartPlaces there =
        elastica::sample_places({&poses_[pose]->blade, 1}, {&part_, 1}, kMarks);
    double away = 0;
    for (std::size_t k = 0; k < kMarks; ++k) {
      const Eigen::Vector2d q = there.at(0, k);
      const Vector3d d = poses_[pose]->frame.point(q.x(), q.y()) - own_.points[k];
      away = std::max(away, (d - own_.tangents[k].dot(d) * own_.tangents[k]).norm());
    }
    return away;
  }

  std::span<const BladePose* const> poses_;
  std::size_t row_;
  elastica::Part part_;
  BladePlaces own_;
};

// The surface's unit normal between two blades at one of their places, to the left of both.
Vector3d normal_between(const BladePlaces& p, const BladePlaces& q, std::size_t j, const Vector3d& left) {
  const Vector3d n = (p.tangents[j] + q.tangents[j]).cross(q.points[j] - p.points[j]).stableNormalized();
  return n.dot(left) < 0 ? -n : n;
}

}  // namespace

Vector3d direction_at(const Vector3d& p, const Vector3d& before, const Vector3d& behind, bool between) {
  const Vector3d u = before - p, v = behind - p;
  const double h = between ? -u.norm() : u.norm(), k = between ? v.norm() : (behind - before).norm() + h;
  if (h == 0 || k == 0 || h == k) return behind - before;
  return (k / h * u - h / k * v) / (k - h);
}

std::optional<RowWay> row_way(std::span<const BladePose* const> poses, std::size_t row, std::size_t columns,
                              double apart_mm) {
  const Search search(poses, row);
  std::optional<std::size_t> before = search.find(false, apart_mm), behind = search.find(true, apart_mm);
  const bool between = before && behind;
  if (!between) {
    // Both on the side that there is, in the order of the sweep.
    const bool after = behind.has_value();
    const std::optional<std::size_t> near = after ? behind : before, far = search.find(after, 2 * apart_mm);
    if (!near || !far || *near == *far) return std::nullopt;
    before = near;
    behind = far;
  }
  const auto left = [](const BladePose& pose, const Vector3d& tangent) -> Vector3d {
    return pose.frame.normal().cross(tangent);
  };
  const BladePlaces own = places_of(*poses[row], search.part(), columns),
                    p = places_of(*poses[*before], search.part(), columns),
                    q = places_of(*poses[*behind], search.part(), columns);
  // The three in the order of the sweep.
  const bool backwards = *behind < row;
  const BladePlaces& first = backwards ? q : between ? p : own;
  const BladePlaces& second = backwards ? p : between ? own : p;
  const BladePlaces& third = backwards ? own : q;
  const auto width = [&](std::size_t pose) -> Vector3d { return poses[pose]->frame.normal(); };
  RowWay way;
  const Vector3d from = width(backwards ? *behind
                              : between ? *before
                                        : row),
                 to = width(backwards ? row : *behind);
  way.width_turn = 0.5 * (to - from);
  for (std::size_t j = 0; j < columns; ++j) {
    const Vector3d direction = direction_at(own.points[j], p.points[j], q.points[j], between);
    way.sweep.push_back(backwards ? Vector3d(-direction) : direction);
    const Vector3d up = left(*poses[row], own.tangents[j]);
    way.step.push_back(0.5 * (third.points[j] - first.points[j]));
    way.turn.push_back(normal_between(second, third, j, up) - normal_between(first, second, j, up));
  }
  return way;
}

}  // namespace hotblade::pipeline
