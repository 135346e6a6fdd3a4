#include "surface/slice/section_march.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <limits>
#include <numeric>

namespace hotblade::surface {
namespace {

std::uint64_t edge_key(int a, int b) {
  return static_cast<std::uint64_t>(std::min(a, b)) << 32 | static_cast<std::uint32_t>(std::max(a, b));
}

// Where the plane leaves or enters a face: the mesh edge from a vertex below the plane to one above it.
struct Crossing {
  int below = 0, above = 0, face = 0;
  [[nodiscard]] std::uint64_t key() const { return edge_key(below, above); }
};

struct FaceCut {
  Crossing in, out;
};

// The curve through one plane's faces, as the edges it crosses.
struct Trace {
  std::vector<Crossing> crossings;
  bool closed = false;
};

// Disjoint sets; the root is always the smallest member, so the order of joining does not matter.
class Sets {
 public:
  explicit Sets(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }
  int add() {
    parent_.push_back(static_cast<int>(parent_.size()));
    return parent_.back();
  }
  int root(int a) {
    while (parent_[static_cast<std::size_t>(a)] != a) {
      int& p = parent_[static_cast<std::size_t>(a)];
      p = parent_[static_cast<std::size_t>(p)];
      a = p;
    }
    return a;
  }
  void join(int a, int b) {
    a = root(a);
    b = root(b);
    parent_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
  }

 private:
  std::vector<int> parent_;
};

class March {
 public:
  March(const TriangleMesh& mesh, const PlaneFamily& planes, std::span<const double> offsets)
      : mesh_(mesh),
        planes_(planes),
        offsets_(offsets),
        normals_(vertex_normals(mesh)),
        sets_(mesh.vertices.size()) {
    layer_.reserve(mesh.vertices.size());
    height_.reserve(mesh.vertices.size());
    double largest = 0;
    for (const Eigen::Vector3d& p : mesh.vertices) {
      height_.push_back(planes.offset(p));
      layer_.push_back(static_cast<int>(std::upper_bound(offsets.begin(), offsets.end(), height_.back()) -
                                        offsets.begin()));
      largest = std::max(largest, p.cwiseAbs().maxCoeff());
    }
    // A crossing point carries the rounding of a handful of operations on numbers of this size; points that
    // are no farther apart than that are one point.
    constexpr double kOperations = 64;
    same_point_ = kOperations * std::numeric_limits<double>::epsilon() * largest;
    join_within_layers();
    sort_faces_by_plane();
  }

  std::vector<std::vector<MarchedPiece>> run() {
    std::vector<std::vector<MarchedPiece>> sections(offsets_.size());
    std::vector<EdgeSide> previous;
    for (std::size_t k = 0; k < offsets_.size(); ++k) {
      std::vector<EdgeSide> current;
      for (const Trace& trace : trace_plane(k)) {
        MarchedPiece marched{to_piece(trace, k), sets_.add(), sets_.add()};
        if (marched.piece.points.size() < 2) continue;
        join_to_surface(trace, marched, static_cast<int>(k), previous, current);
        sections[k].push_back(std::move(marched));
      }
      std::sort(sections[k].begin(), sections[k].end(), [](const MarchedPiece& a, const MarchedPiece& b) {
        const Eigen::Vector3d &p = a.piece.points.front().p, &q = b.piece.points.front().p;
        return std::lexicographical_compare(p.begin(), p.end(), q.begin(), q.end());
      });
      std::sort(current.begin(), current.end());
      previous = std::move(current);
    }
    for (auto& section : sections) {
      for (MarchedPiece& m : section) {
        m.surface_below = sets_.root(m.surface_below);
        m.surface_above = sets_.root(m.surface_above);
      }
    }
    return sections;
  }

 private:
  // An edge crossed by a plane, and the surface above the plane at that edge.
  using EdgeSide = std::pair<std::uint64_t, int>;

  [[nodiscard]] int layer(int v) const { return layer_[static_cast<std::size_t>(v)]; }
  [[nodiscard]] const Eigen::Vector3d& at(int v) const { return mesh_.vertices[static_cast<std::size_t>(v)]; }
  [[nodiscard]] std::pair<int, int> layers(const std::array<int, 3>& t) const {
    return {std::min({layer(t[0]), layer(t[1]), layer(t[2])}),
            std::max({layer(t[0]), layer(t[1]), layer(t[2])})};
  }

