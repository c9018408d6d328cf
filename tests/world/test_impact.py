"""The first time at which any pair of a world meets, against closed forms."""

import numpy as np
import pytest

import standoff as so
from standoff.impact import ImpactStatus
from standoff.motion import ConstantTwist

BALL = so.shapes.sphere(0.5)


def at(x: float, y: float = 0.0) -> np.ndarray:
    pose = np.eye(4)
    pose[:3, 3] = x, y, 0.0
    return pose


def test_the_first_of_several_impacts_with_its_pieces() -> None:
    two = so.compound({"left": BALL, "right": (BALL, at(2.0))})
    world = so.World(
        {"two": two, "near": BALL, "far": BALL, "wall": so.shapes.box((1.0, 1.0, 1.0))},
        fixed={"wall": at(20.0)},
    )
    paths = {
        "two": ConstantTwist(at(0.0), ([1.0, 0, 0], [0, 0, 0])),
        "near": at(8.0),
        "far": at(12),
    }
    found = world.time_of_impact(paths, 20.0)
    assert found.status is ImpactStatus.IMPACT
    assert found.names == ("two", "near")
    assert found.pieces == ("right", "")
    assert found.time <= 5.0
    assert found.time == pytest.approx(5.0, abs=1e-8)
    assert found.searched >= 4
    early = world.time_of_impact(paths, 20.0, clearance=1.0)
    assert early.time == pytest.approx(4.0, abs=1e-8)


def test_no_impact_and_bad_paths() -> None:
    world = so.World({"a": BALL, "b": BALL})
    paths = {"a": at(0.0), "b": ConstantTwist(at(0.0, 3.0), ([1.0, 0, 0], [0, 0, 0]))}
    found = world.time_of_impact(paths, 5.0)
    assert found.status is ImpactStatus.NO_IMPACT
    assert found.time == 5.0
    assert found.names is None
    with pytest.raises(ValueError, match="none of 'b'"):
        world.time_of_impact({"a": at(0.0)}, 5.0)
    for duration in (0.0, -1.0, np.nan):
        with pytest.raises(ValueError, match="duration"):
            world.time_of_impact(paths, duration)
    with pytest.raises(TypeError, match=r"'clearence'.*'clearance'"):
        world.time_of_impact(paths, 5.0, clearence=0.1)
    with pytest.raises(ValueError, match=r"\('a', 'b'\)"):
        world.time_of_impact(paths, 5.0, clearance=-1.0)
