import ctypes
import gc
import json
import math
import os
import pickle
import re
import shutil
import signal
import subprocess
import sys
import threading
import time
import weakref

import numpy as np
import pytest

import hotblade as hb


def test_a_plan_is_the_programs_to_the_byte(bump, bump_cut):
    result = bump[2]
    assert result.status == "passed"
    assert result.program.to_json().encode() == (bump_cut / "program.json").read_bytes()
    assert result.report == json.loads((bump_cut / "report.json").read_text())
    result.check()


def test_threads_change_no_byte(bump):
    design, settings, result = bump
    assert hb.plan(design, settings, threads=1).program.to_json() == result.program.to_json()


@pytest.mark.parametrize("threads", [-1, 1025, 10**7])
def test_threads_are_counted(bump, threads):
    for call in (lambda: hb.plan(*bump[:2], threads=threads), lambda: hb.verify(bump[2].program, bump[0], threads=threads)):
        with pytest.raises(hb.UsageError, match=f"threads .{threads}, must be 0 to 1024"):
            call()


def test_a_design_of_any_name_is_planned(bump, samples, tmp_path):
    file = os.fsdecode(os.fsencode(tmp_path) + b"/b\xff.obj")
    shutil.copy(samples / "bump.obj", file)
    design = hb.read(file, settings=bump[1])
    result = hb.plan(design, bump[1])
    assert result.program.design_file == design.name == os.path.basename(file)
    # A JSON is UTF-8, and has the mark of what is none in its place.
    assert result.report["design"]["file"] == json.loads(result.program.to_json())["design"]["file"] == "b\ufffd.obj"
    assert hb.verify(result.program, design).report["within_tolerance"]


def test_programs_are_saved_and_loaded(bump, bump_cut, tmp_path, program, samples):
    text = bump[2].program.to_json()
    for name in ("program.json", "program.json.gz"):
        bump[2].program.save(tmp_path / name)
        assert hb.Program.load(tmp_path / name).to_json() == text
        program("verify", tmp_path / name, "--design", samples / "bump.obj")
    with pytest.raises(hb.FileError):
        bump[2].program.save(tmp_path / "program.json")
    with pytest.raises(hb.InputError, match="not JSON"):
        hb.Program.load(samples / "bump.obj")
    for behind in ("\0", "\0garbage{{{"):
        with pytest.raises(hb.InputError, match="not JSON: a NUL byte"):
            hb.Program.from_json(text + behind)


def test_verify_measures_what_the_command_does(bump, bump_cut, program, samples):
    check = hb.verify(bump[2].program, bump[0])
    said = json.loads(program("verify", bump_cut / "program.json", "--design", samples / "bump.obj", "--json"))
    assert check.report == said
    assert check.within_tolerance and check.held and check.deviation_mm == said["deviation_mm"]["max"]
    check.check()
    with pytest.raises(hb.InputError, match="not the design of this program"):
        hb.verify(bump[2].program, hb.read(samples / "petal.obj", "mm"))


@pytest.mark.parametrize("words", [{"units": "cm"}, {"units": "mm", "up": "y"}, {"units": "mm", "facing": [0, 0, 1]},
                                   {"units": "mm", "stitch_mm": 0.001}])
def test_a_design_that_was_read_otherwise_is_not_the_programs(bump, samples, words):
    design = hb.read(samples / "bump.obj", **words)
    key = list(words)[-1]
    with pytest.raises(hb.UsageError, match=f"design: bump.obj was read with design.{key} = .* settings=program.settings"):
        hb.verify(bump[2].program, design)
    again = hb.read(samples / "bump.obj", settings=bump[2].program.settings)
    assert hb.verify(bump[2].program, again).within_tolerance


