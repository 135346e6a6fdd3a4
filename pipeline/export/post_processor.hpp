// Robot programs from a vendor-neutral job: one interface, one implementation a controller language.
//
// Both arms run one program each and have to stay together within a waypoint's time. Every target keeps
// positions in the cell frame as the arms' common work object, tool centre point in the clamp's jaw with x
// along the blade from A to B, y in the blade's plane; the heat on an output of arm A; a halt between
// strips. None of these programs has been run on hardware: signals, tool and work object have to be set to
// those of the cell.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "pipeline/export/exported_file.hpp"
#include "pipeline/program/program.hpp"

namespace hotblade::pipeline {

struct RobotStrip {
  std::string id;
  double blade_length_mm = 0;
  std::vector<robot::Waypoint> path;  // cell frame, at least 2
};

struct RobotJob {
  std::string created_by, design;
  std::vector<RobotStrip> strips;
};

// The job of a program, its waypoints in the cell frame.
[[nodiscard]] RobotJob robot_job(const Program& program);

class PostProcessor {
 public:
  virtual ~PostProcessor() = default;
  // All files of the job; the same job gives the same text.
  [[nodiscard]] virtual std::vector<ExportedFile> files(const RobotJob& job) const = 0;
};

// The post processor of a target, nullptr when there is none. "rapid" is ABB RAPID with MultiMove,
// synchronised moves with the same \ID in both tasks; "krl" is KUKA KRL, a spline a strip with its times in
// a time block, started together by signals.
[[nodiscard]] std::unique_ptr<PostProcessor> post_processor(const std::string& target);

}  // namespace hotblade::pipeline
