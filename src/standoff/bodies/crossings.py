"""Whether a point is inside a boundary, by where rays from it cross the faces.

Along a ray, crossings alternate between out and in, and the last leads out. If those found do not,
for instance because the ray runs along an edge or touches a face, another direction is tried.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.face_leaves import FaceChart, FaceRectangles, face_charts, leaves_of, quartered
from standoff.bodies.packed_parts import PackedParts
from standoff.bodies.tolerances import CROSSING_STEP, LEAF_MARGIN, SAME_CROSSING
from standoff.errors import BodyError
from standoff.kernels.entries.queries import on_face
from standoff.typing import Array

# Half the angle of a leaf's cone of normals, radians.
LEAF_ANGLE = 0.4
# A ray at a larger angle than this to all of a leaf's surface (radians) crosses it at most once.
GRAZING = 0.05
# How often a leaf that a ray may graze is quartered before another direction is tried.
MOST_QUARTERINGS = 12
# Newton steps for one crossing: a leaf is nearly plane.
MOST_STEPS = 30
# Directions of rays, none along an axis or a diagonal, as hand-made shapes have them.
_SPREAD = np.array(
    [
        (0.5417, 0.3109, 0.7809),
        (-0.7331, 0.5923, 0.3341),
        (0.2273, -0.8419, 0.4893),
        (-0.3779, -0.4561, -0.8057),
        (0.8713, 0.4327, -0.2311),
        (-0.6173, 0.2927, -0.7302),
        (0.1361, 0.9277, -0.3476),
        (-0.9043, -0.1913, 0.3815),
        (0.4159, -0.3571, -0.8363),
        (-0.0877, 0.6451, 0.7590),
    ]
)
DIRECTIONS = _SPREAD / np.linalg.norm(_SPREAD, axis=1)[:, None]


class Crossings:
    """Rays through some faces of a boundary, which close a shell."""

    def __init__(self, boundary: PackedParts, faces: Sequence[int] | None = None) -> None:
        self.boundary = boundary
        self.charts = face_charts(boundary, faces)
        self._leaves: dict[int, FaceRectangles] = {}
        self._extents: dict[tuple[int, int], tuple[Array, Array]] = {}
        self.near = 0.0
        low, high = self._whole(np.eye(3))
        size = float(np.linalg.norm(high.max(axis=1) - low.min(axis=1)))
        self.near = SAME_CROSSING * (size + float(np.abs([low, high]).max()))
        self._known: dict[int, tuple[Array, Array, Array]] = {}

    def _whole(self, frame: Array) -> tuple[Array, Array]:
        """The charts' extents in a frame, (3, n) each, slightly enlarged."""
        found = []
        for chart in self.charts:
            low, high = chart.surface.extents(quartered(quartered(chart.rectangle[None])), frame)
            found.append((low.min(axis=1), high.max(axis=1)))
        low, high = np.moveaxis(np.array(found), 0, -1)
        return low - self.near, high + self.near

    def _ray(self, number: int) -> tuple[Array, Array, Array]:
        """A direction's frame (3, 3), and the charts' extents in it."""
        if number not in self._known:
            direction = DIRECTIONS[number]
            across = np.cross(direction, np.eye(3)[int(np.abs(direction).argmin())])
            across = across / np.linalg.norm(across)
            frame = np.stack([direction, across, np.cross(direction, across)])
            self._known[number] = frame, *self._whole(frame)
        return self._known[number]

    def _met_leaves(self, k: int, number: int, at: Array, frame: Array) -> FaceRectangles:
        """Those of a chart's leaves that a ray may meet; they are made once it meets the chart."""
        if k not in self._leaves:
            self._leaves[k] = leaves_of(self.boundary, self.charts[k], LEAF_ANGLE)
        own = self._leaves[k]
        if (k, number) not in self._extents:
            low, high = self.charts[k].surface.extents(own.rectangles, frame)
            self._extents[k, number] = low - self.near, high + self.near
        met = _meets(at, *self._extents[k, number])
        return FaceRectangles(*(rows[met] for rows in own))

    def inside(self, point: Array) -> bool:
        """Is a point inside, or on a face?

        Raises BodyError: the crossings alternate along no direction.
        """
        for grazing in (False, True):
            for number in range(len(DIRECTIONS)):
                told = self._along(point, number, grazing)
                if told is not None:
                    return told
        raise BodyError(
            f"Cannot decide whether {point} is inside: along none of {len(DIRECTIONS)} rays do the "
            "crossings alternate between out and in. Faces may cross each other or have gaps."
        )

    def _along(self, point: Array, number: int, grazing: bool) -> bool | None:
        """By one ray; None if it does not decide, or may graze a face and `grazing` is False."""
        frame, *extents = self._ray(number)
        at = frame @ point
        hits: list[tuple[float, float]] = []
        met = [
            (self.charts[k], self._met_leaves(int(k), number, at, frame))
            for k in np.flatnonzero(_meets(at, *extents))
        ]
        every = [_steep(leaves.axes, leaves.angles, frame[0]) for _, leaves in met]
        if not (grazing or all(steep.all() for steep in every)):
            return None
        for (chart, leaves), steep in zip(met, every, strict=True):
            rows = leaves.rectangles
            for cross, part in ((self._crossings, rows[steep]), (self._grazed, rows[~steep])):
                found = cross(chart, part, at, frame) if len(part) else []
                if found is None:
                    return None
                hits += found
        if any(abs(t) <= self.near for t, _ in hits):
            return True
        return _parity([hit for hit in hits if hit[0] > 0.0], self.near)

    def _crossings(
        self, chart: FaceChart, rows: Array, at: Array, frame: Array
    ) -> list[tuple[float, float]] | None:
        """(distance along the ray, +1 where it leads out) of each crossing in steep rectangles;
        None where one may be missed: Newton's method alone proves no rectangle free of them."""
        hits, missed = [], []
        for row in rows:
            root = self._root(chart, row, at, frame)
            if root is None:
                missed.append(row)
            elif on_face(self.boundary.ints, self.boundary.reals, chart.number, *root):
                x, xu, xv, *_ = chart.surface.jet(*root)
                out = chart.outward * float(np.sign(np.cross(xu, xv) @ frame[0]))
                hits.append((float(frame[0] @ x - at[0]), out))
        rows = np.reshape(missed, (-1, 4))
        for _ in range(MOST_QUARTERINGS):
            rows = self._met(chart, quartered(rows), at, frame)
            if not len(rows):
                return hits
        return None

    def _grazed(
        self, chart: FaceChart, rows: Array, at: Array, frame: Array
    ) -> list[tuple[float, float]] | None:
        """The same for rectangles that a ray may graze; None where it does."""
        hits: list[tuple[float, float]] = []
        for _ in range(MOST_QUARTERINGS):
            steep = _steep(*chart.surface.normal_cones(rows), frame[0])
            found = self._crossings(chart, rows[steep], at, frame)
            if found is None:
                return None
            hits += found
            rows = self._met(chart, quartered(rows[~steep]), at, frame)
            if not len(rows):
                return hits
        return None

    def _met(self, chart: FaceChart, rows: Array, at: Array, frame: Array) -> Array:
        """Those of some rectangles that a ray may meet."""
        if not len(rows):
            return rows
        low, high = chart.surface.extents(rows, frame)
        return rows[_meets(at, low - self.near, high + self.near)]

    def _root(
        self, chart: FaceChart, row: Array, at: Array, frame: Array
    ) -> tuple[float, float] | None:
        """Where the ray's line meets a leaf, by Newton's method; None if it misses it."""
        low, high = row[[0, 2]], row[[1, 3]]
        width = high - low
        place = 0.5 * (low + high)
        for _ in range(MOST_STEPS):
            x, xu, xv, *_ = chart.surface.jet(float(place[0]), float(place[1]))
            away = frame[1:] @ x - at[1:]
            slope = frame[1:] @ np.column_stack([xu, xv])
            det = slope[0, 0] * slope[1, 1] - slope[0, 1] * slope[1, 0]
            if det == 0.0:
                return None
            step = np.array(
                [
                    slope[1, 1] * away[0] - slope[0, 1] * away[1],
                    slope[0, 0] * away[1] - slope[1, 0] * away[0],
                ]
            )
            place = np.clip(place - step / det, low - 0.5 * width, high + 0.5 * width)
            if (np.abs(step / det) <= CROSSING_STEP * np.maximum(width, np.abs(place))).all():
                break
        else:
            return None
        spare = LEAF_MARGIN * width
        inside = (low - spare <= place).all() and (place <= high + spare).all()
        return (float(place[0]), float(place[1])) if inside else None


