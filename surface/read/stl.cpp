#include "surface/read/stl.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "surface/read/blocks.hpp"
#include "surface/read/bytes.hpp"
#include "surface/read/design_surface.hpp"
#include "surface/read/first_of_equals.hpp"
#include "surface/read/warning.hpp"
#include "surface/read/words.hpp"

namespace hotblade::surface {
namespace {

constexpr std::size_t kHeader = 80, kCount = 4, kFacet = 50, kVector = 12;  // bytes
// So that corners have numbers.
constexpr std::size_t kMostFacets = std::numeric_limits<int>::max() / 3;

// Counts facets of a kind, and keeps the first one's place.
struct Odd {
  std::size_t count = 0, first = 0;
  void note(std::size_t place) {
    if (count++ == 0) first = place;
  }
  void add(const Odd& later) {
    if (count == 0) first = later.first;
    count += later.count;
  }
};

// What is odd about facets.
struct Oddities {
  Odd looking_away, not_finite, attributes;

  void look(const Eigen::Vector3d& normal, const std::array<Eigen::Vector3d, 3>& corners, std::size_t place) {
    if (!normal.allFinite()) {
      not_finite.note(place);
    } else if (looks_away(normal, corners)) {
      looking_away.note(place);
    }
  }

  void add(const Oddities& later) {
    looking_away.add(later.looking_away);
    not_finite.add(later.not_finite);
    attributes.add(later.attributes);
  }

  void tell(Polygons& polygons) const {
    tell(looking_away, Warning::kNormalLooksAway, polygons);
    tell(not_finite, Warning::kNormalNotFinite, polygons);
    tell(attributes, Warning::kFacetHasAttribute, polygons);
  }

 private:
  static bool looks_away(const Eigen::Vector3d& normal, const std::array<Eigen::Vector3d, 3>& corners) {
    // More than 120 degrees: normals of slivers are turned by the rounding of their corners.
    constexpr double kCosine = -0.5;
    const Eigen::Vector3d wound = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    return normal.dot(wound) < kCosine * normal.norm() * wound.norm();
  }

  static void tell(const Odd& odd, Warning one, Polygons& polygons) {
    if (odd.count == 0) return;
    polygons.warnings.push_back(
        text_of(odd.count, one, {std::string(polygons.place), std::to_string(odd.first)}));
  }
};

std::size_t facets_of(std::string_view bytes) {
  return number_at<std::uint32_t>(bytes, kHeader);
}

// Reads facets side by side.
class BinaryFacets {
 public:
  BinaryFacets(std::string_view bytes, std::size_t facets, double limit)
      : bytes_(bytes), facets_(facets), limit_(limit) {}

  Polygons parse(const std::string& name) {
    polygons_.place = "facet";
    check(name);
    join_corners();
    polygons_.first_corner.resize(facets_ + 1);
    polygons_.face_place.resize(facets_);
    polygons_.face_group.resize(facets_);
    for_blocks(facets_, kBlock, [&](std::size_t from, std::size_t to) {
      for (std::size_t f = from; f < to; ++f) {
        polygons_.first_corner[f + 1] = static_cast<std::uint32_t>(3 * f + 3);
        polygons_.face_place[f] = static_cast<std::uint32_t>(f + 1);
      }
    });
    polygons_.spacing = single_precision_spacing(polygons_.positions);
    return std::move(polygons_);
  }

 private:
  // The normal (0) or a corner (1 to 3) of a facet, and the place of its first byte.
  [[nodiscard]] static std::size_t place(std::size_t facet, std::size_t k) {
    return kHeader + kCount + kFacet * facet + kVector * k;
  }
  [[nodiscard]] Eigen::Vector3d vector(std::size_t facet, std::size_t k) const {
    const std::size_t at = place(facet, k);
    return Eigen::Vector3f(number_at<float>(bytes_, at), number_at<float>(bytes_, at + 4),
                           number_at<float>(bytes_, at + 8))
        .cast<double>();
  }

  // Refuses the first facet that cannot be taken, and tells what is odd about the others.
  void check(const std::string& name) {
    const std::size_t blocks = (facets_ + kBlock - 1) / kBlock;
    std::vector<Oddities> odd(blocks);
    std::vector<std::size_t> refused(blocks, facets_);
    for_blocks(facets_, kBlock, [&](std::size_t from, std::size_t to) {
      for (std::size_t f = from; f < to && refused[from / kBlock] == facets_; ++f)
        if (!look_at(f, odd[from / kBlock])) refused[from / kBlock] = f;
    });
    for (const std::size_t f : refused)
      if (f < facets_) refuse(f, name);
    for (std::size_t block = 1; block < blocks; ++block) odd[0].add(odd[block]);
    odd[0].tell(polygons_);
  }

