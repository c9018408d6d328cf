"""Patches prepared for sewing: cut at knots, at seams, and until normals fit a hemisphere."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np

from standoff.bodies.proofs import PatchProof, prove_patch
from standoff.bodies.sewing.sides import SIDE_NAMES, PatchSide, gap
from standoff.checks.real_numbers import shown
from standoff.errors import BodyError
from standoff.geometry.surfaces import Surface
from standoff.typing import Array

# Halvings of one patch before it counts as singular: into up to 2^8 pieces.
PATCH_HALVINGS = 8
# Points along u and v from which a patch's extent is computed.
GRID = 5


@dataclass(frozen=True, eq=False)
class SewnPatch:
    """A surface with a finite domain; `given` is its number in the caller's list."""

    surface: Surface
    given: int
    cut: bool = False

    @cached_property
    def proof(self) -> PatchProof:
        return prove_patch(self.surface)

    @property
    def label(self) -> str:
        if not self.cut:
            return f"patch {self.given}"
        u0, u1, v0, v1 = self.surface.domain
        return f"patch {self.given} (u {u0:.6g}..{u1:.6g}, v {v0:.6g}..{v1:.6g})"

    def side(self, name: str) -> PatchSide:
        return PatchSide.of(self.surface, self.label, name)

    def middle(self, along: str) -> float:
        """Where to halve it: at the middle of its parameter or, if uneven, of its longer side."""
        ends = (("v0", "v1"), ("u0", "u1"))[along == "v"]
        side = max((self.side(name) for name in ends), key=lambda side: side.length)
        return side.middle if side.uneven else 0.5 * (side.first + side.last)

    def halves(self, along: str) -> tuple[SewnPatch, SewnPatch]:
        u0, u1, v0, v1 = self.surface.domain
        middle = self.middle(along)
        if along == "u":
            parts = (u0, middle, v0, v1), (middle, u1, v0, v1)
        else:
            parts = (u0, u1, v0, middle), (u0, u1, middle, v1)
        first, second = (
            SewnPatch(self.surface.restricted(*part), self.given, True) for part in parts
        )
        return first, second


def grid_points(surface: Surface, count: int = GRID) -> Array:
    """Points of a patch on a regular grid that includes its boundary, (count, count, 3)."""
    u0, u1, v0, v1 = surface.domain
    return np.array(
        [
            [surface.jet(u, v)[0] for v in np.linspace(v0, v1, count)]
            for u in np.linspace(u0, u1, count)
        ]
    )


def check_patches(patches: Sequence[Any]) -> None:
    """Raise BodyError if something given is not a patch."""
    if not len(patches):
        raise BodyError("No patches: give patches that close a shell.", "patches", patches)
    for k, surface in enumerate(patches):
        if not isinstance(surface, Surface):
            raise BodyError(
                f"patch {k} is {shown(surface)}: give a Surface with a finite domain.",
                part=("patch", k),
            )
        if not np.isfinite(surface.domain).all():
            raise BodyError(
                f"patch {k} is an unbounded {type(surface).__name__} (domain "
                f"{surface.domain}): cut a patch from it with .restricted(u0, u1, v0, v1).",
                part=("patch", k),
            )


def cut_patches(patches: Sequence[Surface], tolerance: float) -> tuple[list[SewnPatch], list[str]]:
    """Patches that are smooth inside, with four open sides, and notes on what was cut."""
    found: list[SewnPatch] = []
    notes: list[str] = []
    for k, surface in enumerate(patches):
        waiting = [(piece, 0) for piece in _at_breaks(surface, k)]
        if len(waiting) > 1:
            us, vs = surface.breaks()
            notes.append(f"patch {k}: split at u = {list(us)}, v = {list(vs)}, where it is not C2")
        reasons: dict[str, int] = {}
        while waiting:
            piece, depth = waiting.pop(0)
            way = _way_to_halve(piece, tolerance)
            if way is None:
                found.append(piece)
                continue
            along, reason = way
            if depth == PATCH_HALVINGS:
                raise BodyError(
                    f"{piece.label}: {reason}, even after {depth} halvings.",
                    part=("patch", piece.given),
                )
            reasons[reason] = reasons.get(reason, 0) + 1
            waiting = [(half, depth + 1) for half in piece.halves(along)] + waiting
        notes += [f"patch {k}: halved {n} times, as {why}" for why, n in reasons.items()]
    return found, notes


def _at_breaks(surface: Surface, given: int) -> list[SewnPatch]:
    us, vs = surface.breaks()
    if not len(us) and not len(vs):
        return [SewnPatch(surface, given)]
    u0, u1, v0, v1 = surface.domain
    return [
        SewnPatch(surface.restricted(a, b, c, d), given, True)
        for a, b in pairwise([u0, *us, u1])
        for c, d in pairwise([v0, *vs, v1])
    ]


def _way_to_halve(patch: SewnPatch, tolerance: float) -> tuple[str, str] | None:
    """("u" | "v", reason) if a patch must be halved, else None."""
    sides = {name: patch.side(name) for name in SIDE_NAMES}
    _check_extent(patch, sides, tolerance)
    for along, across in (("u", "v"), ("v", "u")):
        closed = any(sides[across + end].closed(tolerance) for end in "01")
        if closed or gap(sides[along + "0"], sides[along + "1"]) <= tolerance:
            return along, f"it closes on itself along {along}"
    if not patch.proof.hemisphere:
        lengths = {
            along: sum(sides[along_side].length for along_side in ends)
            for along, ends in (("u", ("v0", "v1")), ("v", ("u0", "u1")))
        }
        return max(lengths, key=lambda k: lengths[k]), "its normals do not fit an open hemisphere"
    return None


def _check_extent(patch: SewnPatch, sides: dict[str, PatchSide], tolerance: float) -> None:
    points = grid_points(patch.surface)
    extent = float(np.linalg.norm(np.ptp(points.reshape(-1, 3), axis=0)))
    if not np.isfinite(points).all():
        raise BodyError(
            f"{patch.label} has points that are not finite.", part=("patch", patch.given)
        )
    if extent <= tolerance:
        raise BodyError(
            f"{patch.label} has no extent: {extent:.3g} across, tolerance {tolerance:.3g}.",
            "tolerance",
            tolerance,
            part=("patch", patch.given),
        )
    collapsed = [name for name in SIDE_NAMES if sides[name].collapsed(tolerance)]
    if len(collapsed) > 2 or (len(collapsed) == 2 and collapsed[0][0] != collapsed[1][0]):
        raise BodyError(
            f"{patch.label}: its sides {', '.join(collapsed)} have collapsed; only one side, or "
            "two opposite sides, may.",
            part=("patch", patch.given),
        )
