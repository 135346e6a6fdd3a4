#include "surface/read/obj_text.hpp"

#include <unordered_map>

#include "surface/read/design_surface.hpp"
#include "surface/read/obj_statements.hpp"
#include "surface/read/warning.hpp"
#include "surface/read/words.hpp"

namespace hotblade::surface {
namespace {

class Parser {
 public:
  Parser(std::string_view text, const std::string& name, double limit)
      : statements_(checked_obj_text(text, name), name, limit) {
    group_of_names_.emplace("\n", 0);
  }

  Polygons parse() {
    using Kind = ObjStatements::Kind;
    for (Kind kind = statements_.next(); kind != Kind::kEnd; kind = statements_.next()) {
      if (kind == Kind::kVertex) obj_.positions.push_back(statements_.position());
      if (kind == Kind::kFace) add_face();
      if (kind == Kind::kObject || kind == Kind::kGroup) add_group(kind == Kind::kObject);
      if (kind == Kind::kUnknown && unknown_++ == 0)
        first_unknown_ =
            shown_token(statements_.keyword()) + " in line " + std::to_string(statements_.line());
    }
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
    obj_.face_group.push_back(group_);
  }

  void add_group(bool object) {
    Polygons::Group next = obj_.groups[group_];
    if (object) {
      next.object = joined_words(statements_.words());
    } else {
      next.names = statements_.words();
    }
    std::string key = next.object + '\n' + joined_words(next.names);
    const auto [found, fresh] =
        group_of_names_.emplace(std::move(key), static_cast<std::uint32_t>(obj_.groups.size()));
    if (fresh) obj_.groups.push_back(std::move(next));
    group_ = found->second;
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
    if (unknown_ > 0) {
      obj_.warnings.push_back(text_of(Warning::kStatements, {std::to_string(unknown_), first_unknown_}));
    }
  }

  ObjStatements statements_;
  Polygons obj_;
  std::uint32_t group_ = 0;  // in force
  std::unordered_map<std::string, std::uint32_t> group_of_names_;
  std::size_t unknown_ = 0;
  std::string first_unknown_;
};

}  // namespace

Polygons parse_obj(std::string_view text, const std::string& name, double limit) {
  return Parser(text, name, limit).parse();
}

}  // namespace hotblade::surface
