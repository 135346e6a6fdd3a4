#include "gpu/mesh_distance.hpp"

#include <embree3/rtcore.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace hotblade::gpu {
namespace {

using Eigen::Vector3d;

// Points answered one after the other by one thread, each search started from the answer before.
constexpr std::size_t kBlock = 256;

// Unit roundoff of the single-precision search tree.
constexpr double kEps32 = 0x1p-24;

// Points farther than this many mesh sizes are compared with every triangle: the slack below then reaches the
// mesh's own size, so the tree would exclude nothing.
constexpr double kFar = 0x1p+20;

// The search radius for a known distance. With the mesh scaled into [-1, 1]^3: rounding a vertex moves a box
// by at most sqrt(3) eps, rounding the point moves it by at most sqrt(3) eps |q|; the box distance
// (difference, square, two sums) and the radius (conversion, square) lose less than 6 eps of their value.
// Rounded up to 2 and 8.
double search_radius(double distance, double point_size) {
  return distance * (1 + 8 * kEps32) + 2 * kEps32 * (1 + point_size);
}

// A triangle with its longest edge first: origin, the two edges from there, and the part of the second edge
// square to the first. Projecting on the longest edge first keeps the error at rounding size for needles and
// caps.
struct Prepared {
  Vector3d a, e0, e1, h;
  double inv_e0 = 0, inv_e1 = 0, inv_e2 = 0, inv_h = 0;  // 1 / squared length, 0 when that underflows
  double shear = 0;                                      // e1 = shear e0 + h
};

double inverse(double squared_length) {
  return squared_length > std::numeric_limits<double>::min() ? 1 / squared_length : 0;
}

Prepared prepare(std::array<Vector3d, 3> p) {
  const double l0 = (p[1] - p[0]).squaredNorm(), l1 = (p[2] - p[1]).squaredNorm(),
               l2 = (p[0] - p[2]).squaredNorm();
  if (l1 > l0 && l1 >= l2) {
    std::rotate(p.begin(), p.begin() + 1, p.end());
  } else if (l2 > l0) {
    std::rotate(p.begin(), p.begin() + 2, p.end());
  }
  Prepared t;
  t.a = p[0];
  t.e0 = p[1] - p[0];
  t.e1 = p[2] - p[0];
  t.inv_e0 = inverse(t.e0.squaredNorm());
  t.inv_e1 = inverse(t.e1.squaredNorm());
  t.inv_e2 = inverse((p[2] - p[1]).squaredNorm());
  t.shear = t.e1.dot(t.e0) * t.inv_e0;
  t.h = t.e1 - t.shear * t.e0;
  t.inv_h = inverse(t.h.squaredNorm());
  return t;
}

struct Closest {
  double distance_sq = std::numeric_limits<double>::infinity();
  Vector3d offset{0, 0, 0};  // from the triangle's origin a
};

Closest closest(const Prepared& t, const Vector3d& q) {
  const Vector3d r = q - t.a;
  const double along = r.dot(t.e0) * t.inv_e0;
  const double v = (r - along * t.e0).dot(t.h) * t.inv_h;
  const double u = along - v * t.shear;
  Closest best;
  const auto consider = [&](const Vector3d& offset) {
    const double d = (r - offset).squaredNorm();
    if (d < best.distance_sq) best = {d, offset};
  };
  if (t.inv_h > 0 && u >= 0 && v >= 0 && u + v <= 1) {
    consider(u * t.e0 + v * t.e1);
    return best;
  }
  const Vector3d e2 = t.e1 - t.e0;
  consider(std::clamp(along, 0.0, 1.0) * t.e0);
  consider(std::clamp(r.dot(t.e1) * t.inv_e1, 0.0, 1.0) * t.e1);
  consider(t.e0 + std::clamp((r - t.e0).dot(e2) * t.inv_e2, 0.0, 1.0) * e2);
  return best;
}

// One search under way: the best triangle so far, in the scaled frame.
struct Search {
  const std::vector<Prepared>* triangles = nullptr;
  Vector3d q{0, 0, 0};
  double size = 0;  // largest |coordinate| of q
  int triangle = -1;
  Closest best;

