#include "surface/slice/slice.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <tuple>

#include "surface/read/place_text.hpp"
#include "surface/slice/bridges.hpp"
#include "surface/slice/end_planes.hpp"
#include "surface/slice/event_planes.hpp"
#include "surface/slice/rib_links.hpp"
#include "surface/slice/ring.hpp"
#include "surface/slice/section_march.hpp"

namespace hotblade::surface {
namespace {

// More planes than this are a slip in the options: a 10 m part at 0.1 mm.
constexpr double kMostPlanes = 100'000;

void check(const DesignSurface& design, const SliceOptions& options) {
  if (!design.health.blockers.empty()) {
    throw std::logic_error("slice: the design cannot be sliced: " + design.health.blockers.front());
  }
  if (design.mesh.triangles().empty()) throw std::logic_error("slice: the design has no faces");
  if (options.fan && !(options.fan->point.allFinite() && options.fan->direction.allFinite() &&
                       options.fan->direction.norm() > 0)) {
    throw std::logic_error("slice: the fan's axis must be finite and its direction not zero");
  }
  if (!options.normal.allFinite() || !(options.normal.norm() > 0)) {
    throw std::logic_error("slice: the plane normal must be finite and not zero");
  }
  if (!std::isfinite(options.spacing_mm) || options.spacing_mm <= 0) {
    throw std::logic_error("slice: spacing_mm must be finite and greater than 0");
  }
  if (!std::isfinite(options.end_inset_mm) || options.end_inset_mm < 0) {
    throw std::logic_error("slice: end_inset_mm must be finite and not less than 0");
  }
  if (!std::isfinite(options.min_piece_mm) || options.min_piece_mm < 0) {
    throw std::logic_error("slice: min_piece_mm must be finite and not less than 0");
  }
}

// In-plane axes: u is level (or along x for level planes), v = normal x u.
std::array<Eigen::Vector3d, 2> plane_axes(const Eigen::Vector3d& normal) {
  constexpr double kNearlyUpright =
      0.9;  // far from both ends of the choice: any value between 0.7 and 1 would do
  const Eigen::Vector3d up =
      std::abs(normal.z()) > kNearlyUpright ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d u = up.cross(normal).normalized();
  return {u, normal.cross(u)};
}

std::vector<double> spread_planes(double low, double high, double spacing_mm) {
  if (!(high > low)) return {};
  const double steps = std::max(1.0, std::ceil((high - low) / spacing_mm));
  if (steps >= kMostPlanes) {
    throw std::logic_error("slice: too many planes (" + std::to_string(steps + 1) +
                           ", limit 100000): make spacing_mm larger");
  }
  std::vector<double> offsets;
  for (double k = 0; k <= steps; ++k) offsets.push_back(low + (high - low) * (k / steps));
  offsets.back() = high;
  return offsets;
}

// Loops become two pieces, so they must be twice as long.
bool too_short(const SectionPiece& piece, double min_piece_mm) {
  return piece.length_mm < (piece.closed ? 2 * min_piece_mm : min_piece_mm);
}

// Sections at either end of the design that have a short piece only, which is open: as many as there are up
// to the first longer one.
std::array<std::size_t, 2> tips(const std::vector<std::vector<MarchedPiece>>& sections, double min_piece_mm) {
  const auto is_tip = [&](const std::vector<MarchedPiece>& pieces) {
    return pieces.size() == 1 && !pieces[0].piece.closed && too_short(pieces[0].piece, min_piece_mm);
  };
  const auto first = std::find_if_not(sections.begin(), sections.end(), is_tip);
  const auto last = std::find_if_not(sections.rbegin(), sections.rend(), is_tip);
  return {static_cast<std::size_t>(first - sections.begin()),
          static_cast<std::size_t>(last - sections.rbegin())};
}

void drop_short_pieces(std::vector<std::vector<MarchedPiece>>& sections, const PlaneFamily& planes,
                       const std::vector<double>& offsets, const SliceOptions& options,
                       std::vector<std::string>& warnings) {
  constexpr std::size_t kShown = 20;
  std::size_t dropped = 0;
  const auto kept = options.keep_tips ? tips(sections, options.min_piece_mm) : std::array<std::size_t, 2>{};
  for (std::size_t k = kept[0]; k + kept[1] < sections.size(); ++k) {
    std::erase_if(sections[k], [&](const MarchedPiece& m) {
      const double limit = (m.piece.closed ? 2 : 1) * options.min_piece_mm;
      if (!too_short(m.piece, options.min_piece_mm)) return false;
      if (++dropped > kShown) return true;
      char text[200];
      std::snprintf(text, sizeof text, "section %zu (%s): piece too short (%.3f mm, limit %.3f mm)", k,
                    planes.describe(offsets[k]).c_str(), m.piece.length_mm, limit);
      warnings.push_back(text + (" near " + place_text(m.piece.points.front().p)) + ": dropped");
      return true;
    });
  }
  if (dropped > kShown) warnings.push_back(std::to_string(dropped - kShown) + " more short pieces dropped");
}

// Does this piece start at its end with the smaller coordinate along u, or along v where u does not tell?
bool runs_forward(const SectionPiece& piece, const Eigen::Vector3d& u, const Eigen::Vector3d& v) {
  const Eigen::Vector3d chord = piece.points.back().p - piece.points.front().p;
  // Less is rounding of coordinates, and may not decide.
  constexpr double kAcross = 1e-9;
  const double along = chord.dot(u);
  return std::abs(along) > kAcross * piece.length_mm ? along > 0 : chord.dot(v) >= 0;
}

class Graph {
 public:
  // u, v span the plane at offset 0.
  Graph(std::vector<RibNode> nodes, const PlaneFamily& planes, const std::vector<double>& offsets,
        const Eigen::Vector3d& u, const Eigen::Vector3d& v, double spacing_mm)
      : nodes_(std::move(nodes)), planes_(planes), offsets_(offsets), u_(u), v_(v), spacing_mm_(spacing_mm) {}

