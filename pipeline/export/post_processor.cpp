#include "pipeline/export/post_processor.hpp"

#include "pipeline/export/robot_languages.hpp"

namespace hotblade::pipeline {

RobotJob robot_job(const Program& program) {
  RobotJob job{program.created_by, program.design.file, {}};
  for (const Strip& strip : program.strips) {
    job.strips.push_back({strip.id, strip.blade_length_mm, waypoints(strip)});
  }
  return job;
}

std::unique_ptr<PostProcessor> post_processor(const std::string& target) {
  if (target == "rapid") return std::make_unique<RapidPostProcessor>();
  if (target == "krl") return std::make_unique<KrlPostProcessor>();
  return nullptr;
}

}  // namespace hotblade::pipeline
