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

cmake -S "$source/tests/install/consumer" -B "$place/consumer" -G Ninja -DCMAKE_BUILD_TYPE=Release \
  -DCMAKE_PREFIX_PATH="$place/usr" > "$place/consumer.log" || { cat "$place/consumer.log"; exit 1; }
cmake --build "$place/consumer" > "$place/consumer.log" || { cat "$place/consumer.log"; exit 1; }
"$place/consumer/consumer" || { echo "the consumer's curve is wrong"; exit 1; }
