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
cat >> "$tree/docs/house.md" <<'TXT'
## A stranger's path
1. [side](side.md) says it,
2. [header](../gpu/mesh/side.hpp) has `side`.
TXT
echo 'int side();' > "$tree/gpu/mesh/side.hpp"
printf '# The side\n[house](house.md), [side](#the-side), [web](https://example.org/none), [header](../gpu/mesh/side.hpp)\n' > "$tree/docs/side.md"
printf '[side](docs/side.md#the-side) `gpu/mesh/side.hpp` `gpu/mesh/*.hpp` `Side.OfA...` `Near.*` `House.Stands`\n' \
  > "$tree/README.md"
good=$(python3 "$check" "$tree") || fail "a good tree must pass, but: $good"
[[ -z $good ]] || fail "a good tree must pass in silence, but: $good"

printf '[side](docs/sides.md)\n[side](docs/side.md#sides)\n`gpu/mesh/far.hpp` `gpu/mesh/*.cl`\n`Side.OfB...`\n`Far.*`\n' \
  > "$tree/README.md"
cat > "$tree/docs/house.md" <<'TXT'
| `gpu/curve` | `hotblade_gpu_mesh` |
## A stranger's path
1. [mesh](../gpu/mesh) is a room,
2. [header](../gpu/mesh/side.hpp) has `sides`,
3. [side](side.md) says it,
4. [header](../gpu/mesh/side.hpp) has it.
TXT
expected='README.md:1: link: docs/sides.md leads nowhere
README.md:2: link: docs/side.md#sides names no heading there
README.md:3: path: `gpu/mesh/far.hpp` is not there
README.md:3: path: `gpu/mesh/*.cl` is not there
README.md:4: test: `Side.OfB...` is no test
README.md:5: test: `Far.*` is no test
docs/house.md:1: room: not the rooms of check_house.sh in their order; missing: gpu/mesh
docs/house.md:1: room: hotblade_gpu_mesh is not the target of gpu/curve
docs/house.md:1: way: 4 clicks, not 1 to 3
docs/house.md:1: way: ../gpu/mesh is not linked before
docs/house.md:1: way: ../gpu/mesh/side.hpp is not linked before
docs/house.md:1: way: `sides` is not in ../gpu/mesh/side.hpp'
code=0
found=$(python3 "$check" "$tree") || code=$?
[[ $code -eq 1 ]] || fail "a bad tree must exit with 1, not $code"
[[ $found == "$expected" ]] || fail "expected:
$expected
found:
$found"
