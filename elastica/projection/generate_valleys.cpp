// Writes the table of project_valleys.hpp as C++: generate_valleys FILE. Run by the build.
//
// The least residual is known on a fine lattice of end directions (generate_lattice.hpp). Every cell of the
// table is covered by quadratics whose descents, made as the projection makes them, end there at every place
// of the cell and of the ring around it.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "elastica/projection/generate_lattice.hpp"
#include "elastica/projection/project_polish.hpp"
#include "elastica/projection/project_valleys.hpp"

namespace hotblade::elastica {
namespace {

constexpr int kWindow = kCellPlaces + 2;  // the cell's places and one ring around them
constexpr std::size_t kWindowPlaces = static_cast<std::size_t>(kWindow) * kWindow;
constexpr double kSpacing = 2 * std::numbers::pi / kPlaces;
// A descent serves a place when it ends this near to the floor: twice what descents resolve.
constexpr double kServes = 2e-3, kServesLeast = 1e-5;
// Residuals above this matter to nobody: any descent that ends serves.
constexpr double kUseless = 0.95;
// Floors of neighbouring places nearer than this are of one valley.
constexpr double kOneValley = 0.1;
// A cell needs at most this many, or what is left lies at single places.
constexpr std::size_t kMostValleys = 12;

using Floors = std::vector<Floor>;

// Distance of window row or column k from the cell's middle.
double offset(int k) {
  return (k - 0.5 * (kWindow - 1)) * kSpacing;
}

class Cell {
 public:
  Cell(Node n, const Floors& floors, WantedBranch wanted) : n_(n), wanted_(wanted), open_(kWindowPlaces, 0) {
    for (int k = 0; k < kWindow; ++k) {
      for (int l = 0; l < kWindow; ++l) {
        const int i = around(n.i * kCellPlaces + k - 1, kPlaces),
                  j = around(n.j * kCellPlaces + l - 1, kPlaces);
        floors_.push_back(floors[static_cast<std::size_t>(i * kPlaces + j)]);
        open_[at(k, l)] = floors_.back().e <= 1 ? 1 : 0;
      }
    }
  }

  std::vector<Valley> cover() {
    std::vector<Valley> valleys;
    while (valleys.size() < kMostValleys) {
      const std::vector<std::size_t> cluster = largest_cluster();
      if (cluster.empty()) break;
      const std::size_t middle = middle_of(cluster);
      Valley valley = quadratic(cluster, middle);
      std::vector<char> serves = served(valley);
      if (std::none_of(cluster.begin(), cluster.end(), [&](std::size_t k) { return serves[k] != 0; })) {
        valley = quadratic({middle}, middle);
        serves = served(valley);
        serves[middle] = 1;
      }
      close(valley, serves);
      valleys.push_back(valley);
    }
    return valleys;
  }

 private:
  static std::size_t at(int k, int l) { return static_cast<std::size_t>(k * kWindow + l); }
  static int row(std::size_t k) { return static_cast<int>(k) / kWindow; }
  static int column(std::size_t k) { return static_cast<int>(k) % kWindow; }

  // Open places of one valley, as many as hang together.
  std::vector<std::size_t> largest_cluster() const {
    std::vector<char> seen(kWindowPlaces, 0);
    std::vector<std::size_t> largest;
    for (std::size_t k = 0; k < kWindowPlaces; ++k) {
      if (!open_[k] || seen[k]) continue;
      std::vector<std::size_t> cluster{k};
      seen[k] = 1;
      for (std::size_t c = 0; c < cluster.size(); ++c) {
        const std::size_t from = cluster[c];
        const int i = row(from), j = column(from);
        for (const auto& [p, q] : {std::pair{i - 1, j}, {i + 1, j}, {i, j - 1}, {i, j + 1}}) {
          if (p < 0 || q < 0 || p >= kWindow || q >= kWindow) continue;
          const std::size_t to = at(p, q);
          const Floor &a = floors_[from], &b = floors_[to];
          if (!open_[to] || seen[to] || std::hypot(a.u - b.u, a.v - b.v) > kOneValley) continue;
          seen[to] = 1;
          cluster.push_back(to);
        }
      }
      if (cluster.size() > largest.size()) largest = cluster;
    }
    return largest;
  }

  // The place of the cluster nearest to its centre.
  static std::size_t middle_of(const std::vector<std::size_t>& cluster) {
    double x = 0, y = 0;
    const double n = static_cast<double>(cluster.size());
    for (const std::size_t k : cluster) {
      x += row(k) / n;
      y += column(k) / n;
    }
    return *std::min_element(cluster.begin(), cluster.end(), [&](std::size_t a, std::size_t b) {
      return std::hypot(row(a) - x, column(a) - y) < std::hypot(row(b) - x, column(b) - y);
    });
  }

  // The quadratic through the floors of the cluster, of lower degree where they are few.
  Valley quadratic(const std::vector<std::size_t>& cluster, std::size_t middle) const {
    const int terms = cluster.size() >= 16 ? 6 : cluster.size() >= 6 ? 3 : 1;
    Eigen::MatrixXd a(static_cast<Eigen::Index>(cluster.size()), terms);
    Eigen::MatrixXd b(static_cast<Eigen::Index>(cluster.size()), 2);
    for (std::size_t r = 0; r < cluster.size(); ++r) {
      const double x = offset(row(cluster[r])), y = offset(column(cluster[r]));
      const double powers[] = {1, x, y, x * x, x * y, y * y};
      for (int c = 0; c < terms; ++c) a(static_cast<Eigen::Index>(r), c) = powers[c];
      b.row(static_cast<Eigen::Index>(r)) << floors_[cluster[r]].u, floors_[cluster[r]].v;
    }
    const Eigen::MatrixXd x = a.colPivHouseholderQr().solve(b);
    Valley valley{};
    for (int c = 0; c < terms; ++c) {
      valley.u[c] = static_cast<float>(x(c, 0));
      valley.v[c] = static_cast<float>(x(c, 1));
    }
    valley.huu = static_cast<float>(floors_[middle].huu);
    valley.huv = static_cast<float>(floors_[middle].huv);
    valley.hvv = static_cast<float>(floors_[middle].hvv);
    return valley;
  }

