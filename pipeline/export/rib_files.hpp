// Rib curves for templates and CAD: every rib flat in its own plane, with its id, as polylines or as circular
// arcs of the rib's length (elastica/arcs/arcs.hpp). mm; the error bound and the length stand in the file.
#pragma once

#include "pipeline/export/exported_file.hpp"
#include "pipeline/program/program.hpp"

namespace hotblade::pipeline {

struct RibFileOptions {
  bool arcs = false;           // biarcs; otherwise chords
  double tolerance_mm = 0.01;  // largest distance between the rib's elastica and what is written
};

// The files of a program's ribs. Format "dxf" (AutoCAD 2000, one LWPOLYLINE a rib with bulges for arcs, on a
// layer of the rib's name) and "svg": one file a strip, its ribs one above the other. "csv": one file a
// strip; points with their place in the design frame, or arcs. "gcode": one file a rib, G1 and, for arcs, G2
// and G3 with the centre in I and J; no tool, no feed, no third axis: a path for a machine's own
// post-processing. Throws std::logic_error for another format.
[[nodiscard]] std::vector<ExportedFile> rib_files(const Program& program, const std::string& format,
                                                  const RibFileOptions& options);

// The file beziers.csv: the control points of every rib's cubic, in the rib's plane and in the design frame,
// mm.
[[nodiscard]] ExportedFile bezier_file(const Program& program);

}  // namespace hotblade::pipeline
