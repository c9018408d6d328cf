"""Pairs on motions whose first contact is known: built backward from the instant of contact.

At ``time`` the bodies are placed by their support points along a unit vector n, ``gap`` apart. With
the separation s(t, n) = n·p_B - n·p_A - h_A(n) - h_B(-n), h the support about each origin:

- "closing": s(t, n) falls faster than turning can change h, so s(t, n) > s(time, n) before.
- "passing": B slides across n and both turn about axes along n: s(t, n) is constant, and the
  distance, never less than that, equals it at ``time``.
- "swinging": B, without turning, goes along a circle whose lowest point over A is at ``time``.
- "free": any constant twists with which the bodies close at ``time``; that they are apart before
  is only sampled, by `apart_before`.

So the clearance ``gap`` is reached at ``time`` in all of them, and first there in the first three.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

import standoff as so
from families.shapes import SOLIDS, Maker, Twin, half_space, loop
from oracles.exact_pairs import ExactPair, exact_pair
from oracles.poses import size_of
from standoff.motion import ConstantTwist, Frame, Helix, Offset, Path
from standoff_studies.oracles import HalfSpace, unit

Array = NDArray[Any]
Rng = np.random.Generator

OFFSETS = (0.0, 1e-9, -1e-9, 1e-6, -1e-6, 1e-3, -1e-3)
"""Grazing: how far beyond the clearance the least distance lies, over the pair's size."""

GRAZING_SLACK = 1e-6
"""Part of the duration: sqrt(1e-15) or so over a curvature, what rounding does to a grazing one."""


@dataclass(frozen=True)
class ImpactCase:
    """Two bodies on paths, and when they are ``clearance`` + ``beyond`` apart."""

    kind: str
    a: Twin
    b: Twin
    path_a: Path
    path_b: Path
    time: float
    duration: float
    clearance: float
    beyond: float
    normal: Array
    slack: float
    """What rounding of the poses may do to ``time`` [s]; inf for a grazing one."""

    def describe(self) -> str:
        return (
            f"{self.kind}: {self.a.body!r} and {self.b.body!r}, time {self.time!r}, clearance "
            f"{self.clearance!r}, beyond {self.beyond!r}"
        )


def draw_twins(rng: Rng) -> tuple[Twin, Twin]:
    """Return two bodies: mostly solids, some over a half-space, some planar."""
    kind = rng.random()
    if kind < 0.1:
        return loop(rng), loop(rng)
    first: Maker = SOLIDS[rng.integers(len(SOLIDS))]
    if kind < 0.2:
        solids = [solid for solid in SOLIDS if solid.__name__ != "point"]
        pair = solids[rng.integers(len(solids))](rng), half_space(rng)
        return pair if rng.random() < 0.5 else (pair[1], pair[0])
    return first(rng), SOLIDS[rng.integers(len(SOLIDS))](rng)


def draw_case(kind: str, a: Twin, b: Twin, rng: Rng) -> ImpactCase:
    """Return one case of a pair."""
    size = size_of(a.shape, b.shape) or 1.0
    clearance = 0.0 if rng.random() < 0.5 else float(size * 10.0 ** rng.uniform(-6, 0))
    beyond = 0.0
    if kind in ("passing", "swinging"):
        beyond = float(size * OFFSETS[rng.integers(len(OFFSETS))])
        if clearance + beyond < 0.0:  # in penetration n need not be the best direction
            clearance = -10.0 * beyond
    pair = exact_pair(a.shape, b.shape, clearance + beyond, rng)
    time = float(rng.uniform(0.5, 2.0))
    flat = a.shape.dimension == 2
    if kind == "closing":
        path_a, path_b, speed = _closing(pair, size, time, flat, rng)
    elif kind == "passing":
        path_a, path_b = _passing(pair, size, time, flat, rng)
        speed = 0.0
    elif kind == "swinging":
        path_a, path_b = _swinging(pair, size, time, rng)
        speed = 0.0
    else:
        path_a, path_b, speed = _free(pair, size, time, flat, rng)
    places = np.abs([path.pose(time).translation for path in (path_a, path_b)]).max()
    slack = 1e-14 * ((size + places + clearance) / speed + time) if speed else np.inf
    return ImpactCase(
        kind, a, b, path_a, path_b, time, 1.5 * time, clearance, beyond, pair.normal, float(slack)
    )


