#include "surface/read/obj_parts.hpp"

#include <algorithm>
#include <atomic>
#include <cstring>

#include "surface/read/blocks.hpp"
#include "surface/read/words.hpp"

namespace hotblade::surface {
namespace {

const char* find(const char* from, const char* end, char wanted) {
  const void* found = std::memchr(from, wanted, static_cast<std::size_t>(end - from));
  return found ? static_cast<const char*>(found) : end;
}

// Does every line end with LF or CR LF, and none go on after its end?
bool has_plain_lines(std::string_view part) {
  const char *from = part.data(), *end = from + part.size();
  if (find(from, end, '\\') != end) return false;
  for (const char* at = find(from, end, '\r'); at != end; at = find(at + 1, end, '\r'))
    if (at + 1 == end || at[1] != '\n') return false;
  return true;
}

// The words from here to the end of the line or to a comment.
std::size_t words_in(const char* at, const char* end) {
  std::size_t words = 0;
  for (;;) {
    while (at != end && is_blank(*at)) ++at;
    if (at == end || *at == '#') return words;
    ++words;
    while (at != end && !is_blank(*at)) ++at;
  }
}

// Counts a line, without its end, as ObjStatements takes it.
void count_line(std::string_view text, const char* at, const char* end, ObjPart& part) {
  if (end - at > 1 && at[0] == 'v' && at[1] == ' ') {
    ++part.vertices;
    return;
  }
  while (at != end && is_blank(*at)) ++at;
  const char* keyword = at;
  while (at != end && !is_blank(*at)) ++at;
  const std::string_view word(keyword, static_cast<std::size_t>(at - keyword));
  if (word == "v") {
    ++part.vertices;
  } else if (word == "f" || word == "fo") {
    ++part.faces;
    part.corners += words_in(at, end);
  } else if (word == "g" || word == "o") {
    part.names.push_back(static_cast<std::size_t>(keyword - text.data()));
  }
}

void count(std::string_view text, ObjPart& part) {
  const char *at = text.data() + part.begin, *end = text.data() + part.end;
  while (at != end) {
    const char* line_end = find(at, end, '\n');
    const bool ends = line_end != end;
    const char* last = ends && line_end != at && line_end[-1] == '\r' ? line_end - 1 : line_end;
    count_line(text, at, last, part);
    part.lines += ends ? 1U : 0U;
    at = ends ? line_end + 1 : end;
  }
}

std::vector<ObjPart> cut_at_lines(std::string_view text, std::size_t bytes) {
  std::vector<ObjPart> parts;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t line_end = text.find('\n', std::min(text.size(), begin + bytes));
    const std::size_t end = line_end == std::string_view::npos ? text.size() : line_end + 1;
    parts.emplace_back();
    parts.back().begin = begin;
    parts.back().end = begin = end;
  }
  return parts;
}

}  // namespace

std::optional<std::vector<ObjPart>> obj_parts(std::string_view text, std::size_t bytes) {
  std::vector<ObjPart> parts = cut_at_lines(text, bytes);
  std::atomic<bool> plain = true;
  for_blocks(parts.size(), 1, [&](std::size_t first, std::size_t) {
    ObjPart& part = parts[first];
    if (!plain) return;
    if (has_plain_lines(text.substr(part.begin, part.end - part.begin))) return count(text, part);
    plain = false;
  });
  if (!plain) return std::nullopt;
  ObjPart all;
  for (ObjPart& part : parts) {
    part.before = all.before;
    part.faces_before = all.faces_before;
    part.corners_before = all.corners_before;
    all.before.lines += part.lines;
    all.before.vertices += part.vertices;
    all.faces_before += part.faces;
    all.corners_before += part.corners;
  }
  if (std::max({all.before.vertices, all.faces_before, all.corners_before}) > ObjStatements::kMost)
    return std::nullopt;
  return parts;
}

}  // namespace hotblade::surface
