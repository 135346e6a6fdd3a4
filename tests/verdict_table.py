#!/usr/bin/env python3
"""Plans every OBJ of a directory (mm, foam kept behind the face normals) and prints a Markdown table of verdicts. The clamps
that an amber verdict asks for are tried: planned again with them the design has to be green, and with a quarter more amber.
Beside every design DESIGN_verdict/ has the three plans.
usage: verdict_table.py PROGRAM DIRECTORY [NAME...]    exit code 1 where a verdict does not hold what it says"""
import json
import subprocess
import sys
from pathlib import Path

WORSE = 1.25


def planned(program, obj, place, settings):
    """The report of one plan; None where the program wrote none."""
    words = [program, "-q", "plan", str(obj), "--units", "mm", "--set", "design.keep=back", "--no-pictures", "--force",
             "-o", str(place)]
    for key, value in settings.items():
        words += ["--set", f"{key}={value!r}"]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    report = place / "report.json"
    if done.returncode not in (0, 4) or not report.is_file():
        print(f"{obj.name}: exit code {done.returncode}: {done.stderr.strip()}", file=sys.stderr)
        return None
    return json.loads(report.read_text())


def with_clamps(program, obj, place, clamps, factor):
    return planned(program, obj, place, {"machine.clamp_error_mm": factor * clamps["position_mm"],
                                         "machine.clamp_error_rad": factor * clamps["angle_rad"]})


def said(report):
    """A verdict in short: its colour and what its budget comes to."""
    if report is None:
        return "no plan", "-"
    return report["verdict"]["color"], f"{report['budget_sum_mm']:.4f}"


def row(program, obj):
    """The design's line of the table, its colour, and whether the verdict holds what it says."""
    places = [obj.parent / f"{obj.stem}_verdict" / name for name in ("asked", "needed", "worse")]
    for place in places:
        place.mkdir(parents=True, exist_ok=True)
    report = planned(program, obj, places[0], {})
    if report is None:
        return f"| {obj.stem} | - | - | - | no plan | - | - | - |", "no plan", False
    verdict = report["verdict"]
    needed = verdict["clamps_needed"]
    asked, again, worse, holds = "-", "-", "-", True
    if verdict["color"] == "green":
        holds = verdict["budget_mm"] <= verdict["tolerance_mm"]
    elif verdict["color"] == "amber":
        holds = verdict["budget_mm"] > verdict["tolerance_mm"]
        asked = "none"
    if verdict["color"] == "amber" and needed:
        asked = f"{needed['position_mm']:g} mm, {1e3 * needed['angle_rad']:g} mrad"
        found = said(with_clamps(program, obj, places[1], needed, 1))
        wider = said(with_clamps(program, obj, places[2], needed, WORSE))
        again, worse = " ".join(found), " ".join(wider)
        holds = holds and found[0] == "green" and wider[0] == "amber"
    line = (f"| {obj.stem} | {report['deviation_mm']['max']:.3f} | {verdict['budget_mm']:.2f} | "
            f"{verdict['clamp_error_mm']:.2f} | {verdict['color']} | {asked} | {again} | {worse} |")
    return line, verdict["color"], holds


def main(program, directory, names):
    designs = sorted(p for p in Path(directory).glob("*.obj") if not names or p.stem in names)
    if not designs:
        sys.exit(f"{directory}: no OBJ there")
    print("| design | deviation mm | budget mm | of it clamps mm | verdict | within the tolerance with clamps within | "
          f"budget mm with these | with {WORSE:g} times these |\n|---|---|---|---|---|---|---|---|")
    counts, broken = {}, []
    for obj in designs:
        line, color, holds = row(program, obj)
        print(line, flush=True)
        counts[color] = counts.get(color, 0) + 1
        if not holds:
            broken.append(obj.stem)
    print("\n" + ", ".join(f"{n} {color}" for color, n in sorted(counts.items())))
    if broken:
        sys.exit("verdicts that do not hold what they say: " + ", ".join(broken))


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2], sys.argv[3:])
