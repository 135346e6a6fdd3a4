// Walks the statements of OBJ text, each checked when it is reached, so that what reads a whole design and
// what splits one take and refuse the same text, in the same words.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hotblade::surface {

// Returns the text without its byte order mark. Throws MeshError, with `name` for the file, when it is empty,
// UTF-16 or has a NUL byte. `passed` is called now and then with the number of bytes that have been gone
// through since the last call.
[[nodiscard]] std::string_view checked_obj_text(std::string_view text, const std::string& name,
                                                const std::function<void(std::size_t)>& passed = nullptr);

class ObjStatements {
 public:
  // The largest number of vertices and corners, and the largest index.
  static constexpr std::size_t kMost = std::numeric_limits<int>::max();

  // kOther carries no polygons; kUnknown is an extension of some program, which may.
  enum class Kind { kVertex, kFace, kObject, kGroup, kOther, kUnknown, kEnd };

  // What stands before the text where it is a part of a file.
  struct Before {
    std::size_t lines = 0, vertices = 0;
  };

  // `name` is the file's name in messages, `limit` the largest coordinate taken, in the file's units. The
  // text has to outlive the walk.
  ObjStatements(std::string_view text, std::string name, double limit, Before before = {0, 0});

  // Goes to a place of the text where a statement starts.
  void seek(std::size_t offset, Before before);

  // Whether the numbers of v lines are read, or passed over because they have been checked.
  void read_numbers(bool reads) { reads_numbers_ = reads; }

  // Goes to the next statement and returns its kind; empty lines and comments are none. Throws MeshError for
  // the first that is not usable.
  Kind next();

  // Of the statement that next() has told of: the line where it starts, from 1, the place of its first byte
  // in the text, and its bytes from the keyword to the last word.
  [[nodiscard]] std::size_t line() const { return line_; }
  [[nodiscard]] std::size_t offset() const { return static_cast<std::size_t>(first_ - begin_); }
  [[nodiscard]] std::string_view bytes() const { return {first_, static_cast<std::size_t>(last_ - first_)}; }
  [[nodiscard]] std::string_view keyword() const { return keyword_; }
  // Of a vertex; of a face, as indices from 0, which may point ahead; of an object or a group, the words
  // after the keyword.
  [[nodiscard]] const Eigen::Vector3d& position() const { return position_; }
  [[nodiscard]] std::span<const int> corners() const { return corners_; }
  [[nodiscard]] const std::vector<std::string>& words() const { return words_; }

  // The number of vertices so far, those before the text included.
  [[nodiscard]] std::size_t vertices() const { return vertices_; }

  // Throws MeshError for a line.
  [[noreturn]] void fail(std::size_t line, const std::string& what) const;

 private:
  // Walks token by token.
  [[nodiscard]] bool joins_lines() const;
  void pass_line_end();
  void skip_blanks();
  std::string_view token();
  void finish_statement();

  // Read a line as nearly all are written at once: `v` and three numbers, `f` and corners without a `/`, with
  // blanks alone between them. False, and nothing done, for every other line, also for one that is refused.
  bool plain_vertex();
  bool plain_face();
  // Goes on behind the line that ends here, whose last word ends at `last`; false where more follows.
  bool take_plain_line(const char* at, const char* last);

  Kind read_statement();
  [[nodiscard]] double number(std::string_view token) const;
  [[noreturn]] void reject_number(std::string_view token) const;
  void read_vertex();
  [[nodiscard]] int corner(std::string_view token) const;
  [[noreturn]] void reject_corner(std::string_view token) const;
  void read_face();
  [[nodiscard]] Kind other_kind() const;

  std::string name_;
  double limit_;
  const char* begin_;
  const char* at_;
  const char* end_;
  const char* first_;
  const char* last_;
  std::size_t at_line_, line_ = 0, vertices_;
  bool reads_numbers_ = true;
  std::string_view keyword_;
  Eigen::Vector3d position_ = Eigen::Vector3d::Zero();
  std::vector<int> corners_;
  std::vector<std::string> words_;
};

}  // namespace hotblade::surface
