import csv
import json
import math

import numpy as np
import pytest

import hotblade as hb


def panel(name, first, bend, width=300, across=0.0):
    """The OBJ of a vault of 300 mm and a name, with its first vertex number; a dome where it is bent across too."""
    lines, n = [f"g {name}"], 13
    for i in range(n):
        for j in range(n):
            x, y = width * i / (n - 1), 300 * j / (n - 1)
            z = 150 + bend * math.sin(math.pi * x / width) + across * math.sin(math.pi * y / width)
            lines.append(f"v {x} {y} {z}")
    for i in range(n - 1):
        for j in range(n - 1):
            a = first + n * i + j
            lines.append(f"f {a} {a + n} {a + n + 1} {a + 1}")
    return "\n".join(lines) + "\n", first + n * n


@pytest.fixture(scope="module")
def facade(tmp_path_factory, program):
    """A batch of two panels in two cases, one of which is refused, planned; and one more that is not."""
    place = tmp_path_factory.mktemp("facade")
    left, end = panel("left", 1, 30)
    right, _ = panel("right", end, 140, 160, 140)
    (place / "facade.obj").write_text(left + right)
    program("batch", "init", place / "all", "--design", place / "facade.obj", "--split", "group", "--units", "mm",
            "--pictures", "none", "--sweep", "design.tolerance_mm=1,2", "-q")
    program("batch", "run", place / "all", "--all", "-q")
    program("batch", "init", place / "none", "--design", place / "facade.obj", "--split", "group", "--units", "mm", "-q")
    program("batch", "gather", place / "all", "-q")
    return place


def test_jobs_are_those_of_the_directory(facade):
    batch = hb.Batch(facade / "all")
    said = list(csv.DictReader((facade / "all" / "jobs.csv").open()))
    assert len(batch) == len(said) == 4 and batch.keys == ("design.tolerance_mm",)
    for job, row in zip(batch, said):
        assert [job.number, job.panel, job.key, job.chunk] == [int(row["job"]), row["panel"], row["key"], int(row["chunk"])]
        assert job.values == {"design.tolerance_mm": row["design.tolerance_mm"]}
    assert batch[0].panel == "left" and [job.number for job in batch[1:3]] == [2, 3]
    assert batch.facts["jobs"] == 4 and batch.facts["designs"] == 2 and batch.facts["asked"]["units"] == "mm"


def test_a_job_has_what_its_plan_made(facade):
    batch = hb.Batch(facade / "all")
    for job in batch:
        result = json.loads((job.directory / "result.json").read_text())
        assert job.result == result and job.report == json.loads((job.directory / "report.json").read_text())
        assert job.settings["design.tolerance_mm"] == float(job.values["design.tolerance_mm"])
        assert (job.program is not None) == (result["verdict"] == "passed")
        assert len(job.design.triangles) == 288
    passed = next(job for job in batch if job.result["verdict"] == "passed")
    again = hb.plan(passed.design, passed.settings)
    assert again.program.to_json() == passed.program.to_json()
    assert hb.verify(passed.program, passed.design).within_tolerance
    verdicts = [job.result["verdict"] for job in batch]
    assert "refused" in verdicts, "one of each, or the tables are not tried"


def test_a_panel_that_was_changed_is_told(facade, tmp_path):
    import shutil
    shutil.copytree(facade / "all", tmp_path / "all")
    job = hb.Batch(tmp_path / "all")[0]
    file = tmp_path / "all" / "designs" / (job.design.sha256[:16] + ".obj")
    file = file if file.exists() else next((tmp_path / "all" / "designs").glob(job.design.sha256 + "*"))
    file.write_text(file.read_text().replace("150.0", "151.0", 1))
    with pytest.raises(hb.InputError, match="not the design of its name"):
        hb.Batch(tmp_path / "all")[0].design


def test_the_table_is_that_of_gather(facade):
    table = hb.Batch(facade / "all").table()
    rows = list(csv.DictReader((facade / "all" / "results.csv").open()))
    assert list(table) == list(rows[0])
    for name, column in table.items():
        for value, row in zip(column, rows):
            if isinstance(value, str):
                assert value == row[name]
            else:
                assert value == float(row[name]) if row[name] else np.isnan(value)
    assert isinstance(table["verdict"], list) and table["machine_s"].dtype == np.float64
    assert {color for color, verdict in zip(table["color"], table["verdict"]) if verdict == "passed"} <= {"green", "amber"}
    told = []
    hb.Batch(facade / "all").table(progress=lambda stage, share: told.append(share))
    assert told[-1] == 1


def test_status_is_the_commands(facade, program):
    for name in ("all", "none"):
        assert hb.Batch(facade / name).status() == json.loads(program("batch", "status", facade / name, "--json"))


def test_a_batch_without_results_says_so(facade):
    batch = hb.Batch(facade / "none")
    job = batch[0]
    assert job.result is None and job.report is None and job.program is None and job.design.units == "mm"
    with pytest.raises(hb.FileError, match="has no result: .* ask again with partial=True"):
        batch.table()
    with pytest.raises(hb.UsageError, match="partial: str .True or False needed"):
        batch.table("x")
    table = batch.table(partial=True)
    assert table["verdict"] == ["missing"] * len(batch) and np.isnan(table["machine_s"]).all()


def test_what_is_no_batch_is_told(tmp_path):
    with pytest.raises(hb.FileError):
        hb.Batch(tmp_path)
    (tmp_path / "batch.json").write_text("{}")
    with pytest.raises(hb.InputError) as wrong:
        hb.Batch(tmp_path)
    assert (wrong.value.file, wrong.value.line) == (str(tmp_path / "batch.json"), None)
