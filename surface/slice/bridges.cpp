#include "surface/slice/bridges.hpp"

#include <algorithm>
#include <boost/pending/disjoint_sets.hpp>
#include <map>
#include <numeric>
#include <optional>

namespace hotblade::surface {
namespace {

const SectionPiece& piece_of(const RibGraph& graph, const RibRef& ref) {
  return graph.sections[static_cast<std::size_t>(ref.section)].pieces[static_cast<std::size_t>(ref.piece)];
}

// Chord of the last `within_mm` of a piece before its end, or after its start.
Eigen::Vector3d end_chord(const SectionPiece& piece, bool at_start, double within_mm) {
  const auto& points = piece.points;
  const std::size_t count = points.size();
  const auto at = [&](std::size_t i) { return points[at_start ? i : count - 1 - i].p; };
  std::size_t i = 1;
  while (i + 1 < count && (at(i) - at(0)).norm() < within_mm) ++i;
  return at_start ? Eigen::Vector3d(at(i) - at(0)) : Eigen::Vector3d(at(0) - at(i));
}

// Does the way from the end of one piece to the start of the next go on in the direction of both?
bool goes_on(const SectionPiece& before, const SectionPiece& after, double spacing_mm) {
  constexpr double kCosine = 0.5;  // 60 degrees
  const Eigen::Vector3d gap = after.points.front().p - before.points.back().p;
  const double within = std::max(spacing_mm, 0.5 * gap.norm());
  const auto ahead = [&](const Eigen::Vector3d& chord) {
    return gap.dot(chord) > kCosine * gap.norm() * chord.norm();
  };
  return gap.norm() > 0 && ahead(end_chord(before, false, within)) && ahead(end_chord(after, true, within));
}

// The pieces of a section one after the other, or nothing.
std::optional<std::vector<RibRef>> in_order(const RibGraph& graph, std::vector<RibRef> refs,
                                            double spacing_mm) {
  const auto chord = [&](const RibRef& ref) -> Eigen::Vector3d {
    const auto& points = piece_of(graph, ref).points;
    return points.back().p - points.front().p;
  };
  Eigen::Vector3d along = Eigen::Vector3d::Zero();
  for (const RibRef& ref : refs) along += chord(ref);
  std::sort(refs.begin(), refs.end(), [&](const RibRef& a, const RibRef& b) {
    return along.dot(piece_of(graph, a).points.front().p) < along.dot(piece_of(graph, b).points.front().p);
  });
  for (const RibRef& ref : refs) {
    if (!(along.dot(chord(ref)) > 0)) return std::nullopt;
  }
  for (std::size_t i = 1; i < refs.size(); ++i) {
    if (!goes_on(piece_of(graph, refs[i - 1]), piece_of(graph, refs[i]), spacing_mm)) return std::nullopt;
  }
  return refs;
}

// Do the outer ends move no faster than a border at 60 degrees to the planes?
bool ends_match(const RibGraph& graph, const std::vector<RibRef>& below, const std::vector<RibRef>& above,
                double spacing_mm) {
  const double most = 2 * spacing_mm;
  const auto near = [&](const SectionPoint& a, const SectionPoint& b) { return (a.p - b.p).norm() <= most; };
  return near(piece_of(graph, below.front()).points.front(), piece_of(graph, above.front()).points.front()) &&
         near(piece_of(graph, below.back()).points.back(), piece_of(graph, above.back()).points.back());
}

std::optional<Bridge> bridge_over(const RibGraph& graph, const std::vector<int>& chains, double spacing_mm) {
  std::map<int, std::vector<RibRef>> sections;
  for (const int c : chains) {
    for (const RibRef& ref : graph.chains[static_cast<std::size_t>(c)].ribs)
      sections[ref.section].push_back(ref);
  }
  Bridge bridge{chains, {}};
  int previous = sections.begin()->first - 1;
  for (const auto& [section, refs] : sections) {
    auto rib = in_order(graph, refs, spacing_mm);
    if (!rib || section != previous + 1) return std::nullopt;
    if (!bridge.ribs.empty() && !ends_match(graph, bridge.ribs.back(), *rib, spacing_mm)) return std::nullopt;
    bridge.ribs.push_back(std::move(*rib));
    previous = section;
  }
  return bridge;
}

}  // namespace

std::vector<Bridge> find_bridges(const RibGraph& graph, std::span<const std::array<int, 2>> joined,
                                 double spacing_mm) {
  std::vector<std::size_t> all(graph.chains.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  boost::disjoint_sets_with_storage<> sets(all.size());
  for (const std::size_t c : all) sets.make_set(c);
  for (const auto& [a, b] : joined) sets.union_set(static_cast<std::size_t>(a), static_cast<std::size_t>(b));
  sets.normalize_sets(all.begin(), all.end());  // each set by its lowest chain
  std::map<std::size_t, std::vector<int>> together;
  for (const std::size_t c : all) together[sets.find_set(c)].push_back(static_cast<int>(c));
  std::vector<Bridge> bridges;
  for (const auto& [first, chains] : together) {
    if (chains.size() < 2) continue;
    if (auto bridge = bridge_over(graph, chains, spacing_mm)) bridges.push_back(std::move(*bridge));
  }
  return bridges;
}

}  // namespace hotblade::surface
