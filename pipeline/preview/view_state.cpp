#include "pipeline/preview/view_state.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace hotblade::pipeline::preview {
namespace {

constexpr std::array<std::pair<const char*, Layer>, kLayers> kLayerKeys{{{"d", Layer::kDesign},
                                                                         {"c", Layer::kCut},
                                                                         {"r", Layer::kRibs},
                                                                         {"b", Layer::kBlocks},
                                                                         {"k", Layer::kBlade},
                                                                         {"g", Layer::kGhosts},
                                                                         {"p", Layer::kPaths},
                                                                         {"l", Layer::kLegend},
                                                                         {"m", Layer::kArms}}};
constexpr std::array<std::pair<const char*, Color>, 5> kColorKeys{{{"1", Color::kDeviation},
                                                                   {"2", Color::kStrip},
                                                                   {"3", Color::kCurvature},
                                                                   {"4", Color::kMargin},
                                                                   {"5", Color::kFeed}}};
constexpr std::array<std::pair<const char*, View>, 4> kViewKeys{
    {{"t", View::kTop}, {"f", View::kFront}, {"s", View::kRight}, {"i", View::kBest}}};
// From rapid steps of a form to the slowest that still moves.
constexpr double kSlowest = 1.0 / 8, kFastest = 512;
constexpr std::array<double, 6> kGhostSteps{10, 20, 50, 100, 200, 500};
constexpr double kClipStep = 0.02;

template <class Table>
auto found(const Table& table, std::string_view key) {
  return std::find_if(table.begin(), table.end(), [&](const auto& entry) { return entry.first == key; });
}

void step_pose(ViewState& state, const ViewFacts& facts, bool forward) {
  if (facts.pose_s.empty()) return;
  state.playing = false;
  const auto& times = facts.pose_s;
  if (forward) {
    const auto next = std::upper_bound(times.begin(), times.end(), state.time_s);
    state.time_s = next == times.end() ? times.back() : *next;
  } else {
    const auto here = std::lower_bound(times.begin(), times.end(), state.time_s);
    state.time_s = here == times.begin() ? times.front() : *(here - 1);
  }
}

// To the start of the strip, or of the one before when it is there already.
void step_strip(ViewState& state, const ViewFacts& facts, bool forward) {
  if (facts.strips() == 0) return;
  const int here = facts.strip_at(state.time_s);
  const double start = facts.strip_start_s[static_cast<std::size_t>(here)];
  const int to = forward ? here + 1 : state.time_s > start ? here : here - 1;
  const auto index = static_cast<std::size_t>(std::clamp(to, 0, facts.strips()));
  state.time_s = facts.strip_start_s[index];
}

void step_ghosts(ViewState& state, bool wider) {
  const double now = state.ghost_step_mm.value_or(wider ? 20 : 100);
  if (wider) {
    const auto next = std::upper_bound(kGhostSteps.begin(), kGhostSteps.end(), now);
    if (next != kGhostSteps.end()) state.ghost_step_mm = *next;
  } else {
    const auto here = std::lower_bound(kGhostSteps.begin(), kGhostSteps.end(), now);
    if (here != kGhostSteps.begin()) state.ghost_step_mm = *(here - 1);
  }
  state.hidden.reset(static_cast<std::size_t>(Layer::kGhosts));
}

void select_strip(ViewState& state, const ViewFacts& facts, int by) {
  const int count = facts.strips();
  if (count == 0) return;
  const bool none = state.selection.part == Part::kNone;
  const int strip = none ? (by > 0 ? 0 : count - 1) : (state.selection.strip + by + count) % count;
  state.selection = {Part::kStrip, strip, -1};
}

bool time_key(ViewState& state, const ViewFacts& facts, std::string_view key) {
  if (key == "space") {
    if (facts.end_s() > 0 && !state.playing && state.time_s >= facts.end_s()) state.time_s = 0;
    state.playing = !state.playing && facts.end_s() > 0;
  } else if (key == "Left" || key == "Right") {
    step_pose(state, facts, key == "Right");
  } else if (key == "Prior" || key == "Next") {
    step_strip(state, facts, key == "Next");
  } else if (key == "Home" || key == "End") {
    state.time_s = key == "Home" ? 0 : facts.end_s();
  } else if (key == "plus" || key == "equal" || key == "KP_Add") {
    state.speed = std::min(2 * state.speed, kFastest);
  } else if (key == "minus" || key == "KP_Subtract") {
    state.speed = std::max(state.speed / 2, kSlowest);
  } else if (key == "u") {
    state.cut_so_far = !state.cut_so_far;
  } else {
    return false;
  }
  return true;
}

bool clip_key(ViewState& state, std::string_view key) {
  ClipPlane& clip = state.clip;
  if (key == "x") {
    clip.axis = clip.axis == 2 ? -1 : clip.axis + 1;
  } else if (key == "X") {
    clip.keeps_low = !clip.keeps_low;
  } else if (key == "Up" || key == "Down") {
    clip.share = std::clamp(clip.share + (key == "Up" ? kClipStep : -kClipStep), 0.0, 1.0);
  } else {
    return false;
  }
  return true;
}

bool view_key(ViewState& state, std::string_view key) {
  if (key == "0") {
    state.view = View::kBest;
    state.clip = {};
  } else if (const auto view = found(kViewKeys, key); view != kViewKeys.end()) {
    state.view = view->second;
  } else {
    return false;
  }
  ++state.aims;
  return true;
}

constexpr std::array kOtherKeys{"h",   "question",     "F1",    "q", "bracketleft", "bracketright",
                                "Tab", "ISO_Left_Tab", "Escape"};

void other_key(ViewState& state, const ViewFacts& facts, std::string_view key) {
  if (key == "h" || key == "question" || key == "F1") state.help = !state.help;
  if (key == "q") state.closed = true;
  if (key == "bracketleft" || key == "bracketright") step_ghosts(state, key == "bracketright");
  if (key == "Tab" || key == "ISO_Left_Tab") select_strip(state, facts, key == "Tab" ? 1 : -1);
  if (key == "Escape") {
    if (state.help) {
      state.help = false;
    } else {
      state.selection = {};
    }
  }
}

}  // namespace

