"""Curve tools on arrays: what `hotblade curve` does, to the bit (docs/python.md).

A cubic Bezier is an array (4, 2) of its control points; an elastica one of 7 numbers, x, y, theta, kappa, lambda1, lambda2
and length; lengths are in any unit, angles in rad.
"""
from __future__ import annotations

from typing import TYPE_CHECKING, List, NamedTuple, Optional, Tuple

from ._hotblade import curve as _curve  # type: ignore

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

    Numbers = NDArray[np.float64]

# The words for the statuses of residuals().
STATUSES = ("ok", "straight", "cusp", "not_finite")


class Residual(NamedTuple):
    """How far a Bezier's curvature is from being affine in position, 0 to 1; nan where it has none (a cusp)."""
    value: float
    lambda1: float
    lambda2: float
    alpha: float
    bound: float
    status: str


class Residuals(NamedTuple):
    """The same of many; `status` counts in STATUSES."""
    value: Numbers
    bound: Numbers
    status: NDArray[np.uint8]


class Fit(NamedTuple):
    """An elastica near a curve. l2 and h1 are relative to its length; nan where points have no tangents."""
    elastica: Numbers
    l2: float
    h1: float
    hausdorff: float
    hausdorff_error: float
    starts_tried: int
    status: str


class Projection(NamedTuple):
    """A Bezier moved towards an elastica; `moved` are its end edges' changes in chords."""
    bezier: Numbers
    lambda_residual: float
    branch: str
    moved: Tuple[float, float]
    angle_constraints_hold: bool
    status: str


class Samples(NamedTuple):
    """Points (n, 2) of an elastica with their tangents' angles and curvatures."""
    points: Numbers
    theta: Numbers
    kappa: Numbers


class Equilibrium(NamedTuple):
    elastica: Numbers
    energy: float
    stable: bool
    margin: float
    inflections: int


class Equilibria(NamedTuple):
    """The shapes of a blade between two clamps, the lowest energy first."""
    shapes: List[Equilibrium]
    unresolved: int
    taut: int


class Arcs(NamedTuple):
    """Circular arcs (k, 5): x, y, theta, kappa, length of each."""
    arcs: Numbers
    error_bound: float
    length: float


def residual(bezier: ArrayLike) -> Residual:
    """The lambda-residual of a Bezier (4, 2)."""
    return Residual(*_curve.residual(bezier))


def residuals(beziers: ArrayLike) -> Residuals:
    """The lambda-residuals of many Beziers (n, 4, 2) at once; of 0 where the status is not ok."""
    return Residuals(*_curve.residuals(beziers))


def fit(curve: ArrayLike, ends: str = "free", tangents: Optional[ArrayLike] = None) -> Fit:
    """The elastica nearest to a Bezier (4, 2) or to points (n, 2), n >= 8.

    ends="clamped" keeps end points and end tangents; of points these are the angles `tangents`.
    """
    return Fit(*_curve.fit(curve, ends, tangents))


def project(bezier: ArrayLike, method: str = "feedback", branch: str = "best", threshold: float = 0) -> Projection:
    """A Bezier moved towards an elastica, ends and end tangents kept.

    method: feedback, optimal or zone; branch of the optimum: inflectional, plain or best. Feedback stops at the
    threshold, and the optimal projection moves no farther than to it (0: to the least).
    """
    return Projection(*_curve.project(bezier, method, branch, threshold))


def sample(elastica: ArrayLike, n: int) -> Samples:
    """n >= 2 points of an elastica (7,), evenly spaced, both ends included."""
    return Samples(*_curve.sample(elastica, n))


def equilibria(a: ArrayLike, b: ArrayLike, length: float, max_inflections: Optional[int] = None,
               max_energy: Optional[float] = None) -> Equilibria:
    """Every shape that a blade of this length can take between clamps a and b, each x, y, theta.

    Without limits, the shapes of at most two inflections: all stable ones are among them.
    """
    shapes, unresolved, taut = _curve.equilibria(a, b, length, max_inflections, max_energy)
    return Equilibria([Equilibrium(*shape) for shape in shapes], unresolved, taut)


def arcs(curve: ArrayLike, tolerance: float, order: str = "biarc") -> Arcs:
    """An elastica (7,) or points (n, 2) as circular arcs of the same length; order: biarc or triarc."""
    return Arcs(*_curve.arcs(curve, tolerance, order))
