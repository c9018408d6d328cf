"""The pairs of the table and how they move: about 2 mrad and 1e-3 of the size a frame.

A spins where it stands, B spins and goes round it. All contenders get the same poses (4, 4).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

import standoff as so
from benchmarks.nurbs_ellipsoids import elevated
from standoff_studies.accuracy.solids import Kind, Solid, named
from standoff_studies.kinds import Twin
from standoff_studies.oracles import Ellipsoid

Array = NDArray[np.float64]

DT = 1e-3
"""Frame time, s."""
TURN = 2e-3
"""Either body's own turn between two frames, rad."""
SHIFT = 1e-3
"""B's way between two frames over the distance of the centres, hence of the size."""
AXIS_A = np.array([2.0, 3.0, 6.0]) / 7.0
AXIS_B = np.array([6.0, -2.0, 3.0]) / 7.0
RISE = 0.2
"""B rises and falls by this share of the distance of the centres."""


@dataclass(frozen=True)
class Frames:
    """Poses and twists of both bodies, row 0 the start: (n, 4, 4) and (n, 6) (v, omega), world."""

    poses_a: Array
    poses_b: Array
    twists_a: Array
    twists_b: Array

    @cached_property
    def pairs(self) -> list[tuple[Array, Array]]:
        """The poses (4, 4) of both, frame by frame."""
        return list(zip(self.poses_a, self.poses_b, strict=True))


def motion(far: float, count: int) -> Frames:
    """The start and ``count`` frames, the centres about ``far`` (length) apart."""
    k = np.arange(count + 1)
    turn = SHIFT * k
    centre = far * np.column_stack([np.cos(turn), np.sin(turn), RISE * np.sin(2 * turn)])
    along = np.column_stack([-np.sin(turn), np.cos(turn), 2 * RISE * np.cos(2 * turn)])
    poses_a, poses_b = (
        _turned(axis, k, place) for axis, place in ((AXIS_A, 0 * centre), (AXIS_B, centre))
    )
    twists_a, twists_b = np.zeros((2, count + 1, 6))
    twists_a[:, 3:], twists_b[:, 3:] = TURN / DT * AXIS_A, TURN / DT * AXIS_B
    twists_b[:, :3] = far * SHIFT / DT * along
    return Frames(poses_a, poses_b, twists_a, twists_b)


def _turned(axis: Array, k: NDArray[np.int64], place: Array) -> Array:
    poses = np.tile(np.eye(4), (len(k), 1, 1))
    poses[:, :3, :3] = Rotation.from_rotvec(TURN * k[:, None] * axis).as_matrix()
    poses[:, :3, 3] = place
    return poses


@dataclass(frozen=True)
class Pair:
    """Two bodies, how far apart their centres are, and which contenders have more to show.

    Attributes
    ----------
    far : float
        Distance of the centres, length.
    overlap : bool
        Are they in penetration in every frame?
    more : frozenset of str
        "laws" for the warm Newton steps, "meshes" for tessellations, "SLSQP", "C++".
    """

    name: str
    a: Solid
    b: Solid
    far: float
    overlap: bool = False
    more: frozenset[str] = field(default_factory=frozenset)

    @cached_property
    def size(self) -> float:
        """The greater of the bodies' diameters, length; errors are told over it."""
        radii = [solid.support.bounding_radius for solid in (self.a, self.b)]
        return 2.0 * max(radii)


def solid(kind: str, *lengths: float) -> Solid:
    """A solid of a kind of the accuracy report, by its lengths."""
    (chosen,) = named([kind])
    names = chosen.draw(np.random.default_rng(0))
    return Solid(chosen, dict(zip(names, lengths, strict=True)))


def nurbs(degree: int) -> Callable[..., Solid]:
    """An ellipsoid of NURBS patches of a degree."""

    def build(a: float, b: float, c: float) -> so.Body:
        return elevated(degree)((a, b, c))

    kind = Kind(f"NURBS of degree {degree}", lambda rng: {}, own=Twin(build, Ellipsoid))
    return lambda a, b, c: Solid(kind, {"a": a, "b": b, "c": c})


BALL = (0.52, 1.04, 0.89)
OTHER = (0.76, 0.52, 0.95)
TOOL = (0.15, 0.30, 0.20)


def all_pairs() -> list[Pair]:
    """The pairs of the table, in its order."""
    ellipsoids = solid("ellipsoid", *BALL), solid("ellipsoid", *OTHER)
    tool = solid("ellipsoid", *TOOL)
    box, block = solid("box", 1.0, 0.7, 0.5), solid("box", 0.3, 0.4, 0.5)
    egg = solid("superellipsoid", 0.5, 0.7, 0.9, 0.6, 0.8)
    found = [
        Pair(
            "ellipsoids",
            *ellipsoids,
            2.3,
            more=frozenset({"laws", "meshes", "SLSQP", "C++"}),
        ),
        Pair("lens, ellipsoid", solid("lens", 1.0, 0.45), tool, 1.6),
        Pair("box, ellipsoid", box, tool, 1.3),
        Pair("boxes", box, block, 1.4),
        Pair("superellipsoid, capsule", egg, solid("capsule", 0.2, 0.5), 1.6),
    ]
    for degree in (2, 3, 5):
        make = nurbs(degree)
        found.append(Pair(f"NURBS of degree {degree}", make(*BALL), make(*OTHER), 2.3))
    six = solid("NURBS ellipsoid", *BALL), solid("NURBS ellipsoid", *OTHER)
    found.insert(7, Pair("NURBS of degree 4", *six, 2.3))
    return [
        *found,
        Pair("ellipsoids in penetration", ellipsoids[0], tool, 0.5, overlap=True),
        Pair("boxes in penetration", box, block, 0.5, overlap=True),
    ]
