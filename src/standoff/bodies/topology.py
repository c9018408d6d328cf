"""The parts of a body's boundary, as its maker gives them: vertices, edges, faces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from standoff.geometry.curves import Curve, Line
from standoff.geometry.pcurves import Pcurve
from standoff.geometry.surfaces import Surface
from standoff.geometry.validation import Array

SIDES = ("v0", "v1", "u0", "u1")
"""Sides of a patch, in the order of the kernels' SIDE_ numbers."""


@dataclass(frozen=True)
class Edge:
    """A curve between two vertices; None, None for a closed curve.

    Parameters
    ----------
    curve : Curve
    first, last : int or None
        Numbers of the vertices at its ends.
    smooth : bool or None
        Both faces share their normal along it (G1). None lets the body find out;
        False keeps a seam as an edge of its own all the same.
    creased : bool
        The normals agree along it, but the curvature across it is infinite.
    """

    curve: Curve
    first: int | None = None
    last: int | None = None
    smooth: bool | None = None
    creased: bool = False


@dataclass(frozen=True)
class Apex:
    """A side of a face that has collapsed to a vertex.

    Parameters
    ----------
    vertex : int
    level, lo, hi : float
    side : str
        "v0": u from lo to hi at v = level, the face at greater v; "v1": at lesser v; "u0" and
        "u1": the same with u and v exchanged.
    """

    vertex: int
    level: float
    lo: float
    hi: float
    side: str = "v0"


@dataclass(frozen=True)
class Face:
    """A surface, or an atlas of overlapping charts of one surface, and its loops of edges.

    Parameters
    ----------
    charts : tuple of Surface
        One surface, or the charts of an atlas.
    loop : tuple of pairs
        (edge, +1 or -1) in any order of loops, counterclockwise seen from outside; -1 where the
        face's boundary runs against the edge's parameter.
    apexes : tuple of Apex
        Its collapsed sides.
    pcurves : tuple of Pcurve or None
        For every entry of the loop its trimming curve on the one chart, with the edge's
        parameter; None (or none at all) where the kinds of curve and surface give it exactly.
    """

    charts: tuple[Surface, ...]
    loop: tuple[tuple[int, int], ...] = ()
    apexes: tuple[Apex, ...] = ()
    pcurves: tuple[Pcurve | None, ...] = ()


class BodyError(ValueError):
    """The parts given do not bound a convex body; the message names the part and the fix."""


def check_parts(
    vertices: Array, edges: Sequence[Any], faces: Sequence[Any], dimension: int
) -> None:
    """Raise BodyError where parts are of the wrong kind, loose, or bound no convex body."""
    if dimension not in (2, 3):
        raise BodyError(f"dimension = {dimension!r}: give 2 (planar loop) or 3.")
    for name, parts, kind in (("Edge", edges, Edge), ("Face", faces, Face)):
        for k, part in enumerate(parts):
            if not isinstance(part, kind):
                raise BodyError(f"{name} {k} is {part!r}: make one with so.{name}.")
    for k, face in enumerate(faces):
        if not face.charts or not all(isinstance(s, Surface) for s in face.charts):
            raise BodyError(f"Face {k} has the charts {face.charts!r}: give at least one Surface.")
        if face.pcurves and (len(face.pcurves) != len(face.loop) or len(face.charts) != 1):
            raise BodyError(
                f"Face {k} has {len(face.pcurves)} pcurves, {len(face.loop)} edges and "
                f"{len(face.charts)} charts: give a pcurve (or None) an edge, and one chart."
            )
        if bad := [a.side for a in face.apexes if a.side not in SIDES]:
            raise BodyError(f"Face {k} has an apex on side {bad[0]!r}: give one of {SIDES}.")
    if not (len(vertices) or edges or faces):
        raise BodyError("A body needs at least one vertex, edge or face.")
    used = {v for e in edges for v in (e.first, e.last) if v is not None}
    used |= {a.vertex for f in faces for a in f.apexes}
    loose = sorted(set(range(len(vertices))) - used)
    if loose and not (len(vertices) == 1 and not edges and not faces):
        raise BodyError(f"Vertices {loose} belong to no edge: leave them out or join them.")
    if dimension == 2:
        _check_planar(vertices, edges, faces)
    elif edges and not faces and not (len(edges) == 1 and isinstance(edges[0].curve, Line)):
        raise BodyError(
            f"{len(edges)} edges and no face: in space only one straight edge is a body (a "
            "segment); for a planar loop give dimension=2."
        )


def _check_planar(vertices: Array, edges: Sequence[Edge], faces: Sequence[Face]) -> None:
    if faces:
        raise BodyError("A planar body (dimension 2) has edges and vertices only, no faces.")
    if not edges:
        raise BodyError("A planar body needs at least one curve.")
    points = [e.curve.point(t) for e in edges for t in np.linspace(e.curve.first, e.curve.last, 9)]
    height = float(np.abs(np.vstack([vertices, points])[:, 2]).max())
    if height > 0.0:
        raise BodyError(f"A planar body leaves z = 0 (by {height:.3g}).")
