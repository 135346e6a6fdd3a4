#include "pipeline/report/sheet_drawings.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <utility>
#include <vector>

#include "pipeline/preview/ghosts.hpp"
#include "pipeline/report/report_plots.hpp"

namespace hotblade::pipeline {

namespace {

using Point = Eigen::Vector2d;

// A drawing in the making: y down, as SVG has it.
class Drawing {
 public:
  Drawing(double width, double height) : width_(width), height_(height) {}

  void line(const std::vector<Point>& points, const std::string& style) {
    if (points.size() < 2) return;
    std::string text;
    for (const Point& p : points) text += fmt::format("{:.1f},{:.1f} ", p.x(), p.y());
    body_ += fmt::format("<polyline points=\"{}\" style=\"fill:none;{}\"/>", text, style);
  }
  void face(const std::vector<Point>& points, const std::string& style) {
    std::string text;
    for (const Point& p : points) text += fmt::format("{:.1f},{:.1f} ", p.x(), p.y());
    body_ += fmt::format("<polygon points=\"{}\" style=\"{}\"/>", text, style);
  }
  void words(const Point& at, const std::string& text, double size, const std::string& anchor,
             const std::string& style = "") {
    body_ += fmt::format(
        "<text x=\"{:.1f}\" y=\"{:.1f}\" font-size=\"{:g}\" text-anchor=\"{}\" style=\"{}\">{}</text>",
        at.x(), at.y(), size, anchor, style, escaped(text));
  }
  // `head`: the length of its point.
  void arrow(const Point& from, const Point& to, const std::string& color, double head = 9) {
    const Point d = (to - from).normalized(), n(-d.y(), d.x());
    line({from, to - 0.5 * head * d}, fmt::format("stroke:{};stroke-width:{:.1f}", color, 0.18 * head));
    face({to, to - head * d + 0.45 * head * n, to - head * d - 0.45 * head * n}, "fill:" + color);
  }
  [[nodiscard]] const std::string& body() const { return body_; }
  [[nodiscard]] std::string svg(const std::string& label) const {
    return fmt::format(
        "<svg viewBox=\"0 0 {0:g} {1:g}\" width=\"{0:g}\" height=\"{1:g}\" role=\"img\" aria-label=\"{2}\" "
        "font-family=\"Arial,sans-serif\">{3}</svg>\n",
        width_, height_, escaped(label), body_);
  }

 private:
  double width_, height_;
  std::string body_;
};

// Obliquely from the front, above and the right: widths and heights as they are, depths shortened.
class Oblique {
 public:
  Oblique(const Eigen::AlignedBox3d& box, const Point& size, const Point& margin) : low_(box.min()) {
    const Eigen::Vector3d s = box.sizes();
    const double wide = s.x() + kAcross * s.y(), high = s.z() + kUp * s.y();
    scale_ = std::min((size.x() - 2 * margin.x()) / wide, (size.y() - 2 * margin.y()) / high);
    corner_ = {0.5 * (size.x() - scale_ * wide), 0.5 * (size.y() + scale_ * high)};
  }
  [[nodiscard]] Point at(const Eigen::Vector3d& p) const {
    const Eigen::Vector3d d = scale_ * (p - low_);
    return {corner_.x() + d.x() + kAcross * d.y(), corner_.y() - d.z() - kUp * d.y()};
  }
  [[nodiscard]] std::vector<Point> all(const std::vector<Eigen::Vector3d>& points) const {
    std::vector<Point> out;
    for (const Eigen::Vector3d& p : points) out.push_back(at(p));
    return out;
  }

