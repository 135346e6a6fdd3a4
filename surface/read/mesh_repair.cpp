#include "surface/read/mesh_repair.hpp"

#include <OpenMesh/Core/Mesh/Handles.hh>

#include <Eigen/Geometry>
#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <optional>
#include <utility>

#include "surface/read/blocks.hpp"
#include "surface/read/first_of_equals.hpp"
#include "surface/read/half_edges.hpp"
#include "surface/read/needles.hpp"
#include "surface/read/place_text.hpp"
#include "surface/read/polygon.hpp"
#include "surface/read/stitches.hpp"
#include "surface/read/warning.hpp"
#include "surface/read/words.hpp"

namespace hotblade::surface {
namespace {

// For each vertex the first one with exactly its coordinates; -0 and 0 are equal.
std::vector<int> merge_positions(std::vector<Eigen::Vector3d>& positions) {
  for_blocks(positions.size(), kBlock, [&](std::size_t from, std::size_t to) {
    // Turns -0 into 0, so that equal numbers have equal bits.
    for (std::size_t v = from; v < to; ++v) positions[v].array() += 0.0;
  });
  const auto hash = [&](std::size_t v) {
    std::uint64_t h = 0;
    for (const double c : positions[v]) h = stir(h, std::bit_cast<std::uint64_t>(c));
    return h;
  };
  return first_of_equals(
      positions.size(), hash, [&](std::size_t v, std::size_t w) { return positions[v] == positions[w]; },
      Equals::kNear);
}

// For each triangle the first one over the same three vertices.
std::vector<int> match_triangles(const std::vector<std::array<int, 3>>& triangles) {
  const auto sorted = [&](std::size_t f) {
    std::array<int, 3> t = triangles[f];
    std::sort(t.begin(), t.end());
    return t;
  };
  const auto hash = [&](std::size_t f) {
    std::uint64_t h = 0;
    for (const int v : sorted(f)) h = stir(h, static_cast<std::uint64_t>(v));
    return h;
  };
  return first_of_equals(
      triangles.size(), hash, [&](std::size_t f, std::size_t g) { return sorted(f) == sorted(g); },
      Equals::kRare);
}

// The parts of a plain surface, whose triangles at a vertex hang together: as many as its vertices fall into.
std::size_t connected_parts(const TriangleMesh& mesh) {
  // Each vertex refers to a lower one of its part or, the lowest, to itself; what refers to none yet is given
  // the lower root of two that meet, by whichever thread comes first: the roots that are left are the same.
  std::vector<int> lower(mesh.vertices().size());
  std::iota(lower.begin(), lower.end(), 0);
  const auto refers = [&](int v) { return std::atomic_ref<int>(lower[static_cast<std::size_t>(v)]); };
  const auto root = [&](int v) {
    for (int up = refers(v).load(std::memory_order_relaxed); up != v;) {
      // Every other vertex on the way is led past the next one.
      const int next = refers(up).load(std::memory_order_relaxed);
      if (next != up) refers(v).compare_exchange_weak(up, next, std::memory_order_relaxed);
      v = next;
      up = refers(v).load(std::memory_order_relaxed);
    }
    return v;
  };
  const auto join = [&](int v, int w) {
    for (;;) {
      v = root(v);
      w = root(w);
      if (v == w) return;
      if (v < w) std::swap(v, w);
      int own = v;
      if (refers(v).compare_exchange_strong(own, w, std::memory_order_relaxed)) return;
    }
  };
  const auto triangles = mesh.triangles();
  for_blocks(triangles.size(), kBlock, [&](std::size_t from, std::size_t to) {
    for (std::size_t f = from; f < to; ++f) {
      join(triangles[f][0], triangles[f][1]);
      join(triangles[f][1], triangles[f][2]);
    }
  });
  std::size_t parts = 0;
  for (std::size_t v = 0; v < lower.size(); ++v) parts += lower[v] == static_cast<int>(v) ? 1U : 0U;
  return parts;
}

class Repair {
 public:
  Repair(Polygons polygons, std::vector<Eigen::Vector3d> positions, const ReadOptions& options,
         const std::string& name, Health& health)
      : polygons_(std::move(polygons)), options_(options), name_(name), health_(health) {
    soup_.vertices = std::move(positions);
    place_word_ = polygons_.place;
    joined_ = polygons_.joined;
  }

