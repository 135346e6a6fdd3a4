#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "elastica/bezier/standard_position.hpp"
#include "elastica/projection/project.hpp"
#include "elastica/projection/project_polish.hpp"

namespace hotblade::elastica {

namespace {

// Rays from the input over the whole circle, and radii on each: a region that is narrower than 1/40 of the
// move, and does not hold the optimum, may be missed.
constexpr int kRays = 256, kRadii = 64;
// Rays of one refinement, an odd number so that the best one stays among them; their span shrinks to a third
// each time.
constexpr int kNearRays = 17, kNearRadii = 24, kRefinements = 14;
constexpr double kShrink = 1.0 / 3;
constexpr std::size_t kRefined = 4;
constexpr int kBisections = 24;
// Batches and single curves agree on residuals to this.
constexpr double kAgree = 2e-9;

struct Ray {
  double angle = 0, reach = 0;  // direction in the (L1, L2) plane; how far it is looked along
  double inside = 0;            // smallest radius known to be served; 0: none
  double outside = 0;           // a smaller radius that is not
};

// The plane of both end edges seen from the input's: which moves reach the threshold.
class Moves {
 public:
  Moves(const StandardPosition& input, WantedBranch wanted, double threshold)
      : input_(input), wanted_(wanted), most_e2_(threshold * threshold) {}

  [[nodiscard]] StandardPosition at(double angle, double radius) const {
    return {input_.a1, input_.a2, input_.l1 + radius * std::cos(angle), input_.l2 + radius * std::sin(angle)};
  }

  [[nodiscard]] std::vector<char> served(const std::vector<StandardPosition>& places) const {
    std::vector<double> u, v;
    std::vector<char> good;
    for (const StandardPosition& s : places) {
      const bool inside = std::min(s.l1, s.l2) >= kShortestEdge && std::max(s.l1, s.l2) <= kLongestEdge;
      const bool branch =
          wanted_ == WantedBranch::kBest || inflectional(s) == (wanted_ == WantedBranch::kInflectional);
      good.push_back(inside && branch ? 1 : 0);
      u.push_back(inside ? std::log(s.l1) : 0);
      v.push_back(inside ? std::log(s.l2) : 0);
    }
    const std::vector<double> e2 = squared_residuals(input_.a1, input_.a2, u, v);
    for (std::size_t i = 0; i < good.size(); ++i) good[i] = good[i] && e2[i] <= most_e2_ ? 1 : 0;
    return good;
  }

  // Looks along every ray at `radii` even radii, then halves the interval before the first served one.
  void look(std::vector<Ray>& rays, int radii) const {
    std::vector<StandardPosition> places;
    for (const Ray& ray : rays) {
      for (int k = 1; k <= radii; ++k) places.push_back(at(ray.angle, ray.reach * k / radii));
    }
    const std::vector<char> good = served(places);
    for (std::size_t r = 0; r < rays.size(); ++r) {
      const auto first = good.begin() + static_cast<std::ptrdiff_t>(r) * radii;
      const auto hit = std::find(first, first + radii, 1);
      if (hit == first + radii) continue;
      const double k = static_cast<double>(hit - first);
      rays[r].outside = rays[r].reach * k / radii;
      rays[r].inside = rays[r].reach * (k + 1) / radii;
    }
    std::erase_if(rays, [](const Ray& ray) { return ray.inside == 0; });
    for (int step = 0; step < kBisections; ++step) {
      places.clear();
      for (const Ray& ray : rays) places.push_back(at(ray.angle, 0.5 * (ray.inside + ray.outside)));
      const std::vector<char> middle = served(places);
      for (std::size_t r = 0; r < rays.size(); ++r) {
        (middle[r] ? rays[r].inside : rays[r].outside) = 0.5 * (rays[r].inside + rays[r].outside);
      }
    }
  }

  // The shortest ray near `best`, whose neighbours lie `span` away.
  [[nodiscard]] Ray refined(Ray best, double span) const {
    for (int k = 0; k < kRefinements; ++k, span *= kShrink) {
      std::vector<Ray> rays;
      for (int i = 0; i < kNearRays; ++i) {
        const int offset = i - kNearRays / 2;
        if (offset != 0) rays.push_back({best.angle + span * offset / (kNearRays / 2), best.inside});
      }
      look(rays, kNearRadii);
      for (const Ray& ray : rays) {
        if (ray.inside < best.inside) best = ray;
      }
    }
    return best;
  }

 private:
  StandardPosition input_;
  WantedBranch wanted_;
  double most_e2_;
};

// The local minima of the radius around the circle, shortest first; the last ray stands alone.
std::vector<Ray> shortest(const std::vector<Ray>& rays) {
  std::vector<Ray> list;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Ray &before = rays[(i + rays.size() - 1) % rays.size()], &after = rays[(i + 1) % rays.size()];
    if (rays[i].inside <= before.inside && rays[i].inside <= after.inside) list.push_back(rays[i]);
  }
  std::stable_sort(list.begin(), list.end(), [](const Ray& a, const Ray& b) { return a.inside < b.inside; });
  if (list.size() > kRefined) list.resize(kRefined);
  return list;
}

}  // namespace

Projection project_smallest_move(const Bezier& b, WantedBranch wanted, double threshold) {
  const Projection optimum = project_optimal(b, wanted);
  if (optimum.status == ProjectStatus::kUnsupported) return optimum;
  const StandardPosition input = *standard_position(b), most = *standard_position(optimum.bezier);
  if (optimum.lambda_residual > threshold - kAgree) return projection(b, input, most, threshold);
  const Moves moves(input, wanted, threshold - kAgree);
  if (moves.served({input}).front()) return projection(b, input, input, threshold);
  const double reach = std::hypot(optimum.moved[0], optimum.moved[1]),
               towards = std::atan2(optimum.moved[1], optimum.moved[0]);
  std::vector<Ray> rays;
  for (int i = 0; i < kRays; ++i) rays.push_back({towards + 2 * std::numbers::pi * i / kRays, reach});
  moves.look(rays, kRadii);
  Ray best{towards, reach, reach};
  std::vector<Ray> starts = shortest(rays);
  starts.push_back(best);
  for (const Ray& start : starts) {
    const Ray found = moves.refined(start, 4 * std::numbers::pi / kRays);
    if (found.inside < best.inside) best = found;
  }
  return projection(b, input, moves.at(best.angle, best.inside), threshold);
}

}  // namespace hotblade::elastica
