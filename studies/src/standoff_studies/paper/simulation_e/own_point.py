"""Do a body's switches depend on its own witness point? The printed tests with wrong ones."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np

from standoff.motion import Twist
from standoff.tracking import Feature, Tracker
from standoff.tracking.laws import PaperLaw
from standoff_studies.paper.law_words import law_words
from standoff_studies.paper.pair_simulation import Simulation
from standoff_studies.paper.simulation_e.runs import SIMULATION

AROUND = 10
"""Frames before and after a switch at which the test is tried."""

POINTS = 25
"""Own witness points tried at each switch, anywhere on the feature before it."""

INSTANT = 1e-9
"""Length of the step in which the tests are evaluated [s]: nothing moves in it."""

LAWS = {
    "voronoi": PaperLaw.as_printed(gain=100.0),
    "multipliers": PaperLaw(gain=100.0, solve="plain", restarts=False),
}
"""The printed tests, and those that use the own witness point."""


class Decisions(NamedTuple):
    """How many decisions were those of the closest points, of how many, and by which tests."""

    right: int
    tried: int
    by: str


@cache
def decisions(switching: str) -> Decisions:
    """Test each switch of simulation E, before and after it, from random own witness points.

    The opposing witness point is the closest one.
    """
    runs, right, tried = SIMULATION, 0, 0
    tracker = Tracker(runs.a, runs.b, INSTANT, law=LAWS[switching])
    rng = np.random.default_rng(3)
    for event in runs.exact.events:
        own = "AB".index(event.body)
        for frame, due in ((event.frame - AROUND, False), (event.frame + AROUND, True)):
            for _ in range(POINTS):
                at = rng.uniform(size=2 if event.source.kind == "face" else 1)
                found = _switches(runs, tracker, frame, own, (event.source, at))
                right += found is due
                tried += 1
    by = law_words(tracker, told="the opposing witness point exact")
    return Decisions(right, tried, by)


def _switches(
    runs: Simulation, tracker: Tracker, frame: int, own: int, place: tuple[Feature, np.ndarray]
) -> bool:
    """Does one body leave a feature, at a point of it, in a frame of the exact run?"""
    exact, time = runs.exact, frame * runs.step
    poses = runs.paths[0].pose(time), runs.paths[1].pose(time)
    features = exact.feature_a[frame], exact.feature_b[frame]
    rows = exact.parameters_a[frame], exact.parameters_b[frame]
    places: list[tuple[Feature, np.ndarray]] = [
        (feature, row[~np.isnan(row)][: 2 if feature.kind == "face" else 1])
        for feature, row in zip(features, rows, strict=True)
    ]
    places[own] = place
    still = Twist.zero()
    (a, at_a), (b, at_b) = places
    state = tracker.start_from(*poses, (a, at_a), (b, at_b), still, still, settle=False)
    _, answer = tracker.step(state, *poses, still, still)
    after: tuple[Feature, Feature] = (answer.feature_a, answer.feature_b)
    return after[own] != place[0]
