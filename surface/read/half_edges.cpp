#include "surface/read/half_edges.hpp"

#include <OpenMesh/Core/System/omstream.hh>

#include <algorithm>
#include <atomic>
#include <optional>
#include <stdexcept>
#include <utility>

#include "surface/read/blocks.hpp"

namespace hotblade::surface {
namespace {

std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}

OpenMesh::VertexHandle vertex(int v) {
  return OpenMesh::VertexHandle(v);
}

std::array<int, 2> edge_between(int a, int b) {
  return {std::min(a, b), std::max(a, b)};
}

void check(const TriangleSoup& soup) {
  for_blocks(soup.triangles.size(), kBlock, [&](std::size_t from, std::size_t to) {
    for (std::size_t f = from; f < to; ++f) {
      const auto& t = soup.triangles[f];
      for (std::size_t i = 0; i < 3; ++i) {
        if (t[i] < 0 || at(t[i]) >= soup.vertices.size() || t[i] == t[(i + 1) % 3])
          throw std::logic_error("TriangleMesh: a triangle needs three different vertices of the mesh");
      }
    }
  });
}

// Numbers the edges of a plain surface by the first of their corners, whose half-edge is the even one.
class EdgeNumbers {
 public:
  explicit EdgeNumbers(std::vector<int>& mates) : mates_(mates), before_(blocks(mates)) {
    std::vector<std::vector<int>> border(before_.size());
    for_blocks(mates.size(), kBlock, [&](std::size_t from, std::size_t to) {
      for (std::size_t c = from; c < to; ++c) {
        before_[from / kBlock] += is_first(c) ? 1U : 0U;
        if (mates[c] < 0) border[from / kBlock].push_back(static_cast<int>(c));
      }
    });
    for (std::size_t block = 0; block < before_.size(); ++block) {
      edges_ += std::exchange(before_[block], edges_);
      border_.insert(border_.end(), border[block].begin(), border[block].end());
    }
  }

  [[nodiscard]] std::size_t edges() const { return edges_; }
  // Returns the corners without a mate, ascending; once.
  [[nodiscard]] std::vector<int> take_border() { return std::move(border_); }

  // Puts for each corner the half-edge along its edge in place of the mate, which is as long and needed no
  // more.
  void replace_mates() {
    for_blocks(mates_.size(), kBlock, [&](std::size_t from, std::size_t to) {
      auto edge = static_cast<int>(before_[from / kBlock]);
      for (std::size_t c = from; c < to; ++c) {
        const int mate = place(c).load(std::memory_order_relaxed);
        if (mate <= kReplaced || (mate >= 0 && at(mate) < c)) continue;
        place(c).store(kReplaced - 2 * edge, std::memory_order_relaxed);
        if (mate >= 0) place(at(mate)).store(kReplaced - (2 * edge + 1), std::memory_order_relaxed);
        ++edge;
      }
    });
    for_blocks(mates_.size(), kBlock, [&](std::size_t from, std::size_t to) {
      for (std::size_t c = from; c < to; ++c) mates_[c] = kReplaced - mates_[c];
    });
  }

 private:
  static std::size_t blocks(const std::vector<int>& mates) { return (mates.size() + kBlock - 1) / kBlock; }
  [[nodiscard]] bool is_first(std::size_t c) const { return mates_[c] < 0 || at(mates_[c]) > c; }

  // Another block may have been at a corner already: what it left there, below -1, is no first corner either.
  static constexpr int kReplaced = -2;
  [[nodiscard]] std::atomic_ref<int> place(std::size_t c) { return std::atomic_ref<int>(mates_[c]); }

  std::vector<int>& mates_;
  std::vector<std::size_t> before_;  // edges before each block
  std::vector<int> border_;
  std::size_t edges_ = 0;
};

// A surface has V + F edges less its Euler characteristic, which holes and handles lower: an eighth of the
// faces leaves room for those. What is reserved and not used takes no memory.
std::size_t most_edges(const TriangleSoup& soup) {
  const std::size_t faces = soup.triangles.size();
  return std::min(3 * faces, soup.vertices.size() + faces + faces / 8);
}

}  // namespace

