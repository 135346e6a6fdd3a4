// Flat shapes and words over a picture.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/preview/drawing/draw_parts.hpp"

namespace hotblade::pipeline::preview {

enum class Align { kLeft, kCentre, kRight };

// The factor by which overlays grow with the picture: their sizes are pixels of one of 1280 x 720.
[[nodiscard]] double overlay_scale(PictureSize size);

// The parts of a line, broken between words so that no part has more letters than `longest`, where words
// allow.
[[nodiscard]] std::vector<std::string> wrapped(const std::string& line, std::size_t longest);

// Two layers over a renderer that is in a window already: shapes, and words over them.
class Sheets {
 public:
  explicit Sheets(vtkRenderer& below);
  ~Sheets();
  Sheets(const Sheets&) = delete;
  Sheets& operator=(const Sheets&) = delete;

 private:
  friend class Canvas;
  struct Layers;
  std::unique_ptr<Layers> layers_;
};

// Draws from the picture's lower left; `pixels` is how many are drawn for one. What is drawn appears with
// finish(), which takes the place of all that this canvas has drawn before.
class Canvas {
 public:
  Canvas(Sheets& sheets, double pixels);
  ~Canvas();
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  void rectangle(double x, double y, double width, double height, const Rgb& color, double opacity = 1);
  using Triangle = std::array<std::array<double, 2>, 3>;
  void triangle(const Triangle& corners, const Rgb& color);
  // `y` is the middle of the line.
  void text(double x, double y, const std::string& words, double height, bool bold = false,
            Align align = Align::kLeft, const Rgb& color = kInk);
  void finish();
  void set_pixels(double pixels) { pixels_ = pixels; }

  // The words of pictures in the language of who sees them: as they are, or as `speak` says them.
  void speak(Speak speak) { speak_ = std::move(speak); }
  [[nodiscard]] std::string said(const std::string& words) const { return speak_ ? speak_(words) : words; }

 private:
  Sheets& sheets_;
  double pixels_;
  Speak speak_;
  using Bytes = std::array<unsigned char, 4>;
  struct Box {
    double x0, y0, x1, y1;
    Bytes color;
  };
  static std::vector<Box> rest(const Box& under, const Box& over);
  static Bytes bytes_of(const Rgb& color, double opacity);
  void draw_shapes();

  // VTK draws flat shapes at one depth, and which of two stays on top is not told: these never overlap.
  std::vector<Box> boxes_;
  std::vector<std::pair<Triangle, Bytes>> triangles_;
  struct Actors;
  std::unique_ptr<Actors> actors_;
};

}  // namespace hotblade::pipeline::preview
