"""From joined parts to a boundary: its shells, the kinds of its edges, its box, and its packing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from standoff.bodies.angles import EdgeTurns, edge_turns, extremes
from standoff.bodies.assembly import Joined, assemble
from standoff.bodies.charts import edge_points
from standoff.bodies.crossings import Crossings
from standoff.bodies.enclosed import Enclosed, enclosed_by
from standoff.bodies.face_leaves import face_charts, grown_box
from standoff.bodies.packed_parts import PackedParts, packed_parts
from standoff.bodies.packing import Assembled, pack, without_charts
from standoff.bodies.report import BoundaryReport
from standoff.bodies.sampling import blind_charts, curve_box, inner_boxes
from standoff.bodies.sewing import sew
from standoff.bodies.tolerances import (
    LEAST_THICKNESS,
    MAX_SPREAD,
    ROUNDOFF,
    SMOOTH_ANGLE,
    VOLUME_END,
    coordinate_roundoff,
)
from standoff.errors import BodyError
from standoff.geometry.surfaces import Surface
from standoff.kernels.body import layout as L
from standoff.typing import Array, Ints

# Greatest number of a shell's faces that a message names.
MOST_NAMED = 6


def joined_patches(patches: Sequence[Surface], tolerance: float | None) -> Joined:
    """Patches sewn into shells, each facing outward."""
    sewn = sew(patches, tolerance, several=True)
    joined = assemble(
        sewn.vertices,
        sewn.edges,
        sewn.faces,
        3,
        sewn.size,
        MAX_SPREAD * sewn.tolerance,
        sewn.senses,
        trusted=True,
    )
    return replace(
        joined,
        notes=[*sewn.notes, *joined.notes],
        residual=max(joined.residual, sewn.residual),
        tolerance=sewn.tolerance,
        claims=[0] * len(joined.shells),
    )


def close(joined: Joined) -> tuple[Assembled, Ints, Array, BoundaryReport]:
    """Check the shells, find the kinds of the edges, and pack."""
    parts = joined.parts
    rough = packed_parts(parts)
    blind = blind_charts(parts, rough.ints, rough.reals)
    if blind:
        parts = without_charts(parts, blind)
        rough = packed_parts(parts)
    shells = [_enclosed(joined, rough, shell) for shell in joined.shells]
    for shell, found in zip(joined.shells, shells, strict=True):
        _check_volume(shell, found, joined.tolerance)
    cavities = _cavities(rough, joined, shells)
    for k in cavities:
        _turn_inward(parts, joined.shells[k])
    low, high = _box(packed_parts(parts), parts)
    size = float(np.linalg.norm(high - low))
    parts = _with_kinds(parts, size)
    roundoff = coordinate_roundoff(np.array([low, high]))
    shift = max(ROUNDOFF * size, roundoff)
    slack = sum((x for x in (joined.residual, parts.moved) if x > shift), 0.0)
    ints, reals = pack(parts, [], (low, high), 0.0, slack)
    inner = inner_boxes(parts, ints, reals)
    ints, reals = pack(parts, [], (low, high), 0.0, slack, inner)
    report = BoundaryReport(
        faces=len(parts.faces),
        edges=len(parts.edges),
        vertices=len(parts.vertices),
        charts=len(parts.charts),
        shells=tuple(tuple(shell) for shell in joined.shells),
        cavities=tuple(cavities),
        size=size,
        volume=sum(-s.volume if k in cavities else s.volume for k, s in enumerate(shells)),
        volume_error=sum(s.error for s in shells),
        area=sum(s.area for s in shells),
        sewing_residual=joined.residual,
        sewing_tolerance=joined.tolerance,
        slack=slack,
        coordinate_roundoff=roundoff,
        notes=tuple(joined.notes),
    )
    return parts, ints, reals, report


def _enclosed(joined: Joined, rough: PackedParts, shell: Sequence[int]) -> Enclosed:
    """What a shell encloses that faces outward: as before it was turned, but for the sign."""
    found = joined.enclosed.get(tuple(shell))
    if found is None:
        return enclosed_by(rough, shell, VOLUME_END)
    return replace(found, volume=abs(found.volume))


def _named(faces: Sequence[int]) -> str:
    dots = ", ..." if len(faces) > MOST_NAMED else ""
    return ", ".join(str(i) for i in faces[:MOST_NAMED]) + dots


def _check_volume(shell: Sequence[int], found: Enclosed, tolerance: float) -> None:
    thin = LEAST_THICKNESS * tolerance * found.area
    if found.volume <= max(found.error, thin):
        raise BodyError(
            f"Faces {_named(shell)} enclose no volume: {found.volume:.3g} at an area of "
            f"{found.area:.3g}, tolerance {tolerance:.3g}.",
            part=("face", shell[0]),
        )


def _cavities(boundary: PackedParts, joined: Joined, shells: Sequence[Enclosed]) -> list[int]:
    """Numbers of the shells that lie inside the outer one.

    Raises BodyError: shells beside each other, in a cavity, or inside the outer one and facing the
    same way.
    """
    if len(shells) == 1:
        return []
    outer = max(range(len(shells)), key=lambda k: shells[k].volume)
    inner = [k for k in range(len(shells)) if k != outer]
    spots = [_spot(boundary, shell) for shell in joined.shells]
    around = Crossings(boundary, joined.shells[outer])
    for k in inner:
        if not around.inside(spots[k]):
            raise BodyError(
                f"Faces {_named(joined.shells[k])} lie outside the shell of faces "
                f"{_named(joined.shells[outer])}: make a boundary of each shell.",
                part=("face", joined.shells[k][0]),
            )
        claims = joined.claims[outer], joined.claims[k]
        if claims[0] * claims[1] > 0:
            raise BodyError(
                f"Faces {_named(joined.shells[k])} lie inside the shell of faces "
                f"{_named(joined.shells[outer])} and face the same way: give the loops of a cavity "
                "the other way round, or leave the inner solid out.",
                part=("face", joined.shells[k][0]),
            )
    for k in inner if len(inner) > 1 else []:
        within = Crossings(boundary, joined.shells[k])
        for m in inner:
            if m != k and within.inside(spots[m]):
                raise BodyError(
                    f"Faces {_named(joined.shells[m])} lie inside the cavity of faces "
                    f"{_named(joined.shells[k])}: make a boundary of each solid.",
                    part=("face", joined.shells[m][0]),
                )
    return inner


def _spot(boundary: PackedParts, shell: Sequence[int]) -> Array:
    """A point of a shell."""
    face = boundary.face_parts[shell[0]]
    if face.loop:
        first: Array = edge_points(boundary.edge_parts[face.loop[0][0]])[0]
        return first
    middle: Array = face.charts[0].jet(0.0, 0.0)[0]
    return middle


def _turn_inward(parts: Assembled, shell: Sequence[int]) -> None:
    """Turn a cavity's shell: out of the material is into the cavity."""
    for chart in parts.charts:
        if chart.face in shell:
            chart.outward = -chart.outward
    edges = {j for i in shell for j, _ in parts.faces[i].loop}
    ends = {v for j in edges for v in (parts.edges[j].first, parts.edges[j].last)}
    ends |= {apex.vertex for i in shell for apex in parts.faces[i].apexes}
    for vertex in ends - {None}:
        assert vertex is not None
        parts.cones[vertex] = [-normal for normal in parts.cones[vertex]]


