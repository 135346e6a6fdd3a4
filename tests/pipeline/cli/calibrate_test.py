#!/usr/bin/env python3
"""calibrate_test.py PROGRAM: a cell that is off is planned for, cut, scanned, calibrated and planned for again, all by
commands; then what the next plan predicts is what the cell cuts. What is no scan, or no log of the cut, writes nothing."""
import json
import pathlib
import subprocess
import sys
import tempfile

# A panel that looks the same from no two sides, as tests/pipeline/calibrate/hidden_cell.hpp has it.
ROWS, COLUMNS = 40, 60
# The cell as it is, all of its numbers: within what a cell set up by hand may be off by.
TRUTH = ["blade.length_error_mm=1.4", "blade.stiffness_error=0.1", "blade.kerf_mm=1.3",
         "machine.clamp_a_shift_mm=[0.5, -0.8, 0.4]", "machine.clamp_a_turn_rad=[0.001, 0, 0.002]",
         "machine.clamp_b_shift_mm=[0, 0.6, 0]", "machine.clamp_b_turn_rad=[0.002, 0.003, -0.004]"]


def panel(u, v):
    x, y = 300 * u, 420 * (v - 0.5)
    return (x, y, 60 - 0.0011 * y * y - 0.00035 * (x - 120) ** 2 + 1.1e-6 * y ** 3 + 0.0004 * x * y + 1.2e-6 * x * y * y)


def panel_obj():
    lines = ["v %.6f %.6f %.6f" % panel(i / ROWS, j / COLUMNS) for j in range(COLUMNS + 1) for i in range(ROWS + 1)]
    for j in range(COLUMNS):
        for i in range(ROWS):
            a = j * (ROWS + 1) + i + 1
            lines.append(f"f {a} {a + 1} {a + ROWS + 2}\nf {a} {a + ROWS + 2} {a + ROWS + 1}")
    return "\n".join(lines) + "\n"


class Cell:
    def __init__(self, program, work):
        self.program, self.work = program, work

    def run(self, *words, code=0):
        done = subprocess.run([self.program, "-q", *words], cwd=self.work, capture_output=True, text=True, check=False)
        assert done.returncode == code, f"{words}: exit code {done.returncode}, {code} is due: {done.stderr}"
        return done

    def plan(self, place, *configs):
        words = [word for config in configs for word in ("--config", config)]
        self.run("plan", "panel.obj", "--units", "mm", "--set", "slice.direction=[1, 0, 0]", "--tolerance", "0.5", *words,
                 "--no-pictures", "-o", place)
        return json.loads((self.work / place / "report.json").read_text())["deviation_mm"]["max"]

    def off(self, place):
        """How far what the cell cuts lies off what the program says that it cuts."""
        truth = [word for setting in TRUTH for word in ("--set", setting)]
        said = self.run("calibrate", f"{place}/program.json", "--rehearse", "--noise", "0", "--placement", "fixed", *truth, "--json")
        return json.loads(said.stdout)["misfit_mm"]["planned"]

    def refused(self, *words, code, says):
        done = self.run("calibrate", "first/program.json", *words, "-o", "refused.toml", code=code)
        assert says in done.stderr, f"{words}: {done.stderr}, {says!r} is due"
        assert not (self.work / "refused.toml").exists(), f"{words}: wrote a calibration"


def calibrates(cell):
    cell.plan("first")
    truth = [word for setting in TRUTH for word in ("--set", setting)]
    cell.run("calibrate", "first/program.json", "--rehearse", "--placement", "fixed", "--points", "8000", *truth,
             "--save-scan", "cut.csv")
    cell.run("dryrun", "first/program.json", "--log", "cut.jsonl", "--design", "panel.obj")
    cell.run("calibrate", "first/program.json", "--scan", "cut.csv", "--log", "cut.jsonl", "--placement", "fixed")
    predicted = cell.plan("next", "calibration.toml")
    before, after = cell.off("first"), cell.off("next")
    print(f"off what was predicted: p95 {before['p95']:.3f} mm at first, {after['p95']:.3f} mm next; predicted {predicted:.3f} mm")
    assert before["p95"] > 1, before
    assert after["p95"] < 0.15 and after["max"] < 0.25, after
    assert predicted < 0.25, predicted


def refuses(cell):
    rows = (cell.work / "cut.csv").read_text().splitlines()
    log = (cell.work / "cut.jsonl").read_text().splitlines(keepends=True)

    def file(name, text):
        (cell.work / name).write_text(text)
        return name

    cell.refused("--scan", file("none.csv", ""), code=3, says="too few points (0, at least 200)")
    metres = "\n".join(",".join(str(float(c) / 1000) for c in row.split(",")) for row in rows[1:])
    cell.refused("--scan", file("metres.csv", metres), code=3, says="say --units m")
    far = "\n".join(f"{float(row.split(',')[0]) + 500},{row.split(',', 1)[1]}" for row in rows[1:])
    cell.refused("--scan", file("far.csv", far), "--placement", "near", code=3, says="say --placement search")
    cell.refused("--scan", "S009=cut.csv", code=2, says="names no strip of the program (S001)")
    cell.refused("--scan", "cut.csv", "--scan", "S001=cut.csv", code=2, says="give each scan once")
    cell.refused("--rehearse", "--log", "cut.jsonl", code=2, says="--log: is not taken with --rehearse")
    cell.refused("--rehearse", "--set", "blade.kerf_mm=1.2", "--set", "design.keep=above", code=2,
                 says="--set design.keep=above: says nothing of the cell: give one of machine.clamp_a_shift_mm, ")
    cell.refused("--rehearse", "--set", "blade.kerf=1.2", code=2, says="unknown key")
    cell.refused("--scan", "missing.csv", code=7, says="missing.csv: cannot be read")
    cell.refused("--scan", "cut.csv", "--log", ".", code=7, says="is a directory")
    cell.refused("--scan", "cut.csv", "--log", file("half.jsonl", "".join(log[:len(log) // 2])), code=3, says="is incomplete")
    poses = [i for i, line in enumerate(log) if '"ev":"pose"' in line]
    gap = set(poses[len(poses) // 2:len(poses) // 2 + 300])
    cell.refused("--scan", "cut.csv", "--log", file("gap.jsonl", "".join(l for i, l in enumerate(log) if i not in gap)), code=3,
                 says="a part of the cut is not told of")
    at = poses[len(poses) // 2]
    bent = log[at].replace('"kappa":', '"kappa":0.5,"was":', 1)
    cell.refused("--scan", "cut.csv", "--log", file("bent.jsonl", "".join(log[:at] + [bent] + log[at + 1:])), code=3,
                 says="from clamp B")


def main(program):
    with tempfile.TemporaryDirectory() as place:
        cell = Cell(program, pathlib.Path(place))
        (cell.work / "panel.obj").write_text(panel_obj())
        calibrates(cell)
        refuses(cell)


main(sys.argv[1])
