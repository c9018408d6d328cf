"""A body's flat faces, vertices and round rims, packed for contacts over a segment or an area."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from standoff.bodies.body import Body
from standoff.bodies.topology import Face
from standoff.geometry.curves import FULL_TURN, ConicArc, Line
from standoff.kernels.body import layout as L
from standoff.kernels.dynamics import flat_parts as F
from standoff.kernels.entries.queries import chart_normal
from standoff.simulation.tolerances import RIM_GAP, SHARED_END
from standoff.typing import Array

RIM_CORNERS = 12
"""Corners of the polygon that stands for a closed curved edge; an open one has half as many."""


class FlatFace(NamedTuple):
    """A flat face: outward normal, a point, corners in order (none: a half-space); body frame."""

    normal: Array
    point: Array
    corners: Array


class FlatParts(NamedTuple):
    """What of a body can be level with a contact; body frame."""

    faces: tuple[FlatFace, ...]
    tips: Array
    rims: Array
    kind: int

    @property
    def springs(self) -> int:
        """The most corners of one face."""
        return max((len(face.corners) for face in self.faces), default=0)

    @property
    def several(self) -> bool:
        """May a contact of it have more than one spot?"""
        return bool(self.faces) or len(self.tips) + len(self.rims) > 1


def flat_parts(body: Body) -> FlatParts:
    """The flat faces, vertices and rims of a body."""
    faces = [
        _flat_face(body, number, face)
        for number, face in enumerate(body.face_parts)
        if len(face.charts) == 1 and face.charts[0].flat
    ]
    rims = [
        edge.curve.basis().T[[2, 0, 1]].ravel()
        for edge in body.edge_parts
        if isinstance(edge.curve, ConicArc)
        and edge.curve.last - edge.curve.first > FULL_TURN - RIM_GAP
    ]
    return FlatParts(
        tuple(faces),
        np.asarray(body.vertex_points),
        np.reshape(rims, (-1, F.RIM_REALS)),
        _kind(body, len(faces)),
    )


def _kind(body: Body, flat_faces: int) -> int:
    """A half-space; a body of flat faces, straight edges, or vertices alone; or a curved one."""
    if not body.bounded:
        return F.HALFSPACE
    straight = all(isinstance(edge.curve, Line) for edge in body.edge_parts)
    return F.POLYTOPE if straight and flat_faces == body.n_faces else F.CURVED


def _flat_face(body: Body, number: int, face: Face) -> FlatFace:
    chart = int(body.ints[int(body.ints[L.FACES]) + L.FACE_STRIDE * number])
    normal = np.array(chart_normal(body.ints, body.reals, chart, 0.0, 0.0))
    corners = _corners(body, face, normal)
    point = corners.mean(axis=0) if len(corners) else face.charts[0].jet(0.0, 0.0)[0]
    return FlatFace(normal, np.asarray(point), corners)


def _corners(body: Body, face: Face, normal: Array) -> Array:
    """A face's corners around it, counterclockwise; curved edges by points on them."""
    points = []
    for number, _ in face.loop:
        curve = body.edge_parts[number].curve
        if isinstance(curve, Line):
            ends = [curve.first, curve.last]
        else:
            count = RIM_CORNERS if curve.closed else RIM_CORNERS // 2 + 1
            ends = list(np.linspace(curve.first, curve.last, count + int(curve.closed)))
        points += [curve.point(float(t)) for t in ends]
    if not points:
        return np.zeros((0, 3))
    cloud = np.array(points)
    middle = cloud.mean(axis=0)
    across = np.cross(np.eye(3)[int(np.abs(normal).argmin())], normal)
    across /= np.linalg.norm(across)
    away = cloud - middle
    angles = np.arctan2(away @ np.cross(normal, across), away @ across)
    ordered = cloud[np.argsort(angles)]
    # neighbouring edges share their ends
    least = SHARED_END * float(np.abs(away).max())
    apart = np.linalg.norm(ordered - np.roll(ordered, 1, axis=0), axis=1) > least
    kept = ordered[apart]
    if len(kept) > F.MAX_SPOTS // 2:
        kept = kept[np.linspace(0, len(kept), F.MAX_SPOTS // 2, endpoint=False).astype(int)]
    return np.asarray(kept)


def pack_flat_parts(parts: FlatParts, offset: int) -> tuple[list[int], list[float]]:
    """(integers, numbers) of them as the kernels read them; `offset` is where the numbers begin."""
    numbers: list[float] = []
    rows: list[int] = []
    for face in parts.faces:
        rows += [len(face.corners), offset + len(numbers)]
        numbers += [*face.normal, *face.point, *face.corners.ravel()]
    tips = offset + len(numbers)
    numbers += list(parts.tips.ravel())
    rims = offset + len(numbers)
    numbers += list(parts.rims.ravel())
    header = [len(parts.faces), len(parts.tips), len(parts.rims), tips, rims, parts.kind]
    return header + rows, numbers