HalfEdges::HalfEdges(TriangleSoup soup) : vertices_(soup.vertices.size()) {
  check(soup);
  // Refused triangles are reported by what reads the mesh, not printed by the library.
  [[maybe_unused]] static const bool silent = [] {
    omerr().disable();
    return true;
  }();
  std::optional<Mates> mates = plain_mates(vertices_, soup.triangles);
  plain_ = mates.has_value();
  if (mates) {
    mesh_.resize(vertices_, 0, 0);
    for_blocks(vertices_, kBlock, [&](std::size_t from, std::size_t to) {
      for (std::size_t v = from; v < to; ++v) mesh_.set_point(vertex(static_cast<int>(v)), soup.vertices[v]);
    });
    std::vector<Eigen::Vector3d>().swap(soup.vertices);
    lay_out(soup.triangles, *std::move(mates));
  } else {
    add(soup);
  }
  triangles_ = std::move(soup.triangles);
  if (!refused_.empty()) link_refused();
}

void HalfEdges::lay_out(const std::vector<std::array<int, 3>>& triangles, Mates mates) {
  // Vertices have their corners in place of half-edges meanwhile: five million take 20 MB.
  for_blocks(vertices_, kBlock, [&](std::size_t from, std::size_t to) {
    for (std::size_t v = from; v < to; ++v)
      mesh_.set_halfedge_handle(vertex(static_cast<int>(v)), Halfedge(mates.lowest[v]));
  });
  std::vector<int>().swap(mates.lowest);
  EdgeNumbers numbers(mates.of_corner);
  border_ = numbers.take_border();
  side_by_side([&] { mesh_.resize(vertices_, numbers.edges(), triangles.size()); },
               [&] { numbers.replace_mates(); });
  const std::vector<int>& half_edges = mates.of_corner;
  for_blocks(triangles.size(), kBlock, [&](std::size_t from, std::size_t to) {
    for (std::size_t f = from; f < to; ++f) {
      const OpenMesh::FaceHandle face(static_cast<int>(f));
      const int* h = &half_edges[3 * f];
      for (std::size_t i = 0; i < 3; ++i) {
        const Halfedge along(h[i]);
        mesh_.set_face_handle(along, face);
        mesh_.set_vertex_handle(along, vertex(triangles[f][(i + 1) % 3]));
        mesh_.set_next_halfedge_handle(along, Halfedge(h[(i + 1) % 3]));
      }
      mesh_.set_halfedge_handle(face, Halfedge(h[2]));
    }
  });
  for_blocks(vertices_, kBlock, [&](std::size_t from, std::size_t to) {
    for (std::size_t v = from; v < to; ++v) {
      const int corner = mesh_.halfedge_handle(vertex(static_cast<int>(v))).idx();
      if (corner >= 0)
        mesh_.set_halfedge_handle(vertex(static_cast<int>(v)), Halfedge(half_edges[at(corner)]));
    }
  });
  set_border();
}

// The half-edges outside follow each other round the border; a vertex there leaves along its own.
void HalfEdges::set_border() {
  for (const int corner : border_) {
    const Halfedge inside = at_corner(corner), outside = mesh_.opposite_halfedge_handle(inside);
    const OpenMesh::VertexHandle from = mesh_.to_vertex_handle(inside);
    mesh_.set_vertex_handle(outside, mesh_.to_vertex_handle(mesh_.prev_halfedge_handle(inside)));
    mesh_.set_halfedge_handle(from, outside);
  }
  for (const int corner : border_) {
    const Halfedge outside = mesh_.opposite_halfedge_handle(at_corner(corner));
    mesh_.set_next_halfedge_handle(outside, mesh_.halfedge_handle(mesh_.to_vertex_handle(outside)));
  }
}

std::vector<int> HalfEdges::border() const {
  if (plain_) return border_;
  std::vector<int> corners;
  for (int f = 0; f < static_cast<int>(triangles().size()); ++f) {
    Halfedge h = first(f);
    for (int c = 3 * f; c < 3 * f + 3; ++c, h = mesh_.next_halfedge_handle(h)) {
      if (!across(h).is_valid()) corners.push_back(c);
    }
  }
  return corners;
}

