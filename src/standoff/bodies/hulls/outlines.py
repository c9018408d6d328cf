"""The outlines of faces: loops of corners round triangles that were merged."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.hulls.merging import areas, by_first
from standoff.bodies.hulls.qhull import Triangles
from standoff.typing import Array, Ints


class Outlines(NamedTuple):
    """Faces as loops of corners, one after another, counterclockwise seen from outside.

    Attributes
    ----------
    corners : (k,) numbers of points.
    starts : (n + 1,) where each face's corners begin, and the end.
    normals : (n, 3) outward unit normals of planes that bound the hull: of the faces' greatest
        triangles.
    left_out : how far a corner that was left out on a straight side is from it at most, length.
    split : how many faces were taken apart again, as they had no single outline.
    """

    corners: Ints
    starts: Ints
    normals: Array
    left_out: float = 0.0
    split: int = 0

    @property
    def owners(self) -> Ints:
        """(k,) the face of every corner."""
        return np.repeat(np.arange(len(self.starts) - 1), np.diff(self.starts))

    @property
    def following(self) -> Ints:
        """(k,) the place of the next corner of the same face."""
        after = np.arange(1, len(self.corners) + 1)
        after[self.starts[1:] - 1] = self.starts[:-1]
        return after


def outlines(points: Array, triangles: Triangles, group: Ints, tolerance: float) -> Outlines:
    """The outlines of groups of triangles.

    Corners between two faces only are left out where they are within `tolerance`, length, of the
    line between their neighbours. A group that has no single outline is taken apart again.
    """
    split = 0
    while True:
        start, stop, owner = _sides(triangles, group)
        order, broken = _chained(start, stop, owner)
        if not len(broken):
            break
        split += len(broken)
        group = _apart(group, broken)
    corners, owner = start[order], owner[order]
    starts = np.concatenate([[0], np.cumsum(np.bincount(owner))])
    order = np.lexsort((-areas(points, triangles), group))
    greatest = order[np.searchsorted(group[order], np.arange(len(starts) - 1))]
    given = Outlines(corners, starts, triangles.normals[greatest], split=split)
    found = _straightened(points, given, tolerance)
    return begun(points, found if _simple(found) else given)


def _sides(triangles: Triangles, group: Ints) -> tuple[Ints, Ints, Ints]:
    """(start, stop, group) of triangles' sides between two groups."""
    outer = group[triangles.neighbours] != group[:, None]
    row, side = np.nonzero(outer)
    start = triangles.corners[row, side]
    stop = triangles.corners[row, (side + 1) % 3]
    return start, stop, group[row]


def _chained(start: Ints, stop: Ints, owner: Ints) -> tuple[Ints, Ints]:
    """Sides group by group in the order of a loop, and the groups that are no one loop."""
    count = int(start.max()) + 1
    keys = owner * count + start
    order = np.argsort(keys, kind="stable")
    keys = keys[order]
    twice = keys[1:][np.diff(keys) == 0] // count
    if len(twice):
        return order, np.unique(twice)
    # in `order`, the place of the side that begins where another one ends
    after = np.searchsorted(keys, owner[order] * count + stop[order])
    begins = np.flatnonzero(np.diff(owner[order], prepend=-1))
    length = np.diff(np.append(begins, len(order)))
    placed = np.empty(len(order), dtype=np.int64)
    at, living, step = begins.copy(), np.arange(len(begins)), 0
    while len(living):
        placed[begins[living] + step] = at[living]
        step += 1
        at[living] = after[at[living]]
        living = living[length[living] > step]
    seen = np.bincount(placed, minlength=len(order))
    once = np.minimum.reduceat((seen == 1).astype(np.int64), begins) == 1
    broken = owner[order[begins[~once]]]
    return order[placed], np.unique(broken)


def _apart(group: Ints, broken: Ints) -> Ints:
    """The members of some groups, each alone."""
    group = group.copy()
    members = np.flatnonzero(np.isin(group, broken))
    group[members] = group.max() + 1 + np.arange(len(members))
    return by_first(group)


