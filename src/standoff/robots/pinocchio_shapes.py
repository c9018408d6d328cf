"""Coal's shapes as kinds and sizes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from standoff.errors import of_extra
from standoff.typing import Array, Ints

with of_extra("Pinocchio", "pinocchio"):
    import coal


class GeometryShape(NamedTuple):
    """A kind, its sizes, and the mesh of one that is.

    Attributes
    ----------
    kind : str
    size : tuple of float
        As ``shapes.EXACT_KINDS`` reads it; the last is the radius of the ball swept over it.
    mesh : callable or None
    """

    kind: str
    size: tuple[float, ...] = ()
    mesh: Callable[[], tuple[Array, Ints]] | None = None


SIZES: dict[Any, tuple[str, Callable[[Any], tuple[float, ...]]]] = {
    coal.Sphere: ("sphere", lambda s: (s.radius,)),
    coal.Capsule: ("capsule", lambda s: (s.radius, 2.0 * s.halfLength)),
    coal.Cylinder: ("cylinder", lambda s: (s.radius, 2.0 * s.halfLength)),
    coal.Cone: ("cone", lambda s: (s.radius, 2.0 * s.halfLength)),
    coal.Ellipsoid: ("ellipsoid", lambda s: tuple(np.ravel(s.radii).tolist())),
    coal.Box: ("box", lambda s: tuple((2.0 * np.ravel(s.halfSide)).tolist())),
    coal.Halfspace: ("plane", lambda s: (*np.ravel(s.n).tolist(), float(s.d))),
}
"""Coal's half lengths as ours."""


def read_shape(geometry: Any) -> GeometryShape:
    """What a geometry of Coal is; a kind by Coal's own name where it is none of ours."""
    for own, (kind, size) in SIZES.items():
        if isinstance(geometry, own):
            swept = float(geometry.getSweptSphereRadius())
            return GeometryShape(kind, (*(float(x) for x in size(geometry)), swept))
    if isinstance(geometry, coal.Convex | coal.BVHModelBase):
        return GeometryShape("mesh", (), lambda: _mesh(geometry))
    if isinstance(geometry, coal.HeightFieldOBBRSS | coal.HeightFieldAABB):
        return GeometryShape("hfield")
    return GeometryShape(type(geometry).__name__)


def _mesh(geometry: Any) -> tuple[Array, Ints]:
    """Points and triangles of a mesh, or of a polyhedron."""
    if isinstance(geometry, coal.BVHModelBase):
        points = np.array(geometry.vertices(), dtype=float)
        count, triangle = geometry.num_tris, geometry.tri_indices
    else:
        points = np.array(geometry.points(), dtype=float)
        count, triangle = geometry.num_polygons, geometry.polygons
    corners = [[t[0], t[1], t[2]] for t in (triangle(k) for k in range(count))]
    return points, np.array(corners, dtype=np.int64).reshape(-1, 3)
