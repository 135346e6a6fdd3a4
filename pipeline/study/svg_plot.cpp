#include "pipeline/study/svg_plot.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace hotblade::pipeline::study {

namespace {

// Room around the axes for ticks, labels and title, in pixels.
constexpr double kLeft = 72, kRight = 20, kTop = 40, kBottom = 56;
constexpr double kInnerWidth = SvgPlot::kPanelWidth - kLeft - kRight,
                 kInnerHeight = SvgPlot::kPanelHeight - kTop - kBottom;

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&') {
      out += "&amp;";
    } else if (c == '<') {
      out += "&lt;";
    } else if (c == '>') {
      out += "&gt;";
    } else {
      out += c;
    }
  }
  return out;
}

std::string label(double x, double y, const char* anchor, double size, const std::string& words) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\" font-size=\"{:g}\">{}</text>\n", x,
                     y, anchor, size, escaped(words));
}

// The round step (1, 2 or 5 times a power of ten) that gives at most about six intervals.
double tick_step(double span) {
  const double raw = span / 6, power = std::pow(10, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= raw) return factor * power;
  }
  return 10 * power;
}

struct Ticks {
  double step, first;
  int count;
};

Ticks tick_row(double low, double high) {
  const double step = tick_step(high - low);
  // A tick that rounding puts a hair outside still counts.
  const double slack = 1e-9;
  const double first = std::ceil(low / step - slack), last = std::floor(high / step + slack);
  return {step, first, static_cast<int>(last - first) + 1};
}

std::string tick_text(double value, double step) {
  const int decimals = std::max(0, static_cast<int>(-std::floor(std::log10(step) + 1e-9)));
  return fmt::format("{:.{}f}", value == 0 ? 0.0 : value, decimals);
}

}  // namespace

SvgPlot::SvgPlot(Axes axes) : axes_(std::move(axes)) {
  if (!(axes_.x_min < axes_.x_max) || !(axes_.y_min < axes_.y_max)) {
    throw std::logic_error("SvgPlot: an axis without length");
  }
}

Eigen::Vector2d SvgPlot::pixel(const Eigen::Vector2d& p) const {
  return {kLeft + kInnerWidth * (p.x() - axes_.x_min) / (axes_.x_max - axes_.x_min),
          kTop + kInnerHeight * (axes_.y_max - p.y()) / (axes_.y_max - axes_.y_min)};
}

void SvgPlot::points(std::span<const Eigen::Vector2d> points, const std::string& colour, double size,
                     const std::string& name) {
  // One path of short round-capped strokes: a tenth of the size of one circle each.
  std::string path;
  for (const Eigen::Vector2d& p : points) {
    const bool inside =
        p.x() >= axes_.x_min && p.x() <= axes_.x_max && p.y() >= axes_.y_min && p.y() <= axes_.y_max;
    if (!inside) continue;
    const Eigen::Vector2d at = pixel(p);
    path += fmt::format("M{:.1f} {:.1f}h.1", at.x(), at.y());
  }
  body_ += fmt::format(
      "<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{:g}\" stroke-linecap=\"round\"/>\n", path,
      colour, size);
  if (!name.empty()) entries_.push_back({name, colour});
}

void SvgPlot::line(std::span<const Eigen::Vector2d> points, const std::string& colour, double width,
                   const std::string& name) {
  std::string list;
  for (const Eigen::Vector2d& p : points) {
    const Eigen::Vector2d at = pixel(p);
    list += fmt::format("{:.1f},{:.1f} ", at.x(), at.y());
  }
  body_ += fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{:g}\"/>\n", list,
                       colour, width);
  if (!name.empty()) entries_.push_back({name, colour});
}

void SvgPlot::text(const Eigen::Vector2d& at, const std::string& words) {
  const Eigen::Vector2d p = pixel(at);
  words_ += label(p.x(), p.y(), "middle", 13, words);
}