  // False for a facet with a corner that cannot be taken.
  bool look_at(std::size_t f, Oddities& odd) const {
    std::array<Eigen::Vector3d, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      corners[k] = vector(f, k + 1);
      if (!(corners[k].cwiseAbs().maxCoeff() <= limit_) || !corners[k].allFinite()) return false;
    }
    odd.look(vector(f, 0), corners, f + 1);
    if (number_at<std::uint16_t>(bytes_, place(f, 4)) != 0) odd.attributes.note(f + 1);
    return true;
  }

  // Corners of the same bytes are one position: a surface has six of them at a vertex, and six times the
  // positions would take more memory than all else.
  void join_corners() {
    const std::size_t count = 3 * facets_, blocks = (count + kBlock - 1) / kBlock;
    const auto bytes_of = [&](std::size_t c) { return place(c / 3, c % 3 + 1); };
    const std::vector<int> first = first_of_equals(
        count,
        [&](std::size_t c) {
          return stir(stir(0, number_at<std::uint64_t>(bytes_, bytes_of(c))),
                      number_at<std::uint32_t>(bytes_, bytes_of(c) + 8));
        },
        [&](std::size_t c, std::size_t d) {
          return bytes_.substr(bytes_of(c), kVector) == bytes_.substr(bytes_of(d), kVector);
        },
        Equals::kNear);
    const auto is_first = [&](std::size_t c) { return first[c] == static_cast<int>(c); };
    std::vector<std::size_t> next(blocks + 1, 0);  // number of a block's first position
    for_blocks(count, kBlock, [&](std::size_t from, std::size_t to) {
      for (std::size_t c = from; c < to; ++c) next[from / kBlock + 1] += is_first(c) ? 1U : 0U;
    });
    std::partial_sum(next.begin(), next.end(), next.begin());
    polygons_.positions.resize(next.back());
    polygons_.joined = count - next.back();
    polygons_.corners.resize(count);
    for_blocks(count, kBlock, [&](std::size_t from, std::size_t to) {
      std::size_t number = next[from / kBlock];
      for (std::size_t c = from; c < to; ++c) {
        if (!is_first(c)) continue;
        polygons_.positions[number] = vector(c / 3, c % 3 + 1);
        polygons_.corners[c] = static_cast<int>(number++);
      }
    });
    for_blocks(count, kBlock, [&](std::size_t from, std::size_t to) {
      for (std::size_t c = from; c < to; ++c)
        if (!is_first(c)) polygons_.corners[c] = polygons_.corners[static_cast<std::size_t>(first[c])];
    });
  }

  // Tells of the first corner that cannot be taken.
  void refuse(std::size_t f, const std::string& name) const {
    for (std::size_t k = 1; k <= 3; ++k) {
      if (const std::string why = refusal_of_position(vector(f, k), limit_); !why.empty())
        throw MeshError(name + ": facet " + std::to_string(f + 1) + " (byte " + std::to_string(place(f, k)) +
                        "): " + why);
    }
  }

  std::string_view bytes_;
  std::size_t facets_;
  double limit_;
  Polygons polygons_;
};

Polygons parse_binary(std::string_view bytes, const std::string& name, double limit) {
  const auto fail = [&name](const std::string& what) { throw MeshError(name + ": " + what); };
  if (bytes.size() < kHeader + kCount) {
    fail("not an STL (" + std::to_string(bytes.size()) + " bytes, a binary one has at least " +
         std::to_string(kHeader + kCount) + ", a text one begins with solid): export it again");
  }
  const std::size_t facets = facets_of(bytes);
  if (const std::size_t size = kHeader + kCount + kFacet * facets; size != bytes.size()) {
    fail("byte " + std::to_string(kHeader) + ": the file has another size than its number of facets makes (" +
         std::to_string(bytes.size()) + " bytes, " + std::to_string(facets) + " facets make " +
         std::to_string(size) + "): it is cut short, or no STL: export it again");
  }
  if (facets == 0) fail("byte " + std::to_string(kHeader) + ": no facets (0): export the design as a mesh");
  if (facets > kMostFacets)
    fail("too many facets (" + std::to_string(facets) + ", limit " + std::to_string(kMostFacets) +
         "): thin the mesh out");
  return BinaryFacets(bytes, facets, limit).parse(name);
}

class StlText {
 public:
  StlText(std::string_view text, std::string name, double limit)
      : words_(text), name_(std::move(name)), limit_(limit) {}

