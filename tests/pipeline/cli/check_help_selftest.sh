#!/usr/bin/env bash
# Shows that check_help.py can fail: a program whose help, manual page and document agree, and the same with one option
# or command left out of one of the three.
set -euo pipefail
check="$(dirname "${BASH_SOURCE[0]}")/check_help.py"
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
mkdir "$tree/docs"

fail() {
  echo "$1"
  exit 1
}

cat > "$tree/hotblade" <<'TXT'
#!/usr/bin/env bash
here=$(dirname "$0")
case "$*" in
  --help) cat "$here/help" ;;
  'cut --help') cat "$here/help-cut" ;;
  'completion man') cat "$here/man" ;;
esac
TXT
chmod +x "$tree/hotblade"

agree() {
  cat > "$tree/help" <<'TXT'
Options:
  -h,--help                   Print this help

Subcommands:
  cut                         Cut
TXT
  cat > "$tree/help-cut" <<'TXT'
Positionals:
  block FILE REQUIRED         The block

Options:
  -h,--help                   Print this help
  --heat low|high             How hot
  -o,--output DIR-OF-ALL-FILES REQUIRED
                              Where to
TXT
  cat > "$tree/man" <<'TXT'
.SH OPTIONS
.TP
.B \-h, \-\-help
Print this help
.SS hotblade cut
Cut
.TP
.B block
The block
.TP
.B \-h, \-\-help
Print this help
.TP
.B \-\-heat low|high
How hot
.TP
.B \-o, \-\-output DIR\-OF\-ALL\-FILES
Where to
TXT
  cat > "$tree/docs/commands.md" <<'TXT'
## Global options
| option | meaning |
|---|---|
| `-h`, `--help` | print the help |

## hotblade cut

    hotblade cut block.json [--heat low|high] -o DIR

`--heat` says how hot.
TXT
  echo '    hotblade cut block.json -o all' > "$tree/README.md"
}

# differs FILE SED_SCRIPT WORDS: with that change to FILE the check must name these words.
differs() {
  agree
  sed -i "$2" "$tree/$1"
  local code=0 found
  found=$(python3 "$check" "$tree/hotblade" "$tree") || code=$?
  [[ $code -eq 1 ]] || fail "$1 changed by $2 must end with 1, not $code"
  [[ $found == *"$3"* ]] || fail "$1 changed by $2: expected \"$3\", found: $found"
}

agree
found=$(python3 "$check" "$tree/hotblade" "$tree") || fail "what agrees must pass, but: $found"
[[ -z $found ]] || fail "what agrees must pass in silence, but: $found"

differs help-cut '/--heat/d' 'man: `cut` --heat low|high is missing in --help'
differs help-cut '/--heat/d' 'synopsis: `cut` --heat is missing in --help'
differs help-cut '/--heat/d' 'word: commands.md:10: --heat is no option of `cut`'
differs help-cut 's/low|high/low|mid /' 'synopsis: `cut` --heat low|mid has other words in docs/commands.md'
differs man '/heat low/d' 'man: `cut` --heat low|high is missing in the manual page'
differs man 's/low|high/low/' 'man: `cut` --heat low|high is missing in the manual page'
differs man '/^\.SS/,$d' 'man: `cut` is missing in the manual page'
differs docs/commands.md 's/ \[--heat low|high\]//' 'synopsis: `cut` --heat low|high is missing in docs/commands.md'
differs docs/commands.md '/^    hotblade/d' 'synopsis: `cut` has none in docs/commands.md'
differs docs/commands.md 's/`-h`, //' 'global: -h is missing in docs/commands.md'
differs README.md 's/ -o / --out /' 'word: README.md:1: --out is no option of `cut`'
differs README.md 's/ cut / cat /' 'word: README.md:1: `cat` is no command'
