#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "elastica/project.hpp"
#include "elastica/standard_position.hpp"

namespace hotblade::elastica {

namespace {

// The step (in the logarithm) at which refining ends.
constexpr double kFinestStep = 1e-4;
// A valley may be long and narrow: steps that go down are lengthened, and the walk along it is bounded.
constexpr int kMostSteps = 600;

struct Candidate {
  double u, v, e;  // logarithms of both edges, score
};

class Valley {
 public:
  Valley(const StandardPosition& input, WantedBranch wanted) : input_(input), wanted_(wanted) {}

  [[nodiscard]] StandardPosition at(double u, double v) const {
    return {input_.a1, input_.a2, std::exp(u), std::exp(v)};
  }
  // Above 1 outside the domain or off the branch.
  [[nodiscard]] double operator()(double u, double v) const {
    constexpr double kOutside = 2;
    if (u < low() || v < low() || u > high() || v > high()) return kOutside;
    const StandardPosition s = at(u, v);
    if (edges_cross(s)) return kOutside;
    if (wanted_ != WantedBranch::kBest && inflectional(s) != (wanted_ == WantedBranch::kInflectional))
      return kOutside;
    return score(s);
  }
  static double low() { return std::log(kShortestEdge); }
  static double high() { return std::log(kLongestEdge); }

 private:
  StandardPosition input_;
  WantedBranch wanted_;
};

// Grid cells that no neighbour undercuts, best first.
std::vector<Candidate> grid_minima(const Valley& valley, const SearchOptions& options) {
  const int grid = options.grid;
  const double step = (Valley::high() - Valley::low()) / (grid - 1);
  std::vector<double> e(static_cast<std::size_t>(grid) * static_cast<std::size_t>(grid));
  const auto cell = [grid](int i, int j) { return static_cast<std::size_t>(i * grid + j); };
  for (int i = 0; i < grid; ++i) {
    for (int j = 0; j < grid; ++j) e[cell(i, j)] = valley(Valley::low() + i * step, Valley::low() + j * step);
  }
  std::vector<Candidate> minima;
  for (int i = 0; i < grid; ++i) {
    for (int j = 0; j < grid; ++j) {
      const double own = e[cell(i, j)];
      bool lowest = own <= 1;
      for (int k = std::max(0, i - 1); k <= std::min(grid - 1, i + 1) && lowest; ++k) {
        for (int l = std::max(0, j - 1); l <= std::min(grid - 1, j + 1); ++l)
          lowest = lowest && e[cell(k, l)] >= own;
      }
      if (lowest) minima.push_back({Valley::low() + i * step, Valley::low() + j * step, own});
    }
  }
  std::stable_sort(minima.begin(), minima.end(),
                   [](const Candidate& a, const Candidate& b) { return a.e < b.e; });
  if (minima.size() > options.refined) minima.resize(options.refined);
  return minima;
}

// Pattern search in eight directions: a step that found a way down is lengthened, one that did not is halved.
Candidate refine(const Valley& valley, Candidate best, double step) {
  for (int k = 0; k < kMostSteps && step > kFinestStep; ++k) {
    const Candidate from = best;
    for (const auto& [du, dv] : {std::pair{1.0, 0.0},
                                 {-1.0, 0.0},
                                 {0.0, 1.0},
                                 {0.0, -1.0},
                                 {1.0, 1.0},
                                 {-1.0, -1.0},
                                 {1.0, -1.0},
                                 {-1.0, 1.0}}) {
      const double u = std::clamp(from.u + step * du, Valley::low(), Valley::high()),
                   v = std::clamp(from.v + step * dv, Valley::low(), Valley::high());
      const double e = valley(u, v);
      if (e < best.e) best = {u, v, e};
    }
    step *= best.e < from.e ? 1.5 : 0.5;
  }
  return best;
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
  const Valley valley(*input, wanted);
  Candidate best{0, 0, 2};
  const double step = (Valley::high() - Valley::low()) / (options.grid - 1);
  for (const Candidate& start : grid_minima(valley, options)) {
    const Candidate found = refine(valley, start, step);
    if (found.e < best.e) best = found;
  }
  if (best.e > 1) return result;
  // The best there is counts as reached.
  return projection(b, *input, valley.at(best.u, best.v), 1);
}

}  // namespace hotblade::elastica
