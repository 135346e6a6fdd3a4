#include "surface/read/obj_text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <set>
#include <unordered_map>

#include "surface/read/design_surface.hpp"

namespace hotblade::surface {
namespace {

constexpr std::string_view kConvertHint =
    "save it as UTF-8, for example with: iconv -f UTF-16 -t UTF-8 in.obj > out.obj";

// Statements that carry no polygons; what they say is not needed here.
constexpr std::array<std::string_view, 18> kPassedOver = {
    "vt",  "vn",     "vp",     "l",     "p",        "s",        "usemtl",     "mtllib",    "mg",
    "lod", "usemap", "maplib", "bevel", "c_interp", "d_interp", "shadow_obj", "trace_obj", "vw"};

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}
bool is_line_end(char c) {
  return c == '\n' || c == '\r';
}

// Unprintable bytes are shown as '?', and long tokens are cut, so that a message stays one readable line.
std::string shown(std::string_view token) {
  constexpr std::size_t kLongest = 40;
  std::string out(token.substr(0, kLongest));
  for (char& c : out) {
    if (static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) >= 0x7f) c = '?';
  }
  return token.size() > kLongest ? out + "..." : out;
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

// Walks the text token by token. A `\` before a line end joins lines; a lone CR ends a line as LF and CR LF
// do.
class Scanner {
 public:
  explicit Scanner(std::string_view text) : at_(text.data()), end_(text.data() + text.size()) {}

  [[nodiscard]] bool done() const { return at_ == end_; }
  [[nodiscard]] std::size_t line() const { return line_; }

  // The next token of this statement; empty at its end. A token that starts with # is a comment.
  std::string_view token() {
    skip_blanks();
    if (at_ == end_ || is_line_end(*at_) || *at_ == '#') return {};
    const char* start = at_;
    while (at_ != end_ && !is_blank(*at_) && !is_line_end(*at_) && !joins_lines()) ++at_;
    return {start, static_cast<std::size_t>(at_ - start)};
  }

  // Passes over what is left of the statement and its line end. A comment ends at its own line's end.
  void finish_statement() {
    skip_blanks();
    while (at_ != end_ && !is_line_end(*at_) && *at_ != '#') {
      static_cast<void>(token());
      skip_blanks();
    }
    while (at_ != end_ && !is_line_end(*at_)) ++at_;
    if (at_ != end_) pass_line_end();
  }

 private:
  [[nodiscard]] bool joins_lines() const { return *at_ == '\\' && at_ + 1 != end_ && is_line_end(at_[1]); }
  void pass_line_end() {
    at_ += (*at_ == '\r' && at_ + 1 != end_ && at_[1] == '\n') ? 2 : 1;
    ++line_;
  }
  void skip_blanks() {
    while (at_ != end_) {
      if (is_blank(*at_)) {
        ++at_;
      } else if (joins_lines()) {
        ++at_;
        pass_line_end();
      } else {
        return;
      }
    }
  }

  const char* at_;
  const char* end_;
  std::size_t line_ = 1;
};

class Parser {
 public:
  Parser(std::string_view text, const std::string& name, double limit)
      : name_(name), limit_(limit), scanner_(checked_encoding(text)) {
    obj_.first_corner.push_back(0);
    obj_.groups.emplace_back();
    group_of_names_.emplace("\n", 0);
  }

  ObjText parse() {
    while (!scanner_.done()) {
      line_ = scanner_.line();
      const std::string_view keyword = scanner_.token();
      if (keyword == "v") {
        read_vertex();
      } else if (keyword == "f" || keyword == "fo") {
        read_face();
      } else if (keyword == "g" || keyword == "o") {
        read_group(keyword == "o");
      } else if (!keyword.empty()) {
        pass_over(keyword);
      }
      scanner_.finish_statement();
    }
    check_whole();
    return std::move(obj_);
  }

 private:
  [[noreturn]] void fail(std::size_t line, const std::string& what) const {
    throw MeshError(name_ + ":" + std::to_string(line) + ": " + what);
  }

