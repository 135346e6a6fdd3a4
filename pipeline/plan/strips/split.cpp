#include "pipeline/plan/strips/split.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <stdexcept>

namespace hotblade::pipeline {

namespace {

// Places that are tried for a split line: more where there are few lines.
constexpr std::size_t kPlacesOfFew = 5, kPlacesOfMany = 3, kFewPieces = 5;

class Splitter {
 public:
  Splitter(const ShareTest& test, const SplitOptions& options) : test_(test), options_(options) {}

  Split run() {
    if (serves(0, steps())) {
      return {{0, 1}, {0, 1}, *tested(0, steps())};
    }
    const std::vector<int> latest = walk(1);
    if (latest.empty()) return {};
    const std::vector<int> earliest = walk(-1);
    // With shares that serve although a larger one around them does, both ways may differ in number.
    if (earliest.size() != latest.size()) return farthest(latest);
    return best_lines(earliest, latest);
  }

 private:
  [[nodiscard]] int steps() const { return options_.steps; }
  [[nodiscard]] double at(int i) const { return static_cast<double>(i) / steps(); }

  const std::optional<double>& tested(int i, int j) {
    const auto [place, fresh] = tested_.try_emplace({i, j});
    if (fresh) place->second = test_(at(i), at(j));
    return place->second;
  }
  bool serves(int i, int j) { return tested(i, j).has_value(); }

  // Does the share of n steps from `from` in the sense of `way` serve?
  bool reaches(int from, int way, int n) { return way > 0 ? serves(from, from + n) : serves(from - n, from); }

  // The most steps that serve from a place, at most `room`; the guess is where the search starts.
  int steps_from(int from, int way, int room, int guess) {
    int good = 0, bad = room + 1;
    for (int n = std::clamp(guess, 1, room), stride = 1; good + 1 < bad;) {
      if (reaches(from, way, n)) {
        good = n;
        n = bad <= room ? (good + bad) / 2 : std::min(room, good + stride);
      } else {
        bad = n;
        n = good > 0 ? (good + bad) / 2 : std::max(1, bad - stride);
      }
      stride *= 2;
    }
    return good;
  }

  // Split lines from one end, each as far as it serves; ascending, with both ends. Empty when some place has
  // no share that serves or there are too many.
  std::vector<int> walk(int way) {
    const int start = way > 0 ? 0 : steps();
    std::vector<int> places{start};
    for (int room = steps(), guess = steps() / 2; room > 0;) {
      if (places.size() > static_cast<std::size_t>(options_.most_pieces)) return {};
      const int n = steps_from(places.back(), way, room, guess);
      if (n == 0) return {};
      guess = n;
      room -= n;
      places.push_back(places.back() + way * n);
    }
    std::sort(places.begin(), places.end());
    return places;
  }

  [[nodiscard]] std::vector<double> to_lines(const std::vector<int>& places) const {
    std::vector<double> lines;
    for (const int i : places) lines.push_back(at(i));
    return lines;
  }

  Split farthest(const std::vector<int>& places) {
    Split split{to_lines(places), to_lines(places), 0};
    for (std::size_t m = 0; m + 1 < places.size(); ++m) {
      split.deviation_mm = std::max(split.deviation_mm, *tested(places[m], places[m + 1]));
    }
    return split;
  }

  // Places evenly spread over a window, both ends included.
  static std::vector<int> spread(int low, int high, std::size_t most) {
    std::vector<int> places;
    const auto count = std::min(most, static_cast<std::size_t>(high - low) + 1);
    for (std::size_t i = 0; i < count; ++i) {
      places.push_back(count < 2 ? low
                                 : low + (high - low) * static_cast<int>(i) / static_cast<int>(count - 1));
    }
    return places;
  }

  struct Node {
    int place = 0;
    double worst = std::numeric_limits<double>::infinity();
    std::size_t before = 0;
  };

  Split best_lines(const std::vector<int>& earliest, const std::vector<int>& latest) {
    const std::size_t most = latest.size() - 1 <= kFewPieces ? kPlacesOfFew : kPlacesOfMany;
    std::vector<std::vector<Node>> stages{{{0, 0, 0}}};
    for (std::size_t m = 1; m < latest.size(); ++m) {
      std::vector<Node> stage;
      for (const int place : spread(std::min(earliest[m], latest[m]), latest[m], most)) {
        Node node{place};
        for (std::size_t b = 0; b < stages.back().size(); ++b) {
          const Node& from = stages.back()[b];
          if (from.place >= place || !serves(from.place, place)) continue;
          const double worst = std::max(from.worst, *tested(from.place, place));
          if (worst < node.worst) node = {place, worst, b};
        }
        stage.push_back(node);
      }
      stages.push_back(std::move(stage));
    }
    // No way through: a share within a serving one does not serve.
    if (!(stages.back().front().worst < std::numeric_limits<double>::infinity())) return farthest(latest);
    Split split{{}, to_lines(latest), stages.back().front().worst};
    std::size_t b = 0;
    for (std::size_t m = stages.size(); m-- > 0; b = stages[m][b].before)
      split.lines.push_back(at(stages[m][b].place));
    std::reverse(split.lines.begin(), split.lines.end());
    return split;
  }

  const ShareTest& test_;
  SplitOptions options_;
  std::map<std::pair<int, int>, std::optional<double>> tested_;
};

}  // namespace

Split split_ribs(const ShareTest& test, const SplitOptions& options) {
  if (options.steps < 1 || options.most_pieces < 1) {
    throw std::logic_error("split_ribs: steps and most_pieces must be at least 1");
  }
  return Splitter(test, options).run();
}

}  // namespace hotblade::pipeline
