#!/usr/bin/env bash
# Checks the rules of the house on a source tree: check_house.sh ROOT [HEADER_LIST]
#   room         a source file lies in a room of the house
#   direction    a room includes only the rooms below it (the table `downhill`)
#   root         quoted includes are written from the project root
#   heavy        heavy libraries stay out of headers, but for the private ones
#   private      a private header is included by sources of its big room only, never by a header
#   long         no source file over 600 lines
#   json         the pipeline writes JSON by json_text(), which takes names that are no UTF-8
#   stray        the root has no files but those of the project: what a trial writes goes elsewhere
#   unlisted     every header is in HEADER_LIST, the file that names those compiled alone (when given)
# Prints one line a breach, `file:line: rule: what`, and exits with 1 when there is any, with 2 when there is nothing to
# check.
set -euof pipefail  # -f: room/* is a name here, no pattern of files
root=$1
header_list=${2:-}
cd "$root"

readonly rooms='elastica surface gpu robot pipeline'
readonly heavy='^(CGAL/|OpenMesh/|ceres/|vtk|modbus|embree|tbb/|CL/|cuda|CLI/|toml|tinyxml2|fcl/)'
readonly max_lines=600
readonly root_files='CHANGELOG.md CMakeLists.txt CMakePresets.json README.md pyproject.toml run setup.py'

# Headers that only sources may include: the half-edge mesh is a template of OpenMesh, which the reader, the repair and
# the slicer walk inline, millions of edges at a time.
readonly private_headers='surface/read/half_edges.hpp'

