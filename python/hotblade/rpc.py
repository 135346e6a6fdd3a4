"""The commands as functions of plain numbers, texts, lists and dictionaries, for other processes and other machines.

    from compas.rpc import Proxy
    hotblade = Proxy("hotblade.rpc")      # CPython on Linux or WSL, from Rhino or Grasshopper
    answer = hotblade.plan({"vertices": ..., "triangles": ..., "units": "mm"}, {"design.tolerance_mm": 1})

A design is {"file": ..., "units": ...} or {"vertices", "triangles", "units", "name"}; further keys of it are those of
hotblade.read and Design.from_arrays, its `settings` on top of those of the call. A program is the dictionary of program.json. Errors are raised as in hotblade.
"""
from __future__ import annotations

import json
import math
from typing import Any, Dict, List, Optional, Sequence, Union

import hotblade as _hb
from hotblade import curve as _curve

Json = Dict[str, Any]


def _is_given(what: str, value: object, wanted: str) -> None:
    """Raises UsageError where an argument is no dictionary."""
    if not isinstance(value, dict):
        raise _hb.UsageError(f"{what}: {type(value).__qualname__} ({wanted} needed)")


def _design(design: Json, settings: Optional[_hb.Settings] = None) -> _hb.Design:
    _is_given("design", design, "a dictionary of file, or of vertices and triangles, and of units")
    words = dict(design)
    own = words.get("settings")
    if settings is not None:
        words["settings"] = settings if own is None else settings.changed(own)
    if "file" in words:
        return _hb.read(**words)
    return _hb.Design.from_arrays(**words)


def _settings(values: Optional[Json], files: Union[str, Sequence[str]]) -> _hb.Settings:
    return _hb.Settings.load(files, values)


def _plain(value: Any) -> Any:
    """Arrays as lists, named tuples as dictionaries, what is no number as None."""
    if hasattr(value, "_asdict"):
        return {key: _plain(part) for key, part in value._asdict().items()}
    if hasattr(value, "tolist"):
        return _plain(value.tolist())
    if isinstance(value, (list, tuple)):
        return [_plain(part) for part in value]
    if isinstance(value, float) and math.isnan(value):
        return None
    return value


def check(design: Json, settings: Optional[Json] = None, files: Union[str, Sequence[str]] = ()) -> Json:
    """The health of a design."""
    health = _design(design, _settings(settings, files)).health
    return {key: _plain(value) for key, value in health.items()}


def config(settings: Optional[Json] = None, files: Union[str, Sequence[str]] = ()) -> Json:
    """All settings, those given on top of the files'."""
    return {key: _plain(value) for key, value in _settings(settings, files).items()}


def plan(design: Json, settings: Optional[Json] = None, files: Union[str, Sequence[str]] = (), threads: int = 0,
         cell: Optional[str] = None, remedies: str = "shape") -> Json:
    """status, refusals, remedies, warnings, report and program of a plan; a refused plan's program is None.

    `cell` is a file on this side, or a name of a cell that hotblade brings.
    """
    resolved = _settings(settings, files)
    result = _hb.plan(_design(design, resolved), resolved, threads, cell=cell, remedies=remedies)
    passed = result.status == "passed"
    return {"status": result.status, "refusals": result.refusals, "remedies": result.remedies,
            "warnings": result.warnings, "report": result.report,
            "program": json.loads(result.program.to_json()) if passed else None}


def verify(program: Json, design: Json, sample_mm: float = 2.5, threads: int = 0, cell: Optional[str] = None) -> Json:
    """What `hotblade verify --json` says of a program; the design is read as the program says."""
    _is_given("program", program, "the dictionary of a program; a refused plan has none")
    loaded = _hb.Program.from_json(json.dumps(program))
    settings = loaded.settings
    return _hb.verify(loaded, _design(design, settings), sample_mm, threads, cell=cell).report


def batch_status(directory: str) -> Json:
    """How far a batch is, as `hotblade batch status --json` has it."""
    return _hb.Batch(directory).status()


def batch_table(directory: str, partial: bool = False) -> Json:
    """The columns of a batch's results by name."""
    return {name: _plain(column) for name, column in _hb.Batch(directory).table(partial).items()}


def curve_residual(bezier: List[Any]) -> Json:
    return dict(_plain(_curve.residual(bezier)))


def curve_fit(curve: List[Any], ends: str = "free", tangents: Optional[List[float]] = None) -> Json:
    return dict(_plain(_curve.fit(curve, ends, tangents)))


def curve_project(bezier: List[Any], method: str = "feedback", branch: str = "best", threshold: float = 0) -> Json:
    return dict(_plain(_curve.project(bezier, method, branch, threshold)))


def curve_sample(elastica: List[float], n: int) -> Json:
    return dict(_plain(_curve.sample(elastica, n)))


def curve_equilibria(a: List[float], b: List[float], length: float, max_inflections: Optional[int] = None,
                     max_energy: Optional[float] = None) -> Json:
    return dict(_plain(_curve.equilibria(a, b, length, max_inflections, max_energy)))


def curve_arcs(curve: List[Any], tolerance: float, order: str = "biarc") -> Json:
    return dict(_plain(_curve.arcs(curve, tolerance, order)))
