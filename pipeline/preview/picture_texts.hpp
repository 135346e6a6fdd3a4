// What stands in a picture beside its shapes: one table of its texts, with places for values, so that a
// report in another language can say them in its own.
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace hotblade::pipeline::preview {

enum class PictureText : std::uint8_t {
  kKept,
  kOneStrip,
  kStrips,
  kVerification,
  kAmber,
  kLargestDeviation,
  kUncut,
  kOverride,
  kBladesLeftOut,
  kReadAs,
  kVertices,
  kOnePiece,
  kPieces,
  kRefused,
  kRefusedAndMore,
  kRinged,
  kStripBlade,
  kBladeEvery,
  kColoursRepeat,
  kFoamLeft,
  kAboveTolerance,
  kBelowTolerance,
  kTooDeep,
  kAllowed,
  kDesignNotCut,
  kPlannedRibs,
  kFoamBlock,
};

struct PictureTextInfo {
  PictureText text = PictureText::kKept;
  const char* english = "";
};

// Returns all entries, in the enum's order.
[[nodiscard]] std::span<const PictureTextInfo> picture_texts();

// Returns the text in English, with its values in their places.
template <typename... Values>
[[nodiscard]] std::string text_of(PictureText text, const Values&... values) {
  return fmt::format(fmt::runtime(picture_texts()[static_cast<std::size_t>(text)].english), values...);
}

}  // namespace hotblade::pipeline::preview
