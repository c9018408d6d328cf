"""The least gain: its bound proven on matrices, never exceeded on moving pairs, where it is inf."""

import math

import numpy as np
import pytest

import standoff as so
from draws import draws
from standoff import control
from standoff_studies.paper.bodies import planar_body
from standoff_studies.paper.control.lag import measured_lag, measured_lags, random_case

POINT = so.shapes.point()
BALL = so.shapes.ellipsoid(0.5, 0.5, 0.5)
EGG = so.shapes.ellipsoid(1.0, 0.7, 0.5)
BOX = so.shapes.box(1.0, 1.0, 1.0)


def turned(angle: float, low: float, high: float) -> np.ndarray:
    c, s = math.cos(angle), math.sin(angle)
    turn = np.array([[c, -s], [s, c]])
    return turn @ np.diag([low, high]) @ turn.T


def random_optimum(random: np.random.Generator):
    """(kA, kB, d, v, spin, H, g_t) of a whitened pair at an optimum, curvatures above the least."""
    k_a, k_b, d = np.exp(random.uniform(-3, 3, 3))
    v, spin = np.exp(random.uniform(-2, 2, 2)) * [random.integers(0, 2), random.integers(0, 2)]
    shapes = [k + np.exp(random.uniform(-6, 6, 2)) for k in (k_a, k_b)]
    first, second = (turned(random.uniform(0, np.pi), *shape) for shape in shapes)
    twist = turned(random.uniform(0, np.pi), 1.0, 1.0)  # how the two frames of tangents stand
    H = np.block([[np.eye(2) + d * first, -twist], [-twist.T, np.eye(2) + d * second]])
    angles = random.uniform(0, 2 * np.pi, 2)
    slide, turn = (np.array([math.cos(x), math.sin(x)]) for x in angles)
    b_a = v * slide
    b_b = twist.T @ (b_a + d * spin * turn)
    return k_a, k_b, d, v, spin, H, np.concatenate([b_a, -b_b])


def test_witness_speeds_bound_every_optimum() -> None:
    """docs/laws.md: |w_ff| of each body below its bound, and the bound is nearly attained."""
    random, parts = np.random.default_rng(3), []
    for _ in range(draws(800)):
        k_a, k_b, d, v, spin, H, g_t = random_optimum(random)
        if v == spin == 0.0:
            continue
        w = np.linalg.solve(H, -g_t)
        bounds = control.witness_speeds(k_a, k_b, (d, d), v, spin)
        parts += [np.linalg.norm(w[:2]) / bounds[0], np.linalg.norm(w[2:]) / bounds[1]]
    assert max(parts) <= 1.0 + 1e-9
    assert max(parts) >= 0.95


def test_least_eigenvalue_bounds_every_optimum() -> None:
    """DESIGN 2.1's H at an optimum; the worst case is attained by equal principal directions."""
    random = np.random.default_rng(4)
    for _ in range(draws(600)):
        k_a, k_b, d, _, _, H, _ = random_optimum(random)
        least = control.least_eigenvalue(k_a, k_b, d)
        assert np.linalg.eigvalsh(H)[0] >= least * (1 - 1e-9) - 1e-12
        H = np.array([[1 + d * k_a, -1.0], [-1.0, 1 + d * k_b]])
        assert np.linalg.eigvalsh(H)[0] == pytest.approx(least, rel=1e-6, abs=1e-12)
    assert control.least_eigenvalue(math.inf, 2.0, 0.25) == 1.5
    assert control.least_eigenvalue(1.0, 2.0, 0.0) == 0.0


def test_greatest_over_a_range_of_distances() -> None:
    """Against the docstring's own formula on a fine grid."""
    random = np.random.default_rng(5)
    for _ in range(draws(30)):
        k_a, k_b, v, spin = np.exp(random.uniform(-2, 2, 4))
        low = math.exp(random.uniform(-3, 1))
        high = low * random.uniform(1.0, 30.0)
        d = np.geomspace(low, high, 2000)
        s = k_a + k_b + d * k_a * k_b
        square = d * spin**2 + k_b * v**2 + k_a * (v + d * spin) ** 2
        greatest = math.sqrt(max((1 + d * k_b) * square / (d * s**2)))
        found = control.witness_speeds(k_a, k_b, (low, high), v, spin)[0]
        assert greatest <= found * (1 + 1e-12)
        assert greatest >= 0.9999 * found
        endless = control.witness_speeds(k_a, k_b, (low, math.inf), v, spin)[0]
        far = control.witness_speeds(k_a, k_b, (low, 1e7), v, spin)[0]
        assert endless == pytest.approx(far, rel=1e-4)


