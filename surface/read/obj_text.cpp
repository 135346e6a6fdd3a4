#include "surface/read/obj_text.hpp"

#include <algorithm>
#include <atomic>
#include <optional>
#include <unordered_map>
#include <utility>

#include "surface/read/blocks.hpp"
#include "surface/read/design_surface.hpp"
#include "surface/read/obj_parts.hpp"
#include "surface/read/obj_statements.hpp"
#include "surface/read/warning.hpp"
#include "surface/read/words.hpp"

namespace hotblade::surface {
namespace {

using Statement = ObjStatements::Kind;

// The groups met so far and the one in force.
class NamedGroups {
 public:
  NamedGroups() { number_of_names_.emplace("\n", 0); }

  // Takes an object's or a group's statement and returns the number of what is in force from there on.
  std::uint32_t enter(const ObjStatements& statement, bool object) {
    Polygons::Group next = groups_[in_force_];
    if (object) {
      next.object = joined_words(statement.words());
    } else {
      next.names = statement.words();
    }
    std::string key = next.object + '\n' + joined_words(next.names);
    const auto [found, fresh] =
        number_of_names_.emplace(std::move(key), static_cast<std::uint32_t>(groups_.size()));
    if (fresh) groups_.push_back(std::move(next));
    return in_force_ = found->second;
  }

  [[nodiscard]] std::uint32_t in_force() const { return in_force_; }
  [[nodiscard]] std::vector<Polygons::Group> take() { return std::move(groups_); }

 private:
  std::uint32_t in_force_ = 0;
  std::vector<Polygons::Group> groups_{Polygons::Group{}};
  std::unordered_map<std::string, std::uint32_t> number_of_names_;
};

// Statements of other programs that were passed over.
struct PassedOver {
  std::size_t count = 0;
  std::string first;

  void add(const ObjStatements& statement) {
    if (count++ == 0)
      first = shown_token(statement.keyword()) + " in line " + std::to_string(statement.line());
  }
  void add(const PassedOver& later) {
    if (count == 0) first = later.first;
    count += later.count;
  }
  void warn(Polygons& obj) const {
    if (count > 0) obj.warnings.push_back(text_of(Warning::kStatements, {std::to_string(count), first}));
  }
};

// Reads text in one, whatever it holds.
class Parser {
 public:
  Parser(std::string_view text, const std::string& name, double limit) : statements_(text, name, limit) {}

  Polygons parse() {
    for (Statement kind = statements_.next(); kind != Statement::kEnd; kind = statements_.next()) {
      if (kind == Statement::kVertex) obj_.positions.push_back(statements_.position());
      if (kind == Statement::kFace) add_face();
      if (kind == Statement::kObject || kind == Statement::kGroup)
        groups_.enter(statements_, kind == Statement::kObject);
      if (kind == Statement::kUnknown) unknown_.add(statements_);
    }
    obj_.groups = groups_.take();
    check_whole();
    return std::move(obj_);
  }

 private:
  void add_face() {
    const std::span<const int> corners = statements_.corners();
    obj_.corners.insert(obj_.corners.end(), corners.begin(), corners.end());
    if (obj_.corners.size() > ObjStatements::kMost)
      statements_.fail(statements_.line(), "too many face corners (limit 2147483647): thin the mesh out");
    obj_.first_corner.push_back(static_cast<std::uint32_t>(obj_.corners.size()));
    obj_.face_place.push_back(static_cast<std::uint32_t>(statements_.line()));
    obj_.face_group.push_back(groups_.in_force());
  }

  void check_whole() {
    const std::size_t vertices = obj_.positions.size();
    if (vertices == 0)
      statements_.fail(statements_.line(),
                       "no vertices in the file (0 v lines): export the design as a polygon mesh");
    if (obj_.faces() == 0) {
      statements_.fail(statements_.line(),
                       "no faces in the file (" + std::to_string(vertices) +
                           " vertices, 0 f lines): export a mesh, not points, curves or NURBS");
    }
    for (std::size_t f = 0; f < obj_.faces(); ++f) {
      for (const int c : obj_.face(f)) {
        if (static_cast<std::size_t>(c) < vertices) continue;
        statements_.fail(obj_.face_place[f], "vertex index out of range (" + std::to_string(c + 1LL) +
                                                 ", the file has " + std::to_string(vertices) +
                                                 " vertices): the file is cut short or was joined wrongly");
      }
    }
    unknown_.warn(obj_);
  }

