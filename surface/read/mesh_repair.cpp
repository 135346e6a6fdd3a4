#include "surface/read/mesh_repair.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <numeric>

#include <Eigen/Geometry>

#include "surface/read/face_links.hpp"
#include "surface/read/first_of_equals.hpp"
#include "surface/read/needles.hpp"
#include "surface/read/place_text.hpp"
#include "surface/read/polygon.hpp"
#include "surface/read/stitches.hpp"

namespace hotblade::surface {
namespace {

std::string counted(std::size_t n, const std::string& one, const std::string& many) {
  return std::to_string(n) + " " + (n == 1 ? one : many);
}

// For each vertex the first one with exactly its coordinates; -0 and 0 are equal.
std::vector<int> merge_positions(std::vector<Eigen::Vector3d>& positions) {
  for (Eigen::Vector3d& p : positions)
    p.array() += 0.0;  // turns -0 into 0, so that equal numbers have equal bits
  const auto hash = [&](std::size_t v) {
    std::uint64_t h = 0;
    for (const double c : positions[v]) h = stir(h, std::bit_cast<std::uint64_t>(c));
    return h;
  };
  return first_of_equals(positions.size(), hash,
                         [&](std::size_t v, std::size_t w) { return positions[v] == positions[w]; });
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
  return first_of_equals(triangles.size(), hash,
                         [&](std::size_t f, std::size_t g) { return sorted(f) == sorted(g); });
}

class Repair {
 public:
  Repair(const ObjText& obj, std::vector<Eigen::Vector3d> positions, const ReadOptions& options,
         const std::string& name, Health& health)
      : obj_(obj), options_(options), name_(name), health_(health) {
    mesh_.vertices = std::move(positions);
  }

  RepairedMesh run() {
    const std::vector<int> first = merge_positions(mesh_.vertices);
    cut_into_triangles(first);
    if (options_.facing) take_facing(*options_.facing, std::cos(options_.facing_max_rad));
    if (options_.stitch_mm > 0) stitch();
    drop_duplicates();
    take_out_needles();
    drop_unused(first);
    FaceLinks links = link_faces(mesh_.triangles);
    report_crowded_edges(links);
    turn_to_agree(links);
    if (!(options_.stitch_mm > 0)) mention_gaps(links);
    if (links.crowded_edges == 0) part_touching_sheets(links);
    return {std::move(mesh_), std::move(line_), links.edges};
  }

 private:
  const Eigen::Vector3d& at(int v) const { return mesh_.vertices[static_cast<std::size_t>(v)]; }

  void cut_into_triangles(std::span<const int> first) {
    std::vector<int> corners;
    std::vector<std::array<int, 3>> pieces;
    std::size_t crossing = 0, crossing_line = 0;
    mesh_.triangles.reserve(obj_.faces());
    line_.reserve(obj_.faces());
    for (std::size_t f = 0; f < obj_.faces(); ++f) {
      clean_corners(obj_.face(f), first, corners);
      pieces.clear();
      if (corners.size() >= 3 && !triangulate_polygon(mesh_.vertices, corners, pieces) && crossing++ == 0) {
        crossing_line = obj_.face_line[f];
      }
      // An outline bridged to a hole passes a vertex twice, and an ear may hold both.
      std::erase_if(pieces, [](const auto& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
      mesh_.triangles.insert(mesh_.triangles.end(), pieces.begin(), pieces.end());
      line_.resize(mesh_.triangles.size(), obj_.face_line[f]);
      if (pieces.empty()) ++health_.degenerate_faces;
    }
    if (crossing > 0) {
      health_.warnings.push_back(counted(crossing, "face is", "faces are") +
                                 " not a simple polygon and cut as a fan, the first in line " +
                                 std::to_string(crossing_line));
    }
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
    const std::size_t all = mesh_.triangles.size();
    keep_triangles([&](const std::array<int, 3>& t) {
      const Eigen::Vector3d normal = (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0]));
      return normal.dot(direction) >= least_cosine * normal.norm() * direction.norm() && normal.norm() > 0;
    });
    if (mesh_.triangles.empty()) {
      throw MeshError(name_ + ": no face looks in the direction of design.facing (" +
                      counted(all, "triangle", "triangles") + "): turn it round or allow a larger angle");
    }
    health_.repairs.push_back("took the " + std::to_string(mesh_.triangles.size()) + " of " +
                              std::to_string(all) + " triangles that look in the direction of design.facing");
  }

