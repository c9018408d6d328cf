"""The convexity defect of a whole body, from its patches, edges and vertices.

How far can a point y of a body lie above a tangent plane n at another, x? Take the shortest path
from x to y inside the body. It is straight except where it bends around a dent: in contact with a
dented patch its curvature is at most the patch's worst normal curvature, so that it turns there by
at most the patch's tilt; over a concave edge it turns by at most that edge's angle. It starts
below the plane, so after turning by T in total, y is at most T times the path's length above it.
Convex patches and edges do not turn it: if all are convex, so is the body, which is the theorem of
Tietze and Nakajima.

At edges and vertices the certificate uses normals between those of the faces. For such a normal
n = sum a_i n_i the height is at most (sum a_i) times that of the faces, and sum a_i <= 1/h if some
unit vector c has c.n_i >= h for all of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from standoff.bodies.angles import EdgeTurns
from standoff.bodies.packing import Assembled, Chart
from standoff.bodies.proofs import PatchProof, prove_patch
from standoff.bodies.report import PatchCheck
from standoff.bodies.tolerances import LEAST_AXIS, TURN_ROUNDOFF
from standoff.errors import BodyError
from standoff.long_loops import told
from standoff.typing import Array


@dataclass(frozen=True)
class FaceProofs:
    """What is already known of every face: its name in messages, and its proof."""

    names: Sequence[str]
    proofs: Sequence[PatchProof]


@dataclass(frozen=True)
class Convexity:
    """patches : the check of every chart; defect : of the body, length; widen : 1/h, see above."""

    patches: tuple[PatchCheck, ...]
    defect: float
    widen: float


def convexity(
    body: Assembled,
    turns: Sequence[EdgeTurns],
    size: float,
    tolerance: float,
    known: FaceProofs | None = None,
) -> Convexity:
    """Bound the convexity defect over the whole boundary.

    known : names and proofs of all faces, each of one chart, if they exist already.

    Raises BodyError: a patch or an edge that is concave by more than the tolerance (length), with
    the place.
    """
    names = known.names if known else [f"face {i}" for i in range(len(body.faces))]
    checks = []
    total = 0.0
    for chart in told(body.charts, "proving patches convex"):
        proof = known.proofs[chart.face] if known else prove_patch(chart.surface)
        check, turn = _check_patch(chart, names[chart.face], proof, size, tolerance)
        checks.append(check)
        total += turn
    for e in turns:
        concave = max(-e.least, 0.0)
        if concave * size > tolerance:
            one, other = (names[i] for i in e.faces)
            where = body.edges[e.edge].curve.point(e.at_least)
            raise BodyError(
                f"Not convex: edge {e.edge} between {one} and {other} is concave by "
                f"{np.degrees(concave):.3g} degrees at {where} (its parameter {e.at_least:.6g}): "
                "split the body there, or give convexity_tolerance.",
                part=("edge", e.edge),
            )
        total += concave if concave > TURN_ROUNDOFF else 0.0
    # a path that turns by T in total is longer than its chord by less than a factor 1 + T
    defect = total * (1.0 + total) * size if total > 0.0 else 0.0  # a half-space has no size
    if defect > tolerance:
        raise BodyError(
            f"Not convex: dents and concave edges add up to a defect of {defect:.3g}, more than "
            f"the convexity_tolerance {tolerance:.3g} (size {size:.3g})."
        )
    return Convexity(tuple(checks), defect, widening(body, turns))


def _check_patch(
    chart: Chart, face: str, proof: PatchProof, size: float, tolerance: float
) -> tuple[PatchCheck, float]:
    """A chart's check, and by how much its dents may turn a path, radians."""
    name = type(chart.surface).__name__
    hollow = proof.sense * chart.outward < 0.0
    if hollow:  # by how much, as it has to face outward
        proof = prove_patch(chart.surface, int(chart.outward))
    if not proof.convex and not max(proof.defect, proof.tilt * size) <= tolerance:
        u, v = proof.place
        shape = "is hollow" if hollow else "dents inward"
        raise BodyError(
            f"Not convex: {face} ({name}) {shape} near (u, v) = ({u:.6g}, {v:.6g}), the point "
            f"{chart.surface.jet(u, v)[0]}: it may rise by {proof.defect:.3g} above its own "
            f"tangent planes, and its normals turn back by up to "
            f"{proof.tilt:.3g} radians ({proof.method} bound), which over the size {size:.3g} is "
            f"above the convexity_tolerance {tolerance:.3g}. Split the body into convex parts, or "
            "give convexity_tolerance."
        )
    turn = float(proof.tilt) if proof.tilt > TURN_ROUNDOFF else 0.0
    check = PatchCheck(
        chart.face,
        name,
        proof.method,
        proof.convex,
        float(proof.defect),
        proof.hemisphere,
        proof.place,
    )
    return check, turn


def widening(body: Assembled, turns: Sequence[EdgeTurns]) -> float:
    """1/h, where h is the least cosine between normals that meet and the axis of their cone."""
    least = min([1.0, *(float(np.cos(0.5 * max(e.greatest, 0.0))) for e in turns)])
    for cone in body.cones:
        if len(cone) > 1:
            least = min(least, _axis_cosine(np.array(cone)))
    return 1.0 / least if least > LEAST_AXIS else np.inf


def _axis_cosine(normals: Array) -> float:
    """The least cosine between unit normals and a central axis, found by repeated correction."""
    axis = normals.mean(axis=0)
    best = 0.0
    for k in range(32):
        length = float(np.linalg.norm(axis))
        if length == 0.0:
            break
        axis = axis / length
        cosines = normals @ axis
        best = max(best, float(cosines.min()))
        axis = axis + normals[int(cosines.argmin())] / (k + 2.0)
    return best
