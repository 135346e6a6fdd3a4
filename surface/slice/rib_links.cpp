#include "surface/slice/rib_links.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <tuple>

namespace hotblade::surface {
namespace {

// Places a piece is compared at: enough to tell the share of its length that is covered to 3 %.
constexpr std::size_t kStations = 32;
// "Most" of the length of a piece.
constexpr double kMost = 0.5;
// Where the surface branches a piece goes on only in one that covers it all but for a sliver.
constexpr double kNearlyAll = 0.9;
// Sheets that are not joined, such as patches with a seam, link at no more than this many plane distances:
// joined sheets that lie askew to the planes by 60 degrees are as far apart.
constexpr double kSeamDistance = 2;
// A station lies beside the other piece when the way there is not much longer than the way back from the
// foot: where a U opposes one of its arms, the way from the other arm is long and the way back short.
constexpr double kThereAndBack = 2;

// How far one piece lies along another: the share of its stations covered, and their mean distance.
struct PieceCover {
  double share = 0, mean_mm = 0;
};

// Stations at the middles of equal lengths.
std::vector<SectionPoint> stations(const SectionPiece& piece) {
  std::vector<SectionPoint> out;
  const std::size_t count = piece.points.size(), edges = piece.closed ? count : count - 1;
  double passed = 0;
  for (std::size_t e = 0; e < edges && out.size() < kStations; ++e) {
    const SectionPoint &a = piece.points[e], &b = piece.points[(e + 1) % count];
    const double length = (b.p - a.p).norm();
    const auto wanted = [&] {
      return piece.length_mm * (static_cast<double>(out.size()) + 0.5) / static_cast<double>(kStations);
    };
    while (out.size() < kStations && wanted() <= passed + length) {
      const double t = (wanted() - passed) / length;
      out.push_back({a.p + t * (b.p - a.p), (1 - t) * a.normal + t * b.normal});
    }
    passed += length;
  }
  return out;
}

struct Foot {
  double distance_sq = std::numeric_limits<double>::infinity();
  std::size_t edge = 0;
  double t = 0;
};

Foot nearest(const SectionPiece& piece, const Eigen::Vector3d& p) {
  Foot best;
  const std::size_t count = piece.points.size(), edges = piece.closed ? count : count - 1;
  for (std::size_t e = 0; e < edges; ++e) {
    const Eigen::Vector3d& a = piece.points[e].p;
    const Eigen::Vector3d along = piece.points[(e + 1) % count].p - a;
    const double t = std::clamp(along.dot(p - a) / along.squaredNorm(), 0.0, 1.0);
    const double distance_sq = (p - a - t * along).squaredNorm();
    if (distance_sq < best.distance_sq) best = {distance_sq, e, t};
  }
  return best;
}

// How far p lies beyond the end of an open piece, measured along it; 0 when its foot is not an end.
double overhang(const SectionPiece& piece, const Foot& foot, const Eigen::Vector3d& p) {
  if (piece.closed) return 0;
  const auto& points = piece.points;
  const bool at_start = foot.edge == 0 && foot.t <= 0, at_end = foot.edge + 2 == points.size() && foot.t >= 1;
  if (!at_start && !at_end) return 0;
  const Eigen::Vector3d& end = at_start ? points.front().p : points.back().p;
  const Eigen::Vector3d& inner = at_start ? points[1].p : points[points.size() - 2].p;
  return (p - end).dot((end - inner).normalized());
}

// A station of `of` is covered when `by` has a point beside it, on a face that looks to the same side, or
// ends less than a plane distance before it: borders may run at 45 degrees.
PieceCover cover(const SectionPiece& of, const std::vector<SectionPoint>& of_stations, const SectionPiece& by,
                 double spacing, double limit) {
  PieceCover result;
  std::size_t covered = 0;
  for (const SectionPoint& station : of_stations) {
    const Foot foot = nearest(by, station.p);
    const SectionPoint &a = by.points[foot.edge], &b = by.points[(foot.edge + 1) % by.points.size()];
    const Eigen::Vector3d normal = (1 - foot.t) * a.normal + foot.t * b.normal;
    if (foot.distance_sq > limit * limit || station.normal.dot(normal) <= 0) continue;
    if (overhang(by, foot, station.p) > spacing) continue;
    const double back_sq = nearest(of, a.p + foot.t * (b.p - a.p)).distance_sq;
    if (foot.distance_sq > kThereAndBack * kThereAndBack * back_sq) continue;
    ++covered;
    result.mean_mm += std::sqrt(foot.distance_sq);
  }
  if (covered > 0) result.mean_mm /= static_cast<double>(covered);
  result.share = static_cast<double>(covered) / static_cast<double>(of_stations.size());
  return result;
}

class Linker {
 public:
  Linker(std::vector<std::vector<MarchedPiece>> sections, double spacing) : spacing_(spacing) {
    for (std::size_t k = 0; k < sections.size(); ++k) {
      first_.push_back(nodes_.size());
      for (MarchedPiece& m : sections[k]) {
        below_.push_back(m.surface_below);
        above_.push_back(m.surface_above);
        stations_.push_back(stations(m.piece));
        nodes_.push_back({static_cast<int>(k), std::move(m.piece), RibNode::kNone, RibNode::kNone,
                          m.surface_below, m.surface_above});
      }
    }
    first_.push_back(nodes_.size());
  }

