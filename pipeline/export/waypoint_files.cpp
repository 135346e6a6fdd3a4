#include "pipeline/export/waypoint_files.hpp"

#include <fmt/format.h>

#include <iterator>
#include <nlohmann/json.hpp>
#include <numbers>

#include "pipeline/settings/error.hpp"
#include "pipeline/settings/json_text.hpp"

namespace hotblade::pipeline {

namespace {

using Json = nlohmann::ordered_json;

// A waypoint's times are whole ones, s.
constexpr double kMicrosecond = 1e-6;

std::string pose_cells(const Pose& pose) {
  return fmt::format("{:.6f},{:.6f},{:.6f},{:.12f},{:.12f},{:.12f},{:.12f}", pose.p.x(), pose.p.y(),
                     pose.p.z(), pose.q.w(), pose.q.x(), pose.q.y(), pose.q.z());
}

Json array(const Eigen::Vector3d& v) {
  return Json::array({v.x(), v.y(), v.z()});
}

Json compas_frame(const Pose& pose) {
  const Eigen::Matrix3d axes = pose.q.toRotationMatrix();
  return {{"dtype", "compas.geometry/Frame"},
          {"data", {{"point", array(pose.p)}, {"xaxis", array(axes.col(0))}, {"yaxis", array(axes.col(1))}}}};
}

// COMPAS puts a box's frame into its centre.
Json compas_box(const Strip& strip) {
  const Frame& f = strip.block.frame;
  const Eigen::Vector3d half = 0.5 * strip.block.size_mm;
  Eigen::Matrix3d axes;
  axes << f.x, f.y, f.normal();
  const Pose in_design{f.point(half.x(), half.y(), half.z()), Eigen::Quaterniond(axes)};
  return {{"dtype", "compas.geometry/Box"},
          {"data",
           {{"xsize", strip.block.size_mm.x()},
            {"ysize", strip.block.size_mm.y()},
            {"zsize", strip.block.size_mm.z()},
            {"frame", compas_frame(robot::transformed(strip.design_to_cell, in_design))["data"]}}}};
}

}  // namespace

std::vector<ExportedFile> waypoint_csv(const Program& program) {
  std::vector<ExportedFile> files;
  for (const Strip& strip : program.strips) {
    std::string text =
        "index,t_s,phase,heat,ax_mm,ay_mm,az_mm,aqw,aqx,aqy,aqz,bx_mm,by_mm,bz_mm,bqw,bqx,bqy,bqz\n";
    const std::vector<robot::Waypoint> path = waypoints(strip);
    for (std::size_t i = 0; i < path.size(); ++i) {
      fmt::format_to(std::back_inserter(text), "{},{:.6f},{},{},{},{}\n", i, kMicrosecond * path[i].t_us,
                     name(strip.poses[i].phase), path[i].heat ? 1 : 0, pose_cells(path[i].a),
                     pose_cells(path[i].b));
    }
    files.push_back({strip.id + ".csv", text});
  }
  return files;
}

std::vector<ExportedFile> joints_csv(const Program& program) {
  if (!program.cell) throw Error(ErrorKind::kBadInput, "the program has no joints: plan it with --cell");
  constexpr double kDegrees = 180 / std::numbers::pi;
  std::vector<ExportedFile> files;
  for (const Strip& strip : program.strips) {
    std::string text = "index,t_s,phase,heat";
    for (const char clamp : {'a', 'b'}) {
      for (std::size_t i = 1; i <= kArmJoints; ++i) text += fmt::format(",{}{}_deg", clamp, i);
    }
    text += "\n";
    const std::vector<robot::Waypoint> path = waypoints(strip);
    for (std::size_t i = 0; i < path.size(); ++i) {
      const BladePose& pose = strip.poses[i];
      fmt::format_to(std::back_inserter(text), "{},{:.6f},{},{}", i, kMicrosecond * path[i].t_us,
                     name(pose.phase), pose.heat ? 1 : 0);
      for (const ArmJoints* joints : {&strip.joints[i].a, &strip.joints[i].b}) {
        for (const double q : *joints) fmt::format_to(std::back_inserter(text), ",{:.9f}", q * kDegrees);
      }
      text += "\n";
    }
    files.push_back({strip.id + "_joints.csv", text});
  }
  return files;
}

std::vector<ExportedFile> waypoint_compas(const Program& program) {
  std::vector<ExportedFile> files;
  for (const Strip& strip : program.strips) {
    Json times = Json::array(), phases = Json::array(), heat = Json::array(), a = Json::array(),
         b = Json::array();
    const std::vector<robot::Waypoint> path = waypoints(strip);
    for (std::size_t i = 0; i < path.size(); ++i) {
      times.push_back(kMicrosecond * path[i].t_us);
      phases.push_back(name(strip.poses[i].phase));
      heat.push_back(path[i].heat);
      a.push_back(compas_frame(path[i].a));
      b.push_back(compas_frame(path[i].b));
    }
    const Json job{{"created_by", program.created_by},
                   {"design", program.design.file},
                   {"strip", strip.id},
                   {"units", "mm"},
                   {"blade_length_mm", strip.blade_length_mm},
                   {"stock", compas_box(strip)},
                   {"times_s", times},
                   {"phases", phases},
                   {"heat", heat},
                   {"clamp_a", a},
                   {"clamp_b", b}};
    files.push_back({strip.id + ".json", json_text(job) + "\n"});
  }
  return files;
}

}  // namespace hotblade::pipeline
