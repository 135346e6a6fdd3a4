// Everything the window shows of one program or design, made once; the state says what of it is seen.
#pragma once

#include <map>

#include "pipeline/preview/cut_values.hpp"
#include "pipeline/preview/ghosts.hpp"
#include "pipeline/preview/view_state.hpp"

namespace hotblade::pipeline::preview {

struct ViewModel {
  Program program;  // the strips shown; none for a design alone
  Scene scene;      // whole cut and ghosts as at the start
  std::map<Color, Coloring> colorings;
  std::vector<double> triangle_s;   // of the cut: when each is done, on the timeline; ascending
  std::vector<Polyline> air_paths;  // of both clamps, where the blade is not in the foam
  ViewFacts facts;
  const CellShown* cell = nullptr;  // of the arms in the scene; absent: none
};

// The model of a program, or of a design alone. Throws Error as scene_of does.
[[nodiscard]] ViewModel view_model(const Program& program, const surface::DesignSurface* design,
                                   const SceneOptions& options);
[[nodiscard]] ViewModel view_model(const surface::DesignSurface& design);

// The state that the window opens with: --at is its time, and it shows the cut so far.
[[nodiscard]] ViewState first_state(const ViewModel& model, const SceneOptions& options, View view);

// A place in the program, by index.
struct Moment {
  int strip = 0, pose = 0;
};

// The last pose at or before a time of the timeline. Throws std::logic_error when there is no pose.
[[nodiscard]] Moment moment_at(const ViewFacts& facts, double time_s);

// The time at which a pose is reached on the timeline, s.
[[nodiscard]] double time_of(const ViewModel& model, Moment moment);

[[nodiscard]] const BladePose& pose_at(const ViewModel& model, Moment moment);

// Words beside the picture.
struct Card {
  std::string title;
  std::vector<std::string> lines;
};

// The card with id, deviation, smallest radius, load and time of what is selected; its title is empty when
// nothing is.
[[nodiscard]] Card card_of(const ViewModel& model, const Selection& selection);

// The line above the time bar, as "S002  12.30 of 83.10 s  cut  x 8".
[[nodiscard]] std::string time_text(const ViewModel& model, const ViewState& state);

}  // namespace hotblade::pipeline::preview
