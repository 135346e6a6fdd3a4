"""Holds tests/thread_times.py to a stand-in of the program, whose stages and threads are known: thread_times_selftest.py"""
import pathlib
import subprocess
import sys
import tempfile

TOOL = pathlib.Path(__file__).resolve().parents[1] / "thread_times.py"
# Idle in `read`, busy in `sweep` (a process of Python holds one core), and an exit code of its own.
PROGRAM = """
import sys, time
assert sys.argv[1:] == ["plan", "--progress", "json"]
def tell(stage): print('{"stage":"%s","progress":0.5}' % stage, file=sys.stderr, flush=True)
tell("read"); time.sleep(0.3)
tell("sweep"); end = time.process_time() + 0.3
while time.process_time() < end: pass
print("a warning", file=sys.stderr); sys.exit(3)
"""


def main():
    with tempfile.TemporaryDirectory() as folder:
        program, picture = pathlib.Path(folder, "program.py"), pathlib.Path(folder, "picture.svg")
        program.write_text(PROGRAM)
        run = subprocess.run([sys.executable, TOOL, picture, sys.executable, program, "plan"], capture_output=True, text=True)
        assert run.returncode == 3 and "a warning" in run.stderr, (run.returncode, run.stderr)
        rows = {line.split()[0]: [float(x) for x in line.split()[1:]] for line in run.stdout.splitlines()[1:]}
        assert rows["read"][0] > 0.25 and rows["read"][1] < 0.1, rows
        assert 0.25 < rows["sweep"][1] < 0.4, rows
        drawn = picture.read_text()
        assert drawn.count(">main<") == 1 and ">sweep<" in drawn and folder not in drawn


if __name__ == "__main__":
    main()
