#include "surface/slice/slice.hpp"

#include <OpenMesh/Core/Mesh/Handles.hh>

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "surface/read/half_edges.hpp"
#include "surface/slice/ring.hpp"

namespace hotblade::surface {
namespace {

using Halfedge = HalfEdges::Halfedge;

// Where the plane leaves or enters a face: a mesh edge, from a vertex below the plane to one above it.
struct Crossing {
  Halfedge halfedge;  // the face's
  int below = 0, above = 0;
};

// Going round the face counter-clockwise, one edge leads down through the plane and one up; the curve comes
// in at the former.
struct FaceCut {
  Crossing in, out;
};

// The curve through one plane's faces, as the edges it crosses.
struct Trace {
  std::vector<Crossing> crossings;
  bool closed = false;
};

class March {
 public:
  March(const TriangleMesh& mesh, const PlaneFamily& planes, std::span<const double> offsets)
      : mesh_(mesh), planes_(planes), offsets_(offsets), cut_in_(mesh.triangles().size(), kNone) {
    layer_.reserve(mesh.vertices().size());
    height_.reserve(mesh.vertices().size());
    double largest = 0;
    for (const Eigen::Vector3d& p : mesh.vertices()) {
      height_.push_back(planes.offset(p));
      layer_.push_back(static_cast<int>(std::upper_bound(offsets.begin(), offsets.end(), height_.back()) -
                                        offsets.begin()));
      largest = std::max(largest, p.cwiseAbs().maxCoeff());
    }
    // A crossing point carries the rounding of a handful of operations on numbers of this size; points that
    // are no farther apart than that are one point.
    constexpr double kOperations = 64;
    same_point_ = kOperations * std::numeric_limits<double>::epsilon() * largest;
    sort_faces_by_plane();
  }

  std::vector<Section> run() {
    std::vector<Section> sections(offsets_.size());
    for (std::size_t k = 0; k < offsets_.size(); ++k) {
      sections[k].offset_mm = offsets_[k];
      auto& pieces = sections[k].pieces;
      for (const Trace& trace : trace_plane(k)) {
        SectionPiece piece = to_piece(trace, k);
        if (piece.points.size() > 1) pieces.push_back(std::move(piece));
      }
      std::sort(pieces.begin(), pieces.end(), [](const SectionPiece& a, const SectionPiece& b) {
        return smaller(a.points.front(), b.points.front());
      });
    }
    return sections;
  }

 private:
  static constexpr int kNone = -1;

  [[nodiscard]] int layer(int v) const { return layer_[static_cast<std::size_t>(v)]; }
  [[nodiscard]] const Eigen::Vector3d& at(int v) const {
    return mesh_.vertices()[static_cast<std::size_t>(v)];
  }
  [[nodiscard]] const HalfEdges& half_edges() const { return mesh_.half_edges(); }
  [[nodiscard]] std::pair<int, int> layers(const std::array<int, 3>& t) const {
    return {std::min({layer(t[0]), layer(t[1]), layer(t[2])}),
            std::max({layer(t[0]), layer(t[1]), layer(t[2])})};
  }

  // Plane k cuts the faces faces_[first_[k]] .. faces_[first_[k + 1]]: those with vertices in layers <= k and
  // > k.
  void sort_faces_by_plane() {
    first_.assign(offsets_.size() + 1, 0);
    for (const auto& t : mesh_.triangles()) {
      const auto [low, high] = layers(t);
      for (int k = low; k < high; ++k) ++first_[static_cast<std::size_t>(k) + 1];
    }
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    faces_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t f = 0; f < mesh_.triangles().size(); ++f) {
      const auto [low, high] = layers(mesh_.triangles()[f]);
      for (int k = low; k < high; ++k) faces_[next[static_cast<std::size_t>(k)]++] = static_cast<int>(f);
    }
  }

  [[nodiscard]] FaceCut cut_face(int face, int plane) const {
    const auto& t = mesh_.triangles()[static_cast<std::size_t>(face)];
    Halfedge h = half_edges().first(face);
    FaceCut cut;
    for (std::size_t i = 0; i < 3; ++i, h = half_edges().mesh().next_halfedge_handle(h)) {
      const int a = t[i], b = t[(i + 1) % 3];
      const bool a_above = layer(a) > plane, b_above = layer(b) > plane;
      if (a_above && !b_above) cut.in = {h, b, a};
      if (!a_above && b_above) cut.out = {h, a, b};
    }
    return cut;
  }