  // UTF-16 text reads as garbage or as nothing at all, so it is told apart before anything else.
  std::string_view checked_encoding(std::string_view text) const {
    if (text.empty()) fail(1, "the file is empty (0 bytes): export the design again");
    if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff")) {
      fail(1, "the text is UTF-16, as its first two bytes say: " + std::string(kConvertHint));
    }
    const std::size_t nul = text.find('\0');
    if (nul != std::string_view::npos) {
      const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(nul), '\n');
      if (nul < 2) fail(1, "NUL byte: the text looks like UTF-16: " + std::string(kConvertHint));
      fail(static_cast<std::size_t>(line), "NUL byte (at byte " + std::to_string(nul) +
                                               "): not OBJ text; if it is UTF-16, " +
                                               std::string(kConvertHint));
    }
    if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
    return text;
  }

  double number(std::string_view token) const {
    std::string_view digits = token;
    if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-') digits.remove_prefix(1);
    double value = 0;
    const auto [rest, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    // Out of range is said for numbers too small as well; those are zero for every purpose here.
    if (error == std::errc::result_out_of_range) value = std::strtod(std::string(digits).c_str(), nullptr);
    if (error == std::errc::invalid_argument || rest != digits.data() + digits.size()) reject_number(token);
    return value;
  }

  [[noreturn]] void reject_number(std::string_view token) const {
    if (token.find('#') != std::string_view::npos) {
      fail(line_, "coordinate is not a finite number ('" + shown(token) +
                      "'): repair the vertex in the CAD program");
    }
    const bool comma = token.find(',') != std::string_view::npos;
    fail(line_, "not a number ('" + shown(token) + "'): " +
                    (comma ? "export with a decimal point, not a comma" : "a v line reads: v x y z"));
  }

  void read_vertex() {
    Eigen::Vector3d p;
    for (int axis = 0; axis < 3; ++axis) {
      const std::string_view token = scanner_.token();
      if (token.empty()) {
        fail(line_, "missing coordinate (" + std::to_string(axis) + " of 3 given): a v line reads: v x y z");
      }
      p[axis] = number(token);
      if (!std::isfinite(p[axis])) {
        fail(line_, "coordinate is not a finite number ('" + shown(token) +
                        "'): repair the vertex in the CAD program");
      }
      if (std::abs(p[axis]) > limit_) {
        fail(line_, "coordinate too large (" + shown(token) + ", limit 1e7 mm after scaling): check --units");
      }
    }
    // A weight and colours may follow; they are checked to be numbers, so that no text goes unseen, and not
    // used.
    for (std::string_view token = scanner_.token(); !token.empty(); token = scanner_.token()) {
      static_cast<void>(number(token));
    }
    if (obj_.positions.size() >= kMost)
      fail(line_, "too many vertices (limit 2147483647): thin the mesh out");
    obj_.positions.push_back(p);
  }

  // The position index of a corner such as 3, 3/1, 3//2, 3/1/2 or -1/-1; a positive one may point ahead.
  int corner(std::string_view token) const {
    const char* end = token.data() + token.size();
    long long index = 0;
    auto [rest, error] = std::from_chars(token.data(), end, index);
    if (error == std::errc::invalid_argument) reject_corner(token);
    for (int part = 0; part < 2 && rest != end && *rest == '/'; ++part) {
      long long unused = 0;
      const auto next = std::from_chars(rest + 1, end, unused);
      rest = next.ec == std::errc::invalid_argument ? rest + 1 : next.ptr;
    }
    if (rest != end) reject_corner(token);
    const auto count = static_cast<long long>(obj_.positions.size());
    if (error == std::errc() && index == 0) {
      fail(line_, "vertex index 0 ('" + shown(token) + "'): OBJ indices start at 1, relative ones at -1");
    }
    if (error == std::errc::result_out_of_range || index > static_cast<long long>(kMost) || index < -count) {
      fail(line_, "vertex index out of range ('" + shown(token) + "', " + std::to_string(count) +
                      " vertices so far): the file is cut short or was joined wrongly");
    }
    return static_cast<int>(index > 0 ? index - 1 : count + index);
  }

  [[noreturn]] void reject_corner(std::string_view token) const {
    fail(line_, "not a face corner ('" + shown(token) +
                    "'): corners read v, v/vt, v//vn or v/vt/vn with whole numbers");
  }

  void read_face() {
    const std::size_t first = obj_.corners.size();
    for (std::string_view token = scanner_.token(); !token.empty(); token = scanner_.token()) {
      obj_.corners.push_back(corner(token));
    }
    const std::size_t count = obj_.corners.size() - first;
    if (count < 3) {
      fail(line_, "face with too few corners (" + std::to_string(count) +
                      ", at least 3): remove it or export again");
    }
    if (obj_.corners.size() > kMost)
      fail(line_, "too many face corners (limit 2147483647): thin the mesh out");
    obj_.first_corner.push_back(static_cast<std::uint32_t>(obj_.corners.size()));
    obj_.face_line.push_back(static_cast<std::uint32_t>(line_));
    obj_.face_group.push_back(group_);
  }

  void read_group(bool object) {
    std::vector<std::string> names;
    for (std::string_view token = scanner_.token(); !token.empty(); token = scanner_.token()) {
      names.emplace_back(token);
    }
    ObjText::Group next = obj_.groups[group_];
    if (object) {
      next.object = joined(names);
    } else {
      next.names = std::move(names);
    }
    std::string key = next.object + '\n' + joined(next.names);
    const auto [found, fresh] =
        group_of_names_.emplace(std::move(key), static_cast<std::uint32_t>(obj_.groups.size()));
    if (fresh) obj_.groups.push_back(std::move(next));
    group_ = found->second;
  }

  // Unknown lower-case words are extensions of one program or another; anything else is taken for a damaged
  // line, because passing over a misspelt vertex would shift every index after it.
  void pass_over(std::string_view keyword) {
    if (std::find(kPassedOver.begin(), kPassedOver.end(), keyword) != kPassedOver.end()) return;
    const bool word = std::all_of(keyword.begin(), keyword.end(), [](char c) {
      return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
    });
    if (!word || keyword[0] < 'a') {
      fail(line_, "not an OBJ statement ('" + shown(keyword) +
                      "'): lines start with v, f, vt, vn, g, o, s, usemtl, ...");
    }
    if (unknown_++ == 0) first_unknown_ = shown(keyword) + " in line " + std::to_string(line_);
  }

  void check_whole() {
    const std::size_t vertices = obj_.positions.size();
    if (vertices == 0)
      fail(line_, "no vertices in the file (0 v lines): export the design as a polygon mesh");
    if (obj_.faces() == 0) {
      fail(line_, "no faces in the file (" + std::to_string(vertices) +
                      " vertices, 0 f lines): export a mesh, not points, curves or NURBS");
    }
    for (std::size_t f = 0; f < obj_.faces(); ++f) {
      for (const int c : obj_.face(f)) {
        if (static_cast<std::size_t>(c) < vertices) continue;
        fail(obj_.face_line[f], "vertex index out of range (" + std::to_string(c + 1LL) + ", the file has " +
                                    std::to_string(vertices) +
                                    " vertices): the file is cut short or was joined wrongly");
      }
    }
    if (unknown_ > 0) {
      obj_.warnings.push_back(std::to_string(unknown_) + " statements passed over, the first " +
                              first_unknown_ + ": only polygons are read");
    }
  }

  static constexpr std::size_t kMost = std::numeric_limits<int>::max();

  const std::string& name_;
  double limit_;
  Scanner scanner_;
  ObjText obj_;
  std::size_t line_ = 1;
  std::uint32_t group_ = 0;  // in force
  std::unordered_map<std::string, std::uint32_t> group_of_names_;
  std::size_t unknown_ = 0;
  std::string first_unknown_;
};