  ObjStatements statements_;
  Polygons obj_;
  NamedGroups groups_;
  PassedOver unknown_;
};

// Reads the parts of a text side by side, each into its own places.
class PartsParser {
 public:
  PartsParser(std::string_view text, const std::string& name, double limit, std::vector<ObjPart> parts)
      : text_(text), name_(name), limit_(limit), parts_(std::move(parts)) {}

  // Nothing where something is wrong.
  std::optional<Polygons> parse() {
    const ObjPart& last = parts_.back();
    const std::size_t vertices = last.before.vertices + last.vertices;
    const std::size_t faces = last.faces_before + last.faces, corners = last.corners_before + last.corners;
    if (vertices == 0 || faces == 0) return std::nullopt;
    side_by_side([&] { obj_.positions.resize(vertices); },
                 [&] {
                   obj_.corners.resize(corners);
                   obj_.first_corner.resize(faces + 1);
                 });
    side_by_side([&] { obj_.face_place.resize(faces); }, [&] { obj_.face_group.resize(faces); });
    name_groups();
    std::vector<PassedOver> unknown(parts_.size());
    std::atomic<bool> usable = true;
    for_blocks(parts_.size(), 1, [&](std::size_t part, std::size_t) {
      try {
        if (usable && !read(part, unknown[part])) usable = false;
      } catch (const MeshError&) {
        usable = false;
      }
    });
    if (!usable) return std::nullopt;
    for (std::size_t part = 1; part < unknown.size(); ++part) unknown[0].add(unknown[part]);
    unknown[0].warn(obj_);
    return std::move(obj_);
  }

 private:
  // Finds what is in force at each part's beginning and after each of its statements of names.
  void name_groups() {
    NamedGroups groups;
    ObjStatements statements(text_, name_, limit_);
    for (const ObjPart& part : parts_) {
      std::vector<std::uint32_t>& own = groups_.emplace_back(1, groups.in_force());
      for (const std::size_t offset : part.names) {
        statements.seek(offset, part.before);
        own.push_back(groups.enter(statements, statements.next() == Statement::kObject));
      }
    }
    obj_.groups = groups.take();
  }

  // False for a corner that names no vertex of the file, or another number of anything than was counted.
  bool read(std::size_t number, PassedOver& unknown) {
    const ObjPart& part = parts_[number];
    const auto all_vertices = static_cast<int>(obj_.positions.size());
    ObjStatements statements(text_.substr(part.begin, part.end - part.begin), name_, limit_, part.before);
    const std::vector<std::uint32_t>& groups = groups_[number];
    std::size_t vertices = 0, faces = 0, corners = 0, names = 0;
    for (Statement kind = statements.next(); kind != Statement::kEnd; kind = statements.next()) {
      if (kind == Statement::kUnknown) unknown.add(statements);
      if (kind == Statement::kVertex) {
        if (vertices == part.vertices) return false;
        obj_.positions[part.before.vertices + vertices++] = statements.position();
      } else if (kind == Statement::kObject || kind == Statement::kGroup) {
        if (++names == groups.size()) return false;
      } else if (kind == Statement::kFace) {
        const std::span<const int> own = statements.corners();
        if (faces == part.faces || corners + own.size() > part.corners) return false;
        for (const int c : own) {
          if (c >= all_vertices) return false;
          obj_.corners[part.corners_before + corners++] = c;
        }
        const std::size_t face = part.faces_before + faces++;
        obj_.face_place[face] = static_cast<std::uint32_t>(statements.line());
        obj_.face_group[face] = groups[names];
        obj_.first_corner[face + 1] = static_cast<std::uint32_t>(part.corners_before + corners);
      }
    }
    return vertices == part.vertices && faces == part.faces && corners == part.corners;
  }

  std::string_view text_;
  const std::string& name_;
  double limit_;
  std::vector<ObjPart> parts_;
  std::vector<std::vector<std::uint32_t>> groups_;  // of each part: at its beginning, after its statements
  Polygons obj_;
};

}  // namespace

Polygons parse_obj(std::string_view text, const std::string& name, double limit, std::size_t part_bytes) {
  text = checked_obj_text(text, name);
  if (std::optional<std::vector<ObjPart>> parts = obj_parts(text, part_bytes); parts && !parts->empty()) {
    if (std::optional<Polygons> obj = PartsParser(text, name, limit, *std::move(parts)).parse())
      return *std::move(obj);
  }
  // What is wrong is told by what reads the text from its beginning.
  return Parser(text, name, limit).parse();
}

}  // namespace hotblade::surface