  template <class Wanted>
  void keep_triangles(const Wanted& wanted) {
    std::size_t kept = 0;
    for (std::size_t f = 0; f < mesh_.triangles.size(); ++f) {
      if (!wanted(mesh_.triangles[f])) continue;
      mesh_.triangles[kept] = mesh_.triangles[f];
      line_[kept++] = line_[f];
    }
    mesh_.triangles.resize(kept);
    line_.resize(kept);
  }

  void mention_gaps(const FaceLinks& links) {
    // Sheets are not drawn so close to each other on purpose.
    constexpr double kGap_mm = 0.1;
    const Stitches found = find_stitches(mesh_.vertices, mesh_.triangles, links, kGap_mm);
    if (found.joined == 0) return;
    health_.warnings.push_back(counted(found.joined, "border vertex", "border vertices") + " within " +
                               decimal(kGap_mm) + " mm of another border, the first at " +
                               place_text(at(found.first)) +
                               ": if the sheets belong together, set design.stitch_mm");
  }

  // Joins borders that almost meet; a face whose corners become one has no area any more.
  void stitch() {
    const FaceLinks links = link_faces(mesh_.triangles);
    const Stitches found = find_stitches(mesh_.vertices, mesh_.triangles, links, options_.stitch_mm);
    if (found.joined == 0) return;
    for (auto& t : mesh_.triangles) {
      for (int& v : t) v = found.vertex[static_cast<std::size_t>(v)];
    }
    const std::size_t before = mesh_.triangles.size();
    keep_triangles([](const auto& t) { return t[0] != t[1] && t[1] != t[2] && t[2] != t[0]; });
    health_.degenerate_faces += before - mesh_.triangles.size();
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
    WithoutNeedles clean = remove_needles(mesh_.vertices, std::move(mesh_.triangles), std::move(line_));
    mesh_.triangles = std::move(clean.triangles);
    line_ = std::move(clean.line);
    health_.degenerate_faces += clean.removed;
    if (health_.degenerate_faces > 0) {
      health_.repairs.push_back("dropped " + counted(health_.degenerate_faces, "face", "faces") +
                                " without area");
    }
    if (mesh_.triangles.empty()) {
      throw MeshError(name_ + ":" + std::to_string(obj_.face_line[0]) + ": no face has an area (" +
                      counted(obj_.faces(), "face", "faces") + "): check the units and export again");
    }
  }

  // Of faces over the same three vertices the first stays, whichever way round the others are.
  void drop_duplicates() {
    const std::vector<int> first = match_triangles(mesh_.triangles);
    std::size_t face = 0;
    keep_triangles([&](const auto&) {
      const std::size_t f = face++;
      return first[f] == static_cast<int>(f);
    });
    health_.duplicate_faces = first.size() - mesh_.triangles.size();
    if (health_.duplicate_faces == 0) return;
    health_.repairs.push_back("dropped " + counted(health_.duplicate_faces, "face", "faces") +
                              " lying on another with the same corners");
  }

