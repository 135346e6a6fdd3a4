"""Waypoint files and robot programs against the program's poses, worked out anew."""
import csv
import json
import math
import re
import xml.etree.ElementTree

from program_curves import cross, expect, expect_near, in_cell, load, main, product, turned

EXACT_MM = 1e-6
SAME_TURN = 1e-9
ROBOT_MM = 1e-4  # robot programs have four decimals


def path_of(strip):
    return [(p["t"], p["phase"], p["heat"], in_cell(strip, p["a"]), in_cell(strip, p["b"])) for p in strip["poses"]]


def expect_same_turn(got, want, limit, claim):
    difference = product([got[0]] + [-c for c in got[1:]], want)
    expect_near(difference[1:], [0, 0, 0], limit, claim)


def csv_files(directory):
    for strip in load(directory)["strips"]:
        rows = list(csv.DictReader((directory / "export_csv" / f"{strip['id']}.csv").open()))
        for k, (row, (t, phase, heat, a, b)) in enumerate(zip(rows, path_of(strip), strict=True)):
            expect((int(row["index"]), row["phase"], row["heat"]) == (k, phase, str(int(heat))), f"row {k}")
            expect_near([float(row["t_s"])], [t], 0.51e-6, "time to the microsecond")
            for name, (p, q) in (("a", a), ("b", b)):
                expect_near([float(row[f"{name}{c}_mm"]) for c in "xyz"], p, EXACT_MM, "place")
                expect_same_turn([float(row[f"{name}q{c}"]) for c in "wxyz"], q, SAME_TURN, "turn")


def compas(directory):
    for strip in load(directory)["strips"]:
        job = json.loads((directory / "export_compas" / f"{strip['id']}.json").read_text())
        fields = ["created_by", "design", "strip", "units", "blade_length_mm", "stock", "times_s", "phases", "heat",
                  "clamp_a", "clamp_b"]
        expect(list(job) == fields, f"the documented fields, not {list(job)}")
        expect((job["strip"], job["units"]) == (strip["id"], "mm"), "strip and unit")
        stock = job["stock"]
        expect(stock["dtype"] == "compas.geometry/Box", "a box")
        expect_near([stock["data"][f"{c}size"] for c in "xyz"], strip["stock"]["size_mm"], EXACT_MM, "block")
        path = path_of(strip)
        expect(job["phases"] == [p[1] for p in path] and job["heat"] == [p[2] for p in path], "phases and heat")
        expect_near(job["times_s"], [p[0] for p in path], 0.51e-6, "times")
        for clamp, place in (("clamp_a", 3), ("clamp_b", 4)):
            for frame, waypoint in zip(job[clamp], path, strict=True):
                p, q = waypoint[place]
                expect(frame["dtype"] == "compas.geometry/Frame", "a frame")
                data = frame["data"]
                expect_near(data["point"], p, EXACT_MM, "point")
                expect_near(data["xaxis"], turned(q, [1, 0, 0]), SAME_TURN, "x axis")
                expect_near(data["yaxis"], turned(q, [0, 1, 0]), SAME_TURN, "y axis")
                expect_near(cross(data["xaxis"], data["yaxis"]), turned(q, [0, 0, 1]), SAME_TURN, "right-handed")


def procedures(text, begin, end):
    """Body lines by name; every block is closed before the next begins."""
    bodies, name = {}, None
    for line in text.splitlines():
        start = re.fullmatch(rf"\s*{begin} (\w+)\(\)", line)
        if start:
            expect(name is None, f"{line.strip()} inside {name}")
            name = start.group(1)
            bodies[name] = []
        elif line.strip() == end:
            expect(name is not None, f"{end} without its {begin}")
            name = None
        elif name:
            bodies[name].append(line.strip())
    expect(name is None, f"{name} stays open")
    return bodies


NUMBERS = re.compile(r"-?\d+\.\d+(?:[eE][-+]?\d+)?|-?\d+(?:[eE][-+]?\d+)?")
CELLS = ("two_irb4600", "two_kr50")


def floats(text):
    return [float(x) for x in NUMBERS.findall(text)]


class Arm:
    """An arm as its URDF has it, in numbers of its own: metres and turns of each joint in a row."""

    def __init__(self, urdf, base, jaw):
        self.base, self.jaw, self.joints = base, jaw, []
        root = xml.etree.ElementTree.parse(urdf).getroot()
        by_child = {j.find("child").get("link"): j for j in root.iter("joint")}
        link, chain = "tool0", []
        while link != "base_link":
            chain.append(by_child[link])
            link = by_child[link].find("parent").get("link")
        for joint in reversed(chain):
            origin = joint.find("origin")
            values = {"xyz": "0 0 0", "rpy": "0 0 0", **(origin.attrib if origin is not None else {})}
            p = [1000 * float(x) for x in values["xyz"].split()]
            roll, pitch, yaw = [float(x) for x in values["rpy"].split()]
            q = product(about([0, 0, 1], yaw), product(about([0, 1, 0], pitch), about([1, 0, 0], roll)))
            axis = [float(x) for x in joint.find("axis").get("xyz").split()] if joint.get("type") == "revolute" else None
            self.joints.append((p, q, axis))

    def jaw_at(self, degrees):
        place, angles = self.base, iter(degrees)
        for p, q, axis in self.joints:
            place = then(place, (p, q))
            if axis:
                place = then(place, ([0, 0, 0], about(axis, math.radians(next(angles)))))
        return then(place, self.jaw)


