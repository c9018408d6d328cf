"""The pair at one instant: its poses, its bounding balls and, where asked, its certified bound."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from standoff.bodies.planes import outer_plane
from standoff.impact.tolerances import POSE_ROUNDINGS, TIME_ROUNDINGS
from standoff.kernels.body import layout as L
from standoff.motion import Pose
from standoff.motion.bounds import bounds_of
from standoff.motion.vectors import cross, length
from standoff.tracking.inputs import flat_pose, flat_twist
from standoff.tracking.proximity import Proximity
from standoff.tracking.state import TrackerState
from standoff.tracking.tracker import Tracker
from standoff.typing import Array

EPS = float(np.finfo(np.float64).eps)


class BodyAtInstant:
    """A body at an instant: pose (R, p), the world position and velocity of its box's centre."""

    __slots__ = ("centre", "p", "pose", "rotation", "twist", "velocity")

    def __init__(self, middle: Array, path: Any, time: float) -> None:
        self.pose, self.twist = Pose.of(path.pose(time)), path.twist(time)
        flat = flat_pose(self.pose)
        self.rotation, self.p = flat[:9].reshape(3, 3), flat[9:]
        arm = self.rotation @ middle
        self.centre = arm + self.p
        twist = flat_twist(self.twist, self.pose)
        self.velocity = twist[:3] + cross(twist[3:], arm)


class BodyBox:
    """The box around a body's core, or a solid, in body axes.

    Attributes
    ----------
    middle : (3,) array
        Its centre; a half-space's is its plane's point nearest to the origin of its frame.
    half : (3,) array
        Half its sides, with the body's slack; 0 for a half-space, which has no box.
    radius : float
        Swept radius of the body; of a half-space with its slack.
    reach : float
        Radius of the ball about ``middle`` that holds the core.
    plane : bool
        Is it a half-space?
    normal : (3,) array
        Outward, of a half-space only.
    """

    def __init__(self, body: Any) -> None:
        self.plane = not body.bounded
        self.radius = 0.0
        self.middle, self.half = np.zeros(3), np.zeros(3)
        if self.plane:
            # its middle is the plane's point nearest to its origin: it stands off by its offset
            self.normal, offset = outer_plane(body)
            self.middle = offset * self.normal
            self.radius = float(body.reals[L.RADIUS] + body.reals[L.SLACK])
        elif hasattr(body, "outline"):  # a planar solid
            low, high = body.outline.low, body.outline.high
            self.middle = np.append(0.5 * (low + high), 0.0)
            self.half = np.append(0.5 * (high - low) + body.slack, 0.0)
        else:
            reals = getattr(body, "boundary", body).reals
            self.middle = reals[L.BOX_CENTRE : L.BOX_CENTRE + 3]
            self.half = reals[L.BOX_HALF : L.BOX_HALF + 3] + reals[L.SLACK]
            self.radius = float(reals[L.RADIUS])
        self.reach = length(self.half)


class BallBound:
    """The distance of two bounding balls: a bound that needs no query."""

    __slots__ = ("lower", "normal", "rate")

    def __init__(self, boxes: tuple[BodyBox, BodyBox], a: BodyAtInstant, b: BodyAtInstant) -> None:
        between = b.centre - a.centre
        if boxes[0].plane:
            self.normal = a.rotation @ boxes[0].normal
        elif boxes[1].plane:
            self.normal = -(b.rotation @ boxes[1].normal)
        else:
            apart = length(between)
            self.normal = between / apart if apart > 0.0 else np.array([1.0, 0.0, 0.0])
        self.lower = float(self.normal @ between) - sum(box.reach + box.radius for box in boxes)
        self.rate = float(self.normal @ (b.velocity - a.velocity))


class PairInstant:
    """The pair at one instant; the tracker is asked by `ask`, from the state of an earlier one."""

    def __init__(self, boxes: tuple[BodyBox, BodyBox], paths: tuple[Any, Any], time: float) -> None:
        self.time = time
        self.a = BodyAtInstant(boxes[0].middle, paths[0], time)
        self.b = BodyAtInstant(boxes[1].middle, paths[1], time)
        self.ball = BallBound(boxes, self.a, self.b)
        self.points = self._points(boxes)
        self._round(boxes, paths)
        self.state: TrackerState | None = None
        self.lower, self.upper = -math.inf, math.inf
        self.rate = math.nan

    def _round(self, boxes: tuple[BodyBox, BodyBox], paths: tuple[Any, Any]) -> None:
        """Find what rounding of the poses and of time may do to a separation (length)."""
        bounds = [
            bounds_of(path, self.time, self.time, point)
            for path, point in zip(paths, self.points, strict=True)
        ]
        composed = sum(bound.lengths for bound in bounds)
        far = [length(x) for x in (self.a.p, self.b.p, self.a.centre, self.b.centre)]
        speed = 0.0
        for bound, box in zip(bounds, boxes, strict=True):
            far.append(box.reach)
            speed += bound.speed + bound.angular_speed * box.reach
        self.rounding = EPS * (
            POSE_ROUNDINGS * (sum(far) + composed) + TIME_ROUNDINGS * abs(self.time) * speed
        )
        # where no length went in the poses are the given ones
        self.doubt = self.rounding if composed > 0.0 else 0.0

    def _points(self, boxes: tuple[BodyBox, BodyBox]) -> list[Array]:
        """The point of each body whose motion counts, in its coordinates: the box's centre.

        Of a half-space it is the point of its frame that is beside the other body.
        """
        placed = self.a, self.b
        return [
            placed[k].rotation.T @ (placed[1 - k].centre - placed[k].p) if box.plane else box.middle
            for k, box in enumerate(boxes)
        ]

    @property
    def asked(self) -> bool:
        """Has the tracker been asked here?"""
        return self.state is not None

    @property
    def proximity(self) -> Proximity:
        """The tracker's answer, after `ask`."""
        assert self.state is not None
        return self.state.proximity

    @property
    def normal(self) -> Array:
        """The direction along which the bodies are ``lower`` apart, after `ask`."""
        return self.proximity.normal

    def ask(self, tracker: Tracker, before: PairInstant | None) -> None:
        """Ask the tracker: from the earlier moment, or anywhere without one."""
        poses = self.a.pose, self.b.pose
        twists = self.a.twist, self.b.twist
        if before is None or before.state is None:
            self.state = tracker.start(*poses, *twists)
        else:
            since = self.time - before.time
            self.state = tracker.step(before.state, *poses, *twists, dt=since)[0]
        answer = self.state.proximity
        self.lower, self.upper = answer.lower_bound, answer.upper_bound
        self.rate = answer.rate
