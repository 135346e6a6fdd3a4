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

// The words of a picture would be too small to be read on a thumbnail.
constexpr preview::PictureSize kThumbnail{320, 180};

preview::Scene scene_of_plan(const PlanResult& result, const surface::DesignSurface& design) {
  preview::Scene scene = result.program.strips.empty() ? preview::scene_of(design)
                                                       : preview::scene_of(result.program, &design, {});
  if (!result.refusals.empty()) preview::mark_refusal(scene, refused_reasons(result));
  return scene;
}

std::string caption_of(const PlanResult& result, const std::string& view) {
  return (result.program.strips.empty() ? "the design, " : "") + view;
}

}  // namespace

std::vector<RefusedReason> refused_reasons(const PlanResult& result) {
  std::vector<RefusedReason> reasons;
  for (const Refusal& refusal : result.refusals) reasons.push_back({describe(refusal), refusal.at});
  return reasons;
}

ReportPictures take_pictures(const PlanResult& result, const surface::DesignSurface& design,
                             const std::function<void(double)>& progress) {
  // What measuring the cut for its colours takes, and the scene's file.
  constexpr double kScene = 0.3, kFile = 0.4;
  ReportPictures taken;
  try {
    const preview::Scene scene = scene_of_plan(result, design);
    progress(kScene);
    taken.scene_gltf = preview::gltf_of(scene);
    progress(kFile);
    // The first picture says it; the others are shown small, and their space is for the geometry.
    std::vector<preview::Shot> shots;
    for (const auto& [view, caption] : kViews) shots.push_back({view, shots.empty()});
    std::vector<std::string> pngs = preview::pngs_of(scene, {}, shots);
    for (std::size_t i = 0; i < pngs.size(); ++i)
      taken.pictures.push_back({caption_of(result, kViews[i].second), std::move(pngs[i])});
  } catch (const Error& error) {
    taken.pictures.clear();
    taken.note = error.what();
  }
  return taken;
}

ReportPictures take_thumbnail(const PlanResult& result, const surface::DesignSurface& design) {
  ReportPictures taken;
  try {
    const std::array shots{preview::Shot{kViews[0].first, false}};
    std::vector<std::string> pngs = preview::pngs_of(scene_of_plan(result, design), kThumbnail, shots);
    taken.pictures.push_back({caption_of(result, kViews[0].second), std::move(pngs[0])});
  } catch (const Error& error) {
    taken.note = error.what();
  }
  return taken;
}

}  // namespace hotblade::pipeline
