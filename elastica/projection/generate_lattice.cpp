#include "elastica/projection/generate_lattice.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "elastica/bezier/standard_position.hpp"

namespace hotblade::elastica {

namespace {

// Edges of the search grid differ by 7%, narrower than all but a few valleys.
constexpr int kGrid = 81;
constexpr std::size_t kFollowed = 24, kKept = 10;
// Minima nearer than this (in the logarithm) are one.
constexpr double kSame = 0.01;
// A minimum this much above the node's best cannot be the best anywhere in the node's cell: residuals change
// by less than 0.4 a radian along a valley that matters, over at most 0.07 rad.
constexpr double kBehind = 0.06;
constexpr DescentEnd kTight{1e-6, 1e-7};
// A neighbour's floor replaces a place's own when it is lower by more than this share or this much.
constexpr double kLower = 3e-4, kLowerLeast = 3e-6;
// Floors of neighbours nearer than this are of one valley: valleys move by less from place to place, but at
// their ends, and there one of the other seven neighbours tells.
constexpr double kOneLatticeValley = 0.004;
constexpr int kMostRounds = 40;

struct Minimum {
  double u = 0, v = 0, e = 0;
  double u_a1 = 0, u_a2 = 0, v_a1 = 0, v_a2 = 0;
};

struct Start {
  double a1, a2, u, v;
};

// Where starts lead on the branch; e above 1 where there is none.
std::vector<Floor> followed(const std::vector<Start>& starts, WantedBranch branch) {
  std::vector<Floor> floors(starts.size());
  std::vector<Descent> going;
  std::vector<std::size_t> places;
  for (std::size_t k = 0; k < starts.size(); ++k) {
    const Start& s = starts[k];
    const auto box = branch_box(s.a1, s.a2, branch, s.u, s.v);
    if (!box) continue;
    going.push_back({s.a1, s.a2, *box, s.u, s.v});
    places.push_back(k);
  }
  // Together, but not so many that they leave the cache.
  constexpr std::size_t kBatch = 256;
  for (std::size_t k = 0; k < going.size(); k += kBatch)
    descend(std::span(going).subspan(k, std::min(kBatch, going.size() - k)), kTight);
  for (std::size_t k = 0; k < going.size(); ++k) {
    const Descent& d = going[k];
    floors[places[k]] = {d.u, d.v, std::sqrt(d.e2), d.huu, d.huv, d.hvv};
  }
  return floors;
}

// Derivatives of all by central differences; zero where the valley does not go on.
void differentiate(double a1, double a2, WantedBranch branch, std::span<Minimum> list) {
  constexpr double kStep = 0.01, kSlide = 0.2;
  std::vector<Start> starts;
  for (const Minimum& m : list) {
    for (const auto& [d1, d2] : {std::pair{kStep, 0.0}, {-kStep, 0.0}, {0.0, kStep}, {0.0, -kStep}})
      starts.push_back({a1 + d1, a2 + d2, m.u, m.v});
  }
  const std::vector<Floor> led = followed(starts, branch);
  for (std::size_t k = 0; k < list.size(); ++k) {
    Minimum& m = list[k];
    const auto goes_on = [&m](const Floor& o) {
      return o.e <= 1 && std::hypot(o.u - m.u, o.v - m.v) < kSlide;
    };
    for (const bool first : {true, false}) {
      const Floor &up = led[4 * k + (first ? 0 : 2)], &down = led[4 * k + (first ? 1 : 3)];
      if (!goes_on(up) || !goes_on(down)) continue;
      (first ? m.u_a1 : m.u_a2) = (up.u - down.u) / (2 * kStep);
      (first ? m.v_a1 : m.v_a2) = (up.v - down.v) / (2 * kStep);
    }
  }
}

// The places of the grid whose eight neighbours on the branch are no lower, lowest first.
std::vector<Start> grid_minima(double a1, double a2, WantedBranch branch) {
  const EdgeBox all = edge_domain();
  const double step = (all.u1 - all.u0) / (kGrid - 1);
  std::vector<double> u, v;
  for (int i = 0; i < kGrid; ++i) {
    for (int j = 0; j < kGrid; ++j) {
      u.push_back(all.u0 + i * step);
      v.push_back(all.v0 + j * step);
    }
  }
  std::vector<double> e2 = squared_residuals(a1, a2, u, v);
  for (std::size_t k = 0; k < e2.size(); ++k) {
    if (inflectional({a1, a2, std::exp(u[k]), std::exp(v[k])}) != (branch == WantedBranch::kInflectional))
      e2[k] = 4;
  }
  const auto at = [](int i, int j) { return static_cast<std::size_t>(i * kGrid + j); };
  std::vector<std::size_t> lowest;
  for (int i = 0; i < kGrid; ++i) {
    for (int j = 0; j < kGrid; ++j) {
      bool low = e2[at(i, j)] <= 1;
      for (int k = std::max(0, i - 1); k <= std::min(kGrid - 1, i + 1) && low; ++k) {
        for (int l = std::max(0, j - 1); l <= std::min(kGrid - 1, j + 1); ++l)
          low = low && e2[at(k, l)] >= e2[at(i, j)];
      }
      if (low) lowest.push_back(at(i, j));
    }
  }
  std::stable_sort(lowest.begin(), lowest.end(),
                   [&e2](std::size_t a, std::size_t b) { return e2[a] < e2[b]; });
  if (lowest.size() > kFollowed) lowest.resize(kFollowed);
  std::vector<Start> starts;
  for (const std::size_t k : lowest) starts.push_back({a1, a2, u[k], v[k]});
  return starts;
}

// The minima of one node, lowest first, with derivatives.
std::vector<Minimum> searched(double a1, double a2, WantedBranch branch) {
  std::vector<Minimum> list;
  for (const Floor& f : followed(grid_minima(a1, a2, branch), branch)) {
    const bool known = std::any_of(list.begin(), list.end(), [&f](const Minimum& o) {
      return std::hypot(o.u - f.u, o.v - f.v) < kSame;
    });
    if (f.e <= 1 && !known) list.push_back({f.u, f.v, f.e});
  }
  std::stable_sort(list.begin(), list.end(), [](const Minimum& a, const Minimum& b) { return a.e < b.e; });
  if (list.size() > kKept) list.resize(kKept);
  std::erase_if(list, [&list](const Minimum& m) { return m.e > list.front().e + kBehind; });
  differentiate(a1, a2, branch, list);
  return list;
}

class Lattice {
 public:
  explicit Lattice(WantedBranch branch) : branch_(branch), floors_(kPlaces * kPlaces) {}

