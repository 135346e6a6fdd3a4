"""Names the source files of the rooms that no command reaches: check_doors.py ROOT

A file is reached from the program's main, from what gives itself to the program when that opens a library, and from what
makes generated sources. A reached file reaches what it includes, and
the kernel (.cl) whose embedded text it names. A reached header reaches the sources that define what it declares: the one of
its name; else those whose name goes on after its name (project.hpp: project_search.cpp); else, for a source that no header
of its folder names, those that take the header in.
Prints one line a file without a door, `file:1: door: what`, and exits with 1 when there is any, with 2 when there is nothing
to check.
"""
import pathlib
import re
import sys

ROOMS = ("elastica", "surface", "gpu", "robot", "pipeline")
ROOTS = ("pipeline/cli/main.cpp", "pipeline/preview/drawing/library.cpp", "elastica/projection/generate_valleys.cpp")
KINDS = {".hpp", ".cpp", ".h", ".cl"}
INCLUDE = re.compile(r'^\s*#\s*include\s*"([^"]+)"', re.MULTILINE)
KERNEL = re.compile(r"\b(\w+)_source\b")


class House:
    def __init__(self, root):
        files = [f for room in ROOMS for f in (root / room).rglob("*") if f.suffix in KINDS]
        self.texts = {f.relative_to(root).as_posix(): f.read_text(encoding="utf-8") for f in files}
        self.includes = {f: [i for i in INCLUDE.findall(t) if i in self.texts] for f, t in self.texts.items()}
        self.sources = {}  # by the header that declares what they define
        for source in (f for f in self.texts if f.endswith(".cpp")):
            for header in self.headers_of(source):
                self.sources.setdefault(header, []).append(source)
        self.kernels = {pathlib.Path(f).stem: f for f in self.texts if f.endswith(".cl")}

    def headers_of(self, source):
        """Headers that declare what a source defines."""
        stem = source.removesuffix(".cpp")
        folder, _, name = stem.rpartition("/")
        parts = name.split("_")
        for count in range(len(parts), 0, -1):
            header = f"{folder}/{'_'.join(parts[:count])}.hpp"
            if header in self.texts:
                return [header]
        return sorted(self.taken_in(source, folder))

    def taken_in(self, file, folder, seen=None):
        """Headers of a folder that a file includes, also through one another."""
        seen = set() if seen is None else seen
        for header in self.includes[file]:
            if header.rpartition("/")[0] == folder and header not in seen:
                seen.add(header)
                self.taken_in(header, folder, seen)
        return seen

    def next_to(self, file):
        yield from self.includes[file]
        yield from self.sources.get(file, [])
        for kernel in KERNEL.findall(self.texts[file]):
            if kernel in self.kernels:
                yield self.kernels[kernel]

    def reached(self):
        waiting = [r for r in ROOTS if r in self.texts]
        found = set(waiting)
        while waiting:
            for file in self.next_to(waiting.pop()):
                if file not in found:
                    found.add(file)
                    waiting.append(file)
        return found


def main(root):
    house = House(pathlib.Path(root))
    reached = house.reached()
    if not reached:
        print(f"{root}: none of {', '.join(ROOTS)} is there")
        return 2
    without = sorted(set(house.texts) - reached)
    for file in without:
        print(f"{file}:1: door: no command reaches it")
    return 1 if without else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