  std::vector<RibNode> run() {
    for (std::size_t k = 0; k + 2 < first_.size(); ++k) {
      link(k, true);
      link(k, false);
    }
    return std::move(nodes_);
  }

 private:
  // The mean distance of two pieces that may link, or nothing when they may not.
  [[nodiscard]] std::optional<double> match(std::size_t a, std::size_t b, bool joined, bool branches) const {
    const double limit = joined ? std::numeric_limits<double>::infinity() : kSeamDistance * spacing_;
    const PieceCover ab = cover(nodes_[a].piece, stations_[a], nodes_[b].piece, spacing_, limit);
    if (joined && !branches && ab.share >= kMost) return ab.mean_mm;  // the only pair; either side will do
    const PieceCover ba = cover(nodes_[b].piece, stations_[b], nodes_[a].piece, spacing_, limit);
    if (joined && !branches) return ba.share >= kMost ? std::optional(ba.mean_mm) : std::nullopt;
    if (std::min(ab.share, ba.share) < (branches ? kNearlyAll : kMost)) return std::nullopt;
    return (ab.mean_mm * ab.share + ba.mean_mm * ba.share) / (ab.share + ba.share);
  }

  // Links what is still free between section k and the next: by the surface between them first, then by
  // nearness.
  void link(std::size_t k, bool joined) {
    const auto count = [&](const std::vector<int>& surface, std::size_t section, int id) {
      return std::count(surface.begin() + static_cast<std::ptrdiff_t>(first_[section]),
                        surface.begin() + static_cast<std::ptrdiff_t>(first_[section + 1]), id);
    };
    std::map<std::pair<std::size_t, std::size_t>, double> matches;
    for (std::size_t a = first_[k]; a < first_[k + 1]; ++a) {
      if (nodes_[a].next != RibNode::kNone) continue;
      for (std::size_t b = first_[k + 1]; b < first_[k + 2]; ++b) {
        if (nodes_[b].previous != RibNode::kNone || nodes_[a].piece.closed != nodes_[b].piece.closed)
          continue;
        if ((above_[a] == below_[b]) != joined) continue;
        const bool branches =
            joined && (count(above_, k, above_[a]) > 1 || count(below_, k + 1, below_[b]) > 1);
        if (!joined && !may_be_a_seam(a, b, k)) continue;
        if (const auto mean = match(a, b, joined, branches)) matches[{a, b}] = *mean;
      }
    }
    link_mutual_best(matches);
  }

  // Across a seam the surface ends at the one piece and begins at the other: neither goes on between the
  // planes.
  [[nodiscard]] bool may_be_a_seam(std::size_t a, std::size_t b, std::size_t k) const {
    const auto none_in = [&](const std::vector<int>& surface, std::size_t section, int id) {
      const auto from = surface.begin() + static_cast<std::ptrdiff_t>(first_[section]);
      const auto to = surface.begin() + static_cast<std::ptrdiff_t>(first_[section + 1]);
      return std::find(from, to, id) == to;
    };
    return none_in(below_, k + 1, above_[a]) && none_in(above_, k, below_[b]);
  }

  void link_mutual_best(const std::map<std::pair<std::size_t, std::size_t>, double>& matches) {
    std::map<std::size_t, std::pair<double, std::size_t>> best_up, best_down;
    const auto offer = [](auto& best, std::size_t from, double mean, std::size_t to) {
      const auto [place, fresh] = best.try_emplace(from, mean, to);
      if (!fresh && std::pair(mean, to) < place->second) place->second = {mean, to};
    };
    for (const auto& [pair, mean] : matches) {
      offer(best_up, pair.first, mean, pair.second);
      offer(best_down, pair.second, mean, pair.first);
    }
    for (const auto& [a, best] : best_up) {
      const std::size_t b = best.second;
      if (best_down.at(b).second != a) continue;
      nodes_[a].next = static_cast<int>(b);
      nodes_[b].previous = static_cast<int>(a);
    }
  }