  // Takes the triangle when it is nearer, or as near and lower in index. Returns whether it is nearer.
  bool consider(int index) {
    const Closest c = closest((*triangles)[static_cast<std::size_t>(index)], q);
    const bool nearer = c.distance_sq < best.distance_sq;
    if (nearer || triangle < 0 || (c.distance_sq == best.distance_sq && index < triangle)) {
      best = c;
      triangle = index;
    }
    return nearer;
  }
  float radius() const { return static_cast<float>(search_radius(std::sqrt(best.distance_sq), size)); }
};

bool visit_triangle(RTCPointQueryFunctionArguments* args) {
  auto& search = *static_cast<Search*>(args->userPtr);
  if (!search.consider(static_cast<int>(args->primID))) return false;
  args->query->radius = std::min(args->query->radius, search.radius());
  return true;
}

void check_input(std::span<const Vector3d> vertices, std::span<const std::array<int, 3>> triangles) {
  if (triangles.empty()) throw std::logic_error("MeshDistance: no triangles");
  for (const Vector3d& v : vertices) {
    if (!v.allFinite()) throw std::logic_error("MeshDistance: a vertex is not finite");
  }
  for (const auto& t : triangles) {
    for (const int i : t) {
      if (i < 0 || static_cast<std::size_t>(i) >= vertices.size()) {
        throw std::logic_error("MeshDistance: vertex index " + std::to_string(i) + " out of range, " +
                               std::to_string(vertices.size()) + " vertices");
      }
    }
  }
}

template <auto kRelease>
struct Releaser {
  template <typename T>
  void operator()(T* handle) const {
    kRelease(handle);
  }
};
using Device = std::unique_ptr<RTCDeviceTy, Releaser<rtcReleaseDevice>>;
using Scene = std::unique_ptr<RTCSceneTy, Releaser<rtcReleaseScene>>;
using Geometry = std::unique_ptr<RTCGeometryTy, Releaser<rtcReleaseGeometry>>;

}  // namespace

struct MeshDistance::Impl {
  Vector3d centre{0, 0, 0};
  double scale = 1;  // a power of two; (p - centre) * scale lies in [-1, 1]^3
  std::vector<Prepared> triangles;
  Device device;
  Scene scene;

  void fit_frame(std::span<const Vector3d> vertices, std::span<const std::array<int, 3>> faces);
  void build_tree(const std::vector<Vector3d>& scaled, std::span<const std::array<int, 3>> faces);
  int search(const Vector3d& point, int start, Nearest& answer) const;
};

// Only vertices that a triangle uses count: a stray one far away would cost precision.
void MeshDistance::Impl::fit_frame(std::span<const Vector3d> vertices,
                                   std::span<const std::array<int, 3>> faces) {
  Vector3d low = vertices[static_cast<std::size_t>(faces[0][0])], high = low;
  for (const auto& face : faces) {
    for (const int i : face) {
      low = low.cwiseMin(vertices[static_cast<std::size_t>(i)]);
      high = high.cwiseMax(vertices[static_cast<std::size_t>(i)]);
    }
  }
  centre = 0.5 * low + 0.5 * high;
  const double half = (high - centre).cwiseMax(centre - low).maxCoeff();
  int exponent = 0;
  if (half > 0) std::frexp(half, &exponent);
  scale = std::ldexp(1.0, std::clamp(-exponent, -1000, 1000));
}

