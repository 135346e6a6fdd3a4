#!/usr/bin/env bash
# Shows that check_house.sh can fail: a tree with one breach of every rule, and one without any.
set -euo pipefail
check="$(dirname "${BASH_SOURCE[0]}")/check_house.sh"
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT

fail() {
  echo "$1"
  exit 1
}

[[ $(bash "$check" "$tree" || echo "rc $?") == *"rc 2" ]] || fail "an empty tree must not pass"

mkdir -p "$tree"/{build,elastica/{kernels,curve},surface/{read,slice},gpu/mesh,robot/pose,pipeline/{program,plan/{ribs,motion}}}
printf '#include <Eigen/Core>\n' > "$tree/elastica/curve/curve.hpp"
printf '#include "surface/read/mesh.hpp"\n#include <CGAL/Surface_mesh.h>\n' > "$tree/surface/slice/slice.cpp"
printf '#include "elastica/kernels/curve.h"\n' > "$tree/gpu/mesh/near.cpp"
printf '#include "elastica/curve/curve.hpp"\n' > "$tree/robot/pose/pose.cpp"
printf '#include "robot/pose/pose.hpp"\n#include "gpu/mesh/near.hpp"\n' > "$tree/pipeline/plan/plan.cpp"
printf '#include "pipeline/plan/ribs/rib_fit.hpp"\n' > "$tree/pipeline/plan/motion/motion.cpp"
printf '#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>\n' > "$tree/surface/read/half_edges.hpp"
printf '#include "surface/read/half_edges.hpp"\n' > "$tree/surface/slice/march.cpp"
printf 'elastica/curve/curve.hpp\nsurface/read/half_edges.hpp\n' > "$tree/build/headers.txt"
good=$(bash "$check" "$tree" build/headers.txt) || fail "a good tree must pass, but: $good"
[[ -z $good ]] || fail "a good tree must pass in silence, but: $good"

printf '#include "surface/slice/slice.hpp"\n' > "$tree/elastica/curve/bad_direction.cpp"
printf '\n  #  include "elastica/curve/curve.hpp"\n' > "$tree/gpu/mesh/bad_direction.cpp"
printf '#include "pipeline/plan/plan.hpp"\n' > "$tree/robot/pose/bad_direction.cpp"
printf '#include "surface/slice/slice.hpp"\n' > "$tree/surface/read/bad_uphill.cpp"
printf '#include "pipeline/plan/motion/motion.hpp"\n' > "$tree/pipeline/plan/ribs/bad_uphill.cpp"
printf '#include "pipeline/plan/plan.hpp"\n' > "$tree/pipeline/program/bad_uphill.cpp"
printf '#include "curve.hpp"\n' > "$tree/pipeline/plan/bad_root.cpp"
printf '#include <string>\n#include <CGAL/Surface_mesh.h>\n' > "$tree/surface/read/bad_heavy.hpp"
printf '#include "surface/read/half_edges.hpp"\n' | tee "$tree/surface/read/bad_private.hpp" > "$tree/pipeline/plan/bad_private.cpp"
echo surface/read/bad_private.hpp >> "$tree/build/headers.txt"
printf 'text = json.dump(2);\n' > "$tree/pipeline/plan/bad_json.cpp"
seq 601 > "$tree/surface/read/bad_long.cpp"
: > "$tree/surface/bad_room.cpp"
echo surface/read/bad_heavy.hpp >> "$tree/build/headers.txt"
: > "$tree/robot/pose/bad_unlisted.hpp"
: > "$tree/bad_stray.txt"
expected='elastica/curve/bad_direction.cpp:1: direction: elastica/curve may not include "surface/slice/slice.hpp"
surface/bad_room.cpp:1: room: surface is no room of the house
surface/read/bad_heavy.hpp:2: heavy: <CGAL/Surface_mesh.h> belongs in a .cpp
surface/read/bad_long.cpp:601: long: 601 lines, at most 600
surface/read/bad_private.hpp:1: private: only sources of surface may include "surface/read/half_edges.hpp"
surface/read/bad_uphill.cpp:1: direction: surface/read may not include "surface/slice/slice.hpp"
gpu/mesh/bad_direction.cpp:2: direction: gpu/mesh may not include "elastica/curve/curve.hpp"
robot/pose/bad_direction.cpp:1: direction: robot/pose may not include "pipeline/plan/plan.hpp"
robot/pose/bad_unlisted.hpp:1: unlisted: not in its room'\''s HEADERS, so not compiled alone
pipeline/plan/bad_json.cpp:1: json: dump() ends at a name that is no UTF-8: json_text() does not
pipeline/plan/bad_private.cpp:1: private: only sources of surface may include "surface/read/half_edges.hpp"
pipeline/plan/bad_root.cpp:1: root: "curve.hpp" does not start with a room
pipeline/plan/ribs/bad_uphill.cpp:1: direction: pipeline/plan/ribs may not include "pipeline/plan/motion/motion.hpp"
pipeline/program/bad_uphill.cpp:1: direction: pipeline/program may not include "pipeline/plan/plan.hpp"
bad_stray.txt:1: stray: no file of the root'
code=0
found=$(bash "$check" "$tree" build/headers.txt) || code=$?
[[ $code -eq 1 ]] || fail "a bad tree must exit with 1, not $code"
[[ $found == "$expected" ]] || fail "expected:
$expected
found:
$found"
