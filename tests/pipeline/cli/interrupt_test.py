#!/usr/bin/env python3
"""interrupt_test.py PROGRAM SAMPLES: SIGINT at random moments of plans ends them within 0.3 s, with nothing written.

Each moment is drawn between the plan's start and the time that it took at most when it was last left alone. Where the interrupt
comes after the last moment that it can be heard, the plan has ended well, its directory holds a whole set, and another moment is
drawn: how long a plan takes depends on what else the machine does. HOTBLADE_INTERRUPTS=N interrupts N times, five plans, the
roof's among them, in place of 8 of four.
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
    """The exit code, the times from the start and from the signal to the end, and what stands in the directory and beside it."""
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir()
    began = time.monotonic()
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
    ended = time.monotonic()
    return code, ended - began, ended - asked, sorted(str(path.relative_to(work)) for path in work.rglob("*"))


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
    failures, worst, ended, tries = 0, 0.0, 0, 0
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder) / "work"
        longest = {name: run(program, samples, name, work, PLANS[name][1])[1] for name in names}
        while ended < moments and tries < 10 * moments:
            tries += 1
            name = names[ended % len(names)]
            after = draw.uniform(0.01, longest[name])
            code, lasted, took, left = run(program, samples, name, work, after)
            if code == 130:  # as it says itself
                ended += 1
                worst = max(worst, took)
                good = not left and took <= LIMIT_S
            elif code == -signal.SIGINT:  # before it began
                ended += 1
                good = not left and after < 0.3
            else:
                longest[name] = min(longest[name], lasted)
                good = code in (0, 4) and whole(left)
            if not good:
                failures += 1
            print(f"{'' if good else 'FAILED: '}{name} after {after:.2f} s: exit {code}, {took:.3f} s later, left {left[:4]}")
    print(f"{ended} interrupted in {tries} tries, the slowest {worst:.3f} s")
    if ended < moments:
        print("FAILED: most plans were over before they were interrupted")
        failures += 1
    return 1 if failures else 0


sys.exit(main())
