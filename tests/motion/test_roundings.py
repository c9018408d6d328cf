"""What rounding does to a pose, against 50 digits: no more than the bounds' lengths allow."""

from collections.abc import Callable
from typing import Any

import mpmath
import numpy as np
import pytest

from standoff.impact.moment import EPS
from standoff.impact.tolerances import POSE_ROUNDINGS, TIME_ROUNDINGS
from standoff.motion import (
    Bounded,
    Carried,
    ConstantTwist,
    Fixed,
    Helix,
    Offset,
    Pose,
    PoseSamples,
    Screw,
    Spiral,
    Twist,
)
from standoff.motion.bounds import bounds_of

CASES = 25
Exact = tuple[Any, ...]
"""A path, its pose as a 4×4 matrix of mpmath and, if it is not the origin, where the body is."""


def exact(array: Any) -> Any:
    return mpmath.matrix(np.atleast_2d(np.asarray(array, dtype=np.float64)).tolist())


def frame(rotation: Any, place: Any) -> Any:
    matrix = mpmath.eye(4)
    for row in range(3):
        matrix[row, 3] = place[row]
        for column in range(3):
            matrix[row, column] = rotation[row, column]
    return matrix


def placed(pose: Pose) -> Any:
    return frame(exact(pose.rotation), [mpmath.mpf(float(x)) for x in pose.translation])


def exponential(omega: Any, velocity: Any) -> Any:
    """Of a twist in se(3), as a 4×4 matrix."""
    x, y, z = omega
    twist = mpmath.matrix([[0, -z, y, 0], [z, 0, -x, 0], [-y, x, 0, 0], [0, 0, 0, 0]])
    for row in range(3):
        twist[row, 3] = velocity[row]
    return mpmath.expm(twist)


def shift(place: Any) -> Any:
    return frame(mpmath.eye(3), place)


def numbers(values: Any) -> list[Any]:
    return [mpmath.mpf(float(value)) for value in values]


def unit(rng: np.random.Generator) -> Any:
    vector = rng.normal(size=3)
    return vector / np.linalg.norm(vector)


def near_pose(rng: np.random.Generator) -> Pose:
    return Pose.exp(rng.normal(size=3), unit(rng))


def world_twist(rng: np.random.Generator, arm: float, t: float) -> Exact:
    """It starts far away and comes near."""
    v, omega = unit(rng) * arm, rng.normal(size=3)
    pose = Pose.exp(rng.normal(size=3), rng.normal(size=3) - v * t)
    turn = exponential([w * t for w in numbers(omega)], [0, 0, 0])
    way = mpmath.matrix([w * t for w in numbers(v)]) + mpmath.matrix(numbers(pose.translation))
    turned = turn * frame(exact(pose.rotation), [0, 0, 0])
    return ConstantTwist(pose, (v, omega)), shift(way) * turned


def body_twist(rng: np.random.Generator, arm: float, t: float) -> Exact:
    """A screw about an axis that is far from the body's origin, and near the body."""
    pose, omega, centre = near_pose(rng), unit(rng) * 10.0, unit(rng) * arm
    v = -np.cross(omega, centre)
    twist = exponential([w * t for w in numbers(omega)], [w * t for w in numbers(v)])
    return ConstantTwist(pose, Twist(v, omega, "body")), placed(pose) * twist, centre


def screw(rng: np.random.Generator, arm: float, t: float) -> Exact:
    pose, axis, point = near_pose(rng), rng.normal(size=3), unit(rng) * arm
    rate, pitch = 1.0 / arm, rng.normal()
    along = mpmath.matrix(numbers(axis)) / mpmath.norm(mpmath.matrix(numbers(axis)))
    angle = mpmath.mpf(rate) * t
    climb = mpmath.mpf(pitch) / (2 * mpmath.pi) * angle
    turn = exponential(along * angle, along * climb)
    centre = mpmath.matrix(numbers(point))
    path = Screw(pose, axis, point, rate, pitch)
    return path, shift(centre) * turn * shift(-centre) * placed(pose)


def winding(kind: str) -> Callable[[np.random.Generator, float, float], Exact]:
    def draw(rng: np.random.Generator, arm: float, t: float) -> Exact:
        rate, phase, change = 1.0 / arm, rng.normal(), rng.normal()
        angle = mpmath.mpf(phase) + mpmath.mpf(rate) * t
        radial = np.array([float(mpmath.cos(angle)), float(mpmath.sin(angle)), 0.0])
        centre = rng.normal(size=3) - radial * arm
        cosine, sine = mpmath.cos(angle), mpmath.sin(angle)
        rotation = mpmath.matrix([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]])
        if kind == "helix":
            path: Helix | Spiral = Helix(
                arm, change, rate, centre, phase=phase, orientation="turning"
            )
            away, height = mpmath.mpf(arm), mpmath.mpf(change) / (2 * mpmath.pi) * rate * t
        else:
            centre[2] = 0.0
            path = Spiral(arm, change, rate, centre[:2], phase, "turning")
            away, height = mpmath.mpf(arm) + mpmath.mpf(change) * mpmath.mpf(rate) * t, 0
        place = mpmath.matrix(numbers(centre)) + rotation * mpmath.matrix([away, 0, height])
        return path, frame(rotation, place)

    return draw


