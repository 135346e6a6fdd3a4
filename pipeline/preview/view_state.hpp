// What the window shows, as one plain value, and how keys, time and clicks change it. None of it draws, so
// all of it is tested without a display.
#pragma once

#include <algorithm>
#include <bitset>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pipeline/preview/scene.hpp"
#include "pipeline/preview/shot.hpp"

namespace hotblade::pipeline::preview {

enum class Layer { kDesign, kCut, kRibs, kBlocks, kBlade, kGhosts, kPaths, kLegend, kArms };
constexpr std::size_t kLayers = 9;

enum class Part { kNone, kStrip, kRib, kPose };

// One strip, or one rib or pose of it by index.
struct Selection {
  Part part = Part::kNone;
  int strip = -1, index = -1;
  bool operator==(const Selection&) const = default;
};

// A plane across an axis of the design frame, beyond which everything is hidden.
struct ClipPlane {
  int axis = -1;       // 0 x, 1 y, 2 z; -1: nothing is clipped
  double share = 0.5;  // of the design's extent along the axis
  bool keeps_low = true;
  bool operator==(const ClipPlane&) const = default;
};

struct ViewState {
  double time_s = 0;  // strips one after another, in the program's order
  bool playing = false;
  double speed = 8;         // seconds of the program in one of the clock
  bool cut_so_far = false;  // the cut up to the time; else all of it
  Color color = Color::kStrip;
  std::bitset<kLayers> hidden;  // by Layer
  ClipPlane clip;
  Selection selection;
  View view = View::kBest;
  int aims = 0;                         // counts up whenever the camera is to be set anew
  std::optional<double> ghost_step_mm;  // absent: eight a strip
  bool help = false;
  bool closed = false;

  [[nodiscard]] bool shows(Layer layer) const { return !hidden.test(static_cast<std::size_t>(layer)); }
};

// The facts of the program that changes of the state need; all empty for a design alone.
struct ViewFacts {
  std::vector<double> strip_start_s;  // a strip, and the end of the last one
  std::vector<double> pose_s;         // of all strips, ascending
  std::vector<int> first_pose;        // a strip, into pose_s, and the number of all
  std::vector<Color> colors;          // that can be shown

  [[nodiscard]] double end_s() const { return strip_start_s.empty() ? 0 : strip_start_s.back(); }
  [[nodiscard]] int strips() const { return std::max(0, static_cast<int>(strip_start_s.size()) - 1); }
  // The strip being cut at a time of all; the later one where they meet.
  [[nodiscard]] int strip_at(double time_s) const;
};

// What lies under a pixel: `pose` is the pose that cut there, where the part is a strip.
struct Picked {
  Selection selection;
  int pose = -1;
};

// The state after a key, which is named as X11 does ("space", "Left", "plus", "c"); an unknown one changes
// nothing.
[[nodiscard]] ViewState after_key(ViewState state, const ViewFacts& facts, std::string_view key);

// The state `elapsed_s` of the clock later; playing stops at the end of the program.
[[nodiscard]] ViewState after_clock(ViewState state, const ViewFacts& facts, double elapsed_s);

// The state at a share (0 to 1, clamped) of the whole time.
[[nodiscard]] ViewState after_seek(ViewState state, const ViewFacts& facts, double share);

// The state after a click, which selects what lies there; a second click on a selected strip selects the
// pose that cut there and goes to its time. A click on nothing selects nothing.
[[nodiscard]] ViewState after_pick(ViewState state, const ViewFacts& facts, const Picked& picked);

// Whether a key of this name does something in the window.
[[nodiscard]] bool is_key(std::string_view key);

// The keys and what they do, for the help in the window; one line each.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> key_help();

}  // namespace hotblade::pipeline::preview
