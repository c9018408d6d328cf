"""Senses of loops, sides of coedges, and which edges are smooth."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Sequence

import numpy as np

from standoff.bodies.charts import encircled, surface_normal
from standoff.bodies.packing import Chart
from standoff.bodies.tolerances import SMOOTH_ANGLE
from standoff.bodies.topology import Edge, Face
from standoff.errors import BodyError
from standoff.geometry.validation import Array
from standoff.kernels.body import layout as L


def _edge_users(faces: Sequence[Face], edges: Sequence[Edge]) -> dict[int, list[tuple[int, int]]]:
    """For every edge its two (face, sense) pairs; raises where it is open or used too often."""
    users: dict[int, list[tuple[int, int]]] = {j: [] for j in range(len(edges))}
    for i, face in enumerate(faces):
        for j, sense in face.loop:
            if sense not in (-1, 1):
                raise BodyError(
                    f"Face {i}, edge {j}: orientation {sense}; give +1 or -1.", part=("face", i)
                )
            users[j].append((i, sense))
    for j, used in users.items():
        if faces and len(used) != 2:
            word = "open" if len(used) < 2 else "used too often"
            raise BodyError(
                f"Edge {j} is {word}: it bounds {len(used)} faces; every edge must bound two.",
                part=("edge", j),
            )
    return users


def _compare_faces(
    charts: list[Chart], faces: Sequence[Face], edges: Sequence[Edge]
) -> tuple[list[bool], dict[int, dict[int, bool]]]:
    """Which edges are smooth; and for every face its sharp edges, True where its sense is wrong.

    At a convex edge the inward conormal of one face goes below the other's plane.
    """
    smooth = [False] * len(edges)
    wrong: dict[int, dict[int, bool]] = {i: {} for i in range(len(faces))}
    for j, used in _edge_users(faces, edges).items():
        if not used:
            continue
        t = edges[j].curve.first + 0.43 * (edges[j].curve.last - edges[j].curve.first)
        tangent = edges[j].curve.jet(t)[1]
        tangent = tangent / np.linalg.norm(tangent)
        (f0, s0), (f1, s1) = used
        n0, n1 = (_normal_at(charts, f, j, t) for f in (f0, f1))
        angle = float(np.linalg.norm(np.cross(n0, n1)))
        smooth[j] = angle < SMOOTH_ANGLE
        if edges[j].smooth and not smooth[j]:
            raise BodyError(
                f"Edge {j} is said to be smooth, but its faces' normals differ by {angle:.3g} "
                "(sine).",
                part=("edge", j),
            )
        seam = smooth[j]
        smooth[j] = seam and edges[j].smooth is not False
        if not seam:
            wrong[f0][j] = bool(s0 * (np.cross(n0, tangent) @ n1) > 0.0)
            wrong[f1][j] = bool(s1 * (np.cross(n1, tangent) @ n0) > 0.0)
    return smooth, wrong


def orient(
    charts: list[Chart], faces: Sequence[Face], edges: Sequence[Edge], known: bool = False
) -> tuple[list[bool], list[str]]:
    """Set every coedge's side; find smooth edges. Returns (smooth, notes of what was turned).

    known : the loops run counterclockwise seen from outside, for sure.
    """
    smooth, wrong = _compare_faces(charts, faces, edges)
    notes = []
    signs = {}
    for i, face in enumerate(faces):
        if known:
            signs[i] = 1
            continue
        first = bisect_left(charts, i, key=lambda chart: chart.face)
        if len(face.charts) == 1 and face.loop:
            inward = encircled(charts[first]) * charts[first].outward < 0.0
        else:
            inward = bool(wrong[i]) and all(wrong[i].values())
        bad = [j for j, given_wrong in wrong[i].items() if given_wrong != inward]
        if bad:
            raise BodyError(
                f"Face {i}: its loop runs both ways round (edges {bad} against the others), or "
                "the body is not convex there.",
                part=("face", i),
            )
        signs[i] = -1 if inward else 1
        if inward:
            notes.append(f"face {i}: loop given inward, turned outward")
    for chart in charts:
        for c in chart.coedges:
            if c.edge >= 0:
                c.side = int(c.side * signs[chart.face] * chart.outward)
    return smooth, notes


def _normal_at(charts: list[Chart], face: int, edge: int, t: float) -> Array:
    chart, u, v = chart_at(charts, face, edge, t)
    return chart.outward * surface_normal(chart.surface, u, v)


def chart_at(charts: list[Chart], face: int, edge: int, t: float) -> tuple[Chart, float, float]:
    """The chart of a face that sees an edge's point most centrally, and the parameters there.

    `charts` are in the order of their faces.
    """
    best: tuple[float, Chart, float, float] | None = None
    first = bisect_left(charts, face, key=lambda chart: chart.face)
    for k in range(first, len(charts)):
        chart = charts[k]
        if chart.face != face:
            break
        for c in chart.coedges:
            if c.edge == edge:
                if c.pcurve.kind == L.BEZIER and not c.first <= t <= c.last:
                    continue
                u, v, depth = c.pcurve.point(t)
                reach = max(abs(u), abs(v))
                if depth > 0.0 and (best is None or reach < best[0]):
                    best = (reach, chart, u, v)
    if best is None:
        raise BodyError(
            f"Face {face}: no chart sees edge {edge} at parameter {t}.", part=("face", face)
        )
    return best[1], best[2], best[3]