  RepairedMesh run() {
    prepare_triangles();
    TriangleMesh mesh(std::move(soup_));
    report_crowded_edges(mesh);
    turn_to_agree(mesh);
    if (!(options_.stitch_mm > 0)) mention_gaps(mesh);
    if (health_.blockers.empty()) part_touching_sheets(mesh);
    return {mesh, std::move(place_)};
  }

 private:
  const Eigen::Vector3d& at(int v) const { return soup_.vertices[static_cast<std::size_t>(v)]; }
  static const Eigen::Vector3d& at(const TriangleMesh& mesh, int v) {
    return mesh.vertices()[static_cast<std::size_t>(v)];
  }

  // Leaves the triangles that the mesh is made of in soup_.
  void prepare_triangles() {
    const std::vector<int> first = merge_positions(soup_.vertices);
    cut_into_triangles(first);
    if (options_.facing) take_facing(*options_.facing, std::cos(options_.facing_max_rad));
    if (options_.stitch_mm > 0) stitch();
    drop_duplicates();
    take_out_needles();
    drop_unused(first);
  }

  void cut_into_triangles(std::span<const int> first) {
    faces_ = polygons_.faces();
    first_place_ = polygons_.face_place[0];
    if (polygons_.corners.size() == 3 * faces_ && take_triangles(first)) return;
    std::vector<int> corners;
    std::vector<std::array<int, 3>> pieces;
    std::size_t crossing = 0, crossing_place = 0;
    soup_.triangles.reserve(polygons_.faces());
    place_.reserve(polygons_.faces());
    for (std::size_t f = 0; f < polygons_.faces(); ++f) {
      clean_corners(polygons_.face(f), first, corners);
      pieces.clear();
      if (corners.size() >= 3 && !triangulate_polygon(soup_.vertices, corners, pieces) && crossing++ == 0) {
        crossing_place = polygons_.face_place[f];
      }
      // An outline bridged to a hole passes a vertex twice, and an ear may hold both.
      std::erase_if(pieces, [](const auto& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
      soup_.triangles.insert(soup_.triangles.end(), pieces.begin(), pieces.end());
      place_.resize(soup_.triangles.size(), polygons_.face_place[f]);
      if (pieces.empty()) ++health_.degenerate_faces;
    }
    polygons_ = {};  // as large as the mesh, and told
    if (crossing > 0) {
      health_.warnings.push_back(
          text_of(crossing, Warning::kNotSimplePolygon, {std::to_string(crossing_place)}));
    }
  }

  // Takes faces that are triangles already; those whose corners have merged have no area. False, and nothing
  // done, where faces of other numbers of corners are among them.
  bool take_triangles(std::span<const int> first) {
    std::atomic<bool> all = true;
    soup_.triangles.resize(faces_);
    for_blocks(faces_, kBlock, [&](std::size_t from, std::size_t to) {
      for (std::size_t f = from; f < to; ++f) {
        const std::span<const int> face = polygons_.face(f);
        if (face.size() != 3) {
          all = false;
          return;
        }
        for (std::size_t i = 0; i < 3; ++i) soup_.triangles[f][i] = first[static_cast<std::size_t>(face[i])];
      }
    });
    if (!all) {
      soup_.triangles.clear();
      return false;
    }
    place_ = std::move(polygons_.face_place);
    polygons_ = {};  // as large as the mesh, and told
    keep_triangles([this](std::size_t f) { return has_three(f); });
    health_.degenerate_faces += faces_ - soup_.triangles.size();
    return true;
  }

  // The face's corners after merging, without repetitions of a neighbour.
  static void clean_corners(std::span<const int> face, std::span<const int> first,
                            std::vector<int>& corners) {
    corners.clear();
    for (const int c : face) {
      const int v = first[static_cast<std::size_t>(c)];
      if (corners.empty() || corners.back() != v) corners.push_back(v);
    }
    while (corners.size() > 1 && corners.front() == corners.back()) corners.pop_back();
  }

  // The faces that look towards `direction`, before any is turned over.
  void take_facing(const Eigen::Vector3d& direction, double least_cosine) {
    const std::size_t all = soup_.triangles.size();
    keep_triangles([&](std::size_t f) {
      const std::array<int, 3>& t = soup_.triangles[f];
      const Eigen::Vector3d normal = (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0]));
      return normal.dot(direction) >= least_cosine * normal.norm() * direction.norm() && normal.norm() > 0;
    });
    if (soup_.triangles.empty()) {
      throw MeshError(name_ + ": no face looks in the direction of design.facing (" +
                      counted(all, "triangle", "triangles") + "): turn it round or allow a larger angle");
    }
    health_.repairs.push_back("took the " + std::to_string(soup_.triangles.size()) + " of " +
                              std::to_string(all) + " triangles that look in the direction of design.facing");
  }