 private:
  static constexpr double kAcross = 0.55, kUp = 0.38;
  Eigen::Vector3d low_;
  Point corner_{0, 0};
  double scale_ = 1;
};

constexpr const char* kEdgeStroke = "stroke:#22262b;stroke-width:1.2";
constexpr const char* kHiddenStroke = "stroke:#8b949c;stroke-width:0.9;stroke-dasharray:4 3";
constexpr const char* kDatumStroke = "stroke:#1d4f9e;stroke-width:4;stroke-linecap:round";
constexpr const char* kCutStroke = "stroke:#b3261e;stroke-width:2";
constexpr const char* kHiddenCutStroke = "stroke:#b3261e;stroke-width:1.2;stroke-dasharray:5 3";

void add_sizes(Drawing& drawing, const Oblique& oblique, const Eigen::AlignedBox3d& box) {
  using Corner = Eigen::AlignedBox3d;
  const Eigen::Vector3d size = box.sizes();
  const auto corner = [&](Corner::CornerType type) { return oblique.at(box.corner(type)); };
  const Point front_left = corner(Corner::BottomLeftFloor), front_right = corner(Corner::BottomRightFloor);
  const Point back_right = corner(Corner::TopRightFloor), front_top = corner(Corner::BottomLeftCeil);
  drawing.words(0.5 * (front_left + front_right) + Point(0, 22), fmt::format("x {:.0f}", size.x()), 15,
                "middle", "font-weight:600");
  drawing.words(0.5 * (front_right + back_right) + Point(10, 16), fmt::format("y {:.0f}", size.y()), 15,
                "start", "font-weight:600");
  drawing.words(0.5 * (front_left + front_top) + Point(-10, 0), fmt::format("z {:.0f}", size.z()), 15, "end",
                "font-weight:600");
}

// The outline of a strip's cut: its first and last blade in the foam, and their ends between.
std::vector<Eigen::Vector3d> outline(const Strip& strip) {
  std::vector<const BladePose*> cut;
  for (const BladePose& pose : strip.poses) {
    if (pose.foam) cut.push_back(&pose);
  }
  std::vector<Eigen::Vector3d> points;
  if (cut.empty()) return points;
  constexpr int kAlong = 12;
  constexpr std::size_t kEnds = 10;
  const auto blade = [](const BladePose& pose, double share) {
    const auto& [first, last] = *pose.foam;
    const std::vector<Eigen::Vector3d> line = preview::line_of(pose.frame, pose.blade).points;
    const double place = (first + share * (last - first)) / pose.blade.length;
    const double last_point = static_cast<double>(line.size() - 1);
    return line[static_cast<std::size_t>(std::lround(std::clamp(place, 0.0, 1.0) * last_point))];
  };
  const auto pose_at = [&](std::size_t i) -> const BladePose& { return *cut[i * (cut.size() - 1) / kEnds]; };
  for (int i = 0; i <= kAlong; ++i) points.push_back(blade(*cut.front(), static_cast<double>(i) / kAlong));
  for (std::size_t i = 1; i < kEnds; ++i) points.push_back(blade(pose_at(i), 1));
  for (int i = kAlong; i >= 0; --i) points.push_back(blade(*cut.back(), static_cast<double>(i) / kAlong));
  for (std::size_t i = kEnds - 1; i > 0; --i) points.push_back(blade(pose_at(i), 0));
  return points;
}

// The axes of the design that a picture may be looked at from.
std::array<Eigen::Vector3d, 6> eyes() {
  std::array<Eigen::Vector3d, 6> all;
  for (int axis = 0; axis < 3; ++axis) {
    all[2 * axis] = Eigen::Vector3d::Unit(axis);
    all[2 * axis + 1] = -Eigen::Vector3d::Unit(axis);
  }
  return all;
}

// Where the waste of a strip lies, away from the base that foam was added at.
const Eigen::Vector3d& waste(const Strip& strip) {
  return strip.block.frame.y;
}

// A cut that is seen more askew than this is shown from another side: at 60 degrees half of it is left.
constexpr double kAskew = 0.5;

// Returns the eye that sees most of these strips' cuts.
Eigen::Vector3d best_eye(const Program& program, const std::vector<std::size_t>& strips) {
  std::array<double, 6> seen{};
  const auto all = eyes();
  for (const std::size_t k : strips) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      const double facing = waste(program.strips[k]).dot(all[i]);
      if (facing > kAskew) seen[i] += facing;
    }
  }
  // From above where it is as good: 1e-9 is rounding.
  std::size_t best = 4;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (seen[i] > seen[best] + 1e-9) best = i;
  }
  return all[best];
}

// Returns the axis of the design, with its sign, that this direction is, as +x.
std::string axis_name(const Eigen::Vector3d& direction) {
  Eigen::Index axis = 0;
  direction.cwiseAbs().maxCoeff(&axis);
  return fmt::format("{}{}", direction[axis] > 0 ? "+" : "-", "xyz"[axis]);
}

}  // namespace

