#include "pipeline/batch/split.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <boost/pending/disjoint_sets.hpp>
#include <cstdint>
#include <deque>
#include <unordered_map>
#include <utility>
#include <vector>

#include "surface/read/obj_statements.hpp"
#include "surface/read/obj_text.hpp"
#include "surface/read/words.hpp"

namespace hotblade::pipeline::batch {
namespace {

using surface::ObjStatements;
using Kind = ObjStatements::Kind;

constexpr std::array<std::pair<SplitBy, std::string_view>, 4> kWords{{{SplitBy::kNone, "none"},
                                                                      {SplitBy::kGroup, "group"},
                                                                      {SplitBy::kObject, "object"},
                                                                      {SplitBy::kComponent, "component"}}};

// Bytes between two calls of `read`.
constexpr std::size_t kReadStep = std::size_t{64} << 20;

// A stretch of the text whose faces are of one panel.
struct Stretch {
  std::size_t begin = 0, end = 0;
  ObjStatements::Before before;
};

struct Panel {
  std::string name;
  std::vector<Stretch> stretches;
};

// Places of all v lines: a deque, as a vector of a billion bytes takes two of them while it grows.
using Offsets = std::deque<std::size_t>;

class Splitter {
 public:
  Splitter(std::string_view text, const std::string& file, const SplitOptions& options, const BytesRead& read)
      : options_(options),
        read_(read),
        statements_(surface::checked_obj_text(text, file, read), file, options.largest_coordinate) {}

  void split(const TakePanel& take) {
    survey();
    if (options_.by == SplitBy::kComponent) part_components();
    local_.assign(offsets_.size(), 0);
    for (const Panel& panel : panels_) {
      if (!options_.wanted || options_.wanted(panel.name)) take(text_of(panel));
    }
  }

 private:
  // ---- the first walk: everything is checked, and stretches are found ----

  void survey() {
    for (Kind kind = next(); kind != Kind::kEnd; kind = next()) {
      if (kind == Kind::kVertex) offsets_.push_back(statements_.offset());
      if (kind == Kind::kObject || kind == Kind::kGroup) change_name(kind == Kind::kObject);
      if (kind == Kind::kFace) add_face();
    }
    check_whole();
    parents_.resize(options_.by == SplitBy::kComponent ? offsets_.size() : 0);
  }

  void seek(std::size_t offset, ObjStatements::Before before) {
    statements_.seek(offset, before);
    told_to_ = offset;
  }

  Kind next() {
    const Kind kind = statements_.next();
    const std::size_t at = statements_.offset();
    untold_ += at - std::min(told_to_, at);
    told_to_ = at;
    if (untold_ >= kReadStep && read_) read_(std::exchange(untold_, 0));
    return kind;
  }

  void change_name(bool object) {
    const std::vector<std::string>& words = statements_.words();
    if (object) group_.object = surface::joined_words(words);
    if (!object) group_.names = words;
    if (options_.by == SplitBy::kObject && object) begin_panel(group_.object);
    if (options_.by == SplitBy::kGroup && !object) begin_panel(counted_name());
    if (options_.by == SplitBy::kNone) wanted_ = options_.only.empty() || group_.has(options_.only);
  }

  [[nodiscard]] std::string counted_name() const {
    const std::vector<std::string>& names = group_.names;
    if (names.size() < 2) return names.empty() ? "" : names.front();
    const auto index = static_cast<std::size_t>(options_.group_index);
    if (index >= 1 && index <= names.size()) return names[index - 1];
    const std::string all = surface::shown_token(surface::joined_words(names));
    statements_.fail(
        statements_.line(),
        index == 0
            ? fmt::format("{} groups at once ({}): say with --group-index which of the names is the panel's",
                          names.size(), all)
            : fmt::format("{} groups at once ({}, --group-index {}): there is no such name", names.size(),
                          all, index));
  }

  void begin_panel(const std::string& name) {
    name_ = name.empty() ? "unnamed" : name;
    stretch_ = nullptr;
  }

  void add_face() {
    for (const int corner : statements_.corners()) {
      if (static_cast<std::size_t>(corner) < highest_) continue;
      highest_ = static_cast<std::size_t>(corner) + 1;
      highest_line_ = statements_.line();
    }
    if (options_.by == SplitBy::kComponent) {
      ++faces_;
      return;
    }
    if (options_.by == SplitBy::kNone && !wanted_) {
      stretch_ = nullptr;
      return;
    }
    if (stretch_ == nullptr)
      begin_stretch(panel_named(options_.by == SplitBy::kNone ? options_.whole_name : name_));
    end_stretch();
    ++faces_;
  }

  Panel& panel_named(const std::string& name) {
    const auto [found, fresh] = panel_of_name_.emplace(name, panels_.size());
    if (fresh) panels_.push_back({name, {}});
    return panels_[found->second];
  }

  // Panels are held in a deque, so that the stretch stays where it is while others are begun.
  void begin_stretch(Panel& panel) {
    panel.stretches.push_back({statements_.offset(), 0, {statements_.line() - 1, statements_.vertices()}});
    stretch_ = &panel.stretches.back();
  }
  void end_stretch() { stretch_->end = statements_.offset() + statements_.bytes().size(); }

