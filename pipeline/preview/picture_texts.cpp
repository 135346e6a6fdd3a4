#include "pipeline/preview/picture_texts.hpp"

#include <array>

namespace hotblade::pipeline::preview {
namespace {

constexpr auto kPictureTexts = std::to_array<PictureTextInfo>({
    {PictureText::kKept, "{:.0f} x {:.0f} x {:.0f} mm, {} kept"},
    {PictureText::kOneStrip, "{} strip, {} ribs, {}"},
    {PictureText::kStrips, "{} strips, {} ribs, {}"},
    {PictureText::kVerification, "verification {}"},
    {PictureText::kAmber, "amber: {}"},
    {PictureText::kLargestDeviation, "deviation max {:.2f}, p99 {:.2f} mm"},
    {PictureText::kUncut, "uncut {:.0f} mm2"},
    {PictureText::kOverride, "override: {}"},
    {PictureText::kBladesLeftOut, "blade ends over other strips are left out: --strip shows them"},
    {PictureText::kReadAs, "{:.0f} x {:.0f} x {:.0f} mm (read as {})"},
    {PictureText::kVertices, "{} vertices, {} triangles"},
    {PictureText::kOnePiece, "{} piece"},
    {PictureText::kPieces, "{} pieces"},
    {PictureText::kRefused, "refused: {}"},
    {PictureText::kRefusedAndMore, "refused: {} (and {} more)"},
    {PictureText::kRinged, "ringed: {}"},
    {PictureText::kStripBlade, "{}, blade {:g} mm"},
    {PictureText::kBladeEvery, "blade every {:.0f} mm"},
    {PictureText::kColoursRepeat, "and {} more, colours repeat"},
    {PictureText::kFoamLeft, "foam left standing: +"},
    {PictureText::kAboveTolerance, "tolerance +{:g}"},
    {PictureText::kBelowTolerance, "tolerance -{:g}"},
    {PictureText::kTooDeep, "cut too deep: -"},
    {PictureText::kAllowed, "allowed {:.3g}"},
    {PictureText::kDesignNotCut, "design, not cut"},
    {PictureText::kPlannedRibs, "planned ribs"},
    {PictureText::kFoamBlock, "foam block"},
});

constexpr bool texts_in_order() {
  for (std::size_t i = 0; i < kPictureTexts.size(); ++i) {
    if (static_cast<std::size_t>(kPictureTexts[i].text) != i) return false;
  }
  return kPictureTexts.back().text == PictureText::kFoamBlock;
}
static_assert(texts_in_order(), "kPictureTexts has one entry for each PictureText, in its order");

}  // namespace

std::span<const PictureTextInfo> picture_texts() {
  return kPictureTexts;
}

}  // namespace hotblade::pipeline::preview
