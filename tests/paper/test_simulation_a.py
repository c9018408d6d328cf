"""Simulation A (Figs. 6 and 7): the paper's law on a patch, its decay and its gains."""

import numpy as np
import pytest

import standoff as so
from standoff_studies.paper import style
from standoff_studies.paper.catalogue import chosen, make
from standoff_studies.paper.many_starts import motion_along
from standoff_studies.paper.pair_simulation import REST
from standoff_studies.paper.simulation_a import errors, gains, raw_law, snapshots
from standoff_studies.paper.simulation_a import run as runs
from standoff_studies.paper.simulation_a import statements as said
from standoff_studies.paper.simulation_a.setting import (
    FACE,
    PATH,
    START,
    STEP,
    VERTEX,
    control_points,
    point,
    vault,
)

PLACES = np.random.default_rng(4).uniform(0.05, 0.95, (12, 2))
STILL = so.Twist.zero()


def system(q, time):
    place = (FACE, tuple(q)), (VERTEX, ())
    return so.tracking.pair_system(
        vault(), point(), REST.pose(time), PATH.pose(time), *place, STILL, PATH.twist(time)
    )


def roof_jet(u, v):
    (roof,) = vault().face_parts[FACE.index].charts
    return roof.jet(u, v)


def roof_point(u, v):
    """The bicubic patch by Bernstein's polynomials."""
    a, b = ([(1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t * t * (1 - t), t**3] for t in (u, v))
    return np.einsum("i,j,ijk->k", a, b, control_points())


def rates(q, time, gain):
    """w = -H^-1 (K Psi + b) and H, with Psi = F'dR, H = F'F + dR.f'', b = -F'v."""
    f, *first, uu, uv, vv = roof_jet(*q)
    F, dR = np.array(first).T, f - PATH.pose(time).translation
    H = F.T @ F + [[dR @ uu, dR @ uv], [dR @ uv, dR @ vv]]
    return -np.linalg.solve(H, gain * F.T @ dR - F.T @ PATH.twist(time).v), H


def test_vault_is_proven_convex_and_its_roof_is_the_patch():
    """Fig. 6: a convex patch."""
    report = vault().check()
    assert (report.closed, report.outward, report.faces) == (True, True, 6)
    assert [patch.convex for patch in report.patches] == [True] * 6
    for u, v in PLACES:
        np.testing.assert_allclose(roof_point(u, v), roof_jet(u, v)[0], atol=1e-14)


def test_twist_is_the_rate_of_the_path():
    h = 1e-6
    for time in (0.0, 0.7, 2.9):
        after, before = (PATH.pose(time + step).translation for step in (h, -h))
        np.testing.assert_allclose(PATH.twist(time).v, (after - before) / (2 * h), atol=1e-9)
        # 1.1 [length/s] around, 0.25 [length] higher after a turn
        around = [0.55 * np.cos(2 * time), 0.55 * np.sin(2 * time), 1.3 + 0.08 * time]
        np.testing.assert_allclose(PATH.pose(time).translation, around, atol=1e-14)


def test_system_is_that_of_the_paper():
    """Eqs. (1)-(4), (9), (10); also beyond the patch's rims, where trial stages come."""
    for time in (0.0, 1.3):
        for q in PLACES:
            s, public = runs.system_at(q, time), system(q, time)
            for name, value in public._asdict().items():
                np.testing.assert_array_equal(getattr(s, name), value)
            w, H = rates(q, time, 300.0)
            np.testing.assert_allclose(-np.linalg.solve(s.M, 300.0 * s.Psi + s.b), w, rtol=1e-10)
            np.testing.assert_allclose(s.H, H, atol=1e-13)
    np.testing.assert_allclose(
        runs.system_at(np.array([1.2, -0.1]), 0.0).dR,
        roof_point(1.2, -0.1) - PATH.pose(0.0).translation,
        atol=1e-13,
    )


@pytest.mark.parametrize("raw", [False, True])
def test_tracker_runs_the_law_by_the_book(raw):
    """Heun's method on Eq. (12), 40 steps, from the wrong start."""
    q, gain = np.array(START), 1000.0
    made = errors.shown(gain).q
    if raw:
        moving = motion_along(REST, PATH, STEP * np.arange(60))
        made = raw_law.follow(raw_law.raw_tracker(gain), q, moving).q
        assert len(made) == 11
    for k, found in enumerate(made[:41]):
        np.testing.assert_allclose(found, q, atol=1e-12)
        w, _ = rates(q, k * STEP, gain)
        after, _ = rates(q + STEP * w, (k + 1) * STEP, gain)
        q = q + 0.5 * STEP * (w + after)


@pytest.mark.parametrize(("gain", "steps"), [(100.0, 70), (1000.0, 10)])
def test_steps_to_a_thousandth(gain, steps):
    """Fig. 7: about 75 and 10 steps; the golden values 70 and 10 of the design, +-1."""
    made = errors.shown(gain)
    assert abs(made.steps - steps) <= 1
    assert (made.normalised[made.steps :] < 1e-3).all()
    assert made.normalised[made.steps - 1].max() >= 1e-3


@pytest.mark.parametrize("gain", [100.0, 1000.0])
def test_decay_is_monotone_and_as_predicted(gain):
    """Fig. 7: the errors decay monotonically; Psi' = -K Psi sampled by Heun's method."""
    made = errors.shown(gain)
    falls = np.diff(made.normalised[: made.steps + 1], axis=0)
    assert (falls < 0.0).all()
    growth = 1.0 - gain * STEP + (gain * STEP) ** 2 / 2.0
    predicted = growth ** np.arange(made.steps + 1)
    # large errors have a second-order part, here at most 5 % of the first error
    assert np.abs(made.normalised[: made.steps + 1] - predicted[:, None]).max() < 0.05


def test_every_gain_of_the_stated_range_settles():
    """The paper's stable range by experiment: 0.5 to 1500 1/s at 1 kHz."""
    made = gains.settling()
    assert made.gain[0] < 0.5
    assert {0.5, 1500.0} <= set(made.gain.tolist())
    assert np.isfinite(made.steps).all()
    slow = made.gain <= 200.0
    np.testing.assert_allclose(made.steps[slow], made.predicted[slow], atol=1)
    assert made.gain[int(np.argmin(made.steps))] in (800.0, 1000.0, 1200.0)
    assert (np.diff(made.steps[made.gain >= 1200.0]) > 0).all()


def test_limit_for_small_errors_is_that_of_linear_theory():
    """K h = 2 for Heun's method: 2000 1/s at 1 kHz; the tracker takes no more."""
    assert gains.LIMIT == 2000.0
    assert abs(gains.small_error_limit() - 2000.0) <= 0.05
    with pytest.raises(ValueError, match="2000"):
        raw_law.raw_tracker(2000.0)


def test_a_growth_that_does_not_rise_has_no_limit(monkeypatch):
    """As at half the gain, where small errors vanish within the steps that are looked at."""
    monkeypatch.setattr(gains, "growth_of_small_errors", lambda *_: 0.0)
    assert np.isnan(gains.small_error_limit.__wrapped__())


def test_figures_are_run_by_the_raw_law():
    """Figs. 6 and 7: M as it is, on one face, and nothing else that moves the witness point."""
    for made in (snapshots.snapshot_run(), errors.shown(100.0), errors.shown(1000.0)):
        law, counts = made.recording.info.law, made.recording.total_counts()
        assert (law.solve, law.switching, law.saturation) == ("plain", "none", "zero")
        assert (law.restarts, law.feedforward, law.integrator) == (False, True, "heun")
        assert law.gain == made.gain
        assert counts.regularised == counts.restarts == counts.saturations == 0
        assert counts.corrections == len(made.q) - 1
    assert [errors.shown(1000.0).steps_below(level) for level in (1e-2, 1e-3, 1e-4)] == [8, 12, 15]


def test_large_errors_meet_a_lower_limit():
    """Why the experiment's limit is below theory's: H is lost at the trial stage from far away."""
    trials = gains.trials()
    assert 1200.0 <= gains.greatest_for_all() <= 1500.0
    assert (trials.steps[0] >= 0).all()
    assert (trials.steps < 0).any()
    lost = trials.steps < 0
    assert not trials.indefinite[~lost].any()
    assert trials.indefinite.sum() > 0.5 * lost.sum()
    home, failed = gains.rescued()
    assert home == failed == lost.sum()


def test_a_lost_start_leaves_the_patch():
    """The start near the rim at K = 1650 1/s, of those that fail without safeguards."""
    with pytest.raises(RuntimeError, match="left the patch at step 1"):
        runs.run(1650.0, 20, (0.02, 0.98))
    trial = raw_law.try_all(np.array([[0.02, 0.98], START]), np.array([1650.0]), 200)
    assert trial.steps[0, 0] == -1 < 0 < trial.steps[0, 1]
    # its first step leads out, and H is lost at the trial stage of it
    q = np.array([0.02, 0.98])
    w, H = rates(q, 0.0, 1650.0)
    assert (np.linalg.eigvalsh(H) > 0.0).all()
    after, H = rates(q + STEP * w, STEP, 1650.0)
    assert trial.indefinite[0, 0] == (np.linalg.eigvalsh(H)[0] <= 0.0)
    assert np.abs(q + 0.5 * STEP * (w + after) - 0.5).max() > 0.5


def test_steady_errors():
    """Without feedforward b/K; with it, 1/(1 - Kh/2) times that of small gains (Heun)."""
    steady = gains.steady()
    fast = steady.gain >= 10.0
    bound = gains.greatest_feedforward() / steady.gain
    np.testing.assert_allclose(steady.without[fast], bound[fast], rtol=0.02)
    part = steady.gain >= 50.0
    level = steady.forward[part] * (1.0 - 0.5 * STEP * steady.gain[part])
    np.testing.assert_allclose(level, level[0], rtol=0.02)
    assert (steady.forward < 1e-3 * steady.without).sum() >= 10


def test_snapshots_end_on_the_closest_point():
    """Fig. 6: a large initial error; then the witness line is the shortest one."""
    made = snapshots.snapshot_run()
    frames = [0, *range(75, len(made.q), 300)]
    over = snapshots.lengths(made)[frames] - snapshots.exact(made, frames)
    assert over[0] > 0.5
    assert (over[1:] >= -1e-12).all()
    assert over[1:].max() < 1e-6


def test_errors_as_cosines():
    """Of the angle between ΔR and each tangent, by differences of the patch."""
    made = runs.run(100.0, 200)
    surface = vault().face_parts[0].charts[0]
    for k in (0, 10, 40):
        u, v = made.q[k]
        away = made.witness[k] - made.target[k]
        for axis, (du, dv) in enumerate(((1e-6, 0.0), (0.0, 1e-6))):
            tangent = surface.jet(u + du, v + dv)[0] - surface.jet(u - du, v - dv)[0]
            cosine = abs(tangent @ away) / np.linalg.norm(tangent) / np.linalg.norm(away)
            assert made.cosines[k, axis] == pytest.approx(cosine, abs=1e-8)
    assert [made.steps_below(level) for level in (1e-2, 1e-3, 1e-4)] == [53, 76, 99]


def test_levels_of_the_cosines_that_fit_both_counts():
    """At every level within both counts are those of the paper to 15 %, at none outside."""
    made = errors.shown(100.0), errors.shown(1000.0)
    low, high = said.fitting_levels(*made)
    assert (low, high) == pytest.approx((1.07e-3, 3.48e-3), rel=0.01)

    def fit(level):
        counts = [one.steps_below(level) for one in made]
        return all(abs(n - of) <= 0.15 * of for n, of in zip(counts, said.STATED, strict=True))

    assert all(fit(level) for level in np.geomspace(low * (1.0 + 1e-9), high, 50).tolist())
    assert not any(fit(level) for level in (low, high * (1.0 + 1e-9), 1e-4, 1e-2))


def test_ends_of_the_range_are_judged_by_themselves(monkeypatch):
    """They would be limits if the gains beyond them failed, as they do without these gains."""
    ends = [end.holds for end in (said._upper_end(), said._lower_end())]
    assert ends == [None, None]
    made = gains.settling()
    outside = (made.gain < 0.5) | (made.gain > 1500.0)
    failing = made._replace(steps=np.where(outside, np.nan, made.steps))
    monkeypatch.setattr(gains, "settling", lambda: failing)
    assert [end.holds for end in (said._upper_end(), said._lower_end())] == [True, True]
    assert said._stated_range().holds is True


@pytest.mark.parametrize("key", ["6", "7"])
def test_figures_are_made(key):
    (entry,) = chosen([key])
    made = make(entry)
    for table in made.tables.values():
        assert len({len(column) for column in table.values()}) == 1
    assert made.statements
    assert not [s.stated for s in made.statements if s.holds is False]
    # the paper names no level of the cosines, and neither end of the range was met
    no_verdict = [s.stated for s in made.statements if s.holds is None and s.stated != "-"]
    words = ("errors as cosines", "upper limit", "lower limit") if key == "7" else ()
    assert len(no_verdict) == len(words)
    assert all(word in stated for word, stated in zip(words, no_verdict, strict=True))
    with style.settings():
        assert len(made.draw().axes) == (2 if key == "6" else 5)


def test_animation_draws_its_first_and_last_frame():
    animation = snapshots.figure_6().animation
    assert animation.frames <= 100
    with style.settings():
        for k in (0, animation.frames - 1):
            figure = style.new_figure(*animation.size)
            animation.draw(figure, k)
            (painted,) = figure.axes[0].collections
            assert len(painted.get_paths()) > snapshots.GRID**2
