// A cell written out as TOML.
#include "pipeline/cell/cell_file.hpp"
#include "pipeline/settings/settings_fields.hpp"

namespace hotblade::pipeline {
namespace {

template <typename Numbers>
std::string list(const Numbers& numbers) {
  std::string text = "[";
  for (const double v : numbers) text += (text.size() > 1 ? ", " : "") + number_text(v);
  return text + "]";
}

std::string list(const Eigen::Vector3d& v) {
  return list(std::array{v.x(), v.y(), v.z()});
}

std::string pose(const robot::Pose& p) {
  return "{ p = " + list(p.p) + ", q = " + list(std::array{p.q.w(), p.q.x(), p.q.y(), p.q.z()}) + " }";
}

std::string size_or_mesh(const robot::Shape& shape) {
  if (const auto* box = std::get_if<robot::Box>(&shape.solid)) return "size_mm = " + list(box->size_mm);
  return "mesh = " + toml_string(std::get<robot::Mesh>(shape.solid).file);
}

const char* word(robot::Placing how) {
  if (how == robot::Placing::kFixed) return "fixed";
  return how == robot::Placing::kRaise ? "raise" : "search";
}

std::string limits(const robot::Arm& arm, double robot::Joint::*limit) {
  std::array<double, robot::kJoints> degrees;
  for (std::size_t i = 0; i < robot::kJoints; ++i) degrees[i] = arm.joints()[i].*limit / robot::kDegree_rad;
  return list(degrees);
}

std::string tool_text(const robot::ArmTool& tool) {
  std::string text = "[arm.tool]\njaw = { p = " + list(tool.jaw_p_mm) + ", x = " + list(tool.jaw_x) +
                     ", y = " + list(tool.jaw_y) + " }\nflip = " + (tool.flip ? "true" : "false") +
                     "\nboxes = [";
  for (const robot::Shape& shape : tool.shapes) {
    text += "\n  { " + size_or_mesh(shape) +
            ", centre = " + list(Eigen::Vector3d(shape.place.translation())) + " },";
  }
  return text + (tool.shapes.empty() ? "" : "\n") + "]\nmass_kg = " + number_text(tool.mass_kg) +
         "\ncog_mm = " + list(tool.cog_mm) + "\n";
}

std::string arm_text(const robot::CellArm& arm) {
  std::string text = "\n[[arm]]\nid = " + toml_string(arm.id) + "\nmodel = " + toml_string(arm.model_file) +
                     "\nbase = " + pose(arm.base) + "\nspeed_share = " + number_text(arm.speed_share) + "\n";
  // An assumption stays one: written out as a figure it would be the user's.
  text += std::string(arm.acceleration_assumed ? "# assumed: " : "") +
          "acceleration_rad_s2 = " + list(arm.acceleration_rad_s2) +
          "\njerk_rad_s3 = " + list(arm.jerk_rad_s3) + "\n";
  text += "min_deg = " + limits(arm.model.arm, &robot::Joint::min_rad) +
          "\nmax_deg = " + limits(arm.model.arm, &robot::Joint::max_rad) + "\n" + tool_text(arm.tool);
  text += "[arm.rapid]\ntask = " + toml_string(arm.rapid.task) + "\ntool = " + toml_string(arm.rapid.tool) +
          "\nwobj = " + toml_string(arm.rapid.wobj) + "\nheat = " + toml_string(arm.rapid.heat) + "\n";
  return text + "[arm.krl]\ntool = " + std::to_string(arm.krl.tool) +
         "\nbase = " + std::to_string(arm.krl.base) + "\nheat = " + toml_string(arm.krl.heat) +
         "\nready_out = " + toml_string(arm.krl.ready_out) + "\nready_in = " + toml_string(arm.krl.ready_in) +
         "\n";
}

}  // namespace

std::string to_toml(const robot::Cell& cell) {
  std::string text =
      "[cell]\nname = " + toml_string(cell.name) + "\nplace = \"" + word(cell.place.how) + "\"\n";
  const auto line = [&text](const char* key, const std::string& value) {
    text += std::string(key) + " = " + value + "\n";
  };
  line("raise_mm", list(cell.place.raise_mm));
  line("place_x_mm", list(cell.place.x_mm));
  line("place_y_mm", list(cell.place.y_mm));
  line("place_step_mm", number_text(cell.place.step_mm));
  line("yaw_deg", list(cell.place.yaw_deg));
  line("yaw_step_deg", number_text(cell.place.yaw_step_deg));
  line("joint_margin_deg", number_text(cell.margins.joint_deg));
  line("wrist_deg", number_text(cell.margins.wrist_deg));
  line("elbow_deg", number_text(cell.margins.elbow_deg));
  line("shoulder_mm", number_text(cell.margins.shoulder_mm));
  line("clearance_mm", number_text(cell.clearances.others_mm));
  line("arm_clearance_mm", number_text(cell.clearances.arms_mm));
  line("tool_clearance_mm", number_text(cell.clearances.tool_mm));
  line("self_clearance_mm", number_text(cell.clearances.self_mm));
  for (const robot::CellArm& arm : cell.arms) text += arm_text(arm);
  if (cell.table_mm) text += "\n[table]\nsize_mm = " + list(*cell.table_mm) + "\n";
  text += "\n[plinth]\ninset_mm = " + number_text(cell.plinth_inset_mm) + "\n";
  for (const robot::Obstacle& obstacle : cell.obstacles) {
    text += "\n[[obstacle]]\nid = " + toml_string(obstacle.id) + "\n" + size_or_mesh(obstacle.shape) +
            "\nat = " + pose(obstacle.at) + "\n";
  }
  return text;
}

}  // namespace hotblade::pipeline
