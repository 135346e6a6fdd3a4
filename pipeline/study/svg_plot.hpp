// Plots as SVG files: axes with round ticks, points, lines and a legend, as the studies need them.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

namespace hotblade::pipeline::study {

// The axes in the data's numbers; each min must be below its max (std::logic_error).
struct Axes {
  std::string title, x_label, y_label;
  double x_min = 0, x_max = 1, y_min = 0, y_max = 1;
};

class SvgPlot {
 public:
  explicit SvgPlot(Axes axes);
  // Adds dots of `size` pixels; what lies outside the axes is left out. `name` goes to the legend unless
  // empty.
  void points(std::span<const Eigen::Vector2d> points, const std::string& colour, double size,
              const std::string& name);
  // Adds a polyline, cut off at the axes.
  void line(std::span<const Eigen::Vector2d> points, const std::string& colour, double width,
            const std::string& name);
  // Adds text centred at a point of the data.
  void text(const Eigen::Vector2d& at, const std::string& words);

  [[nodiscard]] const Axes& axes() const { return axes_; }
  // The elements of the plot inside a frame of kPanelWidth by kPanelHeight pixels. `id` is unique on a page.
  [[nodiscard]] std::string panel(int id) const;

  // The width with the legend, which stands right of the axes, pixels.
  [[nodiscard]] double width() const { return kPanelWidth + (entries_.empty() ? 0 : kLegendWidth); }

  static constexpr double kPanelWidth = 560, kPanelHeight = 460, kLegendWidth = 240;

 private:
  struct Entry {
    std::string name, colour;
  };
  [[nodiscard]] Eigen::Vector2d pixel(const Eigen::Vector2d& p) const;
  [[nodiscard]] std::string ticks() const;
  [[nodiscard]] std::string legend() const;
  Axes axes_;
  std::string body_, words_;
  std::vector<Entry> entries_;
};

// The text of one SVG file with the plots side by side.
[[nodiscard]] std::string svg_page(std::span<const SvgPlot> plots);

}  // namespace hotblade::pipeline::study