  RibGraph build() {
    turn_chains();
    RibGraph graph;
    graph.planes = planes_;
    for (const double offset : offsets_) graph.sections.push_back({offset, {}});
    const std::vector<std::size_t> order = ordered();
    std::vector<RibRef> place(nodes_.size());
    std::vector<int> chain_of(nodes_.size());
    for (const std::size_t n : order) {
      auto& pieces = graph.sections[static_cast<std::size_t>(nodes_[n].section)].pieces;
      place[n] = {nodes_[n].section, static_cast<int>(pieces.size())};
      pieces.push_back(std::move(nodes_[n].piece));
    }
    for (const std::size_t n : order) {
      if (nodes_[n].previous != RibNode::kNone) continue;
      Chain& chain = graph.chains.emplace_back();
      for (int m = static_cast<int>(n); m != RibNode::kNone; m = nodes_[static_cast<std::size_t>(m)].next) {
        chain.ribs.push_back(place[static_cast<std::size_t>(m)]);
        chain_of[static_cast<std::size_t>(m)] = static_cast<int>(graph.chains.size()) - 1;
      }
    }
    graph.bridges = find_bridges(graph, joined(chain_of), spacing_mm_);
    return graph;
  }

 private:
  // The pieces of a chain have one sense already, that of the surface; the first one decides which.
  void turn_chains() {
    for (const RibNode& first : nodes_) {
      if (first.previous != RibNode::kNone ||
          runs_forward(first.piece, in_plane(u_, first), in_plane(v_, first)))
        continue;
      int n = static_cast<int>(&first - nodes_.data());
      for (; n != RibNode::kNone; n = nodes_[static_cast<std::size_t>(n)].next) {
        auto& points = nodes_[static_cast<std::size_t>(n)].piece.points;
        std::reverse(points.begin(), points.end());
      }
    }
  }

  // Chains with pieces in neighbouring sections that the same surface lies between.
  [[nodiscard]] std::vector<std::array<int, 2>> joined(const std::vector<int>& chain_of) const {
    std::multimap<std::pair<int, int>, int> below;  // section and surface below it, to chain
    for (std::size_t n = 0; n < nodes_.size(); ++n) {
      if (nodes_[n].surface_below != RibNode::kNone)
        below.insert({{nodes_[n].section, nodes_[n].surface_below}, chain_of[n]});
    }
    std::vector<std::array<int, 2>> pairs;
    for (std::size_t n = 0; n < nodes_.size(); ++n) {
      if (nodes_[n].surface_above == RibNode::kNone) continue;
      const auto [from, to] = below.equal_range({nodes_[n].section + 1, nodes_[n].surface_above});
      for (auto b = from; b != to; ++b) {
        if (b->second != chain_of[n]) pairs.push_back({chain_of[n], b->second});
      }
    }
    return pairs;
  }

  [[nodiscard]] Eigen::Vector3d in_plane(const Eigen::Vector3d& at_zero, const RibNode& node) const {
    return planes_.turned(at_zero, offsets_[static_cast<std::size_t>(node.section)]);
  }

  // By section, then by the pieces' middles along u, then along v.
  [[nodiscard]] std::vector<std::size_t> ordered() const {
    std::vector<std::tuple<int, double, double, double, std::size_t>> keys;
    for (std::size_t n = 0; n < nodes_.size(); ++n) {
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (const SectionPoint& q : nodes_[n].piece.points) sum += q.p;
      sum /= static_cast<double>(nodes_[n].piece.points.size());
      keys.emplace_back(nodes_[n].section, sum.dot(in_plane(u_, nodes_[n])), sum.dot(in_plane(v_, nodes_[n])),
                        nodes_[n].piece.length_mm, n);
    }
    std::sort(keys.begin(), keys.end());
    std::vector<std::size_t> order;
    for (const auto& key : keys) order.push_back(std::get<4>(key));
    return order;
  }

