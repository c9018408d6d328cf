"""The page's sentences, and the numbers beside its plot."""

from __future__ import annotations

import numpy as np
import pytest

from standoff.bodies.features import Feature
from standoff.motion import Pose
from standoff.tracking import Status
from standoff.tracking.status import OF_SOLIDS
from standoff.view.plot import PlotScale, scale_of
from standoff.view.readout import beside, readout, verdict
from standoff.view.shown import ShownPair
from standoff.view.tolerances import LEVEL_PLOT

SAID = [
    (Status.CONVERGED, 12.34567, 12.34567, "apart, distance 12.35 mm, proven", "12.35 mm"),
    (
        Status.TRACKING,
        12.34567,
        11.0,
        "distance between 11 and 12.35 mm: the law is still on its way",
        "between 11 and 12.35 mm",
    ),
    (
        Status.DEADLINE,
        12.0,
        -np.inf,
        "distance at most 12 mm: stopped by the deadline",
        "at most 12 mm",
    ),
    (
        Status.NOT_CERTIFIED,
        12.0,
        1.0,
        "distance between 1 and 12 mm: not proven closer",
        "between 1 and 12 mm",
    ),
    (Status.NOT_RESTARTED, 12.0, 1.0, "distance between 1 and 12 mm: no search was allowed", None),
    (
        Status.NOT_RESTARTED,
        -19.6,
        -19.7,
        "depth at most 19.7 mm: no search was allowed",
        "depth at most 19.7 mm",
    ),
    (Status.GLOBAL, -19.6, -19.6, "overlap, depth 19.6 mm, proven least", "depth 19.6 mm"),
    (Status.LOCAL, -19.6, -30.0, "overlap, depth 19.6 mm, perhaps not the least", "depth 19.6 mm"),
    (Status.OVERLAPPING, 0.0, -np.inf, "overlap, depth not known", "depth not known"),
    (Status.OVERLAPPING, np.nan, np.nan, "overlap, depth not known", "depth not known"),
    (Status.GLOBAL, 0.0, -8.1e-13, "touching, to within 8.1e-13 mm", "touching"),
    (Status.GLOBAL, 0.0, 0.0, "touching", "touching"),
    (Status.CONVERGED, 2e-12, 1e-12, "touching, to within 2e-12 mm", "touching"),
    (
        Status.FAR,
        np.inf,
        200.0,
        "at least 200 mm apart, beyond the horizon",
        "at least 200 mm apart",
    ),
    (Status.TRACKING, 0.0, -5.0, "distance between -5 and 0 mm: the law is still on its way", None),
]


def answer(status: Status, distance: float, bound: float) -> ShownPair:
    normal = np.array([0.0, -1e-17, -1.0])
    home = Pose.identity()
    features = Feature("face", 2), Feature("edge", 0)
    return ShownPair(
        (home, home),
        (np.zeros(3), np.nan_to_num(distance) * normal),
        normal,
        distance,
        bound,
        features,
        status,
    )


@pytest.mark.parametrize(("status", "distance", "bound", "said", "short"), SAID)
def test_an_answer_is_said_in_words(
    status: Status, distance: float, bound: float, said: str, short: str | None
) -> None:
    shown = answer(status, distance, bound)
    assert verdict(shown, "mm", 100.0) == said
    if short is not None:
        assert beside(shown, "mm", 100.0) == short
    # a page asks for no rows of a batch, so none is refused; solids have sentences of their own
    assert {status for status, *_ in SAID} == set(Status) - {Status.REFUSED, *OF_SOLIDS}


def test_the_table_names_bodies_and_writes_no_python() -> None:
    shown = answer(Status.GLOBAL, -19.6, -19.6)
    table = readout(shown, ("lens", "<b>"), "mm", 100.0, force=1.234)
    for part in ("face 2 of lens", "edge 0 of &lt;b&gt;", "+0.000, +0.000, -1.000", "1.23 N"):
        assert part in table
    for part in ("GLOBAL", "Status", "array", "Feature", "<b>"):
        assert part not in table
    touching = readout(answer(Status.GLOBAL, 0.0, -8.10018719e-13), ("a", "b"), "", 100.0)
    assert ">-8.2e-13<" in touching


def test_numbers_beside_the_plot_differ_and_hold_the_curves(rng: np.random.Generator) -> None:
    for _ in range(2000):
        size = 10.0 ** rng.uniform(-9.0, 6.0)
        middle = rng.choice([0.0, 1.0, -1.0]) * size * 10.0 ** rng.uniform(-6.0, 1.0)
        span = rng.choice([0.0, 1.0]) * size * 10.0 ** rng.uniform(-12.0, 1.0)
        values = middle + span * rng.uniform(-0.5, 0.5, 7)
        scale = scale_of(values, size)
        numbers = np.array([float(label) for label in scale.labels])
        assert len(set(scale.labels)) == len(scale.labels) >= 3
        assert len(scale.labels) <= 7
        assert numbers == pytest.approx(np.array(scale.ticks), rel=1e-12, abs=1e-12 * size)
        assert scale.ticks[0] <= values.min() <= values.max() <= scale.ticks[-1]
        assert max(map(len, scale.labels)) <= 14


def test_the_scale_is_calm_and_a_level_curve_is_not_magnified() -> None:
    first = scale_of(np.array([0.03, 0.05]), 0.2)
    assert first.labels == ("0.030", "0.035", "0.040", "0.045", "0.050")
    assert scale_of(np.array([0.032, 0.049]), 0.2, first) is first
    assert scale_of(np.array([0.032, 0.051]), 0.2, first) != first
    assert scale_of(np.array([0.032, 0.033]), 0.2, first) != first
    level = scale_of(np.array([0.83, 0.83 * (1.0 + 0.1 * LEVEL_PLOT)]), 1.0)
    assert level.labels == ("0", "0.5", "1.0", "1.5")
    assert scale_of(np.array([-34.0]), 100.0) == PlotScale(
        (-60.0, -50.0, -40.0, -30.0, -20.0, -10.0), ("-60", "-50", "-40", "-30", "-20", "-10")
    )
