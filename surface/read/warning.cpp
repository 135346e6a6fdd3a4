#include "surface/read/warning.hpp"

#include <array>
#include <stdexcept>
#include <string_view>
#include <vector>

namespace hotblade::surface {
namespace {

constexpr auto kTexts = std::to_array<WarningInfo>({
    {Warning::kSinglePrecision,
     "coordinates of single precision, so far from the origin {} mm apart: move the design to the origin "
     "before it is exported, or export an OBJ"},
    {Warning::kNotSimplePolygon, "{} face is not a simple polygon and cut as a fan, the first in line {}"},
    {Warning::kNotSimplePolygons, "{} faces are not a simple polygon and cut as a fan, the first in line {}"},
    {Warning::kNearBorder,
     "{} border vertex within {} mm of another border, the first at {}: if the sheets belong together, set "
     "design.stitch_mm"},
    {Warning::kNearBorders,
     "{} border vertices within {} mm of another border, the first at {}: if the sheets belong together, set "
     "design.stitch_mm"},
    {Warning::kNormalLooksAway,
     "{} facet whose normal looks the other way than the corners go round: the corners count, the first in "
     "{} {}"},
    {Warning::kNormalsLookAway,
     "{} facets whose normals look the other way than the corners go round: the corners count, the first in "
     "{} {}"},
    {Warning::kNormalNotFinite,
     "{} facet whose normal is no finite number: the corners count, the first in {} {}"},
    {Warning::kNormalsNotFinite,
     "{} facets whose normals are no finite number: the corners count, the first in {} {}"},
    {Warning::kFacetHasAttribute,
     "{} facet has attribute bytes (colours), which are not read, the first in {} {}"},
    {Warning::kFacetsHaveAttributes,
     "{} facets have attribute bytes (colours), which are not read, the first in {} {}"},
    {Warning::kStatements, "{} statements passed over, the first {}: only polygons are read"},
    {Warning::kTriangleStrips, "triangle strips are passed over: only the faces are read"},
    {Warning::kLineOrPoint, "{} primitive of lines or points passed over: only triangles are read"},
    {Warning::kLinesOrPoints, "{} primitives of lines or points passed over: only triangles are read"},
    {Warning::kMeshAtRest, "{} mesh with a skin or morph targets read as at rest"},
    {Warning::kMeshesAtRest, "{} meshes with skins or morph targets read as at rest"},
    {Warning::kFacesCross,
     "{} pair of faces crosses, the first those of {}s {} and {} near {}: only one of them can be cut there, "
     "trim the sheets"},
    {Warning::kManyFacesCross,
     "{} pairs of faces cross, the first those of {}s {} and {} near {}: only one of them can be cut there, "
     "trim the sheets"},
});

constexpr bool in_order() {
  for (std::size_t i = 0; i < kTexts.size(); ++i) {
    if (static_cast<std::size_t>(kTexts[i].warning) != i) return false;
  }
  return true;
}
static_assert(in_order() && kTexts.back().warning == Warning::kManyFacesCross,
              "kTexts has one entry for each Warning, in its order");

std::string filled(std::string_view text, const std::vector<std::string>& values) {
  std::string out;
  for (const std::string& value : values) {
    const std::size_t place = text.find("{}");
    if (place == std::string_view::npos) throw std::logic_error("a warning has too many values");
    out += std::string(text.substr(0, place)) + value;
    text.remove_prefix(place + 2);
  }
  if (text.find("{}") != std::string_view::npos) throw std::logic_error("a warning has too few values");
  return out + std::string(text);
}

}  // namespace

std::span<const WarningInfo> warning_texts() {
  return kTexts;
}

std::string text_of(Warning warning, std::initializer_list<std::string> values) {
  return filled(kTexts[static_cast<std::size_t>(warning)].text, values);
}

std::string text_of(std::size_t count, Warning one, std::initializer_list<std::string> more) {
  std::vector<std::string> values{std::to_string(count)};
  values.insert(values.end(), more);
  return filled(kTexts[static_cast<std::size_t>(one) + (count == 1 ? 0 : 1)].text, values);
}

}  // namespace hotblade::surface