  // The minima of the nodes followed to every place of their cells.
  void seed() {
    for (int i = 0; i < kValleyNodes; ++i) {
      for (int j = 0; j < kValleyNodes; ++j) {
        if (leads({i, j}, kValleyNodes)) seed_cell({i, j});
      }
    }
  }

  // Neighbours' floors followed to every place, until nothing goes lower: a valley is found wherever it
  // reaches from a place that knows it, and its ends to a place's width.
  void grow() {
    std::vector<char> fresh(floors_.size(), 1);
    for (int round = 0; round < kMostRounds; ++round) {
      std::vector<char> next(floors_.size(), 0);
      if (!grow_once(fresh, next)) return;
      fresh = std::move(next);
    }
  }

  std::vector<Floor> floors() && { return std::move(floors_); }

 private:
  static std::size_t index(Node n) { return static_cast<std::size_t>(n.i * kPlaces + n.j); }

  // The floor at a place and at its images.
  void put(Node n, const Floor& f, std::vector<char>* fresh = nullptr) {
    const Floor r{f.v, f.u, f.e, f.hvv, f.huv, f.huu};
    const Node m = mirrored(n, kPlaces), b = reversed(n, kPlaces);
    floors_[index(n)] = floors_[index(m)] = f;
    floors_[index(b)] = floors_[index(mirrored(b, kPlaces))] = r;
    if (!fresh) return;
    for (const Node o : {n, m, b, mirrored(b, kPlaces)}) (*fresh)[index(o)] = 1;
  }

