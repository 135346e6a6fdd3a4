#!/usr/bin/env python3
"""interrupt_test.py PROGRAM SAMPLES: SIGINT at random moments of plans ends them within 0.3 s, with nothing written.

Each moment is drawn between the plan's start and the time that it takes to its end. Where the interrupt comes after the last
moment that it can be heard, the plan has ended well and its directory holds a whole set. HOTBLADE_INTERRUPTS=N tries N moments
of five plans, the roof's among them, in place of 8 of four.
"""
import os
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time

LIMIT_S = 0.3
PLANS = {  # options of each, and the longest that is waited for
    "hypar": ([], 60),
    "corner": ([], 60),
    "vase": (["--no-pictures"], 60),
    "wave_wall": (["--set", "design.tolerance_mm=0.05"], 60),  # refused after a long search
    "roof": (["--no-pictures"], 40),
}


def command(program, samples, name, out):
    config = samples / f"{name}.toml"
    options = ["--config", str(config)] if config.exists() else ["--units", "mm"]
    return [program, "plan", str(samples / f"{name}.obj"), *options, *PLANS[name][0], "-o", str(out)]


def run(program, samples, name, work, after_s):
    """The exit code, the time from the signal to the end, and what stands in the directory and beside it."""
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir()
    process = subprocess.Popen(command(program, samples, name, work / "cut"), stdout=subprocess.DEVNULL,
                               stderr=subprocess.DEVNULL)
    try:
        process.wait(after_s)
    except subprocess.TimeoutExpired:
        pass
    asked = time.monotonic()
    if process.poll() is None:
        process.send_signal(signal.SIGINT)
    code = process.wait()
    took = time.monotonic() - asked
    return code, took, sorted(str(path.relative_to(work)) for path in work.rglob("*"))


def whole(left):
    return "cut/report.json" in left and ("cut/program.json" in left or "cut/refused.json" in left) \
        and not any(path.startswith(".") for path in left)


def main():
    program, samples = sys.argv[1], pathlib.Path(sys.argv[2])
    moments = int(os.environ.get("HOTBLADE_INTERRUPTS", "8"))
    names = list(PLANS) if moments > 8 else [name for name in PLANS if name != "roof"]
    seed = int(os.environ.get("HOTBLADE_SEED", str(random.randrange(10**6))))
    print(f"seed {seed}")
    draw = random.Random(seed)
    failures, worst, ended = 0, 0.0, 0
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder) / "work"
        longest = {}
        for name in names:
            began = time.monotonic()
            run(program, samples, name, work, PLANS[name][1])
            longest[name] = time.monotonic() - began
        for moment in range(moments):
            name = names[moment % len(names)]
            after = draw.uniform(0.01, longest[name])
            code, took, left = run(program, samples, name, work, after)
            if code == 130:  # as it says itself
                ended += 1
                worst = max(worst, took)
                good = not left and took <= LIMIT_S
            elif code == -signal.SIGINT:  # before it began
                ended += 1
                good = not left and after < 0.3
            else:
                good = code in (0, 4) and whole(left)
            if not good:
                failures += 1
            print(f"{'' if good else 'FAILED: '}{name} after {after:.2f} s: exit {code}, {took:.3f} s later, left {left[:4]}")
    print(f"{ended} of {moments} interrupted, the slowest {worst:.3f} s")
    if 2 * ended < moments:
        print("FAILED: most plans were over before they were interrupted")
        failures += 1
    return 1 if failures else 0


sys.exit(main())