def about(axis, angle):
    return [math.cos(angle / 2)] + [c * math.sin(angle / 2) for c in axis]


def then(a, b):
    return [x + y for x, y in zip(a[0], turned(a[1], b[0]))], product(a[1], b[1])


def clamp_of(jaw, clamp, flip):
    """The clamp's pose from its jaw's: b is turned about its plane's normal, a flipped jaw about the blade."""
    q = jaw[1]
    if flip:
        q = product(q, [0, 1, 0, 0])
    if clamp == "b":
        q = product(q, [0, 0, 0, 1])
    return jaw[0], q


def expect_at(got, want, claim):
    expect_near(got[0], want[0], ROBOT_MM, claim + ": place")
    expect_same_turn(got[1], want[1], 1e-7, claim + ": turn")


def holders(program, arm_id, strip):
    """Which clamp an arm holds through a strip, and whether turned."""
    if "arms" not in strip:
        return arm_id, False
    clamp = "a" if strip["arms"]["a"]["arm"] == arm_id else "b"
    return clamp, strip["arms"][clamp]["flip"]


def arms_of(directory, program):
    """The arms' names, and their numbers where the program has a cell."""
    if "cell" not in program:
        return {"a": None, "b": None}
    arms = {}
    for arm in program["cell"]["arms"]:
        base, jaw = [(x["p"], x["q"]) for x in (arm["base"], arm["jaw"])]
        arms[arm["id"]] = Arm(directory.parent / arm["model"], base, jaw)
    return arms


APPROACH = 40  # moves that bend the straight blade


def expect_moves(program, strip, arm_id, arm, moves, kind):
    """Jaws behind the approach are where the program has its clamps, at each waypoint that is moved to."""
    clamp, flip = holders(program, arm_id, strip)
    path = [w[3 if clamp == "a" else 4] for w in path_of(strip)]
    both = [(w[3], w[4]) for w in path_of(strip)]
    targets = [k for k in range(1, len(path)) if max(math.dist(x[0], y[0]) for x, y in zip(both[k - 1], both[k])) > 0]
    expect(len(moves) == APPROACH + len(targets), f"{strip['id']}: a move a waypoint that moves")
    for n, k in zip(moves[APPROACH - 1:], [0] + targets):
        if kind == "joint":
            pose = arm.jaw_at(n)
        elif len(n) == 7:
            pose = (n[:3], n[3:])
        else:
            a, b, c = [math.radians(x) for x in n[3:]]
            pose = (n[:3], product(about([0, 0, 1], a), product(about([0, 1, 0], b), about([1, 0, 0], c))))
        expect_at(clamp_of(pose, clamp, flip) if arm else pose, path[k], f"{strip['id']} waypoint {k} of arm {arm_id}")


def expect_bent(strip, first, kind, arms):
    """The blade goes in straight: both jaws a blade's length apart, their tangents in line."""
    poses = {}
    for arm_id, (n, clamp, flip) in first.items():
        # Without a cell the tool is the clamp.
        poses[clamp] = clamp_of(arms[arm_id].jaw_at(n), clamp, flip) if kind == "joint" else (n[:3], n[3:7])
    a, b = poses["a"], poses["b"]
    expect_near([math.dist(a[0], b[0])], [strip["blade_length_mm"]], 2e-4, "a straight blade fits")
    along = [(y - x) / strip["blade_length_mm"] for x, y in zip(a[0], b[0])]
    for pose in (a, b):
        expect_near(turned(pose[1], [1, 0, 0]), along, 1e-6, "tangents in line")