def _vector(size: float, flat: bool, rng: Rng) -> Array:
    v = rng.normal(size=3) * size
    return v * [1.0, 1.0, 0.0] if flat else v


def _spin(rate: float, flat: bool, rng: Rng) -> Array:
    omega = rng.normal(size=3) * rate
    return omega * [0.0, 0.0, 1.0] if flat else omega


def _backward(pose: Any, twist: so.Twist, time: float) -> ConstantTwist:
    """The path with that twist that is at the pose at a time."""
    return ConstantTwist(twist.carry(so.Pose(*pose), -time), twist)


def _spins(pair: ExactPair, flat: bool, rng: Rng) -> list[Array]:
    """Angular velocities, rad/s; a half-space does not turn, as its points would have any speed."""
    rates = 10.0 ** rng.uniform(-2, 1, 2) * (rng.random(2) < 0.8)
    still = [isinstance(body.shape, HalfSpace) for body in (pair.a, pair.b)]
    return [
        np.zeros(3) if rest else _spin(rate, flat, rng)
        for rest, rate in zip(still, rates, strict=True)
    ]


def _closing(
    pair: ExactPair, size: float, time: float, flat: bool, rng: Rng
) -> tuple[Path, Path, float]:
    omegas = _spins(pair, flat, rng)
    reaches = [
        float(np.linalg.norm(np.cross(pair.normal, omega))) * body.shape.bounding_radius
        if omega.any()
        else 0.0
        for omega, body in zip(omegas, (pair.a, pair.b), strict=True)
    ]
    speed = 1.01 * sum(reaches) + size * float(10.0 ** rng.uniform(-2, 1))
    v_a = _vector(size, flat, rng)
    across = _vector(size, flat, rng)
    across -= pair.normal * (pair.normal @ across)
    v_b = v_a + across - speed * pair.normal
    twists = [so.Twist(v, w) for v, w in zip((v_a, v_b), omegas, strict=True)]
    path_a, path_b = (
        _backward(pair.pose_a, twists[0], time),
        _backward(pair.pose_b, twists[1], time),
    )
    return path_a, path_b, speed - sum(reaches)


def _passing(pair: ExactPair, size: float, time: float, flat: bool, rng: Rng) -> tuple[Path, Path]:
    across = _vector(size, flat, rng) * 10.0 ** rng.uniform(-1, 1)
    across -= pair.normal * (pair.normal @ across)
    v_a = _vector(size, flat, rng)
    rates = 10.0 ** rng.uniform(-1, 1, 2) * (rng.random(2) < 0.8) * (not flat)
    walls = [isinstance(body.shape, HalfSpace) for body in (pair.a, pair.b)]
    rates[walls] = 0.0  # its points would have any speed
    twists = [
        so.Twist(v, rate * pair.normal) for v, rate in zip((v_a, v_a + across), rates, strict=True)
    ]
    return _backward(pair.pose_a, twists[0], time), _backward(pair.pose_b, twists[1], time)


def _swinging(pair: ExactPair, size: float, time: float, rng: Rng) -> tuple[Path, Path]:
    radius = float(size * 10.0 ** rng.uniform(-1, 1))
    rate = float(rng.choice([-1.0, 1.0]) * rng.uniform(0.2, 2.0))
    if abs(rate) * 1.5 * time > 3.0:  # not a whole turn: contact would come again
        rate *= 3.0 / (abs(rate) * 1.5 * time)
    axis = np.array([0.0, 0.0, 1.0])
    if pair.a.shape.dimension == 3:
        axis = unit(np.cross(pair.normal, rng.normal(size=3))[None])[0]
    rotation, place = pair.pose_b
    centre = place + radius * pair.normal
    # a helix measures its phase from axes of its own
    first = Helix(radius, 0.0, rate, axis=axis).pose(0.0).translation
    lowest = np.arctan2(-pair.normal @ np.cross(axis, first), -pair.normal @ first)
    circle = Helix(radius, 0.0, rate, centre, axis, float(lowest) - rate * time)
    rest = ConstantTwist(so.Pose(*pair.pose_a), so.Twist.zero())
    return rest, Offset(circle, (rotation, np.zeros(3)))


