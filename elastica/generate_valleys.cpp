// Writes the table of project_valleys.hpp as C++: generate_valleys FILE. Run by the build.
//
// Every node is searched on its own: the local minima of a grid of both edges, on either branch, followed
// down. Then neighbours' minima are followed to the node, which finds narrow valleys that the grid has
// missed; one that ends on the way stays as a start without being a minimum, so that both sides of an ending
// are tried.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "elastica/project_polish.hpp"
#include "elastica/project_valleys.hpp"

namespace hotblade::elastica {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kNodes = kValleyNodes;
// Edges of the grid differ by 7%, narrower than all but a few valleys.
constexpr int kGrid = 81;
constexpr std::size_t kFollowed = 24, kKept = 10;
// Minima nearer than this (in the logarithm) are one.
constexpr double kSame = 0.01;
// A minimum this much above the node's best cannot be the best anywhere in the node's cell: residuals change
// by less than 0.4 a radian along a valley that matters, over at most 0.07 rad.
constexpr double kBehind = 0.06;
constexpr DescentEnd kTight{1e-7, 1e-8};

struct Minimum {
  WantedBranch branch = WantedBranch::kPlain;
  double u = 0, v = 0, e = 0;
  double u_a1 = 0, u_a2 = 0, v_a1 = 0, v_a2 = 0;
  bool start_only = false;
};

struct Node {
  int i = 0, j = 0;
  bool operator<(const Node& o) const { return std::pair(i, j) < std::pair(o.i, o.j); }
};

double angle(int i) {
  return -kPi + (i + 0.5) * 2 * kPi / kNodes;
}
int around(int i) {
  return (i % kNodes + kNodes) % kNodes;
}
Node mirrored(Node n) {
  return {kNodes - 1 - n.i, kNodes - 1 - n.j};
}
Node reversed(Node n) {
  return {around(kNodes / 2 - 1 - n.j), around(kNodes / 2 - 1 - n.i)};
}
Minimum mirrored(Minimum m) {
  for (double* d : {&m.u_a1, &m.u_a2, &m.v_a1, &m.v_a2}) *d = -*d;
  return m;
}
Minimum reversed(const Minimum& m) {
  Minimum r = m;
  r.u = m.v;
  r.v = m.u;
  r.u_a1 = -m.v_a2;
  r.u_a2 = -m.v_a1;
  r.v_a1 = -m.u_a2;
  r.v_a2 = -m.u_a1;
  return r;
}

using Table = std::map<Node, std::vector<Minimum>>;

// One start and the directions it starts at.
struct Start {
  double a1, a2;
  WantedBranch branch;
  double u, v;
};

// The minima that starts lead to on their branches; e above 1 where there is none.
std::vector<Minimum> followed(const std::vector<Start>& starts) {
  std::vector<Minimum> minima;
  std::vector<Descent> going;
  for (const Start& s : starts) {
    const auto box = branch_box(s.a1, s.a2, s.branch, s.u, s.v);
    minima.push_back({s.branch, s.u, s.v, box ? 0.0 : 2.0});
    if (box) going.push_back({s.a1, s.a2, *box, s.u, s.v});
  }
  descend(going, kTight);
  std::size_t k = 0;
  for (Minimum& m : minima) {
    if (m.e > 1) continue;
    m.u = going[k].u;
    m.v = going[k].v;
    m.e = std::sqrt(going[k].e2);
    ++k;
  }
  return minima;
}

bool same(const Minimum& a, const Minimum& b) {
  return a.branch == b.branch && std::hypot(a.u - b.u, a.v - b.v) < kSame;
}

bool known(const std::vector<Minimum>& list, const Minimum& m) {
  return std::any_of(list.begin(), list.end(), [&m](const Minimum& o) { return same(o, m); });
}

// Derivatives of all by central differences; zero where the valley does not go on.
void differentiate(double a1, double a2, std::span<Minimum> list) {
  constexpr double kStep = 0.01, kSlide = 0.2;
  std::vector<Start> starts;
  for (const Minimum& m : list) {
    for (const auto& [d1, d2] : {std::pair{kStep, 0.0}, {-kStep, 0.0}, {0.0, kStep}, {0.0, -kStep}})
      starts.push_back({a1 + d1, a2 + d2, m.branch, m.u, m.v});
  }
  const std::vector<Minimum> led = followed(starts);
  for (std::size_t k = 0; k < list.size(); ++k) {
    Minimum& m = list[k];
    const auto goes_on = [&m](const Minimum& o) {
      return o.e <= 1 && std::hypot(o.u - m.u, o.v - m.v) < kSlide;
    };
    for (const bool first : {true, false}) {
      const Minimum &up = led[4 * k + (first ? 0 : 2)], &down = led[4 * k + (first ? 1 : 3)];
      if (!goes_on(up) || !goes_on(down)) continue;
      (first ? m.u_a1 : m.u_a2) = (up.u - down.u) / (2 * kStep);
      (first ? m.v_a1 : m.v_a2) = (up.v - down.v) / (2 * kStep);
    }
  }
}

double best(const std::vector<Minimum>& list, WantedBranch branch) {
  double e = 2;
  for (const Minimum& m : list) {
    if (!m.start_only && (branch == WantedBranch::kBest || m.branch == branch)) e = std::min(e, m.e);
  }
  return e;
}

void prune(std::vector<Minimum>& list) {
  std::stable_sort(list.begin(), list.end(), [](const Minimum& a, const Minimum& b) { return a.e < b.e; });
  for (const WantedBranch branch : {WantedBranch::kInflectional, WantedBranch::kPlain}) {
    const double least = best(list, branch);
    std::size_t kept = 0;
    std::erase_if(list, [&](const Minimum& m) {
      return m.branch == branch && (m.e > 1 || m.e > least + kBehind || ++kept > kKept);
    });
  }
}

std::vector<Minimum> searched(double a1, double a2) {
  const EdgeBox all = edge_domain();
  const double step = (all.u1 - all.u0) / (kGrid - 1);
  std::vector<double> u, v;
  for (int i = 0; i < kGrid; ++i) {
    for (int j = 0; j < kGrid; ++j) {
      u.push_back(all.u0 + i * step);
      v.push_back(all.v0 + j * step);
    }
  }
  const std::vector<double> e2 = squared_residuals(a1, a2, u, v);
  std::vector<Minimum> list;
  for (const WantedBranch branch : {WantedBranch::kInflectional, WantedBranch::kPlain}) {
    std::vector<double> own(e2.size(), 4);
    for (std::size_t k = 0; k < e2.size(); ++k) {
      if (inflectional({a1, a2, std::exp(u[k]), std::exp(v[k])}) == (branch == WantedBranch::kInflectional))
        own[k] = e2[k];
    }
    std::vector<Minimum> starts;
    const auto at = [&own](int i, int j) { return own[static_cast<std::size_t>(i * kGrid + j)]; };
    for (int i = 0; i < kGrid; ++i) {
      for (int j = 0; j < kGrid; ++j) {
        bool lowest = at(i, j) <= 1;
        for (int k = std::max(0, i - 1); k <= std::min(kGrid - 1, i + 1) && lowest; ++k) {
          for (int l = std::max(0, j - 1); l <= std::min(kGrid - 1, j + 1); ++l)
            lowest = lowest && at(k, l) >= at(i, j);
        }
        if (lowest) starts.push_back({branch, all.u0 + i * step, all.v0 + j * step, at(i, j)});
      }
    }
    std::stable_sort(starts.begin(), starts.end(),
                     [](const Minimum& a, const Minimum& b) { return a.e < b.e; });
    if (starts.size() > kFollowed) starts.resize(kFollowed);
    std::vector<Start> going;
    for (const Minimum& s : starts) going.push_back({a1, a2, branch, s.u, s.v});
    for (const Minimum& m : followed(going)) {
      if (m.e <= 1 && !known(list, m)) list.push_back(m);
    }
  }
  prune(list);
  differentiate(a1, a2, list);
  return list;
}

// One node of every orbit of the symmetries.
bool leads(Node n) {
  const Node images[] = {mirrored(n), reversed(n), mirrored(reversed(n))};
  return std::none_of(std::begin(images), std::end(images), [n](Node o) { return o < n; });
}

void spread(Table& table, Node n) {
  const std::vector<Minimum> own = table[n];
  std::vector<Minimum> mirror, reverse, both;
  for (const Minimum& m : own) {
    mirror.push_back(mirrored(m));
    reverse.push_back(reversed(m));
    both.push_back(mirrored(reversed(m)));
  }
  table[mirrored(n)] = mirror;
  table[reversed(n)] = reverse;
  table[mirrored(reversed(n))] = both;
  table[n] = own;
}

// Minima of the eight neighbours followed to the node.
std::vector<Minimum> joined(const Table& table, Node n, bool with_starts) {
  std::vector<Minimum> list = table.at(n), origins, fresh;
  const double a1 = angle(n.i), a2 = angle(n.j), h = 2 * kPi / kNodes;
  std::vector<Start> starts;
  for (int di = -1; di <= 1; ++di) {
    for (int dj = -1; dj <= 1; ++dj) {
      for (const Minimum& o : table.at({around(n.i + di), around(n.j + dj)})) {
        if (o.start_only || (di == 0 && dj == 0)) continue;
        starts.push_back(
            {a1, a2, o.branch, o.u - h * (di * o.u_a1 + dj * o.u_a2), o.v - h * (di * o.v_a1 + dj * o.v_a2)});
        origins.push_back(o);
      }
    }
  }
  const std::vector<Minimum> led = followed(starts);
  std::vector<Minimum> gone;
  for (std::size_t k = 0; k < led.size(); ++k) {
    const Minimum& m = led[k];
    if (m.e > 1) continue;
    if (!known(list, m) && !known(fresh, m)) fresh.push_back(m);
    constexpr double kGone = 0.15;
    if (!with_starts || std::hypot(m.u - starts[k].u, m.v - starts[k].v) < kGone) continue;
    Minimum start = origins[k];
    start.u = starts[k].u;
    start.v = starts[k].v;
    start.start_only = true;
    if (!known(list, start) && !known(gone, start)) gone.push_back(start);
  }
  differentiate(a1, a2, fresh);
  list.insert(list.end(), fresh.begin(), fresh.end());
  list.insert(list.end(), gone.begin(), gone.end());
  prune(list);
  return list;
}

Table build() {
  Table table;
  std::vector<Node> leaders;
  for (int i = 0; i < kNodes; ++i) {
    for (int j = 0; j < kNodes; ++j) {
      if (leads({i, j})) leaders.push_back({i, j});
    }
  }
  for (const Node n : leaders) table[n] = searched(angle(n.i), angle(n.j));
  for (const Node n : leaders) spread(table, n);
  for (const bool with_starts : {false, true}) {
    Table next = table;
    for (const Node n : leaders) next[n] = joined(table, n, with_starts);
    table = std::move(next);
    for (const Node n : leaders) spread(table, n);
  }
  return table;
}

// Places of a cell at which its valleys are compared: in either direction, in half cells.
constexpr double kPlaces[] = {-1.0, -0.7, -0.35, 0.0, 0.35, 0.7, 1.0};
// A valley serves a place when it comes this near to the best one there: half of what the descents resolve.
constexpr double kServes = 5e-4, kServesLeast = 1e-5;
// Residuals above this matter to nobody: one valley is enough.
constexpr double kUseless = 0.95;

struct Place {
  double x, y;
};

std::vector<Place> places() {
  const double half = kPi / kNodes;
  std::vector<Place> list;
  for (const double x : kPlaces) {
    for (const double y : kPlaces) list.push_back({half * x, half * y});
  }
  return list;
}

// Where every start leads at every place; e2 above 1 where it leads nowhere.
std::vector<std::vector<Descent>> descents_of(Node n, const std::vector<Minimum>& starts,
                                              WantedBranch wanted) {
  std::vector<std::vector<Descent>> led;
  std::vector<Descent> going;
  for (const Minimum& m : starts) {
    if (wanted != WantedBranch::kBest && m.branch != wanted) continue;
    led.emplace_back();
    for (const Place& at : places()) {
      const double a1 = angle(n.i) + at.x, a2 = angle(n.j) + at.y;
      const double u = m.u + at.x * m.u_a1 + at.y * m.u_a2, v = m.v + at.x * m.v_a1 + at.y * m.v_a2;
      const auto box = wanted == WantedBranch::kBest ? edge_domain() : branch_box(a1, a2, wanted, u, v);
      led.back().push_back({a1, a2, box.value_or(EdgeBox{}), u, v, 0, 0, 0, box ? 0.0 : 4.0});
      if (box) going.push_back(led.back().back());
    }
  }
  descend(going, DescentEnd{1e-5, 1e-7});
  std::size_t k = 0;
  for (auto& list : led) {
    for (Descent& d : list) {
      if (d.e2 == 0) d = going[k++];
    }
  }
  return led;
}

// The quadratic through (u, v) at the places where the start serves, of lower degree where they are few.
Valley quadratic(const std::vector<Descent>& d, const std::vector<bool>& serves) {
  const std::vector<Place> at = places();
  std::vector<std::size_t> used;
  for (std::size_t k = 0; k < d.size(); ++k) {
    if (serves[k]) used.push_back(k);
  }
  const int terms = used.size() >= 12 ? 6 : used.size() >= 6 ? 3 : 1;
  Eigen::MatrixXd a(static_cast<Eigen::Index>(used.size()), terms);
  Eigen::MatrixXd b(static_cast<Eigen::Index>(used.size()), 2);
  for (std::size_t r = 0; r < used.size(); ++r) {
    const Place p = at[used[r]];
    const double row[] = {1, p.x, p.y, p.x * p.x, p.x * p.y, p.y * p.y};
    for (int c = 0; c < terms; ++c) a(static_cast<Eigen::Index>(r), c) = row[c];
    b.row(static_cast<Eigen::Index>(r)) << d[used[r]].u, d[used[r]].v;
  }
  const Eigen::MatrixXd x = a.colPivHouseholderQr().solve(b);
  Valley valley{};
  for (int c = 0; c < terms; ++c) {
    valley.u[c] = static_cast<float>(x(c, 0));
    valley.v[c] = static_cast<float>(x(c, 1));
  }
  const Descent& middle = d[used[used.size() / 2]];
  valley.huu = static_cast<float>(middle.huu);
  valley.huv = static_cast<float>(middle.huv);
  valley.hvv = static_cast<float>(middle.hvv);
  return valley;
}

// The fewest starts of the node that serve every place of its cell.
std::vector<Valley> cover(Node n, const std::vector<Minimum>& starts, WantedBranch wanted) {
  const std::vector<std::vector<Descent>> led = descents_of(n, starts, wanted);
  const std::size_t count = places().size();
  std::vector<double> least(count, 2);
  for (const auto& list : led) {
    for (std::size_t k = 0; k < count; ++k) least[k] = std::min(least[k], std::sqrt(list[k].e2));
  }
  const auto serves = [&](const std::vector<Descent>& list, std::size_t k) {
    const double e = std::sqrt(list[k].e2);
    return e <= 1 && (e <= least[k] * (1 + kServes) + kServesLeast || e > kUseless);
  };
  std::vector<bool> open(count);
  for (std::size_t k = 0; k < count; ++k) open[k] = least[k] <= 1;
  std::vector<Valley> valleys;
  while (std::find(open.begin(), open.end(), true) != open.end()) {
    std::size_t most = 0;
    const std::vector<Descent>* chosen = nullptr;
    for (const auto& list : led) {
      std::size_t served = 0;
      for (std::size_t k = 0; k < count; ++k) served += open[k] && serves(list, k) ? 1 : 0;
      if (served > most) {
        most = served;
        chosen = &list;
      }
    }
    std::vector<bool> mine(count);
    for (std::size_t k = 0; k < count; ++k) {
      mine[k] = serves(*chosen, k);
      if (mine[k]) open[k] = false;
    }
    valleys.push_back(quadratic(*chosen, mine));
  }
  return valleys;
}

// The symmetries on quadratics: both angles change sign; or they swap with a sign, and the edges swap.
Valley mirrored(Valley m) {
  for (float* c : {m.u, m.v}) {
    c[1] = -c[1];
    c[2] = -c[2];
  }
  return m;
}
Valley reversed(const Valley& m) {
  const auto turned = [](const float(&c)[6], float(&out)[6]) {
    const float r[] = {c[0], -c[2], -c[1], c[5], c[4], c[3]};
    std::copy(std::begin(r), std::end(r), out);
  };
  Valley r = m;
  turned(m.v, r.u);
  turned(m.u, r.v);
  r.huu = m.hvv;
  r.hvv = m.huu;
  return r;
}

using Valleys = std::map<Node, std::vector<Valley>>;

Valleys covered(const Table& table, WantedBranch wanted) {
  Valleys valleys;
  for (const auto& [n, starts] : table) {
    if (!leads(n)) continue;
    const std::vector<Valley> own = cover(n, starts, wanted);
    std::vector<Valley> mirror, reverse, both;
    for (const Valley& m : own) {
      mirror.push_back(mirrored(m));
      reverse.push_back(reversed(m));
      both.push_back(mirrored(reversed(m)));
    }
    valleys[mirrored(n)] = mirror;
    valleys[reversed(n)] = reverse;
    valleys[mirrored(reversed(n))] = both;
    valleys[n] = own;
  }
  return valleys;
}

std::string numbers(const float* c, int count) {
  std::string out;
  char word[40];
  for (int i = 0; i < count; ++i) {
    std::snprintf(word, sizeof word, "%.7gf, ", static_cast<double>(c[i]));
    // A literal needs a point or an exponent before its f.
    std::string text = word;
    if (text.find_first_of(".e") == std::string::npos) text.insert(text.find('f'), ".0");
    out += text;
  }
  return out;
}

std::string text(const Table& table) {
  std::string out =
      "// Made by generate_valleys.\n#include \"elastica/project_valleys_table.hpp\"\n\n"
      "namespace hotblade::elastica {\n\nconst Valley kValleys[] = {\n";
  std::string firsts;
  std::size_t count = 0;
  for (const WantedBranch wanted : {WantedBranch::kInflectional, WantedBranch::kPlain, WantedBranch::kBest}) {
    const Valleys valleys = covered(table, wanted);
    for (const auto& [n, list] : valleys) {
      firsts += std::to_string(count) + ",\n";
      for (const Valley& m : list) {
        const float h[] = {m.huu, m.huv, m.hvv};
        out += "{{" + numbers(m.u, 6) + "}, {" + numbers(m.v, 6) + "}, " + numbers(h, 3) + "},\n";
        ++count;
      }
    }
  }
  firsts += std::to_string(count) + "\n";
  return out + "};\n\nconst std::uint32_t kFirstValley[] = {\n" + firsts +
         "};\n\n}  // namespace hotblade::elastica\n";
}

}  // namespace
}  // namespace hotblade::elastica

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: generate_valleys FILE\n");
    return 2;
  }
  const std::string table = hotblade::elastica::text(hotblade::elastica::build());
  std::ofstream file(argv[1], std::ios::binary);
  file << table;
  file.close();
  if (!file) {
    std::fprintf(stderr, "%s: cannot be written\n", argv[1]);
    return 1;
  }
  return 0;
}