  std::vector<RibNode> nodes_;
  PlaneFamily planes_;
  std::vector<double> offsets_;
  Eigen::Vector3d u_, v_;
  double spacing_mm_;
};

// Short pieces that end a chain: with others as short at the most, each goes on in a longer one to one side
// and in none to the other. By sections, then pieces.
std::vector<char> tips_of_chains(const std::vector<std::vector<MarchedPiece>>& sections, double spacing,
                                 double min_piece_mm) {
  const std::vector<RibNode> nodes = link_pieces(sections, spacing);
  const auto is_short = [&](int n) {
    const SectionPiece& piece = nodes[static_cast<std::size_t>(n)].piece;
    return !piece.closed && too_short(piece, min_piece_mm);
  };
  const auto comes_to_longer = [&](int n, int RibNode::*side) {
    while (n != RibNode::kNone && is_short(n)) n = nodes[static_cast<std::size_t>(n)].*side;
    return n != RibNode::kNone;
  };
  std::vector<char> tips(nodes.size(), 0);
  for (int n = 0; n < static_cast<int>(nodes.size()); ++n) {
    if (!is_short(n)) continue;
    tips[static_cast<std::size_t>(n)] =
        comes_to_longer(n, &RibNode::next) != comes_to_longer(n, &RibNode::previous) ? 1 : 0;
  }
  return tips;
}

// Sections with planes at the chains' ends: of short pieces the chains' tips are kept.
std::vector<RibNode> linked_with_tips(std::vector<std::vector<MarchedPiece>> sections, double spacing,
                                      double min_piece_mm) {
  const std::vector<char> tips = tips_of_chains(sections, spacing, min_piece_mm);
  std::size_t n = 0;
  for (auto& pieces : sections) {
    std::erase_if(pieces, [&](const MarchedPiece& m) {
      const bool tip = tips[n++] != 0;
      return !tip && too_short(m.piece, min_piece_mm);
    });
  }
  return link_pieces(std::move(sections), spacing);
}

std::vector<RibNode> linked_pieces(const TriangleMesh& mesh, const PlaneFamily& planes,
                                   const std::vector<double>& offsets, double spacing,
                                   const SliceOptions& options, std::vector<std::string>& warnings) {
  auto sections = march_sections(mesh, planes, offsets);
  drop_short_pieces(sections, planes, offsets, options, warnings);
  return link_pieces(std::move(sections), spacing);
}

void move_section(Section& section, const PlaneFamily& planes, double offset_mm) {
  for (SectionPiece& piece : section.pieces) move_to_plane(piece, planes, section.offset_mm, offset_mm);
  section.offset_mm = offset_mm;
}

}  // namespace

RibGraph slice(const DesignSurface& design, const SliceOptions& options) {
  check(design, options);
  const PlaneFamily planes =
      options.fan ? fan_about(design.mesh, *options.fan) : parallel_about(design.mesh, options.normal);
  const TriangleMesh opened = planes.closed() ? cut_open(design.mesh, planes) : TriangleMesh{};
  const TriangleMesh& mesh = planes.closed() ? opened : design.mesh;
  const auto [u, v] = plane_axes(planes.normal(0));
  const EndPlanes ends = end_planes(mesh, planes, options);
  std::vector<double> offsets = spread_planes(ends.taken[0], ends.taken[1], options.spacing_mm);
  if (offsets.empty()) {
    RibGraph flat;
    flat.planes = planes;
    flat.warnings.push_back(planes.turns() ? "the design has no extent about the fan's axis: no sections"
                                           : "the design has no extent along the plane normal: no sections");
    return flat;
  }
  const double spacing = offsets[1] - offsets[0];
  std::vector<std::string> warnings;
  std::vector<RibNode> nodes = linked_pieces(mesh, planes, offsets, spacing, options, warnings);
  std::vector<double> all = with_event_planes(mesh, planes, nodes, offsets, options.end_inset_mm);
  if (all.size() > offsets.size()) {
    offsets = std::move(all);
    std::vector<std::string> unsaid;  // short pieces at a border's tips: the even planes have told of others
    nodes = options.keep_tips
                ? linked_with_tips(march_sections(mesh, planes, offsets), spacing, options.min_piece_mm)
                : linked_pieces(mesh, planes, offsets, spacing, options, unsaid);
  }
  cut_loops_open(nodes, planes, offsets, u, v);
  RibGraph graph = Graph(std::move(nodes), planes, offsets, u, v, spacing).build();
  move_section(graph.sections.front(), planes, ends.at[0]);
  move_section(graph.sections.back(), planes, ends.at[1]);
  graph.warnings = std::move(warnings);
  return graph;
}

}  // namespace hotblade::surface
