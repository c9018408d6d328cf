"""A proof that two cores overlap, from their own support points."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.body import Body
from standoff.bodies.planes import outer_plane
from standoff.tracking.overlap import hulls_meet
from standoff.tracking.support import sample_points, support_point

Array = NDArray[np.float64]


def cores_overlap(a: Body, b: Body, flat_a: Array, flat_b: Array) -> bool:
    """Is it proven that two cores share a point: do the hulls of some of their points?

    flat_a and flat_b are world poses, 12 numbers each (R row-major, p).
    """
    turn_a, turn_b = flat_a[:9].reshape(3, 3), flat_b[:9].reshape(3, 3)
    shift = flat_b[9:] - flat_a[9:]
    if not a.bounded:
        normal, offset = outer_plane(a)
        up = turn_a @ normal
        return reaches_into(b, turn_b.T @ up, float(up @ shift) - offset)
    if not b.bounded:
        normal, offset = outer_plane(b)
        up = turn_b @ normal
        return reaches_into(a, turn_a.T @ up, -float(up @ shift) - offset)
    points_a = sample_points(a) @ turn_a.T
    points_b = sample_points(b) @ turn_b.T + shift
    return hulls_meet(
        points_a,
        points_b,
        lambda w: turn_a @ support_point(a, turn_a.T @ w),
        lambda w: turn_b @ support_point(b, turn_b.T @ w) + shift,
    )


def reaches_into(body: Body, up: Array, height: float) -> bool:
    """Does a body come into a half-space whose outward normal `up` is, in the body's frame, when
    its origin is `height` above the plane?

    Its lowest point below, or within the swept radius of, the plane proves it.
    """
    return bool(up @ support_point(body, -up) + height <= body.radius)
