#include "pipeline/report/pictures.hpp"

#include <tbb/task_group.h>

#include <algorithm>
#include <array>
#include <memory>
#include <utility>

#include "pipeline/preview/drawing.hpp"
#include "pipeline/preview/picture_texts.hpp"
#include "pipeline/report/refusal_text.hpp"
#include "pipeline/settings/error.hpp"

namespace hotblade::pipeline {

namespace {

using preview::View;

struct Taken {
  View view;
  bool by_strip;
  const char* caption;
};
constexpr std::array<Taken, 4> kViews{{{View::kBest, false, "on the cut side"},
                                       {View::kTop, false, "from above (+z)"},
                                       {View::kFront, false, "from the front (-y)"},
                                       {View::kBest, true, "which block is which: colours by strip"}}};

// The words of a picture would be too small to be read on a thumbnail.
constexpr preview::PictureSize kThumbnail{320, 180};

preview::Scene scene_of_plan(const PlanResult& result, const surface::DesignSurface& design, const Words& w) {
  preview::Scene scene = result.program.strips.empty() ? preview::scene_of(design)
                                                       : preview::scene_of(result.program, &design, {});
  if (!result.refusals.empty()) preview::mark_refusal(scene, refused_reasons(result, w));
  for (std::size_t i = 0; i < result.program.overrides.size() && i < result.refusals.size(); ++i) {
    std::replace(scene.caption.begin(), scene.caption.end(),
                 preview::text_of(preview::PictureText::kOverride, result.program.overrides[i]),
                 preview::text_of(preview::PictureText::kOverride, describe(result.refusals[i], w)));
  }
  return scene;
}

std::string caption_of(const PlanResult& result, const std::string& view) {
  return (result.program.strips.empty() ? "the design, " : "") + view;
}

// The view, then the scene's file, then the pictures.
void draw(const PlanResult& result, const preview::Scene& scene, Pictures pictures, const Words& w,
          const std::function<void(double)>& progress, ReportPictures& taken) {
  constexpr double kView = 0.4, kFile = 0.5;
  try {
    const std::unique_ptr<const preview::DrawnScene> drawn = preview::drawing().drawn(scene);
    progress(kView);
    std::vector<preview::Shot> shots;
    if (pictures == Pictures::kFull) {
      taken.scene_gltf = drawn->gltf();
      // The first picture says it; the others are shown small, and their space is for the geometry.
      for (const Taken& one : kViews) {
        // Of one strip there is nothing to tell apart.
        if (!one.by_strip || result.program.strips.size() > 1)
          shots.push_back({one.view, shots.empty(), one.by_strip});
      }
    } else {
      shots.push_back({kViews[0].view, false});
    }
    progress(kFile);
    const preview::PictureSize size = pictures == Pictures::kFull ? preview::PictureSize{} : kThumbnail;
    std::vector<std::string> pngs =
        drawn->pngs(size, shots, [&](const std::string& words) { return w.said(words); });
    for (std::size_t i = 0; i < pngs.size(); ++i)
      taken.pictures.push_back({caption_of(result, kViews[i].caption), std::move(pngs[i])});
  } catch (const Error& error) {
    taken.pictures.clear();
    taken.note = error.what();
  }
}

}  // namespace

std::vector<RefusedReason> refused_reasons(const PlanResult& result, const Words& w) {
  std::vector<RefusedReason> reasons;
  for (const Refusal& refusal : result.refusals) reasons.push_back({describe(refusal, w), refusal.at});
  return reasons;
}

std::optional<Pictures> pictures_named(const std::string& name) {
  constexpr std::array<std::pair<Pictures, const char*>, 3> kPictures{
      {{Pictures::kNone, "none"}, {Pictures::kThumb, "thumb"}, {Pictures::kFull, "full"}}};
  for (const auto& [pictures, one] : kPictures) {
    if (one == name) return pictures;
  }
  return std::nullopt;
}

ReportPictures take_pictures(const PlanResult& result, const surface::DesignSurface& design,
                             Pictures pictures, Viewer viewer, const std::function<void(double)>& progress) {
  const Words w(result.program.settings.job.language);
  ReportPictures taken;
  if (pictures == Pictures::kNone) taken.note = "not asked for (--no-pictures)";
  if (pictures == Pictures::kNone && viewer == Viewer::kNone) return taken;
  constexpr double kScene = 0.3;  // what measuring the cut for its colours takes
  const preview::Scene scene = scene_of_plan(result, design, w);
  progress(kScene);
  tbb::task_group beside;
  beside.run([&] {
    if (viewer != Viewer::kNone) taken.view = viewer_scene(scene, result.program, limits_of(viewer));
  });
  if (pictures != Pictures::kNone) draw(result, scene, pictures, w, progress, taken);
  beside.wait();
  return taken;
}

}  // namespace hotblade::pipeline
