#include "pipeline/verify/blade_speeds.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "elastica/blade/blade_batch.hpp"

namespace hotblade::pipeline {

namespace {

// Speeds change over the blade's length and over tens of millimetres of the cut.
constexpr std::size_t kColumns = 25;
constexpr double kRowsMm = 3;

// Even points of the part in foam, of each pose.
elastica::PartPlaces points_in_foam(const std::vector<const BladePose*>& poses) {
  std::vector<elastica::Elastica> blades;
  std::vector<elastica::Part> parts;
  for (const BladePose* pose : poses) {
    blades.push_back(pose->blade);
    parts.push_back({(*pose->foam)[0], (*pose->foam)[1]});
  }
  return elastica::sample_places(blades, parts, kColumns);
}

}  // namespace

double speed_across(const Eigen::Vector3d& before, const Eigen::Vector3d& after, double seconds,
                    const Eigen::Vector3d& tangent) {
  if (!(seconds > 0)) return 0;
  const Eigen::Vector3d along = tangent.stableNormalized(), moved = after - before;
  return (moved - along.dot(moved) * along).norm() / seconds;
}

BladeSpeeds::BladeSpeeds(const std::vector<BladePose>& poses) {
  std::vector<const BladePose*> in_foam, kept;
  for (const BladePose& pose : poses) {
    if (pose.foam) in_foam.push_back(&pose);
  }
  if (in_foam.size() < 2) return;
  const elastica::PartPlaces all = points_in_foam(in_foam);
  const auto point = [&](std::size_t row, std::size_t column) -> Eigen::Vector3d {
    const Eigen::Vector2d q = all.at(row, column);
    return in_foam[row]->frame.point(q.x(), q.y());
  };
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < in_foam.size(); ++i) {
    double moved = rows.empty() ? std::numeric_limits<double>::infinity() : 0;
    for (std::size_t j = 0; j < kColumns && !rows.empty(); j += (kColumns - 1) / 2)
      moved = std::max(moved, (point(i, j) - point(rows.back(), j)).norm());
    if (moved >= kRowsMm) rows.push_back(i);
  }
  if (rows.back() + 1 < in_foam.size()) rows.push_back(in_foam.size() - 1);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const std::size_t i = rows[k], before = rows[k > 0 ? k - 1 : 0],
                      after = rows[std::min(k + 1, rows.size() - 1)];
    const Frame& frame = in_foam[i]->frame;
    Row row{frame.origin, frame.x, frame.normal(), {}};
    for (std::size_t j = 0; j < kColumns; ++j) {
      const Eigen::Vector3d along = point(i, std::min(j + 1, kColumns - 1)) - point(i, j > 0 ? j - 1 : 0);
      row.places.push_back(
          {all.at(i, j).x(),
           speed_across(point(before, j), point(after, j), in_foam[after]->t - in_foam[before]->t, along),
           point(i, j)});
    }
    std::sort(row.places.begin(), row.places.end(),
              [](const Place& a, const Place& b) { return a.x_mm < b.x_mm; });
    rows_.push_back(std::move(row));
  }
}

double BladeSpeeds::Row::ahead(const Eigen::Vector3d& p) const {
  return (p - origin).dot(normal);
}

double BladeSpeeds::Row::aside(const Eigen::Vector3d& p) const {
  const double at_mm = (p - origin).dot(x);
  return std::max({0.0, places.front().x_mm - at_mm, at_mm - places.back().x_mm});
}

double BladeSpeeds::Row::at(const Eigen::Vector3d& p) const {
  const double at_mm = (p - origin).dot(x);
  const auto after =
      std::find_if(places.begin(), places.end(), [&](const Place& place) { return place.x_mm > at_mm; });
  if (after == places.begin()) return places.front().speed_mm_s;
  if (after == places.end()) return places.back().speed_mm_s;
  const Place &low = *(after - 1), &high = *after;
  return low.speed_mm_s + (at_mm - low.x_mm) / (high.x_mm - low.x_mm) * (high.speed_mm_s - low.speed_mm_s);
}

double BladeSpeeds::at(const Eigen::Vector3d& point) const {
  if (empty()) throw std::logic_error("BladeSpeeds: fewer than two poses form the design");
  // Between poses on either side of the point. Planes that turn far meet it once more behind their axis,
  // where no blade is.
  double nearest = std::numeric_limits<double>::infinity(), speed = 0;
  double before = rows_.front().ahead(point);
  for (std::size_t i = 0; i + 1 < rows_.size(); ++i) {
    const Row &row = rows_[i], &next = rows_[i + 1];
    const double after = next.ahead(point);
    const double here = std::exchange(before, after);
    if ((here > 0) == (after > 0)) continue;
    const double aside = std::min(row.aside(point), next.aside(point));
    if (!(aside < nearest)) continue;
    nearest = aside;
    const double t = std::abs(here) / (std::abs(here) + std::abs(after));
    speed = (1 - t) * row.at(point) + t * next.at(point);
  }
  if (std::isfinite(nearest)) return speed;
  const bool first = std::abs(rows_.front().ahead(point)) <= std::abs(rows_.back().ahead(point));
  return (first ? rows_.front() : rows_.back()).at(point);
}

std::pair<double, double> BladeSpeeds::range() const {
  double slowest = std::numeric_limits<double>::infinity(), fastest = 0;
  for_each([&](const Eigen::Vector3d&, double speed_mm_s) {
    slowest = std::min(slowest, speed_mm_s);
    fastest = std::max(fastest, speed_mm_s);
  });
  return {slowest, fastest};
}

}  // namespace hotblade::pipeline
