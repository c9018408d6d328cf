"""The frame that is compiled for the kinds of a pair's faces answers as the general one does."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import standoff as so
from draws import draws
from on_first_use import OnFirstUse
from shares import share
from standoff.geometry.ellipsoid_patches import ellipsoid_octants, ellipsoid_patches
from standoff.kernels.compiler.calls import CAN_CALL
from standoff.kernels.state import arrays as K
from standoff.tracking.specialised import COMPILED_AHEAD, smooth_frame_of

REST = np.eye(4)
TOOL = so.shapes.ellipsoid(0.15, 0.30, 0.20)
BOX = so.shapes.box(1.0, 0.7, 0.5)
LENS = so.shapes.lens(1.0, 0.45)
CYLINDER = so.shapes.cylinder(0.4, 0.9)
AXES = ((0.5, 0.8, 0.9), (0.15, 0.30, 0.20))


def of_degree(degree: int, axes: tuple[float, float, float]) -> so.Body:
    """An ellipsoid of NURBS patches."""
    patches = ellipsoid_patches(*axes) if degree >= 4 else ellipsoid_octants(*axes)
    return so.Body.from_patches([patch.elevated(degree, degree) for patch in patches])


AHEAD = {
    "ellipsoids": lambda: (so.shapes.ellipsoid(*AXES[0]), TOOL),
    "lens, ellipsoid": lambda: (LENS, TOOL),
    "lenses": lambda: (LENS, so.shapes.lens(0.7, 0.3)),
    "box, ellipsoid": lambda: (BOX, TOOL),
    "ellipsoid, box": lambda: (TOOL, BOX),
    **{
        f"NURBS of degree {n}": lambda n=n: (of_degree(n, AXES[0]), of_degree(n, AXES[1]))
        for n in (2, 3, 4, 5)
    },
}
ON_DEMAND = {
    "cylinder, ellipsoid": lambda: (CYLINDER, TOOL),
    "superellipsoid, ellipsoid": lambda: (
        so.shapes.superellipsoid(0.5, 0.7, 0.9, 0.6, 1.3),
        TOOL,
    ),
    "cone, ellipsoid": lambda: (so.shapes.cone(0.4, 0.8), TOOL),
    "swept lens, NURBS": lambda: (
        so.shapes.lens(1.0, 0.45, rounding=0.05),
        of_degree(3, AXES[1]),
    ),
}
PAIRS = OnFirstUse(AHEAD | ON_DEMAND)
DIGITS = 1e-14
"""Of the size: both round, not alike."""

pytestmark = pytest.mark.skipif(not CAN_CALL, reason="compiled frames are not called by address")


def motion(rng: np.random.Generator, size: float, n: int) -> Iterator[tuple[Any, Any]]:
    """B's poses and twists: on an arc round A, nearer and farther, turning with it."""
    axis, way = rng.normal(size=3), rng.normal(size=3)
    axis, way = axis / np.linalg.norm(axis), way / np.linalg.norm(way)
    rate, far = 10.0 ** rng.uniform(-3.5, -1.3), 0.6 * size * rng.uniform(0.9, 1.6)
    begin = Rotation.from_rotvec(rng.normal(size=3))
    for k in range(n):
        turn = Rotation.from_rotvec(axis * rate * k)
        out, pose = turn.apply(way), np.eye(4)
        pose[:3, :3] = (turn * begin).as_matrix()
        pose[:3, 3] = far * (1.0 - 0.3 * np.sin(3.0 * rate * k)) * out
        spin = axis * rate / 1e-3
        slide = -0.9 * far * np.cos(3.0 * rate * k) * rate / 1e-3
        yield pose, (np.cross(spin, pose[:3, 3]) + slide * out, spin)


def agree(smooth: so.Proximity, general: so.Proximity, size: float) -> None:
    """Are they the same answer, from as many evaluations?"""
    assert (smooth.status, smooth.feature_a, smooth.feature_b) == (
        general.status,
        general.feature_a,
        general.feature_b,
    )
    assert smooth.events == general.events == ()
    assert smooth.counts == general.counts
    for name in ("distance", "lower_bound", "upper_bound", "point_a", "point_b"):
        off = np.abs(np.asarray(getattr(smooth, name)) - np.asarray(getattr(general, name)))
        assert off.max() <= DIGITS * size, name
    np.testing.assert_allclose(smooth.normal, general.normal, rtol=0.0, atol=1e-12)
    for name in ("velocity_a", "velocity_b", "rate"):
        one, other = getattr(smooth, name), getattr(general, name)
        np.testing.assert_allclose(one, other, rtol=1e-8, atol=1e-8, err_msg=name)


