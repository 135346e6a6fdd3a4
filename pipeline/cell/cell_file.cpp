#include "pipeline/cell/cell_file.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include "pipeline/cell/embedded.hpp"
#include "pipeline/cell/robot_names.hpp"
#include "pipeline/cell/toml_table.hpp"
#include "pipeline/sayings/saying.hpp"
#include "pipeline/settings/error.hpp"
#include "pipeline/settings/settings_fields.hpp"
#include "robot/arm/model_file.hpp"
#include "robot/arm/stl.hpp"

namespace hotblade::pipeline {
namespace {

using Eigen::Vector3d;
using robot::kJoints;

// Nothing of a cell lies farther away.
constexpr double kFarthest_mm = 1e5;
// Directions and quaternions are written with six digits or more.
constexpr double kUnitSlack = 1e-5;
// Limits nearer to the model's than this are the model's: files write radians with seven digits or more.
constexpr double kSameAngle_rad = 1e-6;

Vector3d vector_of(const std::array<double, 3>& v) {
  return {v[0], v[1], v[2]};
}

template <typename T>
void take(const std::optional<T>& value, T& place) {
  if (value) place = *value;
}

void take_range(TomlTable& table, const char* key, double least, double most, std::array<double, 2>& place) {
  take(table.numbers<2>(key, least, most), place);
  if (place[0] > place[1]) table.fail(key, "the first number is larger than the second");
}

class CellReader {
 public:
  CellReader(std::string name, std::filesystem::path folder)
      : name_(std::move(name)), folder_(std::move(folder)) {}

  robot::Cell read(const std::string& text) {
    TomlTable top = TomlTable::parse(text, name_);
    robot::Cell cell;
    auto head = top.table("cell");
    if (!head) top.fail("", "needs [cell] with a name");
    read_head(*head, cell);
    for (TomlTable& arm : top.tables("arm")) {
      cell.arms.push_back(read_arm(arm, cell.arms.size()));
      if (cell.arms.size() == 2) expect_apart(arm, cell.arms[0], cell.arms[1]);
    }
    if (cell.arms.size() != 2)
      top.fail("arm", std::to_string(cell.arms.size()) + " arms, must be two [[arm]]");
    if (auto table = top.table("table")) {
      const auto size = table->numbers<3>("size_mm", 1, kFarthest_mm);
      if (!size) table->fail("", "needs size_mm");
      cell.table_mm = vector_of(*size);
      table->expect_all_read();
    }
    if (auto plinth = top.table("plinth")) {
      take(plinth->number("inset_mm", 0, 1000), cell.plinth_inset_mm);
      plinth->expect_all_read();
    }
    read_obstacles(top, cell);
    top.expect_all_read();
    return cell;
  }

 private:
  static void read_head(TomlTable& head, robot::Cell& cell) {
    const auto name = head.text("name");
    if (!name) head.fail("", "needs a name");
    cell.name = *name;
    robot::PlaceRange& place = cell.place;
    if (const auto how = head.text("place")) {
      if (*how == "fixed") {
        place.how = robot::Placing::kFixed;
      } else if (*how == "raise") {
        place.how = robot::Placing::kRaise;
      } else if (*how == "search") {
        place.how = robot::Placing::kSearch;
      } else {
        head.fail("place", "\"" + *how + "\", must be fixed, raise or search");
      }
    }
    take_range(head, "raise_mm", 0, 3000, place.raise_mm);
    take_range(head, "place_x_mm", -3000, 3000, place.x_mm);
    take_range(head, "place_y_mm", -3000, 3000, place.y_mm);
    take(head.number("place_step_mm", 10, 3000), place.step_mm);
    take_range(head, "yaw_deg", -180, 180, place.yaw_deg);
    take(head.number("yaw_step_deg", 1, 180), place.yaw_step_deg);
    take(head.number("joint_margin_deg", 0, 60), cell.margins.joint_deg);
    take(head.number("wrist_deg", 0, 60), cell.margins.wrist_deg);
    take(head.number("elbow_deg", 0, 60), cell.margins.elbow_deg);
    take(head.number("shoulder_mm", 0, 1000), cell.margins.shoulder_mm);
    take(head.number("clearance_mm", 0, 1000), cell.clearances.others_mm);
    take(head.number("arm_clearance_mm", 0, 1000), cell.clearances.arms_mm);
    take(head.number("tool_clearance_mm", 0, 1000), cell.clearances.tool_mm);
    take(head.number("self_clearance_mm", 0, 1000), cell.clearances.self_mm);
    head.expect_all_read();
  }

