#include "surface/read/polygons.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <set>

#include "surface/read/blocks.hpp"
#include "surface/read/design_surface.hpp"
#include "surface/read/words.hpp"

namespace hotblade::surface {
namespace {

// What the user may have meant.
std::string known_groups(const Polygons& polygons) {
  std::set<std::string> names;
  for (const std::uint32_t g :
       std::set<std::uint32_t>(polygons.face_group.begin(), polygons.face_group.end())) {
    const Polygons::Group& group = polygons.groups[g];
    if (!group.object.empty()) names.insert(group.object);
    names.insert(group.names.begin(), group.names.end());
  }
  if (names.empty()) return "the file names none, leave design.group empty";
  constexpr std::size_t kShown = 8;
  std::string text = "choose one of";
  std::size_t listed = 0;
  for (const std::string& name : names) {
    if (listed++ == kShown) return text + ", ... (" + std::to_string(names.size()) + " in all)";
    text += (listed == 1 ? " " : ", ") + shown_token(name);
  }
  return text;
}

}  // namespace

bool Polygons::Group::has(std::string_view name) const {
  return object == name || joined_words(names) == name ||
         std::find(names.begin(), names.end(), name) != names.end();
}

void keep_group(Polygons& polygons, const std::string& group, const std::string& name) {
  std::vector<bool> wanted(polygons.groups.size());
  for (std::size_t g = 0; g < wanted.size(); ++g) wanted[g] = polygons.groups[g].has(group);
  std::size_t faces = 0, corners = 0;
  for (std::size_t f = 0; f < polygons.faces(); ++f) {
    if (!wanted[polygons.face_group[f]]) continue;
    const std::size_t from = polygons.first_corner[f], to = polygons.first_corner[f + 1];
    std::copy(polygons.corners.begin() + static_cast<std::ptrdiff_t>(from),
              polygons.corners.begin() + static_cast<std::ptrdiff_t>(to),
              polygons.corners.begin() + static_cast<std::ptrdiff_t>(corners));
    polygons.first_corner[faces] = static_cast<std::uint32_t>(corners);
    polygons.face_place[faces] = polygons.face_place[f];
    polygons.face_group[faces++] = polygons.face_group[f];
    corners += to - from;
  }
  if (faces == 0)
    throw MeshError(name + ": no faces in group '" + shown_token(group) + "': " + known_groups(polygons));
  polygons.first_corner[faces] = static_cast<std::uint32_t>(corners);
  polygons.first_corner.resize(faces + 1);
  polygons.corners.resize(corners);
  polygons.face_place.resize(faces);
  polygons.face_group.resize(faces);
}

std::string place_of(const std::string& name, std::string_view place, std::size_t number) {
  if (place == "line") return name + ":" + std::to_string(number) + ": ";
  return name + ": " + std::string(place) + " " + std::to_string(number) + ": ";
}

std::string refusal_of_coordinate(double value, std::string_view shown, double limit) {
  if (!std::isfinite(value)) {
    return "coordinate is not a finite number ('" + shown_token(shown) +
           "'): repair the vertex in the CAD program";
  }
  if (std::abs(value) > limit) {
    return "coordinate too large (" + shown_token(shown) + ", limit 1e7 mm after scaling): check --units";
  }
  return "";
}

std::string refusal_of_position(const Eigen::Vector3d& position, double limit) {
  if (position.allFinite() && position.cwiseAbs().maxCoeff() <= limit) return "";
  for (const double value : position) {
    std::array<char, 32> shown{};
    std::snprintf(shown.data(), shown.size(), "%.9g", value);
    if (std::string why = refusal_of_coordinate(value, shown.data(), limit); !why.empty()) return why;
  }
  return "";
}

double single_precision_spacing(std::span<const Eigen::Vector3d> positions) {
  std::vector<double> blocks((positions.size() + kBlock - 1) / kBlock, 0.0);
  for_blocks(positions.size(), kBlock, [&](std::size_t from, std::size_t to) {
    for (const Eigen::Vector3d& p : positions.subspan(from, to - from))
      blocks[from / kBlock] = std::max(blocks[from / kBlock], p.cwiseAbs().maxCoeff());
  });
  double largest = 0;
  for (const double own : blocks) largest = std::max(largest, own);
  const auto single = static_cast<float>(largest);
  return static_cast<double>(std::nextafter(single, std::numeric_limits<float>::infinity())) -
         static_cast<double>(single);
}

}  // namespace hotblade::surface
