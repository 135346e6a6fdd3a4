"""Draws when the threads of a command are busy, by its own stages: thread_times.py OUT.svg hotblade plan DESIGN [OPTION]...

Runs the command with `--progress json`, whose stages it takes, and looks every 5 ms at what the kernel says each thread has
had of a core and has waited for one (/proc/PID/task/TID/schedstat). The picture has a row a thread: dark while it runs, light
while it is ready and other programs have the cores. Prints a line a stage: seconds by the clock, processor seconds of all
threads, and seconds that threads waited for a core. Exit code of the command.
"""
import json
import pathlib
import subprocess
import sys
import threading
import time
from xml.sax.saxutils import escape

STEP_S = 0.005
LEAST_S = 0.01  # a thread that has run for less gets no row
LEAST_STAGE_S = 0.02  # a shorter stage counts with the one after it
LEFT, WIDTH, ROW, TOP = 70, 900, 56, 40


def schedule(process):
    """Seconds that each thread has run, and has waited for a core."""
    seen = {}
    for task in pathlib.Path(f"/proc/{process}/task").glob("*"):
        try:
            ran, waited = (task / "schedstat").read_text().split()[:2]
        except OSError:
            continue
        seen[int(task.name)] = (int(ran) / 1e9, int(waited) / 1e9)
    return seen


def follow(command):
    """Runs it; returns its exit code, the samples (second, {thread: (ran, waited)}) and the stages' beginnings."""
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    start, stages, samples = time.monotonic(), [], []

    def listen():
        for line in process.stderr:
            now = time.monotonic() - start
            try:
                stage = json.loads(line)["stage"]
            except (ValueError, KeyError, TypeError):
                sys.stderr.write(line)
                continue
            if not stages or stages[-1][1] != stage:
                stages.append((now, stage))

    listener = threading.Thread(target=listen)
    listener.start()
    while process.poll() is None:
        seen = schedule(process.pid)
        if seen:
            samples.append((time.monotonic() - start, seen))
        time.sleep(STEP_S)
    listener.join()
    return process.returncode, samples, stages


def merged(stages, end):
    """(name, from, to), each long enough to be seen."""
    bounds = [(0.0, "start")] + stages
    spans = [[name, at, then] for (at, name), (then, _) in zip(bounds, bounds[1:] + [(end, "")])]
    kept = []
    for name, at, then in spans:
        if kept and kept[-1][0] == name:
            kept[-1][2] = then
        elif kept and kept[-1][2] - kept[-1][1] < LEAST_STAGE_S:
            kept[-1] = [name, kept[-1][1], then]
        else:
            kept.append([name, at, then])
    return kept


def at_time(samples, thread, second):
    """What a thread had run and waited for at a time, between samples evenly."""
    before = (0.0, (0.0, 0.0))
    for now, seen in samples:
        if thread not in seen:
            continue
        if now >= second:
            share = (second - before[0]) / (now - before[0]) if now > before[0] else 1
            return tuple(a + share * (b - a) for a, b in zip(before[1], seen[thread]))
        before = (now, seen[thread])
    return before[1]


def drawing(samples, stages, threads, end, title):
    bins = 300
    height = TOP + ROW * len(threads) + 30
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {LEFT + WIDTH + 10} {height}" font-family="sans-serif" '
             f'font-size="11"><title>{escape(title)}</title><rect width="100%" height="100%" fill="white"/>']
    for i, (name, at, then) in enumerate(stages):
        x, wide = LEFT + WIDTH * at / end, WIDTH * (then - at) / end
        parts.append(f'<rect x="{x:.1f}" y="{TOP - 18}" width="{wide:.1f}" height="{height - TOP}" '
                     f'fill="{"#f1f1f1" if i % 2 else "#e3e3e3"}"/>')
        if wide > 7 * len(name):
            parts.append(f'<text x="{x + 3:.1f}" y="{TOP - 6}">{escape(name)}</text>')
    for row, thread in enumerate(threads):
        floor = TOP + ROW * (row + 1) - 6
        parts.append(f'<text x="4" y="{floor - 16}">{"main" if row == 0 else f"worker {row}"}</text>')
        last = (0.0, 0.0)
        for b in range(bins):
            now = at_time(samples, thread, end * (b + 1) / bins)
            ran, waited = (min(1, (q - p) * bins / end) for p, q in zip(last, now))
            last = now
            x, wide, tall = LEFT + WIDTH * b / bins, WIDTH / bins + 0.2, ROW - 12
            for share, under, colour in ((ran, 0, "#1f5a99"), (min(waited, 1 - ran), ran, "#a9c8ea")):
                if share > 0.01:
                    parts.append(f'<rect x="{x:.1f}" y="{floor - tall * (under + share):.1f}" width="{wide:.1f}" '
                                 f'height="{tall * share:.1f}" fill="{colour}"/>')
    step = next(s for s in (0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100) if end / s <= 12)
    for k in range(int(end / step) + 1):
        parts.append(f'<text x="{LEFT + WIDTH * k * step / end:.1f}" y="{height - 10}">{k * step:g} s</text>')
    return "\n".join(parts) + "</svg>\n"


def main(out, *command):
    code, samples, stages = follow([*command, "--progress", "json"])
    if not samples:
        print("the command ended before it could be looked at", file=sys.stderr)
        return code or 1
    end = samples[-1][0]
    spans = merged(stages, end)
    order = list(dict.fromkeys(t for _, seen in samples for t in seen))
    threads = [t for t in order if at_time(samples, t, end)[0] >= LEAST_S or t == order[0]]
    print(f"{'stage':<10}{'clock s':>9}{'processor s':>13}{'waited s':>10}")
    for name, at, then in spans:
        used = [[q - p for p, q in zip(at_time(samples, t, at), at_time(samples, t, then))] for t in threads]
        print(f"{name:<10}{then - at:>9.2f}{sum(u[0] for u in used):>13.2f}{sum(u[1] for u in used):>10.2f}")
    pathlib.Path(out).write_text(drawing(samples, spans, threads, end, " ".join(word.rsplit("/", 1)[-1] for word in command)), encoding="utf-8")
    return code


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