def test_moving_pairs_never_exceed_the_bound() -> None:
    """The tracker itself with `so.min_gain`'s gain: random pairs as in the figure."""
    count = draws(160)
    lags = measured_lags(count, seed=11)
    assert len(lags) >= 0.75 * count
    worst = max(lag.part for lag in lags)
    assert worst <= 1.0
    assert worst >= 0.8


@pytest.mark.parametrize(
    ("kind", "seed"),
    [("box - ellipsoid", 254), ("ellipsoid - capsule", 434), ("box - ellipsoid", 522)],
)
def test_a_feature_left_late_needs_its_allowance(
    kind: str, seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Pairs that leave a vertex or an edge: past the bound of the mode alone, within the whole."""
    case = random_case(kind, np.random.default_rng(seed))
    whole = measured_lag(case)
    monkeypatch.setattr("standoff.control.gain._switches", lambda body: False)
    alone = measured_lag(case)
    assert alone.part > 1.1
    assert whole is None or whole.part < 1.0


def test_a_point_beside_a_ball() -> None:
    """The bound is the law itself: v / ((1 + d/r) K)."""
    gain = so.min_gain(BALL, POINT, 1e-3, 2.0, distance=0.25)
    assert gain == pytest.approx(2.0 / 1.5 / 1e-3, rel=1e-12)


def test_where_no_gain_is_enough() -> None:
    assert so.min_gain(BOX, BOX, 1e-3, 1.0, distance=0.5) == math.inf
    assert so.min_gain(EGG, BALL, 1e-3, 1.0, distance=0.0) == math.inf
    assert control.witness_speeds(0.0, 0.0, (0.1, 1.0), 1.0) == (math.inf, math.inf)
    assert so.min_gain(POINT, POINT, 1e-3, 1.0, 1.0, distance=0.0) == 0.0
    assert math.isfinite(so.min_gain(BOX, BALL, 1e-3, 1.0, 1.0, distance=(0.1, 2.0)))
    assert math.isfinite(so.min_gain(BALL, BOX, 1e-3, 1.0, 1.0, distance=(0.1, 2.0)))


def test_it_falls_with_the_error_and_rises_with_the_motion() -> None:
    gain = so.min_gain(EGG, BALL, 1e-3, 1.0, 0.5, distance=0.3)
    assert so.min_gain(EGG, BALL, 2e-3, 1.0, 0.5, distance=0.3) == pytest.approx(0.5 * gain)
    assert so.min_gain(EGG, BALL, 1e-3, 2.0, 1.0, distance=0.3) == pytest.approx(2.0 * gain)
    assert so.min_gain(EGG, BALL, 1e-3, 1.0, 0.5, distance=0.2) > gain


def test_the_skin_of_a_swept_body_adds_to_the_distance() -> None:
    thick = so.min_gain(so.shapes.sphere(0.2), EGG, 1e-3, 1.0, distance=0.3)
    thin = so.min_gain(POINT, EGG, 1e-3, 1.0, distance=0.5)
    assert thick == pytest.approx(thin, rel=1e-12)


@pytest.mark.parametrize(
    ("numbers", "message"),
    [
        ({"error": 0.0}, "error = 0.0: must be positive"),
        ({"speed": -1.0}, "speed = -1.0: must be zero or positive"),
        ({"spin": math.nan}, "spin = nan"),
        ({"distance": -0.1}, "distance = -0.1"),
        ({"distance": (0.5, 0.2)}, "give \\(least, most\\)"),
    ],
)
def test_bad_numbers(numbers: dict, message: str) -> None:
    good = {"error": 1e-3, "speed": 1.0, "spin": 0.0, "distance": 0.3}
    with pytest.raises(ValueError, match=message):
        so.min_gain(EGG, BALL, **(good | numbers))


def test_bad_bodies() -> None:
    with pytest.raises(TypeError, match="is not a Body"):
        so.min_gain(EGG, "ball", 1e-3, 1.0, distance=0.3)
    with pytest.raises(ValueError, match="planar"):
        so.min_gain(EGG, planar_body(), 1e-3, 1.0, distance=0.3)
    with pytest.raises(ValueError, match="least curvature of -1"):
        control.witness_speeds(-1.0, 1.0, (0.1, 1.0), 1.0)