  template <class Wanted>
  void keep_triangles(const Wanted& wanted) {
    std::vector<char> keeps(soup_.triangles.size());
    std::atomic<bool> all = true;
    for_blocks(keeps.size(), kBlock, [&](std::size_t from, std::size_t to) {
      for (std::size_t f = from; f < to; ++f) keeps[f] = wanted(f) ? 1 : 0;
      if (std::find(keeps.begin() + static_cast<std::ptrdiff_t>(from),
                    keeps.begin() + static_cast<std::ptrdiff_t>(to),
                    0) != keeps.begin() + static_cast<std::ptrdiff_t>(to))
        all = false;
    });
    if (all) return;
    std::size_t kept = 0;
    for (std::size_t f = 0; f < soup_.triangles.size(); ++f) {
      if (keeps[f] == 0) continue;
      soup_.triangles[kept] = soup_.triangles[f];
      place_[kept++] = place_[f];
    }
    soup_.triangles.resize(kept);
    place_.resize(kept);
  }

  // Whether a triangle's corners are three vertices.
  [[nodiscard]] bool has_three(std::size_t f) const {
    const auto& t = soup_.triangles[f];
    return t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
  }

  void mention_gaps(const TriangleMesh& mesh) {
    // Sheets are not drawn so close to each other on purpose.
    constexpr double kGap_mm = 0.1;
    const Stitches found = find_stitches(mesh, kGap_mm);
    if (found.joined == 0) return;
    health_.warnings.push_back(
        text_of(found.joined, Warning::kNearBorder, {decimal(kGap_mm), place_text(at(mesh, found.first))}));
  }

  // Joins borders that almost meet; a face whose corners become one has no area any more.
  void stitch() {
    const Stitches found = find_stitches(TriangleMesh(soup_), options_.stitch_mm);
    if (found.joined == 0) return;
    for (auto& t : soup_.triangles) {
      for (int& v : t) v = found.vertex[static_cast<std::size_t>(v)];
    }
    const std::size_t before = soup_.triangles.size();
    keep_triangles([this](std::size_t f) { return has_three(f); });
    health_.degenerate_faces += before - soup_.triangles.size();
    stitched_ = found.joined;
    health_.repairs.push_back("stitched " + counted(found.joined, "border vertex", "border vertices") +
                              " to another border, moved by at most " + decimal(found.largest_move_mm) +
                              " mm");
  }

  static std::string decimal(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.3g", value);
    return text;
  }

