#include "pipeline/report/pictures.hpp"

#include <array>
#include <utility>

#include "pipeline/preview/draw.hpp"
#include "pipeline/preview/exchange.hpp"
#include "pipeline/settings/error.hpp"

namespace hotblade::pipeline {

namespace {

using preview::View;

constexpr std::array<std::pair<View, const char*>, 3> kViews{{{View::kBest, "on the cut side"},
                                                              {View::kTop, "from above (+z)"},
                                                              {View::kFront, "from the front (-y)"}}};

}  // namespace

std::vector<RefusedReason> refused_reasons(const PlanResult& result) {
  std::vector<RefusedReason> reasons;
  for (const Refusal& refusal : result.refusals) reasons.push_back({describe(refusal), refusal.at});
  return reasons;
}

ReportPictures take_pictures(const PlanResult& result, const surface::DesignSurface& design) {
  ReportPictures taken;
  const bool planned = !result.program.strips.empty();
  try {
    preview::Scene scene =
        planned ? preview::scene_of(result.program, &design, {}) : preview::scene_of(design);
    if (!result.refusals.empty()) preview::mark_refusal(scene, refused_reasons(result));
    taken.scene_gltf = preview::gltf_of(scene);
    // The first picture says it; the others are shown small, and their space is for the geometry.
    std::vector<preview::Shot> shots;
    for (const auto& [view, caption] : kViews) shots.push_back({view, shots.empty()});
    std::vector<std::string> pngs = preview::pngs_of(scene, {}, shots);
    for (std::size_t i = 0; i < pngs.size(); ++i) {
      const std::string caption = kViews[i].second;
      taken.pictures.push_back({planned ? caption : "the design, " + caption, std::move(pngs[i])});
    }
  } catch (const Error& error) {
    taken.pictures.clear();
    taken.note = error.what();
  }
  return taken;
}

}  // namespace hotblade::pipeline
