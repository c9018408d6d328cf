"""Senses of faces: which side is outside, from their loops, neighbours and the enclosed volume.

The loops of a face of one chart determine where it is, whichever way round they were given. The two
faces of an edge run in opposite directions along it, so one face of a shell determines all others;
the sign of the volume that the shell encloses determines that one. No interior point is needed.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from standoff.bodies.charts import surface_normal
from standoff.bodies.loops import traced, turn_loops
from standoff.bodies.packing import Chart
from standoff.bodies.tolerances import PIECE_ROUNDOFF, SMOOTH_ANGLE
from standoff.bodies.topology import Edge, Face
from standoff.errors import BodyError
from standoff.geometry.surfaces import Surface
from standoff.kernels.body import layout as L
from standoff.typing import Array

Volume = Callable[[Sequence[int]], float]
"""The volume that the faces of a shell enclose, as their charts face now: negative if they face
inward, zero if it is only roundoff."""


@dataclass
class Oriented:
    """What was found about the faces' senses.

    Attributes
    ----------
    smooth : for every edge, whether its faces have the same normal at one of its points.
    shells : the faces of each, ascending.
    claims : for every shell +1 if all its loops were given counterclockwise seen from outside, -1
        if all were given clockwise, 0 if they differ or there are none.
    notes : what was turned.
    """

    smooth: list[bool]
    shells: list[list[int]]
    claims: list[int]
    notes: list[str]


def orient(
    charts: list[Chart],
    faces: Sequence[Face],
    edges: Sequence[Edge],
    volume: Volume,
    senses: Sequence[int | None] | None = None,
    trusted: bool = False,
) -> Oriented:
    """Turn every chart outward, and its coedges so that the face is on their left.

    Raises BodyError: an edge that does not join two faces; loops that bound no face; a one-sided
    shell.

    Parameters
    ----------
    senses : for every face +1 if x_u × x_v points outward, -1 if inward, None if its loops decide.
    trusted : all senses are known, and the loops are known to run counterclockwise seen from
        outside.
    """
    users = _edge_users(faces, edges)
    given = senses if senses is not None else [None] * len(faces)
    sheets = [_Sheet(i, face, _charts_of(charts, i), given[i]) for i, face in enumerate(faces)]
    for sheet in sheets:
        sheet.settle(edges, trusted)
    shells = _shells(sheets, users)
    if not trusted:
        for shell in shells:
            _turn_outward([sheets[i] for i in shell], volume)
    claims, notes = [], []
    for shell in shells:
        told = {sheets[i].claim for i in shell}
        claims.append(told.pop() if len(told) == 1 else 0)
    if not trusted:
        notes = [
            f"face {sheet.number}: loop given inward, turned outward"
            for sheet in sheets
            if sheet.claim < 0
        ]
    return Oriented(_smooth_edges(charts, users, edges), shells, claims, notes)


@dataclass
class _Sheet:
    """A face whose sense is being found.

    A sheet of one chart with loops is turned by the chart's `outward`. A sheet of an atlas with
    loops is what lies on their left; which way it faces follows from the surface, so its loops are
    turned instead.
    """

    number: int
    face: Face
    charts: Sequence[Chart]
    sense: int | None
    as_given: int = 1  # -1 if its loops run clockwise seen from x_u × x_v, or were turned

    @property
    def by_loops(self) -> bool:
        return bool(self.face.loop) and len(self.charts) == 1

    def settle(self, edges: Sequence[Edge], trusted: bool) -> None:
        """Use its own loops, with x_u × x_v outward; without a sense an atlas bulges outward."""
        first = self.charts[0].surface
        outward = self.sense or (1 if self.by_loops else bulging(first))
        for chart in self.charts:
            # charts of one atlas may be mirror images of each other
            alike = bulging(chart.surface) * bulging(first)
            chart.outward = float(outward * alike)
        if self.by_loops and not trusted:
            if turn_loops(self.charts[0], self.face, edges, self.number):
                self.as_given = -1
            return
        several = not trusted and len(traced(self.face, edges, self.number)) > 1
        for chart in self.charts:
            chart.holed = several
            for c in chart.coedges:
                c.side = int(c.side * chart.outward) if c.edge >= 0 else c.side

    def along(self, entry: int) -> int:
        """+1 if its boundary runs along the edge of an entry, seen from outside, -1 if against."""
        if self.by_loops:
            side = next(c.side for c in self.charts[0].coedges if c.entry == entry)
            return int(side * self.charts[0].outward)
        return self.face.loop[entry][1] * self.as_given

    def turn(self) -> None:
        """Turn it to the other side: a face of an atlas with loops becomes its complement."""
        if self.by_loops or not self.face.loop:
            for chart in self.charts:
                chart.outward = -chart.outward
            return
        self.as_given = -self.as_given
        for chart in self.charts:
            for c in chart.coedges:
                c.side = -c.side if c.edge >= 0 else c.side

    @property
    def claim(self) -> int:
        """+1 if its loops were given counterclockwise seen from outside, else -1; 0 if none."""
        if not self.face.loop:
            return 0
        outward = int(self.charts[0].outward) if self.by_loops else 1
        return self.as_given * outward


def bulging(surface: Surface) -> int:
    """+1 if a surface bulges along x_u × x_v, -1 if against it, by theorem; +1 if not known."""
    side = 1 if np.linalg.det(surface.linear) > 0.0 else -1
    return side * surface.bulge if surface.bulge else 1


def _charts_of(charts: list[Chart], face: int) -> list[Chart]:
    first = bisect_left(charts, face, key=lambda chart: chart.face)
    last = bisect_left(charts, face + 1, key=lambda chart: chart.face)
    return charts[first:last]


def _edge_users(faces: Sequence[Face], edges: Sequence[Edge]) -> dict[int, list[tuple[int, int]]]:
    """For every edge its two (face, entry) pairs; raises if it is open or used too often."""
    users: dict[int, list[tuple[int, int]]] = {j: [] for j in range(len(edges))}
    for i, face in enumerate(faces):
        for k, (j, sense) in enumerate(face.loop):
            if sense not in (-1, 1):
                raise BodyError(
                    f"Face {i}, edge {j}: orientation {sense}; give +1 or -1.", part=("face", i)
                )
            users[j].append((i, k))
    for j, used in users.items():
        if faces and len(used) != 2:
            word = "open" if len(used) < 2 else "used too often"
            raise BodyError(
                f"Edge {j} is {word}: it bounds {len(used)} faces; every edge must bound two.",
                part=("edge", j),
            )
    return users


def _shells(sheets: Sequence[_Sheet], users: dict[int, list[tuple[int, int]]]) -> list[list[int]]:
    """Connected faces, turned so that all faces of a shell have the same side outside."""
    neighbours: list[list[tuple[int, int]]] = [[] for _ in sheets]
    for used in users.values():
        if len(used) == 2:
            (one, k), (other, m) = used
            apart = -sheets[one].along(k) * sheets[other].along(m)
            neighbours[one].append((other, apart))
            neighbours[other].append((one, apart))
    turned: dict[int, int] = {}
    shells = []
    for first in range(len(sheets)):
        if first in turned:
            continue
        turned[first], shell, waiting = 1, [], [first]
        while waiting:
            i = waiting.pop()
            shell.append(i)
            for other, apart in neighbours[i]:
                if other not in turned:
                    turned[other] = apart * turned[i]
                    waiting.append(other)
                elif turned[other] != apart * turned[i]:
                    raise BodyError(
                        f"The boundary has one side only (like a Moebius strip): faces {i} and "
                        f"{other} cannot both face outward.",
                        part=("face", i),
                    )
        for i in shell:
            if turned[i] < 0:
                sheets[i].turn()
        shells.append(sorted(shell))
    return shells


def _turn_outward(shell: Sequence[_Sheet], volume: Volume) -> None:
    """Turn a shell so that it encloses a positive volume; if 0, as most loops were given."""
    numbers = [sheet.number for sheet in shell]
    if sum(sheet.claim for sheet in shell) < 0:
        _turn(shell)
    if len(shell) == 1 and not shell[0].face.loop:
        return  # a closed surface already bulges outward, a half-space is as it was given
    if volume(numbers) >= 0.0:
        return
    _turn(shell)
    if any(not sheet.by_loops and sheet.face.loop for sheet in shell) and volume(numbers) < 0.0:
        raise BodyError(
            f"Faces {numbers} enclose no volume whichever way their loops run: give senses= for "
            "those with several charts.",
            part=("face", numbers[0]),
        )


def _turn(shell: Sequence[_Sheet]) -> None:
    for sheet in shell:
        sheet.turn()


def _smooth_edges(
    charts: list[Chart], users: dict[int, list[tuple[int, int]]], edges: Sequence[Edge]
) -> list[bool]:
    """Which edges are smooth: their faces have the same normal at one point of the edge."""
    smooth = [False] * len(edges)
    for j, used in users.items():
        if not used:
            continue
        t = edges[j].curve.first + 0.43 * (edges[j].curve.last - edges[j].curve.first)
        n0, n1 = (_normal_at(charts, face, j, t) for face, _ in used)
        angle = float(np.linalg.norm(np.cross(n0, n1)))
        smooth[j] = angle < SMOOTH_ANGLE
        if edges[j].smooth and not smooth[j]:
            raise BodyError(
                f"Edge {j} is said to be smooth, but the sine of the angle between its faces' "
                f"normals is {angle:.3g}.",
                part=("edge", j),
            )
        smooth[j] = smooth[j] and edges[j].smooth is not False
    return smooth


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
                room = PIECE_ROUNDOFF * (abs(t) + 1.0)
                if c.pcurve.kind == L.BEZIER and not c.first - room <= t <= c.last + room:
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