  void take_out_needles() {
    WithoutNeedles clean = remove_needles(soup_.vertices, std::move(soup_.triangles), std::move(place_));
    soup_.triangles = std::move(clean.triangles);
    place_ = std::move(clean.line);
    health_.degenerate_faces += clean.removed;
    if (health_.degenerate_faces > 0) {
      health_.repairs.push_back("dropped " + counted(health_.degenerate_faces, "face", "faces") +
                                " without area");
    }
    if (soup_.triangles.empty()) {
      throw MeshError(place_of(name_, place_word_, first_place_) + "no face has an area (" +
                      counted(faces_, "face", "faces") + "): check the units and export again");
    }
  }

  // Of faces over the same three vertices the first stays, whichever way round the others are.
  void drop_duplicates() {
    const std::vector<int> first = match_triangles(soup_.triangles);
    keep_triangles([&](std::size_t f) { return first[f] == static_cast<int>(f); });
    health_.duplicate_faces = first.size() - soup_.triangles.size();
    if (health_.duplicate_faces == 0) return;
    health_.repairs.push_back("dropped " + counted(health_.duplicate_faces, "face", "faces") +
                              " lying on another with the same corners");
  }

  // Vertices keep their order. Merged ones are said as a repair, ones without a face are counted.
  void drop_unused(std::span<const int> first) {
    std::size_t merged = 0;
    for (std::size_t v = 0; v < first.size(); ++v) merged += first[v] != static_cast<int>(v) ? 1U : 0U;
    std::vector<int> renamed(first.size(), -1);
    for_blocks(soup_.triangles.size(), kBlock, [&](std::size_t from, std::size_t to) {
      for (std::size_t f = from; f < to; ++f)
        for (const int v : soup_.triangles[f])
          std::atomic_ref<int>(renamed[static_cast<std::size_t>(v)]).store(0, std::memory_order_relaxed);
    });
    int kept = 0;
    for (std::size_t v = 0; v < renamed.size(); ++v) {
      if (renamed[v] < 0) continue;
      soup_.vertices[static_cast<std::size_t>(kept)] = soup_.vertices[v];
      renamed[v] = kept++;
    }
    if (static_cast<std::size_t>(kept) < first.size()) {
      rename(renamed);
      for (std::size_t v = 0; v < renamed.size(); ++v)
        if (renamed[v] >= 0) file_number_.push_back(static_cast<int>(v) + 1);
    }
    health_.unused_vertices = first.size() - merged - stitched_ - static_cast<std::size_t>(kept);
    soup_.vertices.resize(static_cast<std::size_t>(kept));
    soup_.vertices.shrink_to_fit();
    if (merged + joined_ > 0) {
      health_.repairs.push_back("merged " + counted(merged + joined_, "vertex", "vertices") +
                                " with another of exactly the same coordinates");
    }
  }

  void rename(std::span<const int> renamed) {
    for_blocks(soup_.triangles.size(), kBlock, [&](std::size_t from, std::size_t to) {
      for (std::size_t f = from; f < to; ++f)
        for (int& v : soup_.triangles[f]) v = renamed[static_cast<std::size_t>(v)];
    });
  }

  void report_crowded_edges(const TriangleMesh& mesh) {
    const HalfEdges::Crowded& crowded = mesh.half_edges().crowded();
    health_.non_manifold_edges = crowded.edges;
    if (crowded.edges == 0) return;
    const auto [a, b] = crowded.first;
    health_.blockers.push_back(counted(crowded.edges, "edge has", "edges have") +
                               " more than two faces, the first with " + std::to_string(crowded.triangles) +
                               " between vertex " + number(a) + " " + place_text(at(mesh, a)) +
                               " and vertex " + number(b) + " " + place_text(at(mesh, b)) +
                               ": part or trim the sheets that meet there");
  }

  std::string number(int v) const {
    return std::to_string(file_number_.empty() ? v + 1 : file_number_[static_cast<std::size_t>(v)]);
  }

