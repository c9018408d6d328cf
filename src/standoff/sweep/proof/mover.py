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

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from standoff.bodies.body import Body
from standoff.errors import StandoffError
from standoff.impact.moment import BodyBox
from standoff.kernels.body import layout as L
from standoff.motion import Pose
from standoff.scene.shapes import SAME_SIZE
from standoff.sweep.parameters import SHIFTS, TURNS, Parameter, turned_by
from standoff.sweep.proof.extent import directions_for, farthest, supports
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
        self.box = BodyBox(self.body)
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


# Bodies that grow with their numbers: the largest and the smallest of a range, and how much they
# grow along a direction.

SIDE = 7
"""Directions along each side of a cube, as of `extent`: 294 in all, some 13 degrees apart, the axes
among them. They are for choosing what to halve, and prove nothing."""


class Growth:
    """How a body grows with the numbers of its shape.

    Raises StandoffError: a number of which the bodies do not nest.

    Parameters
    ----------
    shaped : ShapedBody
    parameters : sequence of Parameter
        All of the job.

    Attributes
    ----------
    columns : list of int
        Its own parameters.
    senses : list of float
        1 where the body of a greater number is the larger one, -1 where it is the smaller.
    largest : Body
        Of the whole range: it holds every other one, and its core the others' cores.
    """

    def __init__(self, shaped: ShapedBody, parameters: Sequence[Parameter]) -> None:
        self.columns = shaped.columns
        own = [parameters[k] for k in self.columns]
        self.senses = [_sense(shaped, p) for p in own]
        ends = [
            (p.low, p.high) if s < 0.0 else (p.high, p.low)
            for p, s in zip(own, self.senses, strict=True)
        ]
        large = [most + 0.0 for most, _ in ends]
        self.largest = shaped.made(tuple(large))
        self.directions = directions_for(self.largest, SIDE)[0]
        rates = []
        for k, (p, (_, least)) in enumerate(zip(own, ends, strict=True)):
            small = shaped.made((*large[:k], least + 0.0, *large[k + 1 :]))
            rates.append(self._grown(small) / (p.high - p.low))
        self.rates = np.array(rates)
        self.most = self.rates.max(axis=1)

    def _grown(self, small: Body) -> Array:
        """By how much the largest reaches farther than another along the directions."""
        if not self.largest.bounded:  # its own normal counts alone, along which numbers are lengths
            return np.full(len(self.directions), 1.0)
        far, near = (
            supports(body, self.directions) + float(body.reals[L.RADIUS])
            for body in (self.largest, small)
        )
        return np.maximum(0.0, far - near)

    def along(self, outward: Array) -> Array:
        """Return by how much the body reaches farther along normals (n, 3) in its own axes, for
        each unit of each of its numbers (n, k): about, and on the average over the range."""
        nearest = (outward @ self.directions.T).argmax(axis=1)
        found: Array = self.rates[:, nearest].T
        return found


def _sense(shaped: ShapedBody, parameter: Parameter) -> float:
    sense = sense_of(shaped.shape, parameter.what)
    if sense is None:
        raise StandoffError(
            f"parameters.{parameter.name}: a proof needs bodies of which the larger holds the "
            f"smaller, and those of a {shaped.shape} that differ in '{parameter.what}' do not "
            "nest: sweep it, or prove one value of it at a time",
            "job",
        )
    return sense


# Which numbers of a shape nest its bodies: of two bodies that differ in it, one holds the other.
#
# A cell of such a number is then proven by its largest body alone, and violated by its smallest.
# All of these are exact, whatever the shape's other numbers are, and hold of images under an
# `affine` or `scale` of the scene as well:
#
# - Sums with a larger ball: radii of spheres and capsules, `rounding`; a segment in a longer one.
# - The map that stretches an axis takes a body into a larger one where the body holds, with each
# point, its foot on the plane across that axis: semi-axes, sizes, lengths and heights of bodies
# that are the same on both sides of the plane. Likewise radii that stretch sections about the axis:
# of cylinders, cones, gores and eggs.
# - Intersections of larger balls, `radius` of lens and cap; a lens's balls with their centres
# farther out hold less, since the nearer centre is within the triangle of the farther ones.
# - Arcs through the same poles with more bulge, and of the same bulge with poles farther apart, lie
# farther out: spindle and gore.
# - Of a superellipsoid the exponents 2/e are those of norms, which fall as these grow.
# - A box or polytope that keeps its size is a union of balls; that of larger ones holds less.
# - `scale` of a body that holds its origin.
#
# A cone's `height` moves its base, an egg's `length` and `taper` its widest place: they do not
# nest.

AXES = ("semi_axes.1", "semi_axes.2", "semi_axes.3")
SIZES = ("size.1", "size.2", "size.3")

GROWS, SHRINKS = 1.0, -1.0

OWN: Mapping[str, Mapping[str, float]] = {
    "point": {},
    "segment": {"length": GROWS},
    "sphere": {"radius": GROWS},
    "ellipsoid": dict.fromkeys(AXES, GROWS),
    "capsule": dict.fromkeys(("radius", "length"), GROWS),
    "cylinder": dict.fromkeys(("radius", "height"), GROWS),
    "cone": {"radius": GROWS},
    "box": dict.fromkeys(SIZES, GROWS),
    "lens": {"radius": GROWS, "offset": SHRINKS},
    "cap": {"radius": GROWS, "offset": SHRINKS},
    "halfspace": {"offset": GROWS},
    "spindle": dict.fromkeys(("radius", "length"), GROWS),
    "gore": dict.fromkeys(("radius", "height"), GROWS),
    "egg": {"radius": GROWS},
    "superellipsoid": {
        **dict.fromkeys(AXES, GROWS),
        **dict.fromkeys(("exponents.1", "exponents.2"), SHRINKS),
    },
}
"""By shape and number: does the body of a greater number hold that of a lesser one, or the other
way round? What is not here does not nest; `sense_of` adds `rounding` and `scale`."""

OFF_ORIGIN = ("segment", "cap", "halfspace")
"""Shapes of which not all hold their origin."""


def sense_of(shape: str, what: str) -> float | None:
    """Return `GROWS`, `SHRINKS`, or None where bodies do not nest.

    Parameters
    ----------
    shape : str
        As a scene names it.
    what : str
        As a parameter names the number.
    """
    if what == "rounding":
        return SHRINKS if shape in SAME_SIZE else GROWS
    if what == "scale":
        return GROWS if shape in OWN and shape not in OFF_ORIGIN else None
    return OWN.get(shape, {}).get(what)
