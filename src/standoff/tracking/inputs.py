"""What a user gives a tracker, checked and made flat: poses, twists, pairs, places to start."""

from __future__ import annotations

import operator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.body import Body
from standoff.kernels import frame as K
from standoff.kernels.entries import on_face
from standoff.motion import Pose, PoseLike, Twist, TwistLike
from standoff.real_numbers import MaskedNumbers, check_unmasked, shown
from standoff.tracking.proximity import charts_of

Array = NDArray[np.float64]
# A planar body's pose may be tilted by this (entries of R): roundoff of composing rotations.
PLANE_TILT = 1e-12
LAST_ROW = [0.0, 0.0, 0.0, 1.0]
# Where R (row-major) and p stand in a 4x4 matrix.
ROTATION_THEN_POSITION = np.array([0, 1, 2, 4, 5, 6, 8, 9, 10, 3, 7, 11])
# Left writable, as given twists are: for a read-only one Numba would compile the kernels anew, in
# the middle of a run. Nothing writes to it.
NO_TWIST = np.zeros(6)


def flat_pose(pose: PoseLike) -> Array:
    """12 numbers (R row-major, p) of a pose; checked by the kernel, or here by Pose."""
    if type(pose) is np.ndarray and pose.shape == (4, 4) and pose.dtype == np.float64:
        if pose[3].tolist() != LAST_ROW:
            Pose.of(pose)  # says what is wrong with it
        return np.asarray(pose.take(ROTATION_THEN_POSITION))
    pose = Pose.of(pose)
    flat = np.empty(12)
    flat[:9] = pose.rotation.ravel()
    flat[9:] = pose.translation
    return flat


def flat_twist(twist: TwistLike | None, pose: PoseLike) -> Array:
    """6 numbers (v, omega) in world axes."""
    if twist is None:
        return NO_TWIST
    if isinstance(twist, tuple) and len(twist) == 2:
        v, omega = twist
        if type(v) is type(omega) is np.ndarray and v.shape == omega.shape == (3,):
            flat = np.empty(6)
            flat[:3], flat[3:] = v, omega
            return flat
    twist = Twist.of(twist)
    if twist.frame != "world":
        twist = twist.in_world(Pose.of(pose))
    return np.concatenate([twist.v, twist.omega])


def same_body(a: Body, b: Body) -> bool:
    """Are two bodies equal, as after a pickle round trip?"""
    return np.array_equal(a.ints, b.ints) and np.array_equal(a.reals, b.reals)


def check_body(body: object) -> None:
    """Raise TypeError where something given is no body."""
    if not isinstance(body, Body):
        raise TypeError(f"{shown(body)} is not a Body: make one with so.shapes or Body.from_brep.")


def check_pair(a: Body, b: Body) -> None:
    """Raise ValueError where two bodies cannot be a pair."""
    check_body(a)
    check_body(b)
    if not a.bounded and not b.bounded:
        raise ValueError("Two half-spaces have no pair of witness points: one must be bounded.")
    if a.dimension != b.dimension:
        other = b if a.dimension == 2 else a
        if not other.flat:
            raise ValueError(
                f"A planar body needs a planar partner (or a point or segment in z = 0), not "
                f"{other!r}."
            )


def check_in_plane(flat_a: Array, flat_b: Array) -> None:
    """A planar pair must move within one plane z = 0 of world."""
    for name, flat in (("pose_a", flat_a), ("pose_b", flat_b)):
        tilt = float(np.abs(flat[[2, 5, 6, 7]]).max())
        if not tilt <= PLANE_TILT or flat[11] != 0.0 or flat[8] < 0.0:
            raise ValueError(
                f"{name} takes a planar body out of z = 0 (tilt {tilt:.3g}, z = {flat[11]}): "
                "planar pairs turn about z and move in x and y."
            )


def _chart_of(body: Body, face: int, values: Array) -> int:
    """The packed chart of parameters (u, v) or (u, v, chart) on a face."""
    first, count = charts_of(body, face)
    u, v = float(values[0]), float(values[1])
    numbers = range(count)
    if len(values) == 3:
        if values[2] not in numbers:
            raise ValueError(f"Face {face} has charts 0 to {count - 1}, not {values[2]}.")
        numbers = range(int(values[2]), int(values[2]) + 1)
    for number in numbers:
        if on_face(body.ints, body.reals, first + number, u, v):
            return first + number
    raise ValueError(f"Parameters {tuple(values)} lie outside face {face}.")


def place(state: Array, at: int, body: Body, feature: Any, parameters: Any) -> None:
    """Write a feature and its parameters into a state, checked."""
    try:
        kind, index = feature
        check_unmasked(index)
        index = operator.index(index)
    except (TypeError, ValueError) as error:
        raise ValueError(
            f"{shown(feature)} is no feature: give so.Feature('face', 0) or ('face', 0)."
        ) from error
    sizes = {"face": body.n_faces, "edge": body.n_edges, "vertex": body.n_vertices}
    if kind not in sizes or not 0 <= index < sizes[kind]:
        raise ValueError(
            f"{body!r} has no {kind} {index}: faces, edges and vertices are numbered from 0."
        )
    try:
        check_unmasked(parameters)
        values = np.atleast_1d(np.asarray(parameters, dtype=np.float64)).ravel()
    except MaskedNumbers as error:
        raise ValueError(f"The parameter list {error}: {shown(parameters)}") from error
    except (TypeError, ValueError) as error:
        raise ValueError(f"Parameters {shown(parameters)} are not numbers.") from error
    wanted = {"face": 2, "edge": 1, "vertex": 0}[kind]
    atlas = kind == "face" and charts_of(body, index)[1] > 1
    if len(values) not in (wanted, wanted + atlas) or not np.isfinite(values).all():
        also = " (and the number of its chart)" if atlas else ""
        raise ValueError(
            f"A {kind} takes {wanted} finite parameters{also}, not {shown(parameters)}."
        )
    offset = {"face": 0, "edge": body.n_faces, "vertex": body.n_faces + body.n_edges}[kind]
    chart = -1
    if kind == "face":
        chart = _chart_of(body, index, values)
    if kind == "edge":
        curve = body.edge_parts[index].curve
        if not curve.closed and not curve.first <= values[0] <= curve.last:
            raise ValueError(
                f"Parameter {values[0]} lies outside edge {index}: [{curve.first}, {curve.last}]."
            )
    state[K.MODE + at] = offset + index
    state[K.MODE + at + 1] = chart
    state[K.Q + at : K.Q + at + wanted] = values[:wanted]