  // Do two triangles run round their edge in opposite senses, as triangles of one side do?
  static bool agree(const TriangleMesh& mesh, HalfEdges::Halfedge h, HalfEdges::Halfedge other) {
    const HalfEdges& half_edges = mesh.half_edges();
    if (other == half_edges.mesh().opposite_halfedge_handle(h)) return true;
    return vertex_at(mesh, half_edges.corner_of(h)) != vertex_at(mesh, half_edges.corner_of(other));
  }

  // Spreads a sense from face to face. In each component the sense that turns fewer faces wins.
  void turn_to_agree(TriangleMesh& mesh) {
    if (mesh.half_edges().plain()) {
      health_.components = connected_parts(mesh);
      return;
    }
    std::vector<Sense> sense(mesh.triangles().size(), Sense::kUnseen);
    std::vector<int> component;
    std::size_t turned = 0;
    for (std::size_t seed = 0; seed < sense.size(); ++seed) {
      if (sense[seed] != Sense::kUnseen) continue;
      ++health_.components;
      component.assign(1, static_cast<int>(seed));
      sense[seed] = Sense::kAsIs;
      for (std::size_t k = 0; k < component.size(); ++k) spread_sense(mesh, component[k], sense, component);
      turned += turn_fewer(component, sense);
    }
    if (!health_.orientable || turned == 0) return;
    rebuild(mesh, [&](TriangleSoup& soup) {
      for (std::size_t f = 0; f < sense.size(); ++f) {
        if (sense[f] == Sense::kTurn) std::swap(soup.triangles[f][1], soup.triangles[f][2]);
      }
    });
    health_.repairs.push_back("turned " + counted(turned, "face", "faces") +
                              " over to agree with their neighbours");
  }

  enum class Sense : unsigned char { kUnseen, kAsIs, kTurn };

  static Sense opposite(Sense sense) { return sense == Sense::kAsIs ? Sense::kTurn : Sense::kAsIs; }

  // Gives the neighbours of a triangle that have no sense yet theirs, and adds them to the component.
  void spread_sense(const TriangleMesh& mesh, int f, std::vector<Sense>& sense, std::vector<int>& component) {
    const HalfEdges& half_edges = mesh.half_edges();
    const Sense mine = sense[static_cast<std::size_t>(f)];
    HalfEdges::Halfedge h = half_edges.first(f);
    for (int i = 0; i < 3; ++i, h = half_edges.mesh().next_halfedge_handle(h)) {
      const HalfEdges::Halfedge other = half_edges.across(h);
      if (!other.is_valid()) continue;
      const OpenMesh::FaceHandle beyond = half_edges.mesh().face_handle(other);
      const Sense wanted = agree(mesh, h, other) ? mine : opposite(mine);
      Sense& theirs = sense[static_cast<std::size_t>(beyond.idx())];
      if (theirs == Sense::kUnseen) {
        theirs = wanted;
        component.push_back(beyond.idx());
      } else if (theirs != wanted && health_.orientable) {
        report_moebius(mesh, f, beyond.idx());
      }
    }
  }

  static std::size_t turn_fewer(std::span<const int> component, std::vector<Sense>& sense) {
    const auto count = static_cast<std::size_t>(std::count_if(component.begin(), component.end(), [&](int f) {
      return sense[static_cast<std::size_t>(f)] == Sense::kTurn;
    }));
    if (2 * count <= component.size()) return count;
    for (const int f : component) {
      Sense& s = sense[static_cast<std::size_t>(f)];
      s = opposite(s);
    }
    return component.size() - count;
  }

  void report_moebius(const TriangleMesh& mesh, int face, int other) {
    health_.orientable = false;
    const auto& t = mesh.triangles()[static_cast<std::size_t>(face)];
    const Eigen::Vector3d centre = (at(mesh, t[0]) + at(mesh, t[1]) + at(mesh, t[2])) / 3;
    health_.blockers.push_back("the surface has one side only, like a Moebius strip: the faces of " +
                               std::string(place_word_) + "s " +
                               std::to_string(place_[static_cast<std::size_t>(face)]) + " and " +
                               std::to_string(place_[static_cast<std::size_t>(other)]) + " near " +
                               place_text(centre) + " cannot be made to agree: cut the strip open");
  }

