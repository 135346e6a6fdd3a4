#!/usr/bin/env bash
# full_disk_test.sh PROGRAM DESIGN.obj CONFIG.toml: a dry run whose log cannot be written says so and leaves none, help that
# cannot be written is no success, and `run` opens no job
# unless its journal and its log can be written. A limit on the size of files stands for a full disk.
set -euo pipefail
program=$1 design=$2 config=$3
work=$(mktemp -d)
trap '[[ -z ${sim:-} ]] || kill "$sim" 2> /dev/null || true; rm -rf "$work"' EXIT
failures=0
fail() { echo "FAILED: $*"; failures=$((failures + 1)); }

# limited KIB COMMAND...: its files grow to KIB at most.
limited() {
  local code=0
  (trap '' XFSZ; ulimit -f "$1"; "${@:2}" 2>&1) | tee "$work/said.txt" > /dev/null || code=$?
  return "$code"
}
ended() { "$@" && echo 0 || echo $?; }

"$program" plan "$design" --config "$config" --set 'slice.direction=[1,0,0]' --set slice.spacing_mm=100 --no-pictures \
  -o "$work/cut" -q > /dev/null
code=$(ended limited 64 "$program" dryrun "$work/cut/program.json" --log "$work/execution.jsonl")
[[ $code == 7 ]] || fail "dryrun ended with $code"
grep -q 'execution.jsonl: the log cannot be written (File too large)' "$work/said.txt" ||
  fail "dryrun says: $(tail -1 "$work/said.txt")"
[[ ! -e $work/execution.jsonl ]] || fail "dryrun left a part of its log"
for words in --help --version "help run" "run --help" "completion bash"; do
  code=$("$program" $words > /dev/full 2> "$work/said.txt" && echo 0 || echo $?)
  [[ $code == 7 ]] || fail "$words ended with $code"
  grep -q 'stdout: cannot write the result' "$work/said.txt" || fail "$words says: $(cat "$work/said.txt")"
done

# A port that somebody else holds already is given up for another one.
answers() { (exec 3<> "/dev/tcp/127.0.0.1/$port") 2> /dev/null; }
for ((try = 0; try < 5; ++try)); do
  port=$((12000 + RANDOM % 20000))
  "$program" sim --listen "127.0.0.1:$port" --time-scale max --log "$work/sim.jsonl" 2> "$work/sim.txt" & sim=$!
  for ((i = 0; i < 50; ++i)); do
    answers && break 2
    kill -0 "$sim" 2> /dev/null || break
    sleep 0.1
  done
  kill "$sim" 2> /dev/null || true
  wait "$sim" || true
done
answers || { echo "FAILED: no simulator listens: $(cat "$work/sim.txt")"; exit 1; }
run=("$program" run "$work/cut/program.json" --connect "127.0.0.1:$port" --yes)
for log in "" "--log-file=$work/run.log"; do
  code=$(ended limited 0 "${run[@]}" $log)
  [[ $code == 7 ]] || fail "run $log ended with $code"
  grep -q 'File too large' "$work/said.txt" || fail "run $log says: $(tail -1 "$work/said.txt")"
  ! grep -q '"ev":"open"' "$work/sim.jsonl" || fail "run $log opened a job"
done
code=$(ended "${run[@]}" --log-file="$work/run.log" > "$work/said.txt" 2>&1; tail -1 "$work/said.txt")
[[ $code == 0 ]] || fail "run with room ended with $code"
grep -q '"ev":"done"' "$work/sim.jsonl" || fail "run with room cut nothing"
((failures == 0)) || exit 1