def rapid_in(directory, program, files, kind):
    arms, keys = arms_of(directory, program), {}
    for strip in program["strips"]:
        first = {}
        for arm_id, arm in arms.items():
            text = (files / f"hb_{strip['id']}_{arm_id}.mod").read_text()
            main_text = (files / f"hb_main_{arm_id}.mod").read_text()
            expect(main_text.startswith(f"MODULE hb_main_{arm_id}\n") and main_text.endswith("ENDMODULE\n"), "a module")
            expect("Not tested on hardware" in main_text, "it says that it was never run")
            expect(all(len(line) < 400 and line.isascii() for line in (text + main_text).splitlines()), "plain lines")
            bodies = procedures(text, "PROC", "ENDPROC")
            expect(list(bodies) == [f"hb_{strip['id']}", f"hb_{strip['id']}_1"], "the strip and its moves")
            start, body = bodies[f"hb_{strip['id']}"], bodies[f"hb_{strip['id']}_1"]
            on, off = start.index("SyncMoveOn hb_on,hb_tasks;"), start.index("SyncMoveOff hb_off;")
            expect(start[on + 1:off] == [f"hb_{strip['id']}_1;"] and off == len(start) - 1, "moves are synchronised")
            asked = [line for line in start if line.startswith("TPReadFK")]
            expect(not asked or (len(asked) == 2 and "OUT" in asked[0] and "straight" in asked[1]), "the operator is asked")
            moves = [line for line in body if line.startswith("Move")]
            expect(all("\\ID:=" in line for line in moves), "no arm moves on its own with the blade held")
            numbers = [floats(re.sub(r"\\ID.*", "", line).replace("MoveAbsJ", "").replace("MoveL", "")) for line in moves]
            numbers = [n[:6] if kind == "joint" else n[:7] for n in numbers]
            expect_moves(program, strip, arm_id, arm, numbers, kind)
            keys.setdefault(strip["id"], []).append(
                [re.search(r"\\ID:=(\d+).*v1000\\T:=([\d.]+),(fine|z0)", line).groups() for line in moves])
            load = [line for line in start if line.startswith("Move")]
            expect(len(load) == 1 and ",fine," in load[0], "one move before the blade is in")
            at = floats(load[0].replace("MoveAbsJ", "").replace("MoveJ", ""))
            first[arm_id] = (at[:6] if arm else at[:7], *holders(program, arm_id, strip))
            for k, line in enumerate(body):
                if line.startswith("SetDO"):
                    expect(body[k - 1].startswith("WaitTime") or ",fine," in body[k - 1], "the output waits for the motion")
        expect_bent(strip, first, "joint" if all(arms.values()) else "cartesian", arms)
    expect(all(a == b for a, b in keys.values()), "both arms: same move numbers, times and stops")


def rapid(directory):
    rapid_in(directory, load(directory), directory / "export_rapid", "cartesian")


def krl_in(directory, program, files, kind):
    arms = arms_of(directory, program)
    for strip in program["strips"]:
        meetings = {}
        for arm_id, arm in arms.items():
            text = (files / f"hb_{strip['id']}_{arm_id}.src").read_text()
            expect("Not tested on hardware" in text and text.isascii(), "plain text that says that it was never run")
            expect("SLIN" not in text, "no straight segments that stop the robot between each other")
            body = procedures(text, "DEF", "END")[f"hb_{strip['id']}_{arm_id}"]
            halts = [k for k, line in enumerate(body) if line == "HALT"]
            expect(len(halts) == 2 and all(body[k - 1].startswith("MsgNotify(") for k in halts), "halts with a text")
            begin = "PTP_SPLINE" if kind == "joint" else "SPLINE"
            word = "SPTP" if kind == "joint" else "SPL"
            blocks, seconds = [], 0
            for k, line in enumerate(body):
                if line == begin:
                    inside = body[k + 1:body.index("ENDSPLINE", k)]
                    blocks.append(inside)
                    expect(body[k - 1].startswith("WAIT FOR"), "arms wait for each other before each block")
                    expect(inside[0] == "TIME_BLOCK START" and inside[-1].startswith("TIME_BLOCK END="), "a time block")
                    parts = [float(x.split("=")[1]) for x in inside if x.startswith("TIME_BLOCK PART")]
                    expect_near([sum(parts)], [100], 1e-9, "the parts are the whole")
                    expect(len(parts) == sum(x.startswith(word) for x in inside), "a part a segment")
                    expect(not any("TRIGGER" in x for x in inside), "heat is switched between blocks")
                    seconds += float(inside[-1].split("=")[1])
                elif line.startswith("WAIT SEC"):
                    seconds += float(line.split()[2])
            expect_near([seconds], [strip["poses"][-1]["t"] + 4], 1e-4, "the strip's time")
            moves = [floats(re.sub(r"[A-Z]+\d? ", " ", x.replace(word, ""))) for b in blocks for x in b if x.startswith(word)]
            expect_moves(program, strip, arm_id, arm, moves, kind)
            meetings[arm_id] = [x for x in body if x.startswith("WAIT FOR")]
        expect(len(set(map(tuple, meetings.values()))) == 1 and len(next(iter(meetings.values()))) % 2 == 0,
               "both arms meet as often, and leave their signals as they were")


def krl(directory):
    krl_in(directory, load(directory), directory / "export_krl", "cartesian")


def with_arms(directory, check, name):
    for cell in CELLS:
        program = json.loads((directory / cell / "program.json").read_text())
        for kind in ("cartesian", "joint"):
            check(directory / cell, program, directory / cell / f"{name}_{kind}", kind)


def rapid_arms(directory):
    with_arms(directory, rapid_in, "rapid")


def krl_arms(directory):
    with_arms(directory, krl_in, "krl")


main({"csv": csv_files, "compas": compas, "rapid": rapid, "krl": krl, "rapid_arms": rapid_arms, "krl_arms": krl_arms})