  // Half-edges keep no order when they are changed in place: what changes triangles makes the mesh anew,
  // once.
  template <class Change>
  static void rebuild(TriangleMesh& mesh, const Change& change) {
    TriangleSoup soup = mesh.soup();
    mesh = {};
    change(soup);
    mesh = TriangleMesh(std::move(soup));
  }

  // Gives every fan of faces round a vertex a vertex of its own, at the same place.
  void part_touching_sheets(TriangleMesh& mesh) {
    if (!mesh.half_edges().has_seams()) return;
    const int corners = 3 * static_cast<int>(mesh.triangles().size());
    std::vector<bool> claimed(mesh.vertices().size(), false);
    std::vector<int> own(static_cast<std::size_t>(corners), TriangleMesh::kNone);  // vertex, per corner
    std::vector<int> parted;
    for (int c = 0; c < corners; ++c) {
      if (own[static_cast<std::size_t>(c)] != TriangleMesh::kNone) continue;
      const int v = vertex_at(mesh, c);
      const bool taken = claimed[static_cast<std::size_t>(v)];
      claimed[static_cast<std::size_t>(v)] = true;
      const int fan = taken ? static_cast<int>(mesh.vertices().size() + parted.size()) : v;
      if (taken) parted.push_back(v);
      for (const int member : fan_of(mesh, c)) own[static_cast<std::size_t>(member)] = fan;
    }
    if (parted.empty()) return;
    rebuild(mesh, [&](TriangleSoup& soup) {
      for (const int v : parted)
        soup.vertices.push_back(Eigen::Vector3d(soup.vertices[static_cast<std::size_t>(v)]));
      for (std::size_t c = 0; c < own.size(); ++c) soup.triangles[c / 3][c % 3] = own[c];
    });
    const int shown = parted.front();
    std::sort(parted.begin(), parted.end());
    parted.erase(std::unique(parted.begin(), parted.end()), parted.end());
    health_.non_manifold_vertices = parted.size();
    health_.repairs.push_back("parted the sheets that touch only in a point at " +
                              counted(parted.size(), "vertex", "vertices") + ", the first vertex " +
                              number(shown) + " " + place_text(at(mesh, shown)));
  }

  // The corners at one vertex that are reached from `corner` across edges: round to where it began, or to the
  // border on both sides.
  static std::vector<int> fan_of(const TriangleMesh& mesh, int corner) {
    std::vector<int> fan{corner};
    for (int other = mesh.beyond(corner); other != TriangleMesh::kNone; other = mesh.beyond(fan.back())) {
      if (next_corner(other) == corner) return fan;
      fan.push_back(next_corner(other));
    }
    const auto back = [&](int c) { return mesh.beyond(next_corner(next_corner(c))); };
    for (int c = back(corner); c != TriangleMesh::kNone; c = back(c)) fan.push_back(c);
    return fan;
  }

  Polygons polygons_;  // empty once its polygons are triangles
  std::size_t faces_ = 0;
  std::string_view place_word_;  // what faces are counted by in the file
  std::uint32_t first_place_ = 0;
  const ReadOptions& options_;
  const std::string& name_;
  Health& health_;
  TriangleSoup soup_;                 // empty once it is a mesh
  std::vector<std::uint32_t> place_;  // per triangle
  std::size_t joined_ = 0;            // vertices that the reader had merged
  std::vector<int> file_number_;      // per vertex, before sheets are parted; empty: as they are, from 1
  std::size_t stitched_ = 0;          // vertices
};

}  // namespace

RepairedMesh repair_mesh(Polygons polygons, std::vector<Eigen::Vector3d> positions,
                         const ReadOptions& options, const std::string& name, Health& health) {
  return Repair(std::move(polygons), std::move(positions), options, name, health).run();
}

}  // namespace hotblade::surface
