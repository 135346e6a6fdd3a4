#!/usr/bin/python3
"""Runs the example of every command's --help as it stands: help_examples_test.py PROGRAM SAMPLES

The directory they run in has the sample vault as vault.obj with its settings as job.toml, settings of a machine as
machine.toml, and facade.obj, of two groups. An example may need what another one writes: FIRST has those, in their order;
the others follow in that of the commands. `sim` serves `run` and ends on Ctrl-C. Prints a line for each example that fails,
says nothing, or is missing, and exits with 1 when there is any.
"""
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from check_help import help_of, output_of  # noqa: E402

# `sim` is started where it stands, and stopped after `run`.
FIRST = ["plan", "batch init", "batch run", "batch gather", "cell", "cell show", "cell validate", "sim", "run"]
SECONDS = 300


def examples_of(program):
    """{command: its example}; empty where there is none."""
    found = {}
    for command in help_of(program, []):
        lines = output_of(program, *command.split(), "--help").splitlines()
        found[command] = "".join(line.removeprefix("Example: ") for line in lines if line.startswith("Example: "))
    return found


def make_inputs(directory, samples):
    shutil.copy(samples / "barrel_vault.obj", directory / "vault.obj")
    shutil.copy(samples / "barrel_vault.toml", directory / "job.toml")
    (directory / "machine.toml").write_text("[blade]\nkerf_mm = 1.1\n")
    panel = ["v {} {} {}".format(x, y, 0.0005 * (x - 150) ** 2) for y in (0, 100, 200) for x in range(0, 301, 20)]
    faces = [f"f {r * 16 + i} {r * 16 + i + 1} {r * 16 + i + 17} {r * 16 + i + 16}" for r in (0, 1) for i in range(1, 16)]
    (directory / "facade.obj").write_text("\n".join([*panel, "g one", *faces[:15], "g two", *faces[15:]]) + "\n")
    (directory / ".local/share/bash-completion/completions").mkdir(parents=True)


class Examples:
    def __init__(self, program, directory):
        self.directory = directory
        # By its name, as a user calls it.
        (directory / "bin").mkdir()
        (directory / "bin/hotblade").symlink_to(program)
        self.environment = {**os.environ, "HOME": str(directory),
                            "PATH": f"{directory / 'bin'}{os.pathsep}{os.environ['PATH']}"}
        self.sim = None

    def start(self, line):
        return subprocess.Popen(["bash", "-o", "pipefail", "-c", f"exec {line}" if "|" not in line else line],
                                cwd=self.directory, env=self.environment, stdin=subprocess.DEVNULL,
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)

    def serve(self, line):
        """Starts the simulator; what is wrong with it, or nothing."""
        self.sim = self.start(line)
        said = self.sim.stdout.readline()  # it says where it listens
        return "" if said and self.sim.poll() is None else said or "it ends at once"

    def stop(self):
        if self.sim is None:
            return ""
        self.sim.send_signal(signal.SIGINT)
        try:
            said, _ = self.sim.communicate(timeout=20)
        except subprocess.TimeoutExpired:
            self.sim.kill()
            return "does not end on Ctrl-C"
        code, self.sim = self.sim.returncode, None
        return "" if code in (0, 130) else f"exit code {code}: {said[-400:]}"

    def files(self):
        return {(path, path.stat().st_mtime_ns) for path in self.directory.rglob("*") if path.is_file()}

    def run(self, line):
        before = self.files()
        process = self.start(line)
        try:
            said, _ = process.communicate(timeout=SECONDS)
        except subprocess.TimeoutExpired:
            process.kill()
            return f"takes more than {SECONDS} s"
        if process.returncode != 0:
            return f"exit code {process.returncode}: {said[-400:]}"
        return "" if said.strip() or self.files() != before else "says and writes nothing"


def main(program, samples):
    examples = examples_of(program)
    wrong = [f"`{command}`: no example" for command, line in examples.items() if not line]
    wrong += [f"`{command}` of this test is no command" for command in FIRST if command not in examples]
    order = [*FIRST, *(command for command in examples if command not in FIRST)]
    done = set()
    with tempfile.TemporaryDirectory() as work:
        runner = Examples(program, pathlib.Path(work))
        make_inputs(runner.directory, samples)
        for command in order:
            line = examples.get(command)
            if not line or line in done:  # a group's example is often one of its commands'
                continue
            done.add(line)
            began = time.monotonic()
            reason = runner.serve(line) if command == "sim" else runner.run(line)
            if command == "run":
                stopped = runner.stop()
                reason = reason or stopped
            print(f"{time.monotonic() - began:6.1f} s  {line}", flush=True)
            if reason:
                wrong.append(f"`{command}`: {line}: {reason.strip()}")
        runner.stop()
    for line in wrong:
        print(line)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()))
