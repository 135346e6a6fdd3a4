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

mkdir -p "$tree"/{elastica/kernels,surface,gpu,robot,pipeline}
printf '#include <Eigen/Core>\n' > "$tree/elastica/curve.hpp"
printf '#include "surface/slice.hpp"\n#include <CGAL/Surface_mesh.h>\n' > "$tree/surface/slice.cpp"
printf '#include "elastica/kernels/curve.h"\n' > "$tree/gpu/near.cpp"
printf '#include "elastica/curve.hpp"\n' > "$tree/robot/pose.cpp"
printf '#include "robot/pose.hpp"\n#include "gpu/near.hpp"\n' > "$tree/pipeline/plan.cpp"
echo elastica/curve.hpp > "$tree/headers.txt"
good=$(bash "$check" "$tree" headers.txt) || fail "a good tree must pass, but: $good"
[[ -z $good ]] || fail "a good tree must pass in silence, but: $good"

printf '#include "surface/slice.hpp"\n' > "$tree/elastica/bad_direction.cpp"
printf '\n  #  include "elastica/curve.hpp"\n' > "$tree/gpu/bad_direction.cpp"
printf '#include "pipeline/plan.hpp"\n' > "$tree/robot/bad_direction.cpp"
printf '#include "curve.hpp"\n' > "$tree/pipeline/bad_root.cpp"
printf '#include <string>\n#include <CGAL/Surface_mesh.h>\n' > "$tree/surface/bad_heavy.hpp"
seq 601 > "$tree/surface/bad_long.cpp"
echo surface/bad_heavy.hpp >> "$tree/headers.txt"
: > "$tree/robot/bad_unlisted.hpp"
expected='elastica/bad_direction.cpp:1: direction: elastica may not include "surface/slice.hpp"
surface/bad_heavy.hpp:2: heavy: <CGAL/Surface_mesh.h> belongs in a .cpp
surface/bad_long.cpp:601: long: 601 lines, at most 600
gpu/bad_direction.cpp:2: direction: gpu may not include "elastica/curve.hpp"
robot/bad_direction.cpp:1: direction: robot may not include "pipeline/plan.hpp"
robot/bad_unlisted.hpp:1: unlisted: not in its room'\''s HEADERS, so not compiled alone
pipeline/bad_root.cpp:1: root: "curve.hpp" does not start with a room'
code=0
found=$(bash "$check" "$tree" headers.txt) || code=$?
[[ $code -eq 1 ]] || fail "a bad tree must exit with 1, not $code"
[[ $found == "$expected" ]] || fail "expected:
$expected
found:
$found"