std::string stand_svg(const BlockStand& stand, const std::string& block, const Words& words) {
  const Point size(520, 430);
  Drawing drawing(size.x(), size.y());
  const Oblique oblique(stand.box, size, {120, 46});
  using Corner = Eigen::AlignedBox3d;
  const auto c = [&](Corner::CornerType type) { return oblique.at(stand.box.corner(type)); };
  const Point a = c(Corner::BottomLeftFloor), b = c(Corner::BottomRightFloor), d = c(Corner::TopLeftFloor),
              e = c(Corner::TopRightFloor), f = c(Corner::BottomLeftCeil), g = c(Corner::BottomRightCeil),
              h = c(Corner::TopLeftCeil), i = c(Corner::TopRightCeil);
  drawing.face({a, b, g, f}, "fill:#f4f0e4");
  drawing.face({b, e, i, g}, "fill:#e6e0cf");
  drawing.face({f, g, i, h}, "fill:#fbf9f2");
  drawing.line({a, d, e}, kHiddenStroke);
  drawing.line({d, h}, kHiddenStroke);
  drawing.line({a, b, g, f, a}, kEdgeStroke);
  drawing.line({b, e, i, g}, kEdgeStroke);
  drawing.line({i, h, f}, kEdgeStroke);
  // The base face's bottom edge, and the left face's.
  drawing.line(stand.base_at_back ? std::vector{d, e} : std::vector{a, b}, kDatumStroke);
  drawing.line({a, d}, kDatumStroke);
  drawing.line(oblique.all(stand.leaves), kHiddenCutStroke);
  for (const std::size_t side : {0u, 1u}) {
    const auto& place = stand.enters_at[side] ? stand.enters_at[side] : stand.leaves_at[side];
    const bool seen = place && (place->face == Face::kRight || place->face == Face::kFront);
    drawing.line(oblique.all(stand.sides[side]), seen ? kCutStroke : kHiddenCutStroke);
  }
  drawing.line(oblique.all(stand.enters), "stroke:#b3261e;stroke-width:3");
  if (stand.enters.size() > 1) {
    const Point left = oblique.at(stand.enters.front()), right = oblique.at(stand.enters.back());
    const char* names[2] = {stand.clamp_a_left ? "A" : "B", stand.clamp_a_left ? "B" : "A"};
    drawing.line({left, left - Point(46, 0)}, kCutStroke);
    drawing.line({right, right + Point(46, 0)}, kCutStroke);
    drawing.words(left - Point(52, -6), names[0], 20, "end", "font-weight:700;fill:#b3261e");
    drawing.words(right + Point(52, 6), names[1], 20, "start", "font-weight:700;fill:#b3261e");
    const Point middle = oblique.at(stand.enters[stand.enters.size() / 2]);
    drawing.arrow(middle - Point(0, 42), middle - Point(0, 6), "#b3261e");
  }
  if (!stand.base_at_back) {
    const Point face = 0.25 * (a + b + f + g);
    drawing.words(face + Point(0, 4), block, 22, "middle", "font-weight:700");
    drawing.arrow(face - Point(0, 22), face - Point(0, 50), "#22262b");
  } else {
    drawing.words(0.25 * (a + b + f + g) + Point(0, 4), words("name on the back"), 12, "middle",
                  "fill:#5c6670");
  }
  add_sizes(drawing, oblique, stand.box);
  drawing.words({size.x() / 2, size.y() - 4},
                words("seen from the front of the table, from above and the right"), 11, "middle",
                "fill:#5c6670");
  return drawing.svg(block);
}

AssemblyPicture::AssemblyPicture(const Program& program, std::size_t view, const Eigen::Vector3d& eye,
                                 std::vector<std::size_t> strips, double width, double most_height)
    : id_(fmt::format("assembly{}", view + 1)),
      width_(width),
      height_(most_height),
      view_(axis_name(-eye)),
      strips_(std::move(strips)) {
  // To the right and up, as one looks at it.
  const Eigen::Vector3d up = eye.z() != 0 ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d right = up.cross(eye);
  axes_ = {axis_name(right), axis_name(up)};
  Eigen::AlignedBox2d box;
  for (const std::size_t k : strips_) {
    const Strip& strip = program.strips[k];
    ids_.push_back(strip.id);
    std::vector<Point>& points = outlines_.emplace_back();
    for (const Eigen::Vector3d& p : outline(strip)) box.extend(points.emplace_back(p.dot(right), p.dot(up)));
    // Up on the table, in the picture.
    const Eigen::Vector3d table_up =
        strip.design_to_cell.q.toRotationMatrix().transpose() * Eigen::Vector3d::UnitZ();
    ups_.emplace_back(table_up.dot(right), -table_up.dot(up));
  }
  if (box.isEmpty()) return;
  constexpr double kMargin = 14, kAxes = 56;
  const Point size = box.sizes().cwiseMax(1e-3);
  const double scale =
      std::min((width - 2 * kMargin) / size.x(), (most_height - kAxes - 2 * kMargin) / size.y());
  height_ = scale * size.y() + 2 * kMargin + kAxes;
  for (std::vector<Point>& points : outlines_) {
    for (Point& p : points) {
      const Point d = scale * (p - box.center());
      p = {width / 2 + d.x(), (height_ - kAxes) / 2 - d.y()};
    }
  }
}

