#!/usr/bin/env python3
"""Runs clang-tidy on the sources that changed, and prints what it says of the lines that changed.

usage: check_tidy.py ROOT BUILD FROM [SECONDS]
BUILD holds a compile_commands.json in which every source stands for itself. The changes are those from the commit FROM to
the working tree. Where only a header changed, the first source that includes it is checked in its place. After SECONDS no
further file is started, and those left are named. Prints what was checked; exit code 1 when something is found that
.clang-tidy takes for an error, or when clang cannot compile a source."""
import concurrent.futures
import json
import os
import re
import subprocess
import sys
import time

ROOMS = ("elastica/", "surface/", "gpu/", "robot/", "pipeline/", "samples/", "tests/")


def git(root, *words):
    return subprocess.run(["git", "-C", root, *words], check=True, capture_output=True, text=True).stdout


def changed_lines(diff):
    """Lines that a `git diff -U0` adds or changes, as ranges of each file."""
    lines, file = {}, None
    for row in diff.splitlines():
        if row.startswith("+++ "):
            file = row[6:] if row.startswith("+++ b/") else None
        hunk = re.match(r"@@ -\S+ \+(\d+)(?:,(\d+))? @@", row)
        if hunk and file:
            first, count = int(hunk[1]), int(hunk[2] or 1)
            if count:
                lines.setdefault(file, []).append([first, first + count - 1])
    return lines


def sources_of(changed, compiled, root):
    """The compiled sources to look at: the changed ones, and one for each header that none of them includes."""
    sources = [f for f in changed if f in compiled]
    text = {}

    def includes(source, header):
        if source not in text:
            with open(os.path.join(root, source), encoding="utf-8") as file:
                text[source] = file.read()
        return f'#include "{header}"' in text[source]

    for header in (f for f in changed if f.endswith(".hpp")):
        if any(includes(source, header) for source in sources):
            continue
        beside = header[:-4] + ".cpp"
        others = [beside] if beside in compiled else []
        found = next((s for s in others + sorted(compiled) if includes(s, header)), None)
        if found:
            sources.append(found)
    return sources


def tidied(root, build, source, line_filter, deadline):
    """What clang-tidy prints about a source; None where the time was up before it began."""
    if time.monotonic() > deadline:
        return None
    # CMake's compiler is g++, some of whose warning options clang does not know.
    command = ["clang-tidy", "--quiet", "-p", build, f"--line-filter={line_filter}",
               "--extra-arg=-Wno-unknown-warning-option", os.path.join(root, source)]
    done = subprocess.run(command, capture_output=True, text=True)
    found = [row for row in done.stdout.splitlines() if re.search(r": (warning|error): ", row)]
    # A source that clang cannot compile is not checked: that is a finding too.
    if done.returncode and not found:
        found = [f"{source}: error: clang-tidy ended with {done.returncode}: {done.stderr.strip()[-300:]}"]
    return found


def main(root, build, start, seconds):
    began = time.monotonic()
    lines = {f: r for f, r in changed_lines(git(root, "diff", "-U0", start, "--", *ROOMS)).items()
             if f.endswith((".cpp", ".hpp", ".h"))}
    with open(os.path.join(build, "compile_commands.json"), encoding="utf-8") as file:
        compiled = {os.path.relpath(entry["file"], root) for entry in json.load(file)}
    # Sources that the build writes are nobody's to tidy, and in a fresh tree not there yet.
    compiled = {source for source in compiled if source.startswith(ROOMS)}
    sources = sources_of(sorted(lines), compiled, root)
    line_filter = json.dumps([{"name": name, "lines": ranges} for name, ranges in lines.items()])
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        results = list(pool.map(lambda s: tidied(root, build, s, line_filter, began + seconds), sources))
    checked = [s for s, found in zip(sources, results) if found is not None]
    left = [s for s, found in zip(sources, results) if found is None]
    findings = sorted({row for found in results if found for row in found})
    print("\n".join(findings), end="\n" if findings else "")
    print(f"clang-tidy: {len(lines)} files changed since {start[:12]}, {len(checked)} sources checked in "
          f"{time.monotonic() - began:.0f} s, {len(findings)} findings in changed lines")
    for source in checked:
        print(f"  checked {source}")
    for source in left:
        print(f"  not checked, the time was up: {source}")
    return 1 if any(": error: " in row for row in findings) else 0


if __name__ == "__main__":
    if len(sys.argv) not in (4, 5):
        sys.exit(__doc__)
    sys.exit(main(os.path.abspath(sys.argv[1]), *sys.argv[2:4], float(sys.argv[4]) if len(sys.argv) == 5 else 900))
