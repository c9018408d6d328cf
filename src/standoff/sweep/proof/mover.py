"""How far a body moves in a cell of its parameters, and what that takes from a bound.

Turns add to a body's support along a normal n. Seen from the body, n turns by an angle of at most
δ. With R a bound on the distance of the core's points from the origin, about which the body turns,
and s <= R its support along n, that is at most s cos δ + √(R² - s²) sin δ - s, or R - s where
s >= R cos δ: no point of the core is beyond the ball, nor beyond the plane of the support.

A turn by θ about an axis at the angle α from n turns n by 2 asin(sin(θ/2) sin α). Of several turns
the angles add up: let v be n after those before, in the middle, and v' anywhere else. The turn T'
leaves the angle of T'v' and T'v as it is, and T'v differs from Tv by that of the turn at v.
The support of the witness point stands for s: it is not greater, and what is taken falls with s.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from standoff.bodies.body import Body
from standoff.impact.moment import Box
from standoff.kernels.body import layout as L
from standoff.motion import Pose
from standoff.sweep.parameters import SHIFTS, TURNS, Parameter, turned_by
from standoff.sweep.proof.extent import farthest
from standoff.sweep.proof.growth import Growth
from standoff.sweep.proof.tolerances import SQUARE_ROUNDINGS
from standoff.sweep.subjects.shaped_body import ShapedBody
from standoff.typing import Array

EPS = float(np.finfo(np.float64).eps)

TOGETHER = -1
"""Of all turns of a body together."""


class PlacedBody(NamedTuple):
    """A convex body, or a piece of one, and where it is where all parameters are zero.

    Attributes
    ----------
    name : str
        That parameters move it by.
    body : Body
    home : Pose
        In the world.
    shaped : ShapedBody, optional
        What makes it for its numbers, where parameters change its shape.
    """

    name: str
    body: Body
    home: Pose
    shaped: ShapedBody | None = None


class Mover:
    """A body, and the parameters that move it and change its shape.

    Raises StandoffError: parameters of its shape of which the bodies do not nest.

    Parameters
    ----------
    placed : PlacedBody
    parameters : sequence of Parameter
        Its own and others.

    Attributes
    ----------
    body : Body
        The largest, of one whose shape changes; `far`, `box` and `radius` are of that one.
    growth : Growth or None
        Of one whose shape changes.
    """

    def __init__(self, placed: PlacedBody, parameters: Sequence[Parameter]) -> None:
        self.name, self.body, self.home_pose, shaped = placed
        self.growth = None if shaped is None else Growth(shaped, parameters)
        if self.growth is not None:
            self.body = self.growth.largest
        own = [(k, p) for k, p in enumerate(parameters) if p.moves == self.name]
        self.shifts = [(k, SHIFTS.index(p.what)) for k, p in own if p.what in SHIFTS]
        self.turns = [(k, TURNS.index(p.what)) for k, p in own if p.what in TURNS]
        self.home = self.home_pose.rotation
        self.box = Box(self.body)
        self.radius = float(self.body.reals[L.RADIUS])
        self.far = farthest(self.body) if self.turns else 0.0

    @property
    def size(self) -> float:
        """Lengths that take part in a point's place, in all."""
        return self.far + self.radius + self.box.reach + float(np.abs(self.box.middle).sum())

    def moved(self, half: Array) -> tuple[Array, dict[int, Array]]:
        """Return how far a point of the body moves at most, and by each parameter alone."""
        alone = {k: half[:, k] for k, _ in self.shifts}
        square, angle = np.zeros(len(half)), np.zeros(len(half))
        for k, _ in self.shifts:
            square = square + half[:, k] * half[:, k]
        for k, _ in self.turns:
            alone[k] = self._chord(half[:, k])
            angle = angle + half[:, k]
        return np.sqrt(square) + self._chord(angle), alone

    def _chord(self, angle: Array) -> Array:
        chord: Array = 2.0 * self.far * np.sin(np.minimum(angle, np.pi) / 2.0)
        return chord

    def given_up(
        self,
        outward: Array,
        point: Array,
        at: Array,
        half: Array,
        radius: Array | None = None,
    ) -> dict[int, Array]:
        """Return what each parameter by itself takes from a bound along a normal, and what all
        turns take together.

        Parameters
        ----------
        outward : (n, 3) array
            The normal, away from the body.
        point : (n, 3) array
            Of the body's surface, from the body's origin; world axes.
        at, half : (n, columns) arrays
            Middles and half sides; of angles, rad.
        radius : (n,) array, optional
            Of the balls swept over the cores of the bodies that were asked, if not `radius`.
        """
        taken = {k: np.abs(outward[:, axis]) * half[:, k] for k, axis in self.shifts}
        if self.turns:
            angle, alone = self.turned(outward, at, half)
            support = np.sum(outward * point, axis=1) - (self.radius if radius is None else radius)
            taken |= {k: self.taken(support, own) for k, own in alone.items()}
            taken[TOGETHER] = self.taken(support, angle)
        return taken

    def turned(self, normal: Array, at: Array, half: Array) -> tuple[Array, dict[int, Array]]:
        """Return by which angle n, seen from the body, turns at most, and for each turn by itself.

        Parameters
        ----------
        normal : (n, 3) array
            World.
        at, half : (n, columns) arrays
            Middles and half sides, rad.
        """
        seen = normal @ self.home
        whole, alone = np.zeros(len(at)), {}
        for k, axis in self.turns:
            left = np.maximum(0.0, 1.0 - seen[:, axis] * seen[:, axis])
            across = np.sqrt(left + SQUARE_ROUNDINGS * EPS)
            sine = np.sin(np.minimum(half[:, k], np.pi) / 2.0)
            alone[k] = 2.0 * np.arcsin(np.minimum(1.0, sine * across))
            whole = whole + alone[k]
            seen = turned_by(seen, axis, at[:, k])
        return whole, alone

    def taken(self, support: Array, angle: Array) -> Array:
        """Return what a turn of n by an angle adds to the support at most."""
        s = np.clip(support, -self.far, self.far)
        square = np.sqrt((self.far - s) * (self.far + s))
        angle = np.minimum(angle, np.pi)
        more = s * np.cos(angle) + square * np.sin(angle) - s
        added: Array = np.where(s >= self.far * np.cos(angle), self.far - s, more)
        return added
