"""The program's numbers, worked out again without hotblade: curves by Runge-Kutta, frames, poses."""
import json
import math
import pathlib
import sys

STEPS_PER_PIECE = 40  # of Runge-Kutta; a step of a tenth of a mm leaves errors far below a nanometre


def load(directory):
    return json.loads((pathlib.Path(directory) / "job" / "program.json").read_text())


def slope(e, state):
    x, y, theta = state
    curvature = e["kappa"] - e["lambda1"] * (y - e["y"]) + e["lambda2"] * (x - e["x"])
    return (math.cos(theta), math.sin(theta), curvature)


def curve_points(e, pieces):
    """The elastica at pieces + 1 places, evenly spaced by arc length: (x, y, theta)."""
    state = (e["x"], e["y"], e["theta"])
    points = [state]
    h = e["length"] / (pieces * STEPS_PER_PIECE)
    for _ in range(pieces):
        for _ in range(STEPS_PER_PIECE):
            k1 = slope(e, state)
            k2 = slope(e, [s + h / 2 * k for s, k in zip(state, k1)])
            k3 = slope(e, [s + h / 2 * k for s, k in zip(state, k2)])
            k4 = slope(e, [s + h * k for s, k in zip(state, k3)])
            state = tuple(s + h / 6 * (a + 2 * b + 2 * c + d) for s, a, b, c, d in zip(state, k1, k2, k3, k4))
        points.append(state)
    return points


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def in_design(frame, x, y):
    return [o + x * a + y * b for o, a, b in zip(frame["origin"], frame["x"], frame["y"])]


def turned(q, v):
    """A vector turned by the unit quaternion (w, x, y, z)."""
    u = q[1:]
    t = [2 * c for c in cross(u, v)]
    return [a + q[0] * b + c for a, b, c in zip(v, t, cross(u, t))]


def product(p, q):
    w = p[0] * q[0] - sum(a * b for a, b in zip(p[1:], q[1:]))
    v = [p[0] * b + q[0] * a + c for a, b, c in zip(p[1:], q[1:], cross(p[1:], q[1:]))]
    return [w] + v


def in_cell(strip, pose):
    """A clamp's pose on the table: position and quaternion."""
    to = strip["design_to_cell"]
    return [a + b for a, b in zip(turned(to["q"], pose["p"]), to["p"])], product(to["q"], pose["q"])


def expect(condition, claim):
    if not condition:
        sys.exit("failed: " + claim)


def expect_near(got, wanted, tolerance, claim):
    worst = max(abs(a - b) for a, b in zip(got, wanted, strict=True))
    expect(worst <= tolerance, f"{claim}: off by {worst} (limit {tolerance})")


def main(checks):
    if len(sys.argv) != 3 or sys.argv[1] not in checks:
        sys.exit(f"usage: {sys.argv[0]} {'|'.join(checks)} DIR")
    checks[sys.argv[1]](pathlib.Path(sys.argv[2]))