def _free(
    pair: ExactPair, size: float, time: float, flat: bool, rng: Rng
) -> tuple[Path, Path, float]:
    """Twists in world or body axes; flipped where the bodies would part."""
    omegas = [0.3 * omega for omega in _spins(pair, flat, rng)]
    speeds = [_vector(size, flat, rng) for _ in omegas]
    poses, points = (pair.pose_a, pair.pose_b), (pair.point_a, pair.point_b)
    rates = [
        float(pair.normal @ (v + np.cross(omega, point - pose[1])))
        for pose, point, v, omega in zip(poses, points, speeds, omegas, strict=True)
    ]
    closing = rates[0] - rates[1]
    paths = []
    for pose, v, omega in zip(poses, speeds, omegas, strict=True):
        twist = np.copysign(1.0, closing) * np.array([v, omega])
        body_axes = rng.random() < 0.5
        frame: Frame = "body" if body_axes else "world"
        paths.append(
            _backward(pose, so.Twist(*(twist @ pose[0] if body_axes else twist), frame), time)
        )
    return paths[0], paths[1], abs(closing)


def separations(case: ImpactCase, times: Array) -> Array:
    """Return (k,) lower bounds of the distance by the oracles: the best of three directions.

    n itself, n carried by A and n carried by B.
    """
    poses = [[path.pose(t) for t in times] for path in (case.path_a, case.path_b)]
    at = [path.pose(case.time).rotation for path in (case.path_a, case.path_b)]
    best = np.full(len(times), -np.inf)
    for which in (None, 0, 1):
        normals = np.array([case.normal] * len(times))
        if which is not None:
            back = at[which].T @ case.normal
            normals = np.array([pose.rotation @ back for pose in poses[which]])
        total = np.zeros(len(times))
        for sign, twin, placed in ((1.0, case.a, poses[0]), (-1.0, case.b, poses[1])):
            inner = np.array(
                [pose.rotation.T @ (sign * n) for pose, n in zip(placed, normals, strict=True)]
            )
            if isinstance(twin.shape, HalfSpace):
                inner = np.where(
                    np.abs(inner - [0, 0, 1]).max(axis=1, keepdims=True) < 1e-9,
                    np.array([0.0, 0.0, 1.0]),
                    inner,
                )
            with np.errstate(invalid="ignore"):
                values = twin.shape.support_many(inner)[0]
            origins = np.array([pose.translation for pose in placed])
            total -= values + sign * (normals * origins).sum(axis=1)
        best = np.fmax(best, total)
    return best


def apart_before(case: ImpactCase, count: int = 24) -> bool:
    """Are the bodies farther apart than the clearance at sampled instants before the time?"""
    times = case.time * (1.0 - np.append(np.geomspace(1e-3, 1.0, count), 1e-6))
    return bool((separations(case, times) > case.clearance).all())


def judge(case: ImpactCase, found: so.impact.Impact) -> str:
    """Say what is wrong with an answer, "" if nothing is."""
    reached = case.beyond <= 0.0
    status = found.status
    # A grazing contact at exactly the clearance is at the mercy of the poses' rounding.
    slack = case.slack if math.isfinite(case.slack) else GRAZING_SLACK * case.duration
    if reached and found.time > case.time + slack:
        return f"late: {found!r}"
    if case.beyond > 0.0 and status in (
        so.impact.ImpactStatus.IMPACT,
        so.impact.ImpactStatus.AT_START,
    ):
        return f"no impact exists: {found!r}"
    return ""
