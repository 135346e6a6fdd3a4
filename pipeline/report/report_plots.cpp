#include "pipeline/report/report_plots.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "pipeline/settings/json_text.hpp"
#include "pipeline/verify/budget.hpp"

namespace hotblade::pipeline {

namespace {

constexpr const char* kGood = "#3b78a8";
constexpr const char* kBad = "#b3261e";
constexpr const char* kInk = "#22262b";
constexpr const char* kFaint = "#c9ced4";

std::string begin_svg(double width, double height, const std::string& title) {
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:g} {1:g}\" width=\"{0:g}\" "
      "height=\"{1:g}\" "
      "role=\"img\" font-family=\"sans-serif\" font-size=\"12\" fill=\"{2}\"><title>{3}</title>\n",
      width, height, kInk, escaped(title));
}

std::string rect(double x, double y, double width, double height, const char* color) {
  return fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"{}\"/>\n", x,
                     y, std::max(0.0, width), std::max(0.0, height), color);
}

std::string line(double x0, double y0, double x1, double y1, const char* style) {
  return fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" {}/>\n", x0, y0, x1, y1,
                     style);
}

std::string text(double x, double y, const char* anchor, const std::string& words) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", x, y, anchor,
                     escaped(words));
}

std::string tolerance_mark(double x, double top, double bottom, double tolerance_mm, const Words& w) {
  return line(x, top, x, bottom, "stroke=\"#b3261e\" stroke-width=\"1.5\" stroke-dasharray=\"5 3\"") +
         text(x, top - 4, "middle", w.format("tolerance {:g} mm", tolerance_mm));
}

}  // namespace

std::string escaped(const std::string& text) {
  std::string safe;
  safe.reserve(text.size());
  // Most texts are plain, and a page has thousands.
  const bool plain = std::all_of(text.begin(), text.end(), [](char c) { return c > 0; });
  for (const char c : plain ? text : utf8_text(text)) {
    switch (c) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      case '\'':
        safe += "&#39;";
        break;
      default:
        safe += c;
    }
  }
  return safe;
}

std::string histogram_svg(const DeviationHistogram& histogram, double tolerance_mm, const Words& w) {
  constexpr double kLeft = 52, kTop = 24, kPlotWidth = 560, kPlotHeight = 170, kWidth = 680, kHeight = 240;
  constexpr std::size_t kGap = 4, kBeyond = 2;  // bins' widths before the bar of what lies beyond, and for it
  std::string svg = begin_svg(kWidth, kHeight, w("Deviation of both surfaces"));
  const auto bins = histogram.areas_mm2.size();
  double total = histogram.beyond_mm2, tallest = histogram.beyond_mm2;
  for (const double area : histogram.areas_mm2) {
    total += area;
    tallest = std::max(tallest, area);
  }
  if (!(total > 0) || bins == 0)
    return svg + text(kWidth / 2, kHeight / 2, "middle", w("no samples")) + "</svg>\n";
  const double bin_width = kPlotWidth / static_cast<double>(bins + kGap + kBeyond),
               bottom = kTop + kPlotHeight;
  const auto bar = [&](double slot, double area, bool good) {
    const double height = kPlotHeight * area / tallest;
    return rect(kLeft + slot * bin_width + 0.5, bottom - height, bin_width - 1, height, good ? kGood : kBad);
  };
  for (std::size_t i = 0; i < bins; ++i) {
    const bool good = (static_cast<double>(i) + 0.5) * histogram.bin_mm < tolerance_mm;
    svg += bar(static_cast<double>(i), histogram.areas_mm2[i], good);
  }
  svg += bar(static_cast<double>(bins + kGap), histogram.beyond_mm2, false);
  const std::string axis = fmt::format("stroke=\"{}\"", kInk);
  svg += line(kLeft, bottom, kLeft + kPlotWidth, bottom, axis.c_str());
  const double end_mm = static_cast<double>(bins) * histogram.bin_mm;
  for (int tick = 0; tick <= 3; ++tick) {
    const double mm = end_mm * tick / 3, x = kLeft + mm / histogram.bin_mm * bin_width;
    svg += line(x, bottom, x, bottom + 4, axis.c_str()) +
           text(x, bottom + 18, "middle", fmt::format("{:.3g}", mm));
  }
  svg += text(kLeft + kPlotWidth - 1.5 * bin_width, bottom + 18, "start", w("beyond"));
  svg += text(kLeft + kPlotWidth / 2, bottom + 36, "middle",
              w("deviation, mm (cut to design and design to cut)"));
  const double share = 100.0 * tallest / total;
  svg +=
      text(kLeft - 6, kTop + 10, "end", fmt::format("{:.3g} %", share)) + text(kLeft - 6, bottom, "end", "0");
  svg +=
      tolerance_mark(kLeft + tolerance_mm / histogram.bin_mm * bin_width, kTop - 6, bottom, tolerance_mm, w);
  return svg + "</svg>\n";
}

std::string budget_svg(const std::vector<std::pair<std::string, double>>& budget_mm, double tolerance_mm,
                       const Words& w) {
  constexpr double kLeft = 190, kRow = 22, kBarWidth = 390, kWidth = 680, kTop = 26;
  std::vector<std::pair<std::string, double>> lines = budget_mm;
  lines.emplace_back("sum", budget_sum_mm(budget_mm));
  double most = tolerance_mm;
  for (const auto& entry : lines) most = std::max(most, std::isfinite(entry.second) ? entry.second : 0);
  const double height = kTop + kRow * static_cast<double>(lines.size()) + 12;
  std::string svg = begin_svg(kWidth, height, w("Error budget"));
  const double scale = most > 0 ? kBarWidth / most : 0;
  double y = kTop;
  for (const auto& [name, mm] : lines) {
    std::string words = name;
    std::replace(words.begin(), words.end(), '_', ' ');
    svg += rect(kLeft, y + 3, kBarWidth, kRow - 6, "#eef0f2");
    svg += rect(kLeft, y + 3, mm * scale, kRow - 6, mm <= tolerance_mm ? kGood : kBad);
    svg += text(kLeft - 8, y + kRow - 7, "end", w.said(words));
    svg += text(kLeft + kBarWidth + 8, y + kRow - 7, "start", fmt::format("{:.4f} mm", mm));
    y += kRow;
  }
  svg += line(kLeft, kTop, kLeft, y, fmt::format("stroke=\"{}\"", kFaint).c_str());
  svg += tolerance_mark(kLeft + tolerance_mm * scale, kTop - 4, y, tolerance_mm, w);
  return svg + "</svg>\n";
}

}  // namespace hotblade::pipeline
