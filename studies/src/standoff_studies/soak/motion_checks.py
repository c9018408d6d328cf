"""Checks of the other numbers: features, parameters, residual and rates."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.kernels.body import layout as L
from standoff.kernels.state import arrays as K
from standoff.typing import Array
from standoff_studies.oracles import dot, lengths
from standoff_studies.soak.motions import Frames
from standoff_studies.soak.shapes import Made

Where = NDArray[np.bool_]

ROUNDOFF = 1e-12
"""Fraction of the speeds of both bodies' points by which roundoff may shift a rate: the greatest in
2,500,000 frames was 2e-15 for rates, 7e-15 for velocities."""

ALONG = 0.1
"""Fraction of a witness point's velocity on its body that may be along the normal if the point is
the farthest along it up to roundoff: the angle that corresponds to roundoff, the root of it divided
by the radius of curvature: 0.1 for radii of 1e-11 of the size."""

TURNS = 2.0
"""The residual consists of four projections of the witness vector, none of which is longer."""


class Check(NamedTuple):
    """One number per frame, (n,), and what is allowed where it counts."""

    what: str
    value: Array
    allowed: Array | float
    where: Where | bool = True


def number_checks(a: Made, b: Made, rows: Array, twists: bool) -> Iterator[Check]:
    """Every number is finite, except rates and velocities, which are nan if no twists are given.

    The mode names features of the bodies, and on a face a chart of that face.
    """
    unknown = ~np.isfinite(rows)
    count = unknown[:, K.OUT_MODE : K.OUT_RATE].sum(axis=1) + unknown[:, K.RESIDUAL :].sum(axis=1)
    yield Check("a feature, parameter, residual or count that is not finite", count, 0.0)
    if twists:
        count = unknown[:, K.OUT_RATE : K.RESIDUAL].sum(axis=1)
        yield Check("a rate or velocity that is not finite", count, 0.0)
    else:
        count = (~np.isnan(rows[:, K.OUT_RATE : K.RESIDUAL])).sum(axis=1)
        yield Check("a rate or velocity without twists", count, 0.0)
    for name, made, at in (("A", a, K.OUT_MODE), ("B", b, K.OUT_MODE + 2)):
        wrong = ~_is_mode(made, rows[:, at], rows[:, at + 1])
        yield Check(f"no feature of {name}", wrong.astype(float), 0.0)
    counts = rows[:, K.OUT_COUNTS :]
    yield Check("a count that is not a number of things", (counts < 0.0).sum(axis=1), 0.0)


def _is_mode(made: Made, feature: Array, chart: Array) -> Where:
    """Does (feature, chart) name a feature of a body, and on a face a chart of it?"""
    ints = made.body.ints
    faces = int(ints[L.N_FACES])
    last = faces + int(ints[L.N_EDGES]) + int(ints[L.N_VERTICES])
    known = (feature >= 0.0) & (feature < last) & (feature == np.floor(feature))
    table = int(ints[L.FACES])
    rows = ints[table : table + L.FACE_STRIDE * faces].reshape(faces, L.FACE_STRIDE)
    on_face = known & (feature < faces)
    face = np.where(on_face, feature, 0.0).astype(np.int64)
    if faces:
        first, count = rows[face, 0], rows[face, 1]
        of_it = (chart >= first) & (chart < first + count) & (chart == np.floor(chart))
        known &= ~on_face | of_it
    return np.asarray(known)


def residual_check(a: Made, b: Made, rows: Array, noise: Array) -> Check:
    """The residual consists of projections of the cores' witness vector, and is no longer."""
    between = rows[:, K.POINT_B : K.POINT_B + 3] - rows[:, K.POINT_A : K.POINT_A + 3]
    radii = a.body.radius + b.body.radius
    longest = lengths(between + radii * rows[:, K.NORMAL : K.NORMAL + 3])
    return Check(
        "the residual is not a projection of the witness vector",
        np.abs(rows[:, K.RESIDUAL]),
        TURNS * longest + noise,
    )


def rate_checks(
    frames: Frames, rows: Array, resting: Where, radii: tuple[float, float]
) -> Iterator[Check]:
    """The rate is n·(V_B - V_A), where V is the velocity of a body's point by the given twists.

    A distance or depth is stationary in its points and normal, so their own motion does not count:
    this is exactly its derivative, whatever the answer's status, and needs no step. Where the
    points are at rest (``resting``), their velocities differ from those of the bodies' points by a
    motion along the surface. A swept body's point turns with the direction between the cores, which
    has the roundoff of their points divided by their distance.
    """
    n = rows[:, K.NORMAL : K.NORMAL + 3]
    x_a = rows[:, K.POINT_A : K.POINT_A + 3]
    x_b = rows[:, K.POINT_B : K.POINT_B + 3]
    speed = _speed(frames.twists_a, frames.poses_a, x_a, x_b)
    speed += _speed(frames.twists_b, frames.poses_b, x_a, x_b)
    # V_A is taken at point_b: if not at rest, the points are not on a line along n
    v_a = _velocity(frames.twists_a, frames.poses_a, x_b)
    v_b = _velocity(frames.twists_b, frames.poses_b, x_b)
    off = np.abs(rows[:, K.OUT_RATE] - dot(n, v_b - v_a))
    yield Check("the rate is not that of the bodies' motion", off, ROUNDOFF * speed)
    v_a = _velocity(frames.twists_a, frames.poses_a, x_a)
    core = np.maximum(np.abs(rows[:, K.DISTANCE] + sum(radii)), np.finfo(float).tiny)
    moved = (("a", v_a, K.VELOCITY_A, radii[0]), ("b", v_b, K.VELOCITY_B, radii[1]))
    for name, v, at, radius in moved:
        slide = rows[:, at : at + 3] - v
        allowed = ALONG * lengths(slide) + ROUNDOFF * speed * (1.0 + radius / core)
        what = f"point_{name} leaves its body"
        yield Check(what, np.abs(dot(n, slide)), allowed, resting)


def _velocity(twists: Array, poses: Array, x: Array) -> Array:
    """v + omega x (x - p), (n, 3)."""
    (wx, wy, wz), (rx, ry, rz) = twists[:, 3:].T, (x - poses[:, 9:]).T
    turned = np.column_stack([wy * rz - wz * ry, wz * rx - wx * rz, wx * ry - wy * rx])
    return np.asarray(twists[:, :3] + turned)


def _speed(twists: Array, poses: Array, x_a: Array, x_b: Array) -> Array:
    """Speed of points as far away as anything involved, (n,): roundoff is relative to it."""
    reach = lengths(poses[:, 9:]) + lengths(x_a) + lengths(x_b)
    return np.asarray(lengths(twists[:, :3]) + lengths(twists[:, 3:]) * reach)
