#!/usr/bin/env bash
# completion_test.sh PROGRAM SHELL: what `hotblade completion SHELL` makes is loaded by that shell and completes commands,
# options, their values, settings and files. Exit code 77 where the shell is not installed.
set -euo pipefail
program=$(realpath "$1") shell=$2
command -v "$shell" > /dev/null || { echo "$shell is not installed"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/bin"
ln -s "$program" "$work/bin/hotblade"
PATH=$work/bin:$PATH
cd "$work"
touch vault_one.obj vault_two.obj
"$program" completion "$shell" > _hotblade

completed_bash() {
  bash --norc -c 'source ./_hotblade; COMP_WORDS=($1); [[ $1 != *" " ]] || COMP_WORDS+=("")
    COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _hotblade; printf "%s\n" "${COMPREPLY[@]}"' - "$1"
}
completed_fish() { fish --no-config -c 'source ./_hotblade; complete -C $argv[1]' "$1" | cut -f1; }
# A shell at a terminal, and the tabulator typed twice.
completed_zsh() {
  zsh -f -c 'zmodload zsh/zpty; zpty shell zsh -f -i
    zpty -w shell "PS1=; TERM=dumb; fpath=($PWD \$fpath); autoload -Uz compinit; compinit -u -D; LISTMAX=999; print \$((6*7))ready"
    zpty -r -m shell line "*42ready*"
    zpty -w -n shell "$1"$'"'\\t\\t'"'; said=""
    for ((i = 0; i < 200; ++i)); do
      sleep 0.05
      while zpty -r -t shell line; do said+=$line; done
      [[ $said != *$2* ]] || break
    done
    print -r -- $said; zpty -d shell' - "$1" "$2" | tr -d '\r\a'
}

failures=0
expect() { # expect LINE WORD: completing the line offers the word
  local said
  said=$("completed_$shell" "$1" "$2")
  grep -qF -- "$2" <<< "$said" || { echo "FAILED: $shell completes '$1' as: $said"; failures=$((failures + 1)); }
}
expect 'hotblade pl' plan
expect "hotblade help dry" dryrun
expect 'hotblade plan --tol' --tolerance
expect 'hotblade plan --units ' cm
expect 'hotblade plan --set design.kee' design.keep=
expect 'hotblade curve fit --en' --ends
expect 'hotblade curve fit --ends ' clamped
expect 'hotblade --progress ' json
expect 'hotblade check vault_o' vault_one.obj
((failures == 0))
