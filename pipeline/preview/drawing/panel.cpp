// What the window has beyond a picture: card, time bar, help.
#include <algorithm>

#include "pipeline/preview/drawing/overlay.hpp"

namespace hotblade::pipeline::preview {
namespace {

constexpr Rgb kPaper{1, 1, 1};
constexpr Rgb kTrackColor{0.80, 0.82, 0.84};
constexpr Rgb kCutTimeColor{0.55, 0.62, 0.70};

// The track of the time bar, in pixels of a picture of 1280 x 720.
struct Track {
  double x, width;
  static constexpr double kMiddle = 24, kHeight = 10, kReach = 12;
};

Track track_of(PictureSize size) {
  const double left = 300, right = size.width / overlay_scale(size) - 28;
  return {left, right - left};
}

double raw_share(PictureSize size, double x) {
  const Track track = track_of(size);
  return (x / overlay_scale(size) - track.x) / track.width;
}

// Where the blade is in the foam: darker.
void draw_cut_times(Canvas& canvas, const ViewModel& model, const Track& track) {
  const double end = std::max(model.facts.end_s(), 1e-9);  // a program of one pose has no duration
  const auto draw = [&](double from, double to) {
    canvas.rectangle(track.x + track.width * from / end, Track::kMiddle - Track::kHeight / 2,
                     track.width * (to - from) / end, Track::kHeight, kCutTimeColor);
  };
  for (int s = 0; s < model.facts.strips(); ++s) {
    const auto& poses = model.program.strips[static_cast<std::size_t>(s)].poses;
    const auto in_foam = [](const BladePose& pose) { return pose.foam.has_value(); };
    const auto first = std::find_if(poses.begin(), poses.end(), in_foam);
    const auto last = std::find_if(poses.rbegin(), poses.rend(), in_foam);
    if (first == poses.end()) continue;
    draw(time_of(model, {s, static_cast<int>(first - poses.begin())}),
         time_of(model, {s, static_cast<int>(poses.rend() - last) - 1}));
  }
}

}  // namespace

void draw_card(Canvas& canvas, const Card& card, double top) {
  if (card.title.empty()) return;
  constexpr double kLine = 20, kWidth = 262, kIndent = 12;
  constexpr std::size_t kLetters = 36;
  std::vector<std::string> lines;
  for (const std::string& line : card.lines) {
    for (const std::string& part : wrapped(line, kLetters)) lines.push_back(part);
  }
  const double height = 40 + kLine * static_cast<double>(lines.size()), bottom = top - height;
  canvas.rectangle(16, bottom, kWidth, height, kPaper, 0.92);
  canvas.rectangle(16, bottom, 3, height, kSelectedColor);
  double y = top - 20;
  canvas.text(16 + kIndent, y, card.title, 16, true);
  for (const std::string& line : lines) {
    y -= kLine;
    canvas.text(16 + kIndent, y - 2, line, 14);
  }
}

void draw_time_bar(Canvas& canvas, const ViewModel& model, const ViewState& state, PictureSize size) {
  if (model.program.strips.empty()) return;
  const Track track = track_of(size);
  const double bottom = Track::kMiddle - Track::kHeight / 2, end = model.facts.end_s();
  canvas.rectangle(track.x, bottom, track.width, Track::kHeight, kTrackColor);
  draw_cut_times(canvas, model, track);
  for (int s = 1; s < model.facts.strips(); ++s) {
    const double share = model.facts.strip_start_s[static_cast<std::size_t>(s)] / end;
    canvas.rectangle(track.x + track.width * share - 0.75, bottom - 3, 1.5, Track::kHeight + 6, kInk);
  }
  const double now = track.x + track.width * (end > 0 ? state.time_s / end : 0);
  canvas.rectangle(now - 4, bottom - 6, 8, Track::kHeight + 12, kBladeNowColor);
  canvas.text(track.x, 52, time_text(model, state), 15);
  canvas.text(track.x + track.width, 52, state.playing ? "space: pause   h: help" : "space: play   h: help",
              14, false, Align::kRight);
}

std::optional<double> time_share_at(PictureSize size, double x, double y) {
  const double scale = overlay_scale(size), share = raw_share(size, x);
  const bool beside = share < -0.01 || share > 1.01;  // a little beyond its ends, to catch them
  if (beside || std::abs(y / scale - Track::kMiddle) > Track::kReach) return std::nullopt;
  return std::clamp(share, 0.0, 1.0);
}

double time_share_along(PictureSize size, double x) {
  return std::clamp(raw_share(size, x), 0.0, 1.0);
}

void draw_help(Canvas& canvas, PictureSize size) {
  const auto lines = key_help();
  constexpr double kLine = 26, kWidth = 560;
  const double scale = overlay_scale(size), height = kLine * static_cast<double>(lines.size()) + 74;
  const double x = (size.width / scale - kWidth) / 2;
  double y = (size.height / scale + height) / 2;
  canvas.rectangle(x, y - height, kWidth, height, kPaper, 0.96);
  canvas.rectangle(x, y - 3, kWidth, 3, kInk);
  y -= 32;
  canvas.text(x + 28, y, "Keys", 20, true);
  for (const auto& [key, words] : lines) {
    y -= kLine;
    canvas.text(x + 28, y, key, 15, true);
    canvas.text(x + 170, y, words, 15);
  }
}

}  // namespace hotblade::pipeline::preview
