"""Writes the project of docs/library.md into a directory: write_projects.py PAGE DIRECTORY

Each code block that begins with a line `# NAME` or `// NAME` is that file. Exits with 1 where a program is 30 lines or
longer.
"""
import pathlib
import re
import sys


def main(page, directory):
    blocks = re.findall(r"^```(?:cmake|cpp)\n(?:#|//) (\S+)\n(.*?)^```", pathlib.Path(page).read_text(), re.M | re.S)
    if sorted(name for name, _ in blocks) != ["CMakeLists.txt", "curves.cpp", "plan.cpp", "stream.cpp"]:
        print(f"{page}: has the files {[name for name, _ in blocks]}")
        return 1
    for name, text in blocks:
        if text.count("\n") >= 30:
            print(f"{page}: {name} has {text.count(chr(10))} lines, 29 at most")
            return 1
        (pathlib.Path(directory) / name).write_text(text)
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
