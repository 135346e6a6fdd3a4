"""Waypoint files and robot programs against the program's poses, worked out anew."""
import csv
import json
import re

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


NUMBER = r"(-?\d+\.?\d*)"


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


def rapid(directory):
    program = load(directory)
    texts = {arm: (directory / "export_rapid" / f"hb_arm_{arm}.mod").read_text() for arm in "ab"}
    synchronised = {}
    for arm, text in texts.items():
        expect(text.startswith(f"MODULE hb_arm_{arm}\n") and text.endswith("ENDMODULE\n"), "one module")
        expect("Not tested on hardware" in text, "it says that it was never run")
        expect(all(len(line) < 400 and line.isascii() for line in text.splitlines()), "plain lines")
        bodies = procedures(text, "PROC", "ENDPROC")
        expect(list(bodies) == [s["id"] for s in program["strips"]] + ["hb_main"], "a procedure a strip")
        calls = [line for s in program["strips"] for line in ("Stop;", f"{s['id']};")]
        expect(bodies["hb_main"] == calls, "a halt before each strip")
        for strip in program["strips"]:
            body = bodies[strip["id"]]
            on, off = body.index("SyncMoveOn hb_on,hb_tasks;"), body.index("SyncMoveOff hb_off;")
            moves = [(k, line) for k, line in enumerate(body) if line.startswith("MoveL")]
            expect(all(on < k < off for k, _ in moves) and off == len(body) - 1, "moves are synchronised")
            expect(len(moves) == len(strip["poses"]) - 1, "a move a waypoint")
            for (_, line), waypoint in zip(moves, path_of(strip)[1:]):
                n = [float(x) for x in re.findall(NUMBER, line)]
                p, q = waypoint[3 if arm == "a" else 4]
                expect_near(n[:3], p, ROBOT_MM, "place")
                expect_same_turn(n[3:7], q, 1e-8, "turn")
            key = [re.search(r"\\ID:=(\d+),v1000\\T:=([\d.]+)", line).groups() for _, line in moves]
            synchronised.setdefault(strip["id"], []).append(key)
    expect(all(a == b for a, b in synchronised.values()), "both arms: same move numbers and times")


def krl(directory):
    program = load(directory)
    for arm in "ab":
        text = (directory / "export_krl" / f"hb_arm_{arm}.src").read_text()
        expect("Not tested on hardware" in text, "it says that it was never run")
        expect(text.isascii(), "plain text")
        bodies = procedures(text, "DEF", "END")
        expect(list(bodies) == [f"hb_arm_{arm}"] + [s["id"] for s in program["strips"]], "a routine a strip")
        main_body = [line for line in bodies[f"hb_arm_{arm}"] if not line.startswith((";", "$"))]
        expect(main_body == [line for s in program["strips"] for line in ("HALT", f"{s['id']}()")], "a halt before each")
        for strip in program["strips"]:
            body = bodies[strip["id"]]
            inside = body[body.index("SPLINE") + 1:body.index("ENDSPLINE")]
            expect(body.index("WAIT FOR hb_ready_in") < body.index("SPLINE"), "arms wait for each other")
            expect(inside[0] == "TIME_BLOCK START" and inside[-1].startswith("TIME_BLOCK END="), "one time block")
            parts = [float(line.split("=")[1]) for line in inside if line.startswith("TIME_BLOCK PART")]
            expect(len(parts) == len(strip["poses"]) - 1, "a part of the time a waypoint")
            expect_near([sum(parts)], [float(inside[-1].split("=")[1])], 1e-5, "the parts are the whole")


main({"csv": csv_files, "compas": compas, "rapid": rapid, "krl": krl})