void MeshDistance::Impl::build_tree(const std::vector<Vector3d>& scaled,
                                    std::span<const std::array<int, 3>> faces) {
  device.reset(rtcNewDevice(nullptr));
  if (!device) throw std::runtime_error("MeshDistance: no search device");
  scene.reset(rtcNewScene(device.get()));
  const Geometry geometry(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE));
  auto* xyz = static_cast<float*>(rtcSetNewGeometryBuffer(
      geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), scaled.size()));
  auto* index = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
      geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), faces.size()));
  if (xyz == nullptr || index == nullptr) throw std::runtime_error("MeshDistance: out of memory");
  for (const Vector3d& v : scaled) {
    for (int k = 0; k < 3; ++k) *xyz++ = static_cast<float>(v[k]);
  }
  for (const auto& face : faces) {
    for (const int i : face) *index++ = static_cast<unsigned>(i);
  }
  rtcSetGeometryPointQueryFunction(geometry.get(), visit_triangle);
  rtcCommitGeometry(geometry.get());
  rtcAttachGeometry(scene.get(), geometry.get());
  rtcCommitScene(scene.get());
  if (rtcGetDeviceError(device.get()) != RTC_ERROR_NONE) {
    throw std::runtime_error("MeshDistance: the search tree could not be built");
  }
}

// Answers one point; `start` is a triangle likely to be near. Returns the nearest triangle.
int MeshDistance::Impl::search(const Vector3d& point, int start, Nearest& answer) const {
  Search s;
  s.triangles = &triangles;
  s.q = (point - centre) * scale;
  s.size = s.q.cwiseAbs().maxCoeff();
  s.consider(start);
  if (s.size > kFar) {
    for (int i = 0; i < static_cast<int>(triangles.size()); ++i) s.consider(i);
  } else {
    RTCPointQuery query{static_cast<float>(s.q.x()), static_cast<float>(s.q.y()), static_cast<float>(s.q.z()),
                        0, s.radius()};
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    rtcPointQuery(scene.get(), &query, &context, nullptr, &s);
  }
  answer.distance = std::sqrt(s.best.distance_sq) / scale;
  answer.triangle = s.triangle;
  answer.point = centre + (triangles[static_cast<std::size_t>(s.triangle)].a + s.best.offset) / scale;
  return s.triangle;
}

MeshDistance::MeshDistance(std::span<const Vector3d> vertices,
                           std::span<const std::array<int, 3>> triangles) {
  check_input(vertices, triangles);
  impl_ = std::make_unique<Impl>();
  impl_->fit_frame(vertices, triangles);
  // Unused vertices may lie anywhere; they are kept for their index, at the centre.
  std::vector<Vector3d> scaled(vertices.size(), Vector3d::Zero());
  for (const auto& t : triangles) {
    std::array<Vector3d, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto i = static_cast<std::size_t>(t[k]);
      corners[k] = scaled[i] = (vertices[i] - impl_->centre) * impl_->scale;
    }
    impl_->triangles.push_back(prepare(corners));
  }
  impl_->build_tree(scaled, triangles);
}

MeshDistance::~MeshDistance() = default;
MeshDistance::MeshDistance(MeshDistance&&) noexcept = default;
MeshDistance& MeshDistance::operator=(MeshDistance&&) noexcept = default;

std::vector<Nearest> MeshDistance::query(std::span<const Vector3d> points) const {
  for (const Vector3d& p : points) {
    if (!p.allFinite()) throw std::logic_error("MeshDistance::query: a point is not finite");
  }
  std::vector<Nearest> answers(points.size());
  const std::size_t blocks = (points.size() + kBlock - 1) / kBlock;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, blocks, 1), [&](const auto& range) {
    for (std::size_t block = range.begin(); block != range.end(); ++block) {
      const std::size_t end = std::min(points.size(), (block + 1) * kBlock);
      int triangle = 0;
      for (std::size_t i = block * kBlock; i < end; ++i)
        triangle = impl_->search(points[i], triangle, answers[i]);
    }
  });
  return answers;
}

std::string backend_name() {
  return "cpu-embree";
}

}  // namespace hotblade::gpu