  // Follows curves from face to face: in the face beyond, the shared edge runs the other way, so one face's
  // way out is the next one's way in. Curves that begin at a border come first.
  [[nodiscard]] std::vector<Trace> trace_plane(std::size_t k) {
    std::vector<FaceCut> cuts;
    cuts.reserve(first_[k + 1] - first_[k]);
    for (std::size_t i = first_[k]; i < first_[k + 1]; ++i) {
      cut_in_[static_cast<std::size_t>(faces_[i])] = static_cast<int>(cuts.size());
      cuts.push_back(cut_face(faces_[i], static_cast<int>(k)));
    }
    const auto& mesh = half_edges().mesh();
    std::vector<bool> seen(cuts.size(), false);
    std::vector<Trace> traces;
    const auto follow = [&](std::size_t start, bool closed) {
      Trace trace;
      trace.closed = closed;
      for (std::size_t i = start; !seen[i];) {
        seen[i] = true;
        trace.crossings.push_back(cuts[i].in);
        const Halfedge next = half_edges().across(cuts[i].out.halfedge);
        if (next.is_valid()) {
          i = static_cast<std::size_t>(cut_in_[static_cast<std::size_t>(mesh.face_handle(next).idx())]);
        } else {
          trace.crossings.push_back(cuts[i].out);
        }
      }
      traces.push_back(std::move(trace));
    };
    for (std::size_t i = 0; i < cuts.size(); ++i) {
      if (!half_edges().across(cuts[i].in.halfedge).is_valid()) follow(i, false);
    }
    for (std::size_t i = 0; i < cuts.size(); ++i) {
      if (!seen[i]) follow(i, true);
    }
    return traces;
  }

  // The same numbers whichever face asks: always from the vertex below to the one above.
  [[nodiscard]] Eigen::Vector3d to_point(const Crossing& c, double offset) const {
    const double low = height_[static_cast<std::size_t>(c.below)],
                 high = height_[static_cast<std::size_t>(c.above)];
    const double t = planes_.crossing(at(c.below), low, at(c.above), high, offset);
    return t < 1 ? Eigen::Vector3d(at(c.below) + t * (at(c.above) - at(c.below))) : at(c.above);
  }

  static bool smaller(const Eigen::Vector3d& p, const Eigen::Vector3d& q) {
    return std::lexicographical_compare(p.begin(), p.end(), q.begin(), q.end());
  }

  [[nodiscard]] SectionPiece to_piece(const Trace& trace, std::size_t k) const {
    SectionPiece piece;
    piece.closed = trace.closed;
    auto& points = piece.points;
    points.reserve(trace.crossings.size());
    for (const Crossing& c : trace.crossings) {
      const Eigen::Vector3d point = to_point(c, offsets_[k]);
      if (points.empty() || (points.back() - point).norm() > same_point_) points.push_back(point);
    }
    while (piece.closed && points.size() > 1 && (points.front() - points.back()).norm() <= same_point_) {
      points.pop_back();
    }
    if (piece.closed && points.size() < 3) points.clear();
    if (piece.closed) {
      std::rotate(points.begin(), std::min_element(points.begin(), points.end(), smaller), points.end());
    }
    for (std::size_t i = 1; i < points.size(); ++i) piece.length_mm += (points[i] - points[i - 1]).norm();
    if (piece.closed && !points.empty()) piece.length_mm += (points.front() - points.back()).norm();
    return piece;
  }

  const TriangleMesh& mesh_;
  PlaneFamily planes_;
  std::span<const double> offsets_;
  std::vector<double> height_;  // offset of the plane through each vertex
  std::vector<int> layer_;      // per vertex: how many planes are at or below it
  std::vector<std::size_t> first_;
  std::vector<int> faces_;
  double same_point_ = 0;
  std::vector<int> cut_in_;  // per face: its place among the cuts of the last plane through it
};

}  // namespace

std::vector<Section> slice(const TriangleMesh& mesh, const PlaneFamily& planes,
                           std::span<const double> offsets_mm) {
  if (planes.closed()) return March(cut_open(mesh, planes), planes, offsets_mm).run();
  return March(mesh, planes, offsets_mm).run();
}

}  // namespace hotblade::surface
