"""How far below their chord the separations of two instants can sag between them.

Let x be any point fixed in A, y one of B, z = y - x, n0 and n1 the unit normals at the times t0 and
t1 with n0·z(t0) >= L0 and n1·z(t1) >= L1 for all x, y. At t = t0 + λ (t1 - t0) take
n = (1-λ) n0 + λ n1. Each point's way differs from its chord by at most ½ λ(1-λ) (t1-t0)² times its
greatest acceleration along n, and |n| <= 1, so that

    n·z(t) >= (1-λ) L0 + λ L1 - λ(1-λ) S,
    S = max (n1 - n0)·(z(t1) - z(t0)) + ½ (t1 - t0)² max (|x''| + |y''|).

The acceleration of a point of a body on a screw has no part along the screw's axis, which leaves
|n × axis| of it. The maximum over x and y in the bodies' boxes is a sum of three absolute values a
body. As the distance is at least n·z/|n|, the bodies are apart in between if the right-hand side is
positive: for L0, L1 > 0 if and only if S < (√L0 + √L1)². Both terms of S are of second order in
t1 - t0.

Where one body is a half-space, n is its own normal and everything is seen from it: then
n1 - n0 = 0, and the accelerations are those relative to its turning frame.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from standoff.impact.moment import Box, Moment
from standoff.motion.bounds import MotionBounds, bounds_of
from standoff.motion.vectors import cross, length
from standoff.typing import Array

STALE = 4.0
"""Bounds on the motion are taken anew where they hold for an interval this many times as long."""


class Chords:
    """Bounds the sag of one pair on two paths, within a piece of time without a break."""

    def __init__(self, boxes: tuple[Box, Box], paths: tuple[Any, Any]) -> None:
        self.boxes, self.paths = boxes, paths
        self.first, self.last = 0.0, -1.0

    def prepare(self, start: Moment, last: float) -> None:
        """Make the bounds those of the time from a moment to `last`, or of little more."""
        within = self.first <= start.time and last <= self.last
        if within and self.last - self.first <= STALE * (last - start.time):
            return
        self.first, self.last = start.time, last
        self.bounds = tuple(
            bounds_of(path, start.time, last, point)
            for path, point in zip(self.paths, start.points, strict=True)
        )
        self.speed = sum(
            bound.speed + bound.angular_speed * box.reach
            for bound, box in zip(self.bounds, self.boxes, strict=True)
        )

    def sag(self, start: Moment, end: Moment, balls: bool) -> float:
        """S between two moments in `prepare`'s time: of the bodies, or of their bounding balls."""
        span = end.time - start.time
        bend = 0.5 * span * span
        ends = start.ball if balls else start, end.ball if balls else end
        normals = ends[0].normal, ends[1].normal
        if self.boxes[0].plane or self.boxes[1].plane:
            return bend * self._seen_from_plane(normals, balls)
        acceleration = sum(
            _along(bound, normals) * (bound.acceleration + _turning(bound) * (0.0 if balls else r))
            for bound, r in zip(self.bounds, (box.reach for box in self.boxes), strict=True)
        )
        way = (end.b.centre - start.b.centre) - (end.a.centre - start.a.centre)
        turn = normals[1] - normals[0]
        total = float(turn @ way) + bend * acceleration
        if not balls:
            # R changes by R1 - R0; the greatest turn·(R1 - R0)(x - middle) over a box
            for box, before, after in (
                (self.boxes[0], start.a.rotation, end.a.rotation),
                (self.boxes[1], start.b.rotation, end.b.rotation),
            ):
                total += float(np.abs(turn @ (after - before)) @ box.half)
        return total

    def first_sag(self, start: Moment, balls: bool) -> float:
        """A guess of S over the square of the span [length/s²], before any was seen."""
        spread = abs(start.ball.lower) + sum(box.reach for box in self.boxes)
        total = sum(bound.acceleration for bound in self.bounds)
        if not balls:
            bounds = zip(self.bounds, self.boxes, strict=True)
            total += sum(_turning(bound) * box.reach for bound, box in bounds)
        return 0.5 * total + (self.speed**2 / spread if spread > 0.0 else 0.0)

    def _seen_from_plane(self, normals: tuple[Array, Array], balls: bool) -> float:
        """Acceleration of the other body's points in the half-space's frame.

        With z from the half-space's own point that was beside the body at the start of the bounds,
        it is z'' - α × z - 2 ω × z' + ω × (ω × z).
        """
        k = 0 if self.boxes[0].plane else 1
        wall, other = self.bounds[k], self.bounds[1 - k]
        reach = 0.0 if balls else self.boxes[1 - k].reach
        own = other.acceleration + _turning(other) * reach
        if wall.angular_speed == 0.0:  # the normal is the same all the time
            return _along(other, normals) * own + _along(wall, normals) * wall.acceleration
        speed = wall.speed + other.speed + other.angular_speed * reach
        away = reach + (self.last - self.first) * speed
        turning = _turning(wall) * away + 2.0 * wall.angular_speed * speed
        return own + wall.acceleration + turning


def _turning(bound: MotionBounds) -> float:
    return bound.angular_acceleration + bound.angular_speed**2


def _along(bound: MotionBounds, normals: tuple[Array, Array]) -> float:
    """The part of the accelerations that can lie along a direction between two unit normals."""
    if bound.axis is None:
        return 1.0
    return min(1.0, max(length(cross(bound.axis, normal)) for normal in normals))
