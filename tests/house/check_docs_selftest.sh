#!/usr/bin/env bash
# Shows that check_docs.py can fail: a tree with one breach of every rule, and one without any.
set -euo pipefail
check="$(dirname "${BASH_SOURCE[0]}")/check_docs.py"
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT

fail() {
  echo "$1"
  exit 1
}

[[ $(python3 "$check" "$tree" || echo "rc $?") == *"rc 2" ]] || fail "an empty tree must not pass"

mkdir -p "$tree"/{docs,tests/house,gpu/{mesh,curve}}
touch "$tree/gpu/mesh/side.hpp"
printf 'TEST(Side,\n     OfAClosedMesh) {}\nTEST_P(Near, IsNearest) {}\n' > "$tree/tests/side_test.cpp"
printf 'add_test(NAME House.Stands\n  COMMAND true)\n' > "$tree/tests/CMakeLists.txt"
printf "readonly downhill='\ngpu/mesh:\ngpu/curve: gpu/mesh\n'\n" > "$tree/tests/house/check_house.sh"
printf '| `gpu/mesh` | `hotblade_gpu_mesh` |\n| `gpu/curve` | `hotblade_gpu_curve` |\n' > "$tree/docs/house.md"
printf '# The side\n[house](house.md), [side](#the-side), [web](https://example.org/none)\n' > "$tree/docs/side.md"
printf '[side](docs/side.md#the-side) `gpu/mesh/side.hpp` `gpu/mesh/*.hpp` `Side.OfA...` `Near.*` `House.Stands`\n' \
  > "$tree/README.md"
good=$(python3 "$check" "$tree") || fail "a good tree must pass, but: $good"
[[ -z $good ]] || fail "a good tree must pass in silence, but: $good"

printf '[side](docs/sides.md)\n[side](docs/side.md#sides)\n`gpu/mesh/far.hpp` `gpu/mesh/*.cl`\n`Side.OfB...`\n`Far.*`\n' \
  > "$tree/README.md"
printf '| `gpu/curve` | `hotblade_gpu_mesh` |\n' > "$tree/docs/house.md"
expected='README.md:1: link: docs/sides.md leads nowhere
README.md:2: link: docs/side.md#sides names no heading there
README.md:3: path: `gpu/mesh/far.hpp` is not there
README.md:3: path: `gpu/mesh/*.cl` is not there
README.md:4: test: `Side.OfB...` is no test
README.md:5: test: `Far.*` is no test
docs/house.md:1: room: not the rooms of check_house.sh in their order; missing: gpu/mesh
docs/house.md:1: room: hotblade_gpu_mesh is not the target of gpu/curve'
code=0
found=$(python3 "$check" "$tree") || code=$?
[[ $code -eq 1 ]] || fail "a bad tree must exit with 1, not $code"
[[ $found == "$expected" ]] || fail "expected:
$expected
found:
$found"
