#!/usr/bin/env bash
# plan_set_test.sh PROGRAM DESIGN.obj CONFIG.toml [ROUNDS]: whatever happens to `plan --force`, its directory holds one
# whole set: all files of one plan, and those that no plan wrote. ROUNDS times each: two plans at once, a plan that is
# killed, a plan on a disk that is full. HOTBLADE_PLAN_SETS replaces ROUNDS.
set -euo pipefail
program=$1 design=$2 config=$3 rounds=${HOTBLADE_PLAN_SETS:-${4:-3}}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cut=$work/cut

# Two plans of one design that differ in every file.
plan() { # plan A|B DIRECTORY [options]
  local kerf=1 which=$1 directory=$2
  [[ $which == A ]] || kerf=1.2
  shift 2
  "$program" plan "$design" --config "$config" --set 'slice.direction=[1,0,0]' --set "blade.kerf_mm=$kerf" \
    --no-pictures -o "$directory" "$@" > "$work/$which.out" 2> "$work/$which.err"
}

# The names and contents of a set; run.json may differ from run to run.
print_of() { (cd "$1" && find . -type f ! -name run.json ! -path './mine*' | LC_ALL=C sort | xargs sha256sum) | sha256sum; }

failures=0
fail() {
  echo "FAILED: $*"
  ls -laR "$cut"
  failures=$((failures + 1))
}

# The directory holds set A or B whole, the report names its program, and what is ours is there.
expect_whole() { # expect_whole WHAT
  local print sha
  print=$(print_of "$cut")
  [[ $print == "$print_a" || $print == "$print_b" ]] || fail "$1: neither set is whole"
  sha=$(sha256sum < "$cut/program.json" | cut -d' ' -f1)
  grep -q "\"program_sha256\": \"$sha\"" "$cut/report.json" || fail "$1: report.json names another program"
  grep -q "$sha" "$cut/report.html" || fail "$1: report.html names another program"
  [[ $(cat "$cut/mine.txt") == mine && $(cat "$cut/mine/notes") == notes ]] || fail "$1: a file of the user is gone"
}
expect_nothing_beside() {
  local left
  left=$(find "$work" -maxdepth 1 -name '.cut*')
  [[ -z $left ]] || fail "$1: left beside: $left"
}

plan A "$work/a"
start=$EPOCHREALTIME
plan B "$work/b"
took_us=$((${EPOCHREALTIME/./} - ${start/./}))
print_a=$(print_of "$work/a") print_b=$(print_of "$work/b")
for file in $(cd "$work/a" && find . -type f ! -name run.json); do
  ! cmp -s "$work/a/$file" "$work/b/$file" || fail "$file is the same in both plans"
done
plan A "$cut"
echo mine > "$cut/mine.txt"
mkdir "$cut/mine"
echo notes > "$cut/mine/notes"

for ((round = 0; round < rounds; ++round)); do
  codes=()
  plan A "$cut" --force & first=$!
  plan B "$cut" --force & second=$!
  for one in $first $second; do wait "$one" && codes+=(0) || codes+=($?); done
  expect_whole "round $round, two at once (${codes[*]})"
  # One of them wrote; the other came later, or was told to wait.
  [[ " ${codes[*]} " == *' 0 '* ]] || fail "round $round: neither of two plans wrote (${codes[*]})"
  for which in A B; do
    code=${codes[0]}
    [[ $which == A ]] || code=${codes[1]}
    ((code == 0)) || { ((code == 7)) && grep -q 'another plan is writing there' "$work/$which.err"; } ||
      fail "round $round: plan $which ended with $code: $(tail -1 "$work/$which.err")"
  done
done
expect_nothing_beside "two at once"

# What a plan leaves that is killed in the middle of a file.
mkdir -p "$work/.cut.hotblade-1/ribs"
touch "$work/.cut.hotblade-1/"{program.json,.report.html.15816.4.tmp,ribs/.S001.dxf.15816.2.tmp}
plan A "$cut" --force
expect_whole "after a torn file"
expect_nothing_beside "a torn file"

for ((round = 0; round < rounds; ++round)); do
  # Most of them at the end, while the set is written and swapped.
  (plan B "$cut" --force) & victim=$!
  wait_us=$((took_us * (60 + RANDOM % 50) / 100))
  sleep "$(printf '%d.%06d' $((wait_us / 1000000)) $((wait_us % 1000000)))"
  pkill -KILL -P "$victim" 2> /dev/null || true
  wait "$victim" 2> /dev/null || true
  expect_whole "round $round, killed after $wait_us us"
  plan A "$cut" --force || fail "round $round: no plan after a killed one: $(tail -1 "$work/A.err")"
  expect_whole "round $round, after a killed one"
done
expect_nothing_beside "killed"

# A disk of its own where that is allowed, else a limit on the size of a file.
for ((round = 0; round < rounds; ++round)); do
  plan A "$cut" --force
  code=0
  (
    trap '' XFSZ
    ulimit -f $((RANDOM % ($(stat -c %s "$work/b/program.json") / 1024)))
    "$program" plan "$design" --config "$config" --set 'slice.direction=[1,0,0]' --set blade.kerf_mm=1.2 \
      --no-pictures -o "$cut" --force > /dev/null 2> "$work/full.err" || { code=$?; true; }
    exit "$code"
  ) || code=$?
  ((code == 7)) || fail "round $round: a plan that cannot write ended with $code"
  expect_whole "round $round, file too large"
  [[ $(print_of "$cut") == "$print_a" ]] || fail "round $round: the older set is not what it was"
done
expect_nothing_beside "file too large"

# The whole disk: the working directory is on it, too.
full_disk() {
  mount -t tmpfs -o "size=$1" tmpfs "$work/disk"
  cut=$work/disk/cut
  plan A "$cut"
  echo mine > "$cut/mine.txt"
  mkdir "$cut/mine"
  echo notes > "$cut/mine/notes"
  dd if=/dev/zero of="$work/disk/filler" bs=1k count=100000 2> /dev/null || true
  truncate -s "$(($(stat -c %s "$work/disk/filler") / 1024 * (RANDOM % 100) / 100))K" "$work/disk/filler"
  local code=0
  plan B "$cut" --force || code=$?
  echo "$code"
  expect_whole "full disk"
  ((code == 0 || code == 7)) || fail "full disk: ended with $code"
  ((code == 0)) || grep -q 'No space left on device' "$work/B.err" || fail "full disk: not said: $(tail -1 "$work/B.err")"
  ((failures == 0))
}
if unshare -rm true 2> /dev/null; then
  mkdir -p "$work/disk"
  size=$(($(du -sk "$work/a" | cut -f1) * 2 + 200))k
  export -f full_disk plan print_of expect_whole fail
  export program design config work print_a print_b failures
  for ((round = 0; round < rounds; ++round)); do
    unshare -rm bash -euo pipefail -c "full_disk $size" > "$work/disk.out" || { cat "$work/disk.out"; fail "round $round, full disk"; }
    full_codes+=" $(head -1 "$work/disk.out")"
  done
  echo "plans on a full disk ended with:${full_codes:-}"
else
  echo "no disk of its own can be mounted here: only the size of files was limited"
fi

((failures == 0)) || exit 1
echo "$rounds rounds each of two plans at once, killed plans and full disks: always one whole set"
