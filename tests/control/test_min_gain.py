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
FINE = "heun", 1e-9  # no gain is too large


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
    for pair in ((BOX, BALL), (BALL, BOX)):
        assert math.isfinite(so.min_gain(*pair, 1e-3, 1.0, 1.0, distance=(0.1, 2.0), step=FINE))


def test_it_falls_with_the_error_and_rises_with_the_motion() -> None:
    gain = so.min_gain(EGG, BALL, 1e-3, 1.0, 0.5, distance=0.3, step=FINE)
    assert so.min_gain(EGG, BALL, 2e-3, 1.0, 0.5, distance=0.3, step=FINE) == pytest.approx(
        0.5 * gain
    )
    assert so.min_gain(EGG, BALL, 1e-3, 2.0, 1.0, distance=0.3, step=FINE) == pytest.approx(
        2.0 * gain
    )
    assert so.min_gain(EGG, BALL, 1e-3, 1.0, 0.5, distance=0.2, step=FINE) > gain


def test_the_skin_of_a_swept_body_adds_to_the_distance() -> None:
    thick = so.min_gain(so.shapes.sphere(0.2), EGG, 1e-3, 1.0, distance=0.3)
    thin = so.min_gain(POINT, EGG, 1e-3, 1.0, distance=0.5)
    assert thick == pytest.approx(thin, rel=1e-12)


def after(integrator: str, gain: float, start: float, lag: float, steps: int, dt: float) -> float:
    """The error after some steps of q' = -K (q - w t), by the method as a textbook has it."""
    q, t = start, 0.0

    def rate(t: float, q: float) -> float:
        return -gain * (q - lag * t)

    for _ in range(steps):
        k1 = rate(t, q)
        half = rate(t + 0.5 * dt, q + 0.5 * dt * k1)
        if integrator == "euler":
            slope = k1
        elif integrator == "heun":
            slope = 0.5 * (k1 + rate(t + dt, q + dt * k1))
        elif integrator == "midpoint":
            slope = half
        else:
            again = rate(t + 0.5 * dt, q + 0.5 * dt * half)
            slope = (k1 + 2.0 * half + 2.0 * again + rate(t + dt, q + dt * again)) / 6.0
        q, t = q + dt * slope, t + dt
    return abs(q - lag * t)


@pytest.mark.parametrize("integrator", ["euler", "heun", "midpoint", "rk4"])
def test_a_start_is_below_the_error_in_time(integrator: str, rng: np.random.Generator) -> None:
    """A ball and a point, whose lag is v / (1 + d/r): just enough, and not with 2 % less."""
    for _ in range(draws(40)):
        dt, start, speed = 1e-3, 10.0 ** rng.uniform(-2, 0), rng.uniform(0.0, 0.3)
        steps, error = int(rng.integers(8, 60)), start * 10.0 ** rng.uniform(-1.5, -0.5)
        numbers = {"distance": 0.25, "start": (start, steps * dt), "step": (integrator, dt)}
        try:
            gain = so.min_gain(BALL, POINT, error, speed, **numbers)
        except so.StandoffError:
            continue
        lag = speed / 1.5
        # the lag on the start's own side: the minimum runs away from it
        assert after(integrator, gain, start, -lag, steps, dt) <= error * (1.0 + 1e-9)
        for later in (1, 7, 100):
            assert after(integrator, gain, start, -lag, steps + later, dt) <= error * (1 + 1e-9)
        assert after(integrator, 0.98 * gain, start, -lag, steps, dt) > error


def test_what_outruns_every_stable_gain_is_told_with_a_step_that_would_do() -> None:
    """22,471 beside a limit of 2000 was given without a word."""
    given = {"error": 1e-4, "speed": 0.5, "spin": 0.2, "distance": 0.1}
    with pytest.raises(ValueError, match=r"end at 2000 \(so\.max_gain\)\. A step of") as told:
        so.min_gain(EGG, BALL, **given)
    short, gain, kept = (float(x.rstrip(".,;")) for x in numbers_of(str(told.value))[-3:])
    assert so.min_gain(EGG, BALL, **given, step=("heun", short)) == pytest.approx(gain, rel=1e-4)
    assert gain < so.max_gain("heun", short)
    assert so.min_gain(EGG, BALL, **(given | {"error": 1.01 * kept})) < 2000.0


def numbers_of(text: str) -> list[str]:
    return [x for x in text.split() if x[0].isdigit()]


@pytest.mark.parametrize(
    ("start", "message"),
    [
        (0.1, "Give start = \\(error, time\\), not 0.1"),
        ((0.0, 0.1), "start's error = 0.0: must be positive"),
        ((0.1, 0.0), "start's time = 0.0: must be positive"),
        ((0.1, 5e-4), "0.0005 is shorter than a step of 0.001: give at least that"),
        ((0.1, 0.1, 0.05), "beyond 0.05, up to which starts are known to settle"),
        ((0.1, 2e-3), "A step of 0.00025 would do"),
    ],
)
def test_bad_starts(start: object, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        so.min_gain(BALL, POINT, 1e-3, 0.1, distance=0.3, start=start)


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


def test_eulers_lag_is_bounded_up_to_one_step() -> None:
    """A minimum that turns with each step: e <- (1 - z) e -+ h w, which ends at h w / (2 - z)."""
    gain, dt, lag, error = 4000.0 / 3.0, 1e-3, 4.0 / 3.0, 0.0
    for _ in range(60):
        error = (1.0 - gain * dt) * error - math.copysign(dt * lag, (gain * dt - 1.0) * error)
    assert abs(error) > 1.9 * lag / gain
    with pytest.raises(ValueError, match="no gain is enough with euler"):
        so.min_gain(BALL, POINT, 1e-3, 2.0, distance=0.25, step=("euler", dt))
    assert so.min_gain(BALL, POINT, 1e-3, 2.0, distance=0.25) == pytest.approx(gain)