  // Robot programs, and the files that they are in, are named by the arms' ids; both tasks are of one
  // controller.
  static void expect_apart(const TomlTable& arm, const robot::CellArm& first, const robot::CellArm& second) {
    if (first.id == second.id) arm.fail("id", "both arms have the id \"" + first.id + "\"");
    const std::string a = robot_name_of(first.id), b = robot_name_of(second.id);
    if (same_robot_name(a, b)) {
      arm.fail("id", "\"" + second.id + "\" beside \"" + first.id + "\": robot programs are named " + a +
                         " and " + b + ", the same to a controller");
    }
    if (same_robot_name(first.rapid.task, second.rapid.task))
      arm.fail("rapid", "both arms have the task \"" + first.rapid.task + "\"");
  }

  using Names = std::array<std::pair<const char*, std::string*>, 3>;

  // Names that stand in one space: what an arm's program declares or switches.
  static void read_names(TomlTable& table, RobotLanguage language, const Names& names) {
    for (const auto& [key, place] : names) read_name(table, language, key, *place);
    for (std::size_t i = 0; i < names.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        if (!same_robot_name(*names[i].second, *names[j].second)) continue;
        // The one that the file gives.
        const auto& [key, place] = table.has(names[i].first) ? names[i] : names[j];
        const char* other = table.has(names[i].first) ? names[j].first : names[i].first;
        table.fail(key, "\"" + *place + "\" is the name of " + other + " as well");
      }
    }
  }

  static void read_name(TomlTable& table, RobotLanguage language, const char* key, std::string& place) {
    take(table.text(key), place);
    if (const std::string fault = robot_name_fault(language, place); !fault.empty())
      table.fail(key, "\"" + place + "\" " + fault);
  }

  robot::CellArm read_arm(TomlTable& arm, std::size_t index) const {
    const auto id = arm.text("id");
    if (!id) arm.fail("", "needs an id");
    if (id->size() > kLongestArmId) {
      arm.fail("id", std::to_string(id->size()) + " bytes (limit " + std::to_string(kLongestArmId) +
                         "): robot programs are named by it");
    }
    const auto model = arm.text("model");
    if (!model) arm.fail("", "needs a model: the path of a URDF");
    auto [text, description] = model_of(arm, *model);
    robot::CellArm found{*id, *model, std::move(text), std::move(description), {}, 0.8, {}, true, {}, {},
                         {},  {}};
    auto base = arm.table("base");
    if (!base) arm.fail("", "needs a base");
    found.base = read_pose(*base);
    read_speeds(arm, found);
    found.model.arm = limited(arm, found.model.arm);
    if (auto tool = arm.table("tool")) found.tool = read_tool(*tool);
    found.rapid.task = "T_ROB" + std::to_string(index + 1);
    if (auto rapid = arm.table("rapid")) {
      robot::RapidNames& names = found.rapid;
      read_name(*rapid, RobotLanguage::kRapid, "task", names.task);
      read_names(*rapid, RobotLanguage::kRapid,
                 {{{"tool", &names.tool}, {"wobj", &names.wobj}, {"heat", &names.heat}}});
      rapid->expect_all_read();
    }
    if (auto krl = arm.table("krl")) {
      take(krl->whole("tool", 1, 128), found.krl.tool);
      take(krl->whole("base", 0, 128), found.krl.base);
      robot::KrlNames& names = found.krl;
      read_names(*krl, RobotLanguage::kKrl,
                 {{{"heat", &names.heat}, {"ready_out", &names.ready_out}, {"ready_in", &names.ready_in}}});
      krl->expect_all_read();
    }
    arm.expect_all_read();
    return found;
  }

  // The description beside the cell's file, else one that the program brings.
  std::pair<std::string, robot::ArmModel> model_of(const TomlTable& arm, const std::string& model) const {
    try {
      const std::filesystem::path file = folder_ / model;
      std::error_code code;
      if (std::filesystem::exists(file, code)) {
        std::string text = robot::read_model_file(file);
        robot::ArmModel parsed = robot::parse_urdf(text, file.string(), file.parent_path());
        return {std::move(text), std::move(parsed)};
      }
      for (const EmbeddedFile& embedded : embedded_files()) {
        if (model == embedded.path) return {embedded.text, robot::parse_urdf(embedded.text, model, {})};
      }
    } catch (const robot::ModelError& error) {
      throw Error(error.missing ? ErrorKind::kFile : ErrorKind::kBadInput, error.what());
    }
    try {
      arm.fail(
          "model",
          "\"" + model + "\" is neither beside the cell's file nor among the arms that the program brings");
    } catch (const Error& error) {
      throw Error(ErrorKind::kFile, error.what());
    }
  }

