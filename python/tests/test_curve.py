import json
import math
import timeit

import numpy as np
import pytest

import hotblade as hb
from hotblade import curve

random = np.random.default_rng(2)
ELASTICA = ("x", "y", "theta", "kappa", "lambda1", "lambda2", "length")


def cubics(count):
    """Random cubics, and some that are straight, cusped or closed."""
    some = random.uniform(-100, 100, (count, 4, 2))
    some[0] = [[0, 0], [1, 1], [2, 2], [3, 3]]
    some[1] = [[0, 0], [0, 0], [70, 40], [100, 0]]
    some[2] = [[0, 0], [30, 40], [70, 40], [0, 0]]
    return some


def elasticae(count):
    return [[*random.uniform(-10, 10, 2), random.uniform(-3, 3), random.uniform(-0.03, 0.03), *random.uniform(-4e-4, 4e-4, 2),
             random.uniform(20, 200)] for _ in range(count)]


def asked(program, tool, lines, *options, code=0):
    """What `hotblade curve TOOL` answers, a line each; numbers come back to the bit."""
    text = "".join(json.dumps(line) + "\n" for line in lines)
    return [json.loads(line) for line in program("curve", tool, *options, code=code, input=text).splitlines()]


def of_elastica(e):
    return dict(zip(ELASTICA, map(float, e)))


def or_none(number):
    return None if math.isnan(number) else number


def test_residuals_of_one_are_those_of_the_command(program):
    beziers = cubics(200)
    for b, said in zip(beziers, asked(program, "residual", [{"bezier": b.tolist()} for b in beziers])):
        r = curve.residual(b)
        assert [or_none(n) for n in r[:5]] == [said[k] for k in ("lambda_residual", "lambda1", "lambda2", "alpha", "bound")]
        assert r.status == said["status"]


def test_numbers_of_more_bits_are_rounded():
    bezier = np.array([[0, 0], [30, 40], [70, 40], [100, 0]])
    assert curve.residual(bezier.astype(np.longdouble)) == curve.residual(bezier.astype(float))


def test_residuals_of_many_are_those_of_one_within_their_bounds():
    beziers = cubics(5000)
    many = curve.residuals(beziers)
    for b, value, bound, status in zip(beziers, *many):
        one = curve.residual(b)
        assert curve.STATUSES[status] == one.status
        if status <= 1:
            assert abs(value - one.value) <= bound + one.bound
    # Splitting a batch changes no bit, nor does the layout of the argument.
    parts = [curve.residuals(part) for part in np.array_split(beziers, 7)]
    assert np.array_equal(many.value, np.concatenate([p.value for p in parts]))
    assert np.array_equal(many.value, curve.residuals(np.asfortranarray(beziers)).value)
    assert curve.residuals(np.empty((0, 4, 2))).value.shape == (0,)


@pytest.mark.parametrize("ends", ["free", "clamped"])
def test_fits_of_beziers_are_those_of_the_command(program, ends):
    beziers = [[[0, 0], [30, 40], [70, 40], [100, 0]], [[0, 0], [30, 10], [60, -20], [100, 0]], [[0, 0], [10, 30], [90, 60], [100, 0]]]
    for b, said in zip(beziers, asked(program, "fit", [{"bezier": b} for b in beziers], "--ends", ends)):
        f = curve.fit(b, ends)
        assert of_elastica(f.elastica) == said["elastica"]
        assert (f.l2, f.h1, f.hausdorff, f.hausdorff_error, f.starts_tried, f.status) == tuple(
            said[k] for k in ("l2", "h1", "hausdorff", "hausdorff_error", "starts_tried", "status"))


def test_fits_of_points_are_those_of_the_command(program):
    lists = [curve.sample(e, 40).points for e in elasticae(6)] + [random.uniform(-1, 1, (9, 2)).cumsum(axis=0)]
    for q, said in zip(lists, asked(program, "fit", [{"points": q.tolist()} for q in lists])):
        f = curve.fit(q)
        assert of_elastica(f.elastica) == said["elastica"] and f.l2 == said["l2"] and f.hausdorff == said["hausdorff"]
        assert math.isnan(f.h1) and said["h1"] is None
    ends = [(0.25, -0.5)] * len(lists)
    clamped = asked(program, "fit", [{"points": q.tolist(), "tangents": t} for q, t in zip(lists, ends)], "--ends", "clamped")
    for q, t, said in zip(lists, ends, clamped):
        f = curve.fit(q, ends="clamped", tangents=t)
        assert of_elastica(f.elastica) == said["elastica"] and f.status == said["status"]


@pytest.mark.parametrize("options", [{}, {"method": "optimal"}, {"method": "optimal", "branch": "plain"}, {"method": "zone"},
                                     {"method": "zone", "threshold": 0.4}, {"method": "optimal", "threshold": 0.2},
                                     {"threshold": 0.1}])
def test_projections_are_those_of_the_command(program, options):
    beziers = [[[0, 0], [30, 40], [70, 40], [100, 0]], [[0, 0], [10, 60], [70, -40], [100, 0]]]
    words = [word for key, value in options.items() for word in ("--" + key, value)]
    for b, said in zip(beziers, asked(program, "project", [{"bezier": b} for b in beziers], *words)):
        p = curve.project(b, **options)
        assert p.bezier.tolist() == said["bezier"] and list(p.moved) == said["moved"]
        assert (p.lambda_residual, p.branch, p.angle_constraints_hold, p.status) == tuple(
            said[k] for k in ("lambda_residual", "branch", "angle_constraints_hold", "status"))


