"""Two bodies that are not convex, made of convex patches: chains of balls, and their minima.

A chain is the union of balls in a row. Its patches are what is left of their surfaces, each cut
from a ball; between two of them is a reflex edge. Where the union is cut at the planes of these
edges, each part is convex: a *lobe*. A nearest pair of two chains is a nearest pair of two balls,
so all that is true of them is known in closed form.
"""

from __future__ import annotations

import math
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.bodies import Body, Edge, Face
from standoff.geometry import ConicArc, Plane, Surface
from standoff.geometry.quadrics import sphere_atlas
from standoff.motion import Carried, ConstantTwist, Path, Pose, Spiral, Twist
from standoff.recording.times import even_times
from standoff.solids import Solid
from standoff.typing import Array

RADIUS, HALF = 1.0, 0.6
"""Of the balls, and half of what the middles of two that are side by side are apart [length]."""
BALLS = 3, 2
"""Of A's chain and of B's."""
PAIRS = tuple((i, j) for i in range(BALLS[0]) for j in range(BALLS[1]))
"""Every lobe of A with every lobe of B."""
DURATION, STEP = 4.0, 2e-3
"""Of the motion, and of a frame [s]."""
GAIN = 25.0
"""K of the printed system [1/s], as in simulation C."""
MOTION: Path = Carried(
    Spiral(5.0, -0.2, 2.0 * math.pi / DURATION, phase=math.radians(120.0)),
    ConstantTwist(Pose.identity(), Twist((0.0, 0.0, 0.0), (0.0, 0.0, -3.0))),
)
"""B's motion: it spins against a spiral once around A, in the plane z = 0."""

X, Y, Z = np.eye(3)


def middles(balls: int) -> Array:
    """Return x of the middles of a chain's balls [length]."""
    return np.asarray(HALF * (2.0 * np.arange(balls) - (balls - 1)))


def seams(balls: int, ball: int) -> list[tuple[int, float]]:
    """Return the reflex edges of a ball: of which neighbour, and their x [length]."""
    x = float(middles(balls)[ball])
    return [(ball + side, x + side * HALF) for side in (-1, 1) if 0 <= ball + side < balls]


def _rim(x: float) -> Edge:
    rim = math.sqrt(RADIUS**2 - HALF**2)
    return Edge(ConicArc(x * X, rim * Y, rim * Z))


def _round(x: float) -> tuple[Surface, ...]:
    return sphere_atlas(RADIUS * np.eye(3), x * X)


@cache
def lobes(balls: int) -> tuple[Body, ...]:
    """Return the convex parts of a chain. Face 0 is the part of its ball that is outside; edge e
    and face e + 1 are at its seam e."""
    made = []
    for ball, x in enumerate(middles(balls)):
        rims, loops, discs = [], [], []
        for e, (other, at) in enumerate(seams(balls, ball)):
            side = 1 if other > ball else -1
            rims.append(_rim(at))
            loops.append((e, -side))
            plane = Plane.through(at * X, *((Y, Z) if side > 0 else (Z, Y)))
            discs.append(Face((plane,), ((e, side),)))
        faces = [Face(_round(float(x)), tuple(loops)), *discs]
        made.append(Body.from_brep(edges=rims, faces=faces, name=f"lobe {ball}"))
    return tuple(made)


@cache
def chain(balls: int) -> Solid:
    """Return the whole chain, which is not convex."""
    x = middles(balls)
    faces = []
    for ball in range(balls):
        loop = [(e, sense) for e, sense in ((ball - 1, 1), (ball, -1)) if 0 <= e < balls - 1]
        faces.append(Face(_round(float(x[ball])), tuple(loop)))
    edges = [_rim(float(at)) for at in 0.5 * (x[:-1] + x[1:])]
    return Solid.from_brep(edges=edges, faces=faces, name=f"chain of {balls}")


class Truth(NamedTuple):
    """What is true at each frame, in closed form.

    Attributes
    ----------
    time : ndarray, shape (n,)
        s
    poses : list of Pose
        Of B.
    apart : ndarray, shape (n, pairs)
        Distance of the two balls of each of `PAIRS` [length].
    alive : ndarray of bool, shape (n, pairs)
        Is their nearest pair on both chains' surfaces? Then it is a local minimum; else it is
        hidden in the chain.
    to_seam : ndarray, shape (n, pairs)
        How far along its chain a point of that pair is from a reflex edge, at least [length].
    """

    time: Array
    poses: list[Pose]
    apart: Array
    alive: NDArray[np.bool_]
    to_seam: Array

    @property
    def distance(self) -> Array:
        """Of the chains [length]."""
        return np.asarray(self.apart.min(axis=1))

    @property
    def births(self) -> int:
        """How often a minimum comes out of a reflex edge."""
        return int((~self.alive[:-1] & self.alive[1:]).sum())


@cache
def truth() -> Truth:
    """Return what is true of the chains along the motion."""
    time = even_times(0.0, DURATION, STEP)
    poses = [MOTION.pose(t) for t in time.tolist()]
    axis = np.array([pose.rotation[:, 0] for pose in poses])
    origin = np.array([pose.translation for pose in poses])
    x_a, x_b = (middles(balls) for balls in BALLS)
    apart, inside = [], []
    for i, j in PAIRS:
        between = origin + x_b[j] * axis - x_a[i] * X
        length = np.linalg.norm(between, axis=1)
        way = between / length[:, None]
        beyond = [*_beyond(BALLS[0], i, way[:, 0]), *_beyond(BALLS[1], j, -(way * axis).sum(1))]
        apart.append(length - 2.0 * RADIUS)
        inside.append(np.array(beyond))
    alive = np.array([(each <= 0.0).all(axis=0) for each in inside])
    to_seam = np.array([np.abs(each).min(axis=0) for each in inside])
    return Truth(time, poses, np.array(apart).T, alive.T, to_seam.T)


def _beyond(balls: int, ball: int, along: Array) -> list[Array]:
    """How far the point of a ball in directions with this x is beyond each of its reflex edges,
    along the chain [length]: beyond one it is inside the next ball."""
    sides = (1.0 if other > ball else -1.0 for other, _ in seams(balls, ball))
    return [RADIUS * side * along - HALF for side in sides]
