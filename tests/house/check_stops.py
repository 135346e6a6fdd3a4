"""Names the parallel loops of planning that are not followed by a stop point: check_stops.py ROOT

Where one loop is ended (gpu/backend/stop.hpp), those beside it return half done: `stop_point();` is the next statement of
each in gpu, pipeline/plan and pipeline/verify, or a loop's body asks stop_asked() where nothing may be thrown.
Prints one line a loop, `file:line: stop: what`, and exits with 1 when there is any, with 2 when there is nothing to check.
"""
import pathlib
import re
import sys

FOLDERS = ("gpu", "pipeline/plan", "pipeline/verify")
# Called by `check` alone, which ends with its process.
APART = {"pipeline/plan/forecast.cpp"}
LOOP = re.compile(r"\btbb::parallel_\w+\(")


def end_of_call(text, at):
    """Where the parenthesis that opens at `at` is closed."""
    depth = 0
    for token in re.finditer(r'"(?:\\.|[^"\\])*"|\'(?:\\.|[^\'\\])\'|//[^\n]*|[()]', text[at:]):
        depth += {"(": 1, ")": -1}.get(token[0], 0)
        if depth == 0:
            return at + token.start()
    raise ValueError("a parenthesis that is not closed")


def breaches(text):
    for loop in LOOP.finditer(text):
        end = end_of_call(text, loop.end() - 1)
        if re.match(r"\);\s*(?:gpu::)?stop_point\(\);", text[end:]) or "stop_asked()" in text[loop.start():end]:
            continue
        yield text.count("\n", 0, loop.start()) + 1


def main(root):
    root = pathlib.Path(root)
    files = [f for folder in FOLDERS for f in sorted((root / folder).rglob("*.cpp"))]
    found = [f"{f.relative_to(root)}:{line}: stop: a parallel loop without a stop point after it"
             for f in files if f.relative_to(root).as_posix() not in APART for line in breaches(f.read_text(encoding="utf-8"))]
    print("\n".join(found), end="\n" if found else "")
    return 2 if not files else 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