  // Vertices keep their order. Merged ones are said as a repair, ones without a face are counted.
  void drop_unused(std::span<const int> first) {
    std::size_t merged = 0;
    for (std::size_t v = 0; v < first.size(); ++v) merged += first[v] != static_cast<int>(v) ? 1U : 0U;
    std::vector<int> renamed(first.size(), -1);
    for (const auto& t : mesh_.triangles) {
      for (const int v : t) renamed[static_cast<std::size_t>(v)] = 0;
    }
    int kept = 0;
    for (std::size_t v = 0; v < renamed.size(); ++v) {
      if (renamed[v] < 0) continue;
      mesh_.vertices[static_cast<std::size_t>(kept)] = mesh_.vertices[v];
      obj_number_.push_back(static_cast<int>(v) + 1);
      renamed[v] = kept++;
    }
    for (auto& t : mesh_.triangles) {
      for (int& v : t) v = renamed[static_cast<std::size_t>(v)];
    }
    health_.unused_vertices = first.size() - merged - stitched_ - static_cast<std::size_t>(kept);
    mesh_.vertices.resize(static_cast<std::size_t>(kept));
    mesh_.vertices.shrink_to_fit();
    if (merged > 0) {
      health_.repairs.push_back("merged " + counted(merged, "vertex", "vertices") +
                                " with another of exactly the same coordinates");
    }
  }

  void report_crowded_edges(const FaceLinks& links) {
    health_.non_manifold_edges = links.crowded_edges;
    if (links.crowded_edges == 0) return;
    const auto [a, b] = links.crowded_edge;
    health_.blockers.push_back(
        counted(links.crowded_edges, "edge has", "edges have") + " more than two faces, the first with " +
        std::to_string(links.crowded_edge_faces) + " between vertex " + number(a) + " " + place_text(at(a)) +
        " and vertex " + number(b) + " " + place_text(at(b)) + ": part or trim the sheets that meet there");
  }

  std::string number(int v) const { return std::to_string(obj_number_[static_cast<std::size_t>(v)]); }

  // Do the two faces of this edge run round it in opposite senses, as faces of one side do?
  bool agree(int corner, int other) const {
    const auto vertex = [&](int c) {
      return mesh_.triangles[static_cast<std::size_t>(c / 3)][static_cast<std::size_t>(c % 3)];
    };
    return vertex(corner) != vertex(other);
  }

  // Spreads a sense from face to face. In each component the sense that turns fewer faces wins.
  void turn_to_agree(FaceLinks& links) {
    enum : unsigned char { kUnseen, kAsIs, kTurn };
    std::vector<unsigned char> state(mesh_.triangles.size(), kUnseen);
    std::vector<int> component;
    std::size_t turned = 0;
    for (std::size_t seed = 0; seed < state.size(); ++seed) {
      if (state[seed] != kUnseen) continue;
      ++health_.components;
      component.assign(1, static_cast<int>(seed));
      state[seed] = kAsIs;
      for (std::size_t k = 0; k < component.size(); ++k) {
        const int f = component[k];
        for (int c = 3 * f; c < 3 * f + 3; ++c) {
          const int other = links.beyond[static_cast<std::size_t>(c)];
          if (other == FaceLinks::kNone) continue;
          const unsigned char mine = state[static_cast<std::size_t>(f)];
          const unsigned char wanted =
              agree(c, other) ? mine : static_cast<unsigned char>(kAsIs + kTurn - mine);
          unsigned char& theirs = state[static_cast<std::size_t>(other / 3)];
          if (theirs == kUnseen) {
            theirs = wanted;
            component.push_back(other / 3);
          } else if (theirs != wanted && health_.orientable) {
            report_moebius(f, other / 3);
          }
        }
      }
      turned += turn_fewer(component, state, kAsIs, kTurn);
    }
    if (!health_.orientable || turned == 0) return;
    for (std::size_t f = 0; f < state.size(); ++f) {
      if (state[f] == kTurn) std::swap(mesh_.triangles[f][1], mesh_.triangles[f][2]);
    }
    links = link_faces(mesh_.triangles);
    health_.repairs.push_back("turned " + counted(turned, "face", "faces") +
                              " over to agree with their neighbours");
  }

  static std::size_t turn_fewer(std::span<const int> component, std::vector<unsigned char>& state,
                                unsigned char as_is, unsigned char turn) {
    const auto count = static_cast<std::size_t>(std::count_if(component.begin(), component.end(), [&](int f) {
      return state[static_cast<std::size_t>(f)] == turn;
    }));
    if (2 * count <= component.size()) return count;
    for (const int f : component) {
      unsigned char& s = state[static_cast<std::size_t>(f)];
      s = s == turn ? as_is : turn;
    }
    return component.size() - count;
  }