  static Eigen::Quaterniond read_turn(TomlTable& table) {
    const auto yaw = table.number("yaw_deg", -360, 360);
    const auto q = table.numbers<4>("q", -1.1, 1.1);
    if (yaw && q) table.fail("q", "given with yaw_deg, must stand alone");
    if (yaw) return Eigen::Quaterniond(Eigen::AngleAxisd(*yaw * robot::kDegree_rad, Vector3d::UnitZ()));
    if (!q) return Eigen::Quaterniond::Identity();
    const Eigen::Quaterniond turn((*q)[0], (*q)[1], (*q)[2], (*q)[3]);
    if (!(std::abs(turn.norm() - 1) <= kUnitSlack))
      table.fail("q", "length " + number_text(turn.norm()) + ", must be 1: [w, x, y, z]");
    // One that is written with all digits stays as it is.
    return std::abs(turn.squaredNorm() - 1) <= 1e-15 ? turn : turn.normalized();
  }

  static robot::Pose read_pose(TomlTable& table) {
    robot::Pose pose;
    if (const auto p = table.numbers<3>("p", -kFarthest_mm, kFarthest_mm)) pose.p = vector_of(*p);
    pose.q = read_turn(table);
    table.expect_all_read();
    return pose;
  }

  static void read_speeds(TomlTable& arm, robot::CellArm& found) {
    take(arm.number("speed_share", 0.01, 1), found.speed_share);
    found.acceleration_rad_s2 = {1.5, 1.0, 1.5, 8, 8, 8};
    found.acceleration_assumed = !arm.has("acceleration_rad_s2");
    take(arm.numbers<kJoints>("acceleration_rad_s2", 0.01, 1000), found.acceleration_rad_s2);
    // A drive that builds its acceleration up in a tenth of a second.
    for (std::size_t i = 0; i < kJoints; ++i) found.jerk_rad_s3[i] = 10 * found.acceleration_rad_s2[i];
    take(arm.numbers<kJoints>("jerk_rad_s3", 0.1, 100000), found.jerk_rad_s3);
  }

  // The arm with the cell's limits, which may only be narrower than the maker's.
  static robot::Arm limited(TomlTable& table, const robot::Arm& arm) {
    robot::JointAngles least, most;
    const auto min_deg = table.numbers<kJoints>("min_deg", -1e5, 1e5);
    const auto max_deg = table.numbers<kJoints>("max_deg", -1e5, 1e5);
    for (std::size_t i = 0; i < kJoints; ++i) {
      const robot::Joint& joint = arm.joints()[i];
      const auto k = static_cast<int>(i);
      least[k] = min_deg ? (*min_deg)[i] * robot::kDegree_rad : joint.min_rad;
      most[k] = max_deg ? (*max_deg)[i] * robot::kDegree_rad : joint.max_rad;
      if (std::abs(least[k] - joint.min_rad) <= kSameAngle_rad) least[k] = joint.min_rad;
      if (std::abs(most[k] - joint.max_rad) <= kSameAngle_rad) most[k] = joint.max_rad;
      const std::string of_model = joint.name + ": the model has ";
      if (least[k] < joint.min_rad)
        table.fail("min_deg", number_text((*min_deg)[i]) + " of " + of_model +
                                  number_text(joint.min_rad / robot::kDegree_rad));
      if (most[k] > joint.max_rad)
        table.fail("max_deg", number_text((*max_deg)[i]) + " of " + of_model +
                                  number_text(joint.max_rad / robot::kDegree_rad));
      if (!(least[k] < most[k]))
        table.fail(min_deg ? "min_deg" : "max_deg", joint.name + ": least not below largest");
    }
    return arm.with_limits(least, most);
  }

  robot::ArmTool read_tool(TomlTable& table) const {
    robot::ArmTool tool;
    if (auto jaw = table.table("jaw")) {
      if (const auto p = jaw->numbers<3>("p", -kFarthest_mm, kFarthest_mm)) tool.jaw_p_mm = vector_of(*p);
      if (const auto x = jaw->numbers<3>("x", -1.1, 1.1)) tool.jaw_x = vector_of(*x);
      if (const auto y = jaw->numbers<3>("y", -1.1, 1.1)) tool.jaw_y = vector_of(*y);
      if (!(std::abs(tool.jaw_x.norm() - 1) <= kUnitSlack)) jaw->fail("x", "must have length 1");
      if (!(std::abs(tool.jaw_y.norm() - 1) <= kUnitSlack)) jaw->fail("y", "must have length 1");
      if (!(std::abs(tool.jaw_x.dot(tool.jaw_y)) <= kUnitSlack)) jaw->fail("y", "must be square to x");
      if (std::abs(tool.jaw_x.squaredNorm() - 1) > 1e-15) tool.jaw_x.normalize();
      const Vector3d square = tool.jaw_y - tool.jaw_x.dot(tool.jaw_y) * tool.jaw_x;
      if (std::abs(tool.jaw_y.squaredNorm() - 1) > 1e-15 || std::abs(tool.jaw_x.dot(tool.jaw_y)) > 1e-15)
        tool.jaw_y = square.normalized();
      jaw->expect_all_read();
    }
    take(table.flag("flip"), tool.flip);
    for (TomlTable& box : table.tables("boxes")) {
      tool.shapes.push_back(read_shape(box));
      if (const auto centre = box.numbers<3>("centre", -kFarthest_mm, kFarthest_mm))
        tool.shapes.back().place.translation() = vector_of(*centre);
      box.expect_all_read();
    }
    take(table.number("mass_kg", 0, 1000), tool.mass_kg);
    if (const auto cog = table.numbers<3>("cog_mm", -10000, 10000)) tool.cog_mm = vector_of(*cog);
    table.expect_all_read();
    return tool;
  }

