#include "surface/read/obj_statements.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <utility>

#include "surface/read/design_surface.hpp"
#include "surface/read/polygons.hpp"
#include "surface/read/words.hpp"

namespace hotblade::surface {
namespace {

constexpr std::string_view kConvertHint =
    "save it as UTF-8, for example with: iconv -f UTF-16 -t UTF-8 in.obj > out.obj";

// Statements that carry no polygons; what they say is not needed here.
constexpr std::array<std::string_view, 18> kPassedOver = {
    "vt",  "vn",     "vp",     "l",     "p",        "s",        "usemtl",     "mtllib",    "mg",
    "lod", "usemap", "maplib", "bevel", "c_interp", "d_interp", "shadow_obj", "trace_obj", "vw"};

// Whether a byte may go on within a token: neither blank nor line end, nor a `\` that may join lines.
constexpr std::array<bool, 256> kGoesOn = [] {
  std::array<bool, 256> goes_on{};
  for (int c = 0; c < 256; ++c) {
    const char byte = static_cast<char>(c);
    goes_on[static_cast<std::size_t>(c)] = !is_blank(byte) && !is_line_end(byte) && byte != '\\';
  }
  return goes_on;
}();

[[noreturn]] void fail_at(const std::string& name, std::size_t line, const std::string& what) {
  throw MeshError(name + ":" + std::to_string(line) + ": " + what);
}

// The number that a token of up to nine digits is; 0 for any other.
int plain_index(std::string_view token) {
  constexpr std::size_t kMostDigits = 9;
  if (token.size() > kMostDigits) return 0;
  int index = 0;
  for (const char c : token) {
    if (c < '0' || c > '9') return 0;
    index = 10 * index + (c - '0');
  }
  return index;
}

// The place of the first NUL byte, looked for in pieces.
std::size_t first_nul(std::string_view text, const std::function<void(std::size_t)>& passed) {
  constexpr std::size_t kStep = std::size_t{64} << 20;
  for (std::size_t begin = 0; begin < text.size(); begin += kStep) {
    const std::string_view part = text.substr(begin, kStep);
    if (const std::size_t nul = part.find('\0'); nul != std::string_view::npos) return begin + nul;
    if (passed) passed(part.size());
  }
  return std::string_view::npos;
}

}  // namespace

// UTF-16 text reads as garbage or as nothing at all, so it is told apart before anything else.
std::string_view checked_obj_text(std::string_view text, const std::string& name,
                                  const std::function<void(std::size_t)>& passed) {
  const auto fail = [&name](std::size_t line, const std::string& what) { fail_at(name, line, what); };
  if (text.empty()) fail(1, "the file is empty (0 bytes): export the design again");
  if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff")) {
    fail(1, "the text is UTF-16, as its first two bytes say: " + std::string(kConvertHint));
  }
  const std::size_t nul = first_nul(text, passed);
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

ObjStatements::ObjStatements(std::string_view text, std::string name, double limit, Before before)
    : name_(std::move(name)),
      limit_(limit),
      begin_(text.data()),
      at_(begin_),
      end_(begin_ + text.size()),
      first_(begin_),
      last_(begin_),
      at_line_(before.lines + 1),
      vertices_(before.vertices) {}

void ObjStatements::seek(std::size_t offset, Before before) {
  at_ = begin_ + offset;
  at_line_ = before.lines + 1;
  vertices_ = before.vertices;
}

void ObjStatements::fail(std::size_t line, const std::string& what) const {
  fail_at(name_, line, what);
}

// A `\` before a line end joins lines; a lone CR ends a line as LF and CR LF do.
bool ObjStatements::joins_lines() const {
  return *at_ == '\\' && at_ + 1 != end_ && is_line_end(at_[1]);
}

void ObjStatements::pass_line_end() {
  at_ += (*at_ == '\r' && at_ + 1 != end_ && at_[1] == '\n') ? 2 : 1;
  ++at_line_;
}

void ObjStatements::skip_blanks() {
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

// The next token of this statement; empty at its end. A token that starts with # is a comment.
std::string_view ObjStatements::token() {
  skip_blanks();
  if (at_ == end_ || is_line_end(*at_) || *at_ == '#') return {};
  const char* start = at_;
  while (at_ != end_ && (kGoesOn[static_cast<unsigned char>(*at_)] || (*at_ == '\\' && !joins_lines())))
    ++at_;
  last_ = at_;
  return {start, static_cast<std::size_t>(at_ - start)};
}

// Passes over what is left of the statement and its line end. A comment ends at its own line's end.
void ObjStatements::finish_statement() {
  skip_blanks();
  while (at_ != end_ && !is_line_end(*at_) && *at_ != '#') {
    static_cast<void>(token());
    skip_blanks();
  }
  while (at_ != end_ && !is_line_end(*at_)) ++at_;
  if (at_ != end_) pass_line_end();
}

bool ObjStatements::take_plain_line(const char* at, const char* last) {
  if (at != end_ && *at == '\r' && at + 1 != end_) ++at;
  if (at != end_ && *at != '\n') return false;
  keyword_ = {at_, 1};
  first_ = at_;
  last_ = last;
  at_line_ += at != end_ ? 1U : 0U;
  at_ = at != end_ ? at + 1 : at;
  return true;
}

bool ObjStatements::plain_vertex() {
  if (!reads_numbers_ || vertices_ >= kMost) return false;
  Eigen::Vector3d p;
  const char* at = at_ + 1;
  for (double& coordinate : p) {
    if (at == end_ || *at != ' ') return false;
    while (at != end_ && *at == ' ') ++at;
    const char* number = at;
    at = plain_number(number, end_, coordinate);
    if (at == number || std::abs(coordinate) > limit_) return false;
  }
  if (!take_plain_line(at, at)) return false;
  position_ = p;
  ++vertices_;
  return true;
}

bool ObjStatements::plain_face() {
  constexpr std::ptrdiff_t kMostDigits = 9;  // of an int all
  corners_.clear();
  const char *at = at_ + 1, *last = at;
  while (at != end_ && *at == ' ') {
    while (at != end_ && *at == ' ') ++at;
    const char* number = at;
    int index = 0;
    for (; at != end_ && *at >= '0' && *at <= '9' && at - number < kMostDigits; ++at)
      index = 10 * index + (*at - '0');
    if (at == number) break;  // the line's end, or no plain corner
    if (index == 0) return false;
    corners_.push_back(index - 1);
    last = at;
  }
  return corners_.size() >= 3 && take_plain_line(at, last);
}

ObjStatements::Kind ObjStatements::next() {
  while (at_ != end_) {
    line_ = at_line_;
    if (*at_ == 'v' && plain_vertex()) return Kind::kVertex;
    if (*at_ == 'f' && plain_face()) return Kind::kFace;
    keyword_ = token();
    if (keyword_.empty()) {
      finish_statement();
      continue;
    }
    first_ = keyword_.data();
    const Kind kind = read_statement();
    finish_statement();
    return kind;
  }
  return Kind::kEnd;
}

ObjStatements::Kind ObjStatements::read_statement() {
  if (keyword_ == "v") {
    read_vertex();
    return Kind::kVertex;
  }
  if (keyword_ == "f" || keyword_ == "fo") {
    read_face();
    return Kind::kFace;
  }
  if (keyword_ != "g" && keyword_ != "o") return other_kind();
  words_.clear();
  for (std::string_view word = token(); !word.empty(); word = token()) words_.emplace_back(word);
  return keyword_ == "o" ? Kind::kObject : Kind::kGroup;
}

double ObjStatements::number(std::string_view token) const {
  const std::optional<double> value = number_in(token);
  if (!value) reject_number(token);
  return *value;
}

void ObjStatements::reject_number(std::string_view token) const {
  if (token.find('#') != std::string_view::npos) {
    fail(line_, "coordinate is not a finite number ('" + shown_token(token) +
                    "'): repair the vertex in the CAD program");
  }
  const bool comma = token.find(',') != std::string_view::npos;
  fail(line_, "not a number ('" + shown_token(token) +
                  "'): " + (comma ? "export with a decimal point, not a comma" : "a v line reads: v x y z"));
}

void ObjStatements::read_vertex() {
  if (vertices_ >= kMost) fail(line_, "too many vertices (limit 2147483647): thin the mesh out");
  ++vertices_;
  if (!reads_numbers_) return;
  Eigen::Vector3d& p = position_;
  for (int axis = 0; axis < 3; ++axis) {
    const std::string_view word = token();
    if (word.empty()) {
      fail(line_, "missing coordinate (" + std::to_string(axis) + " of 3 given): a v line reads: v x y z");
    }
    p[axis] = number(word);
    if (const std::string why = refusal_of_coordinate(p[axis], word, limit_); !why.empty()) fail(line_, why);
  }
  // A weight and colours may follow; they are checked to be numbers, so that no text goes unseen, and not
  // used.
  for (std::string_view word = token(); !word.empty(); word = token()) {
    static_cast<void>(number(word));
  }
}

// The position index of a corner such as 3, 3/1, 3//2, 3/1/2 or -1/-1; a positive one may point ahead.
int ObjStatements::corner(std::string_view token) const {
  const char* end = token.data() + token.size();
  if (const int plain = plain_index(token); plain > 0) return plain - 1;
  long long index = 0;
  auto [rest, error] = std::from_chars(token.data(), end, index);
  if (error == std::errc::invalid_argument) reject_corner(token);
  for (int part = 0; part < 2 && rest != end && *rest == '/'; ++part) {
    long long unused = 0;
    const auto next = std::from_chars(rest + 1, end, unused);
    rest = next.ec == std::errc::invalid_argument ? rest + 1 : next.ptr;
  }
  if (rest != end) reject_corner(token);
  const auto count = static_cast<long long>(vertices_);
  if (error == std::errc() && index == 0) {
    fail(line_, "vertex index 0 ('" + shown_token(token) + "'): OBJ indices start at 1, relative ones at -1");
  }
  if (error == std::errc::result_out_of_range || index > static_cast<long long>(kMost) || index < -count) {
    fail(line_, "vertex index out of range ('" + shown_token(token) + "', " + std::to_string(count) +
                    " vertices so far): the file is cut short or was joined wrongly");
  }
  return static_cast<int>(index > 0 ? index - 1 : count + index);
}

void ObjStatements::reject_corner(std::string_view token) const {
  fail(line_, "not a face corner ('" + shown_token(token) +
                  "'): corners read v, v/vt, v//vn or v/vt/vn with whole numbers");
}

void ObjStatements::read_face() {
  corners_.clear();
  for (std::string_view word = token(); !word.empty(); word = token()) corners_.push_back(corner(word));
  if (corners_.size() >= 3) return;
  fail(line_, "face with too few corners (" + std::to_string(corners_.size()) +
                  ", at least 3): remove it or export again");
}

// Unknown lower-case words are extensions of one program or another; anything else is taken for a damaged
// line, because passing over a misspelt vertex would shift every index after it.
ObjStatements::Kind ObjStatements::other_kind() const {
  if (std::find(kPassedOver.begin(), kPassedOver.end(), keyword_) != kPassedOver.end()) return Kind::kOther;
  const bool word = std::all_of(keyword_.begin(), keyword_.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  });
  if (!word || keyword_[0] < 'a') {
    fail(line_, "not an OBJ statement ('" + shown_token(keyword_) +
                    "'): lines start with v, f, vt, vn, g, o, s, usemtl, ...");
  }
  return Kind::kUnknown;
}

}  // namespace hotblade::surface
