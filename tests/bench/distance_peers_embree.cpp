#include <embree3/rtcore.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/bench/distance_peers.hpp"

namespace hotblade::bench {
namespace {

struct Float3 {
  float x, y, z;
};
Float3 operator-(Float3 a, Float3 b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
Float3 operator+(Float3 a, Float3 b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
Float3 operator*(float s, Float3 a) {
  return {s * a.x, s * a.y, s * a.z};
}
float dot(Float3 a, Float3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

// Nearest point by the regions of Ericson, Real-Time Collision Detection, 5.1.5.
Float3 nearest(Float3 p, Float3 a, Float3 b, Float3 c) {
  const Float3 ab = b - a, ac = c - a, ap = p - a;
  const float d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const Float3 bp = p - b;
  const float d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return b;
  const float vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + (d1 / (d1 - d3)) * ab;
  const Float3 cp = p - c;
  const float d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return c;
  const float vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + (d2 / (d2 - d6)) * ac;
  const float va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) return b + ((d4 - d3) / ((d4 - d3) + (d5 - d6))) * (c - b);
  const float scale = 1 / (va + vb + vc);
  return a + (vb * scale) * ab + (vc * scale) * ac;
}

struct Search {
  const float* vertices;
  const unsigned* triangles;
  float best_sq = std::numeric_limits<float>::infinity();
  unsigned triangle = 0;

  bool consider(Float3 p, unsigned index) {
    const auto corner = [&](unsigned k) {
      const float* v = vertices + 3 * triangles[3 * index + k];
      return Float3{v[0], v[1], v[2]};
    };
    const Float3 d = p - nearest(p, corner(0), corner(1), corner(2));
    const float sq = dot(d, d);
    if (!(sq < best_sq)) return false;
    best_sq = sq;
    triangle = index;
    return true;
  }
};

bool visit(RTCPointQueryFunctionArguments* args) {
  auto& search = *static_cast<Search*>(args->userPtr);
  if (!search.consider({args->query->x, args->query->y, args->query->z}, args->primID)) return false;
  args->query->radius = std::sqrt(search.best_sq);
  return true;
}

class Embree : public Peer {
 public:
  explicit Embree(const PeerMesh& mesh) : device_(rtcNewDevice(nullptr)), scene_(rtcNewScene(device_)) {
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    vertices_ = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                                            RTC_FORMAT_FLOAT3, 12, mesh.vertices.size()));
    triangles_ = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0,
                                                                RTC_FORMAT_UINT3, 12, mesh.triangles.size()));
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) vertices_[3 * i + k] = static_cast<float>(mesh.vertices[i][k]);
    }
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) triangles_[3 * i + k] = static_cast<unsigned>(mesh.triangles[i][k]);
    }
    rtcSetGeometryPointQueryFunction(geometry, visit);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
  }
  ~Embree() override {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  Embree(const Embree&) = delete;
  Embree& operator=(const Embree&) = delete;

  void query(const std::vector<std::array<double, 3>>& points,
             std::vector<double>& distances) const override {
    constexpr std::size_t kBlock = 256;
    distances.resize(points.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.size(), kBlock), [&](const auto& range) {
      unsigned last = 0;
      for (std::size_t i = range.begin(); i != range.end(); ++i) {
        const auto x = static_cast<float>(points[i][0]), y = static_cast<float>(points[i][1]),
                   z = static_cast<float>(points[i][2]);
        Search search{vertices_, triangles_};
        search.consider({x, y, z}, last);
        RTCPointQuery query{x, y, z, 0, std::sqrt(search.best_sq)};
        RTCPointQueryContext context;
        rtcInitPointQueryContext(&context);
        rtcPointQuery(scene_, &query, &context, nullptr, &search);
        last = search.triangle;
        distances[i] = static_cast<double>(std::sqrt(search.best_sq));
      }
    });
  }

 private:
  RTCDevice device_;
  RTCScene scene_;
  float* vertices_ = nullptr;
  unsigned* triangles_ = nullptr;
};

}  // namespace

std::unique_ptr<Peer> embree_from_last(const PeerMesh& mesh) {
  return std::make_unique<Embree>(mesh);
}

}  // namespace hotblade::bench