std::string SvgPlot::ticks() const {
  std::string out;
  const Ticks across = tick_row(axes_.x_min, axes_.x_max), up = tick_row(axes_.y_min, axes_.y_max);
  const char* grid = "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"#e4e4e4\"/>\n";
  for (int i = 0; i < across.count; ++i) {
    const double value = (across.first + i) * across.step, x = pixel({value, 0}).x();
    out += fmt::format(fmt::runtime(grid), x, kTop, x, kTop + kInnerHeight);
    out += label(x, kTop + kInnerHeight + 18, "middle", 12, tick_text(value, across.step));
  }
  for (int i = 0; i < up.count; ++i) {
    const double value = (up.first + i) * up.step, y = pixel({0, value}).y();
    out += fmt::format(fmt::runtime(grid), kLeft, y, kLeft + kInnerWidth, y);
    out += label(kLeft - 8, y + 4, "end", 12, tick_text(value, up.step));
  }
  return out;
}

std::string SvgPlot::legend() const {
  if (entries_.empty()) return "";
  constexpr double kRow = 18, kWidthPerLetter = 6.6;
  std::size_t longest = 0;
  for (const Entry& e : entries_) longest = std::max(longest, e.name.size());
  const double width = 30 + kWidthPerLetter * static_cast<double>(longest),
               height = 8 + kRow * static_cast<double>(entries_.size());
  const double x = kLeft + kInnerWidth + 12, y = kTop;
  std::string out = fmt::format(
      "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"white\" "
      "fill-opacity=\"0.85\" "
      "stroke=\"#bbbbbb\"/>\n",
      x, y, width, height);
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const double row = y + 4 + kRow * (static_cast<double>(i) + 0.5);
    out += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\" fill=\"{}\"/>\n", x + 12, row,
                       entries_[i].colour);
    out += label(x + 24, row + 4, "start", 12, entries_[i].name);
  }
  return out;
}

std::string SvgPlot::panel(int id) const {
  std::string out = label(kPanelWidth / 2, 24, "middle", 15, axes_.title);
  out += ticks();
  out += fmt::format(
      "<clipPath id=\"axes{}\"><rect x=\"{:g}\" y=\"{:g}\" width=\"{:g}\" height=\"{:g}\"/></clipPath>\n", id,
      kLeft, kTop, kInnerWidth, kInnerHeight);
  out += fmt::format("<g clip-path=\"url(#axes{})\">\n{}</g>\n", id, body_);
  out += fmt::format(
      "<rect x=\"{:g}\" y=\"{:g}\" width=\"{:g}\" height=\"{:g}\" fill=\"none\" stroke=\"#333333\"/>\n",
      kLeft, kTop, kInnerWidth, kInnerHeight);
  out += words_ + legend();
  out += label(kLeft + kInnerWidth / 2, kPanelHeight - 14, "middle", 14, axes_.x_label);
  const double middle = kTop + kInnerHeight / 2;
  out += fmt::format("<g transform=\"rotate(-90 18 {:g})\">\n{}</g>\n", middle,
                     label(18, middle, "middle", 14, axes_.y_label));
  return out;
}

std::string svg_page(std::span<const SvgPlot> plots) {
  double width = 0;
  for (const SvgPlot& plot : plots) width += plot.width();
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:g}\" height=\"{1:g}\" viewBox=\"0 0 {0:g} "
      "{1:g}\" "
      "font-family=\"sans-serif\">\n<rect width=\"{0:g}\" height=\"{1:g}\" fill=\"white\"/>\n",
      width, SvgPlot::kPanelHeight);
  double x = 0;
  for (std::size_t i = 0; i < plots.size(); ++i) {
    out +=
        fmt::format("<g transform=\"translate({:g} 0)\">\n{}</g>\n", x, plots[i].panel(static_cast<int>(i)));
    x += plots[i].width();
  }
  return out + "</svg>\n";
}

}  // namespace hotblade::pipeline::study
