#!/usr/bin/env bash
# Shows that check_doors.py can fail: a tree with one file of every kind without a door, and one without any.
set -euo pipefail
check="$(dirname "${BASH_SOURCE[0]}")/check_doors.py"
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT

fail() {
  echo "$1"
  exit 1
}

[[ $(python3 "$check" "$tree" || echo "rc $?") == *"rc 2" ]] || fail "an empty tree must not pass"

mkdir -p "$tree"/{elastica/{kernels,curve},gpu/{kernels,curve},pipeline/cli}
printf '#include "pipeline/cli/command.hpp"\n' | tee "$tree"/pipeline/cli/{main,cmd_plan}.cpp > /dev/null
printf '#include "gpu/curve/near.hpp"\n' > "$tree/pipeline/cli/command.hpp"
printf '  #  include "elastica/curve/curve.hpp"\n' > "$tree/gpu/curve/near.hpp"
printf '#include "gpu/curve/near.hpp"\nextern const char* const near_source;\n' > "$tree/gpu/curve/near.cpp"
printf '#include "gpu/kernels/near.h"\n' > "$tree/gpu/kernels/near.cl"
: > "$tree/gpu/kernels/near.h"
printf '#include "elastica/kernels/curve.h"\n' > "$tree/elastica/curve/curve.hpp"
: > "$tree/elastica/kernels/curve.h"
printf '#include "elastica/curve/curve.hpp"\n' | tee "$tree"/elastica/curve/curve{,_avx2}.cpp > /dev/null
good=$(python3 "$check" "$tree") || fail "a good tree must pass, but: $good"
[[ -z $good ]] || fail "a good tree must pass in silence, but: $good"

# What only an orphan takes in is without a door as well.
printf '#include "elastica/curve/orphan.hpp"\n#include "elastica/curve/curve.hpp"\n' > "$tree/elastica/curve/orphan.cpp"
printf '#include "elastica/kernels/orphan.h"\n' > "$tree/elastica/curve/orphan.hpp"
: > "$tree/elastica/curve/orphan_avx2.cpp"
: > "$tree/elastica/kernels/orphan.h"
: > "$tree/gpu/kernels/orphan.cl"
: > "$tree/gpu/curve/unlike.cpp"
expected='elastica/curve/orphan.cpp:1: door: no command reaches it
elastica/curve/orphan.hpp:1: door: no command reaches it
elastica/curve/orphan_avx2.cpp:1: door: no command reaches it
elastica/kernels/orphan.h:1: door: no command reaches it
gpu/curve/unlike.cpp:1: door: no command reaches it
gpu/kernels/orphan.cl:1: door: no command reaches it'
code=0
found=$(python3 "$check" "$tree") || code=$?
[[ $code -eq 1 ]] || fail "a tree with orphans must exit with 1, not $code"
[[ $found == "$expected" ]] || fail "expected:
$expected
found:
$found"
