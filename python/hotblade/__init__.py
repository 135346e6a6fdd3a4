"""Plan, verify and look at hot-blade cuts: docs/python.md."""
from collections.abc import Mapping as _Mapping

from . import curve
from ._hotblade import PHASES, Cell, Check, Design, Plan, Program, Rib, Settings, Strip, __version__
from .batch import Batch, Job
from .calls import from_arrays as _from_arrays
from .calls import plan, read, verify
from .errors import ControllerError, Error, FileError, InputError, NotCuttable, OverTolerance, UsageError

__all__ = ["PHASES", "Batch", "Cell", "Check", "ControllerError", "Design", "Error", "FileError", "InputError", "Job",
           "NotCuttable", "OverTolerance", "Plan", "Program", "Rib", "Settings", "Strip", "UsageError", "curve", "plan", "read", "verify",
           "__version__"]

Design.from_arrays = staticmethod(_from_arrays)
# What a mapping has beside its items.
for _name in ("__contains__", "__eq__", "get", "items", "keys", "values"):
    setattr(Settings, _name, getattr(_Mapping, _name))
_Mapping.register(Settings)
# Equal to every mapping of the same items, of which some have a hash and some have none.
Settings.__hash__ = None
