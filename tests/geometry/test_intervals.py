"""Interval arithmetic holds what it must: python-flint's ball arithmetic is the oracle."""

import numpy as np
import pytest
from flint import arb, ctx

from standoff.geometry import intervals as I
from standoff.geometry.intervals import FUNCTIONS, Interval, interval

TRIALS = 300


@pytest.fixture(autouse=True)
def _twice_the_digits_of_float64():
    before, ctx.prec = ctx.prec, 106
    yield
    ctx.prec = before


ORACLES = {
    "sin": (arb.sin, (-9, 9)),
    "cos": (arb.cos, (-9, 9)),
    "tan": (arb.tan, (-9, 9)),
    "asin": (arb.asin, (-1.3, 1.3)),
    "acos": (arb.acos, (-1.3, 1.3)),
    "atan": (arb.atan, (-9, 9)),
    "sinh": (arb.sinh, (-9, 9)),
    "cosh": (arb.cosh, (-9, 9)),
    "tanh": (arb.tanh, (-3, 3)),
    "exp": (arb.exp, (-9, 9)),
    "log": (arb.log, (-1, 9)),
    "sqrt": (arb.sqrt, (-1, 9)),
}
OPERATIONS = {
    "add": (lambda a, b: a + b),
    "sub": (lambda a, b: a - b),
    "mul": (lambda a, b: a * b),
    "div": (lambda a, b: a / b),
}


def drawn(rng, low, high, shape=(TRIALS,)):
    """Intervals of all widths, from a single number to the whole range."""
    ends = rng.uniform(low, high, (2, *shape))
    width = rng.choice([0.0, 1e-15, 1e-6, 1e-2, 1.0], shape)
    ends[1] = ends[0] + width * (ends[1] - ends[0])
    return Interval(ends.min(axis=0), ends.max(axis=0))


def inside(rng, a):
    """The ends and three places between them, for each interval."""
    share = np.array([0.0, 1.0, *rng.uniform(size=3)])[:, None]
    return np.clip(a.lo + share * (a.hi - a.lo), a.lo, a.hi)


def assert_holds(result, k, exact):
    """Interval k holds the ball `exact`."""
    low, high = arb(float(result.lo[k])), arb(float(result.hi[k]))
    # the ball is 2^-90 wide at most, so its middle stands for it
    assert low <= exact.mid() <= high


@pytest.mark.parametrize("name", ORACLES)
def test_functions_hold_their_values_and_no_more_than_needed(name):
    exact, (low, high) = ORACLES[name]
    rng = np.random.default_rng(11)
    a = drawn(rng, low, high)
    with np.errstate(all="ignore"):
        result = FUNCTIONS[name](a)
    known = 0
    for k in range(TRIALS):
        if not result.known[k]:
            values = [exact(arb(float(x))) for x in np.linspace(a.lo[k], a.hi[k], 50)]
            defined = all(v.is_finite() for v in values)
            assert not defined or name == "tan"
            continue
        known += 1
        places = np.linspace(a.lo[k], a.hi[k], 50)
        values = [exact(arb(float(x))) for x in [*inside(rng, a)[:, k], *places]]
        for value in values:
            assert_holds(result, k, value)
        floats = [float(v.mid()) for v in values]
        spare = 1e-13 * (1 + np.abs(floats).max()) + 2e-3 * (a.hi[k] - a.lo[k]) * (
            1 + np.abs(floats).max()
        )
        assert result.lo[k] >= min(floats) - spare
        assert result.hi[k] <= max(floats) + spare
    assert known >= TRIALS / 3


@pytest.mark.parametrize("name", OPERATIONS)
def test_arithmetic_holds_its_values(name):
    operation = OPERATIONS[name]
    rng = np.random.default_rng(12)
    a, b = drawn(rng, -3, 3), drawn(rng, -3, 3)
    with np.errstate(all="ignore"):
        result = operation(a, b)
    in_a, in_b = inside(rng, a), inside(rng, b)
    for k in range(TRIALS):
        if name == "div" and b.lo[k] <= 0 <= b.hi[k]:
            assert not result.known[k]
            continue
        for x in in_a[:, k]:
            for y in in_b[:, k]:
                assert_holds(result, k, operation(arb(float(x)), arb(float(y))))


