#include "pipeline/report/pictures.hpp"

#include <array>
#include <utility>

#include "pipeline/command_error.hpp"
#include "pipeline/preview/draw.hpp"
#include "pipeline/preview/exchange.hpp"

namespace hotblade::pipeline {

namespace {

using preview::View;

constexpr std::array<std::pair<View, const char*>, 3> kViews{{{View::kBest, "on the cut side"},
                                                              {View::kTop, "from above (+z)"},
                                                              {View::kFront, "from the front (-y)"}}};

}  // namespace

ReportPictures take_pictures(const PlanResult& result, const surface::DesignSurface& design) {
  ReportPictures taken;
  const bool planned = !result.program.strips.empty();
  try {
    preview::Scene scene =
        planned ? preview::scene_of(result.program, &design, {}) : preview::scene_of(design);
    taken.scene_gltf = preview::gltf_of(scene);
    for (const auto& [view, caption] : kViews) {
      taken.pictures.push_back(
          {planned ? caption : "the design, " + std::string(caption), preview::png_of(scene, {}, view)});
      // The first picture says it; the others are shown small, and their space is for the geometry.
      scene.caption.clear();
    }
  } catch (const CommandError& error) {
    taken.pictures.clear();
    taken.note = error.what();
  }
  return taken;
}

}  // namespace hotblade::pipeline