void HalfEdges::add(const TriangleSoup& soup) {
  mesh_.reserve(vertices_, most_edges(soup), soup.triangles.size());
  for (const Eigen::Vector3d& p : soup.vertices) mesh_.add_vertex(p);
  for (std::size_t f = 0; f < soup.triangles.size(); ++f) {
    const auto& t = soup.triangles[f];
    if (mesh_.add_face(vertex(t[0]), vertex(t[1]), vertex(t[2])).is_valid()) continue;
    refused_.push_back(static_cast<int>(f));
    add_beside(t);
  }
}

void HalfEdges::add_beside(const std::array<int, 3>& t) {
  std::array<OpenMesh::VertexHandle, 3> copies;
  for (std::size_t i = 0; i < 3; ++i) {
    const Eigen::Vector3d p = mesh_.point(vertex(t[i]));
    copies[i] = mesh_.add_vertex(p);
  }
  mesh_.add_face(copies[0], copies[1], copies[2]);
}

HalfEdges::Halfedge HalfEdges::at_corner(int corner) const {
  Halfedge h = first(corner / 3);
  for (int i = 0; i < corner % 3; ++i) h = mesh_.next_halfedge_handle(h);
  return h;
}

int HalfEdges::corner_of(Halfedge h) const {
  const int f = mesh_.face_handle(h).idx();
  const Halfedge zero = first(f);
  if (h == zero) return 3 * f;
  return h == mesh_.next_halfedge_handle(zero) ? 3 * f + 1 : 3 * f + 2;
}

bool HalfEdges::joined(int v, int other) const {
  return mesh_.find_halfedge(vertex(v), vertex(other)).is_valid() ||
         std::binary_search(refused_edges_.begin(), refused_edges_.end(), edge_between(v, other));
}

bool HalfEdges::has_seams() const {
  if (plain_) return false;
  if (!refused_.empty()) return true;
  // A vertex has a half-edge out along the border for each of its fans: one walk over the half-edges finds
  // the second.
  std::vector<bool> seen(mesh_.n_vertices());
  for (const Halfedge h : mesh_.halfedges()) {
    if (!mesh_.is_boundary(h)) continue;
    auto from = seen[at(mesh_.from_vertex_handle(h).idx())];
    if (from) return true;
    from = true;
  }
  return false;
}

std::vector<HalfEdges::EdgeUse> HalfEdges::uses_at_refused() const {
  std::vector<EdgeUse> uses;
  for (const int f : refused_) {
    for (int c = 3 * f; c < 3 * f + 3; ++c) {
      const auto& t = triangles()[at(f)];
      const auto edge = edge_between(t[at(c % 3)], t[at((c + 1) % 3)]);
      uses.push_back({edge, at_corner(c)});
      const Halfedge there = mesh_.find_halfedge(vertex(edge[0]), vertex(edge[1]));
      if (!there.is_valid()) continue;
      for (const Halfedge h : {there, mesh_.opposite_halfedge_handle(there)}) {
        if (!mesh_.is_boundary(h)) uses.push_back({edge, h});
      }
    }
  }
  std::sort(uses.begin(), uses.end());
  const auto same = [](const EdgeUse& a, const EdgeUse& b) { return a.halfedge == b.halfedge; };
  uses.erase(std::unique(uses.begin(), uses.end(), same), uses.end());
  return uses;
}

void HalfEdges::link_refused() {
  mesh_.add_property(across_);
  for (const Halfedge h : mesh_.halfedges()) {
    const Halfedge opposite = mesh_.opposite_halfedge_handle(h);
    mesh_.property(across_, h) = mesh_.is_boundary(opposite) ? Halfedge() : opposite;
  }
  const std::vector<EdgeUse> uses = uses_at_refused();
  for (auto from = uses.begin(), to = from; from != uses.end(); from = to) {
    to = std::find_if(from, uses.end(), [&](const EdgeUse& use) { return use.edge != from->edge; });
    refused_edges_.push_back(from->edge);
    for (auto use = from; use != to; ++use) {
      mesh_.property(across_, use->halfedge) =
          to - from == 2 ? (use == from ? from + 1 : from)->halfedge : Halfedge();
    }
    if (to - from > 2 && crowded_.edges++ == 0) {
      crowded_.first = from->edge;
      crowded_.triangles = static_cast<std::size_t>(to - from);
    }
  }
}

}  // namespace hotblade::surface
