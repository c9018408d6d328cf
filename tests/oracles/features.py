"""Which feature of a shape a surface point lies on: geometric predicates, no topology."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from standoff_studies.oracles import (
    Affine,
    Box,
    Capsule,
    Cone,
    Placed,
    Point,
    Segment,
    Shape,
    Sphere,
    Swept,
)

from .closed_forms import point_curve
from .loops import PlanarLoop
from .surfaces import quadrics

Array = NDArray[Any]
Kind = Literal["face", "edge", "vertex"]

ON_SURFACE = 1e-7
"""Distance to a surface, over the shape's bounding radius, at which a point lies on it."""


@dataclass(frozen=True)
class Feature:
    """``kind`` and the names of the surfaces that meet there (see ``surfaces.quadrics``)."""

    kind: Kind
    surfaces: frozenset[str]

    @property
    def dimension(self) -> int:
        """2 for a face, 1 for an edge, 0 for a vertex."""
        return {"face": 2, "edge": 1, "vertex": 0}[self.kind]


def core_point(shape: Shape, point: Array) -> Array:
    """Return the point of a swept shape's core that a surface point belongs to."""
    if isinstance(shape, Sphere):
        return np.zeros(3)
    if isinstance(shape, Capsule):
        half = shape.length / 2
        return np.array([0.0, 0.0, np.clip(point[2], -half, half)])
    if isinstance(shape, Box):
        return np.clip(point, -shape.half, shape.half)
    return point


def _loop_feature(loop: PlanarLoop, point: Array, tolerance: float) -> Feature:
    corner = np.linalg.norm(loop.corners - point[:2], axis=1)
    count = len(loop.curves)
    if corner.min() <= tolerance:
        index = int(corner.argmin())
        names = {f"curve{(index - 1) % count}", f"curve{index}"}
        return Feature("vertex", frozenset(names))
    found = [point_curve(point, curve)[0] for curve in loop.curves]
    if min(found) > tolerance:
        raise ValueError(f"point {point} is {min(found):.3g} off the loop")
    return Feature("edge", frozenset({f"curve{int(np.argmin(found))}"}))


def _cone_feature(cone: Cone, point: Array, tolerance: float) -> Feature:
    if np.linalg.norm(point - cone.apex) <= tolerance:
        return Feature("vertex", frozenset({"side"}))
    slope = cone.radius / cone.height
    off = np.hypot(point[0], point[1]) - slope * (cone.height / 2 - point[2])
    names = set()
    if abs(off) / np.hypot(1, slope) <= tolerance:
        names.add("side")
    if abs(point[2] + cone.height / 2) <= tolerance:
        names.add("base")
    if not names:
        raise ValueError(f"point {point} is off the cone")
    return Feature("edge" if len(names) == 2 else "face", frozenset(names))


def feature_at(shape: Shape, point: ArrayLike, tolerance: float = ON_SURFACE) -> Feature:
    """Return the feature a body-frame surface point lies on.

    ``tolerance`` is relative to the bounding radius. Swept shapes are judged by their core:
    a sphere is a vertex, a capsule an edge with two vertices, a rounded box a box.

    Raises
    ------
    ValueError
        The point is on no surface within the tolerance.
    """
    p = np.asarray(point, dtype=float)
    if isinstance(shape, Affine) and isinstance(shape.shape, Cone | Swept | PlanarLoop):
        inverse = np.linalg.inv(shape.matrix)
        return feature_at(shape.shape, inverse @ (p - shape.shift), tolerance)
    allowed = tolerance * shape.bounding_radius if np.isfinite(shape.bounding_radius) else tolerance
    if isinstance(shape, PlanarLoop):
        return _loop_feature(shape, p, allowed)
    if isinstance(shape, Cone):
        return _cone_feature(shape, p, allowed)
    if isinstance(shape, Point | Sphere):
        return Feature("vertex", frozenset())
    system = quadrics(shape)
    core = core_point(shape, p)
    active = (np.abs(system.distances(core)) <= allowed) & ~system.equality
    names = frozenset(name for name, on in zip(system.names, active, strict=True) if on)
    if isinstance(shape, Segment | Capsule):
        return Feature("vertex" if names else "edge", names)
    if not names:
        raise ValueError(
            f"point {p} is {np.abs(system.distances(core)).min():.3g} off every surface"
        )
    kinds: tuple[Kind, ...] = ("face", "edge", "vertex")
    return Feature(kinds[min(len(names), 3) - 1], names)


def feature_in_world(body: Placed, point: ArrayLike, tolerance: float = ON_SURFACE) -> Feature:
    """Return the feature a world point lies on."""
    return feature_at(body.shape, body.local(point), tolerance)
