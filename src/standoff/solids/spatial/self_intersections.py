"""Where a solid's boundary meets itself away from where its faces are joined."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.body import Body
from standoff.bodies.features import Feature
from standoff.bodies.tessellation import surface_of
from standoff.kernels.entries.queries import on_face
from standoff.kernels.entries.solids import meet_own_leaves
from standoff.kernels.solids import spatial_self as K
from standoff.motion.pose import Pose
from standoff.solids.spatial.minimum import SearchOptions, leaf_jet_of, started
from standoff.solids.spatial.own_pairs import OwnPairs, own_pairs
from standoff.solids.spatial.pair import PlacedPair
from standoff.solids.spatial.solid_model import SolidModel
from standoff.solids.spatial.ties import starts
from standoff.solids.spatial.tolerances import (
    LEAST_ANGLE,
    LEAST_LENGTH,
    MEETING,
    MEETING_SLACKS,
    PROVEN_SHARE,
    SHORT_WAY,
)
from standoff.typing import Array
from standoff.wording import counted

# Evaluations for one pair of leaves, at most.
BUDGET = 20_000
# Numbers that the pairs of boxes of one pair of leaves need.
WORK = 2048
# Steps of the way from one point of a face to another.
ON_THE_WAY = 16
Key = tuple[int, int]

NONE_PROVEN = "no self-intersection: proven for the whole boundary"
NONE_OUTSIDE = (
    "no self-intersection: proven, except close to edges and vertices, where none was looked for"
)
NONE_FOUND = "no self-intersection was found, but there is no proof that there is none"
"""Said of a boundary that meets itself nowhere, as far as that is known."""


class SelfIntersection(NamedTuple):
    """A place where two faces of a boundary meet away from where they are joined.

    Attributes
    ----------
    point_a, point_b : (3,) arrays
        One of each, own frame.
    feature_a, feature_b : Feature
        The faces; twice the same of a face that meets itself.
    gap : float
        Between the points, length; below the tolerance.
    depth : float
        How far each face reaches beyond the other there on both of its sides, length: about, and
        at least as far as it was looked for; 0 where they only come near or touch.
    """

    point_a: Array
    point_b: Array
    feature_a: Feature
    feature_b: Feature
    gap: float
    depth: float


@dataclass(frozen=True, eq=False)
class SelfIntersections:
    """What was found of a boundary that may meet itself.

    Attributes
    ----------
    places : tuple of SelfIntersection
        One of each pair of faces that meet, the deepest first.
    tolerance : float
        Faces that come nearer than this meet, length: four times the slack, and 1e-9 of the size at
        least. They cross where they reach beyond each other by more.
    apart : int
        Pairs of pieces of faces that are proven not to meet.
    beside : int
        Pairs of pieces that are proven so, but for the neighbourhood of what joins them, where it
        is not looked for: a 32nd of an edge's length round it, a thousandth of the shortest edge
        round a vertex, twice the tolerance at least.
    undecided : int
        Pairs of pieces that neither were found to meet nor are proven not to.
    """

    places: tuple[SelfIntersection, ...]
    tolerance: float
    apart: int
    beside: int
    undecided: int

    @property
    def crossings(self) -> tuple[SelfIntersection, ...]:
        """The places where faces reach beyond each other by more than the tolerance."""
        return tuple(place for place in self.places if place.depth > self.tolerance)

    @property
    def none_outside_joints(self) -> bool:
        """Is it proven that the boundary nowhere meets itself, but for the neighbourhoods of edges
        and vertices?"""
        return not self.places and self.undecided == 0

    @property
    def proven_none(self) -> bool:
        """Is it proven that the boundary nowhere meets itself?"""
        return self.none_outside_joints and self.beside == 0

    def lines(self, unit: str = "") -> list[str]:
        """What was found, in sentences."""
        after = f" {unit}" if unit else ""
        if self.proven_none:
            return [NONE_PROVEN]
        found = [told(place, self.tolerance, after) for place in self.places]
        if self.undecided:
            pairs = counted(self.undecided, "pair")
            found.append(f"undecided: {pairs} of pieces of faces, which may or may not meet")
        if not self.places:
            found.insert(0, NONE_OUTSIDE if self.none_outside_joints else NONE_FOUND)
        return found


def told(place: SelfIntersection, tolerance: float, unit: str = "") -> str:
    """A place in words."""
    x, y, z = place.point_a
    where = f"near ({x:.6g}, {y:.6g}, {z:.6g})"
    if place.feature_a == place.feature_b:
        which = f"{place.feature_a} meets itself"
    else:
        verb = "crosses" if place.depth > tolerance else "meets"
        which = f"{place.feature_a} {verb} {place.feature_b}"
    by = f", by about {place.depth:.3g}{unit}" if place.depth > tolerance else ""
    return f"{which} away from their common edges {where}{by}"


def self_intersections(solid: SolidModel) -> SelfIntersections:
    """Look for places where a solid's boundary meets itself.

    Parameters
    ----------
    solid : SolidModel

    Returns
    -------
    SelfIntersections
    """
    count = sum(leaf.dim == 2 for leaf in solid.leaves)
    every = count * (count + 1) // 2
    tolerance = max(MEETING_SLACKS * solid.slack, MEETING * solid.size)
    if isinstance(solid.boundary, Body):  # convex
        return SelfIntersections((), tolerance, every, 0, 0)
    groups, beside = own_pairs(solid, tolerance)
    places: dict[Key, SelfIntersection] = {}
    undecided = met = 0
    for group in _shared_out(groups):
        rows = _looked_at(solid, group, tolerance)
        neighbours = _neighbours(solid, group, rows, SHORT_WAY * tolerance)
        rows[neighbours, 0] = K.OPEN
        beside += int((rows[:, 0] == K.BESIDE).sum())
        undecided += int((rows[:, 0] == K.OPEN).sum())
        met += int((rows[:, 0] == K.MET).sum())
        places |= _deepest(solid, group, rows)
    ordered = sorted(places.values(), key=lambda place: (-place.depth, place.gap))
    return SelfIntersections(
        tuple(ordered), tolerance, every - beside - undecided - met, beside, undecided
    )


def _shared_out(groups: Iterable[OwnPairs]) -> Iterator[OwnPairs]:
    """The same with all pairs of faces that have nothing in common as one group."""
    alone = []
    for group in groups:
        if len(group.joint):
            yield group
        else:
            alone.append(group.leaves)
    if alone:
        yield OwnPairs((-1, -1), np.concatenate(alone), np.zeros((0, 4)))


def _looked_at(solid: SolidModel, group: OwnPairs, tolerance: float) -> Array:
    """Rows (what is found, distance, parameters) of pairs of leaves."""
    best = started(SearchOptions(PROVEN_SHARE * tolerance, BUDGET, tolerance), solid.size, 0.0)[0]
    found = np.zeros((len(group.leaves), K.FOUND_REALS))
    counts = np.zeros(8, dtype=np.int64)
    meet_own_leaves(
        solid.packed,
        np.ascontiguousarray(group.leaves).ravel(),
        np.ascontiguousarray(group.joint).ravel(),
        best,
        np.zeros(WORK),
        found.ravel(),
        counts,
    )
    return found


def _neighbours(solid: SolidModel, group: OwnPairs, rows: Array, most: float) -> NDArray[np.bool_]:
    """Of which pairs both points are on one face, with a way along it from one to the other that is
    not longer than a length: they are near because they are neighbours."""
    found = np.zeros(len(rows), dtype=bool)
    for k in np.flatnonzero(rows[:, 0] == K.MET):
        first, other = (solid.leaves[int(leaf)] for leaf in group.leaves[k])
        if first.chart != other.chart:
            continue
        surface = surface_of(
            solid.boundary, solid.boundary.face_parts[first.feature].charts, first.chart
        )
        p, q = rows[k, 2:4], rows[k, 4:6].copy()
        if surface.periodic:
            q[0] -= 2.0 * np.pi * np.round((q[0] - p[0]) / (2.0 * np.pi))
        places = p + np.linspace(0.0, 1.0, ON_THE_WAY + 1)[:, None] * (q - p)
        points = np.array([surface.jet(float(u), float(v))[0] for u, v in places])
        found[k] = np.linalg.norm(np.diff(points, axis=0), axis=1).sum() <= most
    return found


def _deepest(solid: SolidModel, group: OwnPairs, rows: Array) -> dict[Key, SelfIntersection]:
    """Of each pair of faces that meet the place where they cross deepest, of those found."""
    places: dict[Key, SelfIntersection] = {}
    hits = np.flatnonzero(rows[:, 0] == K.MET)
    if not len(hits):
        return places
    pair = PlacedPair(solid, solid, Pose.identity(), Pose.identity())
    common = MEETING * solid.size
    for k in hits:
        leaves = group.leaves[k]
        first = np.array([rows[k, 1], *leaves, *rows[k, 2:], 0.0])
        place = _place(solid, first)
        apart = place.gap > common
        # how deep they cross is known where both have a point: these may only be beside each other
        place = place._replace(depth=0.0) if apart else place
        key = place.feature_a.index, place.feature_b.index
        known = places.get(key)
        if known is None or known.depth < place.depth:
            places[key] = place
        # and where Newton's method ended at the rim of a face: other points of the same leaves
        if places[key].depth == 0.0 and (apart or len(group.joint) == 0):
            tried = np.vstack([first[3:7], starts(pair, first)])
            for row in pair.found_from(first, tried, common):
                other = _place(solid, row)
                if other.depth > places[key].depth and _away(group.joint, other):
                    places[key] = other
    return places


def _away(joint: Array, place: SelfIntersection) -> bool:
    """Is a place away from what joins its faces, where they always meet?"""
    off = np.linalg.norm(joint[:, :3] - place.point_a, axis=1)
    return bool((off > joint[:, 3]).all())


def _place(solid: SolidModel, row: Array) -> SelfIntersection:
    """Of a row (distance, leaf, leaf, parameters)."""
    a, b = int(row[1]), int(row[2])
    depth, jets = crossing_depth(solid, (a, b), row[3:7])
    sides = [(solid.feature_of(leaf), jet[0]) for leaf, jet in zip((a, b), jets, strict=True)]
    (first, x), (other, y) = sorted(sides, key=lambda side: side[0])
    return SelfIntersection(x, y, first, other, float(row[0]), depth)


# How far two faces of one boundary reach beyond each other where they cross.

# Halvings of a length, from the solid's size on, and of what is left of it.
HALVINGS, REFINED = 40, 6


def crossing_depth(
    solid: SolidModel, leaves: tuple[int, int], at: Array
) -> tuple[float, tuple[Array, Array]]:
    """(depth, jets (6, 3) of both) of two faces' leaves at parameters (4,) of a common point.

    The depth is the least distance from one face's tangent plane to what the other reaches, on
    either side, seen across the line in which they cross; 0 where they only touch.
    """
    jets = (
        leaf_jet_of(solid.packed, leaves[0], *at[:2]),
        leaf_jet_of(solid.packed, leaves[1], *at[2:]),
    )
    normals = []
    for jet in jets:
        normal = np.cross(jet[1], jet[2])
        normals.append(normal / max(float(np.linalg.norm(normal)), LEAST_LENGTH))
    line = np.cross(normals[0], normals[1])
    sine = float(np.linalg.norm(line))
    if sine <= LEAST_ANGLE:
        return 0.0, jets
    reaches = [
        _reach(solid, leaf, uv, jet, sign * np.cross(line / sine, normal))
        for leaf, uv, jet, normal in zip(leaves, (at[:2], at[2:]), jets, normals, strict=True)
        for sign in (-1.0, 1.0)
    ]
    return sine * min(reaches), jets


def _reach(solid: SolidModel, leaf: int, uv: Array, jet: Array, way: Array) -> float:
    """How far a face reaches from its point in a direction of its tangent plane, length: the
    longest of some lengths at whose end it still is, found by halving."""
    chart = solid.leaves[leaf].chart
    step = np.linalg.lstsq(jet[1:3].T, way, rcond=None)[0]

    def is_on(length: float) -> bool:
        u, v = uv + length * step
        return bool(on_face(solid.boundary.ints, solid.boundary.reals, chart, float(u), float(v)))

    low, high = 0.0, solid.size
    for _ in range(HALVINGS):
        if is_on(high):
            low = high
            break
        high *= 0.5
    high = min(2.0 * low, solid.size)
    for _ in range(REFINED):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if is_on(middle) else (low, middle)
    return low