// What the user may have meant.
std::string known_groups(const ObjText& obj) {
  std::set<std::string> names;
  for (const std::uint32_t g : std::set<std::uint32_t>(obj.face_group.begin(), obj.face_group.end())) {
    const ObjText::Group& group = obj.groups[g];
    if (!group.object.empty()) names.insert(group.object);
    names.insert(group.names.begin(), group.names.end());
  }
  if (names.empty()) return "the file names none, leave design.group empty";
  constexpr std::size_t kShown = 8;
  std::string text = "choose one of";
  std::size_t listed = 0;
  for (const std::string& name : names) {
    if (listed++ == kShown) return text + ", ... (" + std::to_string(names.size()) + " in all)";
    text += (listed == 1 ? " " : ", ") + shown(name);
  }
  return text;
}

}  // namespace

ObjText parse_obj(std::string_view text, const std::string& name, double limit) {
  return Parser(text, name, limit).parse();
}

bool ObjText::Group::has(std::string_view name) const {
  return object == name || joined(names) == name ||
         std::find(names.begin(), names.end(), name) != names.end();
}

void keep_group(ObjText& obj, const std::string& group, const std::string& name) {
  std::vector<bool> wanted(obj.groups.size());
  for (std::size_t g = 0; g < wanted.size(); ++g) wanted[g] = obj.groups[g].has(group);
  std::size_t faces = 0, corners = 0;
  for (std::size_t f = 0; f < obj.faces(); ++f) {
    if (!wanted[obj.face_group[f]]) continue;
    const std::size_t from = obj.first_corner[f], to = obj.first_corner[f + 1];
    std::copy(obj.corners.begin() + static_cast<std::ptrdiff_t>(from),
              obj.corners.begin() + static_cast<std::ptrdiff_t>(to),
              obj.corners.begin() + static_cast<std::ptrdiff_t>(corners));
    obj.first_corner[faces] = static_cast<std::uint32_t>(corners);
    obj.face_line[faces] = obj.face_line[f];
    obj.face_group[faces++] = obj.face_group[f];
    corners += to - from;
  }
  if (faces == 0) throw MeshError(name + ": no faces in group '" + shown(group) + "': " + known_groups(obj));
  obj.first_corner[faces] = static_cast<std::uint32_t>(corners);
  obj.first_corner.resize(faces + 1);
  obj.corners.resize(corners);
  obj.face_line.resize(faces);
  obj.face_group.resize(faces);
}

}  // namespace hotblade::surface
