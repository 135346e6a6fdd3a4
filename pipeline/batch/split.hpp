// Splits one OBJ into panels, from its text: a mesh of the whole is never made. A panel's text holds the v
// lines that it uses, as they are written, in the order of their first use, and its polygons with renumbered
// corners; nothing of it depends on the other panels.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hotblade::pipeline::batch {

// What makes a panel: the whole file, the faces of a group's or an object's name, or faces that share
// vertices.
enum class SplitBy { kNone, kGroup, kObject, kComponent };

// Returns its word (none, group, object, component), and the other way round; absent for other words.
[[nodiscard]] std::string_view name(SplitBy by);
[[nodiscard]] std::optional<SplitBy> split_named(std::string_view word);

struct SplitOptions {
  SplitBy by = SplitBy::kNone;
  // Which name counts where a g line gives several, from 1; 0: such a line is refused.
  int group_index = 0;
  // With kNone the faces of this group or object alone; empty: all.
  std::string only{};
  double largest_coordinate = 0;                                  // taken, in the file's units
  std::string whole_name{};                                       // of the panel of kNone
  bool with_lines = false;                                        // PanelText::face_lines are wanted
  std::function<bool(const std::string& name)> wanted = nullptr;  // panels to be made; absent: all
};

struct PanelText {
  std::string name, text;
  std::size_t triangles = 0;
  double area = 0;  // in the file's units, for an estimate of work
  std::size_t lines_before_faces = 0;
  std::vector<std::size_t> face_lines{};  // of the file, of each face; empty unless asked for

  // Returns the line of the file where a face stands that a line of the text holds, both from 1; absent for
  // lines of vertices and where lines were not asked for.
  [[nodiscard]] std::optional<std::size_t> file_line(std::size_t text_line) const;
};

// Hands the panels of OBJ text to `take`, in the order of their first faces. Faces without a name are panel
// `unnamed`, and components have numbers. `read` is called now and then with the number of bytes that have
// been gone through since the last call. Throws surface::MeshError, with `file` and the line, for the first
// statement that is not usable, before any panel.
using TakePanel = std::function<void(PanelText&&)>;
using BytesRead = std::function<void(std::size_t)>;
void split_obj(std::string_view text, const std::string& file, const SplitOptions& options,
               const TakePanel& take, const BytesRead& read = nullptr);

}  // namespace hotblade::pipeline::batch
