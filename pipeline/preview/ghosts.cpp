#include "pipeline/preview/ghosts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace hotblade::pipeline::preview {
namespace {

// Ghosts a strip: enough to read the motion, few enough to see the surface between them.
constexpr int kGhosts = 8;
constexpr int kLinePoints = 161;  // a blade of 1500 mm in steps under 10 mm

// Tells over which strip a point lies.
class StripMap {
 public:
  StripMap(const CutSurface& cut, std::size_t strips) : samples_(strips) {
    // A few hundred points a strip: strips are told apart at clamps, which keep clear of their own by
    // centimetres.
    constexpr std::size_t kSamples = 20000;
    const std::size_t step = std::max<std::size_t>(1, cut.vertices.size() / kSamples);
    for (std::size_t i = 0; i < cut.vertices.size(); i += step) {
      samples_[static_cast<std::size_t>(cut.strip_of_vertex[i])].push_back(cut.vertices[i]);
    }
  }

  // Is another strip's cut nearer than this strip's own?
  [[nodiscard]] bool over_another(const Eigen::Vector3d& point, std::size_t own) const {
    const double to_own = squared_distance(point, own);
    for (std::size_t strip = 0; strip < samples_.size(); ++strip) {
      if (strip != own && squared_distance(point, strip) < to_own) return true;
    }
    return false;
  }

 private:
  [[nodiscard]] double squared_distance(const Eigen::Vector3d& point, std::size_t strip) const {
    double least = std::numeric_limits<double>::infinity();
    for (const Eigen::Vector3d& sample : samples_[strip])
      least = std::min(least, (sample - point).squaredNorm());
    return least;
  }

  std::vector<std::vector<Eigen::Vector3d>> samples_;
};

struct Cutting {
  std::vector<const BladePose*> poses;
  std::vector<double> way;  // of the middle between the clamps, mm
};

Cutting cutting_of(const Strip& strip) {
  Cutting cutting;
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
  for (const BladePose& pose : strip.poses) {
    if (!pose.foam) continue;
    const Eigen::Vector3d middle = (pose.a.p + pose.b.p) / 2;
    cutting.way.push_back(cutting.poses.empty() ? 0 : cutting.way.back() + (middle - last).norm());
    cutting.poses.push_back(&pose);
    last = middle;
  }
  return cutting;
}

// Adds both ends of the blade; returns how many were left out.
int add_ends(Scene& scene, const BladePose& pose, const StripMap& map, std::size_t strip) {
  const auto [s0, s1] = *pose.foam;
  int left_out = 0;
  const auto add = [&](const Pose& clamp, std::vector<Pose>& clamps, double from, double to) {
    if (map.over_another(clamp.p, strip)) {
      ++left_out;
      return;
    }
    clamps.push_back(clamp);
    scene.blades.push_back(line_of(pose.frame, elastica::segment(pose.blade, from, to)));
  };
  add(pose.a, scene.clamps_a, 0, s0);
  add(pose.b, scene.clamps_b, s1, pose.blade.length);
  return left_out;
}

}  // namespace

Polyline line_of(const Frame& frame, const elastica::Elastica& curve) {
  Polyline line;
  for (const auto& point : elastica::sample(curve, kLinePoints))
    line.points.push_back(frame.point(point.x, point.y));
  return line;
}

void add_ghosts(Scene& scene, const Program& program) {
  const StripMap map(scene.cut, program.strips.size());
  int left_out = 0;
  double longest_step = 0;
  for (std::size_t strip = 0; strip < program.strips.size(); ++strip) {
    const Cutting cutting = cutting_of(program.strips[strip]);
    if (cutting.poses.empty()) continue;
    const double step = cutting.way.back() / (kGhosts - 1);
    longest_step = std::max(longest_step, step);
    for (int ghost = 0; ghost < kGhosts; ++ghost) {
      const auto found =
          std::lower_bound(cutting.way.begin(), cutting.way.end(), ghost * step) - cutting.way.begin();
      const auto index = std::min(static_cast<std::size_t>(found), cutting.poses.size() - 1);
      left_out += add_ends(scene, *cutting.poses[index], map, strip);
    }
  }
  if (scene.blades.empty()) return;
  scene.blade_note = fmt::format("blade every {:.0f} mm", longest_step);
  if (left_out > 0) scene.caption.push_back("blade ends over other strips are left out: --strip shows them");
}

}  // namespace hotblade::pipeline::preview