def test_operations_with_numbers():
    a = Interval(np.array([1.0]), np.array([2.0]))
    for result, low, high in (
        (3.0 - a, 1, 2),
        (a - 3.0, -2, -1),
        (2.0 / a, 1, 2),
        (a / 2.0, 0.5, 1),
        (-1.0 * a, -2, -1),
        (1.0 + a, 2, 3),
    ):
        assert result.lo[0] <= low
        assert result.hi[0] >= high
        np.testing.assert_allclose([result.lo[0], result.hi[0]], [low, high], rtol=1e-15)


@pytest.mark.parametrize("exponent", [1, 2, 3, 4, 7, -1, -2])
def test_whole_powers(exponent):
    rng = np.random.default_rng(13)
    a = drawn(rng, -2, 2)
    with np.errstate(all="ignore"):
        result = a**exponent
    for k in range(TRIALS):
        if exponent < 0 and a.lo[k] <= 0 <= a.hi[k]:
            assert not result.known[k]
            continue
        for x in inside(rng, a)[:, k]:
            value = arb(1)
            for _ in range(abs(exponent)):
                value = value * arb(float(x))
            assert_holds(result, k, 1 / value if exponent < 0 else value)
    even = (Interval(np.array([-1.0]), np.array([2.0])) ** 2).lo[0]
    assert even == 0.0


def test_powers_of_real_exponents():
    rng = np.random.default_rng(14)
    a, e = drawn(rng, -0.2, 3), drawn(rng, -2, 2)
    with np.errstate(all="ignore"):
        result = I.power(a, e)
    for k in range(TRIALS):
        if a.lo[k] < 0.0:
            assert not result.known[k]
            continue
        for x in inside(rng, a)[:, k]:
            for y in inside(rng, e)[:, k]:
                assert_holds(result, k, (arb(float(y)) * arb(float(x)).log()).exp())
    root = I.power(Interval(np.array([0.0]), np.array([4.0])), interval(0.5))
    assert root.lo[0] == 0.0
    np.testing.assert_allclose(root.hi[0], 2.0, rtol=1e-14)


def test_angles_of_points():
    rng = np.random.default_rng(15)
    y, x = drawn(rng, -2, 2), drawn(rng, -2, 2)
    with np.errstate(all="ignore"):
        result = I.atan2(y, x)
    for k in range(TRIALS):
        if x.lo[k] <= 0.0 and y.lo[k] <= 0.0 <= y.hi[k]:
            assert not result.known[k]
            continue
        for p in inside(rng, y)[:, k]:
            for q in inside(rng, x)[:, k]:
                assert_holds(result, k, arb.atan2(arb(float(p)), arb(float(q))))


def test_constants_that_float64_cannot_hold():
    third = I.near(1 / 3)
    assert arb(float(third.lo)) < arb(1) / 3 < arb(float(third.hi))
    pi = I.near(np.pi)
    assert arb(float(pi.lo)) < arb.pi() < arb(float(pi.hi))


def test_what_is_unknown_stays_unknown():
    lost = Interval(np.array([np.nan]), np.array([np.nan]))
    one = Interval(np.array([1.0]), np.array([1.0]))
    with np.errstate(all="ignore"):
        for name in ORACLES:
            assert not FUNCTIONS[name](lost).known[0], name
        for function in (I.power, I.atan2):
            assert not function(lost, one).known[0]
            assert not function(one, lost).known[0]
        for operation in OPERATIONS.values():
            assert not operation(lost, one).known[0]
            assert not operation(one, lost).known[0]
        assert not (lost**2).known[0]
        assert not I.sin(Interval(np.array([-np.inf]), np.array([np.inf]))).magnitude[0] > 1.0
