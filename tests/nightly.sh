#!/usr/bin/env bash
# What is too long for every change: nightly.sh [STEP...], all steps unless some are named. A step that fails does not keep
# the next from running. build/nightly/STEP.log has what it printed, build/nightly/summary.md a row for each step. Exit
# code 1 when a step failed. docs/nightly.md describes the steps.
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
readonly out=build/nightly

tests() { ./run test; }

# Tests that take a share of their cases in every run, with all of them.
long() {
  local failed=0
  ./run build &&
    cmake --build --preset release --target hotblade_elastica_arcs_tests hotblade_elastica_bezier_tests hotblade_elastica_blade_tests \
      hotblade_elastica_quadratic_tests hotblade_pipeline_cli_tests hotblade_pipeline_plan_arms_tests \
      hotblade_robot_client_tests hotblade_robot_controller_tests || return 1
  HOTBLADE_CLAMP_PAIRS=1000 build/release/hotblade_elastica_blade_tests --gtest_filter='*FindEquilibria*' || failed=1
  build/release/hotblade_elastica_quadratic_tests --gtest_also_run_disabled_tests --gtest_filter='*HundredThousand*' || failed=1
  build/release/hotblade_elastica_arcs_tests --gtest_also_run_disabled_tests --gtest_filter='*TenThousand*' || failed=1
  HOTBLADE_RESIDUAL_CUBICS=100000 build/release/hotblade_elastica_bezier_tests --gtest_filter='*ResidualBound*' || failed=1
  HOTBLADE_CELL_SAMPLES=all build/release/hotblade_pipeline_plan_arms_tests --gtest_filter='*BothCellsServe/wave_wall' || failed=1
  HOTBLADE_STREAM_FAULTS=full build/release/hotblade_robot_client_tests --gtest_filter='*Kill*:*Stream*' || failed=1
  HOTBLADE_HOSTILE=full build/release/hotblade_robot_controller_tests --gtest_filter='*Hostile*' || failed=1
  HOTBLADE_STOPPED_CUTS=20 build/release/hotblade_pipeline_cli_tests --gtest_filter='*StoppedCut*' || failed=1
  HOTBLADE_INTERRUPTS=50 ctest --preset release -R '^Latency.AnInterrupt' || failed=1
  HOTBLADE_BROWSER_ROOF=1 ./run test-browser || failed=1
  HOTBLADE_PLAN_SETS=100 ctest --preset release -R '^PlanSet' || failed=1
  return "$failed"
}

# That benchmarks build, which no test needs, and those of many blades run.
bench() { ./run bench --benchmark_filter=Many --benchmark_min_time=0.1; }

# Every header alone, with nothing read before it.
headers() {
  cmake --preset release -DHOTBLADE_BARE_HEADERS=ON > /dev/null &&
    cmake --build --preset release --target hotblade_headers_alone
  local failed=$?
  cmake --preset release -DHOTBLADE_BARE_HEADERS=OFF > /dev/null
  return "$failed"
}

sanitize() { ./run sanitize; }

threads() { ./run sanitize threads; }

units() { ./run sanitize units; }

tidy() { ./run tidy; }

fuzz() { ./run fuzz 100000; }

# 118 of three seeds' 120 is what the planner has to pass.
panels() { ./run panels 1 2 3 --at-least 118; }

meshes() {
  local mesh=$out/wave_wall.obj size failed=0
  ./run build && cmake --build --preset release --target make_samples || return 1
  for size in 100000 1000000 10000000; do
    build/release/make_samples "$mesh" wave_wall "$size" || return 1
    echo "$size triangles"
    time build/release/hotblade -q check "$mesh" --units mm || failed=1
    time build/release/hotblade -q plan "$mesh" --config samples/wave_wall.toml -o "$out/wave_wall" --force \
      --no-pictures || failed=1
  done
  rm -f "$mesh"
  return "$failed"
}

# The clamps that amber verdicts ask for, tried.
verdicts() {
  ./run panels 77 --at-least 0 --out "$out/verdicts" && python3 tests/verdict_table.py build/release/hotblade "$out/verdicts/77"
}

samples() { ./run samples; }

pip() { ./run test-pip; }

readonly all=(tests headers long bench units sanitize threads tidy fuzz panels verdicts meshes samples pip)
steps=("$@")
((${#steps[@]})) || steps=("${all[@]}")
for step in "${steps[@]}"; do
  [[ " ${all[*]} " == *" $step "* ]] || { echo "nightly: no step $step, there are: ${all[*]}" >&2; exit 2; }
done

mkdir -p "$out"
{
  echo "Commit $(git rev-parse --short HEAD), $(date -u +%F), $(nproc) cores"
  echo
  echo "| step | result | minutes | processor minutes |"
  echo "|---|---|---|---|"
} > "$out/summary.md"
TIMEFORMAT='%R %U %S'
worst=0
for step in "${steps[@]}"; do
  echo "== $step: $out/$step.log"
  took=$({ time "$step" > "$out/$step.log" 2>&1; echo "$?" > "$out/status"; } 2>&1)
  status=$(< "$out/status")
  ((status == 0)) || worst=1
  read -r wall user system <<< "$took"
  awk -v step="$step" -v status="$status" -v wall="$wall" -v user="$user" -v system_s="$system" 'BEGIN {
    printf "| %s | %s | %.1f | %.1f |\n", step, status == 0 ? "green" : "red, exit code " status, wall / 60,
      (user + system_s) / 60 }' | tee -a "$out/summary.md"
done
rm -f "$out/status"
exit "$worst"
