"""Faces that a screw motion moves along themselves, nearly: the flanks of threads.

What is found here only decides which potential is tried; nothing is proven by it.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from standoff.bodies.face_leaves import FaceChart
from standoff.geometry.nurbs import NurbsSurface
from standoff.kernels.solids import spatial_layout as S
from standoff.solids.spatial.leaves import Leaf
from standoff.solids.spatial.tolerances import ALONG_SCREW, LEAST_TURN, MANY_SCREWS, OFF_THREAD
from standoff.typing import Array

# Samples of a face along each of its parameters.
SAMPLES = 8


@dataclass(frozen=True)
class ScrewSymmetry:
    """A screw motion: its rise per radian, length, a point of its axis, and the axis."""

    rise: float
    point: Array
    axis: Array


@dataclass
class _Thread:
    """Faces along one screw, and samples of them."""

    charts: list[int]
    points: Array
    normals: Array
    screw: ScrewSymmetry


def put_screws(
    leaves: Iterable[Leaf],
    charts: Mapping[int, FaceChart],
    beside: Mapping[int, Sequence[int]],
) -> None:
    """Give each leaf of a face along a screw, and of an edge of one, the screw of its thread.

    `beside`: the charts beside each edge, by its number as a feature.
    """
    screws = {
        number: thread.screw for thread in _threads(charts.values()) for number in thread.charts
    }
    for leaf in leaves:
        if leaf.kind != S.NO_KIND:
            continue
        own = [leaf.chart] if leaf.dim == 2 else beside[leaf.feature]
        screw = next((screws[number] for number in own if number in screws), None)
        if screw is not None:
            leaf.kind, leaf.beside = S.SCREWED, S.NO_KIND
            record = [1.0, screw.rise, 0.0, *screw.point, *screw.axis]
            leaf.reals[S.NATURAL_REALS : S.NATURAL_REALS + 9] = record


def _threads(charts: Iterable[FaceChart]) -> list[_Thread]:
    """Faces along one screw, together: of a whole thread it is known far better than of a piece.
    Its crests and roots have many screws, that one among them."""
    found: list[_Thread] = []
    others: list[tuple[int, Array, Array]] = []
    for chart in charts:
        if not isinstance(chart.surface, NurbsSurface):
            continue
        points, normals = _sampled(chart)
        screw = screw_of(points, normals)
        if screw is None:
            others.append((chart.number, points, normals))
            continue
        for thread in found:
            both = np.concatenate([thread.points, points])
            across = np.concatenate([thread.normals, normals])
            joint = screw_of(both, across)
            if joint is not None:
                thread.charts.append(chart.number)
                thread.points, thread.normals, thread.screw = both, across, joint
                break
        else:
            found.append(_Thread([chart.number], points, normals, screw))
    for number, points, normals in others:
        along = [each for each in found if _is_along(each.screw, points, normals)]
        if along:
            along[0].charts.append(number)
    return found


def _is_along(screw: ScrewSymmetry, points: Array, normals: Array) -> bool:
    """Does a screw motion move a surface along itself, nearly?"""
    ways = np.cross(screw.axis, points - screw.point) + screw.rise * screw.axis
    speeds = np.linalg.norm(ways, axis=1)
    return bool((np.abs((ways * normals).sum(axis=1)) <= OFF_THREAD * speeds).all())


def _sampled(chart: FaceChart) -> tuple[Array, Array]:
    """(n, 3) points of a chart's rectangle and unit normals there."""
    u0, u1, v0, v1 = chart.rectangle
    shares = (np.arange(SAMPLES) + 0.5) / SAMPLES
    points, normals = [], []
    for u, v in product(u0 + (u1 - u0) * shares, v0 + (v1 - v0) * shares):
        x, xu, xv, *_ = chart.surface.jet(float(u), float(v))
        normal = np.cross(xu, xv)
        size = np.linalg.norm(normal)
        if size > 0.0:
            points.append(x)
            normals.append(normal / size)
    return np.reshape(points, (-1, 3)), np.reshape(normals, (-1, 3))


def screw_of(points: Array, normals: Array) -> ScrewSymmetry | None:
    """The screw motion that moves a surface along itself, nearly; None where there is none, or
    more than one, or it is a translation.

    Parameters
    ----------
    points, normals : (n, 3)
        Of the surface; unit normals.

    Notes
    -----
    A motion with the angular velocity w and the velocity v of the origin moves a surface along
    itself if all its velocities are tangential: n . v + (p x n) . w = 0, linear in (v, w) [1]_.

    References
    ----------
    .. [1] H. Pottmann and T. Randrup, Rotational and helical surface approximation for reverse
       engineering, Computing 60, 1998.
    """
    if len(points) < 6:
        return None
    centre = points.mean(axis=0)
    size = float(np.abs(points - centre).max())
    if size == 0.0:
        return None
    p = (points - centre) / size
    rows = np.hstack([normals, np.cross(p, normals)])
    _, values, motions = np.linalg.svd(rows, full_matrices=False)
    v, w = motions[-1, :3], motions[-1, 3:]
    turn = float(np.linalg.norm(w))
    far = values[-1] > ALONG_SCREW * values[0]
    if far or values[-2] < MANY_SCREWS * values[0] or turn < LEAST_TURN:
        return None
    rise = size * float(v @ w) / turn**2
    return ScrewSymmetry(rise, centre + size * np.cross(w, v) / turn**2, w / turn)
