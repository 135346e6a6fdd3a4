import inspect
import json

import pytest

import hotblade as hb
from hotblade import rpc


def plain(value):
    """Through the text that such a call is sent as."""
    return json.loads(json.dumps(value, allow_nan=False))


def test_a_plan_of_lists_is_that_of_the_design(bump):
    design, settings, result = bump
    listed = {"vertices": design.vertices.tolist(), "triangles": design.triangles.tolist(), "units": "mm", "name": "bump"}
    values = plain({k: v for k, v in settings.items() if k.startswith(("design.tol", "blade", "stock", "slice", "foam"))})
    answer = plain(rpc.plan(plain(listed), values))
    assert answer["status"] == "passed" and len(answer["program"]["strips"]) == len(result.program.strips)
    check = plain(rpc.verify(answer["program"], plain(listed)))
    assert check["within_tolerance"] and check["deviation_mm"]["max"] <= settings["design.tolerance_mm"]
    assert plain(rpc.check(plain(listed)))["triangles"] == len(design.triangles)


def test_a_plan_of_a_file_is_the_modules(bump, samples):
    answer = plain(rpc.plan({"file": str(samples / "bump.obj")}, {"design.units": "mm"}, str(samples / "bump.toml")))
    assert answer["program"] == json.loads(bump[2].program.to_json()) and answer["report"] == bump[2].report
    assert plain(rpc.verify(answer["program"], {"file": str(samples / "bump.obj")}))["within_tolerance"]


def test_a_design_has_settings_of_its_own(bump, samples):
    file = str(samples / "bump.obj")
    answer = rpc.plan({"file": file, "settings": {"design.units": "mm"}}, None, str(samples / "bump.toml"), remedies="none")
    assert answer["program"] == json.loads(bump[2].program.to_json())
    with pytest.raises(hb.UsageError, match="design.units: the settings say something else"):
        rpc.plan({"file": file, "settings": {"design.units": "mm"}}, {"design.units": "cm"})


@pytest.mark.parametrize("words", [{"units": "cm"}, {"up": "y"}, {"settings": {"design.units": "cm"}}])
def test_a_program_is_verified_by_its_own_reading(bump, samples, words):
    answer = json.loads(bump[2].program.to_json())
    with pytest.raises(hb.UsageError, match="design: bump.obj was read with design"):
        rpc.verify(answer, {"file": str(samples / "bump.obj"), **words})


def test_a_refused_plan_has_reasons_and_no_program(samples):
    answer = plain(rpc.plan({"file": str(samples / "bump.obj")}, {"design.units": "mm", "blade.free_lengths_mm": [50]}, str(samples / "bump.toml")))
    assert answer["status"] == "refused" and answer["refusals"] and answer["program"] is None
    assert answer["remedies"] == []
    with pytest.raises(hb.FileError):
        rpc.check({"file": "none.obj", "units": "mm"})


@pytest.mark.parametrize("call, said", [
    (lambda: rpc.plan("a.obj"), "design: str .a dictionary of file, or of vertices and triangles, and of units needed"),
    (lambda: rpc.check(None), "design: NoneType .a dictionary"),
    (lambda: rpc.verify(None, {"file": "a.obj"}), "program: NoneType .the dictionary of a program; a refused plan has none"),
    (lambda: rpc.plan({"file": "a.obj", "units": "mm"}, "job.toml"), "settings: str .hotblade.Settings or a mapping"),
])
def test_what_is_no_dictionary_is_told_by_its_name(call, said):
    with pytest.raises(hb.UsageError, match=said):
        call()


def test_arms_and_batches_are_plain(bump, samples, program, tmp_path):
    design = {"file": str(samples / "bump.obj")}
    answer = plain(rpc.plan(design, {"design.units": "mm"}, str(samples / "bump.toml"), cell="two_kr50", remedies="none"))
    assert answer["status"] == "passed" and answer["program"]["cell"]["name"] == hb.Cell.load("two_kr50").name
    assert plain(rpc.verify(answer["program"], design, cell="two_kr50"))["joints"]["breaches"] == []
    program("batch", "init", tmp_path / "batch", "--design", samples / "bump.obj", "--units", "mm", "-q")
    assert plain(rpc.batch_status(str(tmp_path / "batch")))["plans"] == 1
    table = plain(rpc.batch_table(str(tmp_path / "batch"), True))
    assert table["verdict"] == ["missing"] and table["machine_s"] == [None] and table["job"] == [1]


def test_settings_are_plain(samples):
    values = plain(rpc.config({"design.units": "mm"}, [str(samples / "bump.toml")]))
    assert values["design.units"] == "mm" and values["blade.free_lengths_mm"][0] == 400
    assert plain(rpc.config(values)) == values


def test_threads_are_counted(samples):
    design = {"file": str(samples / "bump.obj"), "units": "mm"}
    with pytest.raises(hb.UsageError, match="threads .10000000, must be 0 to 1024"):
        rpc.plan(design, None, str(samples / "bump.toml"), 10**7)


def test_curves_are_plain():
    bezier = [[0, 0], [30, 40], [70, 40], [100, 0]]
    assert plain(rpc.curve_residual(bezier))["status"] == "ok"
    assert plain(rpc.curve_residual([[0, 0], [0, 0], [70, 40], [100, 0]]))["value"] is None
    near = plain(rpc.curve_fit(bezier))["elastica"]
    points = plain(rpc.curve_sample(near, 20))["points"]
    assert plain(rpc.curve_fit(points))["h1"] is None
    assert plain(rpc.curve_project(bezier, "optimal"))["status"] == "ok"
    assert plain(rpc.curve_arcs(near, 0.01))["error_bound"] <= 0.01
    assert len(plain(rpc.curve_equilibria([0, 0, 0.5], [100, 0, -0.5], 110))["shapes"]) == 2
    tools = {name for name, tool in inspect.getmembers(hb.curve, inspect.isfunction) if tool.__module__ == "hotblade.curve"}
    assert {"curve_" + tool for tool in tools} <= set(dir(rpc)) | {"curve_residuals"}