def test_samples_are_those_of_the_command(program):
    some = elasticae(20)
    for e, said in zip(some, asked(program, "sample", [{"elastica": of_elastica(e), "n": 17} for e in some])):
        s = curve.sample(e, 17)
        assert s.points.tolist() == said["points"]
        assert s.theta.tolist() == said["theta"] and s.kappa.tolist() == said["kappa"]


def test_samples_are_views_of_one_memory_that_they_keep():
    s = curve.sample(elasticae(1)[0], 1000)
    assert s.points.base is not None and s.points.base is s.theta.base
    assert s.theta.strides == (32,) and not s.points.flags.writeable
    theta, before = s.theta, s.theta.copy()
    del s
    curve.sample(elasticae(1)[0], 1000)
    assert np.array_equal(theta, before)


def test_equilibria_are_those_of_the_command(program):
    clamps = [([0, 0, 0.5], [100, 0, -0.5], 110, {}), ([0, 0, 1.2], [60, 10, -2], 150, {}),
              ([0, 0, 0.5], [100, 0, -0.5], 110, {"max_energy": 2}), ([0, 0, 0.5], [100, 0, -0.5], 110, {"max_inflections": 0})]
    said = asked(program, "equilibria", [{"a": a, "b": b, "length": length, **more} for a, b, length, more in clamps])
    for (a, b, length, more), answer in zip(clamps, said):
        found = curve.equilibria(a, b, length, **more)
        assert (found.unresolved, found.taut) == (answer["unresolved"], answer["taut"])
        assert len(found.shapes) == len(answer["equilibria"])
        for shape, of_answer in zip(found.shapes, answer["equilibria"]):
            assert of_elastica(shape.elastica) == of_answer["elastica"]
            assert (shape.energy, shape.stable, shape.margin, shape.inflections) == tuple(
                of_answer[k] for k in ("energy", "stable", "margin", "inflections"))


@pytest.mark.parametrize("order", ["biarc", "triarc"])
def test_arcs_are_those_of_the_command(program, order):
    some = elasticae(5)
    lines = [{"elastica": of_elastica(e)} for e in some] + [{"points": curve.sample(some[0], 30).points.tolist()}]
    given = some + [curve.sample(some[0], 30).points]
    for c, said in zip(given, asked(program, "arcs", lines, "--tolerance", "0.01", "--order", order)):
        found = curve.arcs(c, 0.01, order)
        assert found.arcs.tolist() == [[*a["start"], a["theta"], a["kappa"], a["length"]] for a in said["arcs"]]
        assert (found.error_bound, found.length) == (said["error_bound"], said["length"])


@pytest.mark.parametrize("call, kind, said", [
    (lambda: curve.residual(np.zeros((3, 2))), hb.UsageError, r"bezier: shape \(3, 2\) \(\(4, 2\) needed\)"),
    (lambda: curve.residual([[0, 0], [1, 1], [2, 0], [math.inf, 0]]), hb.UsageError, "bezier: out of range"),
    (lambda: curve.residuals(np.zeros((4, 2))), hb.UsageError, r"beziers: shape \(4, 2\) \(\(n, 4, 2\) needed\)"),
    (lambda: curve.residuals("abc"), hb.UsageError, "beziers: dtype"),
    (lambda: curve.fit(np.zeros((5, 2))), hb.UsageError, "curve: 5 points"),
    (lambda: curve.fit(np.zeros((9, 2))), hb.InputError, "curve: its points are all the same"),
    (lambda: curve.fit([[0, 0], [0, 0], [1, 1], [2, 0]]), hb.InputError, "cusp"),
    (lambda: curve.fit(np.random.rand(9, 2), "clamped"), hb.UsageError, "tangents"),
    (lambda: curve.fit(np.random.rand(9, 2), "tight"), hb.UsageError, 'ends \\("tight", must be one of free, clamped'),
    (lambda: curve.project(np.zeros((4, 2)), method="optimal"), hb.InputError, "its ends coincide"),
    (lambda: curve.project(np.zeros((4, 2)), threshold=2), hb.UsageError, "threshold: out of range"),
    (lambda: curve.sample([0] * 7, 5), hb.UsageError, "elastica: its length"),
    (lambda: curve.sample([0] * 6 + [1], 1), hb.UsageError, "n: out of range"),
    (lambda: curve.sample([0] * 6 + [1], 10**12), hb.UsageError, "n: out of range"),
    (lambda: curve.sample([0, 0, 0, 1e8, 0, 0, 1e8], 5), hb.InputError, ""),
    (lambda: curve.equilibria([0, 0, 0], [1, 0], 2), hb.UsageError, r"b: shape \(2,\)"),
    (lambda: curve.equilibria([0, 0, 0], [1, 0, 0], -2), hb.UsageError, "length: out of range"),
    (lambda: curve.equilibria([0, 0, 0], [1, 0, 200], 2), hb.UsageError, "turning"),
    (lambda: curve.arcs(np.zeros((3, 2)), 0.1), hb.UsageError, "curve: 3 points .at least 4 needed"),
    (lambda: curve.arcs(np.zeros((4, 2)), 0.1), hb.InputError, "curve: .* neighbours distinct"),
    (lambda: curve.arcs([0] * 6 + [1], 0), hb.UsageError, "tolerance: out of range"),
])
def test_what_is_wrong_is_told_by_its_name(call, kind, said):
    with pytest.raises(kind, match=said):
        call()


def test_a_call_is_short():
    # 5 us are promised (docs/python.md); a machine that others use may take some times as long.
    bezier = np.array([[0, 0], [30, 40], [70, 40], [100, 0.0]])
    assert min(timeit.repeat(lambda: curve.residual(bezier), number=1000, repeat=5)) / 1000 < 25e-6
