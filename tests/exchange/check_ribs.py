"""Rib files read back by ezdxf, svgelements and csv, against the program's own curves."""
import csv
import math

from program_curves import curve_points, expect, expect_near, in_design, load, main

EXACT_MM = 1e-6      # coordinates that are the program's
JOINT_RAD = 2e-5     # tangents of neighbouring arcs: beside an inflection a line may stand for an arc of as much
TOLERANCE_MM = 0.01  # of `hotblade ribs` without --tolerance


def ribs_by_strip(directory):
    return {s["id"]: {r["id"]: r for r in s["ribs"]} for s in load(directory)["strips"]}


def expect_same_curve(points, rib, claim):
    """Points evenly spaced along the rib, up to where the rib was put on the sheet."""
    wanted = curve_points(rib["elastica"], len(points) - 1)
    for got, want in zip(points, wanted):
        expect_near([got[0] - points[0][0], got[1] - points[0][1]], [want[0] - wanted[0][0], want[1] - wanted[0][1]],
                    EXACT_MM, claim)


def expect_near_curve(points, rib, claim):
    """Every point lies on the rib within the tolerance; the first ones tell where the rib was put."""
    wanted = curve_points(rib["elastica"], 400)
    spacing = rib["elastica"]["length"] / 400
    shift = [points[0][0] - wanted[0][0], points[0][1] - wanted[0][1]]
    for p in points:
        x, y = p[0] - shift[0], p[1] - shift[1]
        near = min(wanted, key=lambda w: (w[0] - x) ** 2 + (w[1] - y) ** 2)
        along = abs((x - near[0]) * math.cos(near[2]) + (y - near[1]) * math.sin(near[2]))
        across = abs((y - near[1]) * math.cos(near[2]) - (x - near[0]) * math.sin(near[2]))
        # Half a sample along a curve of radius 100 mm or more moves it across by less than the slack.
        expect(along <= spacing and across <= TOLERANCE_MM + spacing ** 2 / 800, f"{claim}: {across} mm off the rib")


def dxf_polylines(path, ribs):
    import ezdxf
    document = ezdxf.readfile(path)
    audit = document.audit()
    expect(not audit.errors and not audit.fixes, f"{path.name}: the auditor found {audit.errors + audit.fixes}")
    expect(document.dxfversion == "AC1015", "version")
    expect(document.units == ezdxf.units.MM, "the drawing says millimetres")
    space = document.modelspace()
    expect({t.dxf.text for t in space.query("TEXT")} == set(ribs), "a name beside every rib")
    lines = {p.dxf.layer: p for p in space.query("LWPOLYLINE")}
    expect(set(lines) == set(ribs) and len(space) == 2 * len(ribs), "one polyline a rib, on its layer")
    expect(all(document.layers.has_entry(name) for name in ribs), "layers are defined")
    return {name: [tuple(v) for v in p.get_points("xyb")] for name, p in lines.items()}


def dxf(directory):
    for strip, ribs in ribs_by_strip(directory).items():
        for name, vertices in dxf_polylines(directory / "dxf" / f"{strip}.dxf", ribs).items():
            expect(all(v[2] == 0 for v in vertices), "chords have no bulge")
            expect_same_curve(vertices, ribs[name], name)


def end_directions(a, b):
    """Directions of a bulged piece at both ends, and its length."""
    chord, half = math.atan2(b[1] - a[1], b[0] - a[0]), 2 * math.atan(a[2])
    length = math.dist(a[:2], b[:2]) * (half / math.sin(half) if half else 1)
    return chord - half, chord + half, length


def dxf_arcs(directory):
    for strip, ribs in ribs_by_strip(directory).items():
        for name, vertices in dxf_polylines(directory / "dxf_arcs" / f"{strip}.dxf", ribs).items():
            pieces = [end_directions(a, b) for a, b in zip(vertices, vertices[1:])]
            for before, after in zip(pieces, pieces[1:]):
                turn = math.remainder(after[0] - before[1], 2 * math.pi)
                expect(abs(turn) <= JOINT_RAD, f"{name}: arcs meet at an angle of {turn} rad")
            rib = ribs[name]["elastica"]
            expect_near([sum(p[2] for p in pieces)], [rib["length"]], EXACT_MM, f"{name}: length")
            start, end = curve_points(rib, 200)[:: 200]
            expect_near([vertices[-1][0] - vertices[0][0], vertices[-1][1] - vertices[0][1]],
                        [end[0] - start[0], end[1] - start[1]], EXACT_MM, f"{name}: ends")
            expect_near([math.remainder(pieces[0][0] - start[2], 2 * math.pi),
                         math.remainder(pieces[-1][1] - end[2], 2 * math.pi)], [0, 0], JOINT_RAD, f"{name}: tangents")
            expect_near_curve(vertices, ribs[name], name)


