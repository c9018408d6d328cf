"""The parts of a body's boundary, as its maker gives them: vertices, edges, faces."""

from __future__ import annotations

from dataclasses import dataclass

from standoff.geometry.curves import Curve
from standoff.geometry.surfaces import Surface


@dataclass(frozen=True)
class Edge:
    """A curve between two vertices; None, None for a closed curve.

    smooth : both faces share their normal along it (G1). None lets the body find out.
    """

    curve: Curve
    first: int | None = None
    last: int | None = None
    smooth: bool | None = None


@dataclass(frozen=True)
class Apex:
    """A side of a face that has collapsed to a vertex: u from lo to hi at v = level."""

    vertex: int
    level: float
    lo: float
    hi: float


@dataclass(frozen=True)
class Face:
    """A surface, or an atlas of overlapping charts of one surface, and its loops of edges.

    loop : (edge, +1 | -1) pairs in any order of loops, counterclockwise seen from outside; -1
        where the face's boundary runs against the edge's parameter.
    """

    charts: tuple[Surface, ...]
    loop: tuple[tuple[int, int], ...] = ()
    apexes: tuple[Apex, ...] = ()


class BodyError(ValueError):
    """The parts given do not bound a convex body; the message names the part and the fix."""
