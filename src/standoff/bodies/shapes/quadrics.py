"""Bodies of planes and quadrics of revolution, and ellipsoids."""

from __future__ import annotations

import numpy as np

from standoff.bodies.body import Body
from standoff.bodies.topology import Apex, Edge, Face
from standoff.geometry.curves import ConicArc
from standoff.geometry.surfaces import Cone, Cylinder, Plane, Sphere
from standoff.geometry.validation import Array, finite, matrix3, positive

# A gnomonic chart alone serves a face up to this tangent of the angle from its centre.
SINGLE_CHART_REACH = 3.0

# Rotations that take e_z to the six axes: the charts of an ellipsoid's atlas.
_AXES = np.array(
    [
        [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
        [[1, 0, 0], [0, -1, 0], [0, 0, -1]],
        [[0, 0, 1], [1, 0, 0], [0, 1, 0]],
        [[0, 0, -1], [-1, 0, 0], [0, 1, 0]],
        [[0, 1, 0], [0, 0, 1], [1, 0, 0]],
        [[0, -1, 0], [0, 0, -1], [1, 0, 0]],
    ],
    dtype=np.float64,
)


def sphere_atlas(linear: Array, centre: Array) -> tuple[Sphere, ...]:
    """Six overlapping gnomonic charts of the ellipsoid linear @ (unit sphere) + centre.

    Parameters
    ----------
    linear : (3, 3) array_like
        Its columns are semi-axes, or any three vectors that map the unit sphere to it; length.
    centre : (3,) array_like
        Length.

    Returns
    -------
    tuple of six Sphere
        The charts of one `Face`.

    Raises
    ------
    ValueError
        A wrong shape, a number that is not finite, or a singular map.
    """
    axes = matrix3(linear, "linear")
    return tuple(Sphere(axes @ turn, centre) for turn in _AXES)


def ellipsoid(a: float, b: float, c: float) -> Body:
    """An ellipsoid about the origin: one smooth face with an atlas of six charts.

    Parameters
    ----------
    a, b, c : float
        Semi-axes along x, y, z, length, positive.

    Returns
    -------
    Body

    Raises
    ------
    ValueError
        A number that is not finite, not positive, beyond 1e50 or below 1e-50.
    """
    axes = np.diag([positive(a, "a"), positive(b, "b"), positive(c, "c")])
    return Body.from_brep(faces=[Face(sphere_atlas(axes, np.zeros(3)))], name="ellipsoid")


def cylinder(r: float, length: float) -> Body:
    """A cylinder about the axis z, centred.

    Two discs and a side without a seam; the rims are closed edges.

    Parameters
    ----------
    r : float
        Radius, length, positive.
    length : float
        From disc to disc, length, positive.

    Returns
    -------
    Body

    Raises
    ------
    ValueError
        A number that is not finite, not positive, beyond 1e50 or below 1e-50.
    """
    r, half = positive(r, "r"), 0.5 * positive(length, "length")
    x, y = np.array([r, 0.0, 0.0]), np.array([0.0, r, 0.0])
    low, high = np.array([0.0, 0.0, -half]), np.array([0.0, 0.0, half])
    edges = [Edge(ConicArc(low, x, y)), Edge(ConicArc(high, x, y))]
    faces = [
        Face((Cylinder(np.diag([r, r, 1.0]), np.zeros(3)),), ((0, 1), (1, -1))),
        Face((Plane.through(low, y / r, x / r),), ((0, -1),)),
        Face((Plane.through(high, x / r, y / r),), ((1, 1),)),
    ]
    return Body.from_brep(edges=edges, faces=faces, name="cylinder")


def cone(r: float, height: float) -> Body:
    """A cone about the axis z: its base at -height/2, its apex at +height/2.

    Parameters
    ----------
    r : float
        Radius of the base, length, positive.
    height : float
        From base to apex, length, positive.

    Returns
    -------
    Body

    Raises
    ------
    ValueError
        A number that is not finite, not positive, beyond 1e50 or below 1e-50.
    """
    r, height = positive(r, "r"), positive(height, "height")
    x, y = np.array([r, 0.0, 0.0]), np.array([0.0, r, 0.0])
    base, apex = np.array([0.0, 0.0, -0.5 * height]), np.array([0.0, 0.0, 0.5 * height])
    side = Cone(np.diag([r, r, -height]), apex)
    return Body.from_brep(
        [apex],
        [Edge(ConicArc(base, x, y))],
        [
            Face((side,), ((0, 1),), (Apex(0, 0.0, 0.0, 2.0 * np.pi),)),
            Face((Plane.through(base, y / r, x / r),), ((0, -1),)),
        ],
        name="cone",
    )


def cap(radius: float, offset: float) -> Body:
    """The part z >= offset of a ball about the origin: a disc and a spherical face.

    Parameters
    ----------
    radius : float
        Of the ball, length, positive.
    offset : float
        Height z of the disc, length; above -radius and below radius.

    Returns
    -------
    Body

    Raises
    ------
    ValueError
        A number that is not finite, a radius that is not positive, an offset that leaves nothing
        or the whole ball.
    """
    r = positive(radius, "radius")
    h = float(finite(offset, "offset", ()))
    if not -r < h < r:
        raise ValueError(f"Cap with offset = {h} outside (-{r}, {r}): nothing or a ball is left.")
    rim = float(np.sqrt((r - h) * (r + h)))
    x, y = np.array([rim, 0.0, 0.0]), np.array([0.0, rim, 0.0])
    base = np.array([0.0, 0.0, h])
    frame = r * np.eye(3)
    charts: tuple[Sphere, ...] = (Sphere(frame, np.zeros(3)),)
    if h <= 0.0 or rim / h > SINGLE_CHART_REACH:
        charts = sphere_atlas(frame, np.zeros(3))
    return Body.from_brep(
        edges=[Edge(ConicArc(base, x, y))],
        faces=[
            Face(charts, ((0, 1),)),
            Face((Plane.through(base, y / rim, x / rim),), ((0, -1),)),
        ],
        name="cap",
    )


def halfspace() -> Body:
    """The half-space z <= 0: one plane without a boundary.

    Returns
    -------
    Body
        Unbounded: its partner must be bounded.
    """
    plane = Plane.through(np.zeros(3), np.array([1.0, 0, 0]), np.array([0, 1.0, 0]))
    return Body.from_brep(faces=[Face((plane,))], name="halfspace")
