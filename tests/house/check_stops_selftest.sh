#!/usr/bin/env bash
# The check of the stops finds what it is for, and nothing else.
set -euo pipefail
check=$(dirname "${BASH_SOURCE[0]}")/check_stops.py
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
python3 "$check" "$root" && { echo "an empty tree passes"; exit 1; }
mkdir -p "$root/gpu"
printf 'void f() {\n  tbb::parallel_for(0, 8, [&](int i) { g(i, ")("); });\n  gpu::stop_point();\n}\n' > "$root/gpu/good.cpp"
python3 "$check" "$root" || { echo "a loop with a stop point is named"; exit 1; }
printf 'void f() {\n  tbb::parallel_for(0, 8, [&](int i) { g(i); });\n  use();\n}\n' > "$root/gpu/bad.cpp"
found=$(python3 "$check" "$root") && { echo "a loop without one passes"; exit 1; }
[[ $found == "gpu/bad.cpp:2: stop: "* ]] || { echo "says: $found"; exit 1; }