  void join_within_layers() {
    for (const auto& t : mesh_.triangles) {
      for (std::size_t i = 0; i < 3; ++i) {
        if (layer(t[i]) == layer(t[(i + 1) % 3])) sets_.join(t[i], t[(i + 1) % 3]);
      }
    }
  }

  // Plane k cuts the faces faces_[first_[k]] .. faces_[first_[k + 1]]: those with vertices in layers <= k and
  // > k.
  void sort_faces_by_plane() {
    first_.assign(offsets_.size() + 1, 0);
    for (const auto& t : mesh_.triangles) {
      const auto [low, high] = layers(t);
      for (int k = low; k < high; ++k) ++first_[static_cast<std::size_t>(k) + 1];
    }
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    faces_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t f = 0; f < mesh_.triangles.size(); ++f) {
      const auto [low, high] = layers(mesh_.triangles[f]);
      for (int k = low; k < high; ++k) faces_[next[static_cast<std::size_t>(k)]++] = static_cast<int>(f);
    }
  }

  // Going round the face counter-clockwise, one edge leads down through the plane and one up; the curve comes
  // in at the former. In the next face the shared edge runs the other way, so one face's way out is the next
  // one's way in.
  [[nodiscard]] FaceCut cut_face(int face, int plane) const {
    const auto& t = mesh_.triangles[static_cast<std::size_t>(face)];
    FaceCut cut;
    for (std::size_t i = 0; i < 3; ++i) {
      const int a = t[i], b = t[(i + 1) % 3];
      const bool a_above = layer(a) > plane, b_above = layer(b) > plane;
      if (a_above && !b_above) cut.in = {b, a, face};
      if (!a_above && b_above) cut.out = {a, b, face};
    }
    return cut;
  }

  [[nodiscard]] std::vector<Trace> trace_plane(std::size_t k) const {
    std::vector<FaceCut> cuts;
    cuts.reserve(first_[k + 1] - first_[k]);
    for (std::size_t i = first_[k]; i < first_[k + 1]; ++i)
      cuts.push_back(cut_face(faces_[i], static_cast<int>(k)));
    std::vector<std::pair<std::uint64_t, std::size_t>> ways_in;
    ways_in.reserve(cuts.size());
    for (std::size_t i = 0; i < cuts.size(); ++i) ways_in.emplace_back(cuts[i].in.key(), i);
    std::sort(ways_in.begin(), ways_in.end());
    constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
    std::vector<std::size_t> next(cuts.size(), kNone);
    std::vector<bool> has_previous(cuts.size(), false), seen(cuts.size(), false);
    for (std::size_t i = 0; i < cuts.size(); ++i) {
      const auto way =
          std::lower_bound(ways_in.begin(), ways_in.end(), std::pair(cuts[i].out.key(), std::size_t{0}));
      if (way == ways_in.end() || way->first != cuts[i].out.key()) continue;
      next[i] = way->second;
      has_previous[way->second] = true;
    }
    std::vector<Trace> traces;
    const auto follow = [&](std::size_t start, bool closed) {
      Trace trace;
      trace.closed = closed;
      for (std::size_t i = start; i != kNone && !seen[i]; i = next[i]) {
        seen[i] = true;
        trace.crossings.push_back(cuts[i].in);
        if (next[i] == kNone) trace.crossings.push_back(cuts[i].out);
      }
      traces.push_back(std::move(trace));
    };
    for (std::size_t i = 0; i < cuts.size(); ++i) {
      if (!has_previous[i]) follow(i, false);
    }
    for (std::size_t i = 0; i < cuts.size(); ++i) {
      if (!seen[i]) follow(i, true);
    }
    return traces;
  }

