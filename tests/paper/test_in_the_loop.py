"""Fig. 5: device, coupler, dynamics and tracker in one operator; what its statements tell."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from standoff import simulation as sim
from standoff.kernels.entries import simulation as E
from standoff_studies.paper import style
from standoff_studies.paper.catalogue import chosen, make
from standoff_studies.paper.in_the_loop import figure, statements
from standoff_studies.paper.in_the_loop.run import (
    BALL,
    DURATION,
    LIFT,
    PERIOD,
    RADIUS,
    Runs,
    device,
    hand_pose,
    operator,
    run,
)


def cut(runs: Runs, records: int) -> Runs:
    """The first part of a run."""
    made = runs.inside
    part = sim.SystemRun(made.system, made.states[:records], made.accounts[:records])
    return replace(runs, inside=part, exact=runs.exact[:records])


@pytest.mark.soak
def test_the_hand_goes_around_the_lens_a_little_inside() -> None:
    times = np.linspace(0.0, DURATION, 200)
    way = np.array([hand_pose(t).translation for t in times])
    speed = np.linalg.norm(np.diff(way, axis=0), axis=1) / np.diff(times)
    assert speed.max() < 0.06
    assert speed[[0, -1]].max() < 0.1 * speed.max()
    # in the middle of its way nearer than the ball's radius
    assert run().exact[0] == pytest.approx(LIFT, abs=1e-6)
    assert np.linalg.norm(way, axis=1).min() > 0.55 * RADIUS


def test_the_tool_rides_over_face_edge_and_vertex() -> None:
    assert statements.kinds_touched(run()) == [
        *("face 0", "edge 0", "face 1", "edge 0", "vertex 1", "edge 1")
    ]
    statement = statements._features(run())
    assert statement.holds is True
    assert statements._features(cut(run(), 1500)).holds is False


def test_the_law_inside_is_at_the_closest_points() -> None:
    assert statements._one_state(run()).holds is True
    off = replace(run(), exact=run().exact + 2e-6)
    assert statements._one_state(off).holds is False


def test_a_jump_of_force_is_told() -> None:
    """The force at a switch, one tick long: a normal that is not that of the witness points."""
    runs = run()
    assert statements._smooth(runs).holds is True
    mode = runs.answers.mode[:, 0]
    switched = np.flatnonzero((np.diff(mode) != 0.0) & (runs.inside.spots[1:, 0] > 0))
    accounts = runs.inside.accounts.copy()
    accounts[switched[-1], E.ACCOUNT_HEADER] += 0.5
    broken = sim.SystemRun(runs.inside.system, runs.inside.states, accounts)
    assert statements._smooth(replace(runs, inside=broken)).holds is False


def test_energy_never_grows() -> None:
    assert statements.grown(run().inside) < 1e-4
    assert run().coupler.energy.least.min() > -1e-12
    accounts = run().inside.accounts.copy()
    accounts[2000:, E.A_KINETIC] += 1e-3
    broken = sim.SystemRun(run().inside.system, run().inside.states, accounts)
    assert statements.grown(broken) > 0.01


def test_inside_and_beside_feel_the_same() -> None:
    runs = run()
    apart = np.linalg.norm(runs.inside.positions(1) - runs.beside.positions(1), axis=1)
    assert apart.max() < 5e-5
    felt = [np.linalg.norm(each.forces[:, 0], axis=1).max() for each in (runs.inside, runs.beside)]
    assert felt[0] == pytest.approx(felt[1], rel=0.02)


@pytest.mark.soak
def test_low_gains_suffice(monkeypatch: pytest.MonkeyPatch) -> None:
    assert statements._gains().holds is True
    wrong = {**statements.by_gain(), "greatest_error_m": np.array([2e-6, 0.0, 0.0])}
    monkeypatch.setattr(statements, "by_gain", lambda: wrong)
    assert statements._gains().holds is False


def test_the_device_and_the_law_are_those_that_are_told() -> None:
    one = operator()
    assert one.tracker == "inside"
    assert one.laws[0].gain == 100.0
    assert device().sampling.period == PERIOD
    assert one.system.bodies[1].body.radius == BALL


@pytest.fixture
def one_gain(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Each takes seconds; `test_low_gains_suffice` runs them all."""
    monkeypatch.setattr(statements, "GAINS", statements.GAINS[:1])
    statements.by_gain.cache_clear()
    yield
    statements.by_gain.cache_clear()


@pytest.mark.usefixtures("one_gain")
def test_the_figure_is_made() -> None:
    (entry,) = chosen(["5"])
    made = make(entry)
    for table in made.tables.values():
        assert len({len(column) for column in table.values()}) == 1
    assert [s for s in made.statements if s.holds is False] == []
    assert sum(s.holds is True for s in made.statements) >= 4
    assert all((s.holds is None) == (s.stated == "-") for s in made.statements)
    assert set(figure.parameters(run())[:, 0]) >= {0.0, 1.0}
    with style.settings():
        assert len(made.draw().axes) == 7
