"""Batches that `hotblade batch` has planned, or is planning: their jobs, results and tables (docs/python.md)."""
from __future__ import annotations

import json
import math
import os
import pathlib
from typing import TYPE_CHECKING, Any, Callable, Dict, Iterator, Optional, Sequence, Tuple, Union, cast

from . import _hotblade  # type: ignore
from .calls import read
from .errors import InputError

if TYPE_CHECKING:
    from . import Design, Program, Settings

_batch = _hotblade.batch

# Columns of text; the others are numbers.
TEXTS = ("verdict", "worst_refusal", "message", "node", "version", "report", "color")


class Job:
    """A panel in one case of the sweeps; jobs of the same key are one plan."""

    def __init__(self, batch: Batch, number: int, panel: str, key: str, chunk: int, values: Dict[str, str]) -> None:
        self._batch = batch
        self.number, self.panel, self.key, self.chunk, self.values = number, panel, key, chunk, values

    def __repr__(self) -> str:
        return f"<hotblade.Job {self.number}: {self.panel}>"

    def _files(self) -> Tuple[pathlib.Path, pathlib.Path, pathlib.Path]:
        """The directory of the result, the design and the settings."""
        return cast("Tuple[pathlib.Path, pathlib.Path, pathlib.Path]", tuple(
            map(pathlib.Path, _batch.files(self._batch.directory, self.key, *self._batch._hashes(self)))))

    @property
    def directory(self) -> pathlib.Path:
        """Where the result's files are, or will be."""
        return self._files()[0]

    @property
    def result(self) -> Optional[Dict[str, Any]]:
        """result.json; None while there is none."""
        return cast("Optional[Dict[str, Any]]", _batch.result(self._batch.directory, self.key))

    @property
    def report(self) -> Optional[Dict[str, Any]]:
        """report.json; None where the plan has none."""
        file = self.directory / "report.json"
        return cast("Dict[str, Any]", json.loads(file.read_text())) if file.exists() else None

    @property
    def program(self) -> Optional[Program]:
        """The program; None where the plan did not pass or the batch keeps none."""
        for name in ("program.json", "program.json.gz"):
            if (self.directory / name).exists():
                return cast("Program", _hotblade.Program.load(self.directory / name))
        return None

    @property
    def settings(self) -> Settings:
        return cast("Settings", _hotblade.Settings.load(self._files()[2]))

    @property
    def design(self) -> Design:
        """The panel as it is planned."""
        file = self._files()[1]
        design = read(file, settings=self.settings)
        if design.sha256 != self._batch._hashes(self)[0]:
            raise InputError(f"{file}: not the design of its name any more", str(file))
        return design


class Batch(Sequence[Job]):
    """The jobs of a directory that `hotblade batch init` made, in their order."""

    def __init__(self, directory: Union[str, "os.PathLike[str]"]) -> None:
        self.directory = pathlib.Path(_batch.path(directory))
        facts, keys, jobs = _batch.open(self.directory)
        self.facts: Dict[str, Any] = facts
        self.keys: Tuple[str, ...] = tuple(keys)
        self._jobs = [Job(self, number, panel, key, chunk, dict(zip(keys, values)))
                      for number, panel, key, chunk, values in jobs]
        self._planned: Dict[int, Dict[str, Tuple[str, str]]] = {}

    def __repr__(self) -> str:
        return f"<hotblade.Batch {self.directory}: {len(self)} jobs>"

    def _hashes(self, job: Job) -> Tuple[str, str]:
        """Of the job's design and settings."""
        if job.chunk not in self._planned:
            self._planned[job.chunk] = _batch.planned(self.directory, job.chunk)
        return self._planned[job.chunk][job.key]

    def __len__(self) -> int:
        return len(self._jobs)

    def __iter__(self) -> Iterator[Job]:
        return iter(self._jobs)

    def __getitem__(self, index: Any) -> Any:
        return self._jobs[index]

    def status(self) -> Dict[str, Any]:
        """What `hotblade batch status --json` prints."""
        return cast("Dict[str, Any]", _batch.status(self.directory))

    def table(self, partial: bool = False, progress: Optional[Callable[[str, float], object]] = None) -> Dict[str, Any]:
        """The columns of results.csv by name, read from the results: arrays of numbers, lists of texts.

        A job without a result is a FileError, unless `partial`: its verdict is then "failed" or "missing". What a
        plan has no number for is nan; settings that change from job to job are texts, as they were given.
        """
        import numpy as np
        names, rows = _batch.table(self.directory, partial, progress)
        columns: Dict[str, Any] = {"job": np.array([job.number for job in self]), "panel": [job.panel for job in self],
                                   "key": [job.key for job in self]}
        columns.update((key, [job.values[key] for job in self]) for key in self.keys)
        for name, values in zip(names, zip(*rows) if rows else ((),) * len(names)):
            columns[name] = list(values) if name in TEXTS else np.array([math.nan if v == "" else v for v in values], float)
        return columns
