#include "pipeline/preview/ghosts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pipeline/preview/picture_texts.hpp"

namespace hotblade::pipeline::preview {
namespace {

// Ghosts a strip: enough to read the motion, few enough to see the surface between them.
constexpr int kGhosts = 8;
constexpr double kMostPoints = 161;  // a blade of 1500 mm in steps under 10 mm
constexpr double kFewestPoints = 9;  // a quarter of a circle has 11 degrees from one to the next

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

// Adds both ends of the blade.
void add_ends(Ghosts& ghosts, const Strip& strip, std::size_t index, const BladePose& pose,
              const StripMap& map, double seen) {
  const auto [s0, s1] = *pose.foam;
  const std::array<int, 2> place{static_cast<int>(index), static_cast<int>(&pose - strip.poses.data())};
  const auto add = [&](const Pose& clamp, std::vector<Pose>& clamps, double from, double to) {
    if (map.over_another(clamp.p, index)) {
      ghosts.left_out = true;
      return;
    }
    clamps.push_back(clamp);
    ghosts.blades.push_back(line_of(pose.frame, elastica::segment(pose.blade, from, to), seen));
    ghosts.pose_of_blade.push_back(place);
  };
  add(pose.a, ghosts.clamps_a, 0, s0);
  add(pose.b, ghosts.clamps_b, s1, pose.blade.length);
}

// The step asked for, wide enough that the picture stays readable and quick; none: none was asked for.
std::optional<double> possible_step(const std::vector<Cutting>& cuttings, std::optional<double> step_mm) {
  constexpr double kMostGhosts = 1500;
  if (!step_mm) return std::nullopt;
  double way = 0;
  for (const Cutting& cutting : cuttings) way += cutting.way.empty() ? 0 : cutting.way.back();
  return std::max(*step_mm, way / kMostGhosts);
}

}  // namespace

double seen_mm(const Program& program) {
  constexpr double kFinest = 2.5, kStepsAcross = 400;
  const Eigen::Vector3d size = program.design.bbox_mm[1] - program.design.bbox_mm[0];
  return std::max(kFinest, size.norm() / kStepsAcross);
}

Polyline line_of(const Frame& frame, const elastica::Elastica& curve, double step_mm) {
  Polyline line;
  const double points = step_mm > 0
                            ? std::clamp(std::ceil(curve.length / step_mm) + 1, kFewestPoints, kMostPoints)
                            : kMostPoints;
  for (const auto& point : elastica::sample(curve, static_cast<int>(points)))
    line.points.push_back(frame.point(point.x, point.y));
  return line;
}

Ghosts ghosts_of(const CutSurface& cut, const Program& program, std::optional<double> step_mm) {
  const StripMap map(cut, program.strips.size());
  std::vector<Cutting> cuttings;
  for (const Strip& strip : program.strips) cuttings.push_back(cutting_of(strip));
  const std::optional<double> given = possible_step(cuttings, step_mm);
  const double seen = seen_mm(program);
  Ghosts ghosts;
  double longest_step = 0;
  for (std::size_t strip = 0; strip < cuttings.size(); ++strip) {
    const Cutting& cutting = cuttings[strip];
    if (cutting.poses.empty()) continue;
    const double way = cutting.way.back(), step = given.value_or(way / (kGhosts - 1));
    const int count = given ? static_cast<int>(way / step) + 1 : kGhosts;
    longest_step = std::max(longest_step, step);
    for (int ghost = 0; ghost < count; ++ghost) {
      const auto found =
          std::lower_bound(cutting.way.begin(), cutting.way.end(), ghost * step) - cutting.way.begin();
      const auto index = std::min(static_cast<std::size_t>(found), cutting.poses.size() - 1);
      add_ends(ghosts, program.strips[strip], strip, *cutting.poses[index], map, seen);
    }
  }
  if (!ghosts.blades.empty()) ghosts.note = text_of(PictureText::kBladeEvery, longest_step);
  return ghosts;
}

}  // namespace hotblade::pipeline::preview