def offset(rng: np.random.Generator, arm: float, t: float) -> Exact:
    """Fixed to a carrier whose origin is far, so that the body is near."""
    near, carrier = near_pose(rng), near_pose(rng)
    far = Pose(carrier.rotation, unit(rng) * arm)
    arms = far.inverse() @ near
    velocity = rng.normal(size=3)
    path = Offset(ConstantTwist(far, (velocity, np.zeros(3))), arms)
    return path, shift([v * t for v in numbers(velocity)]) * placed(far) * placed(arms)


def carried(rng: np.random.Generator, arm: float, t: float) -> Exact:
    velocity, far = rng.normal(size=3), Pose.exp(rng.normal(size=3), unit(rng) * arm)
    arms = far.inverse() @ near_pose(rng)
    within = ConstantTwist(arms, (velocity, np.zeros(3)))
    moved = shift([v * t for v in numbers(velocity)]) * placed(arms)
    return Carried(Fixed(far), within), placed(far) * moved


def wrapped(rng: np.random.Generator, arm: float, t: float) -> Exact:
    path, truth, *_ = offset(rng, arm, t)
    told: dict[str, float] = dict.fromkeys(("acceleration", "angular_acceleration"), 0.0)
    bounded = Bounded(path, speed=9.0, angular_speed=0.0, **told, lengths=2.0 * arm + 9.0 * abs(t))
    return bounded, truth


KINDS = {
    "world twist": world_twist,
    "body twist": body_twist,
    "screw": screw,
    "helix": winding("helix"),
    "spiral": winding("spiral"),
    "offset": offset,
    "carried": carried,
    "bounded": wrapped,
}


@pytest.mark.parametrize("draw", KINDS.values(), ids=KINDS.keys())
def test_no_pose_is_farther_off_than_its_roundings(draw: Any, rng: np.random.Generator) -> None:
    with mpmath.workdps(50):
        for _ in range(CASES):
            arm, t = float(10.0 ** rng.uniform(3, 8)), float(rng.uniform(-50.0, 50.0))
            path, truth, *far = draw(rng, arm, t)
            point = unit(rng) + sum(far)
            pose = path.pose(t)
            place = truth * mpmath.matrix([*numbers(point), 1])
            found = placed(pose) * mpmath.matrix([*numbers(point), 1])
            bounds = bounds_of(path, t, t, point)
            own = np.linalg.norm(pose.translation) + np.linalg.norm(pose.apply(point))
            lengths = POSE_ROUNDINGS * (bounds.lengths + own)
            allowed = EPS * (lengths + TIME_ROUNDINGS * abs(t) * bounds.speed)
            assert mpmath.norm(place - found) <= allowed
            # and it grows no less than the intervals do
            assert bounds_of(path, t - 1.0, t + 1.0, point).lengths >= bounds.lengths * (1 - EPS)


def test_a_pose_that_is_given_is_not_rounded() -> None:
    far, samples = Pose.exp([0.1, 0.2, 0.3], [1e6, 0.0, 0.0]), [0.0, 1.0, 3.0]
    poses = [Pose.exp([0.0, 0.0, 0.1 * k], [1e6, k, 0.0]) for k in range(3)]
    path = PoseSamples(samples, poses)
    assert bounds_of(Fixed(far), 0.0, 1.0, np.ones(3)).lengths == 0.0
    assert [bounds_of(path, t, t, np.ones(3)).lengths for t in samples] == [0.0, 0.0, 0.0]
    assert bounds_of(path, 0.5, 0.5, np.ones(3)).lengths > 2e6
    assert bounds_of(path, 0.0, 0.5, np.ones(3)).lengths > 2e6


def test_what_is_not_told_of_a_path_of_ones_own_is_its_distance() -> None:
    told = {"acceleration": 0.0, "angular_speed": 0.0, "angular_acceleration": 0.0}
    far = ConstantTwist(Pose.exp([0.0, 0.0, 0.0], [1e6, 0.0, 0.0]), ([2.0, 0, 0], [0, 0, 0]))
    path = Bounded(far, speed=2.0, **told)
    assert bounds_of(path, 1.0, 1.0, np.ones(3)).lengths == 1e6 + 2.0
    assert bounds_of(path, 1.0, 4.0, np.ones(3)).lengths == 1e6 + 8.0
    path = Bounded(far, speed=2.0, **told, lengths=3e7)
    assert bounds_of(path, 1.0, 4.0, np.ones(3)).lengths == 3e7
    with pytest.raises(ValueError, match=r"lengths = -1\.0: must be zero or positive"):
        Bounded(far, speed=2.0, **told, lengths=-1.0)