  // A box by its size, or a mesh by its file.
  robot::Shape read_shape(TomlTable& table) const {
    const auto size = table.numbers<3>("size_mm", 0.001, kFarthest_mm);
    const auto mesh = table.text("mesh");
    if (size.has_value() == mesh.has_value()) table.fail("", "needs size_mm or mesh, one of them");
    robot::Shape shape;
    if (size) {
      shape.solid = robot::Box{vector_of(*size)};
      return shape;
    }
    try {
      shape.solid = robot::Mesh{*mesh, robot::read_stl(folder_ / *mesh, Vector3d::Ones())};
    } catch (const robot::ModelError& error) {
      throw Error(error.missing ? ErrorKind::kFile : ErrorKind::kBadInput, error.what());
    }
    return shape;
  }

  void read_obstacles(TomlTable& top, robot::Cell& cell) const {
    std::set<std::string> ids;
    for (TomlTable& table : top.tables("obstacle")) {
      robot::Obstacle obstacle;
      const auto id = table.text("id");
      if (!id) table.fail("", "needs an id");
      if (!ids.insert(*id).second) table.fail("id", "a second obstacle \"" + *id + "\"");
      obstacle.id = *id;
      obstacle.shape = read_shape(table);
      auto at = table.table("at");
      if (!at) table.fail("", "needs at, the place of its middle");
      obstacle.at = read_pose(*at);
      table.expect_all_read();
      cell.obstacles.push_back(std::move(obstacle));
    }
  }

  std::string name_;
  std::filesystem::path folder_;
};

constexpr std::string_view kCells = "cells/", kToml = ".toml";

}  // namespace

robot::Cell parse_cell(const std::string& text, const std::string& name,
                       const std::filesystem::path& folder) {
  return CellReader(name, folder).read(text);
}

std::vector<std::string> embedded_cells() {
  std::vector<std::string> names;
  for (const EmbeddedFile& file : embedded_files()) {
    std::string_view path = file.path;
    if (!path.starts_with(kCells)) continue;
    path.remove_prefix(kCells.size());
    path.remove_suffix(kToml.size());
    names.emplace_back(path);
  }
  return names;
}

robot::Cell read_cell(const std::string& file_or_name) {
  std::error_code code;
  if (!std::filesystem::exists(file_or_name, code)) {
    for (const EmbeddedFile& file : embedded_files()) {
      if (file.path == std::string(kCells) + file_or_name + std::string(kToml))
        return parse_cell(file.text, file_or_name, {});
    }
  }
  std::string text;
  try {
    text = robot::read_model_file(file_or_name);
  } catch (const robot::ModelError& error) {
    if (!error.missing) throw Error(ErrorKind::kBadSettings, error.what());
    std::string names;
    for (const std::string& name : embedded_cells()) names += (names.empty() ? "" : ", ") + name;
    throw Error(ErrorKind::kFile, std::string(error.what()) + " Cells that need no file: " + names);
  }
  return parse_cell(text, file_or_name, std::filesystem::path(file_or_name).parent_path());
}

std::vector<std::string> warnings(const robot::Cell& cell) {
  std::vector<std::string> lines;
  for (const robot::CellArm& arm : cell.arms) {
    if (arm.acceleration_assumed) lines.push_back(say(Saying::kAccelerationsAssumed, {arm.id}));
    if (arm.tool.shapes.empty()) lines.push_back(say(Saying::kToolHasNoShape, {arm.id}));
    if (!arm.model.shapeless.empty()) {
      lines.push_back(
          say(Saying::kLinksHaveNoShape, {arm.id, fmt::format("{}", fmt::join(arm.model.shapeless, ", "))}));
    }
  }
  if (!cell.table_mm) lines.push_back(say(Saying::kNoTable));
  return lines;
}

}  // namespace hotblade::pipeline
