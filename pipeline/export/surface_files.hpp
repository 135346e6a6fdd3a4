// The surface as cut, for CAD and mesh tools: mm, design frame, fronts on the waste side.
#pragma once

#include "pipeline/export/exported_file.hpp"
#include "pipeline/program/program.hpp"

namespace hotblade::pipeline {

// The file as_cut.obj with one group a strip. `sample_mm` as in swept_surface().
[[nodiscard]] ExportedFile as_cut_obj(const Program& program, double sample_mm);

// The file as_cut.ply in text form: x y z, normal, and the strip's index (from 0) a vertex.
[[nodiscard]] ExportedFile as_cut_ply(const Program& program, double sample_mm);

}  // namespace hotblade::pipeline
