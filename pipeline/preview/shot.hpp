// What is asked for of a picture or a film.
#pragma once

#include <functional>
#include <optional>
#include <string>

namespace hotblade::pipeline::preview {

struct PictureSize {
  int width = 1280, height = 720;
};

// The side that a picture is taken from: obliquely on the cut side, or along an axis of the design frame.
enum class View { kBest, kTop, kFront, kRight };

// The view of a name on the command line (best, top, front, right); absent for an unknown name.
[[nodiscard]] std::optional<View> view_named(const std::string& name);

// A picture of several; the caption's lines can be left out to leave their room to the geometry.
struct Shot {
  View view = View::kBest;
  bool caption = true;
  bool by_strip = false;  // the cut coloured by strip, whatever the scene's scale
};

// Says English words in another language.
using Speak = std::function<std::string(const std::string&)>;

struct MovieOptions {
  PictureSize size;
  int frames = 60;
  int frames_per_s = 12;
};

}  // namespace hotblade::pipeline::preview