  Polygons parse() {
    std::string_view word = words_.next();
    while (!word.empty()) {
      if (!is(word, "solid")) reject(word, "solid");
      read_solid();
      word = words_.next();
    }
    if (facets_ == 0) fail("no facets in the file (0): export the design as a mesh");
    odd_.tell(polygons_);
    return std::move(polygons_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw MeshError(place_of(name_, "line", words_.line()) + what);
  }

  // Keywords are written in small letters, by some programs in capitals.
  static bool is(std::string_view word, std::string_view keyword) {
    return std::equal(word.begin(), word.end(), keyword.begin(), keyword.end(),
                      [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a - 'A' + 'a' : a) == b; });
  }

  [[noreturn]] void reject(std::string_view word, const std::string& due) const {
    if (word.empty())
      fail("the text ends where " + due + " is due (" + counted(facets_, "facet", "facets") +
           " so far): it is cut short, export it again");
    fail("not the word that is due ('" + shown_token(word) + "', " + due + "): the text is damaged");
  }

  void expect(const char* keyword) {
    if (const std::string_view word = words_.next(); !is(word, keyword)) reject(word, keyword);
  }

  void read_solid() {
    const std::string solid(words_.rest_of_line());
    if (!solid.empty()) {
      polygons_.groups.push_back({solid, {}});
      if (polygons_.groups.size() > kMostFacets) fail("too many solids: join them");
    }
    const auto group = static_cast<std::uint32_t>(solid.empty() ? 0 : polygons_.groups.size() - 1);
    for (;;) {
      const std::string_view word = words_.next();
      if (is(word, "endsolid")) break;
      if (!is(word, "facet")) reject(word, "facet or endsolid");
      read_facet(group);
    }
    (void)words_.rest_of_line();  // its name again
  }

  void read_facet(std::uint32_t group) {
    const std::size_t line = words_.line();
    if (facets_ >= kMostFacets)
      fail("too many facets (limit " + std::to_string(kMostFacets) + "): thin the mesh out");
    if (line > std::numeric_limits<std::uint32_t>::max())
      fail("too many lines (limit 4294967295): save it as binary STL");
    expect("normal");
    const Eigen::Vector3d normal = read_vector(false);
    expect("outer");
    expect("loop");
    std::array<Eigen::Vector3d, 3> corners;
    for (Eigen::Vector3d& corner : corners) {
      expect("vertex");
      corner = read_vector(true);
    }
    expect("endloop");
    expect("endfacet");
    add(corners, line, group);
    odd_.look(normal, corners, line);
    ++facets_;
  }

  void add(const std::array<Eigen::Vector3d, 3>& corners, std::size_t line, std::uint32_t group) {
    for (const Eigen::Vector3d& corner : corners) {
      polygons_.corners.push_back(static_cast<int>(polygons_.positions.size()));
      polygons_.positions.push_back(corner);
    }
    polygons_.first_corner.push_back(static_cast<std::uint32_t>(polygons_.corners.size()));
    polygons_.face_place.push_back(static_cast<std::uint32_t>(line));
    polygons_.face_group.push_back(group);
  }

  Eigen::Vector3d read_vector(bool position) {
    Eigen::Vector3d vector;
    for (double& value : vector) {
      const std::string_view word = words_.next();
      const std::optional<double> number = number_in(word);
      if (!number) {
        if (word.empty()) reject(word, "a number");
        if (word.find('#') != std::string_view::npos)
          value = std::numeric_limits<double>::quiet_NaN();  // 1.#IND
        else
          fail("not a number ('" + shown_token(word) + "'): " +
               (word.find(',') != std::string_view::npos ? "export with a decimal point, not a comma"
                                                         : "three numbers are due"));
      } else {
        value = *number;
      }
      if (!position) continue;
      if (const std::string why = refusal_of_coordinate(value, word, limit_); !why.empty()) fail(why);
    }
    return vector;
  }

  Words words_;
  std::string name_;
  double limit_;
  Polygons polygons_;
  Oddities odd_;
  std::size_t facets_ = 0;
};

}  // namespace

bool is_binary_stl(std::string_view bytes) {
  return bytes.size() >= kHeader + kCount && bytes.size() == kHeader + kCount + kFacet * facets_of(bytes);
}

Polygons parse_stl(std::string_view bytes, const std::string& name, double limit) {
  // A text that is cut short is told as text.
  if (is_binary_stl(bytes) || Words(bytes.substr(0, 4096)).next() != "solid" ||
      bytes.substr(0, 4096).find('\0') != std::string_view::npos) {
    return parse_binary(bytes, name, limit);
  }
  return StlText(bytes, name, limit).parse();
}

}  // namespace hotblade::surface