int ViewFacts::strip_at(double time_s) const {
  const auto after = std::upper_bound(strip_start_s.begin(), strip_start_s.end(), time_s);
  return std::clamp(static_cast<int>(after - strip_start_s.begin()) - 1, 0, std::max(0, strips() - 1));
}

bool is_key(std::string_view key) {
  ViewState state;
  return found(kLayerKeys, key) != kLayerKeys.end() || found(kColorKeys, key) != kColorKeys.end() ||
         std::find(kOtherKeys.begin(), kOtherKeys.end(), key) != kOtherKeys.end() ||
         time_key(state, {}, key) || clip_key(state, key) || view_key(state, key);
}

ViewState after_key(ViewState state, const ViewFacts& facts, std::string_view key) {
  if (const auto layer = found(kLayerKeys, key); layer != kLayerKeys.end()) {
    state.hidden.flip(static_cast<std::size_t>(layer->second));
    return state;
  }
  if (const auto color = found(kColorKeys, key); color != kColorKeys.end()) {
    const bool at_hand = std::count(facts.colors.begin(), facts.colors.end(), color->second) > 0;
    if (at_hand) state.color = color->second;
    return state;
  }
  if (time_key(state, facts, key) || clip_key(state, key) || view_key(state, key)) return state;
  other_key(state, facts, key);
  return state;
}

ViewState after_clock(ViewState state, const ViewFacts& facts, double elapsed_s) {
  if (!state.playing) return state;
  state.time_s += state.speed * std::max(0.0, elapsed_s);
  if (state.time_s >= facts.end_s()) {
    state.time_s = facts.end_s();
    state.playing = false;
  }
  return state;
}

ViewState after_seek(ViewState state, const ViewFacts& facts, double share) {
  state.time_s = std::clamp(share, 0.0, 1.0) * facts.end_s();
  return state;
}

ViewState after_pick(ViewState state, const ViewFacts& facts, const Picked& picked) {
  const bool again = picked.selection.part == Part::kStrip && picked.selection == state.selection;
  state.selection = picked.selection;
  if (!again || picked.pose < 0) return state;
  state.selection = {Part::kPose, picked.selection.strip, picked.pose};
  const int first = facts.first_pose[static_cast<std::size_t>(picked.selection.strip)];
  state.time_s = facts.pose_s[static_cast<std::size_t>(first + picked.pose)];
  state.playing = false;
  return state;
}

std::vector<std::pair<std::string, std::string>> key_help() {
  return {{"space", "play, pause"},
          {"left right", "one pose back, forward"},
          {"page up down", "one strip back, forward"},
          {"home end", "to the start, the end"},
          {"+ -", "faster, slower"},
          {"u", "all of the cut, or up to now"},
          {"1 2 3 4 5", "deviation, strip, curvature, margin, feed"},
          {"d c r b", "design, cut, ribs, foam blocks"},
          {"k g p l", "blade, ghosts, paths in air, legend"},
          {"m", "arms and what stands around them"},
          {"[ ]", "ghosts nearer, farther apart"},
          {"t f s i", "top, front, side, oblique view"},
          {"0", "reset view and clip plane"},
          {"x X", "clip plane across x, y, z, off; other side"},
          {"up down", "move the clip plane"},
          {"click", "strip, rib or pose; again: the pose there"},
          {"tab esc", "next strip, nothing selected"},
          {"drag, wheel", "turn, zoom; middle button moves"},
          {"h ? q", "this help, quit"}};
}

}  // namespace hotblade::pipeline::preview