  void check_whole() const {
    const std::size_t line = statements_.line();
    if (offsets_.empty())
      statements_.fail(line, "no vertices in the file (0 v lines): export the design as a polygon mesh");
    if (highest_ > offsets_.size()) {
      statements_.fail(
          highest_line_,
          fmt::format("vertex index out of range ({}, the file has {} vertices): the file is cut "
                      "short or was joined wrongly",
                      highest_, offsets_.size()));
    }
    if (faces_ > 0) return;
    statements_.fail(
        line, options_.only.empty()
                  ? fmt::format("no faces in the file ({} vertices, 0 f lines): export a mesh, not points, "
                                "curves or NURBS",
                                offsets_.size())
                  : fmt::format("no faces in group '{}'", surface::shown_token(options_.only)));
  }

  // ---- components: one walk joins the vertices of each face, one finds the stretches ----

  void part_components() {
    std::vector<std::uint8_t> ranks(offsets_.size());
    boost::disjoint_sets sets(ranks.data(), parents_.data());
    for (std::size_t i = 0; i < parents_.size(); ++i) parents_[i] = static_cast<int>(i);
    statements_.read_numbers(false);
    walk_faces([&] {
      for (const int corner : statements_.corners()) sets.union_set(statements_.corners().front(), corner);
    });
    std::unordered_map<int, std::string> names;
    int last = -1;
    walk_faces([&] {
      const int root = sets.find_set(statements_.corners().front());
      if (root != last) {
        const auto found = names.emplace(root, fmt::format("component {}", names.size() + 1)).first;
        begin_stretch(panel_named(found->second));
      }
      last = root;
      end_stretch();
    });
    std::vector<int>().swap(parents_);
  }

  template <typename Visit>
  void walk_faces(const Visit& visit) {
    seek(0, {});
    for (Kind kind = next(); kind != Kind::kEnd; kind = next()) {
      if (kind == Kind::kFace) visit();
    }
  }

  // ---- the second walk: a panel's text ----

  PanelText text_of(const Panel& panel) {
    PanelText made{panel.name, {}, 0, 0, 0, {}};
    std::vector<int> order;  // its vertices
    std::string faces;
    std::vector<int> corners;
    std::vector<std::size_t> ends;
    statements_.read_numbers(false);
    for (const Stretch& stretch : panel.stretches) {
      seek(stretch.begin, stretch.before);
      while (next() != Kind::kEnd && statements_.offset() < stretch.end) {
        if (statements_.keyword() != "f" && statements_.keyword() != "fo") continue;
        faces += 'f';
        if (options_.with_lines) made.face_lines.push_back(statements_.line());
        for (const int corner : statements_.corners()) {
          int& local = local_[static_cast<std::size_t>(corner)];
          if (local == 0) {
            order.push_back(corner);
            local = static_cast<int>(order.size());
          }
          corners.push_back(local - 1);
          fmt::format_to(std::back_inserter(faces), " {}", local);
        }
        faces += '\n';
        ends.push_back(corners.size());
      }
    }
    const std::vector<Eigen::Vector3d> positions = add_vertices(order, made.text);
    made.lines_before_faces = static_cast<std::size_t>(std::count(made.text.begin(), made.text.end(), '\n'));
    made.text += faces;
    std::size_t begin = 0;
    for (const std::size_t end : ends) {
      made.triangles += end - begin - 2;
      for (std::size_t i = begin + 2; i < end; ++i) {
        const auto at = [&](std::size_t corner) -> const Eigen::Vector3d& {
          return positions[static_cast<std::size_t>(corners[corner])];
        };
        made.area += (at(i - 1) - at(begin)).cross(at(i) - at(begin)).norm() / 2;
      }
      begin = end;
    }
    return made;
  }

  std::vector<Eigen::Vector3d> add_vertices(const std::vector<int>& order, std::string& text) {
    std::vector<Eigen::Vector3d> positions;
    statements_.read_numbers(true);
    for (const int vertex : order) {
      const auto index = static_cast<std::size_t>(vertex);
      statements_.seek(offsets_[index], {0, index});
      (void)statements_.next();
      text += statements_.bytes();
      text += '\n';
      positions.push_back(statements_.position());
      local_[index] = 0;
    }
    return positions;
  }

  const SplitOptions& options_;
  const BytesRead& read_;
  ObjStatements statements_;
  std::size_t told_to_ = 0,
              untold_ = 0;  // the place of the walk, and the bytes that `read_` has not been told of
  Offsets offsets_;
  std::vector<int> parents_;
  surface::Polygons::Group group_;  // in force
  std::string name_ = "unnamed";    // of the panel in force
  bool wanted_ = options_.only.empty();
  Stretch* stretch_ = nullptr;
  std::deque<Panel> panels_;
  std::unordered_map<std::string, std::size_t> panel_of_name_;
  std::size_t faces_ = 0, highest_ = 0, highest_line_ = 0;
  std::vector<int> local_;  // of a vertex, its number in the panel being written, from 1; 0: none yet
};

}  // namespace

std::optional<std::size_t> PanelText::file_line(std::size_t text_line) const {
  if (text_line <= lines_before_faces || text_line - lines_before_faces > face_lines.size())
    return std::nullopt;
  return face_lines[text_line - lines_before_faces - 1];
}

std::string_view name(SplitBy by) {
  return kWords[static_cast<std::size_t>(by)].second;
}

std::optional<SplitBy> split_named(std::string_view word) {
  for (const auto& [by, its_word] : kWords) {
    if (word == its_word) return by;
  }
  return std::nullopt;
}

void split_obj(std::string_view text, const std::string& file, const SplitOptions& options,
               const TakePanel& take, const BytesRead& read) {
  Splitter(text, file, options, read).split(take);
}

}  // namespace hotblade::pipeline::batch
