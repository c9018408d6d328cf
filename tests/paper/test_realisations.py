"""Figs. 3 and 4: the law's two realisations agree, and how they drift apart."""

import numpy as np
import pytest

import standoff as so
from standoff_studies.paper import style
from standoff_studies.paper.catalogue import chosen, make
from standoff_studies.paper.realisations import comparison, run


def system(q, time):
    poses = run.PATH_A.pose(time), run.PATH_B.pose(time)
    twists = run.PATH_A.twist(time), run.PATH_B.twist(time)
    return so.tracking.pair_system(
        run.body(), run.body(), *poses, (run.FACE, q[:2]), (run.FACE, q[2:]), *twists
    )


@pytest.mark.parametrize("realisation", comparison.REALISATIONS)
def test_realisations_by_the_book(realisation):
    """Eq. (12) by Euler's rule, with Psi a state (Fig. 3) or evaluated (Fig. 4)."""
    gain, step = 50.0, 8e-3
    made = run.trace(realisation, "euler", gain, step, 50, run.MISS)
    q = made.q[0]
    psi = system(q, 0.0).Psi
    for k in range(12):
        s = system(q, k * step)
        if realisation == "evaluated":
            psi = s.Psi
        w = -np.linalg.solve(s.M, gain * psi + s.b)
        psi = psi + step * (s.M @ w + s.b)
        q = q + step * w
        np.testing.assert_allclose(made.q[k + 1], q, atol=1e-11)
        if realisation == "integrated":
            np.testing.assert_allclose(made.believed[k + 1], psi, atol=1e-12)


def test_integrated_errors_decay_by_themselves():
    """Fig. 3: Psi' = M w + b = -K Psi, by Heun's method."""
    made = comparison.decay()
    z = comparison.GAIN * comparison.SHORT_STEP
    predicted = (1.0 - z + z * z / 2.0) ** np.arange(len(made.believed))
    np.testing.assert_allclose(made.believed / made.believed[0], predicted, atol=1e-12)


def test_true_errors_of_the_integrated_one_stay():
    """Fig. 3 is open loop in q: what a step loses is never corrected."""
    made = comparison.decay()
    assert made.integrated[0] == pytest.approx(made.evaluated[0], rel=1e-12)
    assert made.believed[-1] < 1e-12
    assert made.integrated[-1] > 5.0 * made.evaluated[-1]
    assert made.integrated[100:].min() > 0.9 * made.integrated[100]


@pytest.mark.parametrize("integrator", comparison.ORDERS)
def test_realisations_come_together_with_the_integrators_order(integrator):
    """Figs. 3 and 4 realise one law."""
    made = comparison.by_integrator()[integrator]
    assert abs(made.orders[-1] - comparison.ORDERS[integrator]) < 0.15
    assert made.apart[-1] < {"euler": 1e-3, "heun": 1e-5, "rk4": 1e-9}[integrator]


def test_they_are_farther_apart_at_higher_gain():
    """After a wrong start, by K h."""
    made = comparison.by_gain()
    for low, high in zip(comparison.GAINS[:-1], comparison.GAINS[1:], strict=True):
        assert (made[high].apart > 2.0 * made[low].apart).all()
    np.testing.assert_allclose(made[200.0].apart[1:], made[100.0].apart[:-1], rtol=0.1)


@pytest.mark.parametrize("integrator", comparison.ORDERS)
def test_integrated_one_drifts_and_evaluated_one_stays_level(integrator):
    """Twenty seconds from the right start with exact twists."""
    early, late = comparison.level_of(comparison.drift("integrated", integrator))
    assert late > 1.7 * early
    _, misfit = comparison.rate_of(comparison.drift("integrated", integrator))
    assert misfit < 0.3
    early, late = comparison.level_of(comparison.drift("evaluated", integrator))
    assert late < 1.1 * early


def test_wrong_twists():
    """The integrated one drifts in proportion; the evaluated one is held at db/K."""
    small, great = comparison.BIASES[1:]
    slopes = [
        comparison.rate_of(comparison.drift("integrated", "heun", bias)) for bias in (small, great)
    ]
    assert slopes[1][0] == pytest.approx(great / small * slopes[0][0], rel=0.05)
    assert max(misfit for _, misfit in slopes) < 0.1
    early, late = comparison.level_of(comparison.drift("evaluated", "heun", great))
    assert late < 1.1 * early
    assert late < 1e-2 * comparison.drift("integrated", "heun", great)[-1]
    double = run.trace("evaluated", "heun", 2.0 * comparison.GAIN, 5e-3, 800, run.RIGHT, great)
    single = run.trace("evaluated", "heun", comparison.GAIN, 5e-3, 800, run.RIGHT, great)
    errors = [
        np.linalg.norm(made.points - run.exact(5e-3, 800), axis=1)[-1] for made in (single, double)
    ]
    assert errors[0] == pytest.approx(2.0 * errors[1], rel=0.1)


def test_a_run_that_leaves_its_patch_says_so():
    with pytest.raises(RuntimeError, match="left its patch at step"):
        run.trace("integrated", "euler", 10.0, 0.02, 300, run.RIGHT, 5.0)


@pytest.mark.parametrize("key", ["3", "4"])
def test_figures_of_the_realisations_are_made(key):
    (entry,) = chosen([key])
    made = make(entry)
    for table in made.tables.values():
        assert len({len(column) for column in table.values()}) == 1
    assert made.statements
    assert [s for s in made.statements if s.holds is False] == []
    assert all((s.holds is None) == (s.stated == "-") for s in made.statements)
    with style.settings():
        assert len(made.draw().axes) == (2 if key == "3" else 5)
