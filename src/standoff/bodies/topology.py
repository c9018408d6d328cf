"""The parts of a body's boundary, as its maker gives them: vertices, edges, faces."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from standoff.checks.arrays import finite
from standoff.checks.numbers import LEAST, is_whole
from standoff.checks.real_numbers import shown
from standoff.errors import BodyError, StandoffTypeError
from standoff.geometry.curves import Curve, Line
from standoff.geometry.surfaces import Surface
from standoff.typing import Array

if TYPE_CHECKING:
    from standoff.geometry.pcurves import Pcurve

SIDES = ("v0", "v1", "u0", "u1")
"""Sides of a patch, in the order of the kernels' SIDE_ numbers."""


@dataclass(frozen=True)
class Edge:
    """A curve between two vertices, or a closed curve without vertices.

    Parameters
    ----------
    curve : Curve
    first, last : int or None
        Numbers of the vertices at its ends; None, None for a closed curve.
    smooth : bool or None
        Both faces have the same normal along it (G1). None lets the body find out; False treats a
        smooth seam like a sharp edge.
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
    """A side of a face that is collapsed to a vertex.

    Parameters
    ----------
    vertex : int
    level, lo, hi : float
    side : str
        "v0": u from lo to hi at v = level, with the face at greater v; "v1": with the face at
        smaller v; "u0" and "u1": the same with u and v exchanged.
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
        (edge, +1 or -1), loops in any order, counterclockwise seen from outside; -1 where the
        face's boundary runs against the edge's parameter.
    apexes : tuple of Apex
        Its collapsed sides.
    pcurves : tuple of Pcurve or None
        For every entry of the loop its trimming curve on the only chart, in the edge's parameter;
        None (or an empty tuple) where the kinds of curve and surface determine it exactly.
    """

    charts: tuple[Surface, ...]
    loop: tuple[tuple[int, int], ...] = ()
    apexes: tuple[Apex, ...] = ()
    pcurves: tuple[Pcurve | None, ...] = ()


def check_parts(
    vertices: Array, edges: Sequence[Any], faces: Sequence[Any], dimension: int
) -> None:
    """Raise BodyError if parts have the wrong type, are loose, or bound nothing."""
    given: Any = dimension
    if not is_whole(given) or dimension not in (2, 3):
        raise BodyError(
            f"dimension = {shown(dimension)}: give 2 (planar loop) or 3.", "dimension", dimension
        )
    for name, parts, kind in (("Edge", edges, Edge), ("Face", faces, Face)):
        for k, part in enumerate(parts):
            if not isinstance(part, kind):
                raise BodyError(
                    f"{name} {k} is {shown(part)}: make one with so.bodies.{name}.",
                    part=(name.lower(), k),
                )
    for k, edge in enumerate(edges):
        _check_edge(k, edge, len(vertices))
    for k, face in enumerate(faces):
        _check_face(k, face, len(vertices))
    if not (len(vertices) or edges or faces):
        raise BodyError("A body needs at least one vertex, edge or face.")
    used = {v for e in edges for v in (e.first, e.last) if v is not None}
    used |= {a.vertex for f in faces for a in f.apexes}
    loose = sorted(set(range(len(vertices))) - used)
    if loose and not (len(vertices) == 1 and not edges and not faces):
        raise BodyError(f"Vertices {loose} belong to no edge: remove them or join them.")
    for k, face in enumerate(faces):
        _check_bounded(k, face, alone=len(faces) == 1)
    if dimension == 2:
        _check_planar(vertices, edges, faces)
    elif edges and not faces and not (len(edges) == 1 and isinstance(edges[0].curve, Line)):
        raise BodyError(
            f"{len(edges)} edges and no face: in space only one straight edge is a body (a "
            "segment); for a planar loop give dimension=2."
        )


def extent_of(points: Any, what: str) -> float:
    """The diagonal of the box around points, length, which is not below `LEAST`: squares are taken
    of it.

    Raises BodyError: it is.
    """
    extent = float(np.linalg.norm(np.ptp(points, axis=0)))
    if not extent >= LEAST:
        raise BodyError(
            f"The extent of {what} is {extent:.3g}: below {LEAST:g}; choose a smaller unit."
        )
    return extent


def parts_of(parts: Any, name: str) -> tuple[Any, ...]:
    """`parts` as a tuple; TypeError if they are not a sequence."""
    no_list = isinstance(parts, np.ndarray) and parts.ndim == 0  # it passes for an Iterable
    if no_list or isinstance(parts, str | bytes | dict) or not isinstance(parts, Iterable):
        raise StandoffTypeError(f"{name} = {shown(parts)}: give a list.", name, parts)
    return tuple(parts)


def _is_number_of(value: Any, count: int) -> bool:
    return is_whole(value) and 0 <= int(value) < count


def _is_pair_of_integers(value: Any) -> bool:
    if not isinstance(value, tuple | list) or len(value) != 2:
        return False
    return all(isinstance(x, int | np.integer) for x in value)


def _check_edge(k: int, edge: Edge, vertices: int) -> None:
    if not isinstance(edge.curve, Curve):
        raise BodyError(
            f"Edge {k} has the curve {shown(edge.curve)}: give a Curve.", part=("edge", k)
        )
    for vertex in (edge.first, edge.last):
        if vertex is not None and not _is_number_of(vertex, vertices):
            raise BodyError(
                f"Edge {k} names vertex {shown(vertex)}; there are {vertices}, numbered from 0: "
                "give one of them, or None at both ends of a closed curve.",
                part=("edge", k),
            )


def _check_face(k: int, face: Face, vertices: int) -> None:
    charts: Any = face.charts  # whatever a caller gave
    listed = isinstance(charts, tuple | list) and len(charts) > 0
    if not listed or not all(isinstance(s, Surface) for s in charts):
        raise BodyError(
            f"Face {k} has the charts {shown(charts)}: give at least one Surface.", part=("face", k)
        )
    for name, parts in (("loop", face.loop), ("apexes", face.apexes), ("pcurves", face.pcurves)):
        if not isinstance(parts, tuple | list):
            raise BodyError(
                f"Face {k} has {name} = {shown(parts)}: give a tuple.", part=("face", k)
            )
    for entry in face.loop:
        if not _is_pair_of_integers(entry):
            raise BodyError(
                f"Face {k} has {shown(entry)} in its loop: give pairs of the number of an edge and "
                "+1 or -1.",
                part=("face", k),
            )
    if face.pcurves and (len(face.pcurves) != len(face.loop) or len(face.charts) != 1):
        raise BodyError(
            f"Face {k} has {len(face.pcurves)} pcurves, {len(face.loop)} edges and "
            f"{len(face.charts)} charts: give one pcurve (or None) per edge, and one chart.",
            part=("face", k),
        )
    for apex in face.apexes:
        _check_apex(k, apex, vertices)


def _check_bounded(k: int, face: Face, alone: bool) -> None:
    """Raise BodyError for an unbounded face, except that of a half-space."""
    closed = len(face.charts) > 1 and all(chart.part_of for chart in face.charts)
    if face.loop or face.apexes or closed:
        return
    if not (alone and len(face.charts) == 1 and face.charts[0].flat):
        raise BodyError(
            f"Face {k}, a {type(face.charts[0]).__name__}, has no loop of edges: give its edges, "
            "or all charts of a closed surface; only a single plane is a body, a half-space.",
            part=("face", k),
        )


def _check_apex(k: int, apex: Any, vertices: int) -> None:
    if not isinstance(apex, Apex):
        raise BodyError(
            f"Face {k} has the apex {shown(apex)}: make one with so.bodies.Apex.", part=("face", k)
        )
    if apex.side not in SIDES:
        raise BodyError(
            f"Face {k} has an apex on side {shown(apex.side)}: give one of {SIDES}.",
            part=("face", k),
        )
    if not _is_number_of(apex.vertex, vertices):
        raise BodyError(
            f"Face {k} has an apex at vertex {shown(apex.vertex)}: give a whole number below "
            f"{vertices}, the number of vertices.",
            part=("face", k),
        )
    _, lo, hi = finite((apex.level, apex.lo, apex.hi), f"Face {k}: apex level, lo, hi", (3,))
    if not lo < hi:
        raise BodyError(f"Face {k} has an apex from {lo} to {hi}: give lo < hi.", part=("face", k))


def _check_planar(vertices: Array, edges: Sequence[Edge], faces: Sequence[Face]) -> None:
    if faces:
        raise BodyError("A planar body (dimension 2) has edges and vertices only, no faces.")
    if not edges:
        raise BodyError("A planar body needs at least one curve.")
    points = [e.curve.point(t) for e in edges for t in np.linspace(e.curve.first, e.curve.last, 9)]
    height = float(np.abs(np.vstack([vertices, points])[:, 2]).max())
    if height > 0.0:
        raise BodyError(f"A planar body leaves z = 0 (by {height:.3g}).")
