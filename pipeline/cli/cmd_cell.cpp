// hotblade cell: shows and checks cells of two arms.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

#include "pipeline/cell/cell_file.hpp"
#include "pipeline/cli/command.hpp"

namespace hotblade::pipeline {
namespace {

std::size_t triangles_of(const robot::ArmModel& model) {
  std::size_t count = 0;
  for (const robot::Body& body : model.bodies) {
    for (const robot::Shape& shape : body.shapes) {
      if (const auto* mesh = std::get_if<robot::Mesh>(&shape.solid)) count += mesh->triangles.size();
    }
  }
  return count;
}

std::size_t shapes_of(const robot::ArmModel& model) {
  std::size_t count = 0;
  for (const robot::Body& body : model.bodies) count += body.shapes.size();
  return count;
}

// What a data sheet says, to hold against it.
std::string facts(const robot::CellArm& arm) {
  const robot::Arm& a = arm.model.arm;
  const robot::ArmLengths l = a.lengths();
  const Eigen::Isometry3d& home = a.flange_at_zero();
  const Eigen::Quaterniond q(home.linear());
  const robot::Reach reach = robot::reach(a, home);
  std::string text = fmt::format("# arm {}: {}\n", arm.id, a.name());
  text += fmt::format(
      "#   lengths a1 {:.6g}, a2 {:.6g}, b {:.6g}, c1 {:.6g}, c2 {:.6g}, c3 {:.6g}, c4 {:.6g} mm\n", l.a1,
      l.a2, l.b, l.c1, l.c2, l.c3, l.c4);
  text += fmt::format("#   reach of the wrist's centre from axis 2: {:.6g} to {:.6g} mm\n", reach.least_mm,
                      reach.most_mm);
  text += fmt::format(
      "#   flange at zero: p ({:.6g}, {:.6g}, {:.6g}) mm, q ({:.6g}, {:.6g}, {:.6g}, {:.6g})\n",
      home.translation().x(), home.translation().y(), home.translation().z(), q.w(), q.x(), q.y(), q.z());
  for (const robot::Joint& joint : a.joints()) {
    text += fmt::format("#   {}: {:.6g} to {:.6g} deg, {:.6g} deg/s\n", joint.name,
                        joint.min_rad / robot::kDegree_rad, joint.max_rad / robot::kDegree_rad,
                        joint.speed_rad_s / robot::kDegree_rad);
  }
  text += fmt::format("#   bodies {}, shapes {}, triangles {}\n", arm.model.bodies.size(),
                      shapes_of(arm.model), triangles_of(arm.model));
  if (!a.exact()) text += "#   axes rounded in the file: joints are found by Newton steps\n";
  for (const std::string& what : arm.model.ignored) text += "#   not read: " + what + "\n";
  return text;
}

Exit show(const std::string& name, const Console& console) {
  const robot::Cell cell = read_cell(name);
  for (const std::string& line : warnings(cell)) console.warn("warning: " + line);
  for (const robot::CellArm& arm : cell.arms) std::cout << facts(arm);
  std::cout << to_toml(cell);
  return Exit::kOk;
}

// All files are looked at; one that cannot be read outweighs a wrong one.
Exit validate_cells(const std::vector<std::string>& names, const Console& console) {
  Exit result = Exit::kOk;
  for (const std::string& name : names) {
    try {
      for (const std::string& line : warnings(read_cell(name))) console.warn(name + ": warning: " + line);
      std::cout << name << ": ok\n";
    } catch (const Error& error) {
      console.warn(error.what());
      result = std::max(result, exit_of(error.kind));
    }
  }
  return result;
}

}  // namespace

void add_cell(CLI::App& app, const Console& console, Action& action) {
  auto* cell = app.add_subcommand("cell", "Show and check cells of two arms");
  cell->require_subcommand(1);
  cell->footer("Example: hotblade cell show two_irb4600 > cell.toml");

  auto name = std::make_shared<std::string>(embedded_cells().front());
  auto* show_command =
      cell->add_subcommand("show", "Print a cell with every value, as TOML, and its arms' lengths");
  show_command->add_option("cell", *name, "A cell's TOML file, or two_irb4600 or two_kr50, which need none")
      ->type_name("CELL");
  show_command->footer("Without CELL: two_irb4600.\nExample: hotblade cell show cell.toml");
  show_command->callback(
      [name, &console, &action] { action = [name, &console] { return show(*name, console); }; });

  auto names = std::make_shared<std::vector<std::string>>();
  auto* validate_command = cell->add_subcommand(
      "validate", "Check cells: exit 0 when all are good, 2 for a cell, 3 for an arm or mesh");
  validate_command->add_option("cells", *names, "TOML files")->required()->type_name("CELL");
  validate_command->footer("Example: hotblade cell validate cell.toml");
  validate_command->callback(
      [names, &console, &action] { action = [names, &console] { return validate_cells(*names, console); }; });
}

}  // namespace hotblade::pipeline
