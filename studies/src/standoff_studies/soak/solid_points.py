"""``python -m standoff_studies.soak.solid_points``: signed distances of points, judged twice.

By the closed forms, to a rounding; and by the generalised winding number and the distance of
OpenCASCADE's mesh (``pip install cadquery-ocp-novtk``), which knows nothing of them, for points
that are farther from the boundary than the mesh is off. Block k of a seed is always the same. The
exit code is 1 after a fault.
"""

from __future__ import annotations

from functools import cache, partial
from typing import Any, NamedTuple

import numpy as np

from standoff_studies.soak import blocks
from standoff_studies.soak.solid_meshes import windings_and_distances
from standoff_studies.soak.solid_outlines import Array
from standoff_studies.soak.solid_pairs import made
from standoff_studies.soak.solid_parts import MAKERS
from standoff_studies.soak.solid_poses import Known
from standoff_studies.soak.solid_shapes import shape_of, triangles_of
from standoff_studies.soak.solid_truth import signed

NOISE = 1e-11
"""Of the size: what roundings may do to a length."""
BLOCK = 500
"""Points of a solid that are asked for at once."""
CHORD = 5e-4
"""Of the size: how far a mesh may be from the boundary."""
MESH_OFF = 1.5
"""Times that is what a mesh's distances are compared to."""
NEAR = (1e-9, 1e-6, 1e-3, 0.1)
"""Of the size: how far points near the boundary are from it."""
GRID = 0.05
"""Length: points of a grid, or off it by little, lie in the planes of faces and under edges."""
NUDGES = (0.0, 0.0, 1e-15, 1e-12, 1e-9)


class PointVerdict(NamedTuple):
    """Counts: bounds that exclude the truth, wrong sides, nearest points that are off the
    boundary, gradients that are wrong; intervals wider than the tolerance; points that the mesh
    judged too, its winding numbers that are no whole ones, sides and distances that are not the
    mesh's; points with a fault, and those of them whose interval is within the tolerance."""

    points: int = 0
    bound: int = 0
    side: int = 0
    nearest: int = 0
    gradient: int = 0
    open: int = 0
    meshed: int = 0
    broken: int = 0
    winding: int = 0
    mesh: int = 0
    wrong: int = 0
    silent: int = 0

    @property
    def sound(self) -> bool:
        return not (self.wrong or self.broken)

    def plus(self, other: PointVerdict) -> PointVerdict:
        return PointVerdict(*(a + b for a, b in zip(self, other, strict=True)))

    def __str__(self) -> str:
        return (
            f"{self.points:,} points; {self.wrong} wrong, {self.silent} of them certified: bound "
            f"{self.bound}, side {self.side}, nearest {self.nearest}, gradient {self.gradient}; of "
            f"{self.meshed:,} beside the mesh side {self.winding}, distance {self.mesh} "
            f"({self.broken} without a whole winding number); {self.open} open"
        )


@cache
def mesh_of(name: str) -> Array:
    """OpenCASCADE's triangles of a part."""
    known = made(name)[0]
    return triangles_of(shape_of(known.part.truth), CHORD * known.size)


def judge_block(number: int, seed: int, parts: list[str]) -> tuple[PointVerdict, list[str]]:
    """Points of a part, and the faults' lines."""
    name = parts[number % len(parts)]
    known, solid = made(name)
    points = drawn(known, BLOCK, np.random.default_rng([seed, number]))
    verdict, wrong = compared(known, points, solid.signed_distance(points), mesh_of(name))
    lines = [f"seed {seed}, block {number}: {name} at {points[k].tolist()!r}" for k in wrong]
    return verdict, lines


def drawn(known: Known, count: int, rng: np.random.Generator) -> Array:
    """Points near the boundary, around the solid, and of a grid, a third each; of the last ones one
    or two coordinates may be any."""
    start = known.sampled.points
    middle, spread = start.mean(axis=0), np.ptp(start, axis=0)
    far = middle + (rng.uniform(size=(count, 3)) - 0.5) * 2.0 * spread
    near = start[rng.integers(len(start), size=count)]
    off = rng.choice(NEAR, count)[:, None] * known.size
    near = near + off * rng.normal(size=(count, 3)) / np.sqrt(3.0)
    grid = GRID * np.round(far / GRID) + rng.choice(NUDGES, count)[:, None]
    grid = np.where(rng.uniform(size=(count, 3)) < 0.4, far, grid)
    which = rng.integers(3, size=(count, 1))
    return np.asarray(np.where(which == 0, far, np.where(which == 1, near, grid)))


def compared(
    known: Known, points: Array, told: Any, triangles: Array | None = None
) -> tuple[PointVerdict, list[int]]:
    """What was told of points, beside the closed form and a mesh; which of them are wrong."""
    true, noise = signed(known.part.truth, points), NOISE * known.size
    bound = (told.lower_bound > true + noise) | (told.upper_bound < true - noise)
    clear = np.abs(true) > 1e-9 * known.size
    side = clear & ((told.distance < 0.0) != (true < 0.0))
    length = np.linalg.norm(points - told.nearest, axis=1)
    nearest = (np.abs(signed(known.part.truth, told.nearest)) > noise) | (
        np.abs(length - np.abs(told.distance)) > noise
    )
    # from the nearest point to the point, or back where it is inside
    way = np.sign(told.distance)[:, None] * (points - told.nearest)
    off = np.linalg.norm(way - length[:, None] * told.gradient, axis=1)
    gradient = clear & (off > noise)
    apart, broken, winding, mesh = beside_mesh(known, points, told.distance, triangles)
    wrong = bound | side | nearest | gradient | winding | mesh
    counts = [bound, side, nearest, gradient, ~told.converged, apart, broken, winding, mesh]
    counts += [wrong, wrong & told.converged]
    verdict = PointVerdict(len(points), *(int(np.count_nonzero(each)) for each in counts))
    return verdict, np.flatnonzero(wrong).tolist()


def beside_mesh(known: Known, points: Array, distance: Array, triangles: Array | None) -> Array:
    """(4, n) of bool: far enough to be judged by the mesh; of these no whole winding number,
    another side, another distance."""
    if triangles is None:
        return np.zeros((4, len(points)), dtype=bool)
    windings, lengths = windings_and_distances(triangles, points)
    off = MESH_OFF * CHORD * known.size
    apart = lengths > off
    broken = apart & (np.abs(windings - np.round(windings)) > 1e-6)
    winding = apart & ((distance < 0.0) != (windings > 0.5))
    mesh = apart & (np.abs(np.abs(distance) - lengths) > off)
    return np.array([apart, broken, winding, mesh])


def main() -> int:
    """Read the options, run, and tell; 1 if anything was wrong."""
    parser = blocks.options(__doc__, "points", 1_000_000, BLOCK)
    parser.add_argument("--parts", nargs="+", default=list(MAKERS), choices=list(MAKERS))
    given = parser.parse_args()
    work = partial(judge_block, seed=given.seed, parts=given.parts)
    found = blocks.run(given, BLOCK, work)
    return 0 if found is None or found.sound else 1


if __name__ == "__main__":
    raise SystemExit(main())