def _straightened(points: Array, given: Outlines, tolerance: float) -> Outlines:
    """Without corners of two faces that are on a straight side."""
    corners = given.corners
    meeting = np.bincount(corners, minlength=len(points))
    if not (meeting == 2).any():
        return given
    loose = meeting == 2
    # of a straight side, the ends are what is left when all loose corners are gone
    before, after = _next_firm(given, loose)
    usable = (before >= 0) & loose[corners]
    a, b, p = (points[x] for x in (corners[before], corners[after], corners))
    along = b - a
    length = np.linalg.norm(along, axis=1)
    off = np.linalg.norm(np.cross(p - a, along), axis=1) / np.where(length > 0.0, length, 1.0)
    usable &= (length > 0.0) & (off <= tolerance)
    gone = np.zeros(len(points), dtype=bool)
    gone[corners[usable]] = True
    gone[corners[loose[corners] & ~usable]] = False  # both faces must agree
    kept = ~gone[corners]
    # a face of fewer than three corners keeps all of its own
    least = np.add.reduceat(kept.astype(np.int64), given.starts[:-1])
    while (least < 3).any():
        gone[corners[(least < 3)[given.owners]]] = False
        kept = ~gone[corners]
        least = np.add.reduceat(kept.astype(np.int64), given.starts[:-1])
    starts = np.concatenate([[0], np.cumsum(least)])
    left_out = float(off[~kept].max(initial=0.0))
    return given._replace(corners=corners[kept], starts=starts, left_out=left_out)


def _next_firm(given: Outlines, loose: NDArray[np.bool_]) -> tuple[Ints, Ints]:
    """(k,) places of the corners before and after that are not loose; -1 where a face has none."""
    following = given.following
    preceding = np.empty_like(following)
    preceding[following] = np.arange(len(following))
    firm = ~loose[given.corners]
    some = np.add.reduceat(firm.astype(np.int64), given.starts[:-1])[given.owners] > 0
    ends = []
    for step in (preceding, following):
        at = step.copy()
        while (moving := some & ~firm[at]).any():
            at[moving] = step[at[moving]]
        ends.append(np.where(some, at, -1))
    return ends[0], ends[1]


def _simple(found: Outlines) -> bool:
    """Does every edge join two faces, which pass it in opposite directions?"""
    start, stop = found.corners, found.corners[found.following]
    count = int(start.max()) + 1
    one, other = np.sort(start * count + stop), np.sort(stop * count + start)
    return bool(np.array_equal(one, other) and (np.diff(one) > 0).all())


def begun(points: Array, found: Outlines) -> Outlines:
    """Each loop from its first corner on in the order of their angles about the loop's middle.

    Angles are measured about the face's normal, from the corner with the least number; so edges
    have the numbers that sorting by angle gives them.
    """
    corners, starts, owners = found.corners, found.starts, found.owners
    count = np.diff(starts)
    ascending = corners[np.lexsort((corners, owners))]
    middle = np.add.reduceat(points[ascending], starts[:-1]) / count[:, None]
    x = points[ascending[starts[:-1]]] - middle
    x /= np.linalg.norm(x, axis=1)[:, None]
    y = np.cross(found.normals, x)
    away = points[corners] - middle[owners]
    across, along = (np.einsum("ij,ij->i", away, axes[owners]) for axes in (y, x))
    angle = np.arctan2(across, along)
    first = np.lexsort((angle, owners))[starts[:-1]] - starts[:-1]
    for face in np.flatnonzero(count > 3).tolist():
        # a corner opposite to that one is at +pi or -pi by roundoff: of this very sum, on which
        # the numbers of edges have always depended
        own = corners[starts[face] : starts[face + 1]]
        first[face] = int(np.flatnonzero(own == _first_corner(points, own, found.normals[face]))[0])
    place = np.arange(len(corners)) - starts[:-1][owners]
    turned = starts[:-1][owners] + (place + first[owners]) % count[owners]
    return found._replace(corners=corners[turned])


def _first_corner(points: Array, corners: Ints, normal: Array) -> int:
    """The corner of one face at the least angle about its middle."""
    ascending = np.sort(corners)
    away = points[ascending] - points[ascending].mean(axis=0)
    x = away[0] / np.linalg.norm(away[0])
    angles = np.arctan2(away @ np.cross(normal, x), away @ x)
    return int(ascending[np.argmin(angles)])
