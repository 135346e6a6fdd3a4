#include "pipeline/cli/controller_cell.hpp"

#include <map>
#include <utility>
#include <vector>

#include "pipeline/cell/cell_file.hpp"
#include "pipeline/plan/arms/arms.hpp"
#include "pipeline/plan/arms/strip_clearance.hpp"

namespace hotblade::pipeline {

std::shared_ptr<const robot::ArmCell> controller_cell(const std::string& file_or_name,
                                                      const MotionSettings& motion, const StripJobs* work) {
  if (file_or_name.empty()) return nullptr;
  robot::Cell cell = read_cell(file_or_name);
  std::map<std::uint64_t, std::vector<robot::Standing>> blocks;
  for (std::size_t i = 0; work != nullptr && i < work->jobs.size(); ++i)
    blocks[work->jobs[i].id] = surroundings(work->program.strips[i], cell);
  const std::uint64_t id = cell_id(cell_sha256(cell));
  return std::make_shared<const robot::ArmCell>(
      std::move(cell), id, robot::ArmCell::Limits{motion.jerk_mm_s3, motion.angular_jerk_rad_s3}, blocks);
}

}  // namespace hotblade::pipeline
