#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "elastica/bezier/standard_position.hpp"
#include "elastica/projection/project.hpp"
#include "elastica/projection/project_polish.hpp"

namespace hotblade::elastica {

namespace {

// The step (in the logarithm) at which refining ends.
constexpr double kFinestStep = 1e-4;
// A valley may be long and narrow: steps that go down are lengthened, and the walk along it is bounded.
constexpr int kMostSteps = 600;

struct Candidate {
  double u, v, e2;  // logarithms of both edges, squared residual
  double step = 0;
};

// Squared residuals of one pair of end directions on one branch; above 1 where there is no curve.
class Landscape {
 public:
  Landscape(const StandardPosition& input, WantedBranch wanted) : input_(input), wanted_(wanted) {}

  [[nodiscard]] StandardPosition at(double u, double v) const {
    return {input_.a1, input_.a2, std::exp(u), std::exp(v)};
  }
  [[nodiscard]] std::vector<double> operator()(const std::vector<double>& u,
                                               const std::vector<double>& v) const {
    std::vector<double> e2 = squared_residuals(input_.a1, input_.a2, u, v);
    if (wanted_ == WantedBranch::kBest) return e2;
    constexpr double kOffBranch = 4;
    for (std::size_t i = 0; i < e2.size(); ++i) {
      if (inflectional(at(u[i], v[i])) != (wanted_ == WantedBranch::kInflectional)) e2[i] = kOffBranch;
    }
    return e2;
  }

 private:
  StandardPosition input_;
  WantedBranch wanted_;
};

// Grid places that no neighbour undercuts, best first.
std::vector<Candidate> grid_minima(const Landscape& landscape, const SearchOptions& options) {
  const int grid = options.grid;
  const EdgeBox all = edge_domain();
  const double step = (all.u1 - all.u0) / (grid - 1);
  std::vector<double> u, v;
  for (int i = 0; i < grid; ++i) {
    for (int j = 0; j < grid; ++j) {
      u.push_back(std::min(all.u1, all.u0 + i * step));
      v.push_back(std::min(all.v1, all.v0 + j * step));
    }
  }
  const std::vector<double> e2 = landscape(u, v);
  const auto place = [grid](int i, int j) { return static_cast<std::size_t>(i * grid + j); };
  std::vector<Candidate> minima;
  for (int i = 0; i < grid; ++i) {
    for (int j = 0; j < grid; ++j) {
      const double own = e2[place(i, j)];
      bool lowest = own <= 1;
      for (int k = std::max(0, i - 1); k <= std::min(grid - 1, i + 1) && lowest; ++k) {
        for (int l = std::max(0, j - 1); l <= std::min(grid - 1, j + 1); ++l)
          lowest = lowest && e2[place(k, l)] >= own;
      }
      if (lowest) minima.push_back({u[place(i, j)], v[place(i, j)], own, step});
    }
  }
  std::stable_sort(minima.begin(), minima.end(),
                   [](const Candidate& a, const Candidate& b) { return a.e2 < b.e2; });
  if (minima.size() > options.refined) minima.resize(options.refined);
  return minima;
}

// Pattern search in eight directions, all candidates at once: a step that found a way down is lengthened, one
// that did not is halved.
void refine(const Landscape& landscape, std::vector<Candidate>& candidates) {
  const EdgeBox all = edge_domain();
  std::vector<double> u, v;
  for (int k = 0; k < kMostSteps; ++k) {
    u.clear();
    v.clear();
    for (const Candidate& c : candidates) {
      if (!(c.step > kFinestStep)) continue;
      for (int i = -1; i <= 1; ++i) {
        for (int j = -1; j <= 1; ++j) {
          if (i == 0 && j == 0) continue;
          u.push_back(std::clamp(c.u + c.step * i, all.u0, all.u1));
          v.push_back(std::clamp(c.v + c.step * j, all.v0, all.v1));
        }
      }
    }
    if (u.empty()) return;
    const std::vector<double> e2 = landscape(u, v);
    std::size_t at = 0;
    for (Candidate& c : candidates) {
      if (!(c.step > kFinestStep)) continue;
      const double from = c.e2;
      for (const std::size_t end = at + 8; at < end; ++at) {
        if (e2[at] < c.e2) c = {u[at], v[at], e2[at], c.step};
      }
      c.step *= c.e2 < from ? 1.5 : 0.5;
    }
  }
}

}  // namespace

Projection project_optimal_search(const Bezier& b, WantedBranch wanted, const SearchOptions& options) {
  if (options.grid < 2) throw std::logic_error("project_optimal_search needs at least a 2 x 2 grid");
  Projection result;
  result.bezier = b;
  result.status = ProjectStatus::kUnsupported;
  const auto input = standard_position(b);
  if (!input) return result;
  result.angle_constraints_hold = angle_constraints_hold(*input);
  const Landscape landscape(*input, wanted);
  std::vector<Candidate> candidates = grid_minima(landscape, options);
  refine(landscape, candidates);
  const auto best = std::min_element(candidates.begin(), candidates.end(),
                                     [](const Candidate& x, const Candidate& y) { return x.e2 < y.e2; });
  if (best == candidates.end() || best->e2 > 1) return result;
  // The best there is counts as reached.
  return projection(b, *input, landscape.at(best->u, best->v), 1);
}

}  // namespace hotblade::elastica
