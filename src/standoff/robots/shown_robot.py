"""What the live page shows of a robot: a configuration, or a path with what is proven of it."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from standoff.checks.real_numbers import shape_of, shown
from standoff.errors import StandoffError, StandoffTypeError
from standoff.robots.joints import SINGLE, JointKind, Joints
from standoff.robots.path_kinds import JointPath
from standoff.robots.paths import joint_path
from standoff.robots.proof import PathProof
from standoff.robots.robot_model import RobotModel
from standoff.typing import Array
from standoff.view.moving_world import MovingWorld

FRAME = 0.04
"""Time between two frames of a path [s]: the page looks as often."""

FRAMES = 100, 2000
"""Fewest and most frames of a path: a short one is played slowly, and a long one is tracked before
the page opens."""


class Slider(NamedTuple):
    """A joint that a slider moves.

    Attributes
    ----------
    name : str
    q_at : int
        Its first number in a configuration.
    circle : bool
        It has two there, (cos, sin).
    low, high : float
        Ends of the slider, rad or length.
    """

    name: str
    q_at: int
    circle: bool
    low: float
    high: float

    def read(self, q: Array) -> float:
        """Where a configuration has it."""
        if self.circle:
            return math.atan2(q[self.q_at + 1], q[self.q_at])
        return float(q[self.q_at])

    def put(self, q: Array, value: float) -> Array:
        """The configuration with the joint elsewhere, no farther than the slider goes."""
        found, value = q.copy(), min(max(value, self.low), self.high)
        if self.circle:
            found[self.q_at : self.q_at + 2] = math.cos(value), math.sin(value)
        else:
            found[self.q_at] = value
        return found


class ShownRobot(NamedTuple):
    """A robot as the page shows it.

    Attributes
    ----------
    robot : RobotModel
    path : JointPath or None
        None: it stands.
    first : (nq,) array
        Where it is at first.
    sliders : tuple of Slider
    world : MovingWorld
        Its bodies.
    proof : PathProof or None
    """

    robot: RobotModel
    path: JointPath | None
    first: Array
    sliders: tuple[Slider, ...]
    world: MovingWorld
    proof: PathProof | None

    def at(self, time: float) -> Array:
        """The configuration at a time of the path [s]."""
        return self.first if self.path is None else self.path.at(np.array([time]))[0]


def shown_robot(robot: RobotModel, what: Any, times: Any, proof: PathProof | None) -> ShownRobot:
    """Read what is to be shown.

    Raises StandoffError as of `view.view`.
    """
    shape = shape_of(what)
    path = None
    if shape is not None and len(shape) == 1:
        if times is not None or proof is not None:
            name = "times" if times is not None else "proof"
            raise StandoffError(f"{name}: of a path only, and this is one configuration.", name)
        Q, moments = robot.kinematics.check(what)[None], np.zeros(1)
    else:
        path = joint_path(what, robot.kinematics, times)
        _check_proof(proof, path)
        moments = _frames(path)
        Q = path.at(moments)
    kinematics = robot.kinematics

    def poses(time: float) -> Array:
        q = Q[0] if path is None else path.at(np.array([time]))[0]
        return kinematics.poses(q)

    world = MovingWorld(robot.world, robot.loaded.source, "", moments, poses)
    sliders = _sliders(robot.joints, Q, robot._horizons.size())
    return ShownRobot(robot, path, Q[0], sliders, world, proof)


def _check_proof(proof: Any, path: JointPath) -> None:
    if proof is None:
        return
    if not isinstance(proof, PathProof):
        raise StandoffTypeError(
            f"proof = {shown(proof)}: give what robot.certify returned.", "proof", proof
        )
    if (proof.start, proof.end) != (path.start, path.end):
        raise StandoffError(
            f"The proof is of a path from {proof.start:g} to {proof.end:g} s, and this one is from "
            f"{path.start:g} to {path.end:g} s: give the proof of this path.",
            "proof",
            proof,
        )


def _frames(path: JointPath) -> Array:
    wanted = math.ceil(min((path.end - path.start) / FRAME, FRAMES[1]))
    return np.linspace(path.start, path.end, max(wanted, FRAMES[0]) + 1)


def _sliders(joints: Joints, Q: Array, size: float) -> tuple[Slider, ...]:
    """One for each number of q that is an angle or a length; its limits, and all that is shown."""
    found: dict[int, Slider] = {}
    # A joint that mimics another has that one's number: it is named by the one that it follows.
    for j in (j for j in range(len(joints.names)) if j not in joints.mimics):
        kind, k = JointKind(joints.kinds[j]), int(joints.q_at[j])
        if kind is JointKind.CONTINUOUS:
            found.setdefault(k, Slider(joints.names[j], k, True, -math.pi, math.pi))
        if kind not in SINGLE:
            continue
        reach = math.pi if kind is JointKind.HINGE else size
        low, high = float(joints.lower[k]), float(joints.upper[k])
        if math.isinf(low):
            low = -reach if math.isinf(high) else high - 2.0 * reach
        if math.isinf(high):
            high = max(low, -reach) + 2.0 * reach
        low, high = min(low, float(Q[:, k].min())), max(high, float(Q[:, k].max()))
        if low < high:
            found[k] = Slider(joints.names[j], k, False, low, high)
    return tuple(found[k] for k in sorted(found))
