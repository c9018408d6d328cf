"""Solids that touch all round, so that nothing moves them apart: a pin in a hole of its diameter.

Around each part of B's boundary that is near A, one potential is sought with B's part above it and
A's boundary below it. Then the part is nowhere deep in A (docs/closing.md, "Held all round").
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.kernels.entries.solids import local_side, part_extents
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.torus_potential import (
    AXIS_OF,
    CENTRE_OF,
    CIRCLE_OF,
    CONE_OF,
    TORUS_THROUGH,
)
from standoff.solids.spatial.leaves import Leaf
from standoff.solids.spatial.minimum import SearchOptions, leaf_jet_of, started
from standoff.solids.spatial.pair import PlacedPair, middle_of, references_of
from standoff.solids.spatial.points import signed_distances
from standoff.solids.spatial.solid_model import SolidModel
from standoff.solids.spatial.tolerances import BESIDE_CONTACT, BESIDE_DEPTH
from standoff.typing import Array, Ints

# Halvings of a leaf: at a corner down to the tolerance, in both parameters.
MOST_CUTS = 70
# Middles of leaves that are tried for a point of A outside B.
MOST_MIDDLES = 64
# Cosine of two slopes from which on both potentials grow along their sum.
LEAST_COMMON = -0.9
# By how much a slope changes over a part, at most; a larger part is halved.
MOST_CHANGE = 0.8
# Boxes of potentials and points, each with one of both solids as A.
MOST_EVALUATIONS = 2_000_000
# The same of solids that are pressed into each other, where another bound is known.
MOST_PRESSED = 250_000
# Parts from which on none is halved because it is not joined to another one.
MOST_PARTS = 1_000
# Potentials that are tried for one part.
MOST_TRIED = 6
# What the kernel needs of work space.
WORK = 2048


def depth_bound(pair: PlacedPair, tolerance: float, depth: float = 0.0) -> float:
    """How deep a point of one solid's boundary is in the other, at most; inf where it is not
    proven.

    Parameters
    ----------
    pair : PlacedPair
    tolerance : float
        The potentials may be missed by this, length; the bound is twice as much.
    depth : float
        By how much less than 0 they may be besides, length.
    """
    for each in (pair, pair.swapped()):
        if _Sides(each, tolerance, depth).hold():
            return 2.0 * tolerance + depth
    return float(np.inf)


class _BoundaryPart(NamedTuple):
    """A part of B's boundary beside which A's boundary is below one potential, or far away.

    Attributes
    ----------
    face : B's.
    centre, half : of a box around it, in B's frame.
    beside : a point that is outside A if the part is: its middle, or above it.
    slope : of the potential in the middle; zero of a part that is far away.
    change : of the slope over the part and what is near it, at most.
    seen : whether the middle is on B, so that `beside` decides.
    potential : which one it is: its kind and numbers; empty: none.
    piece : B's leaf, the rectangle, and how often it was halved.
    settled : whether `beside` decides for the whole rectangle, on B or off it.
    """

    face: int
    centre: Array
    half: Array
    beside: Array
    slope: Array
    change: float
    seen: bool
    potential: tuple[float, ...]
    piece: tuple[int, Array, int]
    settled: bool


class _Sides:
    """The search for potentials between B's parts and A's boundary."""

    def __init__(self, pair: PlacedPair, tolerance: float, depth: float) -> None:
        self.pair, self.pressed, self.tolerance = pair, depth > 0.0, tolerance + 0.5 * depth
        self.near = max(BESIDE_CONTACT * pair.size, BESIDE_DEPTH * self.tolerance)
        self.packed_a = _shifted(pair.a, 0.5 * depth)
        # a larger change only has to be known where a part that is not joined is halved
        self.most_change = np.finfo(float).max if self.pressed else MOST_CHANGE
        self.faces_a = np.array([k for k, leaf in enumerate(pair.a.leaves) if leaf.dim == 2])
        self.centres = np.array([pair.a.leaves[k].centre for k in self.faces_a])
        self.radii = np.array([np.linalg.norm(pair.a.leaves[k].half) for k in self.faces_a])
        self.parts: list[_BoundaryPart] = []
        self.counts = np.zeros(8, dtype=np.int64)

    def hold(self) -> bool:
        """Is no point of B's boundary deeper in A than twice the tolerance, and A not inside B?"""
        pair = self.pair
        faces = [k for k, leaf in enumerate(pair.b.leaves) if leaf.dim == 2]
        if not (len(self.faces_a) and faces):  # a point
            return False
        waiting = [(leaf, pair.b.leaves[leaf].reals[:4], 0) for leaf in faces]
        while waiting:
            if not all(self._part(*piece) for piece in waiting):
                return False
            bad = self._not_joined()
            if bad.any() and len(self.parts) >= MOST_PARTS:
                return False
            split = [part.piece for k, part in enumerate(self.parts) if bad[k]]
            self.parts = [part for k, part in enumerate(self.parts) if not bad[k]]
            waiting = [
                (leaf, half, cuts + 1)
                for leaf, box, cuts in split
                for half in self._halves(leaf, box)
            ]
        return self._outside() and self._other_outside()

    def _outside(self) -> bool:
        """Is each shell of B known to be outside A?"""
        seen = [part for part in self.parts if part.seen or (self.pressed and part.settled)]
        if not seen:
            return False
        told = signed_distances(self.pair.a, np.array([part.beside for part in seen]))
        known = {part.face for part in seen if part.seen}
        report = self.pair.b.report
        shells = getattr(report, "shells", ()) or (tuple(range(self.pair.b.boundary.n_faces)),)
        return bool((told.lower_bound > 0.0).all()) and all(known & set(each) for each in shells)

    def _other_outside(self) -> bool:
        """Is a point of A's boundary outside B?"""
        pair = self.pair
        middles = [
            leaf_jet_of(pair.a.packed, k, *middle_of(pair.a, k))[0]
            for k in self.faces_a
            if not pair.a.leaves[k].cut
        ]
        spots = np.vstack([references_of(pair.a), *middles[:MOST_MIDDLES]])
        told = signed_distances(pair.b, pair.in_b(spots @ pair.ra.T + pair.pa))
        return bool((told.lower_bound > self.near).any())

    def _part(self, leaf: int, box: Array, cuts: int) -> bool:
        """Is a part of B's leaf far from A's boundary, or on one side of it, whole or in halves?"""
        centre, half = self._extents(leaf, box)
        middle = self.pair.in_a(centre @ self.pair.rb.T + self.pair.pb)
        away = np.linalg.norm(self.centres - middle, axis=1)
        near = self.faces_a[away <= self.radii + np.linalg.norm(half) + self.near]
        for over in self._potentials(near, middle):
            told = self._asked(leaf, box, over, near)
            if told[0] > 0.0 and told[7] <= self.most_change:
                face = self.pair.b.leaves[leaf].feature
                potential = _potential(self.pair.a.leaves[over]) if over >= 0 else ()
                # all of the rectangle, moved until it is above the potential, is near to it
                own = leaf_jet_of(self.pair.b.packed, leaf, *box.reshape(2, 2).mean(axis=1))[0]
                on_b = self.pair.in_a(own @ self.pair.rb.T + self.pair.pb)
                lift = float(np.linalg.norm(told[1:4] - on_b))
                moved = self.tolerance + lift - 0.5 * self.near + 2.0 * float(np.linalg.norm(half))
                part = _BoundaryPart(
                    face, centre, half, told[1:4], told[4:7], float(told[7]), told[8] > 0.0,
                    potential, (leaf, box, cuts), over >= 0 and moved < self.near,
                )  # fmt: skip
                self.parts.append(part)
                return True
        most = MOST_PRESSED if self.pressed else MOST_EVALUATIONS
        if cuts >= MOST_CUTS or self.counts[0] + 2 * self.counts[1] > most:
            return False
        return all(self._part(leaf, half, cuts + 1) for half in self._halves(leaf, box))

    def _potentials(self, near: Ints, middle: Array) -> list[int]:
        """-1, for none; then leaves of A that have a potential of their own, one leaf for
        each, the nearest first."""
        leaves = self.pair.a.leaves
        known = [int(k) for k in near if leaves[k].kind >= 0]
        known.sort(key=lambda k: float(np.linalg.norm(leaves[k].centre - middle)))
        first: dict[tuple[float, ...], int] = {}
        for k in known:
            first.setdefault(_potential(leaves[k]), k)
        return [-1, *list(first.values())[:MOST_TRIED]]

    def _halves(self, leaf: int, box: Array) -> tuple[Array, Array]:
        long_u, long_v = self.pair.b.leaves[leaf].reals[S.FIRST : S.FIRST + 2]
        k = 0 if long_u * (box[1] - box[0]) >= long_v * (box[3] - box[2]) else 2
        first, other = box.copy(), box.copy()
        first[k + 1] = other[k] = 0.5 * (box[k] + box[k + 1])
        return first, other

    def _extents(self, leaf: int, box: Array) -> tuple[Array, Array]:
        """(middle, half extents) of a box around a part of B, in B's frame."""
        out = np.zeros(6)
        part_extents(self.pair.b.packed, np.eye(3).ravel(), leaf, np.ascontiguousarray(box), out)
        return out[:3], out[3:]

    def _asked(self, leaf: int, box: Array, over: int, near: Ints) -> Array:
        pair, shift = self.pair, float(np.linalg.norm(self.pair.relative[9:]))
        told, _ = started(SearchOptions(self.tolerance), pair.size, shift)
        local_side(
            (self.packed_a, pair.b.packed),
            pair.relative,
            np.array([leaf, over], dtype=np.int64),
            near,
            np.array([*box, self.tolerance, self.near]),
            told,
            np.empty(WORK),
            self.counts,
        )
        return told

    def _not_joined(self) -> NDArray[np.bool_]:
        """Of each part, may it have points in common with another one whose slope does not point
        to the same side, so that not both are outside A if one is?"""
        parts = self.parts
        centres, halves = np.array([p.centre for p in parts]), np.array([p.half for p in parts])
        slopes, changes = np.array([p.slope for p in parts]), np.array([p.change for p in parts])
        gaps = np.abs(centres[:, None] - centres[None]) - halves[:, None] - halves[None]
        numbers: dict[tuple[float, ...], int] = {(): -1}
        which = np.array([numbers.setdefault(p.potential, len(numbers)) for p in parts])
        held = which >= 0
        meet = (gaps.max(axis=2) <= BESIDE_CONTACT * self.pair.size) & held[:, None] & held[None]
        meet &= which[:, None] != which[None]
        least = slopes @ slopes.T - changes[:, None] - changes[None]
        apart = least <= LEAST_COMMON
        if self.pressed:  # the slopes change on the way as well
            grown = np.sqrt(np.maximum(0.5 * (1.0 + least), 0.0)) - changes[None]
            apart = np.minimum(grown, grown.T) <= 4.0 / (BESIDE_DEPTH - 2.0)
        settled = np.array([p.settled and self.pressed for p in parts])
        return np.asarray((meet & apart).any(axis=1) & ~settled)


def _shifted(solid: SolidModel, by: float) -> tuple[Any, Any, Any, Any]:
    """A solid as the kernels read it, with its faces' own potentials greater by a length."""
    ints, reals, own, numbers = solid.packed
    numbers = numbers.copy()
    for k, leaf in enumerate(solid.leaves):
        row = numbers[own[S.R_LEAVES] + S.LEAF_STRIDE * k + S.NATURAL_REALS :][:9]
        less = by * row[0]
        if leaf.kind in (AXIS_OF, CENTRE_OF):
            row[1] -= less
        elif leaf.kind == CIRCLE_OF:
            row[2] -= less
        elif leaf.kind == TORUS_THROUGH:
            row[3:6] -= less * row[6:]
        elif leaf.kind == CONE_OF:
            row[3:6] += less / row[2] * row[6:]
    return ints, reals, own, numbers


def _potential(leaf: Leaf) -> tuple[float, ...]:
    """What the natural potential of a face's leaf is made of; a sphere's axis says nothing."""
    count = 6 if leaf.kind == CENTRE_OF else 9
    return (leaf.kind, *leaf.reals[S.NATURAL_REALS : S.NATURAL_REALS + count].tolist())
