#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "elastica/projection/project.hpp"
#include "elastica/projection/project_polish.hpp"
#include "elastica/projection/project_valleys.hpp"
#include "elastica/projection/project_valleys_table.hpp"

namespace hotblade::elastica {

namespace {

// Curves handled together: enough to fill the batches, few enough to stay in the cache.
constexpr std::size_t kChunk = 128;

// The table's starts of one curve.
void add_starts(double a1, double a2, WantedBranch wanted, std::size_t curve, std::vector<Descent>& descents,
                std::vector<std::size_t>& owners) {
  const ValleysNear near = valleys_near(a1, a2, wanted);
  const auto reaches = [&near](const Valley& v) {
    return near.x >= v.x0 && near.x <= v.x1 && near.y >= v.y0 && near.y <= v.y1;
  };
  // Between the places that the table knows, none may reach: then all are tried.
  const bool any = std::none_of(near.valleys.begin(), near.valleys.end(), reaches);
  for (const Valley& valley : near.valleys) {
    if (!any && !reaches(valley)) continue;
    const auto descent = valley_descent(a1, a2, wanted, valley, near.x, near.y);
    if (!descent) continue;
    descents.push_back(*descent);
    owners.push_back(curve);
  }
}

void solve_chunk(std::span<const double> a1, std::span<const double> a2, WantedBranch wanted,
                 std::span<OptimalEdges> out) {
  std::vector<Descent> descents;
  std::vector<std::size_t> owners;
  for (std::size_t i = 0; i < a1.size(); ++i) add_starts(a1[i], a2[i], wanted, i, descents, owners);
  descend(descents, kValleyEnd);
  for (std::size_t k = 0; k < descents.size(); ++k) {
    OptimalEdges& best = out[owners[k]];
    const double e = std::sqrt(descents[k].e2);
    if (e > 1 || (best.exists && e >= best.lambda_residual)) continue;
    best = {std::exp(descents[k].u), std::exp(descents[k].v), e, true};
  }
}

}  // namespace

ValleysNear valleys_near(double a1, double a2, WantedBranch wanted) {
  constexpr double kStep = 2 * std::numbers::pi / kValleyNodes;
  const auto node = [](double a) {
    return std::clamp(static_cast<int>(std::floor((a + std::numbers::pi) / kStep)), 0, kValleyNodes - 1);
  };
  const int i = node(a1), j = node(a2);
  const std::size_t k =
      static_cast<std::size_t>((static_cast<int>(wanted) * kValleyNodes + i) * kValleyNodes + j);
  const std::uint32_t first = kFirstValley[k], end = kFirstValley[k + 1];
  return {{kValleys + first, kValleys + end},
          a1 + std::numbers::pi - (i + 0.5) * kStep,
          a2 + std::numbers::pi - (j + 0.5) * kStep};
}

void optimal_edges(std::span<const double> a1, std::span<const double> a2, WantedBranch wanted,
                   std::span<OptimalEdges> out) {
  if (a1.size() != a2.size() || a1.size() != out.size())
    throw std::logic_error("optimal_edges: spans of different sizes");
  for (std::size_t i = 0; i < a1.size(); i += kChunk) {
    const std::size_t n = std::min(kChunk, a1.size() - i);
    std::fill_n(out.begin() + static_cast<std::ptrdiff_t>(i), n, OptimalEdges{});
    solve_chunk(a1.subspan(i, n), a2.subspan(i, n), wanted, out.subspan(i, n));
  }
}

void project_optimal(std::span<const Bezier> beziers, WantedBranch wanted, std::span<Projection> out) {
  if (beziers.size() != out.size()) throw std::logic_error("project_optimal: spans of different sizes");
  for (std::size_t start = 0; start < beziers.size(); start += kChunk) {
    const std::size_t n = std::min(kChunk, beziers.size() - start);
    std::vector<StandardPosition> inputs;
    std::vector<std::size_t> places;
    std::vector<double> a1, a2;
    for (std::size_t i = start; i < start + n; ++i) {
      const auto s = standard_position(beziers[i]);
      Projection& p = out[i];
      p.bezier = beziers[i];
      p.lambda_residual = 0;
      p.branch = Branch::kPlain;
      p.moved = {0, 0};
      p.angle_constraints_hold = s && angle_constraints_hold(*s);
      p.status = ProjectStatus::kUnsupported;
      if (!s) continue;
      inputs.push_back(*s);
      places.push_back(i);
      a1.push_back(s->a1);
      a2.push_back(s->a2);
    }
    std::vector<OptimalEdges> found(inputs.size());
    optimal_edges(a1, a2, wanted, found);
    for (std::size_t k = 0; k < found.size(); ++k) {
      const StandardPosition s{a1[k], a2[k], found[k].l1, found[k].l2};
      if (!found[k].exists) continue;
      Projection& p = out[places[k]];
      p.bezier = with_edges(p.bezier, inputs[k], s);
      p.lambda_residual = found[k].lambda_residual;
      p.branch = inflectional(s) ? Branch::kInflectional : Branch::kPlain;
      p.moved = {s.l1 - inputs[k].l1, s.l2 - inputs[k].l2};
      p.status = ProjectStatus::kReached;
    }
  }
}

Projection project_optimal(const Bezier& bezier, WantedBranch wanted) {
  Projection out;
  project_optimal({&bezier, 1}, wanted, {&out, 1});
  return out;
}

}  // namespace hotblade::elastica