  // Whether the projection's descent from the valley ends at the floor, for the open places.
  std::vector<char> served(const Valley& valley) const {
    std::vector<Descent> descents;
    std::vector<std::size_t> places;
    for (std::size_t k = 0; k < kWindowPlaces; ++k) {
      const double x = offset(row(k)), y = offset(column(k));
      const double a1 = lattice_angle(n_.i, kValleyNodes) + x, a2 = lattice_angle(n_.j, kValleyNodes) + y;
      const auto descent = valley_descent(a1, a2, wanted_, valley, x, y);
      if (!open_[k] || !descent) continue;
      descents.push_back(*descent);
      places.push_back(k);
    }
    descend(descents, kValleyEnd);
    std::vector<char> serves(kWindowPlaces, 0);
    for (std::size_t k = 0; k < descents.size(); ++k) {
      const double e = std::sqrt(descents[k].e2), least = floors_[places[k]].e;
      serves[places[k]] = e <= 1 && (e <= least * (1 + kServes) + kServesLeast || e > kUseless) ? 1 : 0;
    }
    return serves;
  }

  // Takes the served places off the open ones; the valley's reach is theirs and half a place beyond.
  void close(Valley& valley, const std::vector<char>& serves) {
    int k0 = kWindow, k1 = -1, l0 = kWindow, l1 = -1;
    for (std::size_t k = 0; k < kWindowPlaces; ++k) {
      if (!serves[k] || !open_[k]) continue;
      open_[k] = 0;
      k0 = std::min(k0, row(k));
      k1 = std::max(k1, row(k));
      l0 = std::min(l0, column(k));
      l1 = std::max(l1, column(k));
    }
    valley.x0 = static_cast<float>(offset(k0) - kSpacing);
    valley.x1 = static_cast<float>(offset(k1) + kSpacing);
    valley.y0 = static_cast<float>(offset(l0) - kSpacing);
    valley.y1 = static_cast<float>(offset(l1) + kSpacing);
  }

  Node n_;
  WantedBranch wanted_;
  Floors floors_;
  std::vector<char> open_;
};

// The symmetries on quadratics: both angles change sign; or they swap with a sign, and the edges swap.
Valley mirrored(Valley m) {
  for (float* c : {m.u, m.v}) {
    c[1] = -c[1];
    c[2] = -c[2];
  }
  m.x0 = -std::exchange(m.x1, -m.x0);
  m.y0 = -std::exchange(m.y1, -m.y0);
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
  r.x0 = -m.y1;
  r.x1 = -m.y0;
  r.y0 = -m.x1;
  r.y1 = -m.x0;
  return r;
}

using Valleys = std::map<Node, std::vector<Valley>>;

Valleys covered(const Floors& floors, WantedBranch wanted) {
  Valleys valleys;
  for (int i = 0; i < kValleyNodes; ++i) {
    for (int j = 0; j < kValleyNodes; ++j) {
      const Node n{i, j}, b = reversed(n, kValleyNodes);
      if (!leads(n, kValleyNodes)) continue;
      const std::vector<Valley> own = Cell(n, floors, wanted).cover();
      std::vector<Valley> mirror, reverse, both;
      for (const Valley& m : own) {
        mirror.push_back(mirrored(m));
        reverse.push_back(reversed(m));
        both.push_back(mirrored(reversed(m)));
      }
      valleys[mirrored(n, kValleyNodes)] = mirror;
      valleys[b] = reverse;
      valleys[mirrored(b, kValleyNodes)] = both;
      valleys[n] = own;
    }
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

// The lower floor of both branches.
Floors lower(const Floors& a, const Floors& b) {
  Floors floors = a;
  for (std::size_t k = 0; k < floors.size(); ++k) {
    if (b[k].e < floors[k].e) floors[k] = b[k];
  }
  return floors;
}

std::string text() {
  const Floors inflectional = lattice_floors(WantedBranch::kInflectional),
               plain = lattice_floors(WantedBranch::kPlain);
  std::string out =
      "// Made by generate_valleys.\n#include \"elastica/projection/project_valleys_table.hpp\"\n\n"
      "namespace hotblade::elastica {\n\nconst Valley kValleys[] = {\n";
  std::string firsts;
  std::size_t count = 0;
  for (const auto& [floors, wanted] :
       {std::pair{inflectional, WantedBranch::kInflectional}, std::pair{plain, WantedBranch::kPlain},
        std::pair{lower(inflectional, plain), WantedBranch::kBest}}) {
    for (const auto& [n, list] : covered(floors, wanted)) {
      firsts += std::to_string(count) + ",\n";
      for (const Valley& m : list) {
        const float rest[] = {m.huu, m.huv, m.hvv, m.x0, m.x1, m.y0, m.y1};
        out += "{{" + numbers(m.u, 6) + "}, {" + numbers(m.v, 6) + "}, " + numbers(rest, 7) + "},\n";
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
  const std::string table = hotblade::elastica::text();
  std::ofstream file(argv[1], std::ios::binary);
  file << table;
  file.close();
  if (!file) {
    std::fprintf(stderr, "%s: cannot be written\n", argv[1]);
    return 1;
  }
  return 0;
}
