"""Control theory: what its figures state, checked on their data; sources in the docstrings."""

import numpy as np
import pytest

import standoff as so
from standoff import control
from standoff.motion import Pose, Twist
from standoff_studies.paper.catalogue import chosen, make
from standoff_studies.paper.control.basins import LAWS, beside_a_point, of_two, place_of, weighted
from standoff_studies.paper.control.decay import arrival, decays, loops
from standoff_studies.paper.control.feedbacks import BIAS, DRIFT, FRAMES, GAIN, bodies, pose, run
from standoff_studies.paper.control.gains import lags
from standoff_studies.paper.control.levels import case, runs, watched
from standoff_studies.paper.control.lower import TRIED, cycle, settles
from standoff_studies.paper.control.roots import loci

LONGEST = ("basin", "lyapunov")
REFUTED = "the squared parameter errors show convergence where M is positive definite"
KEYS = ("gains", "lower", "stability", "feedback", "basin", "lyapunov")


@pytest.mark.parametrize(
    "key", [pytest.param(k, marks=[pytest.mark.soak] if k in LONGEST else []) for k in KEYS]
)
def test_every_statement_that_can_hold_does(key: str) -> None:
    (entry,) = chosen([key])
    artwork = make(entry)
    assert not [s.measured for s in artwork.statements if s.holds is False and s.stated != REFUTED]
    assert sum(s.stated == REFUTED for s in artwork.statements) == (key == "lyapunov")
    for columns in artwork.tables.values():
        assert len({len(column) for column in columns.values()}) == 1


@pytest.mark.parametrize("name", ["euler", "heun", "midpoint", "rk4"])
def test_decay_per_step_is_the_growth_factor(name: str) -> None:
    """Eqs. (12)-(14): Psi' = -K Psi; the tracker's own step, to eight digits, all stable K."""
    found = decays()[name]
    assert found.z.min() < 0.12
    assert found.z.max() > 0.95 * control.stability_limit(name)
    np.testing.assert_allclose(found.measured, found.predicted, atol=2e-8)


def test_pi_loop_has_the_predicted_roots() -> None:
    """Item 9: PI feedback; real roots above damping 1, complex ones below."""
    for loop in loops():
        np.testing.assert_allclose(loop.measured, loop.predicted, atol=2e-8)
    assert any(abs(loop.measured.imag).max() > 0.1 for loop in loops())
    assert any(abs(loop.measured.imag).max() < 1e-9 for loop in loops())


def test_finite_time_law_runs_its_equation() -> None:
    """Item 9: |Psi / r|^(1 - p) falls at K (1 - p)."""
    found = arrival()
    np.testing.assert_allclose(found.measured, found.predicted, atol=2e-8)
    assert abs(found.measured[-1]).max() < 0.75 * abs(found.measured[0]).max()


def test_lag_stays_within_the_promise_of_the_least_gain() -> None:
    """Item 9: so.min_gain from motion bounds, curvature and a tolerance; every kind of pair."""
    parts = {
        kind: max(x.part for x in lags() if x.kind == kind) for kind in {x.kind for x in lags()}
    }
    assert len(parts) == 6
    assert max(parts.values()) <= 1.0
    assert parts["ellipsoid - point"] > 0.9


@pytest.mark.parametrize("gain", TRIED[::3])
def test_starts_settle_up_to_the_cycle(gain: float) -> None:
    """tan x / x = 2 / (K h) by hand, for both methods; what is said before stays within it."""
    for integrator in ("heun", "euler"):
        found = settles(integrator, gain)
        assert found.inside
        assert not found.outside
        assert 0.8 * cycle(gain) <= found.told <= cycle(gain)


def test_loci_leave_the_circle_at_the_limits() -> None:
    """Item 9: root loci; the proportional loop's limit is so.max_gain's."""
    for locus in loci():
        if np.isinf(locus.damping):
            assert locus.limit == pytest.approx(so.max_gain(locus.integrator, 1.0), rel=1e-9)
        elif locus.damping == 0.25:
            assert locus.limit < so.max_gain(locus.integrator, 1.0)
    euler = {x.damping: x.limit for x in loci() if x.integrator == "euler"}
    # |1 + h s|² = 1 with s² + K s + K²/(4 zeta²) = 0: K h = 4 zeta²
    assert euler[0.25] == pytest.approx(0.25, rel=1e-9)
    assert euler[0.5] == pytest.approx(1.0, rel=1e-9)


