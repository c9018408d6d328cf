"""Functions of time as paths: their poses, their differentiation and its order, what is refused."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from test_paths import PATHS

from standoff.motion import (
    Bounded,
    Carried,
    Fixed,
    Offset,
    Path,
    Pose,
    PoseFunction,
    PoseSamples,
    Screw,
    Twist,
)

SMOOTH = [name for name in PATHS if "samples" not in name]
SCREW = Screw(Pose.exp([0.7, -0.5, 0.9], [1.0, 2.0, 3.0]), (1, -2, -0.5), (0.5, 0, -1), 1.3, 0.7)


def error(path: PoseFunction, exact: Path, t: float) -> float:
    found, known = path.twist(t), exact.twist(t)
    return float(np.abs(np.append(found.v - known.v, found.omega - known.omega)).max())


@pytest.mark.parametrize("name", SMOOTH)
@given(t=st.floats(0.0, 3.0))
def test_the_twist_is_the_derivative_of_the_pose(name: str, t: float) -> None:
    exact = PATHS[name]
    path = PoseFunction(lambda s: exact.pose(s).matrix)
    assert isinstance(path, Path)
    np.testing.assert_array_equal(path.pose(t).matrix, exact.pose(t).matrix)
    assert error(path, exact, t) < 1e-10


@pytest.mark.parametrize(("at", "factor"), [(1.0, 1 / 30), (0.0, 1 / 5), (2.0, 1 / 5)])
def test_the_difference_is_of_fourth_order(at: float, factor: float) -> None:
    """Off by step⁴ times the fifth derivative over 30, and over 5 at an end."""

    def swinging(t: float) -> tuple[Any, Any]:
        return np.eye(3), [math.exp(3.0 * t), 0.0, 0.0]

    for step in (0.02, 0.01):
        path = PoseFunction(swinging, start=0.0, end=2.0, step=step)
        off = abs(path.twist(at).v[0] - 3.0 * math.exp(3.0 * at))
        assert off == pytest.approx(factor * step**4 * 3.0**5 * math.exp(3.0 * at), rel=0.2)


@given(
    st.floats(-3.0, 3.0),
    st.floats(1e-6, 5.0),
    st.floats(0.0, 1.0),
    st.floats(1e-4, 0.3),
)
def test_no_time_outside_is_asked_for(start: float, span: float, part: float, step: float) -> None:
    end, asked = start + span, []

    def guarded(t: float) -> Pose:
        assert start <= t <= end
        asked.append(t)
        return SCREW.pose(t)

    t = min(start + part * span, end)
    path = PoseFunction(guarded, start=start, end=end, step=step)
    path.twist(t)
    assert t in asked
    assert len(set(asked)) == 5
    assert max(asked) - min(asked) <= 4.001 * step


@pytest.mark.parametrize(("start", "t", "step"), [(0.1, 0.7, 0.3), (0.2, 0.74, 0.27)])
def test_no_rounding_leads_outside(start: float, t: float, step: float) -> None:
    assert t - 2 * step < start
    assert (t - start) / step >= 2.0

    def guarded(s: float) -> Pose:
        assert start <= s
        return SCREW.pose(s)

    PoseFunction(guarded, start=start, step=step).twist(t)


def test_outside_its_times_a_function_still_answers() -> None:
    path = PoseFunction(SCREW.pose, start=0.0, end=1.0)
    for t in (-0.5, -1e-4, 1.0001, 7.0):
        assert error(path, SCREW, t) < 1e-10


@pytest.mark.parametrize("frame", ["world", "body"])
def test_a_twist_of_its_own_is_taken(frame: Any) -> None:
    def twist(t: float) -> Twist:
        return Twist([t, 0.0, 1.0], [0.0, t, 2.0], frame)

    path = PoseFunction(SCREW.pose, twist)
    expected = twist(0.3).in_world(SCREW.pose(0.3))
    np.testing.assert_array_equal(path.twist(0.3).v, expected.v)
    np.testing.assert_array_equal(path.twist(0.3).omega, expected.omega)
    assert path.twist(0.3).frame == "world"
    assert PoseFunction(SCREW.pose, lambda t: (t, 0, 0, 0, 0, 1)).twist(0.5).v[0] == 0.5


def test_rounded_poses_are_repaired_and_carry_the_mark() -> None:
    path = PoseFunction(lambda t: SCREW.pose(t).matrix.astype(np.float32))
    assert path.pose(0.3).repaired
    assert not PoseFunction(SCREW.pose).pose(0.3).repaired


def test_far_from_zero_the_clock_is_too_coarse_for_a_difference() -> None:
    assert error(PoseFunction(SCREW.pose), SCREW, 1e6) < 1e-6
    with pytest.raises(
        ValueError, match=r"times .* s apart around t = 10000000000000\.0 are not distinct"
    ):
        PoseFunction(lambda t: Pose.identity()).twist(1e13)
    still = PoseFunction(lambda t: Pose.identity(), lambda t: Twist.zero())
    assert not still.twist(1e13).v.any()


def test_paths_of_other_paths_take_functions() -> None:
    bounds = dict.fromkeys(
        ("speed", "acceleration", "angular_speed", "angular_acceleration"), 100.0
    )
    for path, exact in (
        (Offset(SCREW.pose, SCREW.pose(1.0)), Offset(SCREW, SCREW.pose(1.0))),
        (Carried(SCREW.pose, SCREW.pose), Carried(SCREW, SCREW)),
        (Bounded(SCREW.pose, **bounds), SCREW),
    ):
        assert path.start == 0.0
        np.testing.assert_array_equal(
            Pose.of(path.pose(0.7)).matrix, Pose.of(exact.pose(0.7)).matrix
        )
        assert error(path, exact, 0.7) < 1e-9  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("given", "error_kind", "message"),
    [
        ({"pose": 3.0}, TypeError, r"pose is 3\.0: give a function of the time"),
        ({"twist": np.zeros(6)}, TypeError, r"twist is .*: give a function of the time"),
        ({"step": 0.0}, ValueError, r"step = 0\.0: must be positive"),
        ({"step": math.nan}, ValueError, "step = nan"),
        ({"start": math.nan}, ValueError, "start = nan"),
        ({"start": 1.0, "end": 1.0}, ValueError, "the end must come after the start"),
        ({"start": 2.0, "end": -math.inf}, ValueError, "the end must come after the start"),
    ],
)
def test_bad_input_is_refused(given: Any, error_kind: Any, message: str) -> None:
    with pytest.raises(error_kind, match=message):
        PoseFunction(**{"pose": SCREW.pose, **given})


@pytest.mark.parametrize("given", [Fixed, float, 3.0, None, "path", PoseSamples])
def test_what_is_neither_path_nor_function_is_refused(given: Any) -> None:
    with pytest.raises(
        TypeError, match=r"is not a path: it needs pose\(t\) and twist\(t\), or to be"
    ):
        Offset(given, SCREW.pose(0.0))


def test_what_the_function_returns_is_named_with_its_time() -> None:
    with pytest.raises(ValueError, match=r"at t = 0\.25: not a pose: .*give a Pose"):
        PoseFunction(lambda t: None).pose(0.25)  # type: ignore[arg-type, return-value]
    with pytest.raises(ValueError, match=r"at t = 0\.25: not a twist: .*give a Twist"):
        PoseFunction(SCREW.pose, lambda t: np.zeros(5)).twist(0.25)
    with pytest.raises(ValueError, match="t = nan"):
        PoseFunction(SCREW.pose).pose(math.nan)
