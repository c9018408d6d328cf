"""Solids that touch all round, so that nothing moves them apart: a pin in a hole of its diameter.

Around each part of B's boundary that is near A, one potential is sought with B's part above it and
A's boundary below it. Then the part is nowhere deep in A (docs/closing.md, "Held all round").
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.geometry.validation import Array
from standoff.kernels.entries.solids import local_side, part_extents
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.torus_potential import CENTRE_OF
from standoff.solids.spatial.leaves import Leaf
from standoff.solids.spatial.minimum import Sought, leaf_jet_of, started
from standoff.solids.spatial.pair import PlacedPair, middle_of, references_of
from standoff.solids.spatial.points import signed_distances
from standoff.solids.spatial.tolerances import BESIDE_CONTACT

IntArray = NDArray[np.int64]

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
# Potentials that are tried for one part.
MOST_TRIED = 6
# What the kernel needs of work space.
WORK = 2048


def depth_bound(pair: PlacedPair, tolerance: float) -> float:
    """How deep a point of one solid's boundary is in the other, at most; inf where it is not
    proven.

    Parameters
    ----------
    pair : PlacedPair
    tolerance : float
        The potentials may be missed by this, length; the bound is twice as much.
    """
    for each in (pair, pair.swapped()):
        if _Sides(each, tolerance).hold():
            return 2.0 * tolerance
    return float(np.inf)


class _Part(NamedTuple):
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
    """

    face: int
    centre: Array
    half: Array
    beside: Array
    slope: Array
    change: float
    seen: bool
    potential: tuple[float, ...]


class _Sides:
    """The search for potentials between B's parts and A's boundary."""

    def __init__(self, pair: PlacedPair, tolerance: float) -> None:
        self.pair, self.tolerance = pair, tolerance
        self.near = BESIDE_CONTACT * pair.size
        self.faces_a = np.array([k for k, leaf in enumerate(pair.a.leaves) if leaf.dim == 2])
        self.centres = np.array([pair.a.leaves[k].centre for k in self.faces_a])
        self.radii = np.array([np.linalg.norm(pair.a.leaves[k].half) for k in self.faces_a])
        self.parts: list[_Part] = []
        self.counts = np.zeros(8, dtype=np.int64)

    def hold(self) -> bool:
        """Is no point of B's boundary deeper in A than twice the tolerance, and A not inside B?"""
        pair = self.pair
        faces = [k for k, leaf in enumerate(pair.b.leaves) if leaf.dim == 2]
        if not (len(self.faces_a) and faces):  # a point
            return False
        if not all(self._part(leaf, pair.b.leaves[leaf].reals[:4], 0) for leaf in faces):
            return False
        return _joined(self.parts, self.near) and self._outside() and self._other_outside()

    def _outside(self) -> bool:
        """Is each shell of B known to be outside A?"""
        seen = [part for part in self.parts if part.seen]
        if not seen:
            return False
        told = signed_distances(self.pair.a, np.array([part.beside for part in seen]))
        known = {part.face for part in seen}
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
            if told[0] > 0.0 and told[7] <= MOST_CHANGE:
                face = self.pair.b.leaves[leaf].feature
                potential = _potential(self.pair.a.leaves[over]) if over >= 0 else ()
                slope, change = told[4:7], float(told[7])
                part = _Part(face, centre, half, told[1:4], slope, change, told[8] > 0.0, potential)
                self.parts.append(part)
                return True
        if cuts >= MOST_CUTS or self.counts[0] + 2 * self.counts[1] > MOST_EVALUATIONS:
            return False
        return all(self._part(leaf, half, cuts + 1) for half in self._halves(leaf, box))

    def _potentials(self, near: IntArray, middle: Array) -> list[int]:
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

    def _asked(self, leaf: int, box: Array, over: int, near: IntArray) -> Array:
        pair, shift = self.pair, float(np.linalg.norm(self.pair.relative[9:]))
        told, _ = started(Sought(self.tolerance), pair.size, shift)
        local_side(
            (pair.a.packed, pair.b.packed),
            pair.relative,
            np.array([leaf, over], dtype=np.int64),
            near,
            np.array([*box, self.tolerance, self.near]),
            told,
            np.empty(WORK),
            self.counts,
        )
        return told


def _potential(leaf: Leaf) -> tuple[float, ...]:
    """What the natural potential of a face's leaf is made of; a sphere's axis says nothing."""
    count = 6 if leaf.kind == CENTRE_OF else 9
    return (leaf.kind, *leaf.reals[S.NATURAL_REALS : S.NATURAL_REALS + count].tolist())


def _joined(parts: list[_Part], near: float) -> bool:
    """Do the slopes of parts that may have points in common point to one side, so that both are
    outside A if one is?"""
    held = [part for part in parts if part.potential]
    if not held:
        return True
    centres, halves = np.array([p.centre for p in held]), np.array([p.half for p in held])
    slopes, changes = np.array([p.slope for p in held]), np.array([p.change for p in held])
    gaps = np.abs(centres[:, None] - centres[None]) - halves[:, None] - halves[None]
    numbers: dict[tuple[float, ...], int] = {}
    which = np.array([numbers.setdefault(p.potential, len(numbers)) for p in held])
    meet = (gaps.max(axis=2) <= near) & (which[:, None] != which[None])
    least = slopes @ slopes.T - changes[:, None] - changes[None]
    return bool((least[meet] > LEAST_COMMON).all())
