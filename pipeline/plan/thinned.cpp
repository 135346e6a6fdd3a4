#include "pipeline/plan/thinned.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace hotblade::pipeline {

namespace {

using Eigen::Vector3d;

// Numbers for the cells met, in the order in which they are: an open hash table.
class Cells {
 public:
  Cells() : keys_(std::size_t{1} << bits_, kFree), numbers_(keys_.size()) {}

  int number(std::uint64_t key) {
    std::size_t i = slot(key);
    if (keys_[i] == key) return numbers_[i];
    if (2 * static_cast<std::size_t>(count_ + 1) > keys_.size()) {
      grow();
      i = slot(key);
    }
    keys_[i] = key;
    return numbers_[i] = count_++;
  }

 private:
  static constexpr std::uint64_t kFree = std::numeric_limits<std::uint64_t>::max();

  // Where the key is, or would be.
  [[nodiscard]] std::size_t slot(std::uint64_t key) const {
    constexpr std::uint64_t kSpread = 0x9E3779B97F4A7C15;
    std::size_t i = (key * kSpread) >> (64 - bits_);
    while (keys_[i] != key && keys_[i] != kFree) i = (i + 1) & (keys_.size() - 1);
    return i;
  }

  void grow() {
    const std::vector<std::uint64_t> keys = std::exchange(keys_, {});
    const std::vector<int> numbers = std::exchange(numbers_, {});
    ++bits_;
    keys_.assign(std::size_t{1} << bits_, kFree);
    numbers_.resize(keys_.size());
    for (std::size_t i = 0; i < keys.size(); ++i) {
      if (keys[i] == kFree) continue;
      const std::size_t there = slot(keys[i]);
      keys_[there] = keys[i];
      numbers_[there] = numbers[i];
    }
  }

  int bits_ = 10;
  std::vector<std::uint64_t> keys_;
  std::vector<int> numbers_;
  int count_ = 0;
};

constexpr int kNotMet = -1;

// Puts each cell's mean where the nearest of its points lies: means lie beside a curved surface, by as much
// as the cell happens to cut off of it, and that would look like bends.
void to_nearest(std::span<const Vector3d> vertices, const std::vector<int>& cell_of,
                std::vector<Vector3d>& means) {
  std::vector<std::size_t> nearest(means.size());
  std::vector<double> away(means.size(), std::numeric_limits<double>::infinity());
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    if (cell_of[v] == kNotMet) continue;
    const auto cell = static_cast<std::size_t>(cell_of[v]);
    const double d = (vertices[v] - means[cell]).squaredNorm();
    if (!(d < away[cell])) continue;
    away[cell] = d;
    nearest[cell] = v;
  }
  for (std::size_t i = 0; i < means.size(); ++i) means[i] = vertices[nearest[i]];
}

// The same corners whichever comes first.
std::array<int, 3> sorted(std::array<int, 3> t) {
  std::sort(t.begin(), t.end());
  return t;
}

}  // namespace

surface::TriangleMesh thinned(const surface::TriangleMesh& mesh, double cell_mm) {
  const auto vertices = mesh.vertices();
  Vector3d low = Vector3d::Constant(std::numeric_limits<double>::infinity());
  for (const Vector3d& p : vertices) low = low.cwiseMin(p);
  Cells cells;
  surface::TriangleSoup soup;
  std::vector<int> cell_of(vertices.size(), kNotMet), members;
  constexpr std::uint64_t kBits = 21;  // designs are at most 2e7 mm wide, cells millimetres
  const auto whole = [](double x) {
    return std::min(static_cast<std::uint64_t>(x), (std::uint64_t{1} << kBits) - 1);
  };
  const auto cell = [&](int vertex) {
    const auto v = static_cast<std::size_t>(vertex);
    if (cell_of[v] != kNotMet) return cell_of[v];
    const Vector3d at = (vertices[v] - low) / cell_mm;
    const int c = cells.number(whole(at.x()) | whole(at.y()) << kBits | whole(at.z()) << 2 * kBits);
    if (static_cast<std::size_t>(c) == soup.vertices.size()) {
      soup.vertices.emplace_back(Vector3d::Zero());
      members.push_back(0);
    }
    soup.vertices[static_cast<std::size_t>(c)] += vertices[v];
    ++members[static_cast<std::size_t>(c)];
    return cell_of[v] = c;
  };
  for (const auto& t : mesh.triangles()) {
    const std::array<int, 3> kept{cell(t[0]), cell(t[1]), cell(t[2])};
    if (kept[0] != kept[1] && kept[1] != kept[2] && kept[2] != kept[0]) soup.triangles.push_back(kept);
  }
  for (std::size_t i = 0; i < soup.vertices.size(); ++i) soup.vertices[i] /= members[i];
  to_nearest(vertices, cell_of, soup.vertices);
  std::sort(soup.triangles.begin(), soup.triangles.end(),
            [](const auto& a, const auto& b) { return sorted(a) < sorted(b); });
  soup.triangles.erase(std::unique(soup.triangles.begin(), soup.triangles.end(),
                                   [](const auto& a, const auto& b) { return sorted(a) == sorted(b); }),
                       soup.triangles.end());
  return surface::TriangleMesh(std::move(soup));
}

}  // namespace hotblade::pipeline
