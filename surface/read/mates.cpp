#include "surface/read/mates.hpp"

#include <algorithm>
#include <atomic>

#include "surface/read/blocks.hpp"

namespace hotblade::surface {
namespace {

std::size_t nth(int i) {
  return static_cast<std::size_t>(i);
}

// The corners at each vertex: those at v are corner[first[v]] to corner[first[v + 1] - 1], in any order.
struct CornersAtVertices {
  std::vector<int> first, corner;
};

CornersAtVertices corners_at_vertices(std::size_t vertices, std::span<const std::array<int, 3>> triangles) {
  CornersAtVertices found{std::vector<int>(vertices + 1, 0), std::vector<int>(3 * triangles.size())};
  const auto place = [&](int v) { return std::atomic_ref<int>(found.first[nth(v)]); };
  for_blocks(triangles.size(), kBlock, [&](std::size_t from, std::size_t to) {
    for (std::size_t f = from; f < to; ++f)
      for (const int v : triangles[f]) place(v).fetch_add(1, std::memory_order_relaxed);
  });
  // Ends first; filling counts down to the beginnings.
  for (std::size_t v = 0, sum = 0; v <= vertices; ++v) {
    sum += nth(found.first[v]);
    found.first[v] = static_cast<int>(sum);
  }
  for_blocks(triangles.size(), kBlock, [&](std::size_t from, std::size_t to) {
    for (std::size_t f = from; f < to; ++f) {
      for (std::size_t i = 0; i < 3; ++i) {
        const int slot = place(triangles[f][i]).fetch_sub(1, std::memory_order_relaxed) - 1;
        found.corner[nth(slot)] = static_cast<int>(3 * f + i);
      }
    }
  });
  return found;
}

// What a corner's triangle has beside its vertex.
struct Spoke {
  int corner, next, before;  // its vertices after and before the corner
};

// Pairs the triangles at one vertex across the edges there.
class Fan {
 public:
  // Takes the corners at the vertex, sets `mate` of each, and tells whether they make one fan.
  bool pair(std::span<const int> corners, std::span<const std::array<int, 3>> triangles,
            std::vector<int>& mate) {
    spokes_.clear();
    for (const int c : corners) {
      const auto& t = triangles[nth(c / 3)];
      spokes_.push_back({c, t[nth((c + 1) % 3)], t[nth((c + 2) % 3)]});
    }
    if (!order()) return false;
    std::size_t start = 0, borders = 0;
    after_.resize(spokes_.size());
    for (std::size_t i = 0; i < spokes_.size(); ++i) {
      after_[i] = beyond(i);
      // The mate of an edge that leaves the vertex is the one that comes in along it, of a triangle whose
      // corner here is the next one.
      mate[nth(spokes_[i].corner)] = after_[i] < 0 ? -1 : corner_before(spokes_[nth(after_[i])].corner);
      if (after_[i] >= 0) continue;
      start = i;
      ++borders;
    }
    return borders <= 1 && walk(start, borders == 1) == spokes_.size();
  }

 private:
  // Vertices with more triangles than this sort them first.
  static constexpr std::size_t kFew = 24;

  static int corner_before(int c) { return c % 3 == 0 ? c + 2 : c - 1; }

  // Tells whether no two edges run the same way between the same vertices; sorts many for beyond().
  bool order() {
    const auto by_before = [](const Spoke& s, const Spoke& t) { return s.before < t.before; };
    if (spokes_.size() <= kFew) {
      for (std::size_t i = 0; i < spokes_.size(); ++i)
        for (std::size_t k = 0; k < i; ++k)
          if (spokes_[i].next == spokes_[k].next || spokes_[i].before == spokes_[k].before) return false;
      return true;
    }
    std::sort(spokes_.begin(), spokes_.end(), [](const Spoke& s, const Spoke& t) { return s.next < t.next; });
    for (std::size_t i = 1; i < spokes_.size(); ++i)
      if (spokes_[i].next == spokes_[i - 1].next) return false;
    std::sort(spokes_.begin(), spokes_.end(), by_before);
    for (std::size_t i = 1; i < spokes_.size(); ++i)
      if (spokes_[i].before == spokes_[i - 1].before) return false;
    return true;
  }

  // The spoke of the triangle beyond the edge that leaves the vertex in spoke i; -1 on the border.
  [[nodiscard]] int beyond(std::size_t i) const {
    const int wanted = spokes_[i].next;
    if (spokes_.size() > kFew) {
      const auto found = std::lower_bound(spokes_.begin(), spokes_.end(), wanted,
                                          [](const Spoke& s, int v) { return s.before < v; });
      return found != spokes_.end() && found->before == wanted ? static_cast<int>(found - spokes_.begin())
                                                               : -1;
    }
    for (std::size_t k = 0; k < spokes_.size(); ++k)
      if (spokes_[k].before == wanted) return static_cast<int>(k);
    return -1;
  }

  // How many triangles are met going round: from the border, against the sense of after_, or from anywhere.
  std::size_t walk(std::size_t start, bool border) {
    if (border) {
      // Each triangle but the first is after one other: as many of them in a row as there are.
      from_.assign(spokes_.size(), -1);
      for (std::size_t i = 0; i < after_.size(); ++i)
        if (after_[i] >= 0) from_[nth(after_[i])] = static_cast<int>(i);
    }
    const std::vector<int>& way = border ? from_ : after_;
    std::size_t met = 0;
    for (int i = static_cast<int>(start); i >= 0 && met < spokes_.size(); i = way[nth(i)]) {
      ++met;
      if (!border && way[nth(i)] == static_cast<int>(start)) break;
    }
    return met;
  }

  std::vector<Spoke> spokes_;
  std::vector<int> after_, from_;
};

}  // namespace

std::optional<Mates> plain_mates(std::size_t vertices, std::span<const std::array<int, 3>> triangles) {
  const CornersAtVertices corners = corners_at_vertices(vertices, triangles);
  Mates mates{std::vector<int>(3 * triangles.size()), std::vector<int>(vertices, -1)};
  std::atomic<bool> plain = true;
  for_blocks(vertices, kBlock / 4, [&](std::size_t from, std::size_t to) {
    Fan fan;
    for (std::size_t v = from; v < to && plain.load(std::memory_order_relaxed); ++v) {
      const auto first = nth(corners.first[v]), last = nth(corners.first[v + 1]);
      if (first == last) continue;
      const auto own = std::span(corners.corner).subspan(first, last - first);
      mates.lowest[v] = *std::min_element(own.begin(), own.end());
      if (!fan.pair(own, triangles, mates.of_corner)) plain = false;
    }
  });
  if (!plain) return std::nullopt;
  return mates;
}

}  // namespace hotblade::surface
