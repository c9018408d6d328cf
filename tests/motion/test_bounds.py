"""Bounds on speed and acceleration against differences of the poses."""

import itertools
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from test_paths import PATHS

from standoff.motion import Bounded, Fixed, Path, Pose, PoseSamples
from standoff.motion.bounds import bounds_of, breaks_of

STEP = 1e-3
NOISE = 1e-6  # of second differences: rounding over STEP² is 1e-9, the fourth order 1e-6 at most


def pieces(path: Path, first: float, last: float) -> list[tuple[float, float]]:
    times = [first, *breaks_of(path, first, last), last]
    return list(itertools.pairwise(times))


@pytest.mark.parametrize("path", PATHS.values(), ids=PATHS.keys())
def test_no_instant_is_faster_than_the_bounds(path: Path, rng: np.random.Generator) -> None:
    for begin, end in pieces(path, 0.0, 3.5):
        point = rng.normal(size=3) * 2.0
        bounds = bounds_of(path, begin, end, point)
        greatest = np.zeros(4)
        for t in rng.uniform(begin + STEP, end - STEP, 40):
            before, now, after = (path.pose(s) for s in (t - STEP, t, t + STEP))
            x, y, z = (pose.apply(point) for pose in (before, now, after))
            turns = [
                Rotation.from_matrix(late.rotation @ early.rotation.T).as_rotvec() / STEP
                for early, late in ((before, now), (now, after))
            ]
            found = [
                (z - x) / (2 * STEP),
                (z - 2 * y + x) / STEP**2,
                (turns[0] + turns[1]) / 2,
                (turns[1] - turns[0]) / STEP,
            ]
            if bounds.axis is not None:
                assert np.linalg.norm(bounds.axis) == pytest.approx(1.0)
                assert abs(found[1] @ bounds.axis) < NOISE
            greatest = np.fmax(greatest, [float(np.linalg.norm(f)) for f in found])
        limits = [
            bounds.speed,
            bounds.acceleration,
            bounds.angular_speed,
            bounds.angular_acceleration,
        ]
        assert (greatest <= np.array(limits) * (1 + 1e-5) + NOISE).all(), (greatest, limits)


@pytest.mark.parametrize("name", ["screw", "constant twist, body axes", "turning spiral"])
def test_bounds_are_reached(name: str) -> None:
    """Bounds that are far too great would be valid, and slow."""
    path, point = PATHS[name], np.array([0.3, -0.8, 0.5])
    bounds = bounds_of(path, 1.0, 1.0 + 2 * STEP, point)
    x, y, z = (path.pose(1.0 + k * STEP).apply(point) for k in range(3))
    assert np.linalg.norm(z - x) / (2 * STEP) == pytest.approx(bounds.speed, rel=1e-2)
    bend = np.linalg.norm(z - 2 * y + x) / STEP**2
    assert bend == pytest.approx(bounds.acceleration, rel=1e-2)


def test_a_screw_knows_its_axis() -> None:
    axes = [bounds_of(path, 0.0, 0.1, np.ones(3)).axis for path in PATHS.values()]
    assert sum(axis is not None for axis in axes) == len(axes) - 3  # fixed, and two carried


def test_samples_bound_one_interval_only() -> None:
    samples = PoseSamples([0.0, 1.0, 3.0], [Pose.exp([0, 0, k], [k, 0, 0]) for k in range(3)])
    assert list(breaks_of(samples, 0.0, 3.0)) == [1.0]
    assert list(breaks_of(samples, 1.0, 3.0)) == []
    with pytest.raises(ValueError, match="within one interval"):
        bounds_of(samples, 0.5, 2.0, np.zeros(3))


@pytest.mark.parametrize(
    "breaks", ["a", 5.0, None, [[1.0, 2.0]], [1.0, "2"], [1.0, np.inf], [True]]
)
def test_breaks_are_a_sequence_of_times(breaks: Any) -> None:
    told = dict.fromkeys(("speed", "acceleration", "angular_speed", "angular_acceleration"), 1.0)
    with pytest.raises(ValueError, match=r"^breaks (is|has) "):
        Bounded(Fixed(Pose.identity()), **told, breaks=breaks)
    assert list(Bounded(Fixed(Pose.identity()), **told).breaks(0.0, 1.0)) == []


def test_a_bound_path_answers_for_every_point_and_keeps_its_breaks() -> None:
    path = Bounded(
        Fixed(Pose.identity()),
        speed=1.0,
        acceleration=2.0,
        angular_speed=3.0,
        angular_acceleration=4.0,
        breaks=[2.0, 1.0],
    )
    found = bounds_of(path, 0.0, 1.0, np.array([0.0, 0.0, 2.0]))
    assert (found.speed, found.acceleration) == (1.0 + 3.0 * 2.0, 2.0 + (4.0 + 9.0) * 2.0)
    assert list(breaks_of(path, 0.0, 2.0)) == [1.0]
    assert path.pose(5.0) is not None
    assert path.end == np.inf


def test_bad_bounds_are_refused() -> None:
    good = {"speed": 1.0, "acceleration": 1.0, "angular_speed": 1.0, "angular_acceleration": 1.0}
    with pytest.raises(TypeError, match="pose\\(t\\) and twist\\(t\\)"):
        Bounded(3.0, **good)
    with pytest.raises(ValueError, match="acceleration = -1"):
        Bounded(Fixed(Pose.identity()), **{**good, "acceleration": -1.0})
    with pytest.raises(TypeError, match="wrap it in standoff"):
        bounds_of(object(), 0.0, 1.0, np.zeros(3))