def test_linear_law_keeps_bias_over_gain() -> None:
    """DESIGN 2.3: Psi_ss = b / K, here of the wrong part of the twist alone."""
    a, b = bodies()
    found = so.distance(a, b, Pose.identity(), pose(FRAMES))
    places = (found.feature_a, found.parameters_a), (found.feature_b, found.parameters_b)
    system = so.tracking.pair_system(
        a, b, Pose.identity(), pose(FRAMES), *places, None, Twist(BIAS, np.zeros(3))
    )
    lengths = [np.linalg.cholesky(t.T @ t) for t in (system.F, system.G)]
    b_a = np.linalg.solve(lengths[0], system.b[:2])
    b_b = np.linalg.solve(lengths[1], system.b[2:])
    expected = np.linalg.norm(np.concatenate([b_a, b_b])) / GAIN
    assert run("linear").steady == pytest.approx(expected, rel=0.02)


def test_what_each_feedback_is_good_for() -> None:
    """Item 9: PI removes a constant bias, finite time arrives first, a late cap chatters."""
    assert run("PI").steady < 1e-3 * run("linear").steady
    others = [run(name).fallen for name in ("linear", "gain matrix", "PI")]
    assert run("finite-time").fallen < 0.5 * min(others)
    assert run("finite-time").chatter == 0.0
    assert run("finite-time, capped late").chatter > 0.9
    assert run("gain matrix").steady < run("linear").steady
    assert DRIFT[0].any()


@pytest.mark.parametrize(
    "law",
    [pytest.param(k, marks=[pytest.mark.soak] if k == "raw law" else []) for k in LAWS],
)
def test_basins(law: str) -> None:
    """DESIGN 2.4: the raw law finds the minimum from a quarter of the starts, the safeguarded
    one from all."""
    point, two = beside_a_point(law), of_two(law)
    if law == "safeguarded":
        assert point.found.all()
        assert two.found.all()
        return
    assert 0.15 < weighted(point.found) < 0.35
    assert 0.02 < two.fraction < 0.2
    assert point.elsewhere.any()
    assert not (point.found & point.elsewhere).any()


def test_starts_of_the_map_are_where_it_says() -> None:
    body = so.shapes.ellipsoid(1.0, 0.7, 0.5)
    random = np.random.default_rng(0).normal(size=(50, 3))
    for x in random / np.linalg.norm(random, axis=1)[:, None]:
        _, (u, v, chart) = place_of(x)
        on = body.face_parts[0].charts[chart].jet(u, v)[0]
        np.testing.assert_allclose(on, x * [1.0, 0.7, 0.5], atol=1e-14)
        assert max(abs(u), abs(v)) <= 1.0 + 1e-12


@pytest.mark.parametrize("bodies_of", ["point", "faces"])
def test_starts_within_the_levels_all_converge(bodies_of: str) -> None:
    """Item 9: the largest level sets inside {H > 0}, thousands of starts of the raw law."""
    first, second = runs(bodies_of)
    assert len(first.found) + len(second.found) >= 2000
    assert first.found.all()
    assert second.found.all()


@pytest.mark.parametrize("bodies_of", ["point", "faces"])
def test_both_functions_fall(bodies_of: str) -> None:
    """dV/dt = -2 K V; dE/dt < 0 in {H > 0}, which no run leaves."""
    seen = watched(bodies_of)
    assert seen.rises == 0
    assert seen.indefinite == 0
    assert seen.rate < 0.1
    time = 50.0 * 1e-3 * np.arange(seen.v.shape[1])
    np.testing.assert_allclose(np.median(seen.v, axis=0), np.exp(-2.0 * time), rtol=1e-4)


def test_beyond_the_levels_h_is_singular() -> None:
    """The levels cannot be larger: each set's closest curve ends where H is singular."""
    for name in ("point", "faces"):
        levels = case(name).levels
        assert levels.singular[levels.slopes[:, -1].argmin()]
        assert levels.singular[levels.energies[:, -1].argmin()]
