#!/usr/bin/env bash
# Installs a build into an empty place and uses it from there: the program, its manual page and completion, and the
# library from a project of its own. Usage: install_test.sh BUILD_DIR SOURCE_DIR
set -euo pipefail
build=$1 source=$2
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT

cmake --install "$build" --prefix "$place/usr" > "$place/install.log"
program=$place/usr/bin/hotblade
"$program" --version | grep -q '^hotblade ' || { echo "the installed program does not run"; exit 1; }
(cd "$place" && "$program" check "$place/usr/share/doc/hotblade/samples/hypar.obj" --units mm > /dev/null)

manual=$place/usr/share/man/man1/hotblade.1
for command in check plan verify preview export sim run dryrun curve config; do
  grep -q "^\.SS hotblade $command" "$manual" || { echo "the manual page lacks $command"; exit 1; }
done

completed=$(bash -c '
  source "$1"
  COMP_WORDS=(hotblade preview --color ""); COMP_CWORD=3; _hotblade; echo "${COMPREPLY[*]}"
  COMP_WORDS=(hotblade ver); COMP_CWORD=1; _hotblade; echo "${COMPREPLY[*]}"
  COMP_WORDS=(hotblade curve project --me); COMP_CWORD=3; _hotblade; echo "${COMPREPLY[*]}"
' - "$place/usr/share/bash-completion/completions/hotblade")
[[ $completed == "deviation strip curvature margin feed"$'\n'"verify"$'\n'"--method" ]] ||
  { echo "completion offers: $completed"; exit 1; }

# Headers that are installed include no header that is not.
include=$place/usr/include/hotblade
missing=$(grep -rhoE '^ *# *include "[^"]+"' "$include" | sed -E 's/.*"(.*)"/\1/' | sort -u |
  while read -r header; do [[ -f $include/$header ]] || echo "$header"; done)
[[ -z $missing ]] || { echo "not installed, but included: $missing"; exit 1; }

cmake -S "$source/tests/install/consumer" -B "$place/consumer" -G Ninja -DCMAKE_BUILD_TYPE=Release \
  -DCMAKE_PREFIX_PATH="$place/usr" > "$place/consumer.log" || { cat "$place/consumer.log"; exit 1; }
cmake --build "$place/consumer" > "$place/consumer.log" || { cat "$place/consumer.log"; exit 1; }
"$place/consumer/consumer" || { echo "the consumer's curve is wrong"; exit 1; }

# The project of docs/library.md: curves, a plan, a program streamed to a simulator.
mkdir "$place/job"
python3 "$source/tests/install/write_projects.py" "$source/docs/library.md" "$place/job"
cmake -S "$place/job" -B "$place/job/build" -G Ninja -DCMAKE_BUILD_TYPE=Release \
  -DCMAKE_PREFIX_PATH="$place/usr" > "$place/job.log" || { cat "$place/job.log"; exit 1; }
cmake --build "$place/job/build" > "$place/job.log" || { cat "$place/job.log"; exit 1; }
cd "$place/job/build"
[[ $(./curves | wc -l) == 3 ]] || { echo "curves: says something else"; exit 1; }
samples=$place/usr/share/doc/hotblade/samples
./plan "$samples/bump.toml" "$samples/bump.obj" program.json 2> plan.log || { cat plan.log; exit 1; }
"$program" plan "$samples/bump.obj" --units mm --config "$samples/bump.toml" --pictures none -q -o planned > /dev/null
cmp program.json planned/program.json || { echo "plan: another program than the command's"; exit 1; }
# What draws is a library that the program opens where it is installed.
"$program" preview planned/program.json --shot cut.png > /dev/null || { echo "the installed program does not draw"; exit 1; }
[[ $(head -c 4 cut.png | tail -c 3) == PNG ]] || { echo "preview: no picture"; exit 1; }
library=$(find "$place/usr" -name libhotblade_drawing.so)
cp "$(ldd "$program" | awk '/libz\.so|libm\.so/ { print $3; exit }')" "$library"
code=0
"$program" preview planned/program.json --shot none.png 2> undrawn.log || code=$?
[[ $code -ne 0 && ! -e none.png ]] || { echo "preview with another library: exit code $code"; exit 1; }
grep -q "does not draw" undrawn.log || { echo "preview does not say that another library has the place"; cat undrawn.log; exit 1; }
rm "$library"
"$program" plan "$samples/bump.obj" --units mm --config "$samples/bump.toml" -o undrawn > /dev/null 2> undrawn.log ||
  { echo "no plan without what draws"; cat undrawn.log; exit 1; }
[[ -s undrawn/program.json && ! -e undrawn/preview.png ]] || { echo "a plan without what draws has a picture"; exit 1; }
grep -q "what draws cannot be opened" undrawn.log undrawn/report.html || { echo "nothing says why there are no pictures"; exit 1; }
code=0
"$program" preview planned/program.json --shot none.png 2> undrawn.log || code=$?
[[ $code -ne 0 && ! -e none.png ]] || { echo "preview without what draws: exit code $code"; exit 1; }
grep -q "what draws cannot be opened" undrawn.log || { echo "preview does not say why nothing is drawn"; cat undrawn.log; exit 1; }
"$program" sim --listen 127.0.0.1:0 --time-scale max --log execution.jsonl > sim.log 2>&1 &
simulator=$!
trap 'kill "$simulator" 2> /dev/null || true; rm -rf "$place"' EXIT
for _ in $(seq 100); do
  port=$(sed -nE 's/.*127\.0\.0\.1:([0-9]+).*/\1/p' sim.log | head -1)
  [[ -z $port ]] || break
  sleep 0.1
done
[[ -n $port ]] || { echo "the simulator does not listen"; cat sim.log; exit 1; }
./stream program.json "$port" > stream.log || { cat stream.log; exit 1; }
strips=$(grep -oE '"id": *"S[0-9]+"' program.json | sort -u | wc -l)
[[ $strips -gt 0 && $(grep -c 'waypoints executed' stream.log) == "$strips" ]] || { echo "stream: not every strip"; cat stream.log; exit 1; }
if ldd plan | grep -E 'vtk|libGL\.|libEGL|libX11'; then echo "plan: links what draws"; exit 1; fi