  double spacing_;
  std::vector<RibNode> nodes_;
  std::vector<std::size_t> first_;  // of each section, in nodes_, and one past the last
  std::vector<int> below_, above_;
  std::vector<std::vector<SectionPoint>> stations_;
};

// A loop with the directions that span its plane, and a point that all planes share.
struct LoopInPlane {
  const SectionPiece* loop;
  Eigen::Vector3d u, v, centre;
};

// Angle from u to the in-plane direction along which the points reach farthest, to a degree. Later directions
// must be clearly better, so that a circle's cut does not depend on rounding.
double longest_direction(const std::vector<LoopInPlane>& loops) {
  constexpr int kDirections = 180;
  constexpr double kClearly = 1 + 1e-6;
  double best = 0, best_extent = 0;
  for (int i = 0; i < kDirections; ++i) {
    const double angle = i * std::numbers::pi / kDirections;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const LoopInPlane& in : loops) {
      const Eigen::Vector3d d = std::cos(angle) * in.u + std::sin(angle) * in.v;
      for (const SectionPoint& q : in.loop->points) {
        const double along = d.dot(q.p - in.centre);
        low = std::min(low, along);
        high = std::max(high, along);
      }
    }
    if (high - low > best_extent * kClearly) {
      best = angle;
      best_extent = high - low;
    }
  }
  return best;
}

double measure(const std::vector<SectionPoint>& points) {
  double length = 0;
  for (std::size_t i = 1; i < points.size(); ++i) length += (points[i].p - points[i - 1].p).norm();
  return length;
}

// From the loop's least point along d to its greatest, and from there back.
std::array<SectionPiece, 2> halve(const SectionPiece& loop, const Eigen::Vector3d& d) {
  const auto less = [&](const SectionPoint& a, const SectionPoint& b) { return d.dot(a.p) < d.dot(b.p); };
  std::vector<SectionPoint> points = loop.points;
  std::rotate(points.begin(), std::min_element(points.begin(), points.end(), less), points.end());
  const auto far = std::max_element(points.begin(), points.end(), less);
  std::array<SectionPiece, 2> halves;
  halves[0].points.assign(points.begin(), far + 1);
  halves[1].points.assign(far, points.end());
  halves[1].points.push_back(points.front());
  for (SectionPiece& half : halves) half.length_mm = measure(half.points);
  return halves;
}

}  // namespace

std::vector<RibNode> link_pieces(std::vector<std::vector<MarchedPiece>> sections, double spacing_mm) {
  return Linker(std::move(sections), spacing_mm).run();
}

void cut_loops_open(std::vector<RibNode>& nodes, const PlaneFamily& planes, std::span<const double> offsets,
                    const Eigen::Vector3d& u, const Eigen::Vector3d& v) {
  const auto in_plane = [&](const RibNode& node) -> LoopInPlane {
    const double offset = offsets[static_cast<std::size_t>(node.section)];
    return {&node.piece, planes.turned(u, offset), planes.turned(v, offset), planes.centre()};
  };
  const std::size_t count = nodes.size();
  for (std::size_t first = 0; first < count; ++first) {
    if (!nodes[first].piece.closed || nodes[first].previous != RibNode::kNone) continue;
    std::vector<int> stack;
    std::vector<LoopInPlane> loops;
    for (int n = static_cast<int>(first); n != RibNode::kNone; n = nodes[static_cast<std::size_t>(n)].next) {
      stack.push_back(n);
      loops.push_back(in_plane(nodes[static_cast<std::size_t>(n)]));
    }
    const double angle = longest_direction(loops);
    int previous = RibNode::kNone;
    for (const int n : stack) {
      const LoopInPlane in = in_plane(nodes[static_cast<std::size_t>(n)]);
      auto [there, back] = halve(*in.loop, std::cos(angle) * in.u + std::sin(angle) * in.v);
      RibNode& node = nodes[static_cast<std::size_t>(n)];
      node.piece = std::move(there);
      node.surface_below = node.surface_above = RibNode::kNone;
      const int twin = static_cast<int>(nodes.size());
      nodes.push_back({node.section, std::move(back), RibNode::kNone, previous});
      if (previous != RibNode::kNone) nodes[static_cast<std::size_t>(previous)].next = twin;
      previous = twin;
    }
  }
}

}  // namespace hotblade::surface