def _box(boundary: PackedParts, parts: Assembled) -> tuple[Array, Array]:
    """(low, high) of a box around a boundary: around the edges of plane faces, and around
    rectangles of parameters that contain the others."""
    curved = [i for i, face in enumerate(parts.faces) if not all(c.flat for c in face.charts)]
    boxes = [curve_box(edge) for edge in parts.edges]
    charts = face_charts(boundary, curved)
    boxes += [(x, x) for c in charts for x in [c.surface.jet(0.0, 0.0)[0]] if not len(c.borders[0])]
    lows, highs = zip(*boxes, strict=True)
    return grown_box(boundary, charts, np.min(lows, axis=0), np.max(highs, axis=0))


def _with_kinds(parts: Assembled, size: float) -> Assembled:
    """The parts, with their edges marked as smooth, reflex or mixed."""
    smooth, flags = [False] * len(parts.edges), [0] * len(parts.edges)
    for turns in edge_turns(parts, size):
        found = extremes(parts, size, turns) if _open(turns) else turns
        j = found.edge
        if max(-found.least, found.greatest) <= SMOOTH_ANGLE:
            smooth[j] = parts.edges[j].smooth is not False
        elif found.greatest <= SMOOTH_ANGLE:
            flags[j] = L.REFLEX
        elif found.least < -SMOOTH_ANGLE:
            flags[j] = L.MIXED
    return replace(parts, smooth=smooth, reflex=flags)


def _open(turns: EdgeTurns) -> bool:
    """May an edge be of a different kind between its samples?"""
    least, greatest = turns.least - turns.doubt, turns.greatest + turns.doubt
    return (turns.least >= -SMOOTH_ANGLE > least) or (turns.greatest <= SMOOTH_ANGLE < greatest)
