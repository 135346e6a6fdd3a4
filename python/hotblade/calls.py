"""What is called of the module by name: arguments and what they are unless said (docs/python.md)."""
from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Callable, Mapping, Optional, Union

from . import _hotblade  # type: ignore

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from . import Cell, Check, Design, Plan, Program

Path = Union[str, "os.PathLike[str]"]
Values = Mapping[str, Any]  # of Settings, or Settings themselves
Progress = Callable[[str, float], object]


def read(file: Path, units: Optional[str] = None, up: Optional[str] = None, group: Optional[str] = None,
         facing: Optional[ArrayLike] = None, stitch_mm: Optional[float] = None, *, format: Optional[str] = None,
         settings: Optional[Values] = None) -> Design:
    """Reads a design: OBJ, STL, PLY, glTF or GLB."""
    return _hotblade.read(file, units, up, group, facing, stitch_mm, format, settings)  # type: ignore[no-any-return]


def from_arrays(vertices: ArrayLike, triangles: ArrayLike, units: Optional[str] = None, name: str = "design", *,
                up: Optional[str] = None, settings: Optional[Values] = None) -> Design:
    """The design of points (n, 3) and triangles (m, 3), known by the OBJ that save() writes."""
    return _hotblade.from_arrays(vertices, triangles, units, name, up, settings)  # type: ignore[no-any-return]


def plan(design: Design, settings: Optional[Values] = None, threads: int = 0, progress: Optional[Progress] = None, *,
         cell: Optional[Union[Cell, Path]] = None, remedies: str = "shape") -> Plan:
    """Plans and verifies the cut program of a design."""
    return _hotblade.plan(design, settings, threads, progress, cell, remedies)  # type: ignore[no-any-return]


def verify(program: Program, design: Design, sample_mm: float = 2.5, threads: int = 0,
           progress: Optional[Progress] = None, *, cell: Optional[Union[Cell, Path]] = None) -> Check:
    """Measures a program against its design again."""
    return _hotblade.verify(program, design, sample_mm, threads, progress, cell)  # type: ignore[no-any-return]
