"""The convexity defect of a planar body: its curves, corners and turning number.

A closed planar curve that nowhere bends inward and turns by 2 pi in total bounds a convex set.
Curves are proven as the surfaces that they sweep along z, which have the same curvature.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from standoff.bodies.convexity import Convexity, widening
from standoff.bodies.packing import Assembled
from standoff.bodies.proofs import PatchProof, prove_patch
from standoff.bodies.report import PatchCheck
from standoff.bodies.tolerances import CORNER_ROUNDOFF, TURN_ROUNDOFF
from standoff.errors import BodyError
from standoff.geometry.curves import ConicArc, Curve, Line
from standoff.geometry.nurbs_curves import NurbsCurve
from standoff.geometry.swept import Extrusion
from standoff.typing import Array

# Points of one span of a curve between which turns are summed: each turn is less than pi.
TURN_POINTS = 65
# A loop turns by 2 pi, or at least twice as much: the threshold between (radians).
MOST_TURNING = 3.0 * np.pi


@dataclass(frozen=True)
class _CurveRun:
    """A curve followed counterclockwise: its normals at both ends, and by how much it turns."""

    first: Array
    last: Array
    turn: float


def planar_convexity(body: Assembled, size: float, tolerance: float) -> Convexity:
    """Bound the convexity defect of a closed planar loop.

    Raises BodyError: a curve or a corner that is concave by more than the tolerance (length), a
    curve with a corner inside, a loop that turns more than once.
    """
    checks, total = [], 0.0
    for j, edge in enumerate(body.edges):
        proof = _proof(edge.curve, 1 if body.outward_right[j] else -1, j)
        if not proof.convex and not max(proof.defect, proof.tilt * size) <= tolerance:
            t = proof.place[0]
            raise BodyError(
                f"Not convex: curve {j} ({type(edge.curve).__name__}) is hollow near its parameter "
                f"{t:.6g}, the point {edge.curve.point(t)}: its normal turns back by up to "
                f"{proof.tilt:.3g} radians ({proof.method} bound), which over the size {size:.3g} "
                f"is above the convexity_tolerance {tolerance:.3g}. Split the body into convex "
                "parts."
            )
        total += proof.tilt if proof.tilt > TURN_ROUNDOFF else 0.0
        name = type(edge.curve).__name__
        checks.append(
            PatchCheck(
                j, name, proof.method, proof.convex, proof.defect, proof.hemisphere, proof.place
            )
        )
    runs = [_run(edge.curve, body.outward_right[j]) for j, edge in enumerate(body.edges)]
    turning = sum(run.turn for run in runs)
    for vertex, turn in _corners(body, runs).items():
        turning += turn
        if -turn * size > tolerance:
            raise BodyError(
                f"Not convex: the corner {vertex} at {body.vertices[vertex][:2]} is hollow by "
                f"{np.degrees(-turn):.3g} degrees: split the body there."
            )
        total += -turn if turn < -CORNER_ROUNDOFF else 0.0
    if turning > MOST_TURNING:
        raise BodyError(
            f"The loop turns {turning / (2.0 * np.pi):.2g} times: it crosses or covers itself."
        )
    defect = total * (1.0 + total) * size
    if defect > tolerance:
        raise BodyError(
            f"Not convex: dents and hollow corners add up to a defect of {defect:.3g}, more than "
            f"the convexity_tolerance {tolerance:.3g} (size {size:.3g})."
        )
    return Convexity(tuple(checks), defect, widening(body, ()))


def _proof(curve: Curve, outward: int, number: int) -> PatchProof:
    """Of a curve with the outside on its right (outward 1) or on its left (-1)."""
    if isinstance(curve, Line):
        return PatchProof(True, 0.0, "theorem", True, (curve.first, 0.0), 0)
    if isinstance(curve, ConicArc):
        _, tangent, bend = curve.jet(curve.first)
        sense = 1 if tangent[0] * bend[1] > tangent[1] * bend[0] else -1
        hollow = sense != outward
        defect, tilt = (np.inf, np.pi) if hollow else (0.0, 0.0)
        half = curve.last - curve.first < np.pi
        return PatchProof(not hollow, defect, "theorem", half, (curve.first, 0.0), sense, tilt)
    points = np.array([curve.point(t) for t in np.linspace(curve.first, curve.last, TURN_POINTS)])
    height = float(np.linalg.norm(np.ptp(points, axis=0)))
    wall = Extrusion(curve, [0.0, 0.0, height])
    proofs = [
        prove_patch(wall.restricted(a, b, 0.0, 1.0), outward)
        for a, b in pairwise(_joints(curve, number))
    ]
    if len(proofs) == 1:
        return proofs[0]
    worst = min(proofs, key=lambda proof: proof.curvature)
    return replace(
        worst,
        convex=all(proof.convex for proof in proofs),
        defect=sum(proof.defect for proof in proofs),
        tilt=sum(proof.tilt for proof in proofs),
        hemisphere=False,
    )


def _joints(curve: Curve, number: int) -> list[float]:
    """The ends of a curve and those inner knots where it could have a corner but does not.

    Raises BodyError: it has a corner.
    """
    if not isinstance(curve, NurbsCurve):
        return [curve.first, curve.last]
    inside = []
    for k, knot in enumerate(curve.essential.breaks[1:-1].tolist()):
        if curve.essential.multiplicity(knot) < curve.degree:
            continue
        before, after = (block[:, :2] / block[:, 3:] for block in curve.blocks[k : k + 2])
        if abs(_angle(before[-1] - before[-2], after[1] - after[0])) > CORNER_ROUNDOFF:
            raise BodyError(
                f"Curve {number} (NurbsCurve) has a corner at its knot {knot:.6g}: split it there.",
                part=("curve", number),
            )
        inside.append(knot)
    return [curve.first, *inside, curve.last]


def _run(curve: Curve, right: bool) -> _CurveRun:
    breaks = curve.essential.breaks if isinstance(curve, NurbsCurve) else (curve.first, curve.last)
    ts = np.unique([np.linspace(a, b, TURN_POINTS) for a, b in pairwise(breaks)])
    normals = np.array([_normal(curve, float(t), right) for t in (ts if right else ts[::-1])])
    turn = sum(_angle(a, b) for a, b in pairwise(normals))
    return _CurveRun(normals[0], normals[-1], turn)


def _normal(curve: Curve, t: float, right: bool) -> Array:
    """The outward normal, (2,), not of unit length."""
    tangent = curve.jet(t)[1]
    return np.array([tangent[1], -tangent[0]]) * (1.0 if right else -1.0)


def _angle(a: Array, b: Array) -> float:
    return float(np.arctan2(a[0] * b[1] - a[1] * b[0], a @ b))


def _corners(body: Assembled, runs: list[_CurveRun]) -> dict[int, float]:
    """The turn at every vertex from the curve that arrives to the one that leaves, radians."""
    arriving: dict[int, Array] = {}
    leaving: dict[int, Array] = {}
    for j, edge in enumerate(body.edges):
        ends = (edge.first, edge.last) if body.outward_right[j] else (edge.last, edge.first)
        if ends[0] is not None and ends[1] is not None:
            leaving[ends[0]] = runs[j].first
            arriving[ends[1]] = runs[j].last
    if len(arriving) != len(body.vertices) or len(leaving) != len(body.vertices):
        raise BodyError(
            "Not convex: the loop's curves do not all have the inside on the same side. "
            "Split the body into convex parts."
        )
    return {vertex: _angle(arriving[vertex], leaving[vertex]) for vertex in arriving}