def test_a_part_is_not_the_design_of_a_program(tmp_path, bump, samples):
    file = tmp_path / "two.obj"
    lines = (samples / "bump.obj").read_text().splitlines()
    faces = [i for i, line in enumerate(lines) if line.startswith("f ")]
    lines.insert(faces[len(faces) // 2], "g right")
    lines.insert(faces[0], "g left")
    file.write_text("\n".join(lines) + "\n")
    values = {key: value for key, value in bump[1].items() if not key.startswith("design.")}
    whole = hb.plan(hb.read(file, "mm"), values, remedies="none")
    with pytest.raises(hb.UsageError, match='design.group = "left", and for this program with ""'):
        hb.verify(whole.program, hb.read(file, "mm", group="left"))


def test_a_check_names_the_limit_that_broke(bump):
    cut = json.loads(bump[2].program.to_json())
    cut["strips"].pop()
    check = hb.verify(hb.Program.from_json(json.dumps(cut)), bump[0])
    with pytest.raises(hb.OverTolerance) as over:
        check.check()
    said = check.report
    uncut = f"uncut {said['uncut_mm2']:.0f} mm2 ({100 * said['uncut_share']:.2f} % of the design, limit"
    assert said["uncut_share"] > 0.01 and uncut in str(over.value)
    assert ("deviation" in str(over.value)) == (said["deviation_mm"]["bound"] > check.tolerance_mm)


def test_poses_are_arrays_of_the_program(bump):
    program = bump[2].program
    text = json.loads(program.to_json())
    for strip, said in zip(program.strips, text["strips"]):
        waypoints = said["poses"]
        assert strip.id == said["id"] and len(strip) == len(waypoints)
        assert strip.t.tolist() == [w["t"] for w in waypoints]
        assert [hb.PHASES[i] for i in strip.phase] == [w["phase"] for w in waypoints]
        assert strip.heat.tolist() == [w["heat"] for w in waypoints]
        for ours, key in ((strip.a, "a"), (strip.b, "b")):
            assert ours.shape == (len(waypoints), 7)
            assert ours.tolist() == [w[key]["p"] + w[key]["q"] for w in waypoints]
        assert strip.blade.tolist() == [list(w["blade"].values()) for w in waypoints]
        for array in (strip.t, strip.phase, strip.blade, strip.a, strip.b):
            assert not array.flags.writeable
        for rib, of_text in zip(strip.ribs, said["ribs"]):
            assert rib.id == of_text["id"]
            assert rib.bezier.tolist() == of_text["bezier"] and rib.target.tolist() == of_text["target"]


def address(array):
    return array.__array_interface__["data"][0]


def test_arrays_share_the_programs_memory_and_outlive_it(bump, bump_cut):
    names = ("t", "a", "b", "blade", "phase", "heat", "margin")
    for make in (lambda: hb.plan(bump[0], bump[1]).program, lambda: hb.Program.load(bump_cut / "program.json")):
        program = make()
        strip, again = program.strips[0], program.strips[0]
        waypoint = strip.t.strides[0]
        for name in names:
            array = getattr(strip, name)
            assert np.shares_memory(array, getattr(again, name)) and not array.flags.owndata, name
            # All are parts of the program's own waypoints, where they lie in its memory.
            assert array.strides[0] == waypoint and abs(address(array) - address(strip.t)) < waypoint, name
        arrays = [getattr(strip, name) for name in names]
        before = [array.copy() for array in arrays]
        owners = [weakref.ref(array.base) for array in arrays]
        del strip, again, program, array
        gc.collect()
        assert all(owner() is not None for owner in owners)
        others = [hb.Program.load(bump_cut / "program.json").strips[0].a.sum() for _ in range(3)]
        assert others == [before[1].sum()] * 3
        for array, values in zip(arrays, before):
            assert np.array_equal(array, values)
        del array, arrays
        gc.collect()
        assert all(owner() is None for owner in owners), "what no array shows any more is let go"


def test_arrays_of_ribs_share_the_programs_memory_and_outlive_it(bump, bump_cut):
    names = ("target", "bezier", "elastica", "origin", "x", "y")
    for make in (lambda: hb.plan(bump[0], bump[1]).program, lambda: hb.Program.load(bump_cut / "program.json")):
        program = make()
        ribs, again = program.strips[0].ribs, program.strips[0].ribs
        assert len(ribs) > 1
        for rib, other in zip(ribs, again):
            for name in names:
                array = getattr(rib, name)
                assert np.shares_memory(array, getattr(other, name)) and not array.flags.owndata, name
                assert array.flags.c_contiguous and array.dtype == np.float64, name
                with pytest.raises(ValueError, match="read-only"):
                    array[...] = 0
        # Of one rib and of two, what is shown is not the same memory: no array is a buffer that they share.
        shown = [getattr(rib, name) for rib in (ribs[0], ribs[-1]) for name in names]
        assert not any(np.shares_memory(one, two) for i, one in enumerate(shown) for two in shown[:i])
        before = [array.copy() for array in shown]
        owners = [weakref.ref(array.base) for array in shown]
        del rib, other, array, ribs, again, program
        gc.collect()
        assert all(owner() is not None for owner in owners)
        others = [hb.Program.load(bump_cut / "program.json").strips[0].ribs[0].target.sum() for _ in range(3)]
        assert others == [before[0].sum()] * 3
        for array, values in zip(shown, before):
            assert np.array_equal(array, values)
        del array, shown
        gc.collect()
        assert all(owner() is None for owner in owners), "what no array shows any more is let go"


def test_a_refused_plan_is_returned_and_says_why(samples, tmp_path):
    settings = hb.Settings.load(samples / "bump.toml", {"design.units": "mm", "blade.free_lengths_mm": [50]})
    design = hb.read(samples / "bump.obj", settings=settings)
    result = hb.plan(design, settings)
    assert result.status == "refused" and result.refusals
    with pytest.raises(hb.NotCuttable) as refused:
        result.check()
    assert refused.value.exit_code == 4 and str(refused.value) == result.refusals[0]["message"]
    with pytest.raises(hb.NotCuttable):
        result.program.save(tmp_path / "program.json")
    assert not (tmp_path / "program.json").exists()


def in_metres(samples, tmp_path):
    """The sample written in metres and read in mm, by a file of its own."""
    file = tmp_path / "metres.obj"
    with open(samples / "bump.obj") as lines, open(file, "w") as out:
        for line in lines:
            words = line.split()
            out.write(f"v {' '.join(str(float(w) / 1000) for w in words[1:])}\n" if words and words[0] == "v" else line)
    return file


def cylinder(tmp_path):
    """Part of a cylinder along x: radius 400 mm, 300 mm long, 0.6 rad wide."""
    file = tmp_path / "cylinder.obj"
    turns = [0.6 * (j / 24 - 0.5) for j in range(25)]
    with open(file, "w") as out:
        for x in (0, 300):
            out.writelines(f"v {x} {400 * math.sin(t)!r} {400 * math.cos(t)!r}\n" for t in turns)
        out.writelines(f"f {j} {j + 25} {j + 26} {j + 1}\n" for j in range(1, 25))
    return file


def test_remedies_are_the_commands(samples, program, tmp_path):
    file = in_metres(samples, tmp_path)
    settings = hb.Settings.load(samples / "bump.toml", {"design.units": "mm"})
    design = hb.read(file, settings=settings)
    short = cylinder(tmp_path)
    one_blade = {"design.units": "mm", "slice.direction": [1, 0, 0], "blade.free_lengths_mm": [100]}
    (tmp_path / "one_blade.toml").write_text("slice.direction = [1, 0, 0]\nblade.free_lengths_mm = [100]\n")
    for word, option, job, config, read, given, change in (
            ("shape", [], file, samples / "bump.toml", design, settings, "design.units=m"),
            ("all", ["--advise"], short, tmp_path / "one_blade.toml", hb.read(short, settings=hb.Settings(one_blade)),
             hb.Settings(one_blade), None)):
        cut = tmp_path / word
        program("plan", job, "--config", config, "--units", "mm", "--pictures", "none", "-q", *option, "-o", cut, code=4)
        told = []
        result = hb.plan(read, given, remedies=word, progress=lambda stage, share: told.append(share))
        assert result.report == json.loads((cut / "report.json").read_text())
        assert result.remedies == result.report["remedies"] and result.remedies
        assert change is None or [change] in [r["set"] for r in result.remedies]
        assert told == sorted(told) and told[-1] == 1
    assert hb.plan(design, settings, remedies="none").remedies == []
    with pytest.raises(hb.UsageError, match="remedies .\"some\", must be one of none, shape, all"):
        hb.plan(design, settings, remedies="some")
    arrays = hb.Design.from_arrays(design.vertices, design.triangles, "mm", "metres")
    assert ["design.units=m"] in [r["set"] for r in hb.plan(arrays, settings).remedies]


def test_remedies_of_a_design_that_is_gone_are_not_made_up(samples, tmp_path):
    file = in_metres(samples, tmp_path)
    settings = hb.Settings.load(samples / "bump.toml", {"design.units": "mm"})
    design = hb.read(file, settings=settings)
    with open(file, "a") as out:
        out.write("# changed\n")
    result = hb.plan(design, settings)
    assert result.remedies == [] and any("changed since it was read" in line for line in result.warnings)
    file.unlink()
    result = hb.plan(design, settings)
    assert result.status == "refused" and any("no remedies were tried" in line for line in result.warnings)


def test_settings_that_contradict_the_design_are_told(bump, samples):
    with pytest.raises(hb.UsageError, match="design.units: the settings say something else"):
        hb.plan(hb.read(samples / "bump.obj", "cm"), bump[1])


@pytest.mark.parametrize("words, values", [
    ({"up": "y"}, {"design.up": "z"}), ({"facing": [0, 0, 1]}, {"design.facing": None}),
    ({"stitch_mm": 0.001}, {"design.stitch_mm": 0}), ({}, {"design.group": "roof"}), ({}, {"design.format": "stl"})])
def test_settings_that_say_what_is_the_default_say_it(samples, tmp_path, words, values):
    design = hb.read(samples / "bump.obj", "mm", **words)
    said = hb.Settings(values)
    for settings in (values, said, pickle.loads(pickle.dumps(said)), hb.Settings(said), said.changed({"fit.max_splits": 7}),
                     hb.Settings.load((), said)):
        with pytest.raises(hb.UsageError, match=f"{list(values)[0]}: the settings say something else .* than bump.obj was read by"):
            hb.plan(design, settings, remedies="none")


def test_settings_that_say_nothing_of_the_design_are_taken(samples):
    design = hb.read(samples / "bump.obj", "mm", up="y", format="obj")
    for settings in (None, hb.Settings(), hb.Settings(hb.Settings()), {"design.format": "auto", "design.units": ""},
                     {"design.up": "y"}, pickle.loads(pickle.dumps(hb.Settings({"design.units": "mm"})))):
        assert hb.plan(design, settings, remedies="none").program.settings["design.up"] == "y"


def test_what_gltf_says_of_itself_contradicts_no_settings(bump, tmp_path):
    points = (bump[0].vertices[:, [0, 2, 1]] * [1, 1, -1] / 1000).astype("<f4")
    corners = bump[0].triangles.astype("<u4")
    (tmp_path / "bump.bin").write_bytes(points.tobytes() + corners.tobytes())
    (tmp_path / "bump.gltf").write_text(json.dumps({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "buffers": [{"byteLength": points.nbytes + corners.nbytes, "uri": "bump.bin"}],
        "bufferViews": [{"buffer": 0, "byteLength": points.nbytes},
                        {"buffer": 0, "byteOffset": points.nbytes, "byteLength": corners.nbytes}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": len(points), "type": "VEC3",
                       "min": points.min(0).tolist(), "max": points.max(0).tolist()},
                      {"bufferView": 1, "componentType": 5125, "count": corners.size, "type": "SCALAR"}]}))
    file = tmp_path / "all.toml"
    file.write_text(bump[1].changed({"design.units": ""}).to_toml())
    settings = hb.Settings.load(file)
    assert settings["design.up"] == "z"
    design = hb.read(tmp_path / "bump.gltf", settings=settings)
    result = hb.plan(design, settings)
    assert result.status == "passed" and hb.verify(result.program, design).within_tolerance
    assert hb.verify(result.program, hb.read(tmp_path / "bump.gltf")).within_tolerance
    for key, word in (("design.units", "mm"), ("design.format", "obj")):
        with pytest.raises(hb.UsageError, match=key):
            hb.plan(design, {key: word})


def test_progress_is_told_and_its_exception_comes_through(bump):
    told = []
    hb.plan(bump[0], bump[1], progress=lambda stage, share: told.append((stage, share)))
    shares = [share for _, share in told]
    assert told[-1] == ("done", 1.0) and shares == sorted(shares) and len(told) > 3
    class Enough(Exception):
        pass
    def enough(stage, share):
        raise Enough
    with pytest.raises(Enough):
        hb.plan(bump[0], bump[1], progress=enough)


def interrupted_after(seconds, call):
    """How long the interrupt took from the signal on; None where the call was over before it."""
    sent = []
    def kill():
        time.sleep(seconds)
        sent.append(time.perf_counter())
        os.kill(os.getpid(), signal.SIGINT)
    killer = threading.Thread(target=kill)
    killer.start()
    try:
        call()
        over = time.perf_counter()
        while killer.is_alive():
            time.sleep(0.01)
        time.sleep(0.01)
        assert over <= sent[0], "a signal that was lost"
    except KeyboardInterrupt:
        taken = time.perf_counter() - sent[0]
        killer.join()
        return taken
    return None


def test_an_interrupt_ends_a_plan_soon_and_spoils_nothing(bump):
    design, settings, result = bump
    started = time.perf_counter()
    hb.plan(design, settings)
    whole = time.perf_counter() - started
    random = np.random.default_rng(7)
    took = [interrupted_after(at, lambda: hb.plan(design, settings)) for at in random.uniform(0, 0.9 * whole, 12)]
    took = sorted(t for t in took if t is not None)
    assert len(took) >= 6
    # 0.3 s of a quiet machine (docs/python.md): here others may run beside it.
    assert took[len(took) // 2] < 0.3 and took[-1] < 1.5, took
    assert hb.plan(design, settings).program.to_json() == result.program.to_json()


class MallocInfo(ctypes.Structure):
    _fields_ = [(name, ctypes.c_size_t) for name in
                ("arena", "ordblks", "smblks", "hblks", "hblkhd", "usmblks", "fsmblks", "uordblks", "fordblks", "keepcost")]


def allocated():
    """Bytes that the process has asked of the C library and not given back, be it free memory for the next or not."""
    gc.collect()
    information = ctypes.CDLL(None).mallinfo2
    information.restype = MallocInfo
    info = information()
    return info.uordblks + info.hblkhd


@pytest.mark.parametrize("threads", [1, 2])
def test_plans_leave_nothing_allocated(threads):
    x, y = np.meshgrid(np.linspace(0, 300, 9), np.linspace(0, 200, 7))
    vertices = np.column_stack([x.ravel(), y.ravel(), (30 * np.sin(np.pi * x / 300) + 80).ravel()])
    corner = (np.arange(6)[:, None] * 9 + np.arange(8)).ravel()
    triangles = np.concatenate([np.column_stack([corner, corner + 1, corner + 10]), np.column_stack([corner, corner + 10, corner + 9])])
    panel = hb.Design.from_arrays(vertices, triangles, "mm", "panel")
    settings = hb.Settings({"design.tolerance_mm": 2})
    sizes = []
    for _ in range(20):
        assert hb.plan(panel, settings, threads).status == "passed"
        sizes.append(allocated())
    # The C library counts what its threads' caches hold free, some kB; one plan that is kept takes over 100.
    kept = hb.plan(panel, settings, threads)
    assert allocated() - sizes[-1] > 100_000 and kept.status == "passed"
    assert abs(sizes[-1] - sizes[9]) < 30_000, sizes


def test_many_threads_may_plan_at_once(bump):
    design, settings, result = bump
    texts = [None] * 3
    def work(i):
        texts[i] = hb.plan(design, settings, threads=1).program.to_json()
    threads = [threading.Thread(target=work, args=(i,)) for i in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert texts == [result.program.to_json()] * 3


def test_the_module_draws_nothing():
    library = sys.modules["hotblade._hotblade"].__file__
    linked = subprocess.run(["ldd", library], capture_output=True, text=True, check=True).stdout
    assert "libtbb" in linked and not re.search("vtk|GL|X11", linked), linked


def run_python(text, *words):
    return subprocess.run([sys.executable, "-c", text, *map(str, words)], capture_output=True, text=True, timeout=120)


ENDS = """
import sys, threading, time
import hotblade as hb
design = hb.read(sys.argv[1], "mm")
def work():
    began.set()
    while True:
        hb.read(sys.argv[1], "mm") if sys.argv[2] == "read" else hb.plan(design, progress=told)
told = (lambda stage, share: time.sleep(0.2)) if sys.argv[2] == "told" else None
began = threading.Event()
for _ in range(2):
    threading.Thread(target=work, daemon=True).start()
began.wait()
time.sleep(float(sys.argv[3]))
"""


@pytest.mark.parametrize("work", ["plan", "told", "read"])
@pytest.mark.parametrize("after", [0, 0.1, 0.3, 0.5])
def test_python_ends_beside_threads_that_work(samples, work, after):
    done = run_python(ENDS, samples / "bump.obj", work, after)
    assert (done.returncode, done.stderr) == (0, "")


def test_what_python_calls_at_its_end_may_plan(samples):
    done = run_python("""
import atexit, sys
atexit.register(lambda: print(hb.plan(hb.read(sys.argv[1], settings=settings), settings).status))
import hotblade as hb
settings = hb.Settings.load(sys.argv[2], {"design.units": "mm"})
""", samples / "bump.obj", samples / "bump.toml")
    assert (done.returncode, done.stdout, done.stderr) == (0, "passed\n", "")


def test_a_fork_ends_without_the_threads_of_its_parent(samples):
    done = run_python("""
import os, sys, threading, time
import hotblade as hb
design = hb.read(sys.argv[1], "mm")
threading.Thread(target=lambda: [hb.plan(design) for _ in range(99)], daemon=True).start()
time.sleep(0.2)
child = os.fork()
if child:
    assert os.waitpid(child, 0)[1] == 0
""", samples / "bump.obj")
    assert (done.returncode, done.stderr) == (0, "")


def test_more_threads_than_cores_are_no_warning(samples):
    done = run_python("""
import os, sys
import hotblade as hb
settings = hb.Settings.load(sys.argv[2], {"design.units": "mm"})
design = hb.read(sys.argv[1], settings=settings)
for more in (1, 3, 2, 40):
    hb.plan(design, settings, os.cpu_count() + more)
""", samples / "bump.obj", samples / "bump.toml")
    assert (done.returncode, done.stderr) == (0, "")
