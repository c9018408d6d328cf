"""Points of boundaries at places, as answers name these."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.boundary import Boundary
from standoff.bodies.features import Feature, charts_of
from standoff.kernels.entries import queries
from standoff.solids.planar.solid import PlanarSolid

Array = NDArray[np.float64]


def point_at(
    body: Boundary | PlanarSolid, feature: Feature, parameters: tuple[float, ...]
) -> Array:
    """The point (3,) of the core at a place: a feature and its parameters, body frame."""
    if isinstance(body, PlanarSolid):
        return _planar_point(body, feature, parameters)
    number, chart = feature.index, -1
    if feature.kind == "face":
        first, _ = charts_of(body, feature.index)
        chart = first + (int(parameters[2]) if len(parameters) > 2 else 0)
    elif feature.kind == "edge":
        number += body.n_faces
    else:
        number += body.n_faces + body.n_edges
    p, q = (*parameters[:2], 0.0, 0.0)[:2]
    return np.array(queries.feature_jet(body.ints, body.reals, number, chart, p, q)[0])


def _planar_point(body: PlanarSolid, feature: Feature, parameters: tuple[float, ...]) -> Array:
    if feature.kind == "edge":
        return body.edges[feature.index].point(parameters[0])
    curves = [pair for loop in body.loops for pair in zip(loop.curves, loop.backward, strict=True)]
    curve, backward = curves[feature.index]
    return curve.point(curve.last if backward else curve.first)