def svg_paths(path, ribs):
    import svgelements
    page = svgelements.SVG.parse(path, reify=False)  # in the file's own units, which are:
    box = page.values["viewBox"].split()
    expect(page.values["width"] == box[2] + "mm" and page.values["height"] == box[3] + "mm", "a unit is a millimetre")
    found = {p.id: p for p in page.elements() if isinstance(p, svgelements.Path)}
    expect(set(found) == set(ribs), "one path a rib, of its id")
    for name, p in found.items():
        expect(len(list(p.as_subpaths())) == 1, f"{name}: one stroke")
        segments = [s for s in p if not isinstance(s, svgelements.Move)]
        for a, b in zip(segments, segments[1:]):
            expect(abs(a.end - b.start) <= EXACT_MM, f"{name}: pieces join")
        found[name] = segments
    return found


def upright(points):
    return [(p.x, -p.y) for p in points]


def svg(directory):
    for strip, ribs in ribs_by_strip(directory).items():
        for name, segments in svg_paths(directory / "svg" / f"{strip}.svg", ribs).items():
            expect(all(type(s).__name__ == "Line" for s in segments), "chords are lines")
            points = upright([segments[0].start] + [s.end for s in segments])
            expect_same_curve(points, ribs[name], name)


def svg_arcs(directory):
    for strip, ribs in ribs_by_strip(directory).items():
        for name, segments in svg_paths(directory / "svg_arcs" / f"{strip}.svg", ribs).items():
            expect(any(type(s).__name__ == "Arc" for s in segments), "there are arcs")
            expect_near([sum(s.length() for s in segments)], [ribs[name]["elastica"]["length"]], 1e-4, f"{name}: length")
            points = upright([segments[0].start] + [s.point(t) for s in segments for t in (0.25, 0.5, 0.75, 1)])
            expect_near_curve(points, ribs[name], name)


def csv_rows(path):
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    return list(csv.DictReader(lines))


def plane_and_design(row):
    return [float(row[k]) for k in ("x_mm", "y_mm")], [float(row[f"design_{k}_mm"]) for k in "xyz"]


def expect_rows_are_curves(directory):
    for strip, ribs in ribs_by_strip(directory).items():
        rows = csv_rows(directory / "csv" / f"{strip}.csv")
        for name, rib in ribs.items():
            mine = [plane_and_design(r) for r in rows if r["rib"] == name]
            wanted = curve_points(rib["elastica"], len(mine) - 1)
            for (plane, design), want in zip(mine, wanted, strict=True):
                expect_near(plane, want[:2], EXACT_MM, f"{name}: point")
                expect_near(design, in_design(rib["frame"], *want[:2]), EXACT_MM, f"{name}: place in the design")


def expect_arcs_join(directory):
    for strip, ribs in ribs_by_strip(directory).items():
        rows = csv_rows(directory / "csv_arcs" / f"{strip}.csv")
        for name in ribs:
            arcs = [{k: float(v) for k, v in r.items() if k != "rib"} for r in rows if r["rib"] == name]
            for a, b in zip(arcs, arcs[1:]):
                arc = {"x": a["x_mm"], "y": a["y_mm"], "theta": a["theta_rad"], "kappa": a["kappa_per_mm"],
                       "lambda1": 0, "lambda2": 0, "length": a["length_mm"]}
                expect_near(curve_points(arc, 10)[-1][:2], [b["x_mm"], b["y_mm"]], EXACT_MM, f"{name}: arcs join")


def expect_control_points(directory):
    rows = csv_rows(directory / "job" / "ribs" / "beziers.csv")
    ribs = {k: v for strip in ribs_by_strip(directory).values() for k, v in strip.items()}
    expect(len(rows) == sum(len(rib["bezier"]) for rib in ribs.values()), "every control point of every rib")
    for row in rows:
        rib = ribs[row["rib"]]
        want = rib["bezier"][int(row["index"])]
        plane, design = plane_and_design(row)
        expect_near(plane, want, EXACT_MM, "control point")
        expect_near(design, in_design(rib["frame"], *want), EXACT_MM, "control point in the design")


def csv_files(directory):
    expect_rows_are_curves(directory)
    expect_arcs_join(directory)
    expect_control_points(directory)


def plan_ribs(directory):
    files = sorted(p.name for p in (directory / "job" / "ribs").iterdir())
    expect(files == sorted(p.name for p in (directory / "dxf").iterdir()) + ["beziers.csv"], f"ribs/ holds {files}")
    for path in (directory / "dxf").iterdir():
        expect(path.read_bytes() == (directory / "job" / "ribs" / path.name).read_bytes(), f"{path.name} is the same")


main({"dxf": dxf, "dxf_arcs": dxf_arcs, "svg": svg, "svg_arcs": svg_arcs, "csv": csv_files, "plan_ribs": plan_ribs})
