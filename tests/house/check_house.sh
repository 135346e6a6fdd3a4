#!/usr/bin/env bash
# Checks the rules of the house on a source tree: check_house.sh ROOT [HEADER_LIST]
#   direction    a room includes only the rooms it may
#   root         quoted includes are written from the project root
#   heavy        heavy libraries stay out of headers
#   long         no source file over 600 lines
#   unlisted     every header is in HEADER_LIST, the file that names those compiled alone (when given)
# Prints one line a breach, `file:line: rule: what`, and exits with 1 when there is any, with 2 when there is nothing to
# check.
set -euo pipefail
root=$1
header_list=${2:-}
cd "$root"

readonly rooms='elastica surface gpu robot pipeline'
readonly heavy='^(CGAL/|OpenMesh/|ceres/|vtk|modbus|embree|tbb/|CL/|cuda|CLI/|toml)'
readonly max_lines=600

# Whether a file of room $1 may include the file $2.
may_include() {
  case $1:$2 in
    pipeline:*) true ;;
    "$1:$1/"*) true ;;
    gpu:elastica/kernels/*) true ;;
    robot:elastica/*) true ;;
    *) false ;;
  esac
}

check_quoted_include() {
  local file=$1 line=$2 target=$3 room=${1%%/*} target_room=${3%%/*}
  if [[ " $rooms " != *" $target_room "* ]]; then
    echo "$file:$line: root: \"$target\" does not start with a room"
  elif ! may_include "$room" "$target"; then
    echo "$file:$line: direction: $room may not include \"$target\""
  fi
}

check_file() {
  local file=$1 line text target
  while IFS=: read -r line text; do
    if [[ $text =~ \#[[:space:]]*include[[:space:]]*\"([^\"]+)\" ]]; then
      check_quoted_include "$file" "$line" "${BASH_REMATCH[1]}"
    elif [[ $file == *.hpp && $text =~ \#[[:space:]]*include[[:space:]]*\<([^\>]+)\> ]]; then
      target=${BASH_REMATCH[1]}
      [[ ! $target =~ $heavy ]] || echo "$file:$line: heavy: <$target> belongs in a .cpp"
    fi
  done < <(grep -nE '^[[:space:]]*#[[:space:]]*include' "$file" || true)
  line=$(wc -l < "$file")
  ((line <= max_lines)) || echo "$file:$line: long: $line lines, at most $max_lines"
  if [[ -n $header_list && $file == *.hpp ]] && ! grep -qxF "$file" "$header_list"; then
    echo "$file:1: unlisted: not in its room's HEADERS, so not compiled alone"
  fi
}

files=0
breaches=0
for room in $rooms; do
  [[ -d $room ]] || continue
  while read -r file; do
    files=$((files + 1))
    found=$(check_file "$file")
    [[ -z $found ]] || { echo "$found"; breaches=$((breaches + 1)); }
  done < <(find "$room" -type f \( -name '*.hpp' -o -name '*.cpp' -o -name '*.h' -o -name '*.cl' \) | LC_ALL=C sort)
done
((files > 0)) || { echo "$root: no source files found"; exit 2; }
((breaches == 0)) || exit 1
