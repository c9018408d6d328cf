"""Pairs of a solid's own leaves that may meet, and where the faces of such a pair are joined."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from itertools import combinations
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.packed_parts import PackedParts
from standoff.bodies.tessellation import surface_of
from standoff.geometry.surfaces import Surface
from standoff.kernels.entries.solids import near_own_leaves
from standoff.solids.spatial.derivative_bounds import surface_derivatives
from standoff.solids.spatial.solid_model import SolidModel
from standoff.solids.spatial.tolerances import JOINT_PARTS, JOINT_ROOM, VERTEX_SHARE
from standoff.typing import Array, Ints

# Room for nodes that wait: two for each level of the tree.
WAITING = 2048
# Starts of leaves for each leaf that there is room for at first.
USUAL = 16


class OwnPairs(NamedTuple):
    """Leaves (n, 2) that are to be looked at together.

    Attributes
    ----------
    faces : the faces they are of, the same twice for one face.
    leaves : (n, 2)
    joint : (m, 4) points of what their faces have in common, with the radius round each that is
        left out; none for faces that have nothing in common.
    """

    faces: tuple[int, int]
    leaves: Ints
    joint: Array


def near_pairs(solid: SolidModel, within: float) -> Ints:
    """(n, 2) leaves of faces whose boxes are not farther apart than a length, each pair once; a
    leaf is beside itself."""
    room = USUAL * len(solid.leaves)
    while True:
        found = np.zeros(2 * room + 1, dtype=np.int64)
        near_own_leaves(solid.packed, within, np.zeros(WAITING, dtype=np.int64), found)
        count = int(found[-1])
        if count <= room:
            return np.unique(found[: 2 * count].reshape(-1, 2), axis=0)
        room = count


def own_pairs(solid: SolidModel, within: float) -> tuple[list[OwnPairs], int]:
    """(what is to be looked at, how many pairs of leaves of one face are beside each other and not
    proven to be apart); a face whose surface cannot meet itself is not looked at."""
    pairs = near_pairs(solid, within)
    faces = np.array([leaf.feature for leaf in solid.leaves])[pairs]
    keys = np.sort(faces, axis=1)
    order = np.lexsort((keys[:, 1], keys[:, 0]))
    starts = np.flatnonzero(np.any(np.diff(keys[order], axis=0, prepend=-1) != 0, axis=1))
    joints = SharedFeatures(solid.boundary, JOINT_ROOM * within)
    found: list[OwnPairs] = []
    beside = 0
    for rows in np.split(order, starts[1:]):
        if not len(rows):
            continue
        one, other = (int(k) for k in keys[rows[0]])
        group = pairs[rows]
        if one == other:
            group, count = _within_face(solid, group)
            beside += count
        if len(group):
            found.append(OwnPairs((one, other), group, joints.between(one, other)))
    return found, beside


def _within_face(solid: SolidModel, pairs: Ints) -> tuple[Ints, int]:
    """Of pairs of one face: those that have to be looked at, and how many leaves beside each other
    may meet there."""
    leaf = solid.leaves[int(pairs[0, 0])]
    surface = surface_of(solid.boundary, solid.boundary.face_parts[leaf.feature].charts, leaf.chart)
    if surface.proof == "theorem":
        return pairs[:0], 0
    rows = np.array([solid.leaves[k].reals[:4] for k in pairs.ravel()]).reshape(-1, 2, 4)
    if surface.periodic:
        rows = _turned_near(rows)
    low = np.minimum(rows[:, 0, 0::2], rows[:, 1, 0::2])
    high = np.maximum(rows[:, 0, 1::2], rows[:, 1, 1::2])
    apart = np.maximum(rows[:, 0, 0::2], rows[:, 1, 0::2]) > np.minimum(
        rows[:, 0, 1::2], rows[:, 1, 1::2]
    )
    touching = ~apart.any(axis=1)
    hulls = np.stack([low[:, 0], high[:, 0], low[:, 1], high[:, 1]], axis=1)
    simple = touching.copy()
    simple[touching] = one_to_one(surface, hulls[touching])
    return pairs[~touching], int((touching & ~simple).sum())


def _turned_near(rows: Array) -> Array:
    """With u of the second a turn less or more where it is nearer so."""
    middles = rows[:, :, 0] + rows[:, :, 1]
    turns = np.round((middles[:, 0] - middles[:, 1]) / (4.0 * np.pi))
    near = rows.copy()
    near[:, 1, :2] += 2.0 * np.pi * turns[:, None]
    return near


def one_to_one(surface: Surface, rows: Array) -> NDArray[np.bool_]:
    """Over which rectangles (n, 4) of parameters a surface is proven not to meet itself.

    Its tangents differ from those in the middle by less than what these have across each other, so
    that x(p) - x(q) cannot vanish.
    """
    if not len(rows):
        return np.zeros(0, dtype=bool)
    whole = np.ones(len(rows), dtype=bool)
    for k, breaks in enumerate(surface.analytic_breaks()):
        for at in np.asarray(breaks).tolist():
            whole &= ~((rows[:, 2 * k] < at) & (at < rows[:, 2 * k + 1]))
    proven = np.zeros(len(rows), dtype=bool)
    if not whole.any():
        return proven
    kept = rows[whole]
    d = surface_derivatives(surface, kept)
    hu, hv = 0.5 * (kept[:, 1] - kept[:, 0]), 0.5 * (kept[:, 3] - kept[:, 2])
    across = np.array([_across(surface.jet(0.5 * (a + b), 0.5 * (c + e))) for a, b, c, e in kept])
    with np.errstate(all="ignore"):
        off_u = (d[:, 2] * hu + d[:, 3] * hv) / across[:, 0]
        off_v = (d[:, 3] * hu + d[:, 4] * hv) / across[:, 1]
        proven[whole] = off_u + off_v < 1.0
    return proven


def _across(jet: Any) -> tuple[float, float]:
    """The length of each tangent across the other."""
    area = float(np.linalg.norm(np.cross(jet[1], jet[2])))
    lengths = [float(np.linalg.norm(jet[k])) for k in (2, 1)]
    return tuple(area / x if x > 0.0 else 0.0 for x in lengths)  # type: ignore[return-value]


class SharedFeatures:
    """The edges and vertices that faces have in common, as points with radii round them, of `least`
    at least, length."""

    def __init__(self, boundary: PackedParts, least: float) -> None:
        self.boundary, self.least = boundary, least
        self.edges: dict[int, Array] = {}
        lengths: dict[int, float] = {}
        around: dict[tuple[int, int], set[tuple[str, int]]] = defaultdict(set)
        users: dict[tuple[str, int], set[int]] = defaultdict(set)
        for number, face in enumerate(boundary.face_parts):
            for j, _ in face.loop:
                users["edge", j].add(number)
                for v in _ends(boundary, j):
                    users["vertex", v].add(number)
                    lengths[v] = min(lengths.get(v, np.inf), self._length(j))
            for apex in face.apexes:
                users["vertex", apex.vertex].add(number)
                around[number, number].add(("vertex", apex.vertex))
        for part, faces in users.items():
            for pair in combinations(sorted(faces), 2):
                around[pair].add(part)
        self.around, self.lengths = around, lengths

    def between(self, one: int, other: int) -> Array:
        """(m, 4) of two faces, or of one and its collapsed sides."""
        parts = sorted(self.around.get((one, other), ()))
        found = np.concatenate([np.zeros((0, 4)), *self._points(parts)])
        found[:, 3] = np.maximum(found[:, 3], self.least)
        return found

    def _points(self, parts: list[tuple[str, int]]) -> Iterator[Array]:
        for kind, number in parts:
            if kind == "edge":
                yield self._along(number)
            else:
                radius = VERTEX_SHARE * min(self.lengths.get(number, np.inf), self.boundary.size)
                yield np.array([[*self.boundary.vertex_points[number], radius]])

    def _along(self, edge: int) -> Array:
        """Points of an edge, each with how far the next ones are from it."""
        if edge not in self.edges:
            curve = self.boundary.edge_parts[edge].curve
            ts = np.linspace(curve.first, curve.last, JOINT_PARTS + 1)
            points = np.array([curve.point(float(t)) for t in ts])
            steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
            radii = np.maximum(np.append(steps, 0.0), np.insert(steps, 0, 0.0))
            self.edges[edge] = np.column_stack([points, radii])
        return self.edges[edge]

    def _length(self, edge: int) -> float:
        return float(self._along(edge)[:, 3].sum())


def _ends(boundary: PackedParts, edge: int) -> list[int]:
    part = boundary.edge_parts[edge]
    return [v for v in (part.first, part.last) if v is not None]