def _steep(axes: Array, angles: Array, direction: Array) -> NDArray[np.bool_]:
    """(n,) rectangles over which the angle of surface and ray is proven above GRAZING."""
    lean = np.minimum(np.abs(axes @ direction), 1.0)
    return np.asarray(np.arcsin(lean) - angles > GRAZING)


def _meets(at: Array, low: Array, high: Array) -> NDArray[np.bool_]:
    """(n,) which of the extents (3, n) a ray from a point meets, all in the ray's frame."""
    beside = ((low[1:] <= at[1:, None]) & (at[1:, None] <= high[1:])).all(axis=0)
    return np.asarray(beside & (high[0] >= at[0]))


def _parity(hits: list[tuple[float, float]], near: float) -> bool | None:
    """Is the start inside? None unless the crossings alternate and the last leads out."""
    kept: list[tuple[float, float]] = []
    for way, out in sorted(hits):
        if kept and way - kept[-1][0] <= near:
            if out != kept[-1][1]:
                return None
            continue  # the same crossing, found in two leaves or on two faces of an edge
        kept.append((way, out))
    if not kept:
        return False
    outs = [out for _, out in kept]
    alternate = all(a == -b for a, b in zip(outs[1:], outs[:-1], strict=True))
    return outs[0] > 0.0 if alternate and outs[-1] > 0.0 else None
