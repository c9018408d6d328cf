"""The paper's law by the covariant solve: it arrives from anywhere, and E falls all the way."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import standoff as so
from shares import share
from standoff_studies.paper.convergence import cells
from standoff_studies.paper.simulation_e.runs import PATH_A, PATH_B, SIMULATION, pair

STILL = so.Twist.zero()
POSES = PATH_A.pose(0.0), PATH_B.pose(0.0)
ARRIVED = 1e-4
"""Of the distance [length]; the bodies are of size 2."""


def starts(n: int) -> list[tuple[Any, Any]]:
    """The first starts of the study of convergence."""
    rng, found = np.random.default_rng(cells.SEED), []
    for _ in range(n):
        faces, at = rng.integers(3, size=2).tolist(), rng.uniform(size=(2, 2))
        found.append(((("face", faces[0]), at[0]), (("face", faces[1]), at[1])))
    return found


STARTS = starts(160)


def frames_of(gain: float) -> int:
    """Frames that a start is given: 15 / K, in which exp(-K t) falls to 3e-7, and 20 switches."""
    return round(15.0 / gain / SIMULATION.step) + 20


KNOWN = (25, 32, 33, 52, 55, 60, 77, 141, 152, 155)
"""Starts that failed while this was made: pinned on a collapsed side, turned about one by steps
longer than the way to it, stopped at a boundary in every frame."""


def law(gain: float, **options: Any) -> so.PaperLaw:
    return so.PaperLaw(gain=gain, solve="covariant", restarts=False, **options)


PRINTED = {"switching": "voronoi", "saturation": "zero", "reset": "nearest"}
VARIANTS = {
    "printed switching, reset and zeroing": PRINTED,
    "boundaries held": {**PRINTED, "saturation": "hold"},
    "exact resets": {**PRINTED, "reset": "foot"},
    "multipliers": {},
}


def run(tracker: so.Tracker, start: tuple[Any, Any], frames: int) -> list[so.Proximity]:
    state = tracker.start_from(*POSES, *start, STILL, STILL, settle=False)
    answers = [state.proximity]
    for _ in range(frames):
        state, answer = tracker.step(state, *POSES, STILL, STILL)
        answers.append(answer)
    return answers


@pytest.mark.parametrize(("name", "gain"), share(2, VARIANTS, [100.0, 1000.0]))
def test_every_start_arrives(name: str, gain: float) -> None:
    tracker = so.Tracker(*pair(), SIMULATION.step, law=law(gain, **VARIANTS[name]))
    truth = so.distance(*pair(), *POSES).distance
    for k in (*KNOWN, *range(20)):
        end = run(tracker, STARTS[k], frames_of(gain))[-1]
        assert abs(end.distance - truth) < ARRIVED, (k, end)
        assert end.counts.restarts == end.counts.searches == 0


def test_e_falls_at_every_step_and_switch() -> None:
    """At a gain far below the stable one, between switches and over them."""
    tracker = so.Tracker(*pair(), SIMULATION.step, law=law(25.0, **{**PRINTED, "reset": "foot"}))
    switches = 0
    for k in range(12):
        answers = run(tracker, STARTS[k], 200)[1:]  # the first frame finds the faces
        apart = np.array([answer.distance for answer in answers])
        switches += sum(answer.counts.switches for answer in answers)
        assert (np.diff(apart) <= 1e-12).all(), (k, np.diff(apart).max())
    assert switches > 0


def test_near_the_minimum_the_errors_fall_as_designed() -> None:
    gain = 100.0
    tracker = so.Tracker(*pair(), SIMULATION.step, law=law(gain, **PRINTED))
    state = tracker.start(*POSES)
    found = state.proximity
    nearby = [
        (feature, (own[0] + 1e-4, own[1] - 2e-4))
        for feature, own in (
            (found.feature_a, found.parameters_a),
            (found.feature_b, found.parameters_b),
        )
    ]
    residuals = np.array([each.residual for each in run(tracker, tuple(nearby), 60)])
    factor = 1.0 - gain * SIMULATION.step + 0.5 * (gain * SIMULATION.step) ** 2  # Heun's
    assert residuals[1:] / residuals[:-1] == pytest.approx(factor, abs=2e-3)


def test_a_lowered_gain_is_counted() -> None:
    tracker = so.Tracker(
        *pair(), SIMULATION.step, law=law(1000.0, **{**PRINTED, "saturation": "hold"})
    )
    answers = run(tracker, STARTS[32], 35)
    assert sum(answer.counts.saturations for answer in answers) > 0
    assert answers[-1].counts.saturations == 0


def test_what_is_held_for_a_frame_alone_is_no_switch() -> None:
    tracker = so.Tracker(
        *pair(), SIMULATION.step, law=law(25.0, **{**PRINTED, "saturation": "hold"})
    )
    for k in (155, *range(12)):
        before = None
        for answer in run(tracker, STARTS[k], 100)[1:]:
            here = answer.feature_a, answer.feature_b
            if before is not None and here == before:
                assert not answer.events, (k, answer.events)
            before = here
