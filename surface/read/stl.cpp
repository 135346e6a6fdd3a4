#include "surface/read/stl.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include "surface/read/bytes.hpp"
#include "surface/read/design_surface.hpp"
#include "surface/read/warning.hpp"
#include "surface/read/words.hpp"

namespace hotblade::surface {
namespace {

constexpr std::size_t kHeader = 80, kCount = 4, kFacet = 50, kVector = 12;  // bytes
// So that corners have numbers.
constexpr std::size_t kMostFacets = std::numeric_limits<int>::max() / 3;

// Takes facets, and notes what is odd about them.
class Facets {
 public:
  explicit Facets(std::string_view place) { polygons_.place = place; }

  void reserve(std::size_t facets) {
    polygons_.positions.reserve(3 * facets);
    polygons_.corners.reserve(3 * facets);
    polygons_.first_corner.reserve(facets + 1);
    polygons_.face_place.reserve(facets);
    polygons_.face_group.reserve(facets);
  }

  void add(const Eigen::Vector3d& normal, const std::array<Eigen::Vector3d, 3>& corners, std::size_t place,
           std::uint32_t group) {
    for (const Eigen::Vector3d& corner : corners) {
      polygons_.corners.push_back(static_cast<int>(polygons_.positions.size()));
      polygons_.positions.push_back(corner);
    }
    polygons_.first_corner.push_back(static_cast<std::uint32_t>(polygons_.corners.size()));
    polygons_.face_place.push_back(static_cast<std::uint32_t>(place));
    polygons_.face_group.push_back(group);
    if (!normal.allFinite()) {
      not_finite_.note(place);
    } else if (looks_away(normal, corners)) {
      looking_away_.note(place);
    }
  }

  void note_attribute(std::size_t place) { attributes_.note(place); }
  Polygons& polygons() { return polygons_; }

  Polygons take() {
    tell(looking_away_, Warning::kNormalLooksAway);
    tell(not_finite_, Warning::kNormalNotFinite);
    tell(attributes_, Warning::kFacetHasAttribute);
    return std::move(polygons_);
  }

 private:
  struct Odd {
    std::size_t count = 0, first = 0;
    void note(std::size_t place) {
      if (count++ == 0) first = place;
    }
  };

  static bool looks_away(const Eigen::Vector3d& normal, const std::array<Eigen::Vector3d, 3>& corners) {
    // More than 120 degrees: normals of slivers are turned by the rounding of their corners.
    constexpr double kCosine = -0.5;
    const Eigen::Vector3d wound = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    return normal.dot(wound) < kCosine * normal.norm() * wound.norm();
  }

  void tell(const Odd& odd, Warning one) {
    if (odd.count == 0) return;
    polygons_.warnings.push_back(
        text_of(odd.count, one, {std::string(polygons_.place), std::to_string(odd.first)}));
  }

  Polygons polygons_;
  Odd looking_away_, not_finite_, attributes_;
};

std::size_t facets_of(std::string_view bytes) {
  return number_at<std::uint32_t>(bytes, kHeader);
}

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
  Facets taken("facet");
  taken.reserve(facets);
  for (std::size_t f = 0; f < facets; ++f) {
    std::size_t at = kHeader + kCount + kFacet * f;
    const auto vector = [&] {
      const Eigen::Vector3f value(number_at<float>(bytes, at), number_at<float>(bytes, at + 4),
                                  number_at<float>(bytes, at + 8));
      at += kVector;
      return Eigen::Vector3d(value.cast<double>());
    };
    const Eigen::Vector3d normal = vector();
    std::array<Eigen::Vector3d, 3> corners;
    for (Eigen::Vector3d& corner : corners) {
      corner = vector();
      const std::string why = refusal_of_position(corner, limit);
      if (!why.empty()) {
        fail("facet " + std::to_string(f + 1) + " (byte " + std::to_string(at - kVector) + "): " + why);
      }
    }
    taken.add(normal, corners, f + 1, 0);
    if (number_at<std::uint16_t>(bytes, at) != 0) taken.note_attribute(f + 1);
  }
  taken.polygons().spacing = single_precision_spacing(taken.polygons().positions);
  return taken.take();
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
    return taken_.take();
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
    Polygons& polygons = taken_.polygons();
    const std::string solid(words_.rest_of_line());
    if (!solid.empty()) {
      polygons.groups.push_back({solid, {}});
      if (polygons.groups.size() > kMostFacets) fail("too many solids: join them");
    }
    const auto group = static_cast<std::uint32_t>(solid.empty() ? 0 : polygons.groups.size() - 1);
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
    taken_.add(normal, corners, line, group);
    ++facets_;
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
  Facets taken_{"line"};
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
