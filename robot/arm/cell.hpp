// A cell: two arms on their bases, the jaw that each holds the blade with, and what stands around them. mm,
// rad, s; the cell's frame has the table's top at z = 0 and z up.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "robot/arm/shape.hpp"
#include "robot/arm/urdf.hpp"
#include "robot/pose/pose.hpp"

namespace hotblade::robot {

// What may be done to a block's place to bring it within reach: nothing, raising it, or raising, moving and
// turning it.
enum class Placing { kFixed, kRaise, kSearch };

struct PlaceRange {
  Placing how = Placing::kRaise;
  std::array<double, 2> raise_mm{0, 400};  // on top of the plinth
  std::array<double, 2> x_mm{-300, 300}, y_mm{-300, 300};
  double step_mm = 150;
  std::array<double, 2> yaw_deg{-180, 180};
  double yaw_step_deg = 15;
};

// What joints keep from their limits and from singular poses.
struct ArmMargins {
  double joint_deg = 3;
  double wrist_deg = 5;     // between axes 4 and 6
  double elbow_deg = 5;     // from stretched or folded
  double shoulder_mm = 60;  // of the wrist's centre from axis 1
};

struct Clearances {
  double others_mm = 20;  // of every pair not named
  double arms_mm = 50;
  double tool_mm = 10;  // of a tool from block and plinth
  double self_mm = 5;
};

// What an arm holds the blade with, in the flange's frame (tool0).
struct ArmTool {
  // Where the blade leaves the jaw: x the way it leaves, y across its thickness, z across its width.
  Eigen::Vector3d jaw_p_mm{0, 0, 250}, jaw_x{0, 0, 1}, jaw_y{0, 1, 0};
  bool flip = true;  // the jaw may hold the blade turned by 180 degrees about x
  std::vector<Shape> shapes;
  double mass_kg = 6;
  Eigen::Vector3d cog_mm{0, 0, 110};
};

// Returns the jaw in the flange's frame.
[[nodiscard]] Eigen::Isometry3d jaw_in_flange(const ArmTool& tool);

// What the maker's software calls the task, the tool, the frame of the poses and the blade's output, which
// the first arm switches.
struct RapidNames {
  std::string task, tool = "hb_clamp", wobj = "hb_cell", heat = "hb_heat";
};
// Arms say by `ready_out` that they are there, and hear it of each other by `ready_in`.
struct KrlNames {
  int tool = 1, base = 1;
  std::string heat = "hb_heat", ready_out = "hb_ready_out", ready_in = "hb_ready_in";
};

struct CellArm {
  std::string id;
  std::string model_file;  // as the cell names it
  std::string model_text;  // of the URDF, whose hash programs carry
  ArmModel model;          // with the cell's limits
  Pose base{};             // of base_link in the cell
  double speed_share = 0.8;
  std::array<double, kJoints> acceleration_rad_s2{1.5, 1.0, 1.5, 8, 8, 8};
  bool acceleration_assumed = true;
  std::array<double, kJoints> jerk_rad_s3{15, 10, 15, 80, 80, 80};
  ArmTool tool{};
  RapidNames rapid{};
  KrlNames krl{};
};

struct Obstacle {
  std::string id;
  Pose at;
  Shape shape;  // in its own frame
};

struct Cell {
  std::string name;
  PlaceRange place;
  ArmMargins margins;
  Clearances clearances;
  std::vector<CellArm> arms;  // two
  std::optional<Eigen::Vector3d> table_mm;
  double plinth_inset_mm = 30;
  std::vector<Obstacle> obstacles;
};

}  // namespace hotblade::robot
