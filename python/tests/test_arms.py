import json
import re
import signal
import time

import numpy as np
import pytest

import hotblade as hb


@pytest.fixture(scope="module")
def held(bump, samples, program, tmp_path_factory):
    """A plan held against a cell, and what the program makes of the same."""
    cut = tmp_path_factory.mktemp("held") / "bump"
    program("plan", samples / "bump.obj", "--config", samples / "bump.toml", "--units", "mm", "--pictures", "none", "-q",
            "--cell", "two_kr50", "-o", cut)
    return hb.plan(bump[0], bump[1], cell="two_kr50"), cut


def test_cells_are_named_and_loaded(tmp_path, samples):
    assert hb.Cell.names()[0] == "two_irb4600"
    cell = hb.Cell.load("two_irb4600")
    assert cell.name and len(cell.arms) == 2 and len(cell.sha256) == 64 and all(arm in repr(cell) for arm in cell.arms)
    file = samples / "cells" / "two_irb4600.toml"
    assert hb.Cell.load(file).sha256 == cell.sha256
    assert hb.Cell.load(file).warnings == cell.warnings
    (tmp_path / "bad.toml").write_text(cell.to_toml() + "\nwrong = 1\n")
    with pytest.raises(hb.UsageError, match="bad.toml:"):
        hb.Cell.load(tmp_path / "bad.toml")
    with pytest.raises(hb.FileError):
        hb.Cell.load(tmp_path / "none.toml")


def test_a_plan_in_a_cell_is_the_programs_to_the_byte(held, bump):
    result, cut = held
    assert result.status == "passed"
    assert result.program.to_json().encode() == (cut / "program.json").read_bytes()
    assert result.report == json.loads((cut / "report.json").read_text())
    cell = hb.Cell.load("two_kr50")
    assert result.program.cell == {"name": cell.name, "sha256": cell.sha256}
    assert hb.plan(bump[0], bump[1], cell=cell).program.to_json() == result.program.to_json()
    assert bump[2].program.cell is None


def test_joints_are_views_of_the_program(held, bump):
    program = held[0].program
    for strip, said in zip(program.strips, json.loads(program.to_json())["strips"]):
        assert strip.joints_a.shape == strip.joints_b.shape == (len(strip), 6)
        assert not strip.joints_a.flags.writeable and np.shares_memory(strip.joints_a, strip.joints_a)
        for joints, key in ((strip.joints_a, "a"), (strip.joints_b, "b")):
            assert not joints.flags.owndata and joints.strides == (2 * 6 * 8, 8)
            assert joints.tolist() == [w["joints"][key] for w in said["poses"]]
        arms = strip.arms
        assert arms["a"]["arm"] == said["arms"]["a"]["arm"] and arms["raise_mm"] == said["arms"]["place"]["raise_mm"]
    strip = bump[2].program.strips[0]
    assert strip.joints_a is None and strip.joints_b is None and strip.arms is None


def test_verify_measures_joints_as_the_command_does(held, bump, samples, program):
    result, cut = held
    check = hb.verify(result.program, bump[0], cell="two_kr50")
    said = json.loads(program("verify", cut / "program.json", "--design", samples / "bump.obj", "--cell", "two_kr50", "--json"))
    assert check.report == said and check.joints_hold and check.report["joints"]["breaches"] == []
    check.check()
    with pytest.raises(hb.InputError):
        hb.verify(bump[2].program, bump[0], cell="two_kr50")


def test_joints_of_another_time_are_told(held, bump):
    said = json.loads(held[0].program.to_json())
    for pose in said["strips"][0]["poses"]:
        pose["joints"]["a"][0] += 0.01
    moved = hb.Program.from_json(json.dumps(said))
    check = hb.verify(moved, bump[0], cell="two_kr50")
    assert not check.joints_hold
    with pytest.raises(hb.OverTolerance, match="joints"):
        check.check()


def test_an_interrupt_ends_the_search_for_arms(bump):
    for after in (0.0, 0.2, 0.4):
        asked = []

        def stop(stage, share):
            if stage == "arms":
                signal.setitimer(signal.ITIMER_REAL, after + 0.01)

        def ring(*_):
            asked.append(time.process_time())
            raise KeyboardInterrupt

        before = signal.signal(signal.SIGALRM, ring)
        try:
            with pytest.raises(KeyboardInterrupt):
                hb.plan(bump[0], bump[1], 1, stop, cell="two_kr50", remedies="none")
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0)
            signal.signal(signal.SIGALRM, before)
        # Of one processor: what others take of it says nothing.
        assert time.process_time() - asked[0] < 0.3


def test_a_plan_that_no_arm_serves_is_refused(bump, samples, program, tmp_path):
    text = hb.Cell.load("two_kr50").to_toml()
    first, second = re.findall(r"^base = { .*$", text, re.M)
    far = tmp_path / "far.toml"
    far.write_text(text.replace(second, second.replace("p = [", "p = [2", 1)))
    assert far.read_text() != text and first != second
    result = hb.plan(bump[0], bump[1], cell=far)
    assert result.status == "refused" and result.refusals and result.program.cell is None
    with pytest.raises(hb.NotCuttable):
        result.check()
    program("plan", samples / "bump.obj", "--config", samples / "bump.toml", "--units", "mm", "--pictures", "none", "-q",
            "--cell", far, "-o", tmp_path / "cut", code=4)
    assert result.report == json.loads((tmp_path / "cut" / "report.json").read_text())
