import os
import pathlib
import subprocess

import pytest

import hotblade as hb

SOURCE = pathlib.Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def samples():
    return SOURCE / "samples"


@pytest.fixture(scope="session")
def program():
    """Runs the program; returns what it prints."""
    def run(*words, code=0, **options):
        done = subprocess.run([os.environ["HOTBLADE_PROGRAM"], *map(str, words)], capture_output=True, text=True, **options)
        assert done.returncode == code, done.stderr
        return done.stdout
    return run


@pytest.fixture(scope="session")
def bump(samples):
    """A sample with its settings and its plan."""
    settings = hb.Settings.load(samples / "bump.toml", {"design.units": "mm"})
    design = hb.read(samples / "bump.obj", settings=settings)
    return design, settings, hb.plan(design, settings)


@pytest.fixture(scope="session")
def bump_cut(samples, program, tmp_path_factory):
    """What the program makes of the same."""
    cut = tmp_path_factory.mktemp("cut") / "bump"
    program("plan", samples / "bump.obj", "--config", samples / "bump.toml", "--units", "mm", "--pictures", "none", "-q",
            "-o", cut)
    return cut
