"""Patches that are planes, or ruled by straight lines, up to the rounding of control points.

After degree elevation or knot insertion along a straight line, such a patch has control points that
are rounded off the line, and second differences over narrow spans turn this into curvatures of
1e-9. But the patch itself is within the rounding h of an exact plane or ruled surface, and its
normals are within a few h over a span's width of those of that surface. Points of the patch then
rise above its tangent planes by at most as much as those of the exact surface, plus twice the
distance, plus the turn between the normals times the size.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from standoff.bodies.proofs.boxes import DyadicBox
from standoff.bodies.proofs.forms import Forms, forms_of, with_poles
from standoff.bodies.proofs.tolerances import NORMAL_ROUNDING
from standoff.geometry import bernstein
from standoff.typing import Array

# Halvings of a span along its curve before normals are compared: on each part they turn little.
SPAN_HALVINGS = 4


@dataclass(frozen=True)
class Nearness:
    """How near a patch is to an exact surface: distance, in units of the size, and greatest turn
    between their normals, radians."""

    distance: float
    turn: float

    @property
    def rise(self) -> float:
        """The rise above a tangent plane, over the whole size, from not being that surface."""
        return 2.0 * self.distance + self.turn


@dataclass(frozen=True, eq=False)
class Grid:
    """The spans of a patch relative to its centre: `points` (nu, nv, 4, p + 1, q + 1), scaled to
    size one with one scale for the weights, and the ends of spans `us` (nu + 1,), `vs` (nv + 1,).
    """

    us: Array
    vs: Array
    points: Array

    def swapped(self) -> Grid:
        return Grid(self.vs, self.us, self.points.transpose(1, 0, 2, 4, 3))


def plane_nearness(points: Sequence[Array], forms: Sequence[Forms]) -> Nearness:
    """How near a patch is to the plane that fits its Bezier points best; the turn is pi if not
    known."""
    cloud = np.concatenate([(h[:3] / h[3]).reshape(3, -1) for h in points], axis=1)
    cloud = cloud - cloud.mean(axis=1, keepdims=True)
    axis = np.linalg.svd(cloud, full_matrices=False)[0][:, 2]
    thickness = float(np.ptp(axis @ cloud))
    normals = np.concatenate([f.normal.reshape(3, -1) / np.abs(f.normal).max() for f in forms], 1)
    lengths = np.linalg.norm(normals, axis=0)
    normals = normals[:, lengths > NORMAL_ROUNDING] / lengths[lengths > NORMAL_ROUNDING]
    heights = axis @ normals
    if not heights.size or (heights.min() <= 0.0 <= heights.max()):
        return Nearness(thickness, float(np.pi))
    # the sine resolves small angles that a cosine would lose
    sine = float(np.linalg.norm(np.cross(normals.T, axis), axis=1).max())
    return Nearness(thickness, 2.0 * float(np.arcsin(min(sine, 1.0))))


@dataclass(frozen=True, eq=False)
class Ruled:
    """A ruled surface within `distance` of a patch, as a fraction of the size.

    Attributes
    ----------
    whole : it with one span, of degree 1, along its straight lines.
    spans : it in the spans and degrees of the patch.
    """

    whole: Grid
    spans: Grid
    distance: float


def ruled_along(grid: Grid, along_u: bool, limit: float) -> Ruled | None:
    """The patch as straight along u, or v, if its points (w x, w) are so to within `limit`.

    None too if it is one span of degree 1, and so exactly straight already.
    """
    if along_u:
        found = ruled_along(grid.swapped(), False, limit)
        return found and Ruled(found.whole.swapped(), found.spans.swapped(), found.distance)
    if grid.points.shape[1] == 1 and grid.points.shape[-1] == 2:
        return None
    ends = np.stack([grid.points[:, 0, ..., 0], grid.points[:, -1, ..., -1]], axis=-1)
    spans = _elevated(grid, ends)
    off = float(np.abs(grid.points - spans).max())
    if off > limit:
        return None
    # a change of w x changes x by as much divided by w, and one of w by x times it divided by w
    distance = 4.0 * off / float(grid.points[:, :, 3].min())
    whole = Grid(grid.us, grid.vs[[0, -1]], ends[:, None])
    return Ruled(whole, Grid(grid.us, grid.vs, spans), distance)


def _elevated(grid: Grid, ends: Array) -> Array:
    """The straight lines between two rows (nu, 4, p + 1, 2), arranged like the grid's points."""
    q = grid.points.shape[-1] - 1
    t = (grid.vs - grid.vs[0]) / (grid.vs[-1] - grid.vs[0])
    # coefficients of a linear function are its values: (nv, q + 1) places between the rows
    s = t[:-1, None] + (t[1:] - t[:-1])[:, None] * np.linspace(0.0, 1.0, q + 1)
    first, last = (ends[:, None, ..., k : k + 1] for k in (0, 1))
    s = s[None, :, None, None, :]
    lines: Array = first * (1.0 - s) + last * s
    return lines


def turn_to(spans: Grid, forms: Sequence[Forms], reach: float, along_u: bool) -> float:
    """The greatest angle between normals of a patch and of a nearby one; pi if not known.

    forms : of the patch's spans, u major; spans : of the other one, of the same degrees, straight
    along u or v.
    """
    greatest = 0.0
    points = spans.points.reshape(-1, *spans.points.shape[2:])
    for own, h in zip(forms, points, strict=True):
        other = forms_of(with_poles(h / h[3].max())[0], reach)
        if own.sharp != other.sharp:
            return float(np.pi)
        # if weights are equal up to rounding, only one may have been found polynomial
        rows, columns = np.maximum(own.normal.shape, other.normal.shape)[1:] - 1
        mine, theirs = (bernstein.elevate(f.normal, rows, columns) for f in (own, other))
        greatest = max(greatest, _turn_between(mine, theirs, along_u))
    return greatest


def _turn_between(one: Array, other: Array, along_u: bool) -> float:
    """The greatest angle between two polynomial vectors, radians; pi if not known.

    They must turn little along u, or v.
    """
    greatest = 0.0
    for k in range(2**SPAN_HALVINGS):
        across = (SPAN_HALVINGS, k)
        cell = DyadicBox((0, 0), across) if along_u else DyadicBox(across, (0, 0))
        normal = cell.part(other)
        apart = float(np.linalg.norm(cell.part(one - other), axis=0).max())
        axis = bernstein.value(normal, 0.5, 0.5)
        length = float(np.linalg.norm(axis))
        height = float(np.tensordot(axis, normal, 1).min()) / length if length > 0.0 else 0.0
        if height <= apart:
            return float(np.pi)
        greatest = max(greatest, float(np.arcsin(apart / height)))
    return greatest
