"""Counts what the house is measured by: count_house.py [REVISION]...

Prints a table with a column for each revision of this repository, and one for the working tree last: the types of a noun, the
includes that run uphill in today's order of rooms, the files that no command reaches, named constants of the plan, lines.

A file of an older revision counts as standing in the room where the file of its name stands today; files of names that are
gone, or that two rooms have, are left out of the uphill count.
"""
import collections
import pathlib
import re
import subprocess
import sys
import tempfile

import check_doors

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent

# Every name that the noun has had. A name counts as often as it is defined in the files whose path has a room of the third
# entry in it: `Block` is a block of foam in the pipeline, and some numbers at a time elsewhere.
NOUNS = (
    ("a strip at its stages", "ChainTarget Attempt Served StripPlan PosedStrip BladeMotion Done PlannedStrip SweptStrip Strip"
     " StripFacts Job LoggedJob ExecutedStrip RobotStrip RobotJob StripDryRun", ""),
    ("a foam block", "Stock Block StockRect StockOutline BlockAxes", "pipeline/"),
    ("the blade's data", "BladeSettings BladeData BladeSection ClampedBlade Blade BladeSet", ""),
    ("the clamps' places", "ClampPair ClampPose ClampPoses EndState HeldPose PlanarPose Waypoint", ""),
    ("which limit broke", "BladeStatus BranchStatus BranchLimit LimitCode Limit", ""),
)
UNION_FIND = re.compile(r"\bparent_?\[")
TURNED_FORCE = re.compile(r"\b\w+ \* \w+\.lambda1 [-+] \w+ \* \w+\.lambda2")
CONSTANT = re.compile(r"\bconstexpr\b[^;{(=]*?\bk[A-Z]\w*(?:\s*\[[^\]]*\])?\s*[={]")
MORE = re.compile(r",\s*k[A-Z]\w*\s*[={]")


def rooms_of(root):
    house = check_doors.House(root)
    return house.texts, house


def order():
    """Rooms as check_house.sh lists them, each with those it may include."""
    text = (HERE / "check_house.sh").read_text(encoding="utf-8")
    table = re.search(r"readonly downhill='\n(.*?)'", text, re.DOTALL).group(1)
    may = {}
    for line in table.strip().splitlines():
        room, _, below = line.partition(":")
        may[room] = {room, *below.split()}
    return may


def rooms_today():
    """The room of a file by its name, where only one room has such a file."""
    texts, _ = rooms_of(ROOT)
    rooms = collections.defaultdict(set)
    for file in texts:
        folder, _, name = file.rpartition("/")
        rooms[name].add(folder)
    return {name: folders.pop() for name, folders in rooms.items() if len(folders) == 1}


def uphill(house, may, today):
    count = 0
    for file, includes in house.includes.items():
        room = today.get(file.rpartition("/")[2])
        for included in includes:
            target = today.get(included.rpartition("/")[2])
            if room and target and target not in may[room] and target.split("/")[0] + "/*" not in may[room]:
                count += 1
    return count


def constants(texts):
    """Names in `constexpr double kA = 1, kB = 2;` count each."""
    count = 0
    for file, text in texts.items():
        if file.startswith("pipeline/plan/"):
            for found in CONSTANT.finditer(text):
                statement = text[found.start() : text.find(";", found.start())]
                count += 1 + len(MORE.findall(statement))
    return count


def lines(root, *folders):
    files = (f for folder in folders for f in (root / folder).rglob("*")
             if f.suffix in {".hpp", ".cpp", ".h", ".cl", ".py", ".sh"} and "build" not in f.relative_to(root).parts)
    return sum(f.read_bytes().count(b"\n") for f in files)


def figures(root, may, today):
    texts, house = rooms_of(root)
    result = {}
    for noun, names, within in NOUNS:
        defined = re.compile(r"^\s*(?:struct|class|enum class) (?:" + "|".join(names.split()) + r")\b[^;()]*\{", re.MULTILINE)
        result["types of " + noun] = sum(len(defined.findall(t)) for f, t in texts.items() if f.startswith(within))
    result["files with a union-find of their own"] = sum(bool(UNION_FIND.search(t)) for t in texts.values())
    result["places that turn (lambda1, lambda2) by hand"] = sum(len(TURNED_FORCE.findall(t)) for t in texts.values())
    result["includes that run uphill"] = uphill(house, may, today)
    result["files without a door"] = len(set(texts) - house.reached())
    result["named constants of pipeline/plan"] = constants(texts)
    result["files of the rooms"] = len(texts)
    result["lines of the rooms"] = lines(root, *check_doors.ROOMS)
    result["lines of tests"] = lines(root, "tests")
    return result


def main(revisions):
    may, today = order(), rooms_today()
    columns = []
    for revision in revisions:
        with tempfile.TemporaryDirectory() as folder:
            archive = subprocess.run(["git", "-C", ROOT, "archive", revision], check=True, capture_output=True)
            subprocess.run(["tar", "-x", "-C", folder], input=archive.stdout, check=True)
            columns.append((revision, figures(pathlib.Path(folder), may, today)))
    columns.append(("working tree", figures(ROOT, may, today)))
    print("| | " + " | ".join(name for name, _ in columns) + " |")
    print("|---" * (len(columns) + 1) + "|")
    for row in columns[0][1]:
        print(f"| {row} | " + " | ".join(f"{column[row]:,}" for _, column in columns) + " |")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
