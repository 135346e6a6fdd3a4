#!/usr/bin/env bash
# cluster_test.sh PROGRAM SOURCE_DIR [TRIAL...]: plans batches through snakemake and Slurm, two nodes of which are started on this
# host, and kills what a cluster loses: every job has one result afterwards, none is lost, none is planned twice. A program that
# sleeps stands in for `hotblade plan`. Exit code 77, with the reason, where it does not run: only `./run test-cluster` asks for
# it, as it takes minutes.
set -euo pipefail
program=$(realpath "$1") source=$(realpath "$2")
shift 2
trials=("$@")
((${#trials[@]})) || trials=(all_once snakemake_killed node_lost controller_killed over_memory refused_and_failed nothing_to_do)
[[ -n ${HOTBLADE_TEST_CLUSTER:-} ]] || { echo "only ./run test-cluster asks for it"; exit 77; }
for needed in snakemake sbatch slurmctld slurmd munged; do
  PATH=$PATH:/usr/sbin type -P "$needed" > /dev/null || { echo "$needed is not installed"; exit 77; }
done
[[ $(id -u) -eq 0 ]] || { echo "only root starts nodes on one host"; exit 77; }
PATH=$PATH:/usr/sbin
share=$source/pipeline/batch/share
work=$(mktemp -d)
export SLURM_CONF=$work/slurm.conf PATH=$work/bin:$PATH STAND_IN_LOG=$work/log
mkdir -p "$work"/{bin,state,spool}

# ---- the cluster ----

host=$(hostname -s)
sed -e "s/batchhost/$host/g" -e "s|STATE_FOLDER|$work|g" "$source/tests/pipeline/batch/slurm.conf" > "$SLURM_CONF"
own_munge=
start_munge() {
  pgrep -x munged > /dev/null && return
  mkdir -p /run/munge && chown munge:munge /run/munge
  runuser -u munge -- munged
  own_munge=/run/munge/munged.pid
}
start_node() { slurmd -N "$1"; }
end_by() { [[ ! -s $1 ]] || kill "${2:--TERM}" "$(< "$1")" 2> /dev/null || true; }
stop() {
  for node in n1 n2; do end_by "$work/slurmd-$node.pid"; done
  end_by "$work/slurmctld.pid"
  [[ -z $own_munge ]] || end_by "$own_munge"
  sleep 1
  rm -rf "$work"
}
trap stop EXIT
start_munge
slurmctld
start_node n1
start_node n2
for ((i = 0; i < 60; ++i)); do
  [[ $(sinfo -h -o %T 2> /dev/null) == idle ]] && break
  sleep 1
done
[[ $(sinfo -h -o %T) == idle ]] || { echo "the nodes do not come up:"; sinfo; tail -5 "$work"/*.log; exit 1; }

# ---- batches of a program that stands in ----

cat > "$work/stand_in" <<'SH'
#!/bin/sh
design=$2
while [ $# -gt 0 ]; do [ "$1" = -o ] && out=$2; shift; done
echo "start $design" >> "$STAND_IN_LOG"
read -r v x y z rest < "$design"
case $z in 903*) echo "bad" >&2; exit 3 ;; 904*) mkdir -p "$out"; echo '{}' > "$out/report.json"; exit 4 ;;
  907*) echo "file lost" >&2; exit 7 ;;
  912*) [ -e "$STAND_IN_LOG.more" ] || { : > "$STAND_IN_LOG.more"; x=$(head -c 700000000 /dev/zero | tr '\0' x); sleep 60; exit 1; } ;;
esac
sleep 0.3
mkdir -p "$out"
echo '{}' > "$out/report.json"
echo "end $design" >> "$STAND_IN_LOG"
SH
cat > "$work/bin/hotblade" <<SH
#!/bin/sh
if [ "\$2" = run ]; then exec "$program" "\$@" --program "$work/stand_in"; fi
exec "$program" "\$@"
SH
chmod +x "$work/stand_in" "$work/bin/hotblade"

# batch NAME COUNT [HEIGHTS...]: a batch of COUNT panels, and of these heights, in some 20 chunks.
batch() {
  local name=$1 count=$2 height
  shift 2
  for height in $(seq 1 "$count") "$@"; do
    printf 'g p%s\nv 0 0 %s.5\nv 100 0 %s.5\nv 0 100 %s.5\nf -3 -2 -1\n' "$height" "$height" "$height" "$height"
  done > "$work/$name.obj"
  hotblade batch init "$work/$name" --design "$work/$name.obj" --split group --units mm \
    --chunk-minutes "${chunk_minutes:-0.25}" > /dev/null
  : > "$STAND_IN_LOG"
}
through() { snakemake -s "$share/Snakefile" -d "$work/$1" --profile "$share/profiles/slurm" > "$work/$1.out" 2>&1; }
rows() { python3 -c 'import csv, sys; print(sum(r["verdict"] == sys.argv[2] for r in csv.DictReader(open(sys.argv[1]))))' \
  "$work/$1/results.csv" "$2"; }
failures=0
expect() { # expect WHAT WANTED FOUND
  [[ $2 == "$3" ]] && { echo "  $1: $3"; return; }
  echo "FAILED: $1: $3 instead of $2"
  failures=$((failures + 1))
}
each_once() { # each_once NAME COUNT
  expect "$1: passed" "$2" "$(rows "$1" passed)"
  expect "$1: ended" "$2" "$(grep -c ^end "$STAND_IN_LOG")"
  expect "$1: ended twice" 0 "$(grep ^end "$STAND_IN_LOG" | sort | uniq -d | wc -l)"
}

all_once() {
  batch all_once 200
  through all_once || cat "$work/all_once.out"
  each_once all_once 200
}

snakemake_killed() {
  batch snakemake_killed 200
  setsid snakemake -s "$share/Snakefile" -d "$work/snakemake_killed" --profile "$share/profiles/slurm" > /dev/null 2>&1 &
  local pid=$!
  while (($(grep -c ^end "$STAND_IN_LOG") < 30)); do sleep 0.5; done
  kill -KILL "$pid"
  wait "$pid" 2> /dev/null || true
  snakemake -s "$share/Snakefile" -d "$work/snakemake_killed" --profile "$share/profiles/slurm" --unlock > /dev/null 2>&1
  through snakemake_killed || cat "$work/snakemake_killed.out"
  each_once snakemake_killed 200
}

node_lost() {
  batch node_lost 200
  through node_lost &
  local run=$!
  while (($(grep -c ^end "$STAND_IN_LOG") < 30)); do sleep 0.5; done
  end_by "$work/slurmd-n1.pid" -KILL
  local step
  for step in $(pgrep -x slurmstepd); do
    # Those of this cluster alone.
    ! grep -qzF "SLURM_CONF=$SLURM_CONF" "/proc/$step/environ" 2> /dev/null || kill -KILL "$step" 2> /dev/null || true
  done
  sleep 3
  start_node n1
  wait "$run" || cat "$work/node_lost.out"
  each_once node_lost 200
}

# Slurm's controller writes what it allocated up to 6 s later. Killed before, it knows nothing of jobs that run: their nodes, asked
# 3 s after it starts again, name them, and they are ended and queued. A job that has ended before that leaves its node drained
# (`Duplicate jobid`), so chunks take longer here, and nothing is started before nodes were asked (batch_sched_delay).
controller_killed() {
  chunk_minutes=1.25 batch controller_killed 300
  local chunks ended
  chunks=$(python3 -c 'import json, sys; print(json.load(open(sys.argv[1]))["chunks"])' "$work/controller_killed/batch.json")
  sbatch --requeue --array="0-$((chunks - 1))" --mem=500 --time=30 --output="$work/array-%a.log" \
    --wrap "hotblade batch run '$work/controller_killed' --chunk \$SLURM_ARRAY_TASK_ID"
  for ended in 30 150; do
    while (($(grep -c ^end "$STAND_IN_LOG") < ended)); do sleep 0.5; done
    end_by "$work/slurmctld.pid" -KILL
    sleep 4
    slurmctld
  done
  for ((i = 0; i < 300; ++i)); do
    [[ -n $(squeue -h 2> /dev/null || echo unknown) ]] || break
    sleep 1
  done
  expect "controller_killed: queued or running" 0 "$(squeue -h | wc -l)"
  expect "controller_killed: drained" 0 "$(sinfo -h -R | wc -l)"
  hotblade batch gather "$work/controller_killed" --partial > /dev/null
  each_once controller_killed 300
}

over_memory() {
  batch over_memory 20 912
  rm -f "$STAND_IN_LOG.more"
  sed 's/config\["mem_mb"\]/300/' "$share/Snakefile" > "$work/Snakefile.small"
  snakemake -s "$work/Snakefile.small" -d "$work/over_memory" --profile "$share/profiles/slurm" > "$work/over_memory.out" 2>&1 ||
    cat "$work/over_memory.out"
  expect "over_memory: passed" 21 "$(rows over_memory passed)"
  expect "over_memory: snakemake tried again" 1 "$(grep -c 'Trying to restart' "$work/over_memory.out")"
}

refused_and_failed() {
  batch refused_and_failed 20 903 904 907
  through refused_and_failed && { echo "FAILED: snakemake says that all is well"; failures=$((failures + 1)); }
  hotblade batch gather "$work/refused_and_failed" --partial > /dev/null
  expect "refused_and_failed: passed" 20 "$(rows refused_and_failed passed)"
  expect "refused_and_failed: bad input" 1 "$(rows refused_and_failed 'bad input')"
  expect "refused_and_failed: refused" 1 "$(rows refused_and_failed refused)"
  expect "refused_and_failed: failed" 1 "$(rows refused_and_failed failed)"
  expect "refused_and_failed: named" 1 "$(hotblade batch status "$work/refused_and_failed" | grep -c 'failed: panel p907')"
}

nothing_to_do() {
  batch nothing_to_do 40
  through nothing_to_do || cat "$work/nothing_to_do.out"
  through nothing_to_do
  expect "nothing_to_do: said" 1 "$(grep -c 'Nothing to be done' "$work/nothing_to_do.out")"
  expect "nothing_to_do: started" 40 "$(grep -c ^start "$STAND_IN_LOG")"
}

for trial in "${trials[@]}"; do
  echo "$trial"
  SECONDS=0
  "$trial"
  echo "  ${SECONDS} s"
done
((failures == 0))