@pytest.mark.parametrize(
    ("pair", "law"), share(2, PAIRS, [so.PredictorCorrector(), so.PredictorCorrector(deadline=3)])
)
def test_it_answers_as_the_general_frame(
    pair: str, law: so.PredictorCorrector, rng: np.random.Generator
) -> None:
    """From the same state, through faces, edges, vertices and contact; refused is bit for bit."""
    a, b = PAIRS[pair]
    quick = so.Tracker(a, b, 1e-3, law, specialise=True)
    general = so.Tracker(a, b, 1e-3, law, specialise=False)
    size, smooth = a.size + b.size, 0
    for run in range(60):
        if run >= 3 and smooth > 30:
            break
        state = None
        for pose, twist in motion(rng, size, 60):
            given = twist if run % 2 else None
            if state is None:
                state = general.start(REST, pose, None, given)
                continue
            _, one = quick.step(state, REST, pose, None, given)
            state, other = general.step(state, REST, pose, None, given)
            assert other.counts.general_frames == 0
            if one.counts.general_frames:
                refused = one.counts._replace(general_frames=0)
                assert (refused, one.distance) == (other.counts, other.distance)
                np.testing.assert_array_equal(one.point_a, other.point_a)
            else:
                smooth += 1
                agree(one, other, size)
    assert smooth > 30


EDGED = {
    "box, ellipsoid": (BOX, TOOL),
    "ellipsoid, box": (TOOL, BOX),
    "ellipsoid, wedge": (TOOL, so.shapes.polytope(np.vstack([np.eye(3), np.zeros((1, 3))]))),
    "box, cylinder": (BOX, CYLINDER),
}


@pytest.mark.parametrize("pair", EDGED)
def test_it_answers_on_straight_edges_too(pair: str, rng: np.random.Generator) -> None:
    """From one face over an edge to the next, past its ends and back."""
    a, b = EDGED[pair]
    quick = so.Tracker(a, b, 1e-3, specialise=True)
    general = so.Tracker(a, b, 1e-3, specialise=False)
    size, on_edges = a.size + b.size, 0
    for run in range(40):
        if run >= draws(8) and on_edges > 60:
            break
        state = None
        for pose, twist in motion(rng, size, 60):
            given = twist if run % 2 else None
            if state is None:
                state = general.start(REST, pose, None, given)
                continue
            _, one = quick.step(state, REST, pose, None, given)
            state, other = general.step(state, REST, pose, None, given)
            if not one.counts.general_frames:
                agree(one, other, size)
                on_edges += "edge" in (one.feature_a.kind, one.feature_b.kind)
    assert on_edges > 60


@pytest.mark.parametrize("pair", AHEAD)
def test_a_pair_of_the_list_has_it_without_asking(pair: str) -> None:
    a, b = PAIRS[pair]
    assert smooth_frame_of(a, b, None) in COMPILED_AHEAD.values()


@pytest.mark.parametrize("pair", ON_DEMAND)
def test_any_other_pair_has_it_on_demand(pair: str) -> None:
    a, b = PAIRS[pair]
    assert smooth_frame_of(a, b, None) is None
    assert smooth_frame_of(a, b, True) is not None
    assert smooth_frame_of(a, b, True) is smooth_frame_of(a, b, True)
    assert smooth_frame_of(a, b, False) is None


def test_a_body_without_faces_has_none() -> None:
    assert smooth_frame_of(so.shapes.point(), TOOL, True) is None
    assert smooth_frame_of(so.shapes.capsule(0.2, 0.5), TOOL, True) is None


def test_general_frames_are_counted_and_nothing_is_written_before_them() -> None:
    """On a box's vertex the state and the answer are those of the general frame alone."""
    tracker = so.Tracker(BOX, TOOL, 1e-3)
    pose = np.eye(4)
    pose[:3, 3] = 0.8, 0.6, 0.5
    state = tracker.start(REST, pose)
    after, answer = tracker.step(state, REST, pose)
    assert answer.feature_a.kind == "vertex"
    assert answer.counts.general_frames == 1
    other, _ = so.Tracker(BOX, TOOL, 1e-3, specialise=False).step(state, REST, pose)
    np.testing.assert_array_equal(after.data, other.data)


def test_the_papers_law_has_none() -> None:
    tracker = so.Tracker(*PAIRS["ellipsoids"], 1e-3, so.PaperLaw(gain=100.0))
    pose = np.eye(4)
    pose[0, 3] = 2.0
    _, answer = tracker.step(tracker.start(REST, pose), REST, pose)
    assert answer.counts.general_frames == 0
    assert tracker.options[K.O_SMOOTH] == 0.0


@pytest.mark.parametrize("specialise", [1, "yes", np.True_])
def test_what_is_no_choice_is_told(specialise: Any) -> None:
    with pytest.raises(TypeError, match="is neither True"):
        so.Tracker(*PAIRS["ellipsoids"], specialise=specialise)


def test_a_tracker_in_another_process_finds_its_own() -> None:
    """A pickle holds no address."""
    import pickle

    tracker = so.Tracker(*PAIRS["ellipsoids"], 1e-3)
    again = pickle.loads(pickle.dumps(tracker))
    assert again.options[K.O_SMOOTH] == tracker.options[K.O_SMOOTH] != 0.0
