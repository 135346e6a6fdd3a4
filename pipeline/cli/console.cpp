#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "pipeline/cli/command.hpp"
#include "pipeline/settings/json_text.hpp"

namespace hotblade::pipeline {
namespace {

constexpr int kBarWidth = 30;

// Finer steps are not shown: they would cost more than the work they tell of.
constexpr double kProgressStep = 0.005;

bool shows_bar(const Console& console) {
  if (console.progress == "bar") return true;
  return console.progress == "auto" && isatty(STDERR_FILENO) == 1;
}

void draw_bar(const std::string& stage, double fraction) {
  const int filled = static_cast<int>(std::floor(fraction * kBarWidth));
  const std::string bar = std::string(static_cast<std::size_t>(filled), '#') +
                          std::string(static_cast<std::size_t>(kBarWidth - filled), '.');
  std::fprintf(stderr, "\r\033[K[%s] %3d%%  %s", bar.c_str(), static_cast<int>(std::floor(100 * fraction)),
               stage.c_str());
  std::fflush(stderr);
}

// Colours only where a person looks, and none who does not want them (no-color.org).
bool shows_colors(int descriptor) {
  const char* none = std::getenv("NO_COLOR");
  const char* terminal = std::getenv("TERM");
  if (none != nullptr && *none != '\0') return false;
  return isatty(descriptor) == 1 && terminal != nullptr && std::string_view(terminal) != "dumb";
}

// The first word of a line that says something is wrong, coloured.
std::string marked(const std::string& line, int descriptor) {
  for (const auto& [word, paint] : {std::pair{"refused:", Paint::kBad}, {"warning:", Paint::kWarning}}) {
    if (line.rfind(word, 0) == 0)
      return painted(word, paint, descriptor) + line.substr(std::string_view(word).size());
  }
  return line;
}

}  // namespace

Paint paint_of(VerdictColor color) {
  if (color == VerdictColor::kRed) return Paint::kBad;
  return color == VerdictColor::kAmber ? Paint::kWarning : Paint::kGood;
}

std::string painted(const std::string& text, Paint paint, int descriptor) {
  if (!shows_colors(descriptor)) return text;
  const char* code = paint == Paint::kGood ? "32" : paint == Paint::kBad ? "31" : "33";
  return "\033[" + std::string(code) + "m" + text + "\033[0m";
}

void Console::report_progress(const std::string& stage, double fraction) const {
  const bool json = progress == "json";
  if (quiet || (!json && !shows_bar(*this))) return;
  const std::scoped_lock lock(mutex_);
  if (!(fraction >= shown_)) fraction = std::max(shown_, 0.0);
  fraction = std::clamp(fraction, 0.0, 1.0);
  const bool reached_end = fraction >= 1 && shown_ < 1;
  if (stage == shown_stage_ && fraction < shown_ + kProgressStep && !reached_end) return;
  shown_ = fraction;
  shown_stage_ = stage;
  if (json) {
    nlohmann::ordered_json line;
    line["stage"] = stage;
    line["progress"] = fraction;
    std::fprintf(stderr, "%s\n", json_text(line).c_str());
    return;
  }
  draw_bar(stage, fraction);
  bar_open_ = true;
  if (fraction >= 1) close_bar();
}

void Console::end_progress() const {
  const std::scoped_lock lock(mutex_);
  close_bar();
}

void Console::close_bar() const {
  if (!bar_open_) return;
  std::fputc('\n', stderr);
  bar_open_ = false;
}

void Console::write(const std::string& line, bool show) const {
  const std::scoped_lock lock(mutex_);
  if (show) {
    close_bar();
    std::fprintf(stderr, "%s\n", marked(line, STDERR_FILENO).c_str());
  }
  if (!log_file.empty()) std::ofstream(log_file, std::ios::app | std::ios::binary) << line << '\n';
}

void Console::detail(const std::string& line) const {
  if (verbose > 0) write(line, !quiet);
}

void Console::note(const std::string& line) const {
  write(line, !quiet);
}

void Console::warn(const std::string& line) const {
  write(line, true);
}

}  // namespace hotblade::pipeline
