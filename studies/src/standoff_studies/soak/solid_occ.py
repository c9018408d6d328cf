"""``python -m standoff_studies.soak.solid_occ``: OpenCASCADE's ``DistShapeShape`` beside ours.

The shapes are made by OpenCASCADE itself from the outlines of `solid_parts`. It has no sign: while
the boundaries are apart, and neither solid is inside the other, its distance is compared. Where it
disagrees, the closed forms say who is off. The exit code is 1 where the library is.
"""

from __future__ import annotations

import time
from functools import cache, partial
from typing import Any, NamedTuple

import numpy as np

from standoff.solids.spatial.distance import spatial_distance
from standoff_studies.soak import blocks
from standoff_studies.soak.solid_judge import truths
from standoff_studies.soak.solid_outlines import Array
from standoff_studies.soak.solid_pairs import made
from standoff_studies.soak.solid_parts import MAKERS
from standoff_studies.soak.solid_poses import Known, draw_poses, pairs_of
from standoff_studies.soak.solid_shapes import placed, shape_of

AGREED = 1e-6
"""Length: OpenCASCADE's own tolerance is 1e-7."""
BLOCK = 10
"""Poses of a pair."""


class Comparison(NamedTuple):
    """Counts over poses apart: answers of OpenCASCADE that are the closed form's, those of them
    that are not the library's; answers of the library, and of OpenCASCADE, that are not the closed
    form's; those of the latter that are too near; seconds of both."""

    poses: int = 0
    right: int = 0
    apart: int = 0
    library: int = 0
    occ: int = 0
    too_near: int = 0
    library_time: float = 0.0
    occ_time: float = 0.0

    @property
    def sound(self) -> bool:
        return not (self.library or self.apart)

    def plus(self, other: Comparison) -> Comparison:
        sums = [a + b for a, b in zip(self, other, strict=True)]
        return Comparison(*(int(n) for n in sums[:6]), *sums[6:])

    def __str__(self) -> str:
        each = 1e3 / max(self.poses, 1)
        return (
            f"{self.poses:,} poses apart; OpenCASCADE is right in {self.right:,} of them, and the "
            f"library differs by more than {AGREED:g} in {self.apart} of these; {self.library} "
            f"answers of the library and {self.occ} of OpenCASCADE are off the closed form "
            f"({self.too_near} too near); {each * self.library_time:.2f} and "
            f"{each * self.occ_time:.1f} ms"
        )


@cache
def shape(name: str) -> Any:
    """OpenCASCADE's shape of a part."""
    return shape_of(made(name)[0].part.truth)


def judge_block(
    number: int, seed: int, pairs: list[tuple[str, str]]
) -> tuple[Comparison, list[str]]:
    """Poses of a pair that are apart, and lines of those in which the library is off."""
    a, b = pairs[number % len(pairs)]
    (one, first), (two, second) = made(a), made(b)
    drawn = draw_poses(one, two, BLOCK, np.random.default_rng([seed, number, 2]))
    return compared(one, two, (first, second), drawn, spatial_distance)


def compared(
    a: Known, b: Known, solids: tuple[Any, Any], poses: tuple[Array, Array], ask: Any
) -> tuple[Comparison, list[str]]:
    """The poses that are apart."""
    from OCP.BRepExtrema import BRepExtrema_DistShapeShape

    shapes = shape(a.part.name), shape(b.part.name)
    found, lines = Comparison(), []
    for pose_a, pose_b, true, inside, _ in truths(a, b, *poses):
        if inside or not true.upper > AGREED:
            continue
        first, second = placed(shapes[0], pose_a), placed(shapes[1], pose_b)
        begun = time.perf_counter()
        told = ask(*solids, pose_a, pose_b)
        between = time.perf_counter()
        try:
            distance = BRepExtrema_DistShapeShape(first, second).Value()
        except Exception as error:
            # its exceptions have no common class in Python
            if not type(error).__module__.startswith("OCP"):
                raise
            distance = float("nan")  # it gave none: counted as off
        ended = time.perf_counter()
        # the search may miss what is nearest: so the told points count too
        least = min(float(true.upper), float(np.linalg.norm(told.point_b - told.point_a)))
        off = [not abs(d - least) <= AGREED for d in (told.distance, distance)]
        differs = not off[1] and not abs(told.distance - distance) <= AGREED
        counts = Comparison(
            1, not off[1], differs, off[0], off[1], distance < least - AGREED,
            between - begun, ended - between,
        )  # fmt: skip
        found = found.plus(counts)
        if off[0] or differs or counts.too_near:
            names = f"{a.part.name} - {b.part.name}"
            poses_told = f"{pose_a.tolist()!r}, {pose_b.tolist()!r}"
            lines.append(f"{names}: {told!r}, closed form {least!r}, {distance!r}: {poses_told}")
    return found, lines


def main() -> int:
    """Read the options, run, and tell; 1 if the library was wrong."""
    parser = blocks.options(__doc__, "poses", 3_000, BLOCK)
    parser.add_argument("--parts", nargs="+", default=list(MAKERS), choices=list(MAKERS))
    given = parser.parse_args()
    found = blocks.run(
        given, BLOCK, partial(judge_block, seed=given.seed, pairs=pairs_of(given.parts))
    )
    return 0 if found is None or found.sound else 1


if __name__ == "__main__":
    raise SystemExit(main())