  void report_moebius(int face, int other) {
    health_.orientable = false;
    const auto& t = mesh_.triangles[static_cast<std::size_t>(face)];
    const Eigen::Vector3d centre = (at(t[0]) + at(t[1]) + at(t[2])) / 3;
    health_.blockers.push_back("the surface has one side only, like a Moebius strip: the faces of lines " +
                               std::to_string(line_[static_cast<std::size_t>(face)]) + " and " +
                               std::to_string(line_[static_cast<std::size_t>(other)]) + " near " +
                               place_text(centre) + " cannot be made to agree: cut the strip open");
  }

  // Gives every fan of faces round a vertex a vertex of its own, at the same place.
  void part_touching_sheets(const FaceLinks& links) {
    std::vector<int> fan = fans(links);
    std::vector<bool> claimed(mesh_.vertices.size(), false);
    std::vector<int> fan_vertex(fan.size(), -1);
    std::vector<int> parted;
    for (std::size_t c = 0; c < fan.size(); ++c) {
      int& v = mesh_.triangles[c / 3][c % 3];
      int& own = fan_vertex[static_cast<std::size_t>(fan[c])];
      if (own < 0 && !claimed[static_cast<std::size_t>(v)]) {
        claimed[static_cast<std::size_t>(v)] = true;
        own = v;
      } else if (own < 0) {
        own = static_cast<int>(mesh_.vertices.size());
        parted.push_back(v);
        mesh_.vertices.push_back(Eigen::Vector3d(at(v)));
      }
      v = own;
    }
    if (parted.empty()) return;
    const int shown = parted.front();
    std::sort(parted.begin(), parted.end());
    parted.erase(std::unique(parted.begin(), parted.end()), parted.end());
    health_.non_manifold_vertices = parted.size();
    health_.repairs.push_back("parted the sheets that touch only in a point at " +
                              counted(parted.size(), "vertex", "vertices") + ", the first vertex " +
                              number(shown) + " " + place_text(at(shown)));
  }

  // For each corner the smallest corner of its fan: corners at one vertex, reached across edges.
  static std::vector<int> fans(const FaceLinks& links) {
    std::vector<int> parent(links.beyond.size());
    std::iota(parent.begin(), parent.end(), 0);
    const auto root = [&](int c) {
      while (parent[static_cast<std::size_t>(c)] != c) {
        int& p = parent[static_cast<std::size_t>(c)];
        p = parent[static_cast<std::size_t>(p)];
        c = p;
      }
      return c;
    };
    const auto join = [&](int a, int b) {
      const int ra = root(a), rb = root(b);
      parent[static_cast<std::size_t>(std::max(ra, rb))] = std::min(ra, rb);
    };
    for (int c = 0; c < static_cast<int>(parent.size()); ++c) {
      const int other = links.beyond[static_cast<std::size_t>(c)];
      if (other < c) continue;
      join(c, next_corner(other));
      join(next_corner(c), other);
    }
    for (int c = 0; c < static_cast<int>(parent.size()); ++c) parent[static_cast<std::size_t>(c)] = root(c);
    return parent;
  }

  const ObjText& obj_;
  const ReadOptions& options_;
  const std::string& name_;
  Health& health_;
  TriangleMesh mesh_;
  std::vector<std::uint32_t> line_;  // per triangle
  std::vector<int> obj_number_;      // per vertex, before sheets are parted
  std::size_t stitched_ = 0;         // vertices
};

}  // namespace

RepairedMesh repair_mesh(const ObjText& obj, std::vector<Eigen::Vector3d> positions,
                         const ReadOptions& options, const std::string& name, Health& health) {
  return Repair(obj, std::move(positions), options, name, health).run();
}

}  // namespace hotblade::surface
