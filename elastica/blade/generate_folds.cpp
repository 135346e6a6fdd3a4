// Writes the tables of fold_table.hpp as C++: generate_folds FILE. Run by the build.
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include "elastica/blade/end_map.hpp"
#include "elastica/blade/fold.hpp"

namespace hotblade::elastica {
namespace {

// Columns are close where the fold's force climbs from a column's first to its second, at phases of 0.06 to
// 0.14 of shallow shapes and somewhat later of deep ones.
std::vector<double> tabled_phases() {
  struct Part {
    double to, step;
  };
  std::vector<double> phases;
  double phase = 0;
  for (const Part& part : {Part{0.045, 0.015}, Part{0.16, 0.0115}, Part{0.7, 0.06}, Part{3.13, 0.2025}}) {
    while (phase < part.to) {
      phases.push_back(phase);
      phase += part.step;
    }
  }
  return phases;
}

constexpr double kLargestShallow = 2;

// Searches start from tabled folds.
constexpr double kTabled = 1e-5;

bool is_stable(const PressedBlade& blade) {
  return end_map(blade.elastica(), Exactness::kSearch).index == 0;
}

// The fold at a force less than the blade's by a step at most.
TabledFold fold_before(PressedBlade blade, double step) {
  const bool after = is_stable(blade);
  constexpr int kHalvings = 9;  // to 0.02
  for (int i = 0; i < kHalvings; ++i) {
    step /= 2;
    PressedBlade middle = blade;
    middle.force -= step;
    if (is_stable(middle) == after) blade = middle;
  }
  return {blade, end_map(blade.elastica(), Exactness::kSearch).point};
}

struct Table {
  std::size_t phases = 0;
  std::vector<std::vector<TabledFold>> cells;
  std::array<std::vector<TabledFold>, 2> edges;
};

Table shallow() {
  constexpr double kRatio = 1.5;
  constexpr int kSizes = 21;  // down to 6e-4: smaller shapes are straight to a blade's thickness
  // Of a straight column between clamps: its first two modes, the second at the root of tan(sqrt(force)/2)
  // = sqrt(force)/2, where an arch has kappa = 2 alpha.
  constexpr double kFirst = 4 * std::numbers::pi * std::numbers::pi, kSecond = 80.7629;
  const std::vector<double> phases = tabled_phases();
  Table all;
  all.phases = phases.size();
  std::vector<double> guesses(phases.size(), kFirst), slopes(phases.size(), 0.0);
  std::array<PressedBlade, 2> edge{PressedBlade{0, 0, kFirst},
                                   PressedBlade{0, std::atan(2 / kBendRate), kSecond}};
  double size = kLargestShallow / std::pow(kRatio, kSizes - 1);
  for (int i = 0; i < kSizes; ++i, size *= kRatio) {
    for (std::size_t j = 0; j < phases.size(); ++j) {
      const double guess = i == 0 && j > 0 ? guesses[j - 1] : guesses[j];
      const auto fold = fold_at(size, phases[j], guess, kTabled, &slopes[j]);
      all.cells.emplace_back();
      if (!fold) continue;
      all.cells.back().push_back(*fold);
      guesses[j] = fold->blade.force;
    }
    for (const FoldEdge kind : {FoldEdge::kTangents, FoldEdge::kCurvatures}) {
      PressedBlade& guess = edge[static_cast<std::size_t>(kind)];
      const auto fold = edge_at(kind, size, guess.phase, guess.force);
      if (!fold) continue;
      all.edges[static_cast<std::size_t>(kind)].push_back(*fold);
      guess = fold->blade;
    }
  }
  return all;
}

Table deep() {
  constexpr double kFirst = 2.06, kStep = 0.14, kLeastForce = 41, kMostForce = 161, kForceStep = 8;
  constexpr int kSizes = 5, kForces = static_cast<int>((kMostForce - kLeastForce) / kForceStep);
  const std::vector<double> phases = tabled_phases();
  Table all;
  all.phases = phases.size();
  for (int i = 0; i < kSizes; ++i) {
    for (const double phase : phases) {
      std::vector<TabledFold>& cell = all.cells.emplace_back();
      PressedBlade blade{kFirst + kStep * i, phase, 0};
      bool before = false;
      for (int k = 0; k <= kForces; ++k) {
        blade.force = kLeastForce + kForceStep * k;
        const bool here = is_stable(blade);
        if (k > 0 && here != before) cell.push_back(fold_before(blade, kForceStep));
        before = here;
      }
    }
  }
  return all;
}

// To the last bit.
std::string number(double x) {
  char text[40];
  std::snprintf(text, sizeof text, "%a", x);
  return text;
}

std::string text(const std::vector<TabledFold>& folds, const std::string& name) {
  std::string out = "constexpr TabledFold " + name + "[] = {\n";
  for (const TabledFold& f : folds) {
    out += "{{" + number(f.blade.size) + ", " + number(f.blade.phase) + ", " + number(f.blade.force) +
           "}, {" + number(f.end.x) + ", " + number(f.end.y) + ", " + number(f.end.theta) + ", " +
           number(f.end.kappa) + "}},\n";
  }
  return out + "};\n";
}

// Of `kName` the folds, and the first of each cell.
std::string text(const Table& table, const std::string& name) {
  std::vector<TabledFold> folds;
  std::string first;
  for (const auto& cell : table.cells) {
    first += std::to_string(folds.size()) + ",\n";
    folds.insert(folds.end(), cell.begin(), cell.end());
  }
  return text(folds, name) + "constexpr std::uint16_t " + name + "First[] = {\n" + first +
         std::to_string(folds.size()) + "};\n";
}

// What FoldTable `kind` returns.
std::string function(const Table& table, const std::string& kind, const std::string& name,
                     const std::string& edges) {
  return "const FoldTable& FoldTable::" + kind + "() {\n  static const FoldTable table(" +
         std::to_string(table.phases) + ", " + name + ", " + name + "First, {" + edges +
         "});\n  return table;\n}\n";
}

std::string source() {
  const Table some = shallow(), others = deep();
  return "// Made by generate_folds.\n#include \"elastica/blade/fold_table.hpp\"\n\nnamespace "
         "hotblade::elastica "
         "{\nnamespace {\n" +
         text(some, "kShallow") + text(some.edges[0], "kTangentEdge") +
         text(some.edges[1], "kCurvatureEdge") + text(others, "kDeep") + "}  // namespace\n" +
         function(some, "shallow", "kShallow", "kTangentEdge, kCurvatureEdge") +
         function(others, "deep", "kDeep", "") + "}  // namespace hotblade::elastica\n";
}

}  // namespace
}  // namespace hotblade::elastica

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: generate_folds FILE\n");
    return 2;
  }
  const std::string table = hotblade::elastica::source();
  std::ofstream file(argv[1], std::ios::binary);
  file << table;
  file.close();
  if (!file) {
    std::fprintf(stderr, "%s: cannot be written\n", argv[1]);
    return 1;
  }
  return 0;
}
