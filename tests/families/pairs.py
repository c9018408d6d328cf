"""The families: which two bodies, and how their poses are drawn."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from families import curved_shapes, formula_bodies, nurbs_bodies, shapes, swept_bodies
from families.shapes import Maker, Twin
from oracles.poses import DrawnPose, Kind, draw_poses, size_of, tilted_pair

TILTS = (0.0, *(10.0**-k for k in range(9, 1, -1)))
"""Angles between two facing flat sides, radians."""
GAPS = (1e-4, 2.0)
"""Range of the gaps of constructed poses, over the pair's size."""
FEW_CLOSE: dict[Kind, float] = {"exact": 0.45, "feature": 0.3, "free": 0.2, "close": 0.05}
"""Shares of the kinds of poses where proving that a free close pose is separated is slow."""
PLANAR_SHARES: dict[Kind, float] = {"exact": 0.3, "feature": 0.0, "free": 0.69, "close": 0.01}
"""The same for planar loops, whose support functions are slow."""

FEW = 60
"""Poses of the suite for families with slow oracles; the benchmark runs all 3,000."""


@dataclass(frozen=True)
class Family:
    """Two makers of bodies; ``shares`` of the kinds of poses, or ``tilted`` flat sides.

    ``poses`` are those of the suite: fewer where bodies or oracles are slow to make.
    """

    first: Maker
    second: Maker
    shares: dict[Kind, float] | None = None
    tilted: bool = False
    poses: int = 180


FAMILIES: dict[str, Family] = {
    "ellipsoid-ellipsoid": Family(shapes.ellipsoid, shapes.ellipsoid),
    "lens-lens": Family(shapes.lens, shapes.lens, FEW_CLOSE),
    "thin lens-lens": Family(shapes.thin_lens, shapes.lens, FEW_CLOSE),
    "lens-point": Family(shapes.lens, shapes.point, FEW_CLOSE),
    "box-box": Family(shapes.box, shapes.box),
    "tilted boxes": Family(shapes.box, shapes.box, tilted=True),
    "tilted round ends": Family(shapes.flat_topped, shapes.flat_ended, tilted=True),
    "box-lens": Family(shapes.box, shapes.lens, FEW_CLOSE),
    "cylinder-cone": Family(shapes.cylinder, shapes.cone),
    "cylinder-cylinder": Family(shapes.cylinder, shapes.cylinder),
    "capsule-ellipsoid": Family(shapes.capsule, shapes.ellipsoid),
    "polytope-ellipsoid": Family(shapes.polytope, shapes.ellipsoid),
    "solid-half-space": Family(shapes.solid, shapes.half_space),
    "half-space-solid": Family(shapes.half_space, shapes.solid),
    "cap-solid": Family(shapes.cap, shapes.solid, FEW_CLOSE),
    "solid-solid": Family(shapes.solid, shapes.extended_solid, FEW_CLOSE),
    "rounded polytope-egg": Family(
        curved_shapes.rounded_polytope, curved_shapes.egg, FEW_CLOSE, poses=FEW
    ),
    "superellipsoid-superellipsoid": Family(
        curved_shapes.superellipsoid, curved_shapes.superellipsoid, FEW_CLOSE, poses=FEW
    ),
    "capsule-superellipsoid": Family(
        shapes.capsule, curved_shapes.superellipsoid, FEW_CLOSE, poses=FEW
    ),
    "spindle-solid": Family(curved_shapes.spindle, shapes.solid, FEW_CLOSE, poses=FEW),
    "gore-solid": Family(curved_shapes.gore, shapes.solid, FEW_CLOSE, poses=FEW),
    "gore-spindle": Family(curved_shapes.gore, curved_shapes.spindle, FEW_CLOSE, poses=FEW),
    "hull-solid": Family(curved_shapes.revolved_hull, shapes.solid, FEW_CLOSE, poses=FEW),
    "NURBS-NURBS": Family(nurbs_bodies.any_nurbs, nurbs_bodies.any_nurbs, FEW_CLOSE, poses=FEW),
    "NURBS-box": Family(nurbs_bodies.any_nurbs, shapes.box, FEW_CLOSE, poses=FEW),
    "formula-lens": Family(formula_bodies.any_formula, shapes.lens, FEW_CLOSE, poses=FEW),
    "swept-solid": Family(swept_bodies.any_swept, shapes.solid, FEW_CLOSE, poses=FEW),
    "affine image-egg": Family(swept_bodies.affine_image, curved_shapes.egg, FEW_CLOSE, poses=FEW),
    "planar-planar": Family(shapes.loop, shapes.loop, PLANAR_SHARES),
    "planar-point": Family(shapes.loop, shapes.planar_point, PLANAR_SHARES),
}
"""Every family of the cold queries."""


@dataclass(frozen=True)
class Instance:
    """Two bodies and several poses of them; ``label`` is enough to draw them again."""

    label: str
    a: Twin
    b: Twin
    poses: list[DrawnPose]


def _tilted(a: Twin, b: Twin, count: int, rng: np.random.Generator) -> list[DrawnPose]:
    size = size_of(a.shape, b.shape)
    low, high = np.log(GAPS)
    return [
        tilted_pair(
            a.shape, b.shape, TILTS[k % len(TILTS)], size * np.exp(rng.uniform(low, high)), rng
        )
        for k in range(count)
    ]


def draw(name: str, seed: int, number: int, count: int) -> Instance:
    """Return instance ``number`` of a family: ``draw(*label)`` gives the same one again."""
    family = FAMILIES[name]
    rng = np.random.default_rng([seed, number])
    a, b = family.first(rng), family.second(rng)
    if family.tilted:
        poses = _tilted(a, b, count, rng)
    else:
        again = int(rng.integers(1 << 31))
        poses = list(draw_poses(a.shape, b.shape, count, again, gaps=GAPS, shares=family.shares))
    return Instance(f"draw({name!r}, {seed}, {number}, {count})", a, b, poses)