  // The same numbers whichever face asks: always from the vertex below to the one above.
  [[nodiscard]] SectionPoint to_point(const Crossing& c, double offset) const {
    const double low = height_[static_cast<std::size_t>(c.below)],
                 high = height_[static_cast<std::size_t>(c.above)];
    const double t = planes_.crossing(at(c.below), low, at(c.above), high, offset);
    SectionPoint point;
    point.p = t < 1 ? Eigen::Vector3d(at(c.below) + t * (at(c.above) - at(c.below))) : at(c.above);
    point.normal = (1 - t) * normals_[static_cast<std::size_t>(c.below)] +
                   t * normals_[static_cast<std::size_t>(c.above)];
    // Faces folded back on themselves leave no mean normal; the crossed face's own is the best there is.
    constexpr double kNoDirection = 1e-6;
    if (point.normal.norm() < kNoDirection) {
      const auto& f = mesh_.triangles[static_cast<std::size_t>(c.face)];
      point.normal = (at(f[1]) - at(f[0])).cross(at(f[2]) - at(f[0]));
    }
    point.normal.normalize();
    return point;
  }

  [[nodiscard]] SectionPiece to_piece(const Trace& trace, std::size_t k) const {
    SectionPiece piece;
    piece.closed = trace.closed;
    auto& points = piece.points;
    points.reserve(trace.crossings.size());
    for (const Crossing& c : trace.crossings) {
      const SectionPoint point = to_point(c, offsets_[k]);
      if (points.empty() || (points.back().p - point.p).norm() > same_point_) points.push_back(point);
    }
    while (piece.closed && points.size() > 1 && (points.front().p - points.back().p).norm() <= same_point_) {
      points.pop_back();
    }
    if (piece.closed && points.size() < 3) points.clear();
    if (piece.closed) {
      const auto smaller = [](const SectionPoint& a, const SectionPoint& b) {
        return std::lexicographical_compare(a.p.begin(), a.p.end(), b.p.begin(), b.p.end());
      };
      std::rotate(points.begin(), std::min_element(points.begin(), points.end(), smaller), points.end());
    }
    for (std::size_t i = 1; i < points.size(); ++i) piece.length_mm += (points[i].p - points[i - 1].p).norm();
    if (piece.closed && !points.empty()) piece.length_mm += (points.front().p - points.back().p).norm();
    return piece;
  }

  // Says at every crossed edge what lies below the curve: a vertex of the layer, or the curve of the plane
  // before when the edge goes on down through that one too. The same above, for the plane to come.
  void join_to_surface(const Trace& trace, const MarchedPiece& marched, int plane,
                       const std::vector<EdgeSide>& previous, std::vector<EdgeSide>& current) {
    for (const Crossing& c : trace.crossings) {
      if (layer(c.below) == plane) {
        sets_.join(c.below, marched.surface_below);
      } else {
        const auto found = std::lower_bound(previous.begin(), previous.end(), EdgeSide(c.key(), 0));
        if (found != previous.end() && found->first == c.key())
          sets_.join(found->second, marched.surface_below);
      }
      if (layer(c.above) == plane + 1) {
        sets_.join(c.above, marched.surface_above);
      } else {
        current.emplace_back(c.key(), marched.surface_above);
      }
    }
  }

  const TriangleMesh& mesh_;
  PlaneFamily planes_;
  std::span<const double> offsets_;
  std::vector<Eigen::Vector3d> normals_;
  std::vector<double> height_;  // offset of the plane through each vertex
  std::vector<int> layer_;      // per vertex: how many planes are at or below it
  std::vector<std::size_t> first_;
  std::vector<int> faces_;
  double same_point_ = 0;
  Sets sets_;
};

}  // namespace

std::vector<Eigen::Vector3d> vertex_normals(const TriangleMesh& mesh) {
  std::vector<Eigen::Vector3d> normals(mesh.vertices.size(), Eigen::Vector3d::Zero());
  for (const auto& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const Eigen::Vector3d& p = mesh.vertices[static_cast<std::size_t>(t[i])];
      const Eigen::Vector3d a = mesh.vertices[static_cast<std::size_t>(t[(i + 1) % 3])] - p;
      const Eigen::Vector3d b = mesh.vertices[static_cast<std::size_t>(t[(i + 2) % 3])] - p;
      normals[static_cast<std::size_t>(t[i])] += a.cross(b) / (a.squaredNorm() * b.squaredNorm());
    }
  }
  for (Eigen::Vector3d& n : normals) n = n.normalized();  // leaves zero as it is
  return normals;
}

std::vector<std::vector<MarchedPiece>> march_sections(const TriangleMesh& mesh, const PlaneFamily& planes,
                                                      std::span<const double> offsets_mm) {
  return March(mesh, planes, offsets_mm).run();
}

}  // namespace hotblade::surface