  void seed_cell(Node cell) {
    const std::vector<Minimum> minima =
        searched(lattice_angle(cell.i, kValleyNodes), lattice_angle(cell.j, kValleyNodes), branch_);
    std::vector<Start> starts;
    std::vector<Node> places;
    for (int k = 0; k < kCellPlaces; ++k) {
      for (int l = 0; l < kCellPlaces; ++l) {
        const Node n{cell.i * kCellPlaces + k, cell.j * kCellPlaces + l};
        const double a1 = lattice_angle(n.i, kPlaces), a2 = lattice_angle(n.j, kPlaces);
        const double x = a1 - lattice_angle(cell.i, kValleyNodes),
                     y = a2 - lattice_angle(cell.j, kValleyNodes);
        for (const Minimum& m : minima) {
          starts.push_back({a1, a2, m.u + x * m.u_a1 + y * m.u_a2, m.v + x * m.v_a1 + y * m.v_a2});
          places.push_back(n);
        }
      }
    }
    const std::vector<Floor> led = followed(starts, branch_);
    for (std::size_t k = 0; k < led.size(); ++k) {
      if (led[k].e <= 1 && led[k].e < floors_[index(places[k])].e) put(places[k], led[k]);
    }
  }

  bool grow_once(const std::vector<char>& fresh, std::vector<char>& next) {
    std::vector<Start> starts;
    std::vector<Node> places;
    for (int i = 0; i < kPlaces; ++i) {
      for (int j = 0; j < kPlaces; ++j) {
        if (!leads({i, j}, kPlaces)) continue;
        const Floor& own = floors_[index({i, j})];
        for (int k = i - 1; k <= i + 1; ++k) {
          for (int l = j - 1; l <= j + 1; ++l) {
            const std::size_t at = index({around(k, kPlaces), around(l, kPlaces)});
            const Floor& o = floors_[at];
            if (!fresh[at] || o.e > 1 || std::hypot(o.u - own.u, o.v - own.v) < kOneLatticeValley) continue;
            // One that is this much higher cannot be the lower at the next place.
            constexpr double kAbove = 0.02;
            if (own.e <= 1 && o.e > own.e + kAbove) continue;
            starts.push_back({lattice_angle(i, kPlaces), lattice_angle(j, kPlaces), o.u, o.v});
            places.push_back({i, j});
          }
        }
      }
    }
    const std::vector<Floor> led = followed(starts, branch_);
    bool lower = false;
    for (std::size_t k = 0; k < led.size(); ++k) {
      if (!(led[k].e <= 1) || led[k].e >= floors_[index(places[k])].e * (1 - kLower) - kLowerLeast) continue;
      put(places[k], led[k], &next);
      lower = true;
    }
    return lower;
  }

  WantedBranch branch_;
  std::vector<Floor> floors_;
};

}  // namespace

double lattice_angle(int i, int count) {
  return -std::numbers::pi + (i + 0.5) * 2 * std::numbers::pi / count;
}

int around(int i, int count) {
  return (i % count + count) % count;
}

Node mirrored(Node n, int count) {
  return {count - 1 - n.i, count - 1 - n.j};
}

Node reversed(Node n, int count) {
  return {around(count / 2 - 1 - n.j, count), around(count / 2 - 1 - n.i, count)};
}

bool leads(Node n, int count) {
  const Node images[] = {mirrored(n, count), reversed(n, count), mirrored(reversed(n, count), count)};
  return std::none_of(std::begin(images), std::end(images), [n](Node o) { return o < n; });
}

std::vector<Floor> lattice_floors(WantedBranch branch) {
  Lattice lattice(branch);
  lattice.seed();
  lattice.grow();
  return std::move(lattice).floors();
}

}  // namespace hotblade::elastica