std::vector<AssemblyPicture> AssemblyPicture::all_of(const Program& program, double width,
                                                     double most_height) {
  std::vector<AssemblyPicture> pictures;
  std::vector<std::size_t> left(program.strips.size());
  std::iota(left.begin(), left.end(), std::size_t{0});
  while (!left.empty()) {
    const Eigen::Vector3d eye = best_eye(program, left);
    // Some axis faces every direction by 1/sqrt(3) at least, so each picture takes a strip.
    const auto other = std::stable_partition(
        left.begin(), left.end(), [&](std::size_t k) { return waste(program.strips[k]).dot(eye) > kAskew; });
    if (other == left.begin()) throw std::logic_error("a strip whose waste lies nowhere");
    pictures.push_back({program, pictures.size(), eye, {left.begin(), other}, width, most_height});
    left.erase(left.begin(), other);
  }
  return pictures;
}

bool AssemblyPicture::shows(std::size_t strip) const {
  return std::find(strips_.begin(), strips_.end(), strip) != strips_.end();
}

std::string AssemblyPicture::name(std::size_t i) const {
  if (outlines_[i].empty()) return "";
  Eigen::AlignedBox2d own;
  for (const Point& p : outlines_[i]) own.extend(p);
  const Point room = own.sizes(), at = own.center();
  const double letters = static_cast<double>(ids_[i].size());
  // Letters are 0.62 of their size wide. Along the longer side of a narrow one.
  const bool turned = room.x() < room.y() && room.x() < 0.62 * 14 * letters;
  const double along = turned ? room.y() : room.x(), across = turned ? room.x() : room.y();
  const double size = std::clamp(std::min(0.8 * along / (0.62 * letters), 0.6 * across), 2.0, 34.0);
  Drawing drawing(0, 0);
  drawing.words(at + Point(turned ? 0.35 * size : 0, turned ? 0 : 0.35 * size), ids_[i], size, "middle",
                turned ? fmt::format("transform:rotate(-90deg);transform-origin:{:.1f}px {:.1f}px",
                                     at.x() + 0.35 * size, at.y())
                       : std::string());
  // Beside the name, where there is room for it and it lies in the picture.
  const Point up = ups_[i];
  const bool sideways = std::abs(up.x()) > std::abs(up.y());
  const double beside = sideways != turned ? 0.5 * letters * 0.62 * size : 0.5 * size;
  const double arrow_room = sideways ? room.x() : room.y();
  if (up.norm() > kAskew && arrow_room > 2 * beside + 2.6 * size)
    drawing.arrow(at + (beside + 0.3 * size) * up.normalized(), at + (beside + 1.2 * size) * up.normalized(),
                  "#22262b", 0.4 * size);
  return drawing.body();
}

std::string AssemblyPicture::definition() const {
  Drawing drawing(width_, height_);
  for (const std::vector<Point>& points : outlines_) {
    if (points.size() > 2) drawing.face(points, "fill:#f4f0e4;stroke:#22262b;stroke-width:0.8");
  }
  const Point corner(20, height_ - 10);
  drawing.arrow(corner, corner + Point(40, 0), "#5c6670", 9);
  drawing.arrow(corner, corner - Point(0, 40), "#5c6670", 9);
  drawing.words(corner + Point(48, 5), axes_[0], 18, "start", "fill:#5c6670");
  drawing.words(corner + Point(10, -32), axes_[1], 18, "start", "fill:#5c6670");
  std::string names;
  for (std::size_t i = 0; i < ids_.size(); ++i) names += name(i);
  return fmt::format(
      "<svg class=\"defs\" width=\"0\" height=\"0\" aria-hidden=\"true\"><defs><g id=\"{}\" "
      "font-family=\"Arial,sans-serif\">{}</g></defs></svg>\n",
      id_, drawing.body() + names);
}

std::string AssemblyPicture::svg(std::optional<std::size_t> filled, const std::string& label) const {
  std::string body = "<use href=\"#" + id_ + "\"/>";
  if (filled) {
    const auto i =
        static_cast<std::size_t>(std::find(strips_.begin(), strips_.end(), *filled) - strips_.begin());
    if (outlines_.at(i).size() > 2) {
      Drawing drawing(width_, height_);
      drawing.face(outlines_[i], "fill:#f3b7b3;stroke:#b3261e;stroke-width:3");
      body += drawing.body() + name(i);
    }
  }
  return fmt::format(
      "<svg viewBox=\"0 0 {0:g} {1:g}\" role=\"img\" aria-label=\"{2}\" "
      "font-family=\"Arial,sans-serif\">{3}</svg>\n",
      width_, height_, escaped(label), body);
}

}  // namespace hotblade::pipeline
