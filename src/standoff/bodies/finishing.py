"""The last checks of an assembled boundary, its slack, and its packing."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from standoff.bodies.angles import EdgeTurns, check_vertices, dihedral, edge_turns, refined
from standoff.bodies.assembly import Joined
from standoff.bodies.convexity import Convexity, FaceProofs, convexity
from standoff.bodies.packing import Assembled, pack, without_charts
from standoff.bodies.report import BodyReport
from standoff.bodies.sampling import (
    blind_charts,
    body_box,
    boundary_samples,
    check_convex,
    inner_boxes,
)
from standoff.bodies.tolerances import (
    CONVEXITY_TOLERANCE,
    ROUNDOFF,
    SAMPLED_DEFECT,
    SMOOTH_ANGLE,
    coordinate_roundoff,
)
from standoff.errors import BodyError
from standoff.typing import Array, Ints


@dataclass(frozen=True, eq=False)
class PackedBoundary:
    """A checked boundary, its two arrays, and what was found."""

    parts: Assembled
    ints: Ints
    reals: Array
    report: BodyReport


def finish(
    joined: Joined,
    radius: float,
    convexity_tolerance: float | None,
    known: FaceProofs | None = None,
) -> PackedBoundary:
    """Prove convexity, bound the defect, and pack.

    Raises BodyError: a boundary that is not convex, has no extent, or is a knife edge with a
    residual.
    """
    parts = joined.parts
    ints, reals = pack(parts, [], (np.zeros(3), np.zeros(3)), radius, 0.0)
    blind = blind_charts(parts, ints, reals)
    if blind:
        parts = without_charts(parts, blind)
        ints, reals = pack(parts, [], (np.zeros(3), np.zeros(3)), radius, 0.0)
    box = body_box(parts, ints, reals)
    size = np.inf if box is None else float(np.linalg.norm(box[1] - box[0]))
    turns = edge_turns(parts, size)
    parts = replace(parts, smooth=_smooth(parts, turns))
    ints, reals = pack(parts, [], (np.zeros(3), np.zeros(3)), radius, 0.0)
    samples = boundary_samples(parts, ints, reals)
    if box is not None and size + radius <= 0.0 and len(parts.vertices) != 1:
        raise BodyError("The body has no extent.")
    share = CONVEXITY_TOLERANCE * size if convexity_tolerance is None else convexity_tolerance
    found = Convexity((), 0.0, 1.0)
    if parts.dimension == 3:
        turns = refined(parts, turns, size)
        check_vertices(parts)
        found = convexity(parts, turns, size, share, known)
    else:
        from standoff.bodies.planar_convexity import planar_convexity

        found = planar_convexity(parts, size, share)
    roundoff = 0.0 if box is None else coordinate_roundoff(np.array(box))
    if box is not None:
        allowed = found.defect + 2.0 * joined.residual + max(SAMPLED_DEFECT * size, roundoff)
        seen = check_convex(samples, size, allowed)
        found = replace(found, defect=max(found.defect, seen, 0.0))
    slack = slack_of(found, joined.residual, parts.moved, max(ROUNDOFF * size, roundoff))
    inner = inner_boxes(parts, ints, reals)
    ints, reals = pack(parts, samples, box, radius, slack, inner)
    report = _report(parts, joined, turns, found, size + 2.0 * radius, share, slack, roundoff)
    return PackedBoundary(parts, ints, reals, report)


def _smooth(parts: Assembled, turns: list[EdgeTurns]) -> list[bool]:
    """An edge is smooth if its faces have the same normals all along it."""
    smooth = list(parts.smooth)
    for e in turns:
        smooth[e.edge] = smooth[e.edge] and max(-e.least, e.greatest) <= SMOOTH_ANGLE
    return smooth


def slack_of(found: Convexity, residual: float, moved: float, roundoff: float) -> float:
    """What the certificate subtracts: 0 where all three are roundoff."""
    total = sum(x for x in (found.defect, residual, moved) if x > roundoff)
    if total == 0.0:
        return 0.0
    if not np.isfinite(found.widen):
        raise BodyError(
            f"A knife edge (faces back to back) with a defect of {found.defect:.3g} and a sewing "
            f"residual of {residual:.3g}: no lower bound holds there. Make its sides equal.",
            "residual",
            residual,
        )
    return total * found.widen


def _report(
    parts: Assembled,
    joined: Joined,
    turns: list[EdgeTurns],
    found: Convexity,
    size: float,
    convexity_tolerance: float,
    slack: float,
    roundoff: float,
) -> BodyReport:
    sharpest = max(turns, key=lambda e: e.greatest, default=None)
    flattest = min(turns, key=lambda e: e.least, default=None)
    return BodyReport(
        dimension=parts.dimension,
        faces=len(parts.faces),
        edges=len(parts.edges),
        vertices=len(parts.vertices),
        smooth_edges=sum(parts.smooth),
        charts=len(parts.charts),
        size=size,
        convexity_defect=found.defect,
        notes=tuple(joined.notes),
        closed=bool(np.isfinite(size)),
        outward=True,
        patches=found.patches,
        sharpest=None
        if sharpest is None
        else dihedral(parts, sharpest.edge, sharpest.greatest, sharpest.at_greatest),
        flattest=None
        if flattest is None
        else dihedral(parts, flattest.edge, flattest.least, flattest.at_least),
        convexity_tolerance=convexity_tolerance,
        sewing_residual=joined.residual,
        sewing_tolerance=joined.tolerance,
        slack=slack,
        coordinate_roundoff=roundoff,
    )
