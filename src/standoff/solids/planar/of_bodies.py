"""The loop of a planar convex body, with its rounding."""

from __future__ import annotations

import numpy as np

from standoff.bodies.body import Body
from standoff.errors import BodyError
from standoff.geometry.curves import ConicArc, Curve, Line
from standoff.kernels.solids import planar_layout as P
from standoff.solids.planar.leaves import form_of
from standoff.solids.planar.loops import Loop, read_loop
from standoff.solids.planar.nesting import turned
from standoff.solids.planar.tolerances import NO_CORNER


def loops_of_body(body: Body) -> list[Curve]:
    """The curves of a planar body's boundary, in order.

    Raises BodyError: a body without area in the plane, or rounded edges that are neither lines nor
    arcs.
    """
    r = body.radius
    if not body.edge_parts and len(body.vertex_points) == 1 and r > 0.0:
        return [ConicArc(body.vertex_points[0], (r, 0.0, 0.0), (0.0, r, 0.0))]
    if len(body.edge_parts) == 1 and r > 0.0 and body.dimension == 3 and body.flat:
        p, q = np.asarray(body.vertex_points)
        return _stadium(p, q, r)
    if body.dimension != 2 or not body.edge_parts:
        raise BodyError(
            f"{body!r} has no area in the plane: give a planar body (so.shapes.planar_loop), a "
            "point or a segment in it with a radius, or a PlanarSolid, whose signed_distance tells "
            "how far points are.",
            "body",
            body,
        )
    curves = [edge.curve for edge in body.edge_parts]
    if r == 0.0:
        return curves
    loop = turned(read_loop(curves, f"the loop of {body.name}"), True)
    return _grown(loop, r, body)


def _stadium(p: np.ndarray, q: np.ndarray, r: float) -> list[Curve]:
    """All around a segment, counterclockwise."""
    along = (q - p) * (r / float(np.linalg.norm(q - p)))
    left = np.array([-along[1], along[0], 0.0])
    return [
        Line(p - left, q - left),
        ConicArc(q, -left, along, 0.0, np.pi),
        Line(q + left, p + left),
        ConicArc(p, left, -along, 0.0, np.pi),
    ]


def _grown(loop: Loop, r: float, body: Body) -> list[Curve]:
    """The loop at a distance r outside, with arcs round its corners."""
    grown: list[Curve] = []
    n = len(loop.curves)
    for k in range(n):
        curve, backward = loop.curves[k], loop.backward[k]
        grown.append(_moved_out(curve, backward, r, body))
        if n == 1:
            break
        corner = curve.point(curve.first if backward else curve.last)
        into, out = _normal(loop, k, True), _normal(loop, (k + 1) % n, False)
        first = float(np.arctan2(into[1], into[0]))
        turn = float(np.arctan2(into[0] * out[1] - into[1] * out[0], into @ out))
        if turn * r > NO_CORNER * body.size:
            axes = (r, 0.0, 0.0), (0.0, r, 0.0)
            grown.append(ConicArc(corner, *axes, first, first + turn))
    return grown


def _normal(loop: Loop, k: int, at_end: bool) -> np.ndarray:
    curve, backward = loop.curves[k], loop.backward[k]
    rate = curve.jet(curve.last if at_end != backward else curve.first)[1][:2]
    tangent = (-rate if backward else rate) / np.linalg.norm(rate)
    return np.array([tangent[1], -tangent[0]])


def _moved_out(curve: Curve, backward: bool, r: float, body: Body) -> Curve:
    form = form_of(curve)
    if form == P.LINE:
        p, q = curve.point(curve.first), curve.point(curve.last)
        rate = (p - q if backward else q - p)[:2]
        out = np.array([rate[1], -rate[0], 0.0]) * (r / float(np.linalg.norm(rate)))
        return Line(p + out, q + out)
    if form == P.ARC:
        a, b, centre = curve.basis().T
        factor = 1.0 + r / float(np.linalg.norm(a))
        return ConicArc(centre, a * factor, b * factor, curve.first, curve.last)
    raise BodyError(
        f"{body!r} is rounded by {r:g}, and has an edge that is neither a line nor an arc of a "
        "circle: its boundary is none of the curves that a PlanarSolid can be made of.",
        "body",
        body,
    )
