// What a design's reader warns of: each sentence has a code and stands in one table, with places for its
// values, so that pages in another language can find it again.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>

namespace hotblade::surface {

// Those with a count come in pairs: of one, and of many.
enum class Warning : std::uint8_t {
  kSinglePrecision,
  kNotSimplePolygon,
  kNotSimplePolygons,
  kNearBorder,
  kNearBorders,
  kNormalLooksAway,
  kNormalsLookAway,
  kNormalNotFinite,
  kNormalsNotFinite,
  kFacetHasAttribute,
  kFacetsHaveAttributes,
  kStatements,
  kTriangleStrips,
  kLineOrPoint,
  kLinesOrPoints,
  kMeshAtRest,
  kMeshesAtRest,
  kFacesCross,
  kManyFacesCross,
};

struct WarningInfo {
  Warning warning = Warning::kSinglePrecision;
  const char* text = "";  // a place for a value is {}
};

// Returns all entries, in the enum's order.
[[nodiscard]] std::span<const WarningInfo> warning_texts();

// Returns the warning with its values in their places. Throws std::logic_error where they are not as many.
[[nodiscard]] std::string text_of(Warning warning, std::initializer_list<std::string> values = {});

// Returns the one or the many of a pair, by the count, which is its first value.
[[nodiscard]] std::string text_of(std::size_t count, Warning one, std::initializer_list<std::string> more);

}  // namespace hotblade::surface
