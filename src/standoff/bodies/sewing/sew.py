"""From patches to the vertices, edges and faces of a body."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from standoff.bodies.proofs import PatchProof
from standoff.bodies.sewing.corners import Outline, Stretch, outline
from standoff.bodies.sewing.correspondence import Correspondence, correspond, isoline
from standoff.bodies.sewing.matching import match
from standoff.bodies.sewing.patches import Patch, check_patches, cut_patches, grid_points
from standoff.bodies.sewing.shell import check_shell, outward_senses
from standoff.bodies.sewing.sides import SENSES
from standoff.bodies.tolerances import MAX_SPREAD, SEWING_TOLERANCE
from standoff.bodies.topology import Apex, Edge, Face
from standoff.errors import BodyError
from standoff.geometry.pcurves import Pcurve
from standoff.geometry.surface_curves import SurfaceCurve
from standoff.geometry.surfaces import Surface
from standoff.geometry.validation import Array, positive
from standoff.real_numbers import shown


@dataclass(frozen=True, eq=False)
class Sewn:
    """A body's parts as they were sewn.

    size : diagonal of the patches' box, length.
    tolerance : within which sides and corners were joined, length.
    residual : the greatest distance of joined points that was met, length.
    senses, labels, proofs : for every face +1 where x_u cross x_v points outward, else -1; the
        patch that it is or was cut from; its convexity.
    """

    vertices: Array
    edges: list[Edge]
    faces: list[Face]
    notes: list[str]
    size: float
    tolerance: float
    residual: float
    senses: list[int]
    labels: list[str]
    proofs: list[PatchProof]


def sew(patches: Sequence[Any], tolerance: float | None = None) -> Sewn:
    """Join patches along their sides into one closed shell that faces outward.

    Parameters
    ----------
    patches : surfaces with a finite domain.
    tolerance : how far joined sides may be apart, length; None: SEWING_TOLERANCE of the size.

    Raises
    ------
    BodyError
        Sides that match none or several, two shells, no volume; the message names the patches.
    """
    given: Any = patches
    no_list = isinstance(given, np.ndarray) and given.ndim == 0
    if no_list or isinstance(patches, Surface) or not isinstance(patches, Iterable):
        raise BodyError(
            f"patches = {shown(patches)}: give a sequence of surfaces that close a shell.",
            "patches",
            patches,
        )
    patches = list(patches)
    check_patches(patches)
    size = _size(patches)
    tolerance = SEWING_TOLERANCE * size if tolerance is None else positive(tolerance, "tolerance")
    if tolerance >= 0.1 * size:
        raise BodyError(
            f"tolerance = {tolerance:.3g} is not a small part of the patches' size {size:.3g}.",
            "tolerance",
            tolerance,
        )
    cut, notes = cut_patches(patches, tolerance)
    shape = outline(cut, tolerance)
    pairs = match([s for row in shape.stretches for s in row], tolerance)
    check_shell(cut, shape, pairs)
    found = [_joined(a, b, size, tolerance) for a, b in pairs]
    sign, turned = outward_senses(cut, pairs, [c.sense for c in found], tolerance)
    edges = [
        Edge(
            SurfaceCurve(cut[a.patch].surface, isoline(a.side), a.side.first, a.side.last),
            a.first,
            a.last,
        )
        for a, _ in pairs
    ]
    faces = _faces(cut, shape, pairs, found, sign)
    residual = max([shape.spread, *(c.residual for c in found)])
    return Sewn(
        shape.vertices,
        edges,
        faces,
        notes + turned,
        size,
        tolerance,
        residual,
        sign,
        [patch.label for patch in cut],
        [patch.proof for patch in cut],
    )


def _joined(one: Stretch, other: Stretch, size: float, tolerance: float) -> Correspondence:
    found = correspond(one, other, size)
    if found.residual > MAX_SPREAD * tolerance:
        raise BodyError(
            f"{one.label} and {other.label} part by {found.residual:.3g} between their ends, "
            f"tolerance {tolerance:.3g}: make them the same curve, or give a greater tolerance.",
            "tolerance",
            tolerance,
        )
    return found


def _size(patches: Sequence[Surface]) -> float:
    points = np.concatenate([grid_points(surface).reshape(-1, 3) for surface in patches])
    size = float(np.linalg.norm(np.ptp(points, axis=0)))
    if not (np.isfinite(size) and size > 0.0):
        raise BodyError(
            f"The patches' size is {size}: they have no extent or no finite points.",
            "patches",
            patches,
        )
    return size


def _faces(
    patches: Sequence[Patch],
    shape: Outline,
    pairs: Sequence[tuple[Stretch, Stretch]],
    found: Sequence[Correspondence],
    sign: Sequence[int],
) -> list[Face]:
    uses: list[list[tuple[int, int, Pcurve]]] = [[] for _ in patches]
    for j, ((a, b), c) in enumerate(zip(pairs, found, strict=True)):
        sense = SENSES[a.side.name] * sign[a.patch]
        uses[a.patch].append((j, sense, isoline(a.side)))
        sense = SENSES[b.side.name] * c.sense * sign[b.patch]
        uses[b.patch].append((j, sense, c.pcurve))
    faces = []
    for p, patch in enumerate(patches):
        apexes = tuple(
            Apex(vertex, side.level, side.first, side.last, side=side.name)
            for side, vertex in shape.collapsed[p]
        )
        loop = tuple((j, sense) for j, sense, _ in uses[p])
        pcurves = tuple(pcurve for _, _, pcurve in uses[p])
        faces.append(Face((patch.surface,), loop, apexes, pcurves))
    return faces