# The house, lowest room first: each inner room with the rooms it may include beside itself. `room/*` stands for a
# whole big room. A line may name only rooms above it in this table, so the table itself has no circle.
readonly downhill='
elastica/kernels:
elastica/linear:
elastica/curve: elastica/kernels
elastica/bezier: elastica/kernels elastica/linear elastica/curve
elastica/fit: elastica/kernels elastica/linear elastica/curve elastica/bezier
elastica/projection: elastica/kernels elastica/curve elastica/bezier elastica/fit
elastica/blade: elastica/kernels elastica/linear elastica/curve
elastica/quadratic: elastica/kernels elastica/linear elastica/curve
elastica/arcs: elastica/kernels elastica/curve
surface/read:
surface/slice: surface/read
gpu/kernels: elastica/kernels
gpu/backend: elastica/kernels gpu/kernels
gpu/mesh: elastica/kernels gpu/kernels gpu/backend
gpu/curve: elastica/kernels gpu/kernels gpu/backend
robot/pose: elastica/*
robot/blade: elastica/* robot/pose
robot/wire: elastica/* robot/pose robot/blade
robot/arm: elastica/* robot/pose
robot/controller: elastica/* robot/pose robot/blade robot/wire robot/arm
robot/client: elastica/* robot/pose robot/blade robot/wire
pipeline/sayings:
pipeline/settings: elastica/* robot/pose robot/blade
pipeline/cell: elastica/* robot/pose robot/arm pipeline/sayings pipeline/settings
pipeline/program: elastica/* surface/* robot/* pipeline/settings
pipeline/verify: elastica/* surface/* gpu/* robot/* pipeline/sayings pipeline/settings pipeline/program
pipeline/calibrate: elastica/* surface/* gpu/* robot/* pipeline/settings pipeline/program pipeline/verify
pipeline/plan/ribs: elastica/* surface/* gpu/* robot/* pipeline/settings pipeline/program pipeline/verify
pipeline/plan/motion: elastica/* surface/* gpu/* robot/* pipeline/sayings pipeline/settings pipeline/program pipeline/verify pipeline/plan/ribs
pipeline/plan/arms: elastica/* gpu/backend robot/* pipeline/sayings pipeline/settings pipeline/cell pipeline/program pipeline/verify pipeline/plan/motion
pipeline/plan/direction: elastica/* surface/* gpu/* robot/* pipeline/settings pipeline/program pipeline/verify pipeline/plan/ribs pipeline/plan/motion
pipeline/plan/sweep: elastica/* surface/* gpu/* robot/* pipeline/sayings pipeline/settings pipeline/program pipeline/verify pipeline/plan/ribs pipeline/plan/motion pipeline/plan/direction
pipeline/stock: elastica/* robot/* pipeline/settings pipeline/program
pipeline/plan: elastica/* surface/* gpu/* robot/* pipeline/sayings pipeline/settings pipeline/program pipeline/verify pipeline/plan/ribs pipeline/plan/motion pipeline/plan/direction pipeline/plan/sweep pipeline/stock
pipeline/advice: elastica/* surface/* gpu/* robot/* pipeline/sayings pipeline/settings pipeline/cell pipeline/program pipeline/verify pipeline/plan/motion pipeline/plan/arms pipeline/plan
pipeline/report/json: elastica/* robot/* pipeline/settings pipeline/program pipeline/verify pipeline/plan
pipeline/run: elastica/* surface/* gpu/* robot/* pipeline/settings pipeline/program pipeline/verify
pipeline/preview: elastica/* surface/* gpu/* robot/* pipeline/settings pipeline/program pipeline/verify
pipeline/preview/drawing: elastica/* surface/* gpu/* robot/* pipeline/settings pipeline/program pipeline/verify pipeline/preview
pipeline/export: elastica/* surface/* gpu/* robot/* pipeline/settings pipeline/cell pipeline/program pipeline/verify
pipeline/report: elastica/* surface/* gpu/* robot/* pipeline/sayings pipeline/settings pipeline/program pipeline/verify pipeline/plan/ribs pipeline/plan/motion pipeline/plan/direction pipeline/stock pipeline/plan pipeline/advice pipeline/report/json pipeline/preview pipeline/export
pipeline/study: elastica/* pipeline/settings pipeline/program
pipeline/batch: elastica/* surface/* pipeline/settings pipeline/program pipeline/stock
pipeline/cli: elastica/* surface/* gpu/* robot/* pipeline/sayings pipeline/settings pipeline/cell pipeline/program pipeline/verify pipeline/calibrate pipeline/plan/arms pipeline/plan pipeline/advice pipeline/run pipeline/preview pipeline/export pipeline/report/json pipeline/report pipeline/study pipeline/batch
'

declare -A may
while IFS=: read -r inner included; do
  [[ -z $inner ]] || may[$inner]=" $inner$included "
done <<< "$downhill"

# Whether the table names only rooms that stand above the line.
check_table() {
  local inner included above=' ' target
  while IFS=: read -r inner included; do
    [[ -n $inner ]] || continue
    for target in $included; do
      [[ $target == *'/*' || $above == *" $target "* ]] || echo "$inner: circle: $target is not below it"
      [[ $target != "${inner%%/*}/*" ]] || echo "$inner: circle: $target holds it"
    done
    above+="$inner "
  done <<< "$downhill"
}

# Whether a file of the inner room $1 may include a file of the inner room $2.
may_include() {
  [[ ${may[$1]:-} == *" $2 "* || ${may[$1]:-} == *" ${2%%/*}/* "* ]]
}

check_quoted_include() {
  local file=$1 line=$2 target=$3 room=${1%/*}
  if [[ " $rooms " != *" ${target%%/*} "* ]]; then
    echo "$file:$line: root: \"$target\" does not start with a room"
  elif ! may_include "$room" "${target%/*}"; then
    echo "$file:$line: direction: $room may not include \"$target\""
  elif [[ " $private_headers " == *" $target "* && ($file == *.hpp || ${file%%/*} != "${target%%/*}") ]]; then
    echo "$file:$line: private: only sources of ${target%%/*} may include \"$target\""
  fi
}

check_file() {
  local file=$1 line text target
  [[ -n ${may[${file%/*}]:-} ]] || echo "$file:1: room: ${file%/*} is no room of the house"
  while IFS=: read -r line text; do
    if [[ $text =~ \#[[:space:]]*include[[:space:]]*\"([^\"]+)\" ]]; then
      check_quoted_include "$file" "$line" "${BASH_REMATCH[1]}"
    elif [[ $file == *.hpp && $text =~ \#[[:space:]]*include[[:space:]]*\<([^\>]+)\> ]]; then
      target=${BASH_REMATCH[1]}
      [[ ! $target =~ $heavy || " $private_headers " == *" $file "* ]] || echo "$file:$line: heavy: <$target> belongs in a .cpp"
    fi
  done < <(grep -nE '^[[:space:]]*#[[:space:]]*include' "$file" || true)
  if [[ $file == pipeline/* && $file != pipeline/settings/json_text.cpp ]]; then
    while IFS=: read -r line text; do
      echo "$file:$line: json: dump() ends at a name that is no UTF-8: json_text() does not"
    done < <(grep -nE '[.>]dump\(' "$file" || true)
  fi
  line=$(wc -l < "$file")
  ((line <= max_lines)) || echo "$file:$line: long: $line lines, at most $max_lines"
  if [[ -n $header_list && $file == *.hpp ]] && ! grep -qxF "$file" "$header_list"; then
    echo "$file:1: unlisted: not in its room's HEADERS, so not compiled alone"
  fi
}

files=0
breaches=0
table=$(check_table)
[[ -z $table ]] || { echo "$table"; exit 1; }
for room in $rooms; do
  [[ -d $room ]] || continue
  while read -r file; do
    files=$((files + 1))
    found=$(check_file "$file")
    [[ -z $found ]] || { echo "$found"; breaches=$((breaches + 1)); }
  done < <(find "$room" -type f \( -name '*.hpp' -o -name '*.cpp' -o -name '*.h' -o -name '*.cl' \) | LC_ALL=C sort)
done
while read -r file; do
  [[ " $root_files " != *" $file "* ]] || continue
  echo "$file:1: stray: no file of the root"
  breaches=$((breaches + 1))
done < <(find . -maxdepth 1 -type f ! -name '.*' -printf '%P\n' | LC_ALL=C sort)
((files > 0)) || { echo "$root: no source files found"; exit 2; }
((breaches == 0)) || exit 1
