"""Which pairs of points are local minima of the distance of two boundaries, to first order, as
``kernels.solids.stationary`` asks it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from standoff.kernels.entries.minima import stationary
from standoff.kernels.solids.planar_tolerances import AT_OPTIMUM
from standoff.kernels.solids.spatial_tolerances import FLAT_VALLEY
from standoff.kernels.solids.stationary import FAN_INTS
from standoff.solids.spatial.minimum import leaf_jet_of
from standoff.solids.spatial.pair import NearestPlace, PlacedPair
from standoff.solids.spatial.sides import charts_at, corners_at
from standoff.solids.spatial.solid_model import SolidModel
from standoff.solids.spatial.tolerances import COLLAPSED_SIDE
from standoff.typing import Array

# Directions that are looked into at a vertex that is a face's collapsed side.
WAYS_AROUND = 17


def is_minimum(pair: PlacedPair, place: NearestPlace) -> bool:
    """Can no small step on either boundary make a pair nearer, to first order, and is it no saddle
    of its two leaves?"""
    return _told(pair, place, AT_OPTIMUM, FLAT_VALLEY)


def is_stationary(pair: PlacedPair, place: NearestPlace, sine: float) -> bool:
    """Can no small step on either boundary make a pair nearer along its normal, to first order?
    `sine`: of the angle by which one may."""
    return _told(pair, place, sine, 0.0)


def _told(pair: PlacedPair, place: NearestPlace, sine: float, spare: float) -> bool:
    solids, fans = (pair.a.packed, pair.b.packed), (fans_of(pair.a), fans_of(pair.b))
    asked = np.array([*(pair.ra.T @ place.normal), sine, spare])
    return bool(stationary(solids, pair.relative, fans, place.row, asked))


Fans = tuple[NDArray[np.int64], Array]
"""The directions into a boundary from its vertices, as the kernel lays them out."""

NONE: Fans = (np.empty(0, dtype=np.int64), np.empty(0))


def fans_of(solid: SolidModel) -> Fans:
    """The directions into a boundary from its vertices, own frame; made once."""
    if solid.vertex_fans is None:
        has_vertices = any(leaf.dim == 0 for leaf in solid.leaves)
        solid.vertex_fans = _packed(solid) if has_vertices else NONE
    found: Fans = solid.vertex_fans
    return found


def _packed(solid: SolidModel) -> Fans:
    charts = charts_at(solid)
    ints: list[int] = []
    reals: list[float] = []
    for vertex in range(solid.boundary.n_vertices):
        ways, corners = _fan_of(solid, vertex, charts[vertex])
        for rows in (ways, corners):
            ints += [len(reals), len(rows)]
            reals += np.ravel(rows).tolist()
    found = (np.array(ints, dtype=np.int64), np.array(reals))
    assert len(found[0]) == FAN_INTS * solid.boundary.n_vertices
    for array in found:
        array.flags.writeable = False
    return found


def _fan_of(
    solid: SolidModel, vertex: int, charts: list[int]
) -> tuple[list[Array], list[list[float]]]:
    """Of a vertex unit directions along edges and into faces from collapsed sides; and of each
    face's corner the edge that leaves it, what is a quarter turn from there, and the angle to the
    one that arrives, counterclockwise."""
    ways: list[Array] = []
    corners: list[list[float]] = []
    found, unknown = corners_at(solid, vertex, charts)
    for chart, along in unknown.items():
        ways += [*along, *_ways_from_side(solid, chart, vertex)]
    for corner in found:
        ways += [corner.out, corner.into]
        across = np.cross(corner.normal, corner.out)
        corners.append([*corner.out, *across, corner.angle])
    return ways, corners


def _ways_from_side(solid: SolidModel, chart: int, vertex: int) -> Array:
    """Unit directions (n, 3) into a face from its side that is collapsed to a vertex."""
    point = np.asarray(solid.boundary.vertex_points[vertex], dtype=float)
    found = [np.empty((0, 3))]
    for k, leaf in enumerate(solid.leaves):
        if leaf.dim != 2 or leaf.chart != chart:
            continue
        rect = leaf.reals[:4]
        for side in range(4):
            across, other = divmod(side, 2)
            first, last = rect[2 - 2 * across : 4 - 2 * across].tolist()
            spots = np.linspace(first, last, WAYS_AROUND)
            level = np.full(WAYS_AROUND, rect[side])
            where = (level, spots) if across == 0 else (spots, level)
            jets = [leaf_jet_of(solid.packed, k, u, v) for u, v in zip(*where, strict=True)]
            if np.linalg.norm(jets[0][0] - point) > COLLAPSED_SIDE * solid.size:
                continue
            if np.linalg.norm(jets[-1][0] - point) > COLLAPSED_SIDE * solid.size:
                continue
            ways = np.array([jet[1 + across] for jet in jets]) * (1.0 - 2.0 * other)
            sizes = np.linalg.norm(ways, axis=1)
            found.append(ways[sizes > 0.0] / sizes[sizes > 0.0, None])
    return np.concatenate(found)
