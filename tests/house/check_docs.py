"""Checks what the documents say about the tree: check_docs.py ROOT
  link  a relative link in README.md, CHANGELOG.md, docs/ or samples/ leads to a file, and to a heading where it names one
  path  a file or folder of a room, the tests or the documents that is named in `code` exists (not in CHANGELOG.md)
  test  a `Suite.Name` in README.md or docs/promises.md is a test; * stands for anything, a name may end in ...
  room  docs/house.md has the rooms of tests/house/check_house.sh in their order, each with its target
  way   the stranger's path in docs/house.md takes at most three clicks, each on a link of README.md or of a page before,
        and what an item names in `code` stands in the source it leads to
Prints one line a breach, `file:line: rule: what`, and exits with 1 when there is any, with 2 when there is no document.
"""
import fnmatch
import pathlib
import re
import sys

LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")
CODE = re.compile(r"`([^`]+)`")
PATH = re.compile(r"(?:elastica|surface|gpu|robot|pipeline|tests|docs|samples|cmake)/[\w./*-]*")
TEST_NAME = re.compile(r"[A-Z]\w*\*?\.(?:\*|[A-Z]\w*(?:\.\.\.)?)")
TEST = re.compile(r"\b(?:TYPED_)?TEST(?:_[FP])?\(\s*(\w+)\s*,\s*(\w+)")
CTEST = re.compile(r"add_test\(\s*NAME\s+(\w+\.\w+)")
ROOM_ROW = re.compile(r"\| `([\w/]+)` \| `(\w+)` \|")
WAY = re.compile(r"^## A stranger's path\n(.*?)(?=^## |\Z)", re.S | re.M)
MOST_CLICKS = 3
DOWNHILL = re.compile(r"downhill='\n(.*?)\n'", re.S)


def documents(root):
    found = [root / "README.md", root / "CHANGELOG.md", *(root / "docs").glob("*.md"), *(root / "samples").glob("*.md")]
    return sorted(file for file in found if file.is_file())


def anchors(file):
    """The fragments by which the headings of a document are reached."""
    headings = re.findall(r"^#+ +(.*)$", file.read_text(), re.M)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def link_breach(file, target):
    if re.match(r"[a-z]+:", target):
        return None
    path, _, fragment = target.partition("#")
    reached = file.parent / path if path else file
    if not reached.exists():
        return f"link: {target} leads nowhere"
    if fragment and reached.suffix == ".md" and fragment not in anchors(reached):
        return f"link: {target} names no heading there"
    return None


def path_breach(root, code):
    if not PATH.fullmatch(code) or any(root.glob(code.rstrip("/"))):
        return None
    return f"path: `{code}` is not there"


def tests_of(root):
    names = set()
    for file in (root / "tests").rglob("*.cpp"):
        names.update(f"{suite}.{name}" for suite, name in TEST.findall(file.read_text()))
    for file in (root / "tests").rglob("CMakeLists.txt"):
        names.update(CTEST.findall(file.read_text()))
    return names


def test_breach(tests, code):
    if not TEST_NAME.fullmatch(code):
        return None
    pattern = code[:-3] + "*" if code.endswith("...") else code
    return None if fnmatch.filter(tests, pattern) else f"test: `{code}` is no test"


def room_breaches(root):
    page, table = root / "docs/house.md", root / "tests/house/check_house.sh"
    if not (page.is_file() and table.is_file()):
        return
    wanted = [line.partition(":")[0] for line in DOWNHILL.search(table.read_text())[1].splitlines()]
    rows = ROOM_ROW.findall(page.read_text())
    if [room for room, _ in rows] != wanted:
        missing = [room for room in wanted if room not in dict(rows)]
        yield f"docs/house.md:1: room: not the rooms of check_house.sh in their order; missing: {' '.join(missing) or 'none'}"
    for room, target in rows:
        if target != "hotblade_" + room.replace("/", "_"):
            yield f"docs/house.md:1: room: {target} is not the target of {room}"


def links_of(file):
    targets = (target.partition("#")[0] for target in LINK.findall(file.read_text()))
    return {(file.parent / target).resolve() for target in targets}


def way_breaches(root):
    page = root / "docs/house.md"
    path = WAY.search(page.read_text()) if page.is_file() else None
    if not path:
        return
    items = re.split(r"^\d+\. ", path[1], flags=re.M)[1:]
    if not 1 <= len(items) <= MOST_CLICKS:
        yield f"docs/house.md:1: way: {len(items)} clicks, not 1 to {MOST_CLICKS}"
    within_reach = links_of(root / "README.md")
    for item in items:
        target = LINK.search(item)[1]
        file = (page.parent / target).resolve()
        if file not in within_reach:
            yield f"docs/house.md:1: way: {target} is not linked before"
        if not file.is_file():
            continue
        within_reach |= links_of(file) if file.suffix == ".md" else set()
        for code in CODE.findall(LINK.sub("", item)):
            if code not in file.read_text():
                yield f"docs/house.md:1: way: `{code}` is not in {target}"


def breaches(root):
    tests = tests_of(root)
    for file in documents(root):
        name = file.relative_to(root).as_posix()
        for number, line in enumerate(file.read_text().splitlines(), 1):
            found = [link_breach(file, target) for target in LINK.findall(line)]
            if name != "CHANGELOG.md":
                found += [path_breach(root, code) for code in CODE.findall(line)]
            if name in ("README.md", "docs/promises.md"):
                found += [test_breach(tests, code) for code in CODE.findall(line)]
            yield from (f"{name}:{number}: {what}" for what in found if what)
    yield from room_breaches(root)
    yield from way_breaches(root)


def main():
    root = pathlib.Path(sys.argv[1])
    if not documents(root):
        print(f"{root}: no documents found")
        return 2
    found = list(breaches(root))
    print("".join(line + "\n" for line in found), end="")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
