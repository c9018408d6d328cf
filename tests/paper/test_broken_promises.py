"""What the rows of the promises rest on, changed: each quotation is turned by a change at least.

Of simulations A to E the law itself is broken: test_broken_on_purpose.py.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from functools import cache
from types import SimpleNamespace
from typing import Any, NamedTuple
from unittest.mock import patch

import numpy as np
import pytest

import standoff as so
from standoff.geometry import BezierPatch
from standoff_studies.paper import normals_study, patches, update_cost, voronoi_figure
from standoff_studies.paper.broken_on_purpose.matrix import statements_of
from standoff_studies.paper.control import gains, levels, roots
from standoff_studies.paper.convergence import figures as arrivals
from standoff_studies.paper.convergence.cells import Cell, committed
from standoff_studies.paper.promises import PROMISES
from standoff_studies.paper.realisations import run as realisations
from standoff_studies.paper.simulation_b import regions as regions_b
from standoff_studies.paper.simulation_c import regions as regions_c

PAPER = "standoff_studies.paper"
FOOT, TRACKER, ROOTS = patches._answer, so.Tracker, roots.sampled_roots
ADVANCED, STEP = normals_study.advanced, update_cost.law_step
FUNCTIONS = levels.functions
B, C = regions_b.run, regions_c.regions


@contextmanager
def made_again() -> Iterator[None]:
    """Within, nothing counts that the studies keep of earlier runs; afterwards it does again."""
    fresh: dict[Any, Any] = {}
    with ExitStack() as stack:
        for module in [one for name, one in sys.modules.items() if name.startswith(f"{PAPER}.")]:
            for name, value in [*vars(module).items()]:
                if hasattr(value, "cache_info"):
                    again = fresh.setdefault(value, cache(value.__wrapped__))
                    stack.enter_context(patch.object(module, name, again))
        yield


def followed_by(change: Callable[[Any, float], Any]) -> Callable[..., so.Tracker]:
    """Trackers whose law, where one is given, is changed."""

    def tracker(a: Any, b: Any, dt: float = 1e-3, **options: Any) -> so.Tracker:
        if "law" in options:
            options["law"] = change(options["law"], dt)
        return TRACKER(a, b, dt, **options)

    return tracker


def gain_halved(law: Any, dt: float) -> Any:
    if not isinstance(law, so.PaperLaw):
        return law
    ruled = law.feedback
    if isinstance(ruled, so.feedback.Linear):
        return replace(law, feedback=replace(ruled, gain=0.5 * ruled.gain))
    if isinstance(ruled, so.feedback.PI):
        slower = so.feedback.PI(0.5 * ruled.gain, 0.25 * ruled.integral)  # of the same damping
        return replace(law, feedback=slower)
    return law if law.feedback else replace(law, gain=0.5 * (law.gain or 1.0 / dt))


def realised_otherwise(law: Any, dt: float) -> Any:
    """Fig. 3's loop of first order, Fig. 4's with half the gain."""
    if not isinstance(law, so.PaperLaw):
        return law
    return (
        replace(law, integrator="euler")
        if law.realisation == "integrated"
        else gain_halved(law, dt)
    )


def long_steps(law: Any, dt: float) -> Any:
    return replace(law, gain=1.5 / dt) if isinstance(law, so.PaperLaw) else law


def otherwise_predicted(law: Any, dt: float) -> Any:
    """With a feedforward where there was none, without where there was one."""
    if isinstance(law, so.PaperLaw):
        return replace(law, feedforward=False)
    return replace(law, predictor="feedforward" if law.predictor == "none" else "none")


def covariant_and_loose(law: Any, dt: float) -> Any:
    """Another M at rest, and an online gain for twice the error."""
    if isinstance(law.feedback, so.feedback.MotionGain):
        return replace(law, feedback=so.feedback.MotionGain(2.0 * law.feedback.error, least=1.0))
    return replace(law, solve="covariant") if law.gain == 500.0 else law


class Stretched(BezierPatch):
    """A patch whose jets have tangents twice as long."""

    def jet(self, u: float, v: float) -> Any:
        x, *partials = super().jet(u, v)
        return x, *(2.0 * partial for partial in partials)


def beside_the_foot(*pair: Any) -> Any:
    """The equations at a place beside the closest points."""
    answer, _ = FOOT(*pair)
    (feature_a, q_a), place_b = answer.place_a, answer.place_b
    return answer, so.tracking.pair_system(*pair, (feature_a, np.array(q_a) + 1e-3), place_b)


def half_arrived() -> tuple[Cell, ...]:
    halved = ("arrived", "right", "settled", "definite", "definite_arrived", "right_arrived")
    return tuple(
        replace(cell, **{name: getattr(cell, name) // 2 for name in halved}) for cell in committed()
    )


def of_another_feature(*pair: Any) -> SimpleNamespace:
    answer = so.distance(*pair)
    return SimpleNamespace(
        certified=answer.certified, distance=answer.distance, feature_a=answer.feature_b
    )


def without_a_line() -> Any:
    """Simulation B with one Voronoi line and one branch of the medial axis left out."""
    run = B()
    regions = replace(
        run.regions, external=run.regions.external[1:], medial_axis=run.regions.medial_axis[1:]
    )
    return run._replace(regions=regions)


def turned_inwards() -> Any:
    return tuple(
        replace(one, external=tuple(x._replace(directions=-x.directions) for x in one.external))
        for one in C()
    )


def of_other_signs(*at: Any) -> Any:
    v, energy, least = FUNCTIONS(*at)
    return v, -energy, -least


def by_euler(integrator: str, *rest: Any) -> Any:
    return ROOTS("euler", *rest)


def half_a_step(*given: Any) -> Any:
    """From where it is, half of the way that the law goes."""
    q = given[3]
    return q + 0.5 * (STEP(*given) - q)


def hardly_moved(at: Any, points: Any, steps: Any) -> Any:
    return ADVANCED(at, points, 0.02 * steps)


class Change(NamedTuple):
    """A change of what a figure rests on: attributes, each with what takes its place."""

    figure: str
    replaced: tuple[tuple[Any, str, Any], ...]


def change(figure: str, *where: Any) -> Change:
    """A change of one attribute after the other: module, name, replacement."""
    return Change(figure, tuple(zip(where[::3], where[1::3], where[2::3], strict=True)))


OTHERWISE, HALVED = followed_by(realised_otherwise), followed_by(gain_halved)

CHANGES = (
    change("1", patches, "curved_face", lambda: Stretched(patches._control_points())),
    change("2", patches, "_answer", beside_the_foot),
    change("3", realisations, "Tracker", OTHERWISE),
    change("4", realisations, "Tracker", OTHERWISE),
    change("8", regions_b, "run", without_a_line),
    change("12", regions_c, "regions", turned_inwards),
    change("arrivals", arrivals, "committed", half_arrived),
    change("voronoi", voronoi_figure, "distance", of_another_feature),
    change("gains", so, "Tracker", HALVED, gains, "stability_limit", lambda name: 2.0),
    change("stability", roots, "sampled_roots", by_euler),
    change("feedback", so, "Tracker", HALVED),
    change("basin", so, "Tracker", followed_by(long_steps)),
    change("lyapunov", levels, "FRAMES", 20, levels, "functions", of_other_signs),
    change("normals", normals_study, "advanced", hardly_moved),
    change("variants", so, "Tracker", followed_by(covariant_and_loose)),
    change("cost", update_cost, "law_step", half_a_step),
    change("verdict", so, "Tracker", followed_by(otherwise_predicted)),
)
BY_CONSTRUCTION = ("one step an update, no test and no loop",)
"""What no change turns, because it says how the program is made."""

QUICK = ("2", "arrivals")
"""Figures whose changes are tried in every run; the others are for `make soak`."""


@pytest.mark.parametrize(
    "change",
    [
        pytest.param(one, id=one.figure, marks=[] if one.figure in QUICK else [pytest.mark.soak])
        for one in CHANGES
    ],
)
def test_each_quotation_is_turned(change: Change) -> None:
    with made_again(), ExitStack() as stack:
        for where, name, by in change.replaced:
            stack.enter_context(patch.object(where, name, by))
        changed = statements_of(change.figure)
    rows = [row for section in PROMISES.values() for row in section]
    quoted = [(row.says, one) for row in rows for one in row.shown if one.key == change.figure]
    assert quoted
    unturned = [(says, one.number) for says, one in quoted if not one.fault(changed)]
    assert [one for one in unturned if one[1] not in BY_CONSTRUCTION] == []
